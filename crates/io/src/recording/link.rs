//! Parsing of captured packets: link, network and transport headers by etherparse, CAN frames by
//! hand.

use std::net::{Ipv4Addr, Ipv6Addr};
use std::ops::Range;

use etherparse::err::LenError;
use etherparse::err::packet::SliceError;
use etherparse::{
    EtherType, IpNumber, Ipv4Slice, LaxNetSlice, LaxSlicedPacket, NetSlice, SlicedPacket,
    TransportSlice, UdpHeader, UdpSlice,
};
use protocol::record::{Direction, DriveLink};

use super::PacketFault;
use super::reassembly::{DatagramId, Fragment};

/// Bytes of a `struct can_frame`: identifier (big-endian), length, three reserved, eight of data.
pub(super) const CAN_FRAME_LEN: usize = 16;

/// `if_name` of the drive's interface in our logs, over USB.
pub(crate) const USB_NAME: &str = "epos2-usb";
/// `if_name` of the drive's interface in our logs, over RS232.
pub(crate) const RS232_NAME: &str = "epos2-rs232";

/// Supported link types, as registered at tcpdump.org.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LinkType {
    Ethernet,
    /// Linux cooked, version 1: 16 bytes with the protocol in bytes 14 and 15.
    Cooked1,
    /// Linux cooked, version 2: 20 bytes with the protocol in bytes 0 and 1.
    Cooked2,
    /// Raw IP of either version.
    Ip,
    Can,
    /// Serial frames of the drive (private use).
    Serial(DriveLink),
    /// Any other type.
    Unused,
}

impl LinkType {
    /// The link type of a registered number. The interface's `name` identifies our use of
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

/// Content of a packet.
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
    /// A fragment of a UDP datagram.
    Fragment(Fragment),
    /// A fragment of another IP packet.
    OtherFragment,
    Other,
}

/// Parses a packet of a link type.
pub(super) fn parse(
    link: LinkType,
    direction: Option<Direction>,
    data: &[u8],
) -> Result<Content, PacketFault> {
    let network = match link {
        LinkType::Ethernet => after_header(data, "Ethernet header", 12, 14)?,
        LinkType::Cooked1 => after_header(data, "Linux cooked header", 14, 16)?,
        LinkType::Cooked2 => after_header(data, "Linux cooked header", 0, 20)?,
        LinkType::Ip => raw_ip(data)?,
        LinkType::Can => return can(data, direction),
        LinkType::Serial(link) => {
            let direction = direction.ok_or(PacketFault::Undirected)?;
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

/// The packet after the link header, with its VLAN tags.
struct NetworkPacket<'a> {
    kind: EtherType,
    packet: &'a [u8],
}

/// The packet after a header of `header_len` bytes with the EtherType at `type_offset`.
fn after_header<'a>(
    data: &'a [u8],
    layer: &'static str,
    type_offset: usize,
    header_len: usize,
) -> Result<NetworkPacket<'a>, PacketFault> {
    let kind = data
        .get(type_offset..)
        .and_then(|bytes| bytes.first_chunk());
    match (kind, data.get(header_len..)) {
        (Some(&kind), Some(packet)) => Ok(NetworkPacket {
            kind: EtherType(u16::from_be_bytes(kind)),
            packet,
        }),
        _ => Err(short(layer, header_len, data)),
    }
}

/// A raw IP packet, whose first four bits are the version.
fn raw_ip(packet: &[u8]) -> Result<NetworkPacket<'_>, PacketFault> {
    let first = packet
        .first()
        .ok_or_else(|| short("IP header", 20, packet))?;
    let kind = match first >> 4 {
        4 => EtherType::IPV4,
        6 => EtherType::IPV6,
        got => {
            return Err(PacketFault::Header(format!(
                "IP version: expected 4 or 6, got {got}"
            )));
        }
    };
    Ok(NetworkPacket { kind, packet })
}

fn short(layer: &str, expected: usize, data: &[u8]) -> PacketFault {
    PacketFault::Short {
        layer: layer.to_owned(),
        offset: 0,
        expected,
        got: data.len(),
    }
}

