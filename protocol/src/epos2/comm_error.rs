//! Communication errors: the u32 at the beginning of each answer, and SDO abort codes alike (Communication Guide,
//! "Communication Errors").

use core::fmt;

/// The error code of an answer; 0 is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CommError(pub u32);

impl CommError {
    /// The command was carried out.
    pub const NONE: Self = Self(0);
    /// The toggle bit of a segment did not alternate.
    pub const TOGGLE: Self = Self(0x0503_0000);
    /// No answer in time, for instance from the node a gateway forwarded to.
    pub const TIMEOUT: Self = Self(0x0504_0000);
    /// Command specifier unknown or not valid here.
    pub const COMMAND: Self = Self(0x0504_0001);
    /// The request's checksum did not match; it was not carried out.
    pub const CRC: Self = Self(0x0504_0004);
    /// Out of memory.
    pub const MEMORY: Self = Self(0x0504_0005);
    /// The object does not support this access.
    pub const ACCESS: Self = Self(0x0601_0000);
    /// Read of a write-only object.
    pub const WRITE_ONLY: Self = Self(0x0601_0001);
    /// Write to a read-only object.
    pub const READ_ONLY: Self = Self(0x0601_0002);
    /// No such index.
    pub const NO_OBJECT: Self = Self(0x0602_0000);
    /// The object cannot be mapped to a PDO.
    pub const PDO_MAPPING: Self = Self(0x0604_0041);
    /// The mapped objects exceed a PDO.
    pub const PDO_LENGTH: Self = Self(0x0604_0042);
    /// Parameters that do not go together.
    pub const PARAMETER: Self = Self(0x0604_0043);
    /// Incompatible inside the device.
    pub const INCOMPATIBLE: Self = Self(0x0604_0047);
    /// Access failed because of a hardware error.
    pub const HARDWARE: Self = Self(0x0606_0000);
    /// The length of the parameter does not match.
    pub const LENGTH: Self = Self(0x0607_0010);
    /// The parameter is too long.
    pub const TOO_LONG: Self = Self(0x0607_0012);
    /// The parameter is too short.
    pub const TOO_SHORT: Self = Self(0x0607_0013);
    /// No such subindex.
    pub const NO_SUB: Self = Self(0x0609_0011);
    /// The value is outside its range.
    pub const RANGE: Self = Self(0x0609_0030);
    /// The value is above its range.
    pub const TOO_HIGH: Self = Self(0x0609_0031);
    /// The value is below its range.
    pub const TOO_LOW: Self = Self(0x0609_0032);
    /// A maximum below its minimum.
    pub const MAX_BELOW_MIN: Self = Self(0x0609_0036);
    /// General error.
    pub const GENERAL: Self = Self(0x0800_0000);
    /// Cannot be transferred or stored (wrong signature, for instance).
    pub const STORE: Self = Self(0x0800_0020);
    /// Not because of local control.
    pub const LOCAL_CONTROL: Self = Self(0x0800_0021);
    /// Not in this device state.
    pub const STATE: Self = Self(0x0800_0022);
    /// Not in this NMT state.
    pub const NMT_STATE: Self = Self(0x0F00_FFC0);
    /// No such command.
    pub const ILLEGAL_COMMAND: Self = Self(0x0F00_FFBF);
    /// Wrong password.
    pub const PASSWORD: Self = Self(0x0F00_FFBE);
    /// Not in service mode.
    pub const SERVICE_MODE: Self = Self(0x0F00_FFBC);
    /// Wrong CAN id.
    pub const CAN_ID: Self = Self(0x0F00_FFB9);

    /// Whether the command was carried out.
    #[must_use]
    pub const fn is_none(self) -> bool {
        self.0 == 0
    }

    /// The code of two words, low word first.
    #[must_use]
    pub const fn from_words(low: u16, high: u16) -> Self {
        Self((high as u32) << 16 | low as u32)
    }

    /// The code as two words, low word first.
    #[must_use]
    pub const fn to_words(self) -> [u16; 2] {
        [self.0 as u16, (self.0 >> 16) as u16]
    }

    /// maxon's name and the meaning in a few words; `None` for a code the guide does not list.
    #[must_use]
    pub fn meaning(self) -> Option<Meaning> {
        TABLE
            .iter()
            .find(|(code, ..)| *code == self)
            .map(|&(_, name, meaning)| Meaning { name, meaning })
    }
}

impl core::error::Error for CommError {}

