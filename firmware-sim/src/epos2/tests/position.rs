//! Profile position mode, and the encoder between two control cycles.

use protocol::epos2::cia402::{DeviceState, control, status};
use protocol::epos2::objects;

use super::super::SimulatedDrive;
use super::{arrive, command, enabled, get, go, has, position, set, state, ticks, until};

#[test]
fn the_papers_sweep_takes_its_time() {
    let mut node = enabled();
    set(&mut node, objects::PROFILE_VELOCITY, 1125);
    go(&mut node, 30_000, control::START_ABSOLUTE);
    assert!(has(&node, status::SETPOINT_ACKNOWLEDGE));
    assert!(!has(&node, status::TARGET_REACHED));
    command(&mut node, control::ENABLE_OPERATION);
    assert!(!has(&node, status::SETPOINT_ACKNOWLEDGE));
    let mut fastest = 0;
    let took = until(&mut node, 2000, |node| has(node, status::TARGET_REACHED));
    // 45 deg at 56.25 deg/s and one ramp of 0.1125 s, one cycle to start and one to detect the end.
    assert!((913..917).contains(&took), "{took}");
    assert_eq!(position(&node), 30_000);
    go(&mut node, 0, control::START_ABSOLUTE);
    while !has(&node, status::TARGET_REACHED) {
        node.tick();
        fastest = fastest.min(get(&node, objects::VELOCITY_ACTUAL));
    }
    assert_eq!((position(&node), fastest), (0, -1125));
}

#[test]
fn sin2_ramps_lengthen_the_sweep_by_pi_half_minus_1_ramps() {
    let mut node = enabled();
    set(&mut node, objects::PROFILE_VELOCITY, 1125);
    set(&mut node, objects::PROFILE_TYPE, 1);
    go(&mut node, 30_000, control::START_ABSOLUTE);
    let took = until(&mut node, 2000, |node| has(node, status::TARGET_REACHED));
    // 800 ms at 56.25 deg/s and one ramp of pi/2 x 112.5 ms.
    assert!((977..981).contains(&took), "{took}");
    assert_eq!(position(&node), 30_000);
    // A halt from full speed has the same ramp.
    go(&mut node, 0, control::START_ABSOLUTE);
    ticks(&mut node, 400);
    assert_eq!(get(&node, objects::VELOCITY_ACTUAL), -1125);
    let from = get(&node, objects::POSITION_DEMAND);
    command(&mut node, control::HALT_MOTION);
    let took = until(&mut node, 500, |node| has(node, status::TARGET_REACHED));
    assert!((177..181).contains(&took), "{took}");
    // At the mean of the speed, 18,750 qc/s.
    assert!((position(&node) - from + 3_313).abs() <= 2);
}

#[test]
fn speed_and_acceleration_are_limited_by_607f_and_60c5() {
    let mut node = enabled();
    set(&mut node, objects::PROFILE_VELOCITY, 20_000);
    set(&mut node, objects::MAX_PROFILE_VELOCITY, 600);
    set(&mut node, objects::PROFILE_ACCELERATION, u32::MAX);
    set(&mut node, objects::MAX_ACCELERATION, 1_000);
    go(&mut node, 20_000, control::START_ABSOLUTE);
    let mut last = 0;
    while !has(&node, status::TARGET_REACHED) {
        node.tick();
        let speed = get(&node, objects::VELOCITY_DEMAND);
        assert!(speed <= 600 && (speed - last).abs() <= 1);
        last = speed;
    }
    assert_eq!(position(&node), 20_000);
}

#[test]
fn a_setpoint_waits_for_the_move_unless_immediate() {
    let mut node = enabled();
    go(&mut node, 10_000, control::START_ABSOLUTE);
    ticks(&mut node, 150);
    go(&mut node, 5_000, control::START_ABSOLUTE);
    assert!(
        !has(&node, status::SETPOINT_ACKNOWLEDGE),
        "not accepted yet"
    );
    until(&mut node, 1000, |node| {
        has(node, status::SETPOINT_ACKNOWLEDGE)
    });
    assert_eq!(position(&node), 10_000);
    arrive(&mut node);
    assert_eq!(position(&node), 5_000);
    go(&mut node, 50_000, control::START_ABSOLUTE);
    ticks(&mut node, 200);
    go(&mut node, 0, control::START_ABSOLUTE_AT_ONCE);
    assert!(has(&node, status::SETPOINT_ACKNOWLEDGE));
    arrive(&mut node);
    assert_eq!(position(&node), 0);
}

