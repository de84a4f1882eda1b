//! From a captured packet to what it carries: link, network and transport headers by etherparse,
//! CAN frames by hand.

use std::net::Ipv6Addr;
use std::ops::Range;

use etherparse::err::LenError;
use etherparse::err::packet::SliceError;
use etherparse::{
    EtherType, IpNumber, Ipv4Slice, LaxNetSlice, LaxSlicedPacket, NetSlice, SlicedPacket,
    TransportSlice, UdpHeader, UdpSlice,
};
use protocol::record::{Direction, DriveLink};

use super::Fault;
use super::reassembly::{DatagramId, Fragment};
use super::sensors::source_of;

/// Bytes of a `struct can_frame`: id (big-endian), length, three reserved, eight of data.
pub(super) const CAN_FRAME_LEN: usize = 16;

/// `if_name` of the drive's interface in our logs, by how the drive is attached.
pub(crate) const USB_NAME: &str = "epos2-usb";
/// As [`USB_NAME`], for RS232.
pub(crate) const RS232_NAME: &str = "epos2-rs232";

/// Link types as registered at tcpdump.org that carry something for us.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LinkType {
    Ethernet,
    /// Linux cooked, version 1: the protocol in bytes 14 and 15 of 16.
    Cooked1,
    /// Linux cooked, version 2: the protocol in the first two bytes of 20.
    Cooked2,
    /// Starts with the IP header, of either version.
    Ip,
    Can,
    /// Our own: the drive's serial frames.
    Serial(DriveLink),
    /// Anything else.
    Unused,
}

impl LinkType {
    /// The link type of a registered number; `name` is the interface's, which tells our use of
    /// LINKTYPE_USER0.
    pub(super) fn from_number(number: u32, name: Option<&str>) -> Option<Self> {
        Some(match number {
            1 => Self::Ethernet,
            101 | 228 | 229 => Self::Ip,
            113 => Self::Cooked1,
            276 => Self::Cooked2,
            227 => Self::Can,
            147 => match name {
                Some(USB_NAME) => Self::Serial(DriveLink::Usb),
                Some(RS232_NAME) => Self::Serial(DriveLink::Rs232),
                _ => return None,
            },
            _ => return None,
        })
    }
}

/// What a packet carries.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// UDP; `payload` counts from the start of the packet.
    Datagram {
        source: [u8; 4],
        port: u16,
        payload: Range<usize>,
    },
    /// The whole packet is a frame of the drive.
    Serial {
        link: DriveLink,
        direction: Direction,
    },
    Can {
        direction: Direction,
        frame: [u8; CAN_FRAME_LEN],
    },
    /// A part of a UDP datagram.
    Fragment(Fragment),
    /// A part of another IP packet.
    OtherFragment,
    Other,
}

/// Looks inside a packet of a link type.
pub(super) fn look_inside(
    link: LinkType,
    direction: Option<Direction>,
    data: &[u8],
) -> Result<Content, Fault> {
    let network = match link {
        LinkType::Ethernet => behind(data, "Ethernet header", 12, 14)?,
        LinkType::Cooked1 => behind(data, "Linux cooked header", 14, 16)?,
        LinkType::Cooked2 => behind(data, "Linux cooked header", 0, 20)?,
        LinkType::Ip => bare(data)?,
        LinkType::Can => return can(data, direction),
        LinkType::Serial(link) => {
            let direction = direction.ok_or(Fault::Undirected)?;
            return Ok(Content::Serial { link, direction });
        }
        LinkType::Unused => return Ok(Content::Other),
    };
    match SlicedPacket::from_ether_type(network.kind, network.packet) {
        Ok(sliced) => Ok(content(&sliced, data)),
        Err(error) => {
            let start = data.len() - network.packet.len();
            by_udp_length(&network, data).ok_or_else(|| fault(error, start))
        }
    }
}

/// What follows the link's own header. VLAN tags are still in front of it.
struct Network<'a> {
    kind: EtherType,
    packet: &'a [u8],
}

