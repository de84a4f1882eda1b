//! Device errors: the codes of the error history (1003) and of emergency messages (Firmware
//! Specification, "Error Handling"), with the drive's reaction and a remedy.

use core::fmt;

/// A device error code; 0 is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DeviceError(pub u16);

/// The drive's reaction to an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Ramps down with the quick-stop deceleration (6085), then switches the power off.
    QuickStop,
    /// Switches the power off at once.
    Disable,
}

/// The description of an error code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ErrorDescription {
    /// Name in the maxon specification.
    pub name: &'static str,
    /// Description.
    pub meaning: &'static str,
    /// Remedy.
    pub remedy: &'static str,
    /// Reaction of the drive.
    pub reaction: Reaction,
}

/// Constants and table of the codes: code, reaction, name in the maxon specification, meaning,
/// remedy.
macro_rules! codes {
    ($($id:ident = $code:literal, $reaction:ident, $name:literal, $meaning:literal, $remedy:expr;)*) => {
        impl DeviceError {
            $(
                #[doc = concat!($name, ": ", $meaning, ".")]
                pub const $id: Self = Self($code);
            )*
        }

        const TABLE: &[(DeviceError, ErrorDescription)] = &[$((DeviceError::$id, ErrorDescription {
            name: $name,
            meaning: $meaning,
            remedy: $remedy,
            reaction: Reaction::$reaction,
        }),)*];
    };
}

const CAN_WIRING: &str = "check the CAN wiring, termination and bit rate; then clear the fault";
const MOTOR_WIRING: &str =
    "check the motor and sensor cables and the motor configuration; then clear the fault";

