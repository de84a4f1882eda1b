//! The USB interface: frames in, frames out.

extern crate std;
use std::vec::Vec;

use proptest::prelude::*;
use protocol::canopen::nmt::NmtCommand;
use protocol::epos2::message::{
    GatewayNmt, InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, RequestCanFrame,
    SegmentedRead, SegmentedWrite, SendCanFrame, SerialAnswer, WriteObject, WriteSegment,
};
use protocol::epos2::objects::{self, Address};
use protocol::epos2::usb::{UsbDecoder, to_bytes};
use protocol::epos2::{AbortCode, BoundedVec, DeviceError, SerialFrame};

use super::super::{SimulatedDrive, SimulatedDriveConfig};
use super::UsbServer;

fn node() -> SimulatedDrive {
    SimulatedDrive::new(SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        ..SimulatedDriveConfig::default()
    })
}

fn send(server: &mut UsbServer, node: &mut SimulatedDrive, bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut out = Vec::new();
    server.input(node, bytes, &mut |frame: &[u8]| out.push(frame.to_vec()));
    out
}

fn decode(bytes: &[u8]) -> SerialFrame {
    let mut decoder = UsbDecoder::new();
    let mut frames: Vec<_> = bytes
        .iter()
        .filter_map(|&byte| decoder.push(byte))
        .collect();
    assert_eq!(frames.len(), 1, "each answer is one frame");
    frames.remove(0).unwrap()
}

/// Sends a request and returns its only answer.
fn exchange(
    server: &mut UsbServer,
    node: &mut SimulatedDrive,
    request: &SerialFrame,
) -> SerialFrame {
    let answers = send(server, node, &to_bytes(request));
    assert_eq!(answers.len(), 1);
    decode(&answers[0])
}

fn read(id: u8, address: Address) -> SerialFrame {
    ReadObject { node: id, address }.to_frame()
}

fn refusal(frame: &SerialFrame) -> AbortCode {
    let answer = SerialAnswer::parse(frame).unwrap();
    assert!(
        matches!(answer.data.len(), 0 | 2),
        "errors have two words or four"
    );
    answer.error
}

#[test]
fn short_values_are_padded_with_garbage() {
    let (mut server, mut node) = (UsbServer::new(1), node());
    let mut above = Vec::new();
    for _ in 0..20 {
        let answer = exchange(
            &mut server,
            &mut node,
            &read(1, objects::STATUSWORD.address),
        );
        let raw = ReadObject::parse_answer(&answer).unwrap().unwrap();
        assert_eq!(objects::STATUSWORD.decode(raw), 0x0140);
        above.push(raw >> 16);
        let answer = exchange(
            &mut server,
            &mut node,
            &read(1, objects::POSITION_ACTUAL.address),
        );
        assert_eq!(ReadObject::parse_answer(&answer), Ok(Ok(0)));
    }
    above.dedup();
    assert!(above.len() > 15, "the garbage does not vary");
}

