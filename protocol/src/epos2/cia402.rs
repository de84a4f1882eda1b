//! The words of the device control state machine: statusword, controlword, modes of operation
//! (Firmware Specification, "Device Control"; CiA 402).

use core::fmt;

/// A device state; the discriminant is its pattern in the statusword.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u16)]
pub enum DeviceState {
    /// Boot-up.
    Start = 0x0000,
    /// Current offset is being measured.
    NotReadyToSwitchOn = 0x0100,
    /// Initialised; drive function disabled.
    SwitchOnDisabled = 0x0140,
    /// Ready for "switch on".
    ReadyToSwitchOn = 0x0121,
    /// Power stage on, no drive function.
    SwitchedOn = 0x0123,
    /// Power stage refresh.
    Refresh = 0x4123,
    /// Power applied, first current measurement.
    MeasureInit = 0x4133,
    /// Drive function enabled, the motor holds or moves.
    OperationEnabled = 0x0137,
    /// Ramping down or stopped after "quick stop", power still on.
    QuickStopActive = 0x0117,
    /// Fault reaction, drive function already off.
    FaultReactionDisabled = 0x010F,
    /// Fault reaction, drive function still on.
    FaultReactionEnabled = 0x011F,
    /// Error; power off until it is reset.
    Fault = 0x0108,
}

/// Bits of the statusword that identify the state.
const MASK: u16 = 0x417F;

const STATES: [(DeviceState, &str); 12] = [
    (DeviceState::Start, "start"),
    (DeviceState::NotReadyToSwitchOn, "not ready to switch on"),
    (DeviceState::SwitchOnDisabled, "switch-on disabled"),
    (DeviceState::ReadyToSwitchOn, "ready to switch on"),
    (DeviceState::SwitchedOn, "switched on"),
    (DeviceState::Refresh, "refresh"),
    (DeviceState::MeasureInit, "measure init"),
    (DeviceState::OperationEnabled, "operation enabled"),
    (DeviceState::QuickStopActive, "quick stop active"),
    (
        DeviceState::FaultReactionDisabled,
        "fault reaction active (disabled)",
    ),
    (
        DeviceState::FaultReactionEnabled,
        "fault reaction active (enabled)",
    ),
    (DeviceState::Fault, "fault"),
];

impl DeviceState {
    /// The state of a statusword; `None` where its bits match none.
    #[must_use]
    pub fn from_statusword(statusword: u16) -> Option<Self> {
        let mut states = STATES.iter().map(|(state, _)| *state);
        states.find(|state| state.pattern() == statusword & MASK)
    }

    /// Its name in the Firmware Specification.
    #[must_use]
    pub fn name(self) -> &'static str {
        let found = STATES.iter().find(|(state, _)| *state == self);
        found.map_or("", |(_, name)| name)
    }

    /// The bits that this state sets in the statusword.
    #[must_use]
    pub const fn pattern(self) -> u16 {
        self as u16
    }
}

impl fmt::Display for DeviceState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Bits of the statusword (6041) outside the pattern of the state.
pub mod status {
    /// Power stage on.
    pub const VOLTAGE_ENABLED: u16 = 1 << 4;
    /// NMT state is operational.
    pub const REMOTE: u16 = 1 << 9;
    /// Target reached; at a halt: standstill.
    pub const TARGET_REACHED: u16 = 1 << 10;
    /// Profile position: the drive has taken the setpoint.
    pub const SETPOINT_ACKNOWLEDGE: u16 = 1 << 12;
    /// Homing: reference found. The same bit as [`SETPOINT_ACKNOWLEDGE`].
    pub const HOMING_ATTAINED: u16 = 1 << 12;
    /// Profile position: following error.
    pub const FOLLOWING_ERROR: u16 = 1 << 13;
    /// Homing: failed. The same bit as [`FOLLOWING_ERROR`].
    pub const HOMING_ERROR: u16 = 1 << 13;
    /// Position is referenced to home.
    pub const REFERENCED: u16 = 1 << 15;
}

/// Bits and commands of the controlword (6040).
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
    /// Profile position: replace the present move at once.
    pub const AT_ONCE: u16 = 1 << 5;
    /// Profile position: the target is relative to the present demand.
    pub const RELATIVE: u16 = 1 << 6;
    /// Fault reset on the rising edge.
    pub const FAULT_RESET: u16 = 1 << 7;
    /// Stop with the profile deceleration and hold.
    pub const HALT: u16 = 1 << 8;

    /// Power stage off.
    pub const DISABLE_VOLTAGE: u16 = 0x0000;
    /// To "ready to switch on".
    pub const SHUTDOWN: u16 = 0x0006;
    /// To "switched on".
    pub const SWITCH_ON: u16 = 0x0007;
    /// To "operation enabled", passing "switched on".
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

/// Modes of operation (6060, 6061) that the tilt axis uses.
pub mod mode {
    /// Follows a velocity without a profile.
    pub const VELOCITY: i8 = -2;
    /// Follows a position without a profile.
    pub const POSITION: i8 = -1;
    /// Moves to a target with a profile.
    pub const PROFILE_POSITION: i8 = 1;
    /// Runs at a speed with a profile.
    pub const PROFILE_VELOCITY: i8 = 3;
    /// Finds the reference.
    pub const HOMING: i8 = 6;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_are_distinct_and_round_trip() {
        for (state, _) in STATES {
            let pattern = state.pattern();
            assert_eq!(pattern & !MASK, 0);
            for other in [0x0000, 0x0200, 0x8480, 0xBE80] {
                assert_eq!(DeviceState::from_statusword(pattern | other), Some(state));
            }
        }
    }

    #[test]
    fn bits_outside_the_pattern_are_ignored() {
        assert_eq!(DeviceState::from_statusword(0x0237), None); // bit 8 missing
        assert_eq!(
            DeviceState::from_statusword(0x0337),
            Some(DeviceState::OperationEnabled)
        );
        assert_eq!(
            DeviceState::from_statusword(0x9737),
            Some(DeviceState::OperationEnabled)
        );
        assert_eq!(
            DeviceState::from_statusword(0x0140),
            Some(DeviceState::SwitchOnDisabled)
        );
    }
}
