//! Position mode and velocity mode, against closed forms.

extern crate std;

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, control, mode, status};
use protocol::epos2::objects::{self, TypedObject};

use super::super::{Servo, SimulatedDrive, SimulatedDriveConfig};
use super::{command, enable, enabled, get, has, healthy, position, set, state, ticks, until};

const POSITION_SETTING: TypedObject<i32> = TypedObject::new(0x2062, 0, "");
const VELOCITY_SETTING: TypedObject<i32> = TypedObject::new(0x206B, 0, "");

fn in_mode(number: i8) -> SimulatedDrive {
    let mut node = enabled();
    set(&mut node, objects::MODE, number);
    assert_eq!(get(&node, objects::MODE_DISPLAY), number);
    node
}

#[test]
fn a_position_step_is_followed_without_a_profile() {
    let mut node = in_mode(mode::POSITION);
    for setting in [500, -300, 1_000] {
        set(&mut node, POSITION_SETTING, setting);
        ticks(&mut node, 1);
        assert_eq!(get(&node, objects::POSITION_DEMAND), setting);
        // 866 qc/ms at most.
        ticks(&mut node, 2);
        assert_eq!(position(&node), setting);
    }
    assert_eq!(get(&node, objects::VELOCITY_ACTUAL), 0);
    assert!(!has(&node, status::TARGET_REACHED));
}

/// `x = d (1 - exp(-w t))`, but for the first cycle, through which the demand rises to `d`.
#[test]
fn a_position_step_has_the_step_response_of_the_servo() {
    let servo = Servo::FirstOrder {
        corner_millihertz: 5_000,
    };
    let mut node = SimulatedDrive::new(SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        initial_position: 0,
        servo: Some(servo),
        ..SimulatedDriveConfig::default()
    });
    enable(&mut node);
    set(&mut node, objects::MODE, mode::POSITION);
    set(&mut node, POSITION_SETTING, 1_500);
    let w = 2.0 * std::f64::consts::PI * 5.0 * 1e-3;
    for ms in 0..300 {
        node.tick();
        // Half a millisecond of the ramp counts.
        let t = f64::from(ms) - 0.5;
        let expected = 1_500.0 * (1.0 - (-w * t.max(0.0)).exp());
        let off = f64::from(position(&node)) - expected;
        assert!(off.abs() < 4.0, "{ms} ms: {off}");
    }
    ticks(&mut node, 200);
    assert_eq!(position(&node), 1_500);
}

#[test]
fn a_position_step_above_6065_is_a_following_error() {
    let mut node = in_mode(mode::POSITION);
    set(&mut node, POSITION_SETTING, 2_000);
    ticks(&mut node, 5);
    assert_eq!(
        (position(&node), state(&node)),
        (2_000, DeviceState::OperationEnabled)
    );
    set(&mut node, POSITION_SETTING, -1);
    ticks(&mut node, 1);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0x8611);
    until(&mut node, 100, |node| state(node) == DeviceState::Fault);
    assert!(has(&node, status::FOLLOWING_ERROR));
}

#[test]
fn a_position_beyond_607d_is_a_software_limit() {
    let mut node = in_mode(mode::POSITION);
    set(&mut node, objects::MAX_POSITION, 100);
    set(&mut node, POSITION_SETTING, 101);
    ticks(&mut node, 1);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0xFF09);
}

/// The setting value of an earlier run applies at once.
#[test]
fn an_old_position_far_away_is_a_fault_when_power_returns() {
    let mut node = healthy();
    set(&mut node, objects::MODE, mode::POSITION);
    set(&mut node, POSITION_SETTING, 30_000);
    command(&mut node, control::SHUTDOWN);
    command(&mut node, control::ENABLE_OPERATION);
    until(&mut node, 100, |node| state(node) == DeviceState::Fault);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0x8611);
    assert!(position(&node).abs() < 900, "{}", position(&node));
}

#[test]
fn a_velocity_is_reached_at_60c5_and_integrates_to_positions() {
    let mut node = in_mode(mode::VELOCITY);
    // Without a limit it is reached within the first cycle.
    set(&mut node, VELOCITY_SETTING, -600);
    ticks(&mut node, 1);
    assert_eq!(get(&node, objects::VELOCITY_ACTUAL), -600);
    ticks(&mut node, 1_000);
    // 20 qc/ms; positions are those at the end of the cycle before.
    assert!((position(&node) + 20_000).abs() <= 1, "{}", position(&node));
    set(&mut node, objects::MAX_ACCELERATION, 3_000);
    set(&mut node, VELOCITY_SETTING, 600);
    let from = get(&node, objects::POSITION_DEMAND);
    for ms in 1..=500 {
        node.tick();
        let rpm = (-600 + 3 * ms).min(600);
        assert_eq!(get(&node, objects::VELOCITY_ACTUAL), rpm, "{ms} ms");
    }
    // A reversal in 400 ms returns to its start; then 100 ms.
    assert!((get(&node, objects::POSITION_DEMAND) - from - 2_000).abs() <= 1);
    assert!(!has(&node, status::TARGET_REACHED));
    assert_eq!(state(&node), DeviceState::OperationEnabled);
}

#[test]
fn a_velocity_is_limited_by_607f_and_a_quick_stop_ends_it() {
    let mut node = in_mode(mode::VELOCITY);
    set(&mut node, objects::MAX_PROFILE_VELOCITY, 500);
    set(&mut node, VELOCITY_SETTING, 25_000);
    ticks(&mut node, 5);
    assert_eq!(get(&node, objects::VELOCITY_ACTUAL), 500);
    set(&mut node, objects::QUICK_STOP_DECELERATION, 5_000);
    command(&mut node, control::QUICK_STOP);
    let took = until(&mut node, 500, |node| {
        get(node, objects::VELOCITY_ACTUAL) == 0
    });
    assert!((100..103).contains(&took), "{took}");
    assert_eq!(state(&node), DeviceState::QuickStopActive);
    // Enabled again, the setting value applies.
    command(&mut node, control::ENABLE_OPERATION);
    ticks(&mut node, 5);
    assert_eq!(get(&node, objects::VELOCITY_ACTUAL), 500);
    // A change of mode ramps down with 6084.
    set(&mut node, objects::MODE, mode::PROFILE_POSITION);
    let took = until(&mut node, 500, |node| {
        get(node, objects::VELOCITY_ACTUAL) == 0
    });
    assert!((50..53).contains(&took), "{took}");
}

#[test]
fn a_blocked_shaft_in_velocity_mode_has_no_following_error() {
    let mut node = in_mode(mode::VELOCITY);
    set(&mut node, VELOCITY_SETTING, 1_000);
    ticks(&mut node, 50);
    node.block();
    ticks(&mut node, 1_000);
    assert_eq!(state(&node), DeviceState::OperationEnabled);
    assert_eq!(get(&node, objects::CURRENT_ACTUAL), 25_000);
}
