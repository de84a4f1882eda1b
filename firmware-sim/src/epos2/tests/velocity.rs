//! Profile velocity mode.

extern crate std;

use protocol::epos2::cia402::{DeviceState, control, mode, status};
use protocol::epos2::objects::{self, TypedObject};

use super::super::SimulatedDrive;
use super::{command, enable, enabled, get, go, has, healthy, position, set, state, ticks, until};

const WINDOW: TypedObject<u32> = TypedObject::new(0x606D, 0, "Velocity Window");
const WINDOW_TIME: TypedObject<u16> = TypedObject::new(0x606E, 0, "Velocity Window Time");
const SPEED_IS_ZERO: u16 = 1 << 12;

fn turning(rpm: i32) -> SimulatedDrive {
    let mut node = enabled();
    set(&mut node, objects::MODE, mode::PROFILE_VELOCITY);
    assert_eq!(get(&node, objects::MODE_DISPLAY), mode::PROFILE_VELOCITY);
    set(&mut node, objects::TARGET_VELOCITY, rpm);
    node
}

fn velocity(node: &SimulatedDrive) -> i32 {
    get(node, objects::VELOCITY_ACTUAL)
}

#[test]
fn the_axis_ramps_to_its_speed_and_keeps_it() {
    let mut node = turning(-600);
    set(&mut node, objects::PROFILE_ACCELERATION, 6_000);
    assert!(has(&node, SPEED_IS_ZERO));
    ticks(&mut node, 50);
    assert_eq!(velocity(&node), -300);
    assert!(!has(&node, status::TARGET_REACHED) && !has(&node, SPEED_IS_ZERO));
    let took = until(&mut node, 200, |node| has(node, status::TARGET_REACHED));
    assert!((50..53).contains(&took), "{took}");
    let from = position(&node);
    ticks(&mut node, 1000);
    // 600 rpm are 20 qc/ms.
    assert_eq!(position(&node) - from, -20_000);
    assert_eq!(velocity(&node), -600);
}

#[test]
fn a_reversal_brakes_with_6084_and_starts_with_6083() {
    let mut node = turning(1_000);
    ticks(&mut node, 200);
    set(&mut node, objects::PROFILE_DECELERATION, 20_000);
    set(&mut node, objects::PROFILE_ACCELERATION, 5_000);
    set(&mut node, objects::TARGET_VELOCITY, -1_000);
    let down = until(&mut node, 500, |node| velocity(node) <= 0);
    assert!((50..53).contains(&down), "{down}");
    let up = until(&mut node, 500, |node| has(node, status::TARGET_REACHED));
    assert!((199..203).contains(&up), "{up}");
}

/// The peak of the acceleration is 6083, so the ramp takes pi/2 times as long as a linear one.
#[test]
fn sin2_ramps_have_their_closed_form_and_a_quick_stop_is_linear() {
    use std::f64::consts::PI;
    let mut node = turning(0);
    ticks(&mut node, 2);
    set(&mut node, objects::PROFILE_TYPE, 1);
    set(&mut node, objects::PROFILE_DECELERATION, 20_000);
    set(&mut node, objects::TARGET_VELOCITY, 1_000);
    for (rate, from, to) in [(10_000.0, 0.0, 1_000.0), (20_000.0, 1_000.0, 0.0)] {
        let ramp_ms = PI / 2.0 * 1e6 / rate;
        for ms in 1..=ramp_ms as usize {
            node.tick();
            let share = (PI / 2.0 * ms as f64 / ramp_ms).sin().powi(2);
            let expected = from + (to - from) * share;
            // 606C is in whole rpm, and the mean acceleration in whole rpm/s.
            let off = f64::from(velocity(&node)) - expected;
            assert!(off.abs() < 0.6, "{ms} ms: {off}");
        }
        command(&mut node, control::HALT_MOTION);
    }
    ticks(&mut node, 5);
    assert!(has(&node, SPEED_IS_ZERO));
    command(&mut node, control::ENABLE_OPERATION);
    until(&mut node, 500, |node| velocity(node) == 1_000);
    command(&mut node, control::QUICK_STOP);
    ticks(&mut node, 50);
    assert_eq!(velocity(&node), 500);
}

#[test]
fn speed_is_limited_by_607f_and_acceleration_by_60c5() {
    let mut node = turning(20_000);
    set(&mut node, objects::MAX_PROFILE_VELOCITY, 500);
    set(&mut node, objects::MAX_ACCELERATION, 1_000);
    let took = until(&mut node, 1_000, |node| has(node, status::TARGET_REACHED));
    assert!((500..503).contains(&took), "{took}");
    assert_eq!(velocity(&node), 500);
}

