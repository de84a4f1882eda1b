//! Limit switches, software limits, the brake.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, control};
use protocol::epos2::objects;

use super::super::{BrakeState, Region, SimulatedDrive, SimulatedDriveConfig, Switch};
use super::{
    arrive, command, enable, enabled, get, go, healthy, position, set, state, ticks, until,
};

#[test]
fn limit_switches_do_not_stop_the_axis_by_default() {
    let mut node = enabled();
    go(&mut node, -50_000, control::START_ABSOLUTE);
    arrive(&mut node);
    assert_eq!(position(&node), -50_000);
    assert_eq!(get(&node, objects::INPUT_STATE) & 3, 1);
}

#[test]
fn a_limit_switch_in_the_execution_mask_stops_the_axis_which_can_move_away() {
    let mut node = enabled();
    set(&mut node, objects::INPUT_EXECUTION_MASK, 0x0003);
    go(&mut node, -50_000, control::START_ABSOLUTE);
    until(&mut node, 5000, |node| state(node) == DeviceState::Fault);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0xFF06);
    assert_eq!(
        get(&node, objects::ERROR_COUNT),
        1,
        "one switch gives one error, independent of the ramp"
    );
    assert_eq!(get(&node, objects::ERROR_REGISTER) & 0x80, 0x80);
    let at = position(&node);
    // 1000 rpm at 10000 rpm/s need 1667 qc to stop.
    assert!((-45_100..-44_900).contains(&at), "{at}");
    command(&mut node, control::FAULT_RESET);
    enable(&mut node);
    go(&mut node, -60_000, control::START_ABSOLUTE);
    until(&mut node, 500, |node| state(node) == DeviceState::Fault);
    assert!(position(&node) > at - 10, "moved on into the switch");
    command(&mut node, control::FAULT_RESET);
    enable(&mut node);
    go(&mut node, 0, control::START_ABSOLUTE);
    arrive(&mut node);
    assert_eq!(
        (position(&node), state(&node)),
        (0, DeviceState::OperationEnabled)
    );
}

#[test]
fn input_mask_and_polarity_take_effect() {
    let mut node = healthy();
    assert_eq!(get(&node, objects::INPUT_STATE), 0);
    set(&mut node, objects::INPUT_POLARITY, 0x0003);
    node.tick();
    assert_eq!(
        get(&node, objects::INPUT_STATE),
        3,
        "open contacts are active"
    );
    set(&mut node, objects::INPUT_MASK, 0x0001);
    node.tick();
    assert_eq!(get(&node, objects::INPUT_STATE), 1);
    // A function without an input.
    set(&mut node, objects::INPUT_6, 15);
    node.tick();
    assert_eq!(get(&node, objects::INPUT_STATE), 0);
}

#[test]
fn a_normally_closed_switch_is_low_when_pressed() {
    let mut config = SimulatedDriveConfig {
        fault_at_power_on: DeviceError::NONE,
        ..SimulatedDriveConfig::default()
    };
    config.switches[0] = Some(Switch {
        input: 6,
        pressed: Region::AtMost(-43_334),
        normally_closed: true,
    });
    let mut node = SimulatedDrive::new(config);
    assert_eq!(get(&node, objects::INPUT_STATE), 1);
    set(&mut node, objects::INPUT_POLARITY, 0x0001);
    node.tick();
    assert_eq!(get(&node, objects::INPUT_STATE), 0);
}