#[test]
fn equal_seeds_give_equal_bytes_and_different_seeds_different_ones() {
    let run = |seed| {
        let (mut server, mut node) = (UsbServer::new(seed), node());
        (0..10)
            .map(|_| {
                send(
                    &mut server,
                    &mut node,
                    &to_bytes(&read(1, objects::STATUSWORD.address)),
                )
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(run(5), run(5));
    assert_ne!(run(5), run(6));
}

#[test]
fn error_codes_are_sent_in_two_words_or_four() {
    let (mut server, mut node) = (UsbServer::new(2), node());
    let missing = read(1, Address::new(0x5000, 0));
    let lengths: Vec<_> = (0..20)
        .map(|_| exchange(&mut server, &mut node, &missing).words.len())
        .collect();
    assert!(lengths.contains(&2) && lengths.contains(&4));
    let write = |address, value| {
        WriteObject {
            node: 1,
            address,
            value,
        }
        .to_frame()
    };
    for (request, code) in [
        (missing, AbortCode::NO_OBJECT),
        (read(1, Address::new(0x6041, 9)), AbortCode::NO_SUB),
        (read(1, objects::DEVICE_NAME), AbortCode::TOO_LONG),
        (read(1, objects::SERIAL_NUMBER_64), AbortCode::TOO_LONG),
        (read(2, objects::STATUSWORD.address), AbortCode::TIMEOUT),
        (write(objects::STATUSWORD.address, 0), AbortCode::READ_ONLY),
        (
            write(objects::MAX_PROFILE_VELOCITY.address, 25_001),
            AbortCode::TOO_HIGH,
        ),
        (
            SerialFrame::new(0x60, &[1, 2]).unwrap(),
            AbortCode::ILLEGAL_COMMAND,
        ),
        (
            SerialFrame::new(0x10, &[1, 2, 3]).unwrap(),
            AbortCode::LENGTH,
        ),
        (
            SegmentedRead { toggle: false }.to_frame(),
            AbortCode::COMMAND,
        ),
        (
            RequestCanFrame {
                cob_id: 0x701,
                len: 1,
            }
            .to_frame(),
            AbortCode::TIMEOUT,
        ),
    ] {
        assert_eq!(
            refusal(&exchange(&mut server, &mut node, &request)),
            code,
            "{request:?}"
        );
    }
}

#[test]
fn a_damaged_request_gets_a_crc_error_and_is_not_executed() {
    let (mut server, mut node) = (UsbServer::new(3), node());
    let request = WriteObject {
        node: 1,
        address: objects::PROFILE_VELOCITY.address,
        value: 77,
    };
    let mut bytes = to_bytes(&request.to_frame()).to_vec();
    bytes[8] ^= 1;
    let answers = send(&mut server, &mut node, &bytes);
    assert_eq!(refusal(&decode(&answers[0])), AbortCode::CRC);
    assert_eq!(
        node.read(objects::PROFILE_VELOCITY.address).unwrap().raw(),
        Some(1000)
    );
}

#[test]
fn node_0_and_the_units_own_id_address_the_unit() {
    let (mut server, mut node) = (UsbServer::new(4), node());
    for id in [0, 1] {
        let request = WriteObject {
            node: id,
            address: objects::PROFILE_VELOCITY.address,
            value: u32::from(id) + 5,
        };
        let answer = exchange(&mut server, &mut node, &request.to_frame());
        assert_eq!(WriteObject::parse_answer(&answer), Ok(Ok(())));
        assert_eq!(
            node.read(objects::PROFILE_VELOCITY.address).unwrap().raw(),
            Some(u32::from(id) + 5)
        );
    }
}

#[test]
fn the_device_name_is_read_in_a_segment() {
    let (mut server, mut node) = (UsbServer::new(5), node());
    let begin = InitiateSegmentedRead {
        node: 1,
        address: objects::DEVICE_NAME,
    }
    .to_frame();
    let answer = exchange(&mut server, &mut node, &begin);
    assert_eq!(refusal(&answer), AbortCode::NONE);
    let segment = exchange(
        &mut server,
        &mut node,
        &SegmentedRead { toggle: false }.to_frame(),
    );
    let segment = SegmentedRead::parse_answer(&segment).unwrap().unwrap();
    assert_eq!(
        (segment.bytes.as_slice(), segment.more),
        (&b"EPOS2"[..], false)
    );
    exchange(&mut server, &mut node, &begin);
    let wrong = exchange(
        &mut server,
        &mut node,
        &SegmentedRead { toggle: true }.to_frame(),
    );
    assert_eq!(refusal(&wrong), AbortCode::TOGGLE);
}

#[test]
fn a_number_is_written_in_segments() {
    let (mut server, mut node) = (UsbServer::new(6), node());
    let address = objects::TARGET_POSITION.address;
    let begin = |len| {
        InitiateSegmentedWrite {
            node: 1,
            address,
            len,
        }
        .to_frame()
    };
    assert_eq!(
        refusal(&exchange(&mut server, &mut node, &begin(5))),
        AbortCode::TOO_LONG
    );
    assert_eq!(
        refusal(&exchange(&mut server, &mut node, &begin(3))),
        AbortCode::TOO_SHORT
    );
    let segment = |toggle, bytes: &[u8]| {
        SegmentedWrite(WriteSegment {
            toggle,
            bytes: BoundedVec::from_slice(bytes).unwrap(),
        })
        .to_frame()
    };
    exchange(&mut server, &mut node, &begin(4));
    let first = exchange(&mut server, &mut node, &segment(false, &[0x78, 0x56]));
    assert_eq!(SegmentedWrite::parse_answer(&first), Ok(Ok(false)));
    let last = exchange(&mut server, &mut node, &segment(true, &[0x34, 0x12]));
    assert_eq!(SegmentedWrite::parse_answer(&last), Ok(Ok(true)));
    assert_eq!(node.read(address).unwrap().raw(), Some(0x1234_5678));
    exchange(&mut server, &mut node, &begin(4));
    assert_eq!(
        refusal(&exchange(&mut server, &mut node, &segment(true, &[1]))),
        AbortCode::TOGGLE
    );
    exchange(&mut server, &mut node, &begin(4));
    assert_eq!(
        refusal(&exchange(&mut server, &mut node, &segment(false, &[1; 5]))),
        AbortCode::TOO_LONG
    );
}

#[test]
fn network_management_and_can_frames_are_answered_on_usb() {
    let (mut server, mut node) = (UsbServer::new(7), node());
    let start = GatewayNmt {
        node: 0,
        specifier: NmtCommand::Start.to_u8().into(),
    }
    .to_frame();
    assert_eq!(
        refusal(&exchange(&mut server, &mut node, &start)),
        AbortCode::NONE
    );
    assert_eq!(
        node.read(objects::STATUSWORD.address).unwrap().raw(),
        Some(0x0340)
    );
    let other = GatewayNmt {
        node: 9,
        specifier: NmtCommand::Stop.to_u8().into(),
    }
    .to_frame();
    exchange(&mut server, &mut node, &other);
    assert_eq!(
        node.read(objects::STATUSWORD.address).unwrap().raw(),
        Some(0x0340)
    );
    let frame = SendCanFrame {
        cob_id: 0x80,
        len: 0,
        data: [0; 8],
    }
    .to_frame();
    assert_eq!(
        refusal(&exchange(&mut server, &mut node, &frame)),
        AbortCode::NONE
    );
}

#[test]
fn frames_may_arrive_byte_by_byte_within_the_timeout() {
    let (mut server, mut node) = (UsbServer::new(8), node());
    let bytes = to_bytes(&read(1, objects::POSITION_ACTUAL.address));
    let mut answers = Vec::new();
    for &byte in bytes.iter() {
        for _ in 0..100 {
            node.tick();
        }
        answers.extend(send(&mut server, &mut node, &[byte]));
    }
    assert_eq!(answers.len(), 1);
    let (head, tail) = bytes.split_at(5);
    assert!(send(&mut server, &mut node, head).is_empty());
    for _ in 0..600 {
        node.tick();
    }
    assert!(
        send(&mut server, &mut node, tail).is_empty(),
        "forgotten after 475 ms"
    );
    assert_eq!(send(&mut server, &mut node, &bytes).len(), 1);
}

proptest! {
    #[test]
    fn requests_are_answered_after_arbitrary_bytes(
        seed: u64,
        junk in prop::collection::vec(prop_oneof![2 => any::<u8>(), 1 => Just(0x90), 1 => Just(0x02), 1 => Just(0x11)], 0..300),
        words in prop::collection::vec(any::<u16>(), 0..8),
        opcode in 0u8..0x24,
    ) {
        let (mut server, mut node) = (UsbServer::new(seed), node());
        for answer in send(&mut server, &mut node, &junk) {
            decode(&answer);
        }
        for answer in send(&mut server, &mut node, &to_bytes(&SerialFrame::new(opcode, &words).unwrap())) {
            decode(&answer);
        }
        node.tick();
        let own = node.node_id();
        let request = to_bytes(&read(own, objects::STATUSWORD.address));
        send(&mut server, &mut node, &request);
        let answers = send(&mut server, &mut node, &request);
        prop_assert!(ReadObject::parse_answer(&decode(answers.last().unwrap())).unwrap().is_ok());
    }
}