#[test]
fn halt_stops_and_motion_resumes_when_it_is_cleared() {
    let mut node = turning(1_000);
    ticks(&mut node, 200);
    command(&mut node, control::HALT_MOTION);
    let took = until(&mut node, 500, |node| velocity(node) == 0);
    assert!((100..103).contains(&took), "{took}");
    ticks(&mut node, 2);
    assert!(has(&node, status::TARGET_REACHED | SPEED_IS_ZERO));
    assert_eq!(state(&node), DeviceState::OperationEnabled);
    command(&mut node, control::ENABLE_OPERATION);
    until(&mut node, 500, |node| velocity(node) == 1_000);
}

#[test]
fn quick_stop_and_disable_use_their_ramps() {
    for (word, object, to) in [
        (
            control::QUICK_STOP,
            objects::QUICK_STOP_DECELERATION,
            DeviceState::QuickStopActive,
        ),
        (
            control::SWITCH_ON,
            objects::PROFILE_DECELERATION,
            DeviceState::SwitchedOn,
        ),
    ] {
        let mut node = turning(1_000);
        ticks(&mut node, 200);
        set(&mut node, object, 5_000);
        command(&mut node, word);
        let took = until(&mut node, 500, |node| velocity(node) == 0);
        assert!((200..203).contains(&took), "{took}");
        ticks(&mut node, 2);
        assert_eq!(state(&node), to);
    }
}

#[test]
fn the_velocity_window_counts_its_time() {
    let mut node = turning(1_000);
    set(&mut node, WINDOW, 100);
    set(&mut node, WINDOW_TIME, 20);
    let took = until(&mut node, 500, |node| has(node, status::TARGET_REACHED));
    // 900 rpm after 90 ms, then 20 ms more.
    assert!((110..114).contains(&took), "{took}");
}

#[test]
fn a_software_limit_stops_the_axis_and_zero_acceleration_is_error_6320() {
    let mut node = turning(1_000);
    set(&mut node, objects::MAX_POSITION, 5_000);
    until(&mut node, 2_000, |node| state(node) == DeviceState::Fault);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0xFF09);
    let mut node = turning(0);
    ticks(&mut node, 5);
    set(&mut node, objects::PROFILE_ACCELERATION, 0);
    set(&mut node, objects::TARGET_VELOCITY, 100);
    ticks(&mut node, 3);
    assert_eq!(state(&node), DeviceState::Fault);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0x6320);
}

#[test]
fn positions_continue_when_the_mode_changes_back() {
    let mut node = turning(1_000);
    ticks(&mut node, 500);
    set(&mut node, objects::MODE, mode::PROFILE_POSITION);
    until(&mut node, 500, |node| velocity(node) == 0);
    go(&mut node, 0, control::START_ABSOLUTE);
    until(&mut node, 5_000, |node| has(node, status::TARGET_REACHED));
    assert_eq!(position(&node), 0);
}

#[test]
fn a_blocked_shaft_draws_the_limit_current_without_a_following_error() {
    let mut node = turning(1_000);
    ticks(&mut node, 300);
    node.block();
    let at = position(&node);
    ticks(&mut node, 2_000);
    assert!((position(&node) - at).abs() <= 34);
    assert_eq!(velocity(&node), 0);
    assert_eq!(state(&node), DeviceState::OperationEnabled);
    assert_eq!(get(&node, objects::CURRENT_ACTUAL), 25_000);
    let held = position(&node);
    node.unblock();
    ticks(&mut node, 30);
    // No jump: it continues from the blocked position at 33.3 qc/ms.
    assert!((950..1_050).contains(&(position(&node) - held)));
    assert_eq!(
        (velocity(&node), get(&node, objects::CURRENT_ACTUAL)),
        (1_000, 0)
    );
}

#[test]
fn modes_that_are_not_simulated_are_out_of_range() {
    let mut node = healthy();
    for number in [-6, -5, -4, -3, 0, 2, 4, 5, 7, 8] {
        let raw = objects::MODE.encode(number);
        assert_eq!(
            node.write(objects::MODE.address, raw),
            Err(super::super::AbortCode::RANGE)
        );
    }
    assert_eq!(get(&node, objects::SUPPORTED_MODES), 0x0003_0025);
    enable(&mut node);
    assert_eq!(get(&node, objects::MODE_DISPLAY), mode::PROFILE_POSITION);
}
