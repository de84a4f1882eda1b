//! SDO: golden bytes, segments, refusals.

extern crate std;
use std::vec::Vec;

use proptest::prelude::*;
use protocol::canopen::nmt::NmtCommand;
use protocol::canopen::sdo::{SdoResponse, SdoTransfer, TransferError, TransferStep};
use protocol::epos2::AbortCode;
use protocol::epos2::objects::{self, Address};

use super::Bus;

impl Bus {
    fn sdo(&mut self, request: [u8; 8]) -> [u8; 8] {
        self.take();
        self.send(0x601, &request);
        let answers = self.with(0x581);
        assert_eq!(answers.len(), 1, "one answer per request");
        answers[0].as_slice().try_into().unwrap()
    }

    fn abort_code(&mut self, request: [u8; 8]) -> AbortCode {
        let answer = self.sdo(request);
        assert_eq!(answer[0], 0x80);
        AbortCode(u32::from_le_bytes([
            answer[4], answer[5], answer[6], answer[7],
        ]))
    }
}

#[test]
fn expedited_transfers_match_golden_bytes() {
    let mut bus = Bus::new();
    // The four lengths: 6041, 6064, 6061, and a write to 6040.
    assert_eq!(
        bus.sdo([0x40, 0x41, 0x60, 0, 0, 0, 0, 0]),
        [0x4B, 0x41, 0x60, 0, 0x40, 0x01, 0, 0]
    );
    assert_eq!(
        bus.sdo([0x40, 0x64, 0x60, 0, 0, 0, 0, 0]),
        [0x43, 0x64, 0x60, 0, 0, 0, 0, 0]
    );
    assert_eq!(
        bus.sdo([0x40, 0x61, 0x60, 0, 0, 0, 0, 0]),
        [0x4F, 0x61, 0x60, 0, 1, 0, 0, 0]
    );
    assert_eq!(
        bus.sdo([0x2B, 0x40, 0x60, 0, 6, 0, 0, 0]),
        [0x60, 0x40, 0x60, 0, 0, 0, 0, 0]
    );
    assert_eq!(bus.read(0x6041, 0), 0x0121);
    assert_eq!(
        bus.sdo([0x23, 0x7A, 0x60, 0, 1, 2, 3, 4]),
        [0x60, 0x7A, 0x60, 0, 0, 0, 0, 0]
    );
    assert_eq!(
        bus.sdo([0x2F, 0x60, 0x60, 0, 6, 0, 0, 0]),
        [0x60, 0x60, 0x60, 0, 0, 0, 0, 0]
    );
    // Without a size the object's size applies.
    assert_eq!(
        bus.sdo([0x22, 0x40, 0x60, 0, 7, 0, 9, 9]),
        [0x60, 0x40, 0x60, 0, 0, 0, 0, 0]
    );
    assert_eq!((bus.read(0x607A, 0), bus.read(0x6040, 0)), (0x0403_0201, 7));
}

#[test]
fn segmented_reads_match_golden_bytes() {
    let mut bus = Bus::new();
    assert_eq!(
        bus.sdo([0x40, 8, 0x10, 0, 0, 0, 0, 0]),
        [0x41, 8, 0x10, 0, 5, 0, 0, 0]
    );
    assert_eq!(
        bus.sdo([0x60, 0, 0, 0, 0, 0, 0, 0]),
        [0x05, 0x45, 0x50, 0x4F, 0x53, 0x32, 0, 0]
    );
    // The serial number has eight bytes: two segments, the second toggled.
    assert_eq!(
        bus.sdo([0x40, 4, 0x20, 0, 0, 0, 0, 0]),
        [0x41, 4, 0x20, 0, 8, 0, 0, 0]
    );
    assert_eq!(
        bus.sdo([0x60, 0, 0, 0, 0, 0, 0, 0]),
        [0x00, 1, 0, 0, 0, 0x55, 0x4D, 0x49]
    );
    assert_eq!(
        bus.sdo([0x70, 0, 0, 0, 0, 0, 0, 0]),
        [0x1D, 0x53, 0, 0, 0, 0, 0, 0]
    );
}

