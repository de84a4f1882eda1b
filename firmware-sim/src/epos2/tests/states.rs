//! The state machine (Firmware Specification, "Device Control"; CiA 402).

use protocol::canopen::nmt::NmtCommand;
use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, control};
use protocol::epos2::objects;

use super::super::{SimulatedDrive, SimulatedDriveConfig};
use super::{command, enabled, get, go, healthy, position, set, state, ticks, until};

#[test]
fn enabling_and_disabling_pass_through_every_state() {
    let mut node = healthy();
    assert_eq!(state(&node), DeviceState::SwitchOnDisabled);
    command(&mut node, control::ENABLE_OPERATION);
    assert_eq!(
        state(&node),
        DeviceState::SwitchOnDisabled,
        "enabling requires a shutdown command first"
    );
    command(&mut node, control::SHUTDOWN);
    assert_eq!(state(&node), DeviceState::ReadyToSwitchOn);
    command(&mut node, control::SWITCH_ON);
    assert_eq!(state(&node), DeviceState::SwitchedOn);
    command(&mut node, control::ENABLE_OPERATION);
    assert_eq!(state(&node), DeviceState::MeasureInit);
    until(&mut node, 10, |node| {
        state(node) == DeviceState::OperationEnabled
    });
    command(&mut node, control::SWITCH_ON);
    ticks(&mut node, 2);
    assert_eq!(state(&node), DeviceState::SwitchedOn);
    command(&mut node, control::SHUTDOWN);
    assert_eq!(state(&node), DeviceState::ReadyToSwitchOn);
    command(&mut node, control::DISABLE_VOLTAGE);
    assert_eq!(state(&node), DeviceState::SwitchOnDisabled);
}

#[test]
fn enabling_from_ready_to_switch_on_passes_switched_on_automatically() {
    let node = enabled();
    assert_eq!(get(&node, objects::STATUSWORD), 0x0137);
}

#[test]
fn nmt_start_shows_in_bit_9() {
    let mut node = enabled();
    node.nmt(NmtCommand::Start);
    assert_eq!(get(&node, objects::STATUSWORD), 0x0337);
    node.nmt(NmtCommand::EnterPreOperational);
    assert_eq!(get(&node, objects::STATUSWORD), 0x0137);
}

#[test]
fn the_fault_of_a_unit_without_can_is_cleared_by_a_rising_bit_7() {
    let mut node = SimulatedDrive::new(SimulatedDriveConfig::default());
    assert_eq!(state(&node), DeviceState::Fault);
    assert_eq!(get(&node, objects::ERROR_COUNT), 1);
    assert_eq!(get(&node, objects::ERROR_HISTORY_1), 0x8120);
    assert_eq!(get(&node, objects::ERROR_REGISTER), 0x11);
    command(&mut node, control::SHUTDOWN);
    assert_eq!(state(&node), DeviceState::Fault);
    command(&mut node, control::FAULT_RESET);
    assert_eq!(state(&node), DeviceState::SwitchOnDisabled);
    assert_eq!(get(&node, objects::ERROR_REGISTER), 0);
    assert_eq!(get(&node, objects::ERROR_COUNT), 1, "the history is kept");
    // The bit is still set: no edge, no reset.
    node.inject(DeviceError::OVERVOLTAGE);
    command(&mut node, control::FAULT_RESET);
    assert_eq!(state(&node), DeviceState::Fault);
    command(&mut node, 0);
    command(&mut node, control::FAULT_RESET);
    assert_eq!(state(&node), DeviceState::SwitchOnDisabled);
    node.power_cycle();
    assert_eq!(state(&node), DeviceState::Fault);
}

#[test]
fn errors_that_ramp_and_errors_that_do_not() {
    for (error, ramps) in [
        (DeviceError::CAN_LIFE_GUARD, true),
        (DeviceError::OVERCURRENT, false),
    ] {
        let mut node = enabled();
        go(&mut node, 100_000, control::START_ABSOLUTE);
        ticks(&mut node, 300); // 1000 rpm are reached after 100 ms
        node.inject(error);
        let at = position(&node);
        let expected = if ramps {
            DeviceState::FaultReactionEnabled
        } else {
            DeviceState::FaultReactionDisabled
        };
        assert_eq!(state(&node), expected);
        let took = until(&mut node, 1000, |node| state(node) == DeviceState::Fault);
        // 1000 rpm at 10000 rpm/s: 100 ms, half of 33.3 qc/ms.
        let way = position(&node) - at;
        if ramps {
            assert!((100..104).contains(&took), "{took}");
            assert!((1650..1720).contains(&way), "{way}");
        } else {
            assert!(took <= 2, "{took}");
            assert!(way <= 34, "{way}");
        }
        assert_eq!(get(&node, objects::ERROR_HISTORY_1), u32::from(error.0));
    }
}

#[test]
fn quick_stop_ramps_holds_and_is_left_by_enable() {
    let mut node = enabled();
    go(&mut node, 100_000, control::START_ABSOLUTE);
    ticks(&mut node, 300);
    set(&mut node, objects::QUICK_STOP_DECELERATION, 20_000);
    command(&mut node, control::QUICK_STOP);
    assert_eq!(state(&node), DeviceState::QuickStopActive);
    let took = until(&mut node, 1000, |node| {
        get(node, objects::VELOCITY_ACTUAL) == 0
    });
    assert!((49..53).contains(&took), "{took}");
    ticks(&mut node, 500);
    assert_eq!(state(&node), DeviceState::QuickStopActive);
    let at = position(&node);
    command(&mut node, control::ENABLE_OPERATION);
    ticks(&mut node, 100);
    assert_eq!(
        (state(&node), position(&node)),
        (DeviceState::OperationEnabled, at)
    );
    command(&mut node, control::QUICK_STOP);
    command(&mut node, control::DISABLE_VOLTAGE);
    assert_eq!(state(&node), DeviceState::SwitchOnDisabled);
}
