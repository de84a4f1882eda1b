//! Serial requests for other nodes, through the unit to a second one on its bus.

extern crate std;
use std::vec::Vec;

use protocol::canopen::nmt::{NmtCommand, NmtState};
use protocol::epos2::message::{
    GatewayNmt, InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, RequestCanFrame,
    SegmentedRead, SegmentedWrite, SendCanFrame, SerialAnswer, WriteObject, WriteSegment,
};
use protocol::epos2::objects::{self, Address};
use protocol::epos2::rs232::encode_body;
use protocol::epos2::usb::{UsbDecoder, to_bytes};
use protocol::epos2::{Bounded, CommError, DeviceError, SerialFrame};

use super::super::{CanServer, Neighbour, Node, NodeConfig, Rs232Server, UsbServer};

struct Bench {
    usb: UsbServer,
    near: Node,
    far: [Node; 2],
    servers: [CanServer; 2],
}

fn node(node_id: u8) -> Node {
    Node::new(NodeConfig {
        node_id,
        fault_at_power_on: DeviceError::NONE,
        ..NodeConfig::default()
    })
}

impl Bench {
    /// The unit at the wire is node 1; nodes 2 and 3 are behind it.
    fn new() -> Self {
        Self {
            usb: UsbServer::new(1),
            near: node(1),
            far: [node(2), node(3)],
            servers: [CanServer::new(), CanServer::new()],
        }
    }

    fn ask(&mut self, request: &SerialFrame) -> SerialFrame {
        let [a, b] = &mut self.far;
        let [sa, sb] = &mut self.servers;
        let mut bus = (
            Neighbour {
                node: a,
                server: sa,
            },
            Neighbour {
                node: b,
                server: sb,
            },
        );
        let mut out = Vec::new();
        self.usb.input_with_bus(
            &mut self.near,
            &mut bus,
            &to_bytes(request),
            &mut |frame: &[u8]| {
                out.extend_from_slice(frame);
            },
        );
        let mut decoder = UsbDecoder::new();
        let mut frames = out.iter().filter_map(|byte| decoder.push(*byte));
        let answer = frames.next().unwrap().unwrap();
        assert!(frames.next().is_none(), "one answer a request");
        answer
    }

    fn read(&mut self, node: u8, address: Address) -> Result<u32, CommError> {
        ReadObject::parse_answer(&self.ask(&ReadObject { node, address }.to_frame())).unwrap()
    }

    fn write(&mut self, node: u8, address: Address, value: u32) -> Result<(), CommError> {
        let request = WriteObject {
            node,
            address,
            value,
        };
        WriteObject::parse_answer(&self.ask(&request.to_frame())).unwrap()
    }

    fn error(&mut self, request: &SerialFrame) -> CommError {
        SerialAnswer::parse(&self.ask(request)).unwrap().error
    }
}

#[test]
fn objects_of_other_nodes_are_read_and_written() {
    let mut bench = Bench::new();
    let speed = objects::PROFILE_VELOCITY.address;
    for id in [1, 2, 3] {
        assert_eq!(bench.write(id, speed, 100 * u32::from(id)), Ok(()));
    }
    for id in [3, 2, 1] {
        assert_eq!(bench.read(id, speed), Ok(100 * u32::from(id)));
        let own = bench.read(id, objects::NODE_ID.address).unwrap();
        assert_eq!(objects::NODE_ID.decode(own), id, "garbage above");
    }
    // Of another width, and signed.
    assert_eq!(
        bench.write(2, objects::CONTROLWORD.address, 0xDEAD_0006),
        Ok(())
    );
    assert_eq!(
        bench.write(3, objects::HOMING_METHOD.address, 0xFFFF_FFFD),
        Ok(())
    );
    let method = bench.read(3, objects::HOMING_METHOD.address).unwrap();
    assert_eq!(objects::HOMING_METHOD.decode(method), -3);
    let word = bench.read(2, objects::STATUSWORD.address).unwrap();
    assert_eq!(objects::STATUSWORD.decode(word), 0x0121);
    let word = bench.read(1, objects::STATUSWORD.address).unwrap();
    assert_eq!(objects::STATUSWORD.decode(word), 0x0140);
}

#[test]
fn refusals_of_the_other_node_come_through_and_silence_is_a_timeout() {
    let mut bench = Bench::new();
    assert_eq!(
        bench.read(2, Address::new(0x5000, 0)),
        Err(CommError::NO_OBJECT)
    );
    assert_eq!(
        bench.write(2, objects::STATUSWORD.address, 0),
        Err(CommError::READ_ONLY)
    );
    assert_eq!(
        bench.write(2, objects::MAX_PROFILE_VELOCITY.address, 25_001),
        Err(CommError::TOO_HIGH)
    );
    assert_eq!(
        bench.read(4, objects::STATUSWORD.address),
        Err(CommError::TIMEOUT)
    );
    assert_eq!(
        bench.write(4, objects::CONTROLWORD.address, 6),
        Err(CommError::TIMEOUT)
    );
    assert_eq!(
        bench.read(200, objects::STATUSWORD.address),
        Err(CommError::CAN_ID)
    );
    // A stopped node has no SDO.
    bench.far[0].nmt(NmtCommand::Stop);
    assert_eq!(
        bench.read(2, objects::STATUSWORD.address),
        Err(CommError::TIMEOUT)
    );
}

