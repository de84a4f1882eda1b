//! Device control: the CiA 402 state machine between controlword and power stage (Firmware Specification, "Device Control").
//!
//! Commands without a ramp act when they are written, the others from the next control cycle on.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{State, control, mode};
use protocol::epos2::device_error::Reaction;
use protocol::epos2::objects::{self, Object};

use super::brake::StandstillTimer;
use super::node::Node;
use super::position_mode::PositionMode;

/// Something that takes the state machine time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sequence {
    Idle,
    /// Current comes up and the brake opens, then operation is enabled.
    Enabling {
        left_ms: u16,
    },
    /// The demand comes to rest, then the shaft, the brake closes, then the power goes off.
    Leaving {
        to: State,
        step: LeavingStep,
    },
}

/// What a [`Sequence::Leaving`] waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LeavingStep {
    /// The shaft to stand: how long it has, and how long that was waited for.
    StandstillTimer(StandstillTimer),
    /// The brake to close.
    Brake { left_ms: u16 },
}

impl Sequence {
    const fn leaving(to: State) -> Self {
        Self::Leaving {
            to,
            step: LeavingStep::StandstillTimer(StandstillTimer::NONE),
        }
    }
}

/// Milliseconds of "measure init"; the specification gives none.
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
    /// Bits 0 to 3; `None` with bit 7 set, which is "fault reset" alone.
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

impl Node {
    /// A controlword was written.
    pub(super) fn command(&mut self, word: u16) {
        let old = core::mem::replace(&mut self.controlword, word);
        if self.state == State::Fault {
            if word & !old & control::FAULT_RESET != 0 {
                self.errors.acknowledge();
                self.lost_demand = false;
                self.state = State::SwitchOnDisabled;
            }
            return;
        }
        if let Some(command) = ControlCommand::of(word) {
            self.transition(command);
        }
        if self.state == State::OperationEnabled && self.sequence == Sequence::Idle {
            match self.mode {
                mode::HOMING => self.homing_command(old, word),
                // The mode looks at the halt bit itself.
                mode::PROFILE_VELOCITY => {}
                _ => self.position_command(old, word),
            }
        }
    }

    fn transition(&mut self, command: ControlCommand) {
        use ControlCommand as C;
        use State as S;
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

    /// Through "measure init" to "operation enabled".
    fn enable(&mut self) {
        self.state = State::MeasureInit;
        self.brake_released = true;
        self.position_mode = PositionMode::default();
        self.velocity_mode.abandon();
        let left_ms = MEASURE_MS.saturating_add(self.brake_rise_ms());
        self.sequence = Sequence::Enabling { left_ms };
    }

    /// Out of "operation enabled" by its option code: 1 is the slow-down ramp, anything else stops the drive function at once.
    fn leave(&mut self, to: State, option: Object<i16>) {
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

    /// From "operation enabled".
    pub(super) fn quick_stop(&mut self) {
        self.abandon_motion();
        self.sequence = Sequence::Idle;
        self.ramp_down(objects::QUICK_STOP_DECELERATION);
        self.state = State::QuickStopActive;
    }

    /// Power off now. The shaft stays where it is: without friction or load there is nothing else for it to do. The demand is
    /// where the shaft is from now on.
    fn power_off(&mut self, to: State) {
        self.abandon_motion();
        self.shaft.rest();
        self.generator.rest_at(self.shaft.position());
        self.brake_released = false;
        self.sequence = Sequence::Idle;
        self.state = to;
    }

    /// Neither setpoint nor homing is under way any more; what the shaft does is the caller's next line.
    fn abandon_motion(&mut self) {
        self.position_mode.abandon();
        self.velocity_mode.abandon();
        self.homing.abandon();
    }

    /// Comes to rest at a deceleration, within the largest there is (60C5).
    pub(super) fn ramp_down(&mut self, deceleration: Object<u32>) {
        let rate = self.acceleration(deceleration);
        self.generator.stop(rate);
    }

    /// An acceleration within the largest there is (60C5).
    pub(super) fn acceleration(&self, object: Object<u32>) -> u32 {
        self.dictionary
            .get(object)
            .min(self.dictionary.get(objects::MAX_ACCELERATION))
    }

    /// A device error happens: history, register and its reaction.
    pub(super) fn fail(&mut self, error: DeviceError) {
        if error.is_none() {
            return;
        }
        self.errors.push(error);
        if matches!(
            self.state,
            State::Fault | State::FaultReactionEnabled | State::FaultReactionDisabled
        ) {
            return;
        }
        if !self.is_powered() {
            self.power_off(State::Fault);
            return;
        }
        let ramp = match error.reaction() {
            Reaction::Disable => None,
            Reaction::QuickStop => self.fault_ramp(),
        };
        let Some(ramp) = ramp else {
            // One control cycle of "fault reaction", then fault.
            self.power_off(State::FaultReactionDisabled);
            self.sequence = Sequence::Leaving {
                to: State::Fault,
                step: LeavingStep::Brake { left_ms: 0 },
            };
            return;
        };
        self.abandon_motion();
        self.ramp_down(ramp);
        self.state = State::FaultReactionEnabled;
        self.sequence = Sequence::leaving(State::Fault);
    }

    /// The ramp of the fault reaction option code (605E): 0 none, 1 slow-down, 2 quick stop; others are taken for 2.
    fn fault_ramp(&self) -> Option<Object<u32>> {
        match self.dictionary.get(objects::FAULT_OPTION) {
            0 => None,
            1 => Some(objects::PROFILE_DECELERATION),
            _ => Some(objects::QUICK_STOP_DECELERATION),
        }
    }

    /// One millisecond of what is under way.
    pub(super) fn advance_sequence(&mut self) {
        match self.sequence {
            Sequence::Idle => {}
            Sequence::Enabling { left_ms: 0 } => {
                self.sequence = Sequence::Idle;
                self.state = State::OperationEnabled;
            }
            Sequence::Enabling { left_ms } => {
                self.sequence = Sequence::Enabling {
                    left_ms: left_ms - 1,
                };
            }
            Sequence::Leaving { .. } if self.generator.is_moving() => {}
            Sequence::Leaving {
                to,
                step: LeavingStep::StandstillTimer(mut standstill),
            } => {
                let step = if self.stands(&mut standstill) {
                    self.brake_released = false;
                    match self.brake_fall_ms() {
                        0 => return self.power_off(to),
                        fall => LeavingStep::Brake { left_ms: fall - 1 },
                    }
                } else {
                    LeavingStep::StandstillTimer(standstill)
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

    /// 6060 was written: the mode changes at once, and what the old one had under way ends in a ramp.
    pub(super) fn set_mode(&mut self, mode: i8) {
        if mode == self.mode {
            return;
        }
        self.mode = mode;
        if self.state == State::OperationEnabled && self.sequence == Sequence::Idle {
            self.abandon_motion();
            if self.generator.is_moving() {
                self.ramp_down(objects::PROFILE_DECELERATION);
            }
        }
    }
}