#[test]
fn software_limits_refuse_targets_and_stop_an_axis_that_crosses_them() {
    let mut node = enabled();
    set(&mut node, objects::MAX_POSITION, 10_000);
    go(&mut node, 10_001, control::START_ABSOLUTE);
    ticks(&mut node, 3);
    assert_eq!((state(&node), position(&node)), (DeviceState::Fault, 0));
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0xFF09);
    command(&mut node, control::FAULT_RESET);
    enable(&mut node);
    go(&mut node, 10_000, control::START_ABSOLUTE);
    arrive(&mut node);
    // At full speed towards the limit a target just past it needs more braking distance than
    // available.
    go(&mut node, -10_000, control::START_ABSOLUTE);
    arrive(&mut node);
    set(&mut node, objects::MAX_POSITION, 0);
    go(&mut node, -100, control::START_ABSOLUTE);
    until(&mut node, 5000, |node| position(node) > -2_000);
    set(&mut node, objects::PROFILE_DECELERATION, 1_000);
    go(&mut node, -100, control::START_ABSOLUTE_AT_ONCE);
    until(&mut node, 5000, |node| state(node) == DeviceState::Fault);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0xFF09);
    // Back into the range from outside.
    assert!(position(&node) > 0);
    command(&mut node, control::FAULT_RESET);
    enable(&mut node);
    go(&mut node, -5_000, control::START_ABSOLUTE);
    arrive(&mut node);
    assert_eq!(position(&node), -5_000);
}

#[test]
fn the_brake_opens_before_and_closes_after() {
    let mut node = healthy();
    assert_eq!(node.brake(), BrakeState::Absent);
    set(&mut node, objects::OUTPUT_1, objects::OUTPUT_BRAKE);
    assert_eq!(
        node.brake(),
        BrakeState::Absent,
        "the output mask disables it"
    );
    set(&mut node, objects::OUTPUT_MASK, 1 << 2);
    set(&mut node, objects::BRAKE_RISE, 50);
    set(&mut node, objects::BRAKE_FALL, 30);
    assert_eq!(
        (node.brake(), get(&node, objects::OUTPUT_STATE)),
        (BrakeState::Closed, 4)
    );
    command(&mut node, control::SHUTDOWN);
    command(&mut node, control::ENABLE_OPERATION);
    assert_eq!(
        (node.brake(), get(&node, objects::OUTPUT_STATE)),
        (BrakeState::Open, 0)
    );
    let took = until(&mut node, 200, |node| {
        state(node) == DeviceState::OperationEnabled
    });
    assert!((50..55).contains(&took), "{took}");
    go(&mut node, 100_000, control::START_ABSOLUTE);
    ticks(&mut node, 300);
    command(&mut node, control::SWITCH_ON);
    let ramp = until(&mut node, 200, |node| node.brake() == BrakeState::Closed);
    // 100 ms of ramp, then 50 ms of standstill.
    assert!((150..154).contains(&ramp), "{ramp}");
    assert_eq!(get(&node, objects::VELOCITY_ACTUAL), 0);
    assert_eq!(
        state(&node),
        DeviceState::OperationEnabled,
        "the motor holds while the brake closes"
    );
    let fall = until(&mut node, 200, |node| {
        state(node) == DeviceState::SwitchedOn
    });
    assert!((29..33).contains(&fall), "{fall}");
}

#[test]
fn waiting_for_standstill_ends_at_its_timeout() {
    let mut node = healthy();
    set(&mut node, objects::OUTPUT_1, objects::OUTPUT_BRAKE);
    set(&mut node, objects::OUTPUT_MASK, 1 << 2);
    set(&mut node, objects::STANDSTILL_TIME, 5_000);
    set(&mut node, objects::STANDSTILL_TIMEOUT, 200);
    enable(&mut node);
    command(&mut node, control::SWITCH_ON);
    let took = until(&mut node, 1_000, |node| node.brake() == BrakeState::Closed);
    assert!((200..203).contains(&took), "{took}");
    // A fault reaction with a ramp does the same.
    until(&mut node, 100, |node| {
        state(node) == DeviceState::SwitchedOn
    });
    set(&mut node, objects::STANDSTILL_TIME, 50);
    command(&mut node, control::ENABLE_OPERATION);
    until(&mut node, 100, |node| {
        state(node) == DeviceState::OperationEnabled
    });
    node.inject(DeviceError::FOLLOWING);
    let took = until(&mut node, 1_000, |node| state(node) == DeviceState::Fault);
    // Standstill and the brake's 10 ms.
    assert!((60..64).contains(&took), "{took}");
}