/// Behind a header of `header_len` bytes with the EtherType at `at`.
fn behind<'a>(
    data: &'a [u8],
    layer: &'static str,
    at: usize,
    header_len: usize,
) -> Result<Network<'a>, Fault> {
    let kind = data.get(at..).and_then(|bytes| bytes.first_chunk());
    match (kind, data.get(header_len..)) {
        (Some(&kind), Some(packet)) => Ok(Network {
            kind: EtherType(u16::from_be_bytes(kind)),
            packet,
        }),
        _ => Err(short(layer, header_len, data)),
    }
}

/// An IP packet with nothing in front: its first four bits tell the version.
fn bare(packet: &[u8]) -> Result<Network<'_>, Fault> {
    let first = packet
        .first()
        .ok_or_else(|| short("IP header", 20, packet))?;
    let kind = match first >> 4 {
        4 => EtherType::IPV4,
        6 => EtherType::IPV6,
        got => {
            return Err(Fault::Header(format!(
                "IP version: expected 4 or 6, got {got}"
            )));
        }
    };
    Ok(Network { kind, packet })
}

fn short(layer: &str, expected: usize, data: &[u8]) -> Fault {
    Fault::Short {
        layer: layer.to_owned(),
        offset: 0,
        expected,
        got: data.len(),
    }
}

/// What a packet that etherparse has taken apart carries.
fn content(sliced: &SlicedPacket<'_>, data: &[u8]) -> Content {
    let source = match &sliced.net {
        Some(NetSlice::Ipv4(ip)) if ip.is_payload_fragmented() => return fragment(ip, data),
        Some(NetSlice::Ipv6(ip)) if ip.is_payload_fragmented() => return Content::OtherFragment,
        Some(NetSlice::Ipv4(ip)) => ip.header().source(),
        Some(NetSlice::Ipv6(ip)) => source_of(Ipv6Addr::from(ip.header().source()).into()),
        _ => return Content::Other,
    };
    match &sliced.transport {
        Some(TransportSlice::Udp(udp)) => Content::Datagram {
            source,
            port: udp.destination_port(),
            payload: within(data, udp.payload()),
        },
        _ => Content::Other,
    }
}

fn fragment(ip: &Ipv4Slice<'_>, data: &[u8]) -> Content {
    let header = ip.header();
    if header.protocol() != IpNumber::UDP {
        return Content::OtherFragment;
    }
    Content::Fragment(Fragment {
        id: DatagramId {
            source: header.source(),
            destination: header.destination(),
            identification: header.identification(),
        },
        offset: header.fragments_offset(),
        more_fragments: header.more_fragments(),
        payload: within(data, ip.payload().payload),
    })
}

/// Port and payload of a reassembled UDP datagram; the payload counts from its start.
pub(super) fn udp(datagram: &[u8]) -> Result<(u16, Range<usize>), Fault> {
    let udp = UdpSlice::from_slice(datagram).map_err(|error| short_layer(&error, 0))?;
    Ok((udp.destination_port(), within(datagram, udp.payload())))
}

/// Where a part lies in the whole it was sliced from.
fn within(whole: &[u8], part: &[u8]) -> Range<usize> {
    let start = (part.as_ptr() as usize).saturating_sub(whole.as_ptr() as usize);
    start..start.saturating_add(part.len())
}

/// A datagram whose IP header claims more than there is while its UDP length is all there: VLP-16
/// firmware of 2014 gives its position packets the IP length of a data packet. A packet that was
/// cut short does not pass: its UDP length is missing bytes too.
fn by_udp_length(network: &Network<'_>, data: &[u8]) -> Option<Content> {
    let lax = LaxSlicedPacket::from_ether_type(network.kind, network.packet);
    match (&lax.net, &lax.transport) {
        (Some(LaxNetSlice::Ipv4(ip)), Some(TransportSlice::Udp(udp)))
            if usize::from(udp.length()) == udp.payload().len() + UdpHeader::LEN =>
        {
            Some(Content::Datagram {
                source: ip.header().source(),
                port: udp.destination_port(),
                payload: within(data, udp.payload()),
            })
        }
        _ => None,
    }
}

