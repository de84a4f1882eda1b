//! Golden bytes of the EPOS2 on CAN, both ways, and properties of every message.

extern crate std;
use std::string::ToString as _;
use std::vec::Vec;

use proptest::prelude::*;

use super::emcy::Emergency;
use super::heartbeat::Heartbeat;
use super::nmt::{Nmt, NmtCommand, NmtState};
use super::object::{Address, TypedObject};
use super::pdo::{CommunicationId, TransmissionType};
use super::sdo::{Expedited, Initiate, SdoRequest, SdoResponse, SdoSegment};
use super::sync::SyncMessage;
use super::{
    BusMessage, CanFrame, CanId, CanopenLayer, CobId, ExtendedId, MessageError, NodeId, PdoNumber,
};
use crate::BoundedVec;
use crate::canopen::AbortCode;

fn node(id: u8) -> NodeId {
    NodeId::new(id).unwrap()
}

/// A frame as candump writes it.
fn frame(text: &str) -> CanFrame {
    let (id, data) = text.split_once('#').unwrap();
    let id = CobId::new(u16::from_str_radix(id, 16).unwrap()).unwrap();
    let data: Vec<u8> = (0..data.len())
        .step_by(2)
        .map(|at| u8::from_str_radix(&data[at..at + 2], 16).unwrap())
        .collect();
    CanFrame::new(id, &data).unwrap()
}

pub(super) fn any_id() -> impl Strategy<Value = CanId> {
    prop_oneof![
        (0_u16..0x800).prop_map(|id| CobId::new(id).unwrap().into()),
        (0_u32..1 << 29).prop_map(|id| ExtendedId::new(id).unwrap().into()),
    ]
}

pub(super) fn any_frame() -> impl Strategy<Value = CanFrame> {
    prop_oneof![
        4 => (any_id(), prop::collection::vec(any::<u8>(), 0..=8))
            .prop_map(|(id, data)| CanFrame::new(id, &data).unwrap()),
        1 => (any_id(), 0_u8..=8).prop_map(|(id, len)| CanFrame::remote(id, len).unwrap()),
    ]
}

/// Objects of CiA 301 and CiA 402 that the tests name.
const NAME: Address = Address::new(0x1008, 0);
pub(super) const TIMESTAMP: TypedObject<u32> =
    TypedObject::new(0x1013, 0, "High Resolution Time Stamp");
pub(super) const STATUSWORD: TypedObject<u16> = TypedObject::new(0x6041, 0, "Statusword");
pub(super) const MODE_DISPLAY: TypedObject<i8> =
    TypedObject::new(0x6061, 0, "Modes of Operation Display");
pub(super) const POSITION_ACTUAL: TypedObject<i32> =
    TypedObject::new(0x6064, 0, "Position Actual Value");

fn upload(address: Address, data: &[u8]) -> SdoResponse {
    let transfer = Initiate::Expedited(Expedited::new(data).unwrap());
    SdoResponse::InitiateUpload { address, transfer }
}

fn download(address: Address, data: &[u8]) -> SdoRequest {
    let transfer = Initiate::Expedited(Expedited::new(data).unwrap());
    SdoRequest::InitiateDownload { address, transfer }
}

fn segment(toggle: bool, last: bool, bytes: &[u8]) -> SdoSegment {
    let bytes = BoundedVec::from_slice(bytes).unwrap();
    SdoSegment {
        toggle,
        last,
        bytes,
    }
}