/// The content of a packet parsed by etherparse.
fn content(sliced: &SlicedPacket<'_>, data: &[u8]) -> Content {
    let source = match &sliced.net {
        Some(NetSlice::Ipv4(ip)) if ip.is_payload_fragmented() => return fragment(ip, data),
        Some(NetSlice::Ipv6(ip)) if ip.is_payload_fragmented() => return Content::OtherFragment,
        Some(NetSlice::Ipv4(ip)) => ip.header().source(),
        Some(NetSlice::Ipv6(ip)) => source_of(ip.header().source().into()),
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

/// The source of a record for an IPv6 address.
///
/// Lidars of this family use IPv4. A mapped address (`::ffff:a.b.c.d`) gives its IPv4 address.
/// Others, of relays, give 28 bits of their FNV-1a hash within 240.0.0.0/4, which RFC 1112
/// reserves.
pub(super) fn source_of(address: Ipv6Addr) -> [u8; 4] {
    match address.to_ipv4_mapped() {
        Some(v4) => v4.octets(),
        None => {
            let hash = address
                .octets()
                .iter()
                .fold(0x811C_9DC5_u32, |hash, &byte| {
                    (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
                });
            Ipv4Addr::from_bits(0xF000_0000 | (hash >> 4)).octets()
        }
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
pub(super) fn udp(datagram: &[u8]) -> Result<(u16, Range<usize>), PacketFault> {
    let udp = UdpSlice::from_slice(datagram).map_err(|error| short_layer(&error, 0))?;
    Ok((udp.destination_port(), within(datagram, udp.payload())))
}

/// The range of a part within the slice that it comes from.
fn within(whole: &[u8], part: &[u8]) -> Range<usize> {
    let start = (part.as_ptr() as usize).saturating_sub(whole.as_ptr() as usize);
    start..start.saturating_add(part.len())
}

/// A datagram whose IP length is too large and whose UDP length is correct: VLP-16 firmware of 2014
/// sends position packets with the IP length of a data packet. A truncated packet does not qualify,
/// since its UDP length is too large as well.
fn by_udp_length(network: &NetworkPacket<'_>, data: &[u8]) -> Option<Content> {
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

/// A classic CAN frame, padded to the full structure.
fn can(data: &[u8], direction: Option<Direction>) -> Result<Content, PacketFault> {
    let Some((head, _)) = data.split_first_chunk::<8>() else {
        return Err(short("CAN frame", 8, data));
    };
    let [id @ .., length, _, _, _] = *head;
    if length > 8 {
        // CAN FD, which the drive does not use.
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

/// Direction of a CANopen message in a recording without directions (candump, Wireshark), by its
/// function code (CiA 301, predefined connection set): NMT, SYNC, TIME, RPDO1-4 and SDO requests go
/// to the drive.
fn direction_of_can(id: u32) -> Direction {
    match id & 0x780 {
        0x080 if id & 0x7F != 0 => Direction::FromDrive,
        0x000 | 0x080 | 0x100 | 0x200 | 0x300 | 0x400 | 0x500 | 0x600 => Direction::ToDrive,
        _ => Direction::FromDrive,
    }
}

/// The fault that etherparse found in a network layer `start` bytes into the packet.
fn fault(error: SliceError, start: usize) -> PacketFault {
    match error {
        SliceError::Len(error) => short_layer(&error, start),
        other => PacketFault::Header(other.to_string()),
    }
}

fn short_layer(error: &LenError, start: usize) -> PacketFault {
    PacketFault::Short {
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
    fn the_direction_of_can_messages_follows_from_the_function_code() {
        use Direction::{FromDrive, ToDrive};
        for (id, expected) in [
            (0x000, ToDrive),   // NMT
            (0x080, ToDrive),   // SYNC
            (0x081, FromDrive), // EMCY of node 1
            (0x181, FromDrive), // TPDO1
            (0x201, ToDrive),   // RPDO1
            (0x581, FromDrive), // SDO answer
            (0x601, ToDrive),   // SDO request
            (0x701, FromDrive), // heartbeat
        ] {
            assert_eq!(direction_of_can(id), expected, "{id:03X}");
        }
    }

    #[test]
    fn short_can_frames_are_padded_and_invalid_ones_refused() {
        let head = [0, 0, 6, 1, 2, 0, 0, 0];
        let frame = [&head[..], &[0xAA, 0xBB]].concat();
        let Ok(Content::Can { frame, direction }) = can(&frame, None) else {
            panic!("a CAN frame");
        };
        assert_eq!(
            frame,
            [0, 0, 6, 1, 2, 0, 0, 0, 0xAA, 0xBB, 0, 0, 0, 0, 0, 0]
        );
        assert_eq!(direction, Direction::ToDrive);
        assert!(matches!(
            can(&head, None),
            Err(PacketFault::Short {
                expected: 10,
                got: 8,
                ..
            })
        ));
        assert!(matches!(
            can(&head[..7], None),
            Err(PacketFault::Short {
                expected: 8,
                got: 7,
                ..
            })
        ));
    }

    #[test]
    fn user0_is_recognised_by_interface_name() {
        assert_eq!(
            LinkType::from_number(147, Some(USB_NAME)),
            Some(LinkType::Serial(DriveLink::Usb))
        );
        assert_eq!(LinkType::from_number(147, Some("eth0")), None);
        assert_eq!(LinkType::from_number(147, None), None);
    }

    #[test]
    fn ipv6_sources_are_reserved_addresses() {
        let of = |text: &str| source_of(text.parse().unwrap());
        assert_eq!(of("::ffff:192.168.1.201"), [192, 168, 1, 201]);
        let sources = ["fe80::1", "fe80::2", "2001:db8::1", "::"].map(of);
        for (n, source) in sources.iter().enumerate() {
            assert_eq!(source[0] >> 4, 15, "class E");
            assert!(!sources[..n].contains(source));
        }
    }
}
