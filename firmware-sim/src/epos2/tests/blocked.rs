//! A shaft that cannot follow: following error, hard stops, homing against them.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, control, mode, status};
use protocol::epos2::objects::{self, TypedObject};

use super::super::{SimulatedDrive, SimulatedDriveConfig};
use super::{arrive, command, enable, enabled, get, go, has, position, set, state, ticks, until};

const FOLLOWING: TypedObject<i16> = TypedObject::new(0x20F4, 0, "Following Error Actual Value");

/// Hard stops at -20,000 and 30,000 world qc; index pulses at 700 + n 2000.
fn between_stops(at: i32) -> SimulatedDrive {
    let mut node = SimulatedDrive::new(SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        initial_position: at,
        hard_stops: [Some(-20_000), Some(30_000)],
        switches: [None; 4],
        ..SimulatedDriveConfig::default()
    });
    enable(&mut node);
    node
}

#[test]
fn a_blocked_motor_is_a_following_error() {
    let mut node = enabled();
    go(&mut node, 50_000, control::START_ABSOLUTE);
    ticks(&mut node, 300);
    assert_eq!(
        (get(&node, FOLLOWING), get(&node, objects::CURRENT_ACTUAL)),
        (0, 0)
    );
    let speed = get(&node, objects::VELOCITY_ACTUAL);
    assert_eq!(speed, 1_000);
    node.block();
    node.tick();
    let at = position(&node);
    ticks(&mut node, 29);
    assert_eq!(
        (position(&node), get(&node, objects::VELOCITY_ACTUAL)),
        (at, 0)
    );
    assert_eq!(get(&node, objects::VELOCITY_DEMAND), 1_000);
    // 30 ms at 33.3 qc/ms, 5 mA each.
    assert!((980..1_020).contains(&get(&node, FOLLOWING)));
    assert!((4_900..5_100).contains(&get(&node, objects::CURRENT_ACTUAL)));
    let took = until(&mut node, 100, |node| {
        state(node) == DeviceState::FaultReactionEnabled
    });
    assert!((29..33).contains(&took), "{took}");
    assert!(has(&node, status::FOLLOWING_ERROR));
    let ramp = until(&mut node, 200, |node| state(node) == DeviceState::Fault);
    assert!((99..104).contains(&ramp), "{ramp}");
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0x8611);
    assert_eq!(get(&node, objects::ERROR_REGISTER), 0x21);
    assert_eq!(
        (get(&node, objects::CURRENT_ACTUAL), position(&node)),
        (0, at)
    );
    assert_eq!(
        get(&node, objects::POSITION_DEMAND),
        at,
        "without power the demand follows the shaft"
    );
    // Released, it continues from there without an error.
    node.unblock();
    command(&mut node, control::FAULT_RESET);
    assert!(!has(&node, status::FOLLOWING_ERROR));
    enable(&mut node);
    assert_eq!(position(&node), at);
    go(&mut node, 0, control::START_ABSOLUTE);
    arrive(&mut node);
    assert_eq!(position(&node), 0);
}

#[test]
fn a_short_block_within_the_6065_window_is_caught_up() {
    let mut node = enabled();
    go(&mut node, 50_000, control::START_ABSOLUTE);
    ticks(&mut node, 300);
    node.block();
    ticks(&mut node, 40);
    node.unblock();
    ticks(&mut node, 5);
    assert_eq!(get(&node, FOLLOWING), 0);
    arrive(&mut node);
    assert_eq!(
        (position(&node), state(&node)),
        (50_000, DeviceState::OperationEnabled)
    );
}

#[test]
fn the_following_error_limit_can_be_widened() {
    let mut node = enabled();
    set(&mut node, objects::MAX_FOLLOWING_ERROR, u32::MAX);
    node.block();
    go(&mut node, 40_000, control::START_ABSOLUTE);
    arrive(&mut node);
    assert_eq!(
        (position(&node), state(&node)),
        (0, DeviceState::OperationEnabled)
    );
    assert_eq!(get(&node, FOLLOWING), i16::MAX);
    assert_eq!(
        get(&node, objects::CURRENT_ACTUAL),
        25_000,
        "6410:2 limits the current"
    );
}