/// EPOS2 Communication Guide, "SDO communication" (node 1); the segments are those of reading the
/// device name.
fn sdo_messages() -> Vec<(&'static str, BusMessage)> {
    let request = |request| BusMessage::SdoRequest(node(1), request);
    let response = |answer| BusMessage::SdoResponse(node(1), answer);
    let address = STATUSWORD.address;
    let six = Address::new(0x2080, 3);
    std::vec![
        (
            "601#4041600000000000",
            request(SdoRequest::InitiateUpload { address })
        ),
        (
            "581#4B41600040010000",
            response(upload(address, &[0x40, 0x01]))
        ),
        (
            "581#4380200344332211",
            response(upload(six, &[0x44, 0x33, 0x22, 0x11]))
        ),
        (
            "581#4780200333221100",
            response(upload(six, &[0x33, 0x22, 0x11]))
        ),
        ("581#4F80200311000000", response(upload(six, &[0x11]))),
        (
            "601#2380200344332211",
            request(download(six, &[0x44, 0x33, 0x22, 0x11]))
        ),
        (
            "601#2780200333221100",
            request(download(six, &[0x33, 0x22, 0x11]))
        ),
        (
            "601#2B4060000F000000",
            request(download(Address::new(0x6040, 0), &[0x0F, 0]))
        ),
        (
            "601#2F60600001000000",
            request(download(Address::new(0x6060, 0), &[1]))
        ),
        (
            "581#6040600000000000",
            response(SdoResponse::InitiateDownload {
                address: Address::new(0x6040, 0)
            })
        ),
        (
            "581#8041600000000206",
            response(SdoResponse::Abort {
                address,
                error: AbortCode::NO_OBJECT
            })
        ),
        (
            "601#8041600000000405",
            request(SdoRequest::Abort {
                address,
                error: AbortCode::TIMEOUT
            })
        ),
        (
            "601#4008100000000000",
            request(SdoRequest::InitiateUpload { address: NAME })
        ),
        (
            "581#4108100005000000",
            response(SdoResponse::InitiateUpload {
                address: NAME,
                transfer: Initiate::Segmented { size: Some(5) }
            })
        ),
        (
            "601#6000000000000000",
            request(SdoRequest::UploadSegment { toggle: false })
        ),
        (
            "581#0545504F53320000",
            response(SdoResponse::UploadSegment(segment(false, true, b"EPOS2")))
        ),
        // Writing nine bytes in segments: announced, seven, two.
        (
            "601#2180200309000000",
            request(SdoRequest::InitiateDownload {
                address: six,
                transfer: Initiate::Segmented { size: Some(9) }
            })
        ),
        (
            "601#0001020304050607",
            request(SdoRequest::DownloadSegment(segment(
                false,
                false,
                &[1, 2, 3, 4, 5, 6, 7]
            )))
        ),
        (
            "581#2000000000000000",
            response(SdoResponse::DownloadSegment { toggle: false })
        ),
        (
            "601#1B08090000000000",
            request(SdoRequest::DownloadSegment(segment(true, true, &[8, 9])))
        ),
        (
            "581#3000000000000000",
            response(SdoResponse::DownloadSegment { toggle: true })
        ),
        (
            "601#7000000000000000",
            request(SdoRequest::UploadSegment { toggle: true })
        ),
        // Forms the EPOS2 does not use and other nodes may.
        (
            "581#42416000AABBCCDD",
            response(SdoResponse::InitiateUpload {
                address,
                transfer: Initiate::Unsized([0xAA, 0xBB, 0xCC, 0xDD])
            })
        ),
        (
            "581#4041600000000000",
            response(SdoResponse::InitiateUpload {
                address,
                transfer: Initiate::Segmented { size: None }
            })
        ),
        (
            "601#A041600000000000",
            request(SdoRequest::Unknown([0xA0, 0x41, 0x60, 0, 0, 0, 0, 0]))
        ),
        (
            "581#C241600000000000",
            response(SdoResponse::Unknown([0xC2, 0x41, 0x60, 0, 0, 0, 0, 0]))
        ),
    ]
}

/// CiA 301: NMT, boot-up, heartbeat, SYNC; EPOS2 Communication Guide: EMCY of node 1.
fn other_messages() -> Vec<(&'static str, BusMessage)> {
    let nmt = |node, command| BusMessage::Nmt(Nmt { node, command });
    let heart = |state| {
        BusMessage::Heartbeat(Heartbeat {
            node: node(1),
            state,
        })
    };
    let mut process = BoundedVec::new();
    process.extend([0x37, 0x03]);
    std::vec![
        ("000#0101", nmt(Some(node(1)), NmtCommand::Start)),
        ("000#0200", nmt(None, NmtCommand::Stop)),
        (
            "000#807F",
            nmt(Some(node(127)), NmtCommand::EnterPreOperational)
        ),
        ("000#8101", nmt(Some(node(1)), NmtCommand::ResetNode)),
        (
            "000#8201",
            nmt(Some(node(1)), NmtCommand::ResetCommunication)
        ),
        ("000#0301", nmt(Some(node(1)), NmtCommand::Unknown(3))),
        ("701#00", heart(NmtState::BootUp)),
        ("701#04", heart(NmtState::Stopped)),
        ("701#05", heart(NmtState::Operational)),
        ("701#7F", heart(NmtState::PreOperational)),
        ("701#85", heart(NmtState::Unknown(0x85))),
        ("080#", BusMessage::Sync(SyncMessage::default())),
        (
            "080#F0",
            BusMessage::Sync(SyncMessage { counter: Some(240) })
        ),
        (
            "081#1186200000000000",
            BusMessage::Emergency(Emergency::new(node(1), 0x8611, 0x20))
        ),
        (
            "081#0000000000000000",
            BusMessage::Emergency(Emergency::new(node(1), 0, 0))
        ),
        (
            "181#3703",
            BusMessage::TransmitPdo(PdoNumber::One, node(1), process)
        ),
        (
            "201#3703",
            BusMessage::ReceivePdo(PdoNumber::One, node(1), process)
        ),
        (
            "100#000000000000",
            BusMessage::Other(frame("100#000000000000"))
        ),
        (
            "7E5#0400000000000000",
            BusMessage::Other(frame("7E5#0400000000000000"))
        ),
    ]
}

