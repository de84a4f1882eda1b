//! SDO abort codes (CiA 301, "Abort SDO transfer protocol"), which EPOS2 drives also send as error
//! codes of serial answers; names and manufacturer-specific codes (0F00FFxx) are those of the maxon
//! Communication Guide.

use core::fmt;

/// An SDO abort code; 0 is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AbortCode(pub u32);

/// Constants and table of the codes: code, name, meaning.
macro_rules! codes {
    ($($id:ident = $code:literal, $name:literal, $meaning:literal;)*) => {
        impl AbortCode {
            $(
                #[doc = concat!($name, ": ", $meaning, ".")]
                pub const $id: Self = Self($code);
            )*
        }

        const TABLE: &[(AbortCode, &str, &str)] = &[$((AbortCode::$id, $name, $meaning),)*];
    };
}

codes! {
    NONE = 0, "No Communication Error", "carried out";
    TOGGLE = 0x0503_0000, "Toggle Error", "toggle bit not alternated";
    TIMEOUT = 0x0504_0000, "SDO Time Out", "no answer in time";
    COMMAND = 0x0504_0001, "Client/Server Specifier Error", "command specifier not valid or unknown";
    CRC = 0x0504_0004, "CRC Error", "the request arrived damaged";
    MEMORY = 0x0504_0005, "Out of Memory Error", "out of memory";
    ACCESS = 0x0601_0000, "Access Error", "the object does not support this access";
    WRITE_ONLY = 0x0601_0001, "Write Only Error", "read of a write-only object";
    READ_ONLY = 0x0601_0002, "Read Only Error", "write to a read-only object";
    NO_OBJECT = 0x0602_0000, "Object does not exist Error", "no such index in the object dictionary";
    PDO_MAPPING = 0x0604_0041, "PDO mapping Error", "the object cannot be mapped to a PDO";
    PDO_LENGTH = 0x0604_0042, "PDO Length Error", "the mapped objects exceed the length of a PDO";
    PARAMETER = 0x0604_0043, "General Parameter Error", "parameters that do not go together";
    INCOMPATIBLE = 0x0604_0047, "General internal Incompatibility Error", "incompatible inside the device";
    HARDWARE = 0x0606_0000, "Hardware Error", "access failed because of a hardware error";
    LENGTH = 0x0607_0010, "Service Parameter Error", "the length of the value does not match the object";
    TOO_LONG = 0x0607_0012, "Service Parameter too long Error", "the value is longer than the object";
    TOO_SHORT = 0x0607_0013, "Service Parameter too short Error", "the value is shorter than the object";
    NO_SUB = 0x0609_0011, "Object Subindex Error", "no such subindex";
    RANGE = 0x0609_0030, "Value Range Error", "the value is outside its range";
    TOO_HIGH = 0x0609_0031, "Value too High Error", "the value is above its range";
    TOO_LOW = 0x0609_0032, "Value too Low Error", "the value is below its range";
    MAX_BELOW_MIN = 0x0609_0036, "Maximum less Minimum Error", "the maximum would be below the minimum";
    GENERAL = 0x0800_0000, "General Error", "general error";
    STORE = 0x0800_0020, "Transfer or store Error", "the value cannot be transferred or stored";
    LOCAL_CONTROL = 0x0800_0021, "Local Control Error", "not possible because of local control";
    STATE = 0x0800_0022, "Wrong Device State", "not possible in the present device state";
    NMT_STATE = 0x0F00_FFC0, "Wrong NMT State Error", "the device is in the wrong NMT state";
    ILLEGAL_COMMAND = 0x0F00_FFBF, "Illegal Command Error", "the device knows no such command";
    PASSWORD = 0x0F00_FFBE, "Password Error", "the password is wrong";
    SERVICE_MODE = 0x0F00_FFBC, "Error Service Mode", "the device is not in service mode";
    CAN_ID = 0x0F00_FFB9, "Error CAN Id", "wrong CAN id";
}

impl AbortCode {
    /// Whether there is no error.
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
}

impl core::error::Error for AbortCode {}

impl fmt::Display for AbortCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match TABLE.iter().find(|(code, ..)| code == self) {
            Some((_, name, meaning)) => write!(f, "{:08X} {name}: {meaning}", self.0),
            None => write!(f, "{:08X} (not a code the maxon guide lists)", self.0),
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
    fn words_are_sent_low_word_first() {
        assert_eq!(AbortCode::NO_OBJECT.to_words(), [0x0000, 0x0602]);
        assert_eq!(AbortCode::from_words(0xFFC0, 0x0F00), AbortCode::NMT_STATE);
    }

    #[test]
    fn known_and_unknown_codes_are_printable() {
        extern crate std;
        use std::string::ToString as _;
        assert_eq!(
            AbortCode::NO_OBJECT.to_string(),
            "06020000 Object does not exist Error: no such index in the object dictionary"
        );
        assert_eq!(
            AbortCode(0xDEAD_BEEF).to_string(),
            "DEADBEEF (not a code the maxon guide lists)"
        );
    }
}
