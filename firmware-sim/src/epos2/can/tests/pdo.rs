//! Process data: the angle stream, events, requests, and what the master sends.

extern crate std;
use std::vec::Vec;

use protocol::canopen::nmt::NmtCommand;

use super::Bus;

/// Position and time stamp of the angle stream.
fn sample(data: &[u8]) -> (i32, u32) {
    let (position, stamp) = data.split_at(4);
    (
        i32::from_le_bytes(position.try_into().unwrap()),
        u32::from_le_bytes(stamp.try_into().unwrap()),
    )
}

#[test]
fn each_sync_sends_position_and_time_stamp() {
    let mut bus = Bus::new();
    bus.stream_angle(1, 0);
    bus.send(0x080, &[]);
    assert_eq!(bus.with(0x181), Vec::<Vec<u8>>::new(), "not operational");
    bus.nmt(NmtCommand::Start);
    bus.go(30_000);
    let mut last = (0, 0);
    // 1 kHz for a second, 370 us into each cycle.
    for n in 0..1_000 {
        bus.ticks(1);
        bus.node.set_phase_us(370);
        let truth = bus.read(0x6064, 0) as i32;
        let now_us = bus.node.time_us();
        bus.take();
        bus.send(0x080, &[]);
        let data = bus.with(0x181);
        assert_eq!(data.len(), 1, "one PDO a SYNC");
        let (position, stamp) = sample(&data[0]);
        assert_eq!((position, u64::from(stamp)), (truth, now_us));
        assert!(n == 0 || stamp - last.1 == 1_000);
        assert!(position >= last.0);
        last = (position, stamp);
    }
    assert!(last.0 > 25_000);
    bus.ticks(50);
    assert_eq!(
        bus.with(0x181),
        Vec::<Vec<u8>>::new(),
        "nothing without SYNC"
    );
}

#[test]
fn pdos_are_sent_on_every_third_sync_and_only_after_events() {
    let mut bus = Bus::new();
    bus.stream_angle(3, 0);
    bus.nmt(NmtCommand::Start);
    for _ in 0..9 {
        bus.send(0x080, &[]);
    }
    assert_eq!(bus.with(0x181).len(), 3);
    bus.nmt(NmtCommand::EnterPreOperational);
    bus.write(0x1800, 2, 0);
    bus.write(0x1800, 1, 0xC000_0181);
    bus.write(0x1A00, 0, 1);
    bus.write(0x1800, 1, 0x4000_0181);
    bus.nmt(NmtCommand::Start);
    for _ in 0..5 {
        bus.send(0x080, &[]);
        bus.ticks(1);
    }
    assert_eq!(bus.with(0x181).len(), 1, "one PDO, then no change");
}

#[test]
fn event_pdos_respect_the_inhibit_time() {
    let mut bus = Bus::new();
    // By default TPDO 1 is the statusword, sent on events.
    bus.nmt(NmtCommand::Start);
    assert_eq!(
        bus.with(0x181),
        [[0x40, 0x03]],
        "immediately on entering operational"
    );
    bus.ticks(20);
    assert_eq!(bus.with(0x181), Vec::<Vec<u8>>::new());
    bus.send(0x201, &[0x06, 0]);
    assert_eq!(bus.with(0x181), [[0x21, 0x03]]);
    bus.nmt(NmtCommand::EnterPreOperational);
    bus.stream_angle(255, 50); // 5 ms
    bus.nmt(NmtCommand::Start);
    bus.take();
    bus.ticks(100);
    assert_eq!(
        bus.with(0x181).len(),
        20,
        "the time stamp changes each millisecond"
    );
    bus.nmt(NmtCommand::Stop);
    bus.ticks(100);
    assert_eq!(bus.take(), []);
}

#[test]
fn remote_frames_are_answered_where_allowed() {
    let mut bus = Bus::new();
    bus.stream_angle(253, 0);
    bus.nmt(NmtCommand::Start);
    bus.send_remote(0x181);
    assert_eq!(
        bus.take(),
        [],
        "bit 30 of the identifier excludes remote frames"
    );
    bus.nmt(NmtCommand::EnterPreOperational);
    bus.write(0x1800, 1, 0xC000_0181);
    bus.write(0x1800, 1, 0x0000_0181);
    bus.nmt(NmtCommand::Start);
    bus.ticks(3);
    bus.send_remote(0x181);
    bus.send_remote(0x182);
    let stamps: Vec<_> = bus.with(0x181).iter().map(|data| sample(data).1).collect();
    assert_eq!(stamps, [3_000]);
    bus.nmt(NmtCommand::EnterPreOperational);
    bus.write(0x1800, 2, 252);
    bus.nmt(NmtCommand::Start);
    bus.send_remote(0x181);
    assert_eq!(bus.take(), [], "no SYNC yet");
    bus.send(0x080, &[]);
    bus.ticks(5);
    bus.send_remote(0x181);
    assert_eq!(
        sample(&bus.with(0x181)[0]).1,
        3_000,
        "the value at the SYNC"
    );
}

#[test]
fn controlword_and_target_are_received_by_pdo() {
    let mut bus = Bus::new();
    bus.send(0x201, &[0x06, 0]);
    assert_eq!(bus.read(0x6041, 0), 0x0140, "not operational");
    bus.nmt(NmtCommand::Start);
    bus.send(0x201, &[0x06, 0]);
    bus.send(0x301, &[0x0F, 0, 1]); // RPDO 2: controlword and mode
    bus.ticks(5);
    assert_eq!(bus.read(0x6041, 0), 0x0337);
    bus.send(0x401, &[0x1F, 0, 0xE8, 3, 0, 0]); // RPDO 3: controlword, then target
    bus.send(0x401, &[0x0F, 0, 0xE8, 3, 0, 0]);
    bus.send(0x401, &[0x1F, 0, 0xE8, 3, 0, 0, 99, 99]);
    bus.ticks(200);
    assert_eq!(bus.read(0x6064, 0), 1_000);
}

#[test]
fn a_synchronous_rpdo_waits_for_the_sync() {
    let mut bus = Bus::new();
    bus.write(0x1400, 2, 1);
    bus.nmt(NmtCommand::Start);
    bus.send(0x201, &[0x06, 0]);
    bus.ticks(3);
    assert_eq!(bus.read(0x6040, 0), 0);
    bus.send(0x080, &[]);
    assert_eq!(bus.read(0x6040, 0), 6);
}

#[test]
fn a_short_rpdo_is_error_8210() {
    let mut bus = Bus::new();
    bus.nmt(NmtCommand::Start);
    bus.take();
    bus.send(0x301, &[0x06]);
    assert_eq!(bus.read(0x1003, 1), 0x8210);
    assert_eq!(bus.with(0x081), [[0x10, 0x82, 0x11, 0, 0, 0, 0, 0]]);
}

#[test]
fn invalid_pdo_values_are_ignored() {
    let mut bus = Bus::new();
    bus.nmt(NmtCommand::Start);
    // Mode 42 does not exist; the controlword before it is applied.
    bus.send(0x301, &[0x06, 0, 42]);
    assert_eq!((bus.read(0x6040, 0), bus.read(0x6061, 0)), (6, 1));
    // Disabled RPDOs.
    bus.nmt(NmtCommand::EnterPreOperational);
    bus.write(0x1400, 1, 0x8000_0201);
    bus.nmt(NmtCommand::Start);
    bus.send(0x201, &[0x07, 0]);
    assert_eq!(bus.read(0x6040, 0), 6);
}
