//! Gravity, friction, the holding brake and encoder dither.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, control, mode};
use protocol::epos2::objects::{self, TypedObject};

use super::super::{AxisLoad, BrakeState, HoldingBrake, SimulatedDrive, SimulatedDriveConfig};
use super::{arrive, command, enable, get, go, healthy, position, set, state, ticks, until};

/// 1500 deg/s2 of an axis geared 120:1, with 2000 qc per revolution of the motor: a free fall of
/// `n` ms covers `n * n / 2` qc.
const GRAVITY: i32 = -30_000;

fn loaded(load: AxisLoad) -> SimulatedDrive {
    SimulatedDrive::new(SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        initial_position: 0,
        load: Some(load),
        ..SimulatedDriveConfig::default()
    })
}

fn free() -> AxisLoad {
    AxisLoad {
        gravity_rpm_s: GRAVITY,
        ..AxisLoad::default()
    }
}

const BRAKE: HoldingBrake = HoldingBrake {
    opening_ms: 10,
    closing_ms: 20,
    holding_rpm_s: 330_000,
};

/// Enabled, with the brake on output 1 and these reaction times in 2100.
fn enabled_with(brake: HoldingBrake, rise_ms: u16, fall_ms: u16) -> SimulatedDrive {
    let mut node = loaded(AxisLoad {
        brake: Some(brake),
        ..free()
    });
    let output = TypedObject::<u16>::new(0x2079, 1, "output");
    set(&mut node, output, objects::OUTPUT_BRAKE);
    let mask = get(&node, objects::OUTPUT_MASK) | 1 << objects::OUTPUT_BRAKE;
    set(&mut node, objects::OUTPUT_MASK, mask);
    set(&mut node, objects::BRAKE_RISE, rise_ms);
    set(&mut node, objects::BRAKE_FALL, fall_ms);
    enable(&mut node);
    node
}

#[test]
fn an_unpowered_axis_falls_with_gravity_less_friction() {
    for (friction_rpm_s, expected) in [(0, -5_000), (6_000, -4_000), (30_000, 0)] {
        let mut node = loaded(AxisLoad {
            friction_rpm_s,
            ..free()
        });
        ticks(&mut node, 101); // the reading is the position at the start of the last
        assert_eq!(position(&node), expected, "{friction_rpm_s}");
    }
    // Under power it holds, and disabling the power lets go.
    let mut node = loaded(free());
    enable(&mut node);
    let held = position(&node);
    ticks(&mut node, 500);
    assert_eq!(position(&node), held);
    command(&mut node, control::DISABLE_VOLTAGE);
    ticks(&mut node, 101);
    assert_eq!(position(&node), held - 5_000);
    // The speed of the fall: 100 ms at 30 rpm/ms.
    assert!((-3_030..=-3_000).contains(&get(&node, objects::VELOCITY_ACTUAL)));
}

#[test]
fn a_fall_ends_at_the_hard_stop_and_is_caught_by_power() {
    let mut node = SimulatedDrive::new(SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        initial_position: 0,
        hard_stops: [Some(-1_000), None],
        load: Some(free()),
        ..SimulatedDriveConfig::default()
    });
    ticks(&mut node, 500);
    assert_eq!(position(&node), -1_000);
    assert_eq!(get(&node, objects::VELOCITY_ACTUAL), 0);
    enable(&mut node);
    go(&mut node, 500, control::START_ABSOLUTE);
    arrive(&mut node);
    assert_eq!(position(&node), 500);
}

#[test]
fn a_shaft_without_power_coasts_until_friction_has_stopped_it() {
    let mut node = loaded(AxisLoad {
        friction_rpm_s: 10_000,
        ..AxisLoad::default()
    });
    enable(&mut node);
    set(&mut node, objects::MODE, mode::PROFILE_VELOCITY);
    set(&mut node, objects::TARGET_VELOCITY, 1_000);
    ticks(&mut node, 2_000);
    node.tick();
    command(&mut node, control::DISABLE_VOLTAGE);
    node.tick();
    let start = position(&node);
    ticks(&mut node, 300);
    // 100 ms from 1000 rpm to rest: 50 ms at 33.3 qc/ms.
    assert!((1_665..=1_668).contains(&(position(&node) - start)));
    // Without a load it stays.
    let mut node = healthy();
    enable(&mut node);
    set(&mut node, objects::MODE, mode::PROFILE_VELOCITY);
    set(&mut node, objects::TARGET_VELOCITY, 1_000);
    ticks(&mut node, 2_000);
    command(&mut node, control::DISABLE_VOLTAGE);
    node.tick();
    let start = position(&node);
    ticks(&mut node, 300);
    assert_eq!(position(&node), start);
}

