//! Serial requests for other nodes: the drive is alone on its bus.

extern crate std;
use std::vec::Vec;

use protocol::canopen::nmt::{NmtCommand, NmtState};
use protocol::epos2::message::{
    GatewayNmt, InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, RequestCanFrame,
    SegmentedWrite, SendCanFrame, SerialAnswer, WriteObject, WriteSegment,
};
use protocol::epos2::objects;
use protocol::epos2::usb::{UsbDecoder, to_bytes};
use protocol::epos2::{AbortCode, BoundedVec, SerialFrame};

use super::super::{SimulatedDrive, SimulatedDriveConfig, UsbServer};

struct Bench {
    usb: UsbServer,
    near: SimulatedDrive,
}

impl Bench {
    fn new() -> Self {
        Self {
            usb: UsbServer::new(1),
            near: SimulatedDrive::new(SimulatedDriveConfig::default()),
        }
    }

    fn error(&mut self, request: &SerialFrame) -> AbortCode {
        let mut out = Vec::new();
        self.usb
            .input(&mut self.near, &to_bytes(request), &mut |frame: &[u8]| {
                out.extend_from_slice(frame);
            });
        let mut decoder = UsbDecoder::new();
        let mut frames = out.iter().filter_map(|byte| decoder.push(*byte));
        let answer = frames.next().unwrap().unwrap();
        assert!(frames.next().is_none(), "one answer per request");
        SerialAnswer::parse(&answer).unwrap().error
    }
}

#[test]
fn other_nodes_are_a_timeout() {
    let mut bench = Bench::new();
    let address = objects::CONTROLWORD.address;
    let value = 6;
    let mut errors = |node| {
        [
            ReadObject { node, address }.to_frame(),
            WriteObject {
                node,
                address,
                value,
            }
            .to_frame(),
            InitiateSegmentedRead { node, address }.to_frame(),
        ]
        .map(|request| bench.error(&request))
    };
    assert_eq!(errors(0), [AbortCode::NONE; 3]);
    assert_eq!(errors(1), [AbortCode::NONE; 3]);
    assert_eq!(errors(4), [AbortCode::TIMEOUT; 3]);
    assert_eq!(errors(200), [AbortCode::CAN_ID; 3]);
}

#[test]
fn a_long_write_to_another_node_ends_in_a_timeout() {
    let mut bench = Bench::new();
    let address = objects::TARGET_POSITION.address;
    let begin = |node, len| InitiateSegmentedWrite { node, address, len }.to_frame();
    assert_eq!(bench.error(&begin(3, 9)), AbortCode::MEMORY);
    assert_eq!(bench.error(&begin(3, 4)), AbortCode::NONE);
    let segment = |toggle, bytes: &[u8]| {
        let bytes = BoundedVec::from_slice(bytes).unwrap();
        SegmentedWrite(WriteSegment { toggle, bytes }).to_frame()
    };
    assert_eq!(bench.error(&segment(false, &[1, 2, 3])), AbortCode::NONE);
    assert_eq!(bench.error(&segment(true, &[4])), AbortCode::TIMEOUT);
}

#[test]
fn network_management_reaches_the_addressed_node() {
    let mut bench = Bench::new();
    let mut send_nmt = |node, command: NmtCommand| {
        let specifier = u16::from(command.to_u8());
        let error = bench.error(&GatewayNmt { node, specifier }.to_frame());
        assert_eq!(error, AbortCode::NONE);
        bench.near.nmt_state()
    };
    assert_eq!(send_nmt(2, NmtCommand::Start), NmtState::PreOperational);
    assert_eq!(send_nmt(0, NmtCommand::Start), NmtState::Operational);
    assert_eq!(send_nmt(1, NmtCommand::Stop), NmtState::Stopped);
    assert_eq!(send_nmt(300, NmtCommand::Start), NmtState::Stopped);
    assert_eq!(send_nmt(0, NmtCommand::ResetNode), NmtState::PreOperational);
}

#[test]
fn can_frames_are_sent_and_requested() {
    let mut bench = Bench::new();
    let send = |cob_id, len| {
        let data = [0; 8];
        SendCanFrame { cob_id, len, data }.to_frame()
    };
    assert_eq!(bench.error(&send(0, 2)), AbortCode::NONE);
    assert_eq!(bench.error(&send(0x800, 2)), AbortCode::CAN_ID);
    assert_eq!(bench.error(&send(0x100, 9)), AbortCode::LENGTH);
    let request = |cob_id, len| RequestCanFrame { cob_id, len }.to_frame();
    assert_eq!(bench.error(&request(0x704, 1)), AbortCode::TIMEOUT);
    assert_eq!(bench.error(&request(0x702, 9)), AbortCode::LENGTH);
    assert_eq!(bench.error(&request(0x800, 1)), AbortCode::CAN_ID);
}