codes! {
    NONE = 0x0000, Disable, "No Error", "no error", "nothing to do";
    GENERIC = 0x1000, Disable, "Generic Error", "unspecified error", "clear the fault; if it returns, restart the drive";
    OVERCURRENT = 0x2310, Disable, "Over Current Error", "short circuit in the motor or its cable, or current gains too high", MOTOR_WIRING;
    OVERVOLTAGE = 0x3210, Disable, "Over Voltage Error", "supply voltage too high, often from braking a heavy load", "lower the deceleration or the supply voltage, or add a shunt; then clear the fault";
    UNDERVOLTAGE = 0x3220, Disable, "Under Voltage Error", "supply voltage too low for the motion", "use a stronger supply or a lower acceleration; then clear the fault";
    TEMPERATURE = 0x4210, Disable, "Over Temperature Error", "the power stage is too hot", "let the drive cool; then clear the fault";
    LOGIC_SUPPLY = 0x5113, Disable, "Supply Voltage (+5V) Too Low Error", "the drive's 5 V supply is overloaded", "check what the 5 V output feeds; then clear the fault";
    OUTPUT_SUPPLY = 0x5114, Disable, "Supply Voltage Output Stage Too Low Error", "the drive's output stage is not supplied", "check the supply; then clear the fault";
    INTERNAL_SOFTWARE = 0x6100, Disable, "Internal Software Error", "the drive's firmware failed", "restart the drive";
    SOFTWARE_PARAMETER = 0x6320, Disable, "Software Parameter Error", "too far a target for too low a profile velocity, or another parameter the generator cannot use", "choose a higher speed or a nearer target; then clear the fault";
    POSITION_SENSOR = 0x7320, Disable, "Sensor Position Error", "the position sensor's signal is wrong: the position is lost", "check the encoder cable, clear the fault, then home";
    CAN_OVERRUN = 0x8110, QuickStop, "CAN Overrun Error", "the drive lost CAN messages", "lower the bus load; then clear the fault";
    CAN_OBJECT_LOST = 0x8111, QuickStop, "CAN Overrun Error (object lost)", "the drive lost a CAN message", "lower the bus load; then clear the fault";
    CAN_PASSIVE = 0x8120, QuickStop, "CAN Passive Mode Error", "no node acknowledges on the CAN bus; usual on a drive used over USB alone", "clear the fault; on a CAN bus check wiring, termination and bit rate";
    CAN_LIFE_GUARD = 0x8130, QuickStop, "CAN Life Guard Error", "the master's heartbeat or guarding stopped", "check that the master runs; then clear the fault";
    CAN_COB_ID = 0x8150, Disable, "CAN Transmit COB-ID Collision Error", "another node sends with this node's id", "give each node its own id; then clear the fault";
    CAN_BUS_OFF = 0x81FD, QuickStop, "CAN Bus Off Error", "the drive left the CAN bus after too many errors", CAN_WIRING;
    CAN_RX_QUEUE = 0x81FE, Disable, "CAN Rx Queue Overrun Error", "too many CAN messages for the drive", "lower the bus load; then clear the fault";
    CAN_TX_QUEUE = 0x81FF, Disable, "CAN Tx Queue Overrun Error", "the drive cannot get rid of its CAN messages", "lower the bus load; then clear the fault";
    PDO_LENGTH = 0x8210, QuickStop, "CAN PDO Length Error", "a PDO of another length than mapped arrived", "map the PDOs again; then clear the fault";
    FOLLOWING = 0x8611, QuickStop, "Following Error", "the motor did not keep up with its demand: blocked, overloaded or badly tuned", "see that the axis moves freely, use a lower speed or acceleration; then clear the fault";
    HALL_SENSOR = 0xFF01, Disable, "Hall Sensor Error", "impossible Hall sensor pattern", MOTOR_WIRING;
    INDEX = 0xFF02, Disable, "Index Processing Error", "the encoder's index pulse came at the wrong place: the position is lost", "check the encoder cable and resolution, clear the fault, then home";
    ENCODER_RESOLUTION = 0xFF03, Disable, "Encoder Resolution Error", "the configured encoder resolution is wrong: the position is lost", "correct the encoder resolution, clear the fault, then home";
    HALL_NOT_FOUND = 0xFF04, Disable, "Hallsensor not found Error", "no Hall sensor edge found", MOTOR_WIRING;
    NEGATIVE_LIMIT = 0xFF06, QuickStop, "Negative Limit Error", "the axis is on its negative limit switch", "clear the fault and move away in positive direction, or home";
    POSITIVE_LIMIT = 0xFF07, QuickStop, "Positive Limit Error", "the axis is on its positive limit switch", "clear the fault and move away in negative direction, or home";
    HALL_ANGLE = 0xFF08, Disable, "Hall Angle Detection Error", "Hall sensor and encoder disagree: the position is lost", MOTOR_WIRING;
    SOFTWARE_LIMIT = 0xFF09, QuickStop, "Software Position Limit Error", "the axis is outside the software position limits", "clear the fault and move back inside the limits";
    SENSOR_BREACH = 0xFF0A, Disable, "Position Sensor Breach", "the position sensor's cable is broken: the position is lost", "check the encoder cable, clear the fault, then home";
    OVERLOADED = 0xFF0B, Disable, "System Overloaded Error", "the drive has too much to compute", "lower the bus load and the controller's rates; then clear the fault";
}

impl DeviceError {
    /// Whether there is no error.
    #[must_use]
    pub const fn is_none(self) -> bool {
        self.0 == 0
    }

    /// Reaction of the drive to this error; codes that are not listed switch the power off.
    #[must_use]
    pub fn reaction(self) -> Reaction {
        self.meaning()
            .map_or(Reaction::Disable, |known| known.reaction)
    }

    /// The description of the code; `None` for one the maxon specification does not list.
    #[must_use]
    pub fn meaning(self) -> Option<ErrorDescription> {
        let (_, known) = TABLE.iter().find(|(code, _)| *code == self)?;
        Some(*known)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_unique() {
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
    fn unknown_codes_are_printable() {
        extern crate std;
        use std::string::ToString as _;
        assert_eq!(
            DeviceError(0x4242).to_string(),
            "4242 (not a code the maxon specification lists)"
        );
        assert_eq!(
            DeviceError::CAN_PASSIVE.to_string(),
            "8120 CAN Passive Mode Error: no node acknowledges on the CAN bus; usual on a drive used over USB alone"
        );
    }
}
