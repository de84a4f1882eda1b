//! Typed object dictionary entries of a tilt axis (Firmware Specification, "Object Dictionary";
//! types and defaults as in the device description).
//!
//! A device may lack an object; it enforces access rights and limits.

pub use crate::canopen::{Address, Scalar, TypedObject};

/// An entry of [`ALL`], without its type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct NamedObject {
    /// Its address.
    pub address: Address,
    /// Its name in the specification.
    pub name: &'static str,
    /// Width of its value.
    pub bytes: u8,
}

macro_rules! objects {
    ($($(#[doc = $doc:literal])+ $name:ident: $t:ty = $index:literal, $sub:literal, $text:literal;)*) => {
        $($(#[doc = $doc])+ pub const $name: TypedObject<$t> = TypedObject::new($index, $sub, $text);)*

        /// All entries defined here.
        pub const ALL: &[NamedObject] = &[$(NamedObject {
            address: Address::new($index, $sub),
            name: $text,
            bytes: <$t as Scalar>::BYTES,
        }),*];
    };
}

/// Purpose of a digital input, 1 to 9.
#[must_use]
pub const fn digital_input(number: u8) -> TypedObject<u16> {
    TypedObject::new(
        INPUT_6.address.index,
        number,
        "Configuration of a Digital Input",
    )
}

/// Purpose of a digital output, 1 to 5; [`OUTPUT_BRAKE`] makes it the holding brake.
#[must_use]
pub const fn digital_output(number: u8) -> TypedObject<u16> {
    TypedObject::new(
        OUTPUT_1.address.index,
        number,
        "Configuration of a Digital Output",
    )
}

objects! {
    /// Constant 0x00020192: servo drive.
    DEVICE_TYPE: u32 = 0x1000, 0, "Device Type";
    /// Error register: bit 0 generic, 1 current, 2 voltage, 3 temperature, 4 communication, 5
    /// device profile, 7 motion.
    ERROR_REGISTER: u8 = 0x1001, 0, "Error Register";
    /// Number of entries of the error history; writing 0 clears it.
    ERROR_COUNT: u8 = 0x1003, 0, "Number of Errors";
    /// The latest error.
    ERROR_HISTORY_1: u32 = 0x1003, 1, "Error History (1)";
    /// Save, signature [`SAVE`].
    STORE_ALL: u32 = 0x1010, 1, "Save All Parameters";
    /// Restore, signature [`LOAD`].
    RESTORE_ALL: u32 = 0x1011, 1, "Restore All Default Parameters";
    /// Free-running counter, 1 us.
    TIMESTAMP: u32 = 0x1013, 0, "High Resolution Time Stamp";
    /// Bits 23..16 node id, 15..0 time in milliseconds (CiA 301).
    CONSUMER_HEARTBEAT: u32 = 0x1016, 1, "Consumer 1 Heartbeat Time";
    /// Milliseconds, 0 off.
    PRODUCER_HEARTBEAT: u16 = 0x1017, 0, "Producer Heartbeat Time";
    /// 0x000000FB is maxon.
    VENDOR_ID: u32 = 0x1018, 1, "Vendor ID";
    /// High word: hardware version.
    PRODUCT_CODE: u32 = 0x1018, 2, "Product Code";
    /// High word: software version.
    REVISION: u32 = 0x1018, 3, "Revision Number";
    /// Lower 32 bits of the serial number.
    SERIAL_NUMBER: u32 = 0x1018, 4, "Serial Number";
    /// Node id.
    NODE_ID: u8 = 0x2000, 0, "Node ID";
    /// Firmware version, BCD (0x2126).
    SOFTWARE_VERSION: u16 = 0x2003, 1, "Software Version";
    /// Hardware version, BCD (0x6420).
    HARDWARE_VERSION: u16 = 0x2003, 2, "Hardware Version";
    /// Milliseconds, 500 by default.
    RS232_FRAME_TIMEOUT: u16 = 0x2005, 0, "RS232 Frame Timeout";
    /// Milliseconds, 500 by default.
    USB_FRAME_TIMEOUT: u16 = 0x2006, 0, "USB Frame Timeout";
    /// Averaged velocity, rpm.
    VELOCITY_AVERAGED: i32 = 0x2028, 0, "Velocity Actual Value Averaged";
    /// Purpose of digital input 6 (0 negative limit by default).
    INPUT_6: u16 = 0x2070, 6, "Configuration of Digital Input6";
    /// Inputs after mask and polarity, one bit per purpose.
    INPUT_STATE: u16 = 0x2071, 1, "Digital Input Functionalities State";
    /// Enabled purposes.
    INPUT_MASK: u16 = 0x2071, 2, "Digital Input Functionalities Mask";
    /// Bit set: active low.
    INPUT_POLARITY: u16 = 0x2071, 3, "Digital Input Functionalities Polarity";
    /// Purposes with an error routine: without its bit a limit switch does not stop the axis.
    INPUT_EXECUTION_MASK: u16 = 0x2071, 4, "Digital Input Functionalities Execution Mask";
    /// Outputs, one bit per purpose.
    OUTPUT_STATE: u16 = 0x2078, 1, "Digital Output State";
    /// Outputs that the state controls.
    OUTPUT_MASK: u16 = 0x2078, 2, "Digital Output Mask";
    /// Bit set: an active output is low.
    OUTPUT_POLARITY: u16 = 0x2078, 3, "Digital Output Polarity";
    /// Purpose of digital output 1; [`OUTPUT_BRAKE`] makes it the holding brake.
    OUTPUT_1: u16 = 0x2079, 1, "Configuration of Digital Output1";
    /// Homing to a mechanical stop: mA.
    HOMING_CURRENT: u16 = 0x2080, 0, "Current Threshold for Homing Mode";
    /// The position of home, qc.
    HOME_POSITION: i32 = 0x2081, 0, "Home Position";
    /// Opening time of the brake in milliseconds.
    BRAKE_RISE: u16 = 0x2100, 1, "Brake Reaction Rise Time";
    /// Closing time of the brake in milliseconds.
    BRAKE_FALL: u16 = 0x2100, 2, "Brake Reaction Fall Time";
    /// Largest speed of a standstill, rpm.
    STANDSTILL_WINDOW: u16 = 0x2101, 1, "Standstill Window";
    /// Duration of a standstill, ms.
    STANDSTILL_TIME: u16 = 0x2101, 2, "Standstill Window Time";
    /// Longest wait for a standstill, ms.
    STANDSTILL_TIMEOUT: u16 = 0x2101, 3, "Standstill Timeout";
    /// Encoder lines per revolution of the motor.
    ENCODER_LINES: u32 = 0x2210, 1, "Pulse Number Incremental Encoder 1";
    /// 1 incremental with index, 2 without.
    SENSOR_TYPE: u16 = 0x2210, 2, "Position Sensor Type";
    /// Bit 0 set: the encoder counts the other way.
    SENSOR_POLARITY: u16 = 0x2210, 4, "Position Sensor Polarity";
    /// See [`crate::epos2::cia402::control`].
    CONTROLWORD: u16 = 0x6040, 0, "Controlword";
    /// Reaction to a lost master: 0 none, 1 that to a fault, 2 disable voltage, 3 quick stop.
    ABORT_CONNECTION_OPTION: i16 = 0x6007, 0, "Abort Connection Option Code";
    /// See [`crate::epos2::cia402::status`].
    STATUSWORD: u16 = 0x6041, 0, "Statusword";
    /// Kind of stop by "shutdown": 0 at once, 1 by the profile deceleration.
    SHUTDOWN_OPTION: i16 = 0x605B, 0, "Shutdown Option Code";
    /// Kind of stop by "disable operation": 0 at once, 1 by the profile deceleration.
    DISABLE_OPTION: i16 = 0x605C, 0, "Disable Operation Option Code";
    /// Kind of stop by a fault: 0 at once, 1 by the profile deceleration, 2 by the quick-stop
    /// deceleration.
    FAULT_OPTION: i16 = 0x605E, 0, "Fault Reaction Option Code";
    /// See [`crate::epos2::cia402::mode`].
    MODE: i8 = 0x6060, 0, "Modes of Operation";
    /// The mode in effect.
    MODE_DISPLAY: i8 = 0x6061, 0, "Modes of Operation Display";
    /// Demand, qc.
    POSITION_DEMAND: i32 = 0x6062, 0, "Position Demand Value";
    /// Encoder, qc.
    POSITION_ACTUAL: i32 = 0x6064, 0, "Position Actual Value";
    /// qc, 2000 by default.
    MAX_FOLLOWING_ERROR: u32 = 0x6065, 0, "Max Following Error";
    /// qc; FFFFFFFF: the target counts as reached at the end of the profile.
    POSITION_WINDOW: u32 = 0x6067, 0, "Position Window";
    /// Milliseconds in the window before the target counts as reached.
    POSITION_WINDOW_TIME: u16 = 0x6068, 0, "Position Window Time";
    /// Demand, rpm.
    VELOCITY_DEMAND: i32 = 0x606B, 0, "Velocity Demand Value";
    /// Actual, rpm.
    VELOCITY_ACTUAL: i32 = 0x606C, 0, "Velocity Actual Value";
    /// mA.
    CURRENT_ACTUAL: i16 = 0x6078, 0, "Current Actual Value";
    /// qc.
    TARGET_POSITION: i32 = 0x607A, 0, "Target Position";
    /// From the reference to home, qc.
    HOME_OFFSET: i32 = 0x607C, 0, "Home Offset";
    /// Software limit, qc; [`i32::MIN`] is off.
    MIN_POSITION: i32 = 0x607D, 1, "Min Position Limit";
    /// Software limit, qc; [`i32::MAX`] is off.
    MAX_POSITION: i32 = 0x607D, 2, "Max Position Limit";
    /// rpm, at most 25000.
    MAX_PROFILE_VELOCITY: u32 = 0x607F, 0, "Max Profile Velocity";
    /// rpm.
    PROFILE_VELOCITY: u32 = 0x6081, 0, "Profile Velocity";
    /// rpm/s.
    PROFILE_ACCELERATION: u32 = 0x6083, 0, "Profile Acceleration";
    /// rpm/s.
    PROFILE_DECELERATION: u32 = 0x6084, 0, "Profile Deceleration";
    /// rpm/s.
    QUICK_STOP_DECELERATION: u32 = 0x6085, 0, "QuickStop Deceleration";
    /// 0 trapezoid, 1 sinus.
    PROFILE_TYPE: i16 = 0x6086, 0, "Motion Profile Type";
    /// Homing method.
    HOMING_METHOD: i8 = 0x6098, 0, "Homing Method";
    /// rpm.
    HOMING_SWITCH_SPEED: u32 = 0x6099, 1, "Speed for Switch Search";
    /// rpm.
    HOMING_ZERO_SPEED: u32 = 0x6099, 2, "Speed for Zero Search";
    /// Power of ten of velocities in rpm; 0 is 1 rpm.
    VELOCITY_NOTATION: i8 = 0x608B, 0, "Velocity Notation Index";
    /// rpm/s.
    HOMING_ACCELERATION: u32 = 0x609A, 0, "Homing Acceleration";
    /// rpm/s.
    MAX_ACCELERATION: u32 = 0x60C5, 0, "Max Acceleration";
    /// rpm.
    TARGET_VELOCITY: i32 = 0x60FF, 0, "Target Velocity";
    /// 10 sinusoidal EC motor, 11 block commutated, 1 DC.
    MOTOR_TYPE: u16 = 0x6402, 0, "Motor Type";
    /// mA.
    OUTPUT_CURRENT: u16 = 0x6410, 2, "Output Current Limit";
    /// rpm.
    MAX_MOTOR_SPEED: u32 = 0x6410, 4, "Maximal Motor Speed";
    /// One bit per mode.
    SUPPORTED_MODES: u32 = 0x6502, 0, "Supported Drive Modes";
}

/// The device name ("EPOS2"), a string: segmented read only.
pub const DEVICE_NAME: Address = Address::new(0x1008, 0);
/// The whole serial number, 64 bits: segmented read only.
pub const SERIAL_NUMBER_64: Address = Address::new(0x2004, 0);

/// Signature of [`STORE_ALL`]: "save", low byte first.
pub const SAVE: u32 = u32::from_le_bytes(*b"save");
/// Signature of [`RESTORE_ALL`]: "load", low byte first.
pub const LOAD: u32 = u32::from_le_bytes(*b"load");

/// Bits of [`INPUT_STATE`], its mask, polarity and execution mask; a purpose in 2070 is the number
/// of its bit.
pub mod input {
    /// Negative limit switch.
    pub const NEGATIVE_LIMIT: u16 = 1 << 0;
    /// Positive limit switch.
    pub const POSITIVE_LIMIT: u16 = 1 << 1;
    /// Home switch.
    pub const HOME_SWITCH: u16 = 1 << 2;
    /// Quick stop.
    pub const QUICK_STOP: u16 = 1 << 5;
}

/// Purpose of a digital output: holding brake (2079), and the number of its bit in 2078.
pub const OUTPUT_BRAKE: u16 = 2;

/// Entry `n` of the error history, 1 to 5, latest first.
#[must_use]
pub const fn error_history(n: u8) -> TypedObject<u32> {
    TypedObject::new(0x1003, n, "Error History")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_unique() {
        for (i, named) in ALL.iter().enumerate() {
            let mut others = ALL.iter().skip(i + 1);
            assert!(
                others.all(|other| other.address != named.address),
                "{named:?}"
            );
        }
    }

    #[test]
    fn garbage_above_the_value_is_ignored() {
        assert_eq!(STATUSWORD.decode(0xDEAD_0337), 0x0337);
        assert_eq!(MODE_DISPLAY.decode(0xDEAD_BEFF), -1);
        assert_eq!(POSITION_ACTUAL.decode(0xFFFF_8AD0), -30_000);
    }

    #[test]
    fn negative_values_are_sign_extended() {
        assert_eq!(HOMING_METHOD.encode(-3), 0xFFFF_FFFD);
        assert_eq!(CONTROLWORD.encode(0xFFFF), 0x0000_FFFF);
        assert_eq!(TARGET_POSITION.encode(-1), u32::MAX);
    }

    #[test]
    fn signatures_are_letters_low_byte_first() {
        assert_eq!(SAVE, 0x6576_6173);
        assert_eq!(LOAD, 0x6461_6F6C);
    }
}