#[test]
fn segmented_writes_match_golden_bytes() {
    let mut bus = Bus::new();
    assert_eq!(
        bus.sdo([0x21, 0x7A, 0x60, 0, 4, 0, 0, 0]),
        [0x60, 0x7A, 0x60, 0, 0, 0, 0, 0]
    );
    assert_eq!(
        bus.sdo([0x0A, 1, 2, 0, 0, 0, 0, 0]),
        [0x20, 0, 0, 0, 0, 0, 0, 0]
    );
    assert_eq!(
        bus.sdo([0x1B, 3, 4, 0, 0, 0, 0, 0]),
        [0x30, 0, 0, 0, 0, 0, 0, 0]
    );
    assert_eq!(bus.read(0x607A, 0), 0x0403_0201);
}

#[test]
fn refusals_have_their_abort_codes() {
    let mut bus = Bus::new();
    let read = |index: u16, sub| {
        let [low, high] = index.to_le_bytes();
        [0x40, low, high, sub, 0, 0, 0, 0]
    };
    for (request, code) in [
        (read(0x5000, 0), AbortCode::NO_OBJECT),
        (read(0x6041, 1), AbortCode::NO_SUB),
        (read(0x20C1, 0), AbortCode::WRITE_ONLY),
        ([0x2B, 0x41, 0x60, 0, 0, 0, 0, 0], AbortCode::READ_ONLY),
        ([0x23, 0x40, 0x60, 0, 6, 0, 0, 0], AbortCode::TOO_LONG),
        ([0x2B, 0x7A, 0x60, 0, 6, 0, 0, 0], AbortCode::TOO_SHORT),
        ([0x23, 0x7F, 0x60, 0, 0xA9, 0x61, 0, 0], AbortCode::TOO_HIGH),
        ([0x2F, 0x60, 0x60, 0, 42, 0, 0, 0], AbortCode::RANGE),
        ([0x21, 0x7A, 0x60, 0, 5, 0, 0, 0], AbortCode::TOO_LONG),
        ([0x21, 0x41, 0x60, 0, 2, 0, 0, 0], AbortCode::READ_ONLY),
        // Segments without a transfer; block transfer.
        ([0x60, 0, 0, 0, 0, 0, 0, 0], AbortCode::COMMAND),
        ([0x01, 0, 0, 0, 0, 0, 0, 0], AbortCode::COMMAND),
        ([0xA0, 8, 0x10, 0, 0, 0, 0, 0], AbortCode::COMMAND),
    ] {
        assert_eq!(bus.abort_code(request), code, "{request:02X?}");
        // Segments without a transfer and their aborts name 0000:00.
        assert_eq!(bus.sdo(request)[1..4], request[1..4]);
    }
}

#[test]
fn a_wrong_toggle_a_new_transfer_and_an_abort_end_a_transfer() {
    let mut bus = Bus::new();
    bus.sdo([0x40, 8, 0x10, 0, 0, 0, 0, 0]);
    assert_eq!(
        bus.abort_code([0x70, 0, 0, 0, 0, 0, 0, 0]),
        AbortCode::TOGGLE
    );
    assert_eq!(
        bus.abort_code([0x60, 0, 0, 0, 0, 0, 0, 0]),
        AbortCode::COMMAND
    );
    bus.sdo([0x40, 8, 0x10, 0, 0, 0, 0, 0]);
    bus.sdo([0x40, 0x41, 0x60, 0, 0, 0, 0, 0]);
    assert_eq!(
        bus.abort_code([0x60, 0, 0, 0, 0, 0, 0, 0]),
        AbortCode::COMMAND
    );
    bus.sdo([0x21, 0x7A, 0x60, 0, 4, 0, 0, 0]);
    bus.take();
    bus.send(0x601, &[0x80, 0x7A, 0x60, 0, 0, 0, 0x04, 0x05]);
    assert_eq!(bus.take(), []);
    assert_eq!(
        bus.abort_code([0x0B, 1, 2, 0, 0, 0, 0, 0]),
        AbortCode::COMMAND
    );
    // Fewer and more bytes than announced.
    bus.sdo([0x21, 0x7A, 0x60, 0, 4, 0, 0, 0]);
    assert_eq!(
        bus.abort_code([0x0B, 1, 2, 0, 0, 0, 0, 0]),
        AbortCode::TOO_SHORT
    );
    bus.sdo([0x21, 0x7A, 0x60, 0, 4, 0, 0, 0]);
    assert_eq!(
        bus.abort_code([0x05, 1, 2, 3, 4, 5, 0, 0]),
        AbortCode::TOO_LONG
    );
    assert_eq!(bus.read(0x607A, 0), 0);
}

