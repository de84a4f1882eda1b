//! The serial interfaces against independent bytes: frames in the Communication Guide's format as a
//! real drive and its tools exchange them, with a checksum computed bit by bit.

extern crate std;
use std::vec::Vec;

use protocol::epos2::objects;

use super::super::{Rs232Server, SimulatedDrive, UsbServer};
use super::{command, healthy, set};

/// CRC-16/XMODEM (polynomial 1021, init 0) over bytes in the order given.
fn crc(bytes: &[u8]) -> u16 {
    let mut crc = 0u16;
    for byte in bytes {
        for bit in (0..8).rev() {
            let out = crc >> 15 ^ u16::from(byte >> bit & 1);
            crc = crc << 1 ^ if out == 1 { 0x1021 } else { 0 };
        }
    }
    crc
}

/// The checksum covers words high byte first; on the wire they are low byte first.
fn crc_over_words(header: [u8; 2], data: &[u8]) -> u16 {
    let swapped = data.chunks(2).flat_map(|word| [word[1], word[0]]);
    crc(&header.into_iter().chain(swapped).collect::<Vec<_>>())
}

/// A USB frame without sync and stuffing, its checksum checked.
fn usb_body(frame: &[u8]) -> Vec<u8> {
    assert_eq!(frame[..2], [0x90, 0x02]);
    let mut body = Vec::new();
    let mut rest = frame[2..].iter();
    while let Some(&byte) = rest.next() {
        body.push(byte);
        if byte == 0x90 {
            assert_eq!(rest.next(), Some(&0x90), "every 90 is doubled");
        }
    }
    let (content, sum) = body.split_at(body.len() - 2);
    assert_eq!(content.len(), 2 + 2 * usize::from(content[1]));
    // On USB the checksum covers the length before the opcode.
    let expected = crc_over_words([content[1], content[0]], &content[2..]);
    assert_eq!(sum, expected.to_le_bytes());
    content.to_vec()
}

fn usb(node: &mut SimulatedDrive, request: &[u8]) -> Vec<u8> {
    usb_body(request);
    let mut out = Vec::new();
    UsbServer::new(9).input(node, request, &mut |frame: &[u8]| {
        out.extend_from_slice(frame)
    });
    out
}

#[test]
fn usb_frames_match_golden_bytes() {
    // The frames confirm the order of the checksum.
    for frame in [
        "90020004000000003702000068 00",
        "900200040000020600000000 5764",
        "90020004000000000000909080 1435",
    ] {
        usb_body(&hex(frame));
    }
    let mut node = healthy();
    command(&mut node, 0x06);
    let read = hex("9002 1002 4160 0001 64CF");
    let answer = usb_body(&usb(&mut node, &read));
    assert_eq!(answer[..8], [0x00, 0x04, 0, 0, 0, 0, 0x21, 0x01]);
    let write = hex("9002 1104 4060 0001 0F00 0000 2D2C");
    assert_eq!(usb(&mut node, &write), hex("9002 0002 0000 0000 408B"));
    assert_eq!(
        node.read(objects::CONTROLWORD.address).unwrap().raw(),
        Some(0x0F)
    );
    let read = hex("9002 1002 6460 0001 52A2");
    assert_eq!(
        usb_body(&usb(&mut node, &read)),
        hex("0004 0000 0000 0000 0000")
    );
    // A value with a byte that must be stuffed.
    set(&mut node, objects::HOME_POSITION, 0x8090_0000_u32 as i32);
    let read = hex("9002 1002 8120 0001 0F87");
    assert_eq!(
        usb(&mut node, &read),
        hex("9002 0004 0000 0000 0000 9090 8014 35")
    );
}

#[test]
fn a_two_word_error_matches_golden_bytes() {
    let mut node = healthy();
    // 5000:00 does not exist.
    let request = {
        let data = hex("0050 0001");
        let sum = crc_over_words([2, 0x10], &data).to_le_bytes();
        [hex("9002 1002"), data, sum.to_vec()].concat()
    };
    let mut seen = [0, 0];
    for seed in 0..20 {
        let mut out = Vec::new();
        UsbServer::new(seed).input(&mut node, &request, &mut |frame: &[u8]| {
            out.extend_from_slice(frame);
        });
        let body = usb_body(&out);
        assert_eq!(body[2..6], [0, 0, 2, 6]);
        if body.len() == 6 {
            assert_eq!(out, hex("9002 0002 0000 0206 A401"));
        }
        seen[usize::from(body.len() == 6)] += 1;
    }
    assert!(seen[0] > 0 && seen[1] > 0, "{seen:?}");
}

fn rs232(node: &mut SimulatedDrive, request: &[u8]) -> Vec<u8> {
    let (server, mut out) = (&mut Rs232Server::new(9), Vec::new());
    let mut send = |bytes: &[u8], node: &mut SimulatedDrive| {
        let mut answer = Vec::new();
        server.input(node, bytes, &mut |bytes: &[u8]| {
            answer.extend_from_slice(bytes)
        });
        answer
    };
    // Opcode, handshake, body, handshake, the answer's opcode, handshake, its body, handshake.
    assert_eq!(send(&request[..1], node), b"O");
    assert_eq!(send(&request[1..], node), b"O\0");
    out.extend(send(b"O", node));
    assert_eq!(send(b"O", node), b"");
    let (content, sum) = out.split_at(out.len() - 2);
    assert_eq!(content.len(), 3 + 2 * usize::from(content[0]));
    // On RS232 the checksum covers the opcode, then the length minus one.
    let expected = crc_over_words([0x00, content[0]], &content[1..]);
    assert_eq!(sum, expected.to_le_bytes());
    out
}

#[test]
fn rs232_frames_match_golden_bytes() {
    let known = hex("03 00000000 37020000 1980");
    assert_eq!(
        crc_over_words([0, 3], &known[1..9]).to_le_bytes(),
        known[9..]
    );
    let mut node = healthy();
    command(&mut node, 0x06);
    let answer = rs232(&mut node, &hex("10 01 4160 0001 ABF0"));
    assert_eq!(answer[..7], [3, 0, 0, 0, 0, 0x21, 0x01]);
    let answer = rs232(&mut node, &hex("11 03 4060 0001 0F00 0000 52EF"));
    assert_eq!(answer[..5], [1, 0, 0, 0, 0]);
    assert_eq!(
        node.read(objects::CONTROLWORD.address).unwrap().raw(),
        Some(0x0F)
    );
    // A wrong checksum is refused without effect.
    let mut out = Vec::new();
    let wrong = hex("11 03 4060 0001 0000 0000 52EF");
    Rs232Server::new(9).input(&mut node, &wrong, &mut |bytes: &[u8]| {
        out.extend_from_slice(bytes)
    });
    assert_eq!(out, b"OF");
    assert_eq!(
        node.read(objects::CONTROLWORD.address).unwrap().raw(),
        Some(0x0F)
    );
}

fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<_> = text.chars().filter_map(|c| c.to_digit(16)).collect();
    digits
        .chunks(2)
        .map(|pair| (pair[0] << 4 | pair[1]) as u8)
        .collect()
}