#[test]
fn messages_match_golden_bytes_in_both_directions() {
    for (text, message) in sdo_messages().into_iter().chain(other_messages()) {
        assert_eq!(message.to_frame().to_string(), text);
        assert_eq!(BusMessage::parse(&frame(text)), Ok(message), "{text}");
    }
}

#[test]
fn pdo_parameters_match_golden_bytes() {
    let tpdo1 = CommunicationId::from_u32(0x4000_0180 + 1);
    assert!(tpdo1.valid && !tpdo1.remote);
    assert_eq!(tpdo1.id.raw(), 0x181);
    assert!(!CommunicationId::from_u32(0xC000_0281).valid);
    assert_eq!(
        TransmissionType::from_u8(0xFF),
        TransmissionType::ProfileEvent
    );
    assert_eq!(CobId::SYNC.get(), 0x080);
}

#[test]
fn the_error_reset_is_distinguished() {
    let parse = |text| Emergency::parse(&frame(text)).unwrap();
    assert!(parse("081#0000000000000000").is_reset());
    let error = parse("0FF#06FF800102030405");
    assert!(!error.is_reset());
    assert_eq!(error.node, node(127));
    assert_eq!(error.code, 0xFF06);
    assert_eq!((error.register, error.vendor), (0x80, [1, 2, 3, 4, 5]));
}

#[test]
fn wrong_lengths_and_services_are_refused() {
    let length = |layer, expected, got| {
        Err(MessageError::Length {
            layer,
            expected,
            got,
        })
    };
    for (text, error) in [
        (
            "581#4B416000400100",
            length(CanopenLayer::SdoResponse, 8, 7),
        ),
        ("601#", length(CanopenLayer::SdoRequest, 8, 0)),
        ("701#0500", length(CanopenLayer::Heartbeat, 1, 2)),
        ("080#0000", length(CanopenLayer::Sync, 0, 2)),
        ("081#11862000", length(CanopenLayer::Emergency, 8, 4)),
        ("000#", length(CanopenLayer::Nmt, 2, 0)),
    ] {
        assert_eq!(BusMessage::parse(&frame(text)), error, "{text}");
    }
    let other = frame("581#4B41600040010000");
    let got = other.id();
    let id = |layer, expected| MessageError::Id {
        layer,
        expected,
        got,
    };
    assert_eq!(Nmt::parse(&other), Err(id(CanopenLayer::Nmt, "000")));
    assert_eq!(
        SyncMessage::parse(&other),
        Err(id(CanopenLayer::Sync, "080"))
    );
    assert_eq!(
        Emergency::parse(&other),
        Err(id(CanopenLayer::Emergency, "081 to 0FF"))
    );
    assert_eq!(
        Heartbeat::parse(&other),
        Err(id(CanopenLayer::Heartbeat, "701 to 77F"))
    );
    assert_eq!(
        SdoRequest::parse(&other),
        Err(id(CanopenLayer::SdoRequest, "601 to 67F"))
    );
    // A 29-bit identifier with the same number is no message of CANopen.
    let extended = CanFrame::new(ExtendedId::new(0x581).unwrap(), other.data()).unwrap();
    assert!(matches!(
        SdoResponse::parse(&extended),
        Err(MessageError::Id { .. })
    ));
    assert_eq!(
        BusMessage::parse(&extended),
        Ok(BusMessage::Other(extended))
    );
}

#[test]
fn remote_frames_are_not_messages() {
    let id = CobId::new(0x701).unwrap();
    let guard = CanFrame::remote(id, 1).unwrap();
    let layer = CanopenLayer::Heartbeat;
    assert_eq!(
        Heartbeat::parse(&guard),
        Err(MessageError::Remote { layer })
    );
    assert_eq!(BusMessage::parse(&guard), Ok(BusMessage::Other(guard)));
}

proptest! {
    #[test]
    fn arbitrary_frames_are_a_message_or_an_error(frame in any_frame()) {
        if let Ok(message) = BusMessage::parse(&frame) {
            prop_assert_eq!(BusMessage::parse(&message.to_frame()), Ok(message));
        }
    }

    #[test]
    fn arbitrary_data_on_a_service_is_a_message_or_an_error(
        base in prop::sample::select(&[0_u16, 0x080, 0x100, 0x180, 0x200, 0x480, 0x500, 0x580, 0x600, 0x700][..]),
        id in 0_u16..0x80,
        data in prop::collection::vec(any::<u8>(), 0..=8),
    ) {
        let frame = CanFrame::new(CobId::new(base + id).unwrap(), &data).unwrap();
        if let Ok(message) = BusMessage::parse(&frame) {
            let again = message.to_frame();
            prop_assert_eq!(again.id(), frame.id());
            prop_assert_eq!(again.dlc(), frame.dlc());
            prop_assert_eq!(BusMessage::parse(&again), Ok(message));
        }
    }
}