#[test]
fn relative_moves_count_from_the_demand() {
    let mut node = enabled();
    go(&mut node, 1_000, control::START_RELATIVE);
    arrive(&mut node);
    go(&mut node, -300, control::START_RELATIVE);
    arrive(&mut node);
    assert_eq!(position(&node), 700);
    go(&mut node, 40_000, control::START_ABSOLUTE);
    ticks(&mut node, 500);
    let demand = get(&node, objects::POSITION_DEMAND);
    go(&mut node, 0, control::START_RELATIVE_AT_ONCE);
    arrive(&mut node);
    assert_eq!(position(&node), demand);
}

#[test]
fn halt_stops_and_cancels_the_move() {
    let mut node = enabled();
    go(&mut node, 100_000, control::START_ABSOLUTE);
    ticks(&mut node, 300);
    command(&mut node, control::HALT_MOTION);
    let took = arrive(&mut node);
    assert!((100..104).contains(&took), "{took}");
    let at = position(&node);
    assert!(at < 12_000);
    // Setpoints are not accepted during a halt.
    command(&mut node, control::HALT_MOTION | control::NEW_SETPOINT);
    command(&mut node, control::ENABLE_OPERATION);
    ticks(&mut node, 500);
    assert_eq!(
        (position(&node), state(&node)),
        (at, DeviceState::OperationEnabled)
    );
    go(&mut node, 0, control::START_ABSOLUTE);
    arrive(&mut node);
    assert_eq!(position(&node), 0);
}

#[test]
fn target_reached_waits_for_the_position_window() {
    let mut node = enabled();
    set(&mut node, objects::POSITION_WINDOW, 5);
    set(&mut node, objects::POSITION_WINDOW_TIME, 100);
    go(&mut node, 0, control::START_ABSOLUTE);
    let took = arrive(&mut node);
    assert!((100..103).contains(&took), "{took}");
}

#[test]
fn a_move_of_zero_distance_is_reached_at_the_next_cycle() {
    let mut node = enabled();
    go(&mut node, 0, control::START_ABSOLUTE);
    assert!(!has(&node, status::TARGET_REACHED));
    assert!(arrive(&mut node) <= 2);
}

#[test]
fn a_target_too_far_for_its_speed_is_error_6320() {
    let mut node = enabled();
    set(&mut node, objects::PROFILE_VELOCITY, 0);
    go(&mut node, 1, control::START_ABSOLUTE);
    ticks(&mut node, 3);
    assert_eq!(state(&node), DeviceState::Fault);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0x6320);
}

#[test]
fn disable_operation_ramps_and_shutdown_does_not() {
    for (word, to, slowest) in [
        (control::SWITCH_ON, DeviceState::SwitchedOn, 100),
        (control::SHUTDOWN, DeviceState::ReadyToSwitchOn, 1),
    ] {
        let mut node = enabled();
        go(&mut node, 100_000, control::START_ABSOLUTE);
        ticks(&mut node, 300);
        command(&mut node, word);
        let took = until(&mut node, 1000, |node| state(node) == to);
        assert!((slowest..slowest + 3).contains(&took), "{took}");
    }
}

#[test]
fn the_encoder_is_read_at_the_time_of_the_request() {
    let mut node = enabled();
    set(&mut node, objects::PROFILE_VELOCITY, 600); // 20 qc/ms
    set(&mut node, objects::PROFILE_ACCELERATION, u32::MAX);
    go(&mut node, 10_000, control::START_ABSOLUTE);
    ticks(&mut node, 10);
    let segment = node.segment();
    assert_eq!((segment.end - segment.start) >> 32, 20);
    let read = |node: &mut SimulatedDrive, phase| {
        node.set_phase_us(phase);
        position(node)
    };
    let start = read(&mut node, 0);
    assert_eq!(i64::from(start), segment.start >> 32);
    assert_eq!(read(&mut node, 500), start + 10);
    assert_eq!(i64::from(read(&mut node, 1000)), segment.end >> 32);
    node.tick();
    assert_eq!(node.segment().start, segment.end, "no gap");
}
