//! The device control state machine's words: statusword, controlword, modes (Firmware Specification, "Device Control"; CiA 402).
//!
//! Names and bits only; who may go where is the device's business, which way to take the client's.

use core::fmt;

/// States as the statusword shows them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum State {
    /// Boot-up.
    Start,
    /// Current offset is being measured.
    NotReadyToSwitchOn,
    /// Initialised; drive function disabled.
    SwitchOnDisabled,
    /// Ready for "switch on".
    ReadyToSwitchOn,
    /// Power stage on, no drive function.
    SwitchedOn,
    /// Power stage refresh.
    Refresh,
    /// Power applied, first current measurement.
    MeasureInit,
    /// Drive function enabled, the motor holds or moves.
    OperationEnabled,
    /// Ramping down or stopped after "quick stop", power still on.
    QuickStopActive,
    /// An error is being dealt with, drive function already off.
    FaultReactionDisabled,
    /// An error is being dealt with, drive function still on.
    FaultReactionEnabled,
    /// Error; power off until it is reset.
    Fault,
}

impl State {
    /// The bits of the statusword that make the state.
    pub const MASK: u16 = 0x417F;

    /// All states with their pattern under [`State::MASK`].
    pub const PATTERNS: [(Self, u16); 12] = [
        (Self::Start, 0x0000),
        (Self::NotReadyToSwitchOn, 0x0100),
        (Self::SwitchOnDisabled, 0x0140),
        (Self::ReadyToSwitchOn, 0x0121),
        (Self::SwitchedOn, 0x0123),
        (Self::Refresh, 0x4123),
        (Self::MeasureInit, 0x4133),
        (Self::OperationEnabled, 0x0137),
        (Self::QuickStopActive, 0x0117),
        (Self::FaultReactionDisabled, 0x010F),
        (Self::FaultReactionEnabled, 0x011F),
        (Self::Fault, 0x0108),
    ];

    /// The state of a statusword; `None` where its bits make none.
    #[must_use]
    pub fn from_statusword(statusword: u16) -> Option<Self> {
        Self::PATTERNS
            .iter()
            .find(|(_, pattern)| *pattern == statusword & Self::MASK)
            .map(|&(state, _)| state)
    }

    /// The bits that this state sets in the statusword.
    #[must_use]
    pub const fn pattern(self) -> u16 {
        match self {
            Self::Start => 0x0000,
            Self::NotReadyToSwitchOn => 0x0100,
            Self::SwitchOnDisabled => 0x0140,
            Self::ReadyToSwitchOn => 0x0121,
            Self::SwitchedOn => 0x0123,
            Self::Refresh => 0x4123,
            Self::MeasureInit => 0x4133,
            Self::OperationEnabled => 0x0137,
            Self::QuickStopActive => 0x0117,
            Self::FaultReactionDisabled => 0x010F,
            Self::FaultReactionEnabled => 0x011F,
            Self::Fault => 0x0108,
        }
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::NotReadyToSwitchOn => "not ready to switch on",
            Self::SwitchOnDisabled => "switch-on disabled",
            Self::ReadyToSwitchOn => "ready to switch on",
            Self::SwitchedOn => "switched on",
            Self::Refresh => "refresh",
            Self::MeasureInit => "measure init",
            Self::OperationEnabled => "operation enabled",
            Self::QuickStopActive => "quick stop active",
            Self::FaultReactionDisabled => "fault reaction active (disabled)",
            Self::FaultReactionEnabled => "fault reaction active (enabled)",
            Self::Fault => "fault",
        })
    }
}

/// Bits of the statusword (6041).
pub mod status {
    /// Voltage applied to the motor (part of the state's pattern).
    pub const VOLTAGE_ENABLED: u16 = 1 << 4;
    /// A warning is pending (not used by the EPOS2).
    pub const WARNING: u16 = 1 << 7;
    /// Current offset has been measured (part of the state's pattern).
    pub const OFFSET_MEASURED: u16 = 1 << 8;
    /// NMT state is operational.
    pub const REMOTE: u16 = 1 << 9;
    /// Target reached; at a halt: standing still.
    pub const TARGET_REACHED: u16 = 1 << 10;
    /// Current is limited by I2t.
    pub const I2T: u16 = 1 << 11;
    /// Profile position: the setpoint bit has been seen.
    pub const SETPOINT_ACKNOWLEDGE: u16 = 1 << 12;
    /// Homing: reference found. The same bit as [`SETPOINT_ACKNOWLEDGE`].
    pub const HOMING_ATTAINED: u16 = 1 << 12;
    /// Profile position: following error.
    pub const FOLLOWING_ERROR: u16 = 1 << 13;
    /// Homing: failed. The same bit as [`FOLLOWING_ERROR`].
    pub const HOMING_ERROR: u16 = 1 << 13;
    /// The power stage is refreshed (part of the state's pattern).
    pub const REFRESH: u16 = 1 << 14;
    /// Position is referenced to home.
    pub const REFERENCED: u16 = 1 << 15;
}

