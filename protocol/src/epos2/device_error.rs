//! Device errors: the u16 codes of the error history (1003) and of emergency messages (Firmware Specification, "Error Handling").
//!
//! Here is what a code means, how the drive reacts and what a person can do; telling it is the binary's business.

use core::fmt;

/// A device error code; 0 is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DeviceError(pub u16);

/// How the drive stops on an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Ramp down with the quick-stop deceleration (6085), then power off.
    QuickStop,
    /// Power off at once.
    Disable,
}

/// What a code says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Meaning {
    /// maxon's name.
    pub name: &'static str,
    /// What happened.
    pub meaning: &'static str,
    /// What to do about it.
    pub remedy: &'static str,
}

impl DeviceError {
    /// No error.
    pub const NONE: Self = Self(0x0000);
    /// Generic error.
    pub const GENERIC: Self = Self(0x1000);
    /// Output stage overcurrent.
    pub const OVERCURRENT: Self = Self(0x2310);
    /// Supply voltage too high.
    pub const OVERVOLTAGE: Self = Self(0x3210);
    /// Supply voltage too low.
    pub const UNDERVOLTAGE: Self = Self(0x3220);
    /// Power stage too hot.
    pub const TEMPERATURE: Self = Self(0x4210);
    /// Internal 5 V supply too low.
    pub const LOGIC_SUPPLY: Self = Self(0x5113);
    /// Output stage supply too low.
    pub const OUTPUT_SUPPLY: Self = Self(0x5114);
    /// Internal software error.
    pub const INTERNAL_SOFTWARE: Self = Self(0x6100);
    /// Parameters that the profile generator cannot use.
    pub const SOFTWARE_PARAMETER: Self = Self(0x6320);
    /// Position sensor error.
    pub const POSITION_SENSOR: Self = Self(0x7320);
    /// CAN messages lost.
    pub const CAN_OVERRUN: Self = Self(0x8110);
    /// CAN object lost.
    pub const CAN_OBJECT_LOST: Self = Self(0x8111);
    /// CAN controller in error-passive mode: nobody acknowledges.
    pub const CAN_PASSIVE: Self = Self(0x8120);
    /// Life guarding or heartbeat missed.
    pub const CAN_LIFE_GUARD: Self = Self(0x8130);
    /// Transmit COB-ID collision.
    pub const CAN_COB_ID: Self = Self(0x8150);
    /// CAN controller off the bus.
    pub const CAN_BUS_OFF: Self = Self(0x81FD);
    /// CAN receive queue overrun.
    pub const CAN_RX_QUEUE: Self = Self(0x81FE);
    /// CAN transmit queue overrun.
    pub const CAN_TX_QUEUE: Self = Self(0x81FF);
    /// PDO of the wrong length.
    pub const PDO_LENGTH: Self = Self(0x8210);
    /// Following error above 6065.
    pub const FOLLOWING: Self = Self(0x8611);
    /// Hall sensor pattern impossible.
    pub const HALL_SENSOR: Self = Self(0xFF01);
    /// Index pulse at the wrong place.
    pub const INDEX: Self = Self(0xFF02);
    /// Encoder resolution wrong.
    pub const ENCODER_RESOLUTION: Self = Self(0xFF03);
    /// Hall sensors not found.
    pub const HALL_NOT_FOUND: Self = Self(0xFF04);
    /// Negative limit switch.
    pub const NEGATIVE_LIMIT: Self = Self(0xFF06);
    /// Positive limit switch.
    pub const POSITIVE_LIMIT: Self = Self(0xFF07);
    /// Hall angle detection failed.
    pub const HALL_ANGLE: Self = Self(0xFF08);
    /// Software position limit (607D).
    pub const SOFTWARE_LIMIT: Self = Self(0xFF09);
    /// Position sensor breach.
    pub const SENSOR_BREACH: Self = Self(0xFF0A);
    /// Device overloaded.
    pub const OVERLOADED: Self = Self(0xFF0B);

    /// Whether there is no error.
    #[must_use]
    pub const fn is_none(self) -> bool {
        self.0 == 0
    }

