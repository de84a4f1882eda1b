//! Encoding of the pcapng blocks that a log uses (draft-ietf-opsawg-pcapng), little-endian, and of
//! classic pcap with microseconds (draft-ietf-opsawg-pcap).

use byteorder::{ByteOrder, LittleEndian};
use protocol::record::Direction;

/// Link types as registered at tcpdump.org.
pub(super) const LINKTYPE_ETHERNET: u16 = 1;
/// Private use: one serial frame of the drive per packet.
pub(super) const LINKTYPE_USER0: u16 = 147;
/// A `struct can_frame` with a big-endian id.
pub(super) const LINKTYPE_CAN_SOCKETCAN: u16 = 227;

const SECTION_HEADER: u32 = 0x0A0D_0D0A;
const INTERFACE_DESCRIPTION: u32 = 1;
const ENHANCED_PACKET: u32 = 6;
const BYTE_ORDER_MAGIC: u32 = 0x1A2B_3C4D;

const OPT_COMMENT: u16 = 1;
const SHB_USERAPPL: u16 = 4;
const IF_NAME: u16 = 2;
const IF_DESCRIPTION: u16 = 3;
const IF_TSRESOL: u16 = 9;
const EPB_FLAGS: u16 = 2;
const OPT_END: u16 = 0;

/// Longest value of an option, in bytes.
pub(super) const MAX_OPTION_LEN: usize = u16::MAX as usize;

/// A section header with a comment. The section length is -1 (unspecified).
pub(super) fn section_header(out: &mut Vec<u8>, comment: &str) {
    block(out, SECTION_HEADER, |out| {
        put_u32(out, BYTE_ORDER_MAGIC);
        put_u16(out, 1); // version 1.0
        put_u16(out, 0);
        out.extend([0xFF; 8]);
        if !comment.is_empty() {
            option(out, OPT_COMMENT, comment.as_bytes());
        }
        option(out, SHB_USERAPPL, b"velomotion");
        option(out, OPT_END, &[]);
    });
}

/// An interface with a resolution of nanoseconds.
pub(super) fn interface(out: &mut Vec<u8>, link: u16, name: &str, description: &str) {
    block(out, INTERFACE_DESCRIPTION, |out| {
        put_u16(out, link);
        put_u16(out, 0); // reserved
        put_u32(out, 0); // no snap length
        option(out, IF_NAME, name.as_bytes());
        option(out, IF_DESCRIPTION, description.as_bytes());
        option(out, IF_TSRESOL, &[9]); // 10^-9 s
        option(out, OPT_END, &[]);
    });
}

/// A packet in two parts (headers, payload) at `time_ns` nanoseconds since 1970.
pub(super) fn packet(
    out: &mut Vec<u8>,
    interface: u32,
    time_ns: u64,
    direction: Direction,
    parts: [&[u8]; 2],
) {
    block(out, ENHANCED_PACKET, |out| {
        put_u32(out, interface);
        put_u32(out, (time_ns >> 32) as u32);
        put_u32(out, time_ns as u32);
        // The writer refuses payloads over 64 KiB, so this does not truncate.
        let length = parts.iter().map(|part| part.len()).sum::<usize>() as u32;
        put_u32(out, length);
        put_u32(out, length);
        for part in parts {
            out.extend_from_slice(part);
        }
        pad(out, length as usize);
        let flags: u32 = match direction {
            Direction::FromDrive => 1, // inbound
            Direction::ToDrive => 2,   // outbound
        };
        option(out, EPB_FLAGS, &flags.to_le_bytes());
        option(out, OPT_END, &[]);
    });
}

/// The header of a pcap file of Ethernet packets.
pub(super) fn pcap_header(out: &mut Vec<u8>) {
    put_u32(out, 0xA1B2_C3D4);
    put_u16(out, 2); // version 2.4
    put_u16(out, 4);
    put_u32(out, 0);
    put_u32(out, 0);
    put_u32(out, 0xFFFF); // longest packet
    put_u32(out, LINKTYPE_ETHERNET.into());
}

/// A packet of a pcap file.
pub(super) fn pcap_record(out: &mut Vec<u8>, time_ns: u64, parts: [&[u8]; 2]) {
    let length = parts.iter().map(|part| part.len()).sum::<usize>() as u32;
    // 32 bits of seconds last until 2106.
    put_u32(out, (time_ns / 1_000_000_000) as u32);
    put_u32(out, (time_ns % 1_000_000_000 / 1_000) as u32);
    put_u32(out, length);
    put_u32(out, length);
    for part in parts {
        out.extend_from_slice(part);
    }
}

/// Type, length, body, length.
fn block(out: &mut Vec<u8>, kind: u32, body: impl FnOnce(&mut Vec<u8>)) {
    let start = out.len();
    put_u32(out, kind);
    put_u32(out, 0);
    body(out);
    let length = (out.len() - start + 4) as u32;
    if let Some(field) = out.get_mut(start + 4..start + 8) {
        LittleEndian::write_u32(field, length);
    }
    put_u32(out, length);
}

fn option(out: &mut Vec<u8>, code: u16, value: &[u8]) {
    let value = value.get(..MAX_OPTION_LEN).unwrap_or(value);
    put_u16(out, code);
    put_u16(out, value.len() as u16);
    out.extend_from_slice(value);
    pad(out, value.len());
}

/// Zeros up to the next multiple of four.
fn pad(out: &mut Vec<u8>, length: usize) {
    out.resize(out.len() + length.next_multiple_of(4) - length, 0);
}

fn put_u32(out: &mut Vec<u8>, value: u32) {
    let mut bytes = [0; 4];
    LittleEndian::write_u32(&mut bytes, value);
    out.extend(bytes);
}

fn put_u16(out: &mut Vec<u8>, value: u16) {
    let mut bytes = [0; 2];
    LittleEndian::write_u16(&mut bytes, value);
    out.extend(bytes);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interface_descriptions_are_encoded_exactly() {
        // draft-ietf-opsawg-pcapng, section 4.2
        let mut out = Vec::new();
        interface(&mut out, LINKTYPE_CAN_SOCKETCAN, "can", "EPOS2");
        let expected = [
            &[1, 0, 0, 0, 52, 0, 0, 0][..],
            &[227, 0, 0, 0, 0, 0, 0, 0],
            &[2, 0, 3, 0, b'c', b'a', b'n', 0],
            &[3, 0, 5, 0, b'E', b'P', b'O', b'S', b'2', 0, 0, 0],
            &[9, 0, 1, 0, 9, 0, 0, 0],
            &[0, 0, 0, 0],
            &[52, 0, 0, 0],
        ]
        .concat();
        assert_eq!(out, expected);
    }

    #[test]
    fn packets_are_encoded_exactly() {
        // draft-ietf-opsawg-pcapng, section 4.3
        let mut out = Vec::new();
        packet(
            &mut out,
            1,
            0x0102_0304_0506_0708,
            Direction::ToDrive,
            [&[0xAA], &[0xBB, 0xCC, 0xDD, 0xEE]],
        );
        let expected = [
            &[6, 0, 0, 0, 52, 0, 0, 0][..],
            &[1, 0, 0, 0, 4, 3, 2, 1, 8, 7, 6, 5],
            &[5, 0, 0, 0, 5, 0, 0, 0],
            &[0xAA, 0xBB, 0xCC, 0xDD, 0xEE, 0, 0, 0],
            &[2, 0, 4, 0, 2, 0, 0, 0, 0, 0, 0, 0],
            &[52, 0, 0, 0],
        ]
        .concat();
        assert_eq!(out, expected);
    }
}
