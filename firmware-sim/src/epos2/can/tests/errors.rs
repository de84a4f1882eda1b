//! Emergency messages.

use protocol::canopen::nmt::NmtCommand;
use protocol::epos2::DeviceError;

use super::Bus;
use crate::epos2::SimulatedDriveConfig;

#[test]
fn errors_and_their_end_are_sent() {
    let mut bus = Bus::new();
    bus.nmt(NmtCommand::Start);
    bus.take();
    bus.node.inject(DeviceError::OVERVOLTAGE);
    bus.poll();
    assert_eq!(bus.with(0x081), [[0x10, 0x32, 0x05, 0, 0, 0, 0, 0]]);
    bus.node.inject(DeviceError::POSITIVE_LIMIT);
    bus.poll();
    assert_eq!(bus.with(0x081), [[0x07, 0xFF, 0x85, 0, 0, 0, 0, 0]]);
    bus.write(0x6040, 0, 0x80);
    bus.poll();
    assert_eq!(bus.with(0x081), [[0; 8]]);
    assert_eq!(
        [0, 1, 2, 3].map(|sub| bus.read(0x1003, sub)),
        [2, 0xFF07, 0x3210, 0]
    );
    bus.write(0x1003, 0, 0);
    assert_eq!(bus.read(0x1003, 0), 0);
}

#[test]
fn a_stopped_node_reports_errors_later_and_one_without_identifier_never() {
    let mut bus = Bus::new();
    bus.nmt(NmtCommand::Stop);
    bus.node.inject(DeviceError::TEMPERATURE);
    bus.ticks(5);
    assert_eq!(bus.take(), []);
    bus.nmt(NmtCommand::Start);
    assert_eq!(bus.with(0x081).len(), 1);
    bus.write(0x1014, 0, 0x8000_0081);
    bus.node.inject(DeviceError::TEMPERATURE);
    bus.ticks(5);
    assert_eq!(bus.with(0x081).len(), 0);
    bus.write(0x1014, 0, 0x0000_0091);
    bus.node.inject(DeviceError::TEMPERATURE);
    bus.ticks(5);
    assert_eq!(bus.with(0x091).len(), 1);
}

#[test]
fn the_power_on_fault_follows_the_boot_up_message() {
    let mut bus = Bus::of(SimulatedDriveConfig::default());
    assert_eq!(bus.read(0x1003, 1), 0x8120);
    bus.nmt(NmtCommand::ResetNode);
    let ids: std::vec::Vec<_> = bus.take().into_iter().map(|(id, _)| id).collect();
    assert_eq!(ids, [0x701, 0x081]);
}

extern crate std;