#[test]
fn a_silent_client_gets_a_timeout_abort() {
    let mut bus = Bus::new();
    bus.sdo([0x40, 8, 0x10, 0, 0, 0, 0, 0]);
    bus.ticks(1_000);
    assert_eq!(bus.with(0x581), Vec::<Vec<u8>>::new());
    bus.ticks(1);
    assert_eq!(bus.with(0x581), [[0x80, 8, 0x10, 0, 0, 0, 0x04, 0x05]]);
    bus.ticks(2_000);
    assert_eq!(bus.with(0x581), Vec::<Vec<u8>>::new());
}

#[test]
fn the_node_answers_only_its_own_requests_and_none_when_stopped() {
    let mut bus = Bus::new();
    let read = [0x40, 0x41, 0x60, 0, 0, 0, 0, 0];
    bus.send(0x602, &read);
    bus.send(0x601, &read[..7]);
    bus.nmt(NmtCommand::Stop);
    bus.send(0x601, &read);
    assert_eq!(bus.take(), []);
    bus.nmt(NmtCommand::EnterPreOperational);
    bus.send(0x601, &read);
    assert_eq!(bus.take().len(), 1);
}

/// Reads every entry by the transfers of the protocol crate, which tests both sides of them.
#[test]
fn every_entry_is_read_over_can_unchanged() {
    let mut bus = Bus::new();
    for entry in &crate::epos2::table::TABLE {
        let (mut transfer, mut request) = SdoTransfer::<8>::upload(entry.address);
        let result = loop {
            let bytes = bus.sdo(request.to_bytes());
            match transfer.handle_response(&SdoResponse::from_bytes(bytes)) {
                Ok(TransferStep::Send(next)) => request = next,
                Ok(TransferStep::Done(data)) => break Ok(data),
                Err(error) => break Err(error),
            }
        };
        match bus.node.read(entry.address) {
            Ok(value) => assert_eq!(result.unwrap().as_slice(), value.bytes()),
            Err(code) => {
                let error = TransferError::Aborted(code);
                assert_eq!(result, Err(error), "{}", entry.address);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn reads_are_answered_after_arbitrary_frames(
        frames in prop::collection::vec(
            (prop_oneof![4 => Just(0x601u16), 1 => 1u16..0x800], prop::collection::vec(any::<u8>(), 0..=8)),
            0..80,
        ),
    ) {
        let mut bus = Bus::new();
        for (id, data) in &frames {
            bus.send(*id, data);
            bus.ticks(1);
        }
        let id = bus.node.node_id();
        prop_assert_eq!(id, 1);
        bus.nmt(NmtCommand::EnterPreOperational);
        let address: Address = objects::DEVICE_TYPE.address;
        let [low, high] = address.index.to_le_bytes();
        let answer = bus.sdo([0x40, low, high, 0, 0, 0, 0, 0]);
        prop_assert_eq!(answer, [0x43, low, high, 0, 0x92, 1, 2, 0]);
    }
}
