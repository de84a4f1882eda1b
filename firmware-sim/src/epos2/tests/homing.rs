//! Homing mode.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, control, mode, status};
use protocol::epos2::objects;

use super::super::{Region, SimulatedDrive, SimulatedDriveConfig, Switch};
use super::{arrive, command, enable, get, go, has, position, set, state, ticks, until};

fn home(node: &mut SimulatedDrive, method: i8) {
    set(node, objects::MODE, mode::HOMING);
    set(node, objects::HOMING_METHOD, method);
    command(node, control::ENABLE_OPERATION);
    command(node, control::START_HOMING);
    assert!(!has(node, status::HOMING_ATTAINED) || method == 35 || method == 0);
    until(node, 200_000, |node| {
        has(node, status::HOMING_ATTAINED | status::TARGET_REACHED)
    });
    assert!(!has(node, status::HOMING_ERROR));
    assert_eq!(get(node, objects::VELOCITY_ACTUAL), 0);
}

/// World position of the shaft, qc.
fn world(node: &SimulatedDrive) -> i64 {
    node.segment().end >> 32
}

/// A home switch between 5000 and 6000, limits at +-43334, index pulses at 700 + n 2000; starting
/// at `at`.
fn with_home_switch(at: i32) -> SimulatedDrive {
    let mut config = SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        initial_position: at,
        ..SimulatedDriveConfig::default()
    };
    config.switches[2] = Some(Switch {
        input: 4,
        pressed: Region::Within(5_000, 6_000),
        normally_closed: false,
    });
    let mut node = SimulatedDrive::new(config);
    enable(&mut node);
    set(&mut node, objects::HOMING_SWITCH_SPEED, 400);
    set(&mut node, objects::HOMING_ZERO_SPEED, 30); // 1 qc/ms
    set(&mut node, objects::HOME_POSITION, 12_345);
    node
}

#[test]
fn homing_methods_find_their_reference() {
    // Method, start, world position of the reference, tolerance (inputs are sampled every
    // millisecond).
    let cases: [(i8, i32, i64, i64); 24] = [
        (17, 0, -43_333, 2),
        (17, -43_500, -43_333, 2),
        (18, 0, 43_333, 2),
        (18, 44_000, 43_333, 2),
        (1, 0, -43_300, 0),
        (2, 0, 42_700, 0),
        (23, 0, 4_999, 2),
        (23, 5_500, 4_999, 2),
        (23, 20_000, 4_999, 2), // reverses at the positive limit
        (27, 20_000, 6_001, 2),
        (27, 5_500, 6_001, 2),
        (27, 0, 6_001, 2), // reverses at the negative limit
        (7, 0, 4_700, 0),
        (7, 20_000, 4_700, 0),
        (7, 5_999, 4_700, 0),
        (11, 20_000, 6_700, 0),
        (11, 0, 6_700, 0),
        (33, 0, -1_300, 0),
        (33, 700, -1_300, 0),
        (33, 701, 700, 0),
        (34, 0, 700, 0),
        (34, 700, 2_700, 0),
        (34, -1_301, -1_300, 0),
        (35, 4_321, 4_321, 0),
    ];
    for (method, start, reference, tolerance) in cases {
        let mut node = with_home_switch(start);
        let offset = if method == 35 { 0 } else { 250 };
        set(&mut node, objects::HOME_OFFSET, offset);
        home(&mut node, method);
        let off = world(&node) - reference - i64::from(offset);
        assert!(
            off.abs() <= tolerance,
            "method {method} from {start}: {off}"
        );
        assert_eq!(position(&node), 12_345, "method {method} from {start}");
        assert!(has(&node, status::REFERENCED));
        // Positions count from there.
        set(&mut node, objects::MODE, mode::PROFILE_POSITION);
        let before = world(&node);
        go(&mut node, 12_345 + 500, control::START_ABSOLUTE);
        arrive(&mut node);
        assert_eq!(world(&node) - before, 500);
    }
}

#[test]
fn method_0_does_no_homing() {
    let mut node = with_home_switch(10);
    home(&mut node, 0);
    assert_eq!(position(&node), 0);
    assert!(!has(&node, status::REFERENCED));
}

#[test]
fn homing_ignores_limit_errors_and_software_limits() {
    let mut node = with_home_switch(0);
    set(&mut node, objects::INPUT_EXECUTION_MASK, 0x0003);
    set(&mut node, objects::MIN_POSITION, -100);
    set(&mut node, objects::MAX_POSITION, 100);
    set(&mut node, objects::HOME_POSITION, 0);
    home(&mut node, 17);
    assert_eq!(
        (state(&node), get(&node, objects::ERROR_COUNT)),
        (DeviceState::OperationEnabled, 0)
    );
}

#[test]
fn bit_4_and_halt_interrupt_homing_and_quick_stop_ends_it() {
    for word in [
        control::ENABLE_OPERATION,
        control::HALT_MOTION,
        control::QUICK_STOP,
    ] {
        let mut node = with_home_switch(0);
        set(&mut node, objects::MODE, mode::HOMING);
        set(&mut node, objects::HOMING_METHOD, 17);
        command(&mut node, control::START_HOMING);
        ticks(&mut node, 500);
        command(&mut node, word);
        ticks(&mut node, 1000);
        assert_eq!(get(&node, objects::VELOCITY_ACTUAL), 0);
        assert!(!has(&node, status::HOMING_ATTAINED) && !has(&node, status::HOMING_ERROR));
        assert_eq!(
            has(&node, status::TARGET_REACHED),
            word != control::QUICK_STOP
        );
        assert!(!has(&node, status::REFERENCED));
    }
}

#[test]
fn homing_that_cannot_start_sets_bit_13() {
    for (object, method) in [
        (objects::HOMING_SWITCH_SPEED, 17),
        (objects::HOMING_ACCELERATION, 34),
    ] {
        let mut node = with_home_switch(0);
        set(&mut node, objects::MODE, mode::HOMING);
        set(&mut node, objects::HOMING_METHOD, method);
        set(&mut node, object, 0);
        command(&mut node, control::START_HOMING);
        ticks(&mut node, 2);
        assert!(has(&node, status::HOMING_ERROR) && !has(&node, status::HOMING_ATTAINED));
    }
}

#[test]
fn a_missing_home_switch_sets_bit_13() {
    let mut node = SimulatedDrive::new(SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        ..SimulatedDriveConfig::default()
    });
    enable(&mut node);
    set(&mut node, objects::MODE, mode::HOMING);
    set(&mut node, objects::HOMING_SWITCH_SPEED, 2_000);
    set(&mut node, objects::HOMING_METHOD, 23);
    command(&mut node, control::START_HOMING);
    until(&mut node, 10_000, |node| has(node, status::HOMING_ERROR));
    until(&mut node, 10_000, |node| {
        get(node, objects::VELOCITY_ACTUAL) == 0
    });
}