#[test]
fn long_objects_of_other_nodes_come_in_segments() {
    let mut bench = Bench::new();
    for (address, expected) in [
        (objects::DEVICE_NAME, b"EPOS2".as_slice()),
        (
            objects::SERIAL_NUMBER_64,
            &[1, 0, 0, 0, 0x55, 0x4D, 0x49, 0x53],
        ),
    ] {
        assert_eq!(bench.read(3, address), Err(CommError::TOO_LONG));
        let begin = InitiateSegmentedRead { node: 3, address }.to_frame();
        assert_eq!(bench.error(&begin), CommError::NONE);
        let answer = bench.ask(&SegmentedRead { toggle: false }.to_frame());
        let segment = SegmentedRead::parse_answer(&answer).unwrap().unwrap();
        assert_eq!((segment.bytes.as_slice(), segment.more), (expected, false));
    }
    let address = objects::TARGET_POSITION.address;
    let begin = |node, len| InitiateSegmentedWrite { node, address, len }.to_frame();
    assert_eq!(bench.error(&begin(3, 9)), CommError::MEMORY);
    assert_eq!(bench.error(&begin(3, 4)), CommError::NONE);
    let segment = |toggle, bytes: &[u8]| {
        let bytes = Bounded::from_slice(bytes).unwrap();
        SegmentedWrite(WriteSegment { toggle, bytes }).to_frame()
    };
    assert_eq!(bench.error(&segment(false, &[1, 2, 3])), CommError::NONE);
    assert_eq!(bench.error(&segment(true, &[4])), CommError::NONE);
    assert_eq!(bench.read(3, address), Ok(0x0403_0201));
    assert_eq!(bench.read(1, address), Ok(0));
}

#[test]
fn network_management_reaches_whom_it_names() {
    let mut bench = Bench::new();
    let mut tell = |node, command: NmtCommand| {
        assert_eq!(
            bench.error(
                &GatewayNmt {
                    node,
                    specifier: u16::from(command.to_u8())
                }
                .to_frame()
            ),
            CommError::NONE
        );
        let [a, b] = &bench.far;
        [bench.near.nmt_state(), a.nmt_state(), b.nmt_state()]
    };
    use NmtState::{Operational as Op, PreOperational as Pre, Stopped as Stop};
    assert_eq!(tell(2, NmtCommand::Start), [Pre, Op, Pre]);
    assert_eq!(tell(0, NmtCommand::Start), [Op, Op, Op]);
    assert_eq!(tell(1, NmtCommand::Stop), [Stop, Op, Op]);
    assert_eq!(tell(300, NmtCommand::Stop), [Stop, Op, Op]);
    assert_eq!(tell(0, NmtCommand::ResetNode), [Pre, Pre, Pre]);
}

#[test]
fn can_frames_are_sent_and_asked_for() {
    let mut bench = Bench::new();
    let send = |cob_id, len, data| SendCanFrame { cob_id, len, data }.to_frame();
    assert_eq!(
        bench.error(&send(0, 2, [1, 2, 0, 0, 0, 0, 0, 0])),
        CommError::NONE
    );
    assert_eq!(bench.far[0].nmt_state(), NmtState::Operational);
    assert_eq!(bench.error(&send(0x800, 2, [0; 8])), CommError::CAN_ID);
    assert_eq!(bench.error(&send(0x100, 9, [0; 8])), CommError::LENGTH);
    let ask = |cob_id, len| RequestCanFrame { cob_id, len }.to_frame();
    let answer = bench.ask(&ask(0x702, 1));
    let data = RequestCanFrame::parse_answer(&answer).unwrap().unwrap();
    assert_eq!(data, [5, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(bench.error(&ask(0x704, 1)), CommError::TIMEOUT);
    assert_eq!(bench.error(&ask(0x702, 9)), CommError::LENGTH);
}

#[test]
fn rs232_is_a_gateway_too() {
    let (mut server, mut near, mut far, mut can) =
        (Rs232Server::new(1), node(1), node(2), CanServer::new());
    let address = objects::PROFILE_VELOCITY.address;
    let request = WriteObject {
        node: 2,
        address,
        value: 321,
    }
    .to_frame();
    let mut body = Vec::from([request.opcode]);
    encode_body(&request, &mut body).unwrap();
    let mut out = Vec::new();
    let mut bus = Neighbour {
        node: &mut far,
        server: &mut can,
    };
    server.input_with_bus(&mut near, &mut bus, &body, &mut |bytes: &[u8]| {
        out.extend_from_slice(bytes);
    });
    assert_eq!(out, b"OO\0");
    assert_eq!(far.read(address).unwrap().raw(), Some(321));
}
