//! NMT, boot-up, heartbeats both ways, guarding.

extern crate std;
use std::vec::Vec;

use protocol::canopen::nmt::{NmtCommand, NmtState};

use super::Bus;

#[test]
fn nmt_commands_change_the_state() {
    let mut bus = Bus::new();
    assert_eq!(bus.node.nmt_state(), NmtState::PreOperational);
    for (command, state) in [
        (NmtCommand::Start, NmtState::Operational),
        (NmtCommand::Stop, NmtState::Stopped),
        (NmtCommand::Start, NmtState::Operational),
        (NmtCommand::EnterPreOperational, NmtState::PreOperational),
        (NmtCommand::Unknown(0x55), NmtState::PreOperational),
    ] {
        bus.nmt(command);
        assert_eq!(bus.node.nmt_state(), state);
        assert_eq!(
            bus.read(0x6041, 0) & 0x0200 != 0,
            state == NmtState::Operational
        );
    }
    bus.send(0, &[0x01, 2]); // another node
    assert_eq!(bus.node.nmt_state(), NmtState::PreOperational);
    bus.send(0, &[0x01, 0]); // all
    assert_eq!(bus.node.nmt_state(), NmtState::Operational);
    for reset in [NmtCommand::ResetNode, NmtCommand::ResetCommunication] {
        bus.take();
        bus.nmt(reset);
        assert_eq!(bus.take(), [(0x701, Vec::from([0]))]);
        assert_eq!(bus.node.nmt_state(), NmtState::PreOperational);
    }
    bus.node.power_cycle();
    bus.poll();
    assert_eq!(bus.take(), [(0x701, Vec::from([0]))]);
}

#[test]
fn heartbeats_report_the_state_periodically() {
    let mut bus = Bus::new();
    bus.ticks(500);
    assert_eq!(bus.take(), [], "heartbeats are off by default");
    bus.write(0x1017, 0, 50);
    bus.poll();
    assert_eq!(
        bus.with(0x701),
        [[0x7F]],
        "the first heartbeat is immediate"
    );
    bus.ticks(499);
    assert_eq!(bus.with(0x701), [[0x7F]; 9]);
    bus.nmt(NmtCommand::Start);
    bus.take();
    bus.ticks(100);
    assert_eq!(bus.with(0x701), [[5]; 2]);
    bus.nmt(NmtCommand::Stop);
    bus.ticks(50);
    assert_eq!(bus.with(0x701), [[4]]);
    bus.write(0x1017, 0, 0);
    bus.ticks(200);
    assert_eq!(bus.with(0x701), Vec::<Vec<u8>>::new());
}

#[test]
fn a_saved_heartbeat_starts_one_period_after_boot_up() {
    let mut bus = Bus::new();
    bus.write(0x1017, 0, 50);
    bus.write(0x1010, 1, u32::from_le_bytes(*b"save"));
    bus.nmt(NmtCommand::ResetNode);
    assert_eq!(bus.with(0x701).last().unwrap(), &[0]);
    bus.ticks(49);
    assert_eq!(bus.with(0x701), Vec::<Vec<u8>>::new());
    bus.ticks(1);
    assert_eq!(bus.with(0x701), [[0x7F]]);
}

#[test]
fn the_axis_stops_when_the_masters_heartbeat_ends() {
    let mut bus = Bus::new();
    bus.write(0x1016, 1, 0x007F_0064); // node 127, 100 ms
    bus.write(0x6007, 0, 1); // as to a device error
    bus.nmt(NmtCommand::Start);
    bus.go(100_000);
    bus.ticks(200);
    assert_eq!(
        bus.read(0x6041, 0) & 0x417F,
        0x0137,
        "the first heartbeat starts the monitoring"
    );
    for _ in 0..5 {
        bus.send(0x77F, &[5]);
        bus.ticks(90);
        bus.send(0x77E, &[5]);
    }
    assert_eq!(bus.read(0x6041, 0) & 0x417F, 0x0137);
    bus.take();
    bus.ticks(11);
    assert_eq!(bus.read(0x6041, 0) & 0x417F, 0x011F, "ramping down");
    assert_eq!(bus.node.nmt_state(), NmtState::PreOperational);
    assert_eq!(bus.with(0x081), [[0x30, 0x81, 0x11, 0, 0, 0, 0, 0]]);
    bus.ticks(150);
    assert_eq!(
        (bus.read(0x6041, 0) & 0x417F, bus.read(0x606C, 0)),
        (0x0108, 0)
    );
    assert_eq!(bus.read(0x1003, 1), 0x8130);
    // Reported once; a heartbeat restarts the monitoring.
    bus.ticks(500);
    assert_eq!(bus.take(), []);
    bus.send(0x77F, &[5]);
    bus.ticks(110);
    assert_eq!(bus.with(0x081).len(), 1);
}

