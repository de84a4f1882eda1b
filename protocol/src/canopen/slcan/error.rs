//! Errors of a line.

use thiserror::Error;

/// Reason why a line was dropped. The decoder continues with the next line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum SlcanError {
    /// No CR within the longest line.
    #[error("SLCAN: a line of more than {max} characters")]
    TooLong {
        /// The longest line.
        max: usize,
    },
    /// A frame began before the line was complete.
    #[error("SLCAN: a line broken off after {got} characters")]
    BrokenOff {
        /// Characters received.
        got: usize,
    },
    /// A character is invalid.
    #[error("SLCAN: character {offset} of the line is {got:02X}, expected {expected}")]
    Character {
        /// Offset from 0.
        offset: usize,
        /// Permitted characters.
        expected: &'static str,
        /// The character.
        got: u8,
    },
    /// The number of characters is wrong.
    #[error("SLCAN: a line of {got} characters, expected {expected}")]
    Length {
        /// The correct number.
        expected: usize,
        /// The number in the line.
        got: usize,
    },
    /// An identifier above 11 bits.
    #[error("SLCAN: identifier {got:X} at character 1, expected at most {max:X}")]
    Id {
        /// The highest.
        max: u32,
        /// The identifier in the line.
        got: u32,
    },
}