    /// How the drive stops on this error: by a ramp for the communication and motion errors, without for all others.
    #[must_use]
    pub const fn reaction(self) -> Reaction {
        match self {
            Self::CAN_OVERRUN
            | Self::CAN_OBJECT_LOST
            | Self::CAN_PASSIVE
            | Self::CAN_LIFE_GUARD
            | Self::CAN_BUS_OFF
            | Self::PDO_LENGTH
            | Self::FOLLOWING
            | Self::NEGATIVE_LIMIT
            | Self::POSITIVE_LIMIT
            | Self::SOFTWARE_LIMIT => Reaction::QuickStop,
            _ => Reaction::Disable,
        }
    }

    /// maxon's name, meaning and remedy; `None` for a code the specification does not list.
    #[must_use]
    pub fn meaning(self) -> Option<Meaning> {
        TABLE
            .iter()
            .find(|(code, ..)| *code == self)
            .map(|&(_, name, meaning, remedy)| Meaning {
                name,
                meaning,
                remedy,
            })
    }
}

impl core::error::Error for DeviceError {}

impl fmt::Display for DeviceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.meaning() {
            Some(known) => write!(f, "{:04X} {}: {}", self.0, known.name, known.meaning),
            None => write!(
                f,
                "{:04X} (not a code the maxon specification lists)",
                self.0
            ),
        }
    }
}

const CAN_WIRING: &str = "check the CAN wiring, termination and bit rate; then clear the fault";
const MOTOR_WIRING: &str =
    "check the motor and sensor cables and the motor configuration; then clear the fault";