#[test]
fn the_abort_connection_option_decides_what_a_lost_master_causes() {
    // No action, fault, disable voltage, quick stop (which keeps the power on).
    for (option, state) in [(0, 0x0137), (1, 0x0108), (2, 0x0140), (3, 0x0117)] {
        let mut bus = Bus::new();
        bus.write(0x1016, 1, 0x007F_0064); // node 127, 100 ms
        bus.write(0x6007, 0, option);
        bus.nmt(NmtCommand::Start);
        bus.go(100_000);
        bus.send(0x77F, &[5]);
        bus.ticks(400);
        assert_eq!(bus.read(0x6041, 0) & 0x417F, state, "option {option}");
        assert_eq!(bus.read(0x606C, 0) == 0, option != 0, "option {option}");
        assert_eq!(bus.read(0x1003, 1), 0x8130);
    }
}

#[test]
fn guarding_requests_are_answered_with_a_toggle() {
    let mut bus = Bus::new();
    bus.send_remote(0x701);
    bus.send_remote(0x701);
    bus.nmt(NmtCommand::Stop);
    bus.send_remote(0x701);
    bus.send_remote(0x702);
    assert_eq!(bus.with(0x701), [[0x7F], [0xFF], [0x04]]);
    bus.write(0x1017, 0, 1000);
    bus.ticks(1);
    bus.take();
    bus.send_remote(0x701);
    assert_eq!(bus.take(), [], "heartbeat excludes guarding");
}

/// A drive in motion, guarded every 40 ms with a life time of 3 x 40 ms and this reaction.
fn guarded(option: u32) -> Bus {
    let mut bus = Bus::new();
    bus.write(0x100C, 0, 40);
    bus.write(0x100D, 0, 3);
    bus.write(0x6007, 0, option);
    bus.nmt(NmtCommand::Start);
    bus.go(100_000);
    bus.ticks(200);
    assert_eq!(
        bus.read(0x6041, 0) & 0x417F,
        0x0137,
        "the first request starts life guarding"
    );
    for _ in 0..5 {
        bus.send_remote(0x701);
        bus.ticks(110);
    }
    bus.send_remote(0x701);
    bus.take();
    bus
}

#[test]
fn the_axis_stops_when_guarding_requests_end() {
    let mut bus = guarded(1);
    bus.send_remote(0x702);
    bus.ticks(120);
    assert_eq!(bus.read(0x6041, 0) & 0x417F, 0x0137);
    assert_eq!(bus.with(0x081), Vec::<Vec<u8>>::new());
    bus.ticks(1);
    assert_eq!(bus.read(0x6041, 0) & 0x417F, 0x011F, "ramping down");
    assert_eq!(bus.node.nmt_state(), NmtState::PreOperational);
    assert_eq!(bus.with(0x081), [[0x30, 0x81, 0x11, 0, 0, 0, 0, 0]]);
    bus.ticks(150);
    assert_eq!(bus.read(0x6041, 0) & 0x417F, 0x0108);
    assert_eq!(bus.read(0x1003, 1), 0x8130);
    // Reported once; a request restarts life guarding, and the toggle bit continues.
    bus.ticks(500);
    bus.take();
    bus.send_remote(0x701);
    assert_eq!(bus.with(0x701), [[0x7F]]);
    bus.ticks(121);
    assert_eq!(bus.with(0x081).len(), 1);
}

#[test]
fn the_abort_connection_option_decides_what_a_missing_guard_causes() {
    for (option, state) in [(0, 0x0137), (1, 0x0108), (2, 0x0140), (3, 0x0117)] {
        let mut bus = guarded(option);
        bus.ticks(400);
        assert_eq!(bus.read(0x6041, 0) & 0x417F, state, "option {option}");
        assert_eq!(bus.read(0x606C, 0) == 0, option != 0, "option {option}");
        assert_eq!(bus.read(0x1003, 1), 0x8130);
    }
}

#[test]
fn life_guarding_needs_both_objects_and_no_heartbeat() {
    for (index, value) in [(0x100C, 0), (0x100D, 0), (0x1017, 1_000)] {
        let mut bus = guarded(1);
        bus.write(index, 0, value);
        bus.ticks(500);
        assert_eq!(bus.read(0x6041, 0) & 0x417F, 0x0137, "{index:04X}");
        assert_eq!(bus.read(0x1003, 0), 0, "{index:04X}");
    }
}