#[test]
fn the_axis_falls_while_the_brake_closes_and_stops_on_it() {
    let mut node = enabled_with(BRAKE, 20, 20);
    command(&mut node, control::DISABLE_VOLTAGE);
    assert_eq!(node.brake(), BrakeState::Closed, "the output");
    ticks(&mut node, 300);
    // 20 ms free to 600 rpm, 200 qc; then 2 ms at 300,000 rpm/s, 20 qc.
    assert_eq!(position(&node), -220);
}

#[test]
fn the_axis_does_not_fall_if_the_drive_holds_until_the_brake_is_closed() {
    let mut node = enabled_with(BRAKE, 20, 25);
    go(&mut node, 5_000, control::START_ABSOLUTE);
    arrive(&mut node);
    command(&mut node, control::SHUTDOWN);
    until(&mut node, 5_000, |node| {
        state(node) == DeviceState::ReadyToSwitchOn
    });
    ticks(&mut node, 1_000);
    assert_eq!(position(&node), 5_000);
    // 10 ms too short a time in 2100: 10 ms of fall, 50 qc, and one at most to stop.
    let mut node = enabled_with(BRAKE, 20, 10);
    command(&mut node, control::SHUTDOWN);
    ticks(&mut node, 3_000);
    assert!(
        (-70..=-40).contains(&position(&node)),
        "{}",
        position(&node)
    );
}

#[test]
fn a_worn_brake_slips() {
    let mut node = enabled_with(
        HoldingBrake {
            closing_ms: 0,
            holding_rpm_s: 20_000,
            ..BRAKE
        },
        20,
        20,
    );
    command(&mut node, control::DISABLE_VOLTAGE);
    ticks(&mut node, 301);
    // A third of gravity is left: 300 * 300 / 6 qc.
    assert_eq!(position(&node), -15_000);
}

#[test]
fn a_brake_that_does_not_open_in_time_is_a_following_error() {
    let mut node = enabled_with(
        HoldingBrake {
            opening_ms: 1_000,
            ..BRAKE
        },
        20,
        20,
    );
    go(&mut node, 50_000, control::START_ABSOLUTE);
    until(&mut node, 1_000, |node| state(node) == DeviceState::Fault);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0x8611);
    assert_eq!(position(&node), 0);
}

#[test]
fn a_fitted_brake_without_an_output_stays_closed() {
    let mut node = loaded(AxisLoad {
        brake: Some(BRAKE),
        ..free()
    });
    ticks(&mut node, 1_000);
    assert_eq!(position(&node), 0);
    enable(&mut node);
    go(&mut node, 50_000, control::START_ABSOLUTE);
    until(&mut node, 1_000, |node| state(node) == DeviceState::Fault);
    assert_eq!(position(&node), 0);
}

#[test]
fn the_encoder_dithers_at_rest_under_power_only() {
    let mut node = SimulatedDrive::new(SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        initial_position: 0,
        dither_qc: 2,
        ..SimulatedDriveConfig::default()
    });
    ticks(&mut node, 100);
    assert_eq!(position(&node), 0);
    enable(&mut node);
    let mut seen = [0; 5];
    for _ in 0..1_000 {
        node.tick();
        let count = usize::try_from(position(&node) + 2).unwrap();
        seen[count] += 1;
    }
    // A fifth each: 200 with a standard deviation of 13 if they were random.
    assert!(seen.iter().all(|n| (140..=260).contains(n)), "{seen:?}");
    assert_eq!(node.segment().start, 0, "the shaft itself is still");
}