#[rustfmt::skip]
const TABLE: &[(DeviceError, &str, &str, &str)] = &[
    (DeviceError::NONE, "No Error", "no error", "nothing to do"),
    (DeviceError::GENERIC, "Generic Error", "unspecified error", "clear the fault; if it returns, restart the drive"),
    (DeviceError::OVERCURRENT, "Over Current Error", "short circuit in the motor or its cable, or current gains too high", MOTOR_WIRING),
    (DeviceError::OVERVOLTAGE, "Over Voltage Error", "supply voltage too high, often from braking a heavy load", "lower the deceleration or the supply voltage, or add a shunt; then clear the fault"),
    (DeviceError::UNDERVOLTAGE, "Under Voltage Error", "supply voltage too low for the motion", "use a stronger supply or a lower acceleration; then clear the fault"),
    (DeviceError::TEMPERATURE, "Over Temperature Error", "the power stage is too hot", "let the drive cool; then clear the fault"),
    (DeviceError::LOGIC_SUPPLY, "Supply Voltage (+5V) Too Low Error", "the drive's 5 V supply is overloaded", "check what the 5 V output feeds; then clear the fault"),
    (DeviceError::OUTPUT_SUPPLY, "Supply Voltage Output Stage Too Low Error", "the drive's output stage is not supplied", "check the supply; then clear the fault"),
    (DeviceError::INTERNAL_SOFTWARE, "Internal Software Error", "the drive's firmware failed", "restart the drive"),
    (DeviceError::SOFTWARE_PARAMETER, "Software Parameter Error", "too far a target for too low a profile velocity, or another parameter the generator cannot use", "choose a higher speed or a nearer target; then clear the fault"),
    (DeviceError::POSITION_SENSOR, "Sensor Position Error", "the position sensor's signal is wrong: the position is lost", "check the encoder cable, clear the fault, then home"),
    (DeviceError::CAN_OVERRUN, "CAN Overrun Error", "the drive lost CAN messages", "lower the bus load; then clear the fault"),
    (DeviceError::CAN_OBJECT_LOST, "CAN Overrun Error (object lost)", "the drive lost a CAN message", "lower the bus load; then clear the fault"),
    (DeviceError::CAN_PASSIVE, "CAN Passive Mode Error", "nobody acknowledges on the CAN bus; usual on a drive used over USB alone", "clear the fault; on a CAN bus check wiring, termination and bit rate"),
    (DeviceError::CAN_LIFE_GUARD, "CAN Life Guard Error", "the master's heartbeat or guarding stopped", "check that the master runs; then clear the fault"),
    (DeviceError::CAN_COB_ID, "CAN Transmit COB-ID Collision Error", "another node sends with this node's id", "give each node its own id; then clear the fault"),
    (DeviceError::CAN_BUS_OFF, "CAN Bus Off Error", "the drive left the CAN bus after too many errors", CAN_WIRING),
    (DeviceError::CAN_RX_QUEUE, "CAN Rx Queue Overrun Error", "too many CAN messages for the drive", "lower the bus load; then clear the fault"),
    (DeviceError::CAN_TX_QUEUE, "CAN Tx Queue Overrun Error", "the drive cannot get rid of its CAN messages", "lower the bus load; then clear the fault"),
    (DeviceError::PDO_LENGTH, "CAN PDO Length Error", "a PDO of another length than mapped arrived", "map the PDOs anew; then clear the fault"),
    (DeviceError::FOLLOWING, "Following Error", "the motor did not keep up with its demand: blocked, overloaded or badly tuned", "see that the axis moves freely, use a lower speed or acceleration; then clear the fault"),
    (DeviceError::HALL_SENSOR, "Hall Sensor Error", "impossible Hall sensor pattern", MOTOR_WIRING),
    (DeviceError::INDEX, "Index Processing Error", "the encoder's index pulse came at the wrong place: the position is lost", "check the encoder cable and resolution, clear the fault, then home"),
    (DeviceError::ENCODER_RESOLUTION, "Encoder Resolution Error", "the configured encoder resolution is wrong: the position is lost", "correct the encoder resolution, clear the fault, then home"),
    (DeviceError::HALL_NOT_FOUND, "Hallsensor not found Error", "no Hall sensor edge found", MOTOR_WIRING),
    (DeviceError::NEGATIVE_LIMIT, "Negative Limit Error", "the axis is on its negative limit switch", "clear the fault and move away in positive direction, or home"),
    (DeviceError::POSITIVE_LIMIT, "Positive Limit Error", "the axis is on its positive limit switch", "clear the fault and move away in negative direction, or home"),
    (DeviceError::HALL_ANGLE, "Hall Angle Detection Error", "Hall sensor and encoder disagree: the position is lost", MOTOR_WIRING),
    (DeviceError::SOFTWARE_LIMIT, "Software Position Limit Error", "the axis is outside the software position limits", "clear the fault and move back inside the limits"),
    (DeviceError::SENSOR_BREACH, "Position Sensor Breach", "the position sensor's cable is broken: the position is lost", "check the encoder cable, clear the fault, then home"),
    (DeviceError::OVERLOADED, "System Overloaded Error", "the drive has too much to compute", "lower the bus load and the controller's rates; then clear the fault"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_code_stands_twice() {
        for (i, (code, ..)) in TABLE.iter().enumerate() {
            assert!(
                TABLE.iter().skip(i + 1).all(|(other, ..)| other != code),
                "{code}"
            );
        }
    }

    #[test]
    fn limit_switches_ramp_and_overcurrent_does_not() {
        for code in [
            0x8110, 0x8111, 0x8120, 0x8130, 0x81FD, 0x8210, 0x8611, 0xFF06, 0xFF07, 0xFF09,
        ] {
            assert_eq!(
                DeviceError(code).reaction(),
                Reaction::QuickStop,
                "{code:04X}"
            );
        }
        for code in [
            0x1000, 0x2310, 0x3210, 0x3220, 0x4210, 0x6320, 0x7320, 0x8150, 0xFF01, 0x1234,
        ] {
            assert_eq!(
                DeviceError(code).reaction(),
                Reaction::Disable,
                "{code:04X}"
            );
        }
    }

    #[test]
    fn unknown_codes_print_too() {
        extern crate std;
        use std::string::ToString as _;
        assert_eq!(
            DeviceError(0x4242).to_string(),
            "4242 (not a code the maxon specification lists)"
        );
        assert_eq!(
            DeviceError::CAN_PASSIVE.to_string(),
            "8120 CAN Passive Mode Error: nobody acknowledges on the CAN bus; usual on a drive used over USB alone"
        );
    }
}
