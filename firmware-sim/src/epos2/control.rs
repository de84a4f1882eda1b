//! Device control: the CiA 402 state machine between controlword and power stage (Firmware
//! Specification, "Device Control").
//!
//! Commands without a ramp act when they are written, others from the next control cycle on.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, control, mode};
use protocol::epos2::device_error::Reaction;
use protocol::epos2::objects::{self, TypedObject};

use super::brake::StandstillTimer;
use super::node::SimulatedDrive;
use super::position_mode::PositionMode;
use super::ramp::RampShape;

/// A state transition that takes time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sequence {
    Idle,
    /// The current rises and the brake opens; then operation is enabled.
    Enabling {
        left_ms: u16,
    },
    /// Demand and shaft come to rest, the brake closes, the power is switched off.
    Leaving {
        to: DeviceState,
        step: LeavingStep,
    },
}

/// Steps of [`Sequence::Leaving`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LeavingStep {
    /// Waits for the standstill of the shaft.
    Standstill(StandstillTimer),
    /// Waits for the brake to close.
    Brake { left_ms: u16 },
}

impl Sequence {
    const fn leaving(to: DeviceState) -> Self {
        Self::Leaving {
            to,
            step: LeavingStep::Standstill(StandstillTimer::NONE),
        }
    }
}

/// Duration of "measure init" in milliseconds; not specified.
const MEASURE_MS: u16 = 2;

/// The commands of the controlword.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ControlCommand {
    Shutdown,
    SwitchOn,
    EnableOperation,
    DisableVoltage,
    QuickStop,
}

impl ControlCommand {
    /// Bits 0 to 3; `None` with bit 7, which is "fault reset" alone.
    fn of(word: u16) -> Option<Self> {
        let has = |bits| word & bits == bits;
        if has(control::FAULT_RESET) {
            None
        } else if !has(control::ENABLE_VOLTAGE_BIT) {
            Some(Self::DisableVoltage)
        } else if !has(control::QUICK_STOP_BIT) {
            Some(Self::QuickStop)
        } else if !has(control::SWITCH_ON_BIT) {
            Some(Self::Shutdown)
        } else if !has(control::ENABLE_OPERATION_BIT) {
            Some(Self::SwitchOn)
        } else {
            Some(Self::EnableOperation)
        }
    }
}

impl SimulatedDrive {
    /// Handles a write of the controlword.
    pub(super) fn command(&mut self, word: u16) {
        let old = core::mem::replace(&mut self.controlword, word);
        if self.state == DeviceState::Fault {
            if word & !old & control::FAULT_RESET != 0 {
                self.errors.acknowledge();
                self.lost_demand = false;
                self.state = DeviceState::SwitchOnDisabled;
            }
            return;
        }
        if let Some(command) = ControlCommand::of(word) {
            self.transition(command);
        }
        if self.state == DeviceState::OperationEnabled && self.sequence == Sequence::Idle {
            match self.mode {
                mode::HOMING => self.homing_command(old, word),
                // These have no setpoints; profile velocity mode reads the halt bit itself.
                mode::PROFILE_VELOCITY | mode::POSITION | mode::VELOCITY => {}
                _ => self.position_command(old, word),
            }
        }
    }

