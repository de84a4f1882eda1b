//! Layer setting services; frames as in CiA 305.

extern crate std;
use std::vec::Vec;

use protocol::canopen::nmt::NmtCommand;
use protocol::epos2::DeviceError;

use super::Bus;
use crate::epos2::{SimulatedDriveConfig, UnitIdentity};

const SERIAL: u32 = 0x1234_5678;

fn stopped() -> Bus {
    let mut bus = Bus::of(SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        identity: UnitIdentity {
            serial_number: SERIAL.into(),
            ..UnitIdentity::default()
        },
        ..SimulatedDriveConfig::default()
    });
    bus.nmt(NmtCommand::Stop);
    bus.take();
    bus
}

/// Sends a request; returns the answers.
fn ask(bus: &mut Bus, specifier: u8, value: u32) -> Vec<Vec<u8>> {
    let [a, b, c, d] = value.to_le_bytes();
    bus.send(0x7E5, &[specifier, a, b, c, d, 0, 0, 0]);
    bus.with(0x7E4)
}

/// The node's identity, in four parts.
fn select(bus: &mut Bus, serial: u32) -> Vec<Vec<u8>> {
    let mut answers = Vec::new();
    for (specifier, value) in [
        (0x40, 0xFB),
        (0x41, 0x6420_0000),
        (0x42, 0x2126_0000),
        (0x43, serial),
    ] {
        answers.extend(ask(bus, specifier, value));
    }
    answers
}

#[test]
fn a_node_that_is_selected_by_its_identity_takes_a_node_id_and_stores_it() {
    let mut bus = stopped();
    assert_eq!(ask(&mut bus, 0x5E, 0), Vec::<Vec<u8>>::new(), "waiting");
    assert_eq!(select(&mut bus, SERIAL + 1), Vec::<Vec<u8>>::new());
    assert_eq!(select(&mut bus, SERIAL), [[0x44, 0, 0, 0, 0, 0, 0, 0]]);
    assert_eq!(ask(&mut bus, 0x5A, 0), [[0x5A, 0xFB, 0, 0, 0, 0, 0, 0]]);
    assert_eq!(
        ask(&mut bus, 0x5D, 0),
        [[0x5D, 0x78, 0x56, 0x34, 0x12, 0, 0, 0]]
    );
    assert_eq!(ask(&mut bus, 0x5E, 0), [[0x5E, 1, 0, 0, 0, 0, 0, 0]]);
    assert_eq!(
        ask(&mut bus, 0x11, 0),
        [[0x11, 1, 0, 0, 0, 0, 0, 0]],
        "no node id"
    );
    assert_eq!(ask(&mut bus, 0x11, 5), [[0x11, 0, 0, 0, 0, 0, 0, 0]]);
    assert_eq!(ask(&mut bus, 0x17, 0), [[0x17, 0, 0, 0, 0, 0, 0, 0]]);
    bus.nmt(NmtCommand::ResetNode);
    assert_eq!(bus.take(), [(0x705, Vec::from([0]))]);
}

#[test]
fn a_node_id_that_is_not_stored_is_lost() {
    let mut bus = stopped();
    ask(&mut bus, 0x04, 1);
    assert_eq!(ask(&mut bus, 0x11, 5), [[0x11, 0, 0, 0, 0, 0, 0, 0]]);
    bus.nmt(NmtCommand::ResetNode);
    assert_eq!(bus.take(), [(0x701, Vec::from([0]))]);
}

#[test]
fn bit_rates_of_the_table_are_taken() {
    let mut bus = stopped();
    ask(&mut bus, 0x04, 1);
    let take = |bus: &mut Bus, table: u32, index: u32| ask(bus, 0x13, table | index << 8)[0][1];
    assert_eq!((take(&mut bus, 0, 0), take(&mut bus, 0, 7)), (0, 0));
    assert_eq!((take(&mut bus, 0, 5), take(&mut bus, 1, 0)), (1, 1));
    ask(&mut bus, 0x04, 0);
    assert_eq!(
        ask(&mut bus, 0x13, 0),
        Vec::<Vec<u8>>::new(),
        "waiting again"
    );
}

#[test]
fn a_search_by_ranges_finds_the_node() {
    let mut bus = stopped();
    let mut search = |low: u32, high: u32| {
        let mut answers = Vec::new();
        for (specifier, value) in [
            (0x46, 0xFB),
            (0x47, 0x6420_0000),
            (0x48, 0),
            (0x49, u32::MAX),
            (0x4A, low),
            (0x4B, high),
        ] {
            answers.extend(ask(&mut bus, specifier, value));
        }
        answers
    };
    assert_eq!(search(SERIAL, SERIAL), [[0x4F, 0, 0, 0, 0, 0, 0, 0]]);
    assert_eq!(search(0, SERIAL - 1), Vec::<Vec<u8>>::new());
    assert_eq!(search(SERIAL + 1, u32::MAX), Vec::<Vec<u8>>::new());
}

#[test]
fn a_node_that_is_not_stopped_does_not_answer() {
    let mut bus = Bus::new();
    for command in [NmtCommand::EnterPreOperational, NmtCommand::Start] {
        bus.nmt(command);
        ask(&mut bus, 0x04, 1);
        assert_eq!(ask(&mut bus, 0x5E, 0), Vec::<Vec<u8>>::new());
    }
}