impl fmt::Display for CommError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.meaning() {
            Some(Meaning { name, meaning }) => write!(f, "{:08X} {name}: {meaning}", self.0),
            None => write!(f, "{:08X} (not a code the maxon guide lists)", self.0),
        }
    }
}

/// What a code says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Meaning {
    /// maxon's name.
    pub name: &'static str,
    /// The meaning.
    pub meaning: &'static str,
}

const TABLE: &[(CommError, &str, &str)] = &[
    (CommError::NONE, "No Communication Error", "carried out"),
    (
        CommError::TOGGLE,
        "Toggle Error",
        "toggle bit not alternated",
    ),
    (CommError::TIMEOUT, "SDO Time Out", "no answer in time"),
    (
        CommError::COMMAND,
        "Client/Server Specifier Error",
        "command specifier not valid or unknown",
    ),
    (CommError::CRC, "CRC Error", "the request arrived damaged"),
    (CommError::MEMORY, "Out of Memory Error", "out of memory"),
    (
        CommError::ACCESS,
        "Access Error",
        "the object does not support this access",
    ),
    (
        CommError::WRITE_ONLY,
        "Write Only Error",
        "read of a write-only object",
    ),
    (
        CommError::READ_ONLY,
        "Read Only Error",
        "write to a read-only object",
    ),
    (
        CommError::NO_OBJECT,
        "Object does not exist Error",
        "no such index in the object dictionary",
    ),
    (
        CommError::PDO_MAPPING,
        "PDO mapping Error",
        "the object cannot be mapped to a PDO",
    ),
    (
        CommError::PDO_LENGTH,
        "PDO Length Error",
        "the mapped objects exceed the length of a PDO",
    ),
    (
        CommError::PARAMETER,
        "General Parameter Error",
        "parameters that do not go together",
    ),
    (
        CommError::INCOMPATIBLE,
        "General internal Incompatibility Error",
        "incompatible inside the device",
    ),
    (
        CommError::HARDWARE,
        "Hardware Error",
        "access failed because of a hardware error",
    ),
    (
        CommError::LENGTH,
        "Service Parameter Error",
        "the length of the value does not match the object",
    ),
    (
        CommError::TOO_LONG,
        "Service Parameter too long Error",
        "the value is longer than the object",
    ),
    (
        CommError::TOO_SHORT,
        "Service Parameter too short Error",
        "the value is shorter than the object",
    ),
    (
        CommError::NO_SUB,
        "Object Subindex Error",
        "no such subindex",
    ),
    (
        CommError::RANGE,
        "Value Range Error",
        "the value is outside its range",
    ),
    (
        CommError::TOO_HIGH,
        "Value too High Error",
        "the value is above its range",
    ),
    (
        CommError::TOO_LOW,
        "Value too Low Error",
        "the value is below its range",
    ),
    (
        CommError::MAX_BELOW_MIN,
        "Maximum less Minimum Error",
        "the maximum would be below the minimum",
    ),
    (CommError::GENERAL, "General Error", "general error"),
    (
        CommError::STORE,
        "Transfer or store Error",
        "the value cannot be transferred or stored",
    ),
    (
        CommError::LOCAL_CONTROL,
        "Local Control Error",
        "not possible because of local control",
    ),
    (
        CommError::STATE,
        "Wrong Device State",
        "not possible in the present device state",
    ),
    (
        CommError::NMT_STATE,
        "Wrong NMT State Error",
        "the device is in the wrong NMT state",
    ),
    (
        CommError::ILLEGAL_COMMAND,
        "Illegal Command Error",
        "the device knows no such command",
    ),
    (
        CommError::PASSWORD,
        "Password Error",
        "the password is wrong",
    ),
    (
        CommError::SERVICE_MODE,
        "Error Service Mode",
        "the device is not in service mode",
    ),
    (CommError::CAN_ID, "Error CAN Id", "wrong CAN id"),
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
    fn words_are_low_first() {
        assert_eq!(CommError::NO_OBJECT.to_words(), [0x0000, 0x0602]);
        assert_eq!(CommError::from_words(0xFFC0, 0x0F00), CommError::NMT_STATE);
    }

    #[test]
    fn known_and_unknown_codes_print() {
        extern crate std;
        use std::string::ToString as _;
        assert_eq!(
            CommError::NO_OBJECT.to_string(),
            "06020000 Object does not exist Error: no such index in the object dictionary"
        );
        assert_eq!(
            CommError(0xDEAD_BEEF).to_string(),
            "DEADBEEF (not a code the maxon guide lists)"
        );
    }
}
