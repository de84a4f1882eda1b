//! Lines of text and hexadecimal digits.

use super::error::SlcanError;
use crate::BoundedVec;

/// Ends a line; alone, it confirms a command.
pub const CR: u8 = 0x0D;
/// Rejects a command.
pub const BEL: u8 = 0x07;
/// Follows CR in some adapters.
const LF: u8 = 0x0A;
/// The longest line. A frame with a time stamp has at most 30 characters; version texts may be
/// longer.
pub const MAX_LINE: usize = 96;

/// A line, or text in it.
pub type Line = BoundedVec<u8, MAX_LINE>;

/// A completed line or answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineEvent {
    /// A line without its CR, possibly empty.
    Line(Line),
    Bell,
    Dropped(SlcanError),
}

/// Collects bytes into lines.
#[derive(Clone, Debug, Default)]
pub(super) struct LineAssembler {
    line: Line,
    /// The line is too long; its rest is dropped.
    skipping: bool,
}

impl LineAssembler {
    pub(super) fn push(&mut self, byte: u8) -> Option<LineEvent> {
        match byte {
            CR => Some(self.end()),
            BEL => {
                *self = Self::default();
                Some(LineEvent::Bell)
            }
            LF => None,
            // Between lines, other bytes are noise of the line or of a port just opened.
            _ if self.line.is_empty() && !byte.is_ascii_graphic() => None,
            b't' | b'T' | b'r' | b'R' if self.is_broken_off() => {
                let got = self.line.len();
                *self = Self::default();
                self.line.extend([byte]);
                Some(LineEvent::Dropped(SlcanError::BrokenOff { got }))
            }
            _ => {
                self.skipping |= self.line.push(byte).is_err();
                None
            }
        }
    }

    fn end(&mut self) -> LineEvent {
        let Self { line, skipping } = core::mem::take(self);
        if skipping {
            LineEvent::Dropped(SlcanError::TooLong { max: MAX_LINE })
        } else {
            LineEvent::Line(line)
        }
    }

    /// Whether the letter of a frame interrupts the line: arguments are hexadecimal, and only
    /// versions and serial numbers are free text.
    fn is_broken_off(&self) -> bool {
        !matches!(self.line.as_slice(), [] | [b'V' | b'v' | b'N', ..])
    }
}

/// The number of `len` hexadecimal digits (at most 8) from character `offset` of a line.
pub(super) fn number(line: &[u8], offset: usize, len: usize) -> Result<u32, SlcanError> {
    let digits = line.get(offset..offset + len).ok_or(SlcanError::Length {
        expected: offset + len,
        got: line.len(),
    })?;
    let mut number = 0;
    for (at, &got) in (offset..).zip(digits) {
        let digit = char::from(got).to_digit(16).ok_or(SlcanError::Character {
            offset: at,
            expected: "a hexadecimal digit",
            got,
        })?;
        number = number << 4 | digit;
    }
    Ok(number)
}

/// The low `len` hexadecimal digits of `number`.
pub(super) fn write_number(number: u32, len: u32, out: &mut impl Extend<u8>) {
    out.extend((0..len).rev().map(|place| {
        let digit = (number >> (4 * place) & 0xF) as u8;
        match digit {
            0..=9 => b'0' + digit,
            _ => b'A' + digit - 10,
        }
    }));
}

/// Checks the length of a line.
pub(super) fn length(line: &[u8], expected: usize) -> Result<(), SlcanError> {
    if line.len() == expected {
        Ok(())
    } else {
        Err(SlcanError::Length {
            expected,
            got: line.len(),
        })
    }
}

/// The text after the letter of a line.
pub(super) fn text(line: &[u8]) -> Line {
    let mut text = Line::new();
    text.extend(line.iter().copied().skip(1));
    text
}