/// The controlword (6040): commands, and bits that a mode adds.
pub mod control {
    /// Bit 0.
    pub const SWITCH_ON_BIT: u16 = 1 << 0;
    /// Bit 1.
    pub const ENABLE_VOLTAGE_BIT: u16 = 1 << 1;
    /// Bit 2, low for a quick stop.
    pub const QUICK_STOP_BIT: u16 = 1 << 2;
    /// Bit 3.
    pub const ENABLE_OPERATION_BIT: u16 = 1 << 3;
    /// Profile position: take the target on the rising edge.
    pub const NEW_SETPOINT: u16 = 1 << 4;
    /// Homing: start on the rising edge. The same bit as [`NEW_SETPOINT`].
    pub const HOMING_START: u16 = 1 << 4;
    /// Profile position: break off the present move for the new one.
    pub const AT_ONCE: u16 = 1 << 5;
    /// Profile position: the target counts from the present demand.
    pub const RELATIVE: u16 = 1 << 6;
    /// Fault reset on the rising edge.
    pub const FAULT_RESET: u16 = 1 << 7;
    /// Stop with the profile deceleration and stay.
    pub const HALT: u16 = 1 << 8;

    /// Power stage off.
    pub const DISABLE_VOLTAGE: u16 = 0x0000;
    /// To "ready to switch on".
    pub const SHUTDOWN: u16 = 0x0006;
    /// To "switched on".
    pub const SWITCH_ON: u16 = 0x0007;
    /// To "operation enabled", by itself through "switched on".
    pub const ENABLE_OPERATION: u16 = 0x000F;
    /// Ramp down with the quick-stop deceleration (bit 3 as in "operation enabled").
    pub const QUICK_STOP: u16 = 0x000B;
    /// Absolute move after the present one.
    pub const START_ABSOLUTE: u16 = 0x001F;
    /// Absolute move now.
    pub const START_ABSOLUTE_AT_ONCE: u16 = 0x003F;
    /// Relative move after the present one.
    pub const START_RELATIVE: u16 = 0x005F;
    /// Relative move now.
    pub const START_RELATIVE_AT_ONCE: u16 = 0x007F;
    /// Start homing.
    pub const START_HOMING: u16 = 0x001F;
    /// Halt, operation stays enabled.
    pub const HALT_MOTION: u16 = 0x010F;
}

/// Modes of operation (6060, 6061) that the tilt axis uses or may meet.
pub mod mode {
    /// Moves to a target with a profile.
    pub const PROFILE_POSITION: i8 = 1;
    /// Turns at a speed with a profile.
    pub const PROFILE_VELOCITY: i8 = 3;
    /// Finds the reference.
    pub const HOMING: i8 = 6;
    /// Follows positions that the master interpolates.
    pub const INTERPOLATED_POSITION: i8 = 7;
    /// maxon: position without profile.
    pub const POSITION: i8 = -1;
    /// maxon: velocity without profile.
    pub const VELOCITY: i8 = -2;
    /// maxon: current.
    pub const CURRENT: i8 = -3;
    /// maxon: diagnostic.
    pub const DIAGNOSTIC: i8 = -4;
    /// maxon: master encoder.
    pub const MASTER_ENCODER: i8 = -5;
    /// maxon: step and direction.
    pub const STEP_DIRECTION: i8 = -6;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_differ_and_read_back() {
        for (state, pattern) in State::PATTERNS {
            assert_eq!(state.pattern(), pattern);
            assert_eq!(pattern & !State::MASK, 0);
            for other in [0x0000, 0x0200, 0x8480, 0xBE80] {
                assert_eq!(State::from_statusword(pattern | other), Some(state));
            }
        }
    }

    #[test]
    fn other_bits_do_not_matter_and_missing_ones_do() {
        assert_eq!(State::from_statusword(0x0237), None); // bit 8 missing
        assert_eq!(
            State::from_statusword(0x0337),
            Some(State::OperationEnabled)
        );
        assert_eq!(
            State::from_statusword(0x9737),
            Some(State::OperationEnabled)
        );
        assert_eq!(
            State::from_statusword(0x0140),
            Some(State::SwitchOnDisabled)
        );
    }
}