/// A classic CAN frame, filled up to the full structure.
fn can(data: &[u8], direction: Option<Direction>) -> Result<Content, Fault> {
    let Some((head, _)) = data.split_first_chunk::<8>() else {
        return Err(short("CAN frame", 8, data));
    };
    let [id @ .., length, _, _, _] = *head;
    if length > 8 {
        // CAN FD: not the drive's.
        return Ok(Content::Other);
    }
    let used = 8 + usize::from(length);
    let mut frame = [0; CAN_FRAME_LEN];
    match (frame.get_mut(..used), data.get(..used)) {
        (Some(to), Some(from)) => to.copy_from_slice(from),
        _ => return Err(short("CAN frame", used, data)),
    }
    Ok(Content::Can {
        direction: direction.unwrap_or_else(|| direction_of_can(u32::from_be_bytes(id))),
        frame,
    })
}

/// Which way a CANopen message goes, where the recording does not say (candump, Wireshark): by its
/// function code (CiA 301, predefined connection set), seen from the drive: NMT, SYNC, time,
/// RPDO1-4 and SDO requests come to it.
fn direction_of_can(id: u32) -> Direction {
    match id & 0x780 {
        0x080 if id & 0x7F != 0 => Direction::FromDevice,
        0x000 | 0x080 | 0x100 | 0x200 | 0x300 | 0x400 | 0x500 | 0x600 => Direction::ToDevice,
        _ => Direction::FromDevice,
    }
}

/// The fault that etherparse found in a network layer `start` bytes into the packet.
fn fault(error: SliceError, start: usize) -> Fault {
    match error {
        SliceError::Len(error) => short_layer(&error, start),
        other => Fault::Header(other.to_string()),
    }
}

fn short_layer(error: &LenError, start: usize) -> Fault {
    Fault::Short {
        layer: error.layer.to_string(),
        offset: start.saturating_add(error.layer_start_offset),
        expected: error.required_len,
        got: error.len,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canopen_messages_without_a_recorded_direction_go_where_their_function_code_says() {
        use Direction::{FromDevice, ToDevice};
        for (id, expected) in [
            (0x000, ToDevice),   // NMT
            (0x080, ToDevice),   // SYNC
            (0x081, FromDevice), // EMCY of node 1
            (0x181, FromDevice), // TPDO1
            (0x201, ToDevice),   // RPDO1
            (0x581, FromDevice), // SDO answer
            (0x601, ToDevice),   // SDO request
            (0x701, FromDevice), // heartbeat
        ] {
            assert_eq!(direction_of_can(id), expected, "{id:03X}");
        }
    }

    #[test]
    fn a_short_can_frame_is_filled_up_and_an_impossible_one_refused() {
        let head = [0, 0, 6, 1, 2, 0, 0, 0];
        let frame = [&head[..], &[0xAA, 0xBB]].concat();
        let Ok(Content::Can { frame, direction }) = can(&frame, None) else {
            panic!("a CAN frame");
        };
        assert_eq!(
            frame,
            [0, 0, 6, 1, 2, 0, 0, 0, 0xAA, 0xBB, 0, 0, 0, 0, 0, 0]
        );
        assert_eq!(direction, Direction::ToDevice);
        assert!(matches!(
            can(&head, None),
            Err(Fault::Short {
                expected: 10,
                got: 8,
                ..
            })
        ));
        assert!(matches!(
            can(&head[..7], None),
            Err(Fault::Short {
                expected: 8,
                got: 7,
                ..
            })
        ));
    }

    #[test]
    fn user0_is_ours_by_name_only() {
        assert_eq!(
            LinkType::from_number(147, Some(USB_NAME)),
            Some(LinkType::Serial(DriveLink::Usb))
        );
        assert_eq!(LinkType::from_number(147, Some("eth0")), None);
        assert_eq!(LinkType::from_number(147, None), None);
    }
}
