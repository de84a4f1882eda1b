//! The RS232 interface: handshake, golden bytes, damage.

extern crate std;
use std::vec::Vec;

use proptest::prelude::*;
use protocol::canopen::nmt::NmtCommand;
use protocol::epos2::message::{GatewayNmt, ReadObject, WriteObject};
use protocol::epos2::rs232::{BodyDecoder, encode_body};
use protocol::epos2::{DeviceError, SerialFrame, objects};

use super::super::{SimulatedDrive, SimulatedDriveConfig};
use super::Rs232Server;

fn node() -> SimulatedDrive {
    SimulatedDrive::new(SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        ..SimulatedDriveConfig::default()
    })
}

fn send(server: &mut Rs232Server, node: &mut SimulatedDrive, bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    server.input(node, bytes, &mut |bytes: &[u8]| {
        out.extend_from_slice(bytes)
    });
    out
}

/// The master's side of one exchange.
fn exchange(
    server: &mut Rs232Server,
    node: &mut SimulatedDrive,
    request: &SerialFrame,
) -> SerialFrame {
    assert_eq!(send(server, node, &[request.opcode]), b"O");
    let mut body = Vec::new();
    encode_body(request, &mut body).unwrap();
    assert_eq!(send(server, node, &body), b"O\0");
    let answer = send(server, node, b"O");
    let mut decoder = BodyDecoder::new(0);
    let mut frames: Vec<_> = answer
        .into_iter()
        .filter_map(|byte| decoder.push(byte))
        .collect();
    assert_eq!(send(server, node, b"O"), b"");
    frames.remove(0).unwrap()
}

/// 2005 is 500 ms from the factory.
#[test]
fn half_a_telegram_is_dropped_after_the_frame_timeout() {
    let read = [0x01, 0x41, 0x60, 0x00, 0x01, 0xAB, 0xF0];
    for (pause_ms, dropped) in [(499, false), (500, false), (501, true)] {
        let (mut server, mut node) = (Rs232Server::new(1), node());
        assert_eq!(send(&mut server, &mut node, &[0x10]), b"O");
        assert_eq!(send(&mut server, &mut node, &read[..3]), b"");
        for _ in 0..pause_ms {
            node.tick();
        }
        if dropped {
            // The next byte is an opcode.
            assert_eq!(send(&mut server, &mut node, &[0x10]), b"O");
            assert_eq!(send(&mut server, &mut node, &read), b"O\0");
        } else {
            assert_eq!(send(&mut server, &mut node, &read[3..]), b"O\0");
        }
    }
}

#[test]
fn an_exchange_matches_golden_bytes() {
    // Read of 6041 of node 1.
    let (mut server, mut node) = (Rs232Server::new(1), node());
    assert_eq!(send(&mut server, &mut node, &[0x10]), b"O");
    assert_eq!(
        send(
            &mut server,
            &mut node,
            &[0x01, 0x41, 0x60, 0x00, 0x01, 0xAB, 0xF0]
        ),
        b"O\0"
    );
    let answer = send(&mut server, &mut node, b"O");
    assert_eq!(answer.len(), 1 + 8 + 2);
    assert_eq!(answer[..7], [3, 0, 0, 0, 0, 0x40, 0x01]);
    assert_eq!(send(&mut server, &mut node, b"O"), b"");
}

#[test]
fn exchanges_follow_each_other() {
    let (mut server, mut node) = (Rs232Server::new(2), node());
    let address = objects::TARGET_POSITION.address;
    for value in [5, 0xFFFF_FF90, 0x9090_9090] {
        let write = WriteObject {
            node: 1,
            address,
            value,
        }
        .to_frame();
        assert_eq!(
            WriteObject::parse_answer(&exchange(&mut server, &mut node, &write)),
            Ok(Ok(()))
        );
        let read = ReadObject { node: 1, address }.to_frame();
        assert_eq!(
            ReadObject::parse_answer(&exchange(&mut server, &mut node, &read)),
            Ok(Ok(value))
        );
    }
}

#[test]
fn unknown_opcodes_and_damaged_bodies_are_refused() {
    let (mut server, mut node) = (Rs232Server::new(3), node());
    assert_eq!(send(&mut server, &mut node, &[0x60]), b"F");
    assert_eq!(send(&mut server, &mut node, &[0x10]), b"O");
    assert_eq!(
        send(
            &mut server,
            &mut node,
            &[0x01, 0x41, 0x60, 0x00, 0x01, 0xAB, 0xF1]
        ),
        b"F"
    );
    let read = ReadObject {
        node: 1,
        address: objects::STATUSWORD.address,
    }
    .to_frame();
    exchange(&mut server, &mut node, &read);
}

#[test]
fn network_management_has_no_answer() {
    let (mut server, mut node) = (Rs232Server::new(4), node());
    let request = GatewayNmt {
        node: 1,
        specifier: NmtCommand::Start.to_u8().into(),
    }
    .to_frame();
    assert_eq!(send(&mut server, &mut node, &[request.opcode]), b"O");
    let mut body = Vec::new();
    encode_body(&request, &mut body).unwrap();
    assert_eq!(send(&mut server, &mut node, &body), b"O");
    assert_eq!(
        node.read(objects::STATUSWORD.address).unwrap().raw(),
        Some(0x0340)
    );
    let read = ReadObject {
        node: 1,
        address: objects::STATUSWORD.address,
    }
    .to_frame();
    exchange(&mut server, &mut node, &read);
}

#[test]
fn silence_ends_a_pending_exchange() {
    let (mut server, mut node) = (Rs232Server::new(5), node());
    assert_eq!(send(&mut server, &mut node, &[0x10, 0x01, 0x41]), b"O");
    for _ in 0..501 {
        node.tick();
    }
    let read = ReadObject {
        node: 1,
        address: objects::STATUSWORD.address,
    }
    .to_frame();
    exchange(&mut server, &mut node, &read);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn the_server_recovers_from_arbitrary_bytes_after_silence(
        junk in prop::collection::vec(prop_oneof![2 => any::<u8>(), 1 => 0x0Eu8..0x22, 1 => Just(b'O')], 0..300),
    ) {
        let (mut server, mut node) = (Rs232Server::new(6), node());
        send(&mut server, &mut node, &junk);
        // The random bytes may have written the timeout, which is at most 65.5 s.
        for _ in 0..66_000 {
            node.tick();
        }
        let request = ReadObject { node: 0, address: objects::STATUSWORD.address }.to_frame();
        prop_assert!(ReadObject::parse_answer(&exchange(&mut server, &mut node, &request)).unwrap().is_ok());
    }
}