#[test]
fn a_hard_stop_ends_a_move() {
    let mut node = between_stops(0);
    go(&mut node, 40_000, control::START_ABSOLUTE);
    until(&mut node, 5_000, |node| state(node) == DeviceState::Fault);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0x8611);
    assert_eq!(position(&node), 30_000);
}

#[test]
fn homing_finds_the_mechanical_stops_by_current() {
    // Method, world position of the reference.
    for (method, reference) in [(-3, 30_000), (-4, -20_000), (-1, 28_700), (-2, -19_300)] {
        for start in [0, reference] {
            let mut node = between_stops(start);
            let offset = if reference > 0 { -250 } else { 250 };
            set(&mut node, objects::MODE, mode::HOMING);
            set(&mut node, objects::HOMING_METHOD, method);
            set(&mut node, objects::HOMING_SWITCH_SPEED, 300);
            set(&mut node, objects::HOMING_ZERO_SPEED, 30);
            set(&mut node, objects::HOME_OFFSET, offset);
            set(&mut node, objects::HOME_POSITION, 12_345);
            let mut most = 0;
            command(&mut node, control::START_HOMING);
            for _ in 0..60_000 {
                node.tick();
                most = most.max(get(&node, objects::CURRENT_ACTUAL).unsigned_abs());
                if has(&node, status::HOMING_ATTAINED) {
                    break;
                }
            }
            assert!(
                has(&node, status::HOMING_ATTAINED | status::REFERENCED),
                "{method}"
            );
            assert_eq!(
                node.segment().end >> 32,
                i64::from(reference + offset),
                "{method}"
            );
            assert_eq!(position(&node), 12_345);
            // The threshold (2080) is 500 mA, checked every millisecond at 10 qc/ms.
            assert!((500..=560).contains(&most), "{most}");
        }
    }
}

#[test]
fn a_threshold_above_the_limit_ends_in_a_following_error() {
    let mut node = between_stops(0);
    set(&mut node, objects::MODE, mode::HOMING);
    set(&mut node, objects::HOMING_METHOD, -3);
    set(&mut node, objects::HOMING_SWITCH_SPEED, 1_000);
    command(&mut node, control::DISABLE_VOLTAGE);
    set(&mut node, objects::OUTPUT_CURRENT, 400);
    enable(&mut node);
    command(&mut node, control::START_HOMING);
    until(&mut node, 5_000, |node| state(node) == DeviceState::Fault);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0x8611);
    assert!(!has(&node, status::REFERENCED));
}

#[test]
fn a_jam_outlasts_power_off() {
    let mut node = enabled();
    node.block();
    node.power_cycle();
    enable(&mut node);
    go(&mut node, 500, control::START_ABSOLUTE);
    arrive(&mut node);
    assert_eq!((position(&node), get(&node, FOLLOWING)), (0, 500));
}

#[test]
fn the_quick_stop_input_stops_the_axis() {
    let mut config = SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        initial_position: 0,
        ..SimulatedDriveConfig::default()
    };
    config.switches[2] = Some(super::super::Switch {
        input: 4,
        pressed: super::super::Region::AtLeast(8_000),
        normally_closed: false,
    });
    let mut node = SimulatedDrive::new(config);
    enable(&mut node);
    set(
        &mut node,
        TypedObject::<u16>::new(0x2070, 4, "Configuration of Digital Input4"),
        5,
    );
    set(&mut node, objects::INPUT_MASK, 0xFFFF);
    set(
        &mut node,
        objects::INPUT_EXECUTION_MASK,
        objects::input::QUICK_STOP,
    );
    go(&mut node, 50_000, control::START_ABSOLUTE);
    until(&mut node, 1_000, |node| {
        state(node) == DeviceState::QuickStopActive
    });
    ticks(&mut node, 200);
    assert!((9_500..9_900).contains(&position(&node)));
    assert_eq!(get(&node, objects::ERROR_COUNT), 0);
}