    fn transition(&mut self, command: ControlCommand) {
        use ControlCommand as C;
        use DeviceState as S;
        match (self.state, command) {
            (S::SwitchOnDisabled, C::Shutdown) => self.state = S::ReadyToSwitchOn,
            (S::ReadyToSwitchOn, C::SwitchOn) => self.state = S::SwitchedOn,
            (S::ReadyToSwitchOn | S::SwitchedOn, C::EnableOperation) => self.enable(),
            (S::SwitchedOn, C::Shutdown) => self.state = S::ReadyToSwitchOn,
            (S::ReadyToSwitchOn | S::SwitchedOn, C::DisableVoltage | C::QuickStop) => {
                self.state = S::SwitchOnDisabled;
            }
            (S::MeasureInit, C::Shutdown) => self.power_off(S::ReadyToSwitchOn),
            (S::MeasureInit, C::SwitchOn) => self.power_off(S::SwitchedOn),
            (S::MeasureInit, C::QuickStop) => self.power_off(S::SwitchOnDisabled),
            (S::OperationEnabled, C::Shutdown) => {
                self.leave(S::ReadyToSwitchOn, objects::SHUTDOWN_OPTION);
            }
            (S::OperationEnabled, C::SwitchOn) => {
                self.leave(S::SwitchedOn, objects::DISABLE_OPTION);
            }
            (S::OperationEnabled, C::QuickStop) => self.quick_stop(),
            (S::QuickStopActive, C::EnableOperation) => self.state = S::OperationEnabled,
            (S::MeasureInit | S::OperationEnabled | S::QuickStopActive, C::DisableVoltage) => {
                self.power_off(S::SwitchOnDisabled);
            }
            _ => {}
        }
    }

    /// Starts "measure init", which ends in "operation enabled".
    fn enable(&mut self) {
        self.state = DeviceState::MeasureInit;
        self.brake_released = true;
        self.position_mode = PositionMode::default();
        self.velocity_mode.abandon();
        let left_ms = MEASURE_MS.saturating_add(self.brake_ms(objects::BRAKE_RISE));
        self.sequence = Sequence::Enabling { left_ms };
    }

    /// Leaves "operation enabled" by its option code: 1 ramps down, other values stop the drive
    /// function at once.
    fn leave(&mut self, to: DeviceState, option: TypedObject<i16>) {
        if matches!(self.sequence, Sequence::Leaving { .. }) {
            return;
        }
        self.abandon_motion();
        if self.dictionary.get(option) == 1 {
            self.ramp_down(objects::PROFILE_DECELERATION);
        } else {
            self.generator.freeze();
        }
        self.sequence = Sequence::leaving(to);
    }

    /// Quick stop from "operation enabled".
    pub(super) fn quick_stop(&mut self) {
        self.abandon_motion();
        self.sequence = Sequence::Idle;
        self.ramp_down(objects::QUICK_STOP_DECELERATION);
        self.state = DeviceState::QuickStopActive;
    }

    /// Switches the power off. The demand equals the shaft's position, which stays unless the
    /// configuration has a load.
    fn power_off(&mut self, to: DeviceState) {
        self.abandon_motion();
        self.shaft.rest();
        self.generator.rest_at(self.shaft.position);
        self.brake_released = false;
        self.sequence = Sequence::Idle;
        self.state = to;
    }

    /// Ends setpoints and homing; the caller stops the shaft.
    fn abandon_motion(&mut self) {
        self.position_mode.abandon();
        self.velocity_mode.abandon();
        self.homing.abandon();
    }

    /// Ramps to rest at a deceleration, limited by 60C5. The profile type (6086) shapes the profile
    /// deceleration alone: the ramps of quick stop and homing are linear.
    pub(super) fn ramp_down(&mut self, deceleration: TypedObject<u32>) {
        let rate = self.acceleration(deceleration);
        let shape = if deceleration.address == objects::PROFILE_DECELERATION.address {
            self.profile_shape()
        } else {
            RampShape::Linear
        };
        self.generator.stop(rate, shape);
    }

    /// Shape of the ramps of profile position and profile velocity mode (6086).
    pub(super) fn profile_shape(&self) -> RampShape {
        match self.dictionary.get(objects::PROFILE_TYPE) {
            1 => RampShape::Sin2,
            _ => RampShape::Linear,
        }
    }

    /// An acceleration, limited by 60C5.
    pub(super) fn acceleration(&self, object: TypedObject<u32>) -> u32 {
        self.dictionary
            .get(object)
            .min(self.dictionary.get(objects::MAX_ACCELERATION))
    }

