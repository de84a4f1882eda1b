//! What can be wrong with a line.

use thiserror::Error;

/// Why a line was dropped. The decoder goes on with the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum SlcanError {
    /// No CR came for longer than any line is.
    #[error("SLCAN: a line of more than {max} characters")]
    TooLong {
        /// The longest there is.
        max: usize,
    },
    /// A frame began before the line was complete.
    #[error("SLCAN: a line broken off after {got} characters")]
    BrokenOff {
        /// Characters that had come.
        got: usize,
    },
    /// A character that cannot stand there.
    #[error("SLCAN: character {offset} of the line is {got:02X}, expected {expected}")]
    Character {
        /// Which, counted from 0.
        offset: usize,
        /// What may stand there.
        expected: &'static str,
        /// What does.
        got: u8,
    },
    /// More or fewer characters than the line should have.
    #[error("SLCAN: a line of {got} characters, expected {expected}")]
    Length {
        /// Characters it should have.
        expected: usize,
        /// Characters it has.
        got: usize,
    },
    /// An identifier above 11 bits.
    #[error("SLCAN: identifier {got:X} at character 1, expected at most {max:X}")]
    Id {
        /// The highest.
        max: u32,
        /// The line's.
        got: u32,
    },
}
