//! From a captured packet to what it carries: link, network and transport headers by etherparse, CAN frames by hand.

use std::ops::Range;

use etherparse::err::packet::SliceError;
use etherparse::{
    EtherType, LaxNetSlice, LaxSlicedPacket, NetSlice, SlicedPacket, TransportSlice, UdpHeader,
};
use protocol::record::{Direction, DriveLink};

use super::Fault;

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
    /// Starts with the IP header.
    Ip,
    /// Four bytes of address family in either byte order, then the IP header.
    Loopback,
    Can,
    /// Our own: the drive's serial frames.
    Serial(DriveLink),
    /// Anything else.
    Unused,
}

impl LinkType {
    /// The link type of a registered number; `name` is the interface's, which tells our use of LINKTYPE_USER0.
    pub(super) fn from_number(number: u32, name: Option<&str>) -> Option<Self> {
        Some(match number {
            0 | 108 => Self::Loopback,
            1 => Self::Ethernet,
            // 12 and 14: what some systems write for 101.
            12 | 14 | 101 | 228 => Self::Ip,
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
    /// UDP over IPv4; `payload` counts from the start of the packet.
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
    /// A part of an IP packet.
    Fragment,
    Other,
}

/// Looks inside a packet of a link type.
pub(super) fn look_inside(
    link: LinkType,
    direction: Option<Direction>,
    data: &[u8],
) -> Result<Content, Fault> {
    let sliced = match link {
        LinkType::Ethernet => SlicedPacket::from_ethernet(data),
        LinkType::Cooked1 => cooked(data, 14, 16)?,
        LinkType::Cooked2 => cooked(data, 0, 20)?,
        LinkType::Ip => SlicedPacket::from_ip(data),
        LinkType::Loopback => match loopback(data)? {
            Some(packet) => SlicedPacket::from_ip(packet),
            None => return Ok(Content::Other),
        },
        LinkType::Can => return can(data, direction),
        LinkType::Serial(link) => {
            let direction = direction.ok_or(Fault::Undirected)?;
            return Ok(Content::Serial { link, direction });
        }
        LinkType::Unused => return Ok(Content::Other),
    };
    let sliced = match sliced {
        Ok(sliced) => sliced,
        Err(error) => return by_udp_length(link, data).ok_or_else(|| fault(error)),
    };
    let Some(NetSlice::Ipv4(ip)) = sliced.net else {
        return Ok(Content::Other);
    };
    if ip.is_payload_fragmented() {
        return Ok(Content::Fragment);
    }
    let Some(TransportSlice::Udp(udp)) = sliced.transport else {
        return Ok(Content::Other);
    };
    Ok(Content::Datagram {
        source: ip.header().source(),
        port: udp.destination_port(),
        payload: within(data, udp.payload()),
    })
}

/// Where a part lies in the whole it was sliced from.
fn within(whole: &[u8], part: &[u8]) -> Range<usize> {
    let start = (part.as_ptr() as usize).saturating_sub(whole.as_ptr() as usize);
    start..start.saturating_add(part.len())
}

/// A datagram whose IP header claims more than there is while its UDP length is all there: VLP-16 firmware of 2014 gives its
/// position packets the IP length of a data packet. A packet that was cut short does not pass: its UDP length is missing bytes too.
fn by_udp_length(link: LinkType, data: &[u8]) -> Option<Content> {
    let lax = match link {
        LinkType::Ethernet => LaxSlicedPacket::from_ethernet(data).ok()?,
        LinkType::Ip => LaxSlicedPacket::from_ip(data).ok()?,
        _ => return None,
    };
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

/// A packet behind a Linux cooked header of `header_len` bytes with the EtherType at `at`.
fn cooked(
    data: &[u8],
    at: usize,
    header_len: usize,
) -> Result<Result<SlicedPacket<'_>, SliceError>, Fault> {
    let protocol = data
        .get(at..at + 2)
        .and_then(|bytes| bytes.first_chunk())
        .map(|&bytes| EtherType(u16::from_be_bytes(bytes)));
    match (protocol, data.get(header_len..)) {
        (Some(protocol), Some(packet)) => Ok(SlicedPacket::from_ether_type(protocol, packet)),
        _ => Err(Fault::Short {
            layer: "Linux cooked header".to_owned(),
            offset: 0,
            expected: header_len,
            got: data.len(),
        }),
    }
}

/// The IPv4 packet behind a loopback header, or `None` for another address family.
fn loopback(data: &[u8]) -> Result<Option<&[u8]>, Fault> {
    let Some((family, packet)) = data.split_first_chunk::<4>() else {
        return Err(Fault::Short {
            layer: "loopback header".to_owned(),
            offset: 0,
            expected: 4,
            got: data.len(),
        });
    };
    // AF_INET is 2 everywhere; its bytes stand in the order of the capturing machine.
    let ipv4 = [2_u32.to_le_bytes(), 2_u32.to_be_bytes()].contains(family);
    Ok(ipv4.then_some(packet))
}

/// A classic CAN frame, filled up to the full structure.
fn can(data: &[u8], direction: Option<Direction>) -> Result<Content, Fault> {
    let short = |expected| Fault::Short {
        layer: "CAN frame".to_owned(),
        offset: 0,
        expected,
        got: data.len(),
    };
    let Some((head, _)) = data.split_first_chunk::<8>() else {
        return Err(short(8));
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
        _ => return Err(short(used)),
    }
    Ok(Content::Can {
        direction: direction.unwrap_or_else(|| direction_of_can(u32::from_be_bytes(id))),
        frame,
    })
}

/// Which way a CANopen message goes, where the recording does not say (candump, Wireshark): by its function code
/// (CiA 301, predefined connection set), seen from the drive: NMT, SYNC, time, RPDO1-4 and SDO requests come to it.
fn direction_of_can(id: u32) -> Direction {
    match id & 0x780 {
        0x080 if id & 0x7F != 0 => Direction::FromDevice,
        0x000 | 0x080 | 0x100 | 0x200 | 0x300 | 0x400 | 0x500 | 0x600 => Direction::ToDevice,
        _ => Direction::FromDevice,
    }
}

fn fault(error: SliceError) -> Fault {
    match error {
        SliceError::Len(e) => Fault::Short {
            layer: e.layer.to_string(),
            offset: e.layer_start_offset,
            expected: e.required_len,
            got: e.len,
        },
        other => Fault::Header(other.to_string()),
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