    /// Raises a device error: history, register and reaction.
    pub(super) fn fail(&mut self, error: DeviceError) {
        if error.is_none() {
            return;
        }
        self.errors.push(error);
        if matches!(
            self.state,
            DeviceState::Fault
                | DeviceState::FaultReactionEnabled
                | DeviceState::FaultReactionDisabled
        ) {
            return;
        }
        if !self.is_powered() {
            self.power_off(DeviceState::Fault);
            return;
        }
        let ramp = match error.reaction() {
            Reaction::Disable => None,
            Reaction::QuickStop => self.fault_ramp(),
        };
        let Some(ramp) = ramp else {
            // One control cycle of fault reaction, then fault.
            self.power_off(DeviceState::FaultReactionDisabled);
            self.sequence = Sequence::Leaving {
                to: DeviceState::Fault,
                step: LeavingStep::Brake { left_ms: 0 },
            };
            return;
        };
        self.abandon_motion();
        self.ramp_down(ramp);
        self.state = DeviceState::FaultReactionEnabled;
        self.sequence = Sequence::leaving(DeviceState::Fault);
    }

    /// Reacts to a lost master by the abort connection option code (6007): 1 as to a device error,
    /// 2 disable voltage, 3 quick stop, others none. The error is recorded in any case.
    pub(super) fn lose_connection(&mut self, error: DeviceError) {
        match self.dictionary.get(objects::ABORT_CONNECTION_OPTION) {
            1 => return self.fail(error),
            2 => self.transition(ControlCommand::DisableVoltage),
            3 => self.transition(ControlCommand::QuickStop),
            _ => {}
        }
        self.errors.push(error);
    }

    /// The ramp of the fault reaction option code (605E): 0 none, 1 slow-down, 2 and others quick
    /// stop.
    fn fault_ramp(&self) -> Option<TypedObject<u32>> {
        match self.dictionary.get(objects::FAULT_OPTION) {
            0 => None,
            1 => Some(objects::PROFILE_DECELERATION),
            _ => Some(objects::QUICK_STOP_DECELERATION),
        }
    }

    /// Advances the sequence by one millisecond.
    pub(super) fn advance_sequence(&mut self) {
        match self.sequence {
            Sequence::Idle => {}
            Sequence::Enabling { left_ms: 0 } => {
                self.sequence = Sequence::Idle;
                self.state = DeviceState::OperationEnabled;
            }
            Sequence::Enabling { left_ms } => {
                self.sequence = Sequence::Enabling {
                    left_ms: left_ms - 1,
                };
            }
            Sequence::Leaving { .. } if self.generator.is_moving() => {}
            Sequence::Leaving {
                to,
                step: LeavingStep::Standstill(mut standstill),
            } => {
                let step = if self.is_at_standstill(&mut standstill) {
                    self.brake_released = false;
                    match self.brake_ms(objects::BRAKE_FALL) {
                        0 => return self.power_off(to),
                        fall => LeavingStep::Brake { left_ms: fall - 1 },
                    }
                } else {
                    LeavingStep::Standstill(standstill)
                };
                self.sequence = Sequence::Leaving { to, step };
            }
            Sequence::Leaving {
                to,
                step: LeavingStep::Brake { left_ms: 0 },
            } => self.power_off(to),
            Sequence::Leaving {
                to,
                step: LeavingStep::Brake { left_ms },
            } => {
                let left_ms = left_ms - 1;
                self.sequence = Sequence::Leaving {
                    to,
                    step: LeavingStep::Brake { left_ms },
                };
            }
        }
    }

    /// Handles a write of 6060: the mode changes at once, and a motion of the old mode ramps down.
    pub(super) fn set_mode(&mut self, mode: i8) {
        if mode == self.mode {
            return;
        }
        self.mode = mode;
        if self.state == DeviceState::OperationEnabled && self.sequence == Sequence::Idle {
            self.abandon_motion();
            if self.generator.is_moving() {
                self.ramp_down(objects::PROFILE_DECELERATION);
            }
        }
    }
}
