//! Parts of all readers: a file with its numbers and lines, and errors.

use thiserror::Error;

use crate::formats::Format;

/// x, y and z in metres.
pub type Positions = Vec<[f64; 3]>;

/// Reason why a cloud cannot be read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{format}: byte {offset}: expected {expected}, got {got}")]
#[non_exhaustive]
pub struct ReadError {
    /// The format.
    pub format: Format,
    /// Offset, from 0.
    pub offset: usize,
    /// Expected content.
    pub expected: String,
    /// Actual content.
    pub got: String,
}

/// A number type of PLY or PCD.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SourceNumber {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl SourceNumber {
    pub(super) const fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number at the beginning of some bytes; `None` if they are too few.
    pub(super) fn read(self, bytes: &[u8], big_endian: bool) -> Option<f64> {
        fn take<const N: usize>(bytes: &[u8], big_endian: bool) -> Option<[u8; N]> {
            let mut bytes: [u8; N] = *bytes.first_chunk()?;
            if big_endian {
                bytes.reverse();
            }
            Some(bytes)
        }
        Some(match self {
            Self::I8 => i8::from_le_bytes(take(bytes, big_endian)?).into(),
            Self::U8 => u8::from_le_bytes(take(bytes, big_endian)?).into(),
            Self::I16 => i16::from_le_bytes(take(bytes, big_endian)?).into(),
            Self::U16 => u16::from_le_bytes(take(bytes, big_endian)?).into(),
            Self::I32 => i32::from_le_bytes(take(bytes, big_endian)?).into(),
            Self::U32 => u32::from_le_bytes(take(bytes, big_endian)?).into(),
            Self::F32 => f32::from_le_bytes(take(bytes, big_endian)?).into(),
            Self::F64 => f64::from_le_bytes(take(bytes, big_endian)?),
        })
    }
}

/// A file, with its format for errors.
#[derive(Clone, Copy)]
pub(super) struct SourceFile<'a> {
    pub(super) format: Format,
    pub(super) bytes: &'a [u8],
}

impl<'a> SourceFile<'a> {
    pub(super) fn wrong(
        &self,
        offset: usize,
        expected: impl Into<String>,
        got: impl Into<String>,
    ) -> ReadError {
        ReadError {
            format: self.format,
            offset,
            expected: expected.into(),
            got: got.into(),
        }
    }

    /// The line at `offset` without its end, and the offset of the next; `None` at the end of the
    /// file.
    pub(super) fn line(&self, offset: usize) -> Result<Option<(&'a str, usize)>, ReadError> {
        let rest = self.bytes.get(offset..).unwrap_or_default();
        if rest.is_empty() {
            return Ok(None);
        }
        let end = rest.iter().position(|&byte| byte == b'\n');
        let line = rest.get(..end.unwrap_or(rest.len())).unwrap_or_default();
        match std::str::from_utf8(line) {
            Ok(text) => {
                let next = (offset + line.len() + 1).min(self.bytes.len());
                Ok(Some((text.trim(), next)))
            }
            Err(error) => Err(self.wrong(offset + error.valid_up_to(), "text", "other bytes")),
        }
    }

    /// Positions in a table of `count` binary rows at `start`, by offset and type of x, y and z. An
    /// error is the number of bytes of a file that is too short.
    pub(super) fn table(
        &self,
        start: usize,
        (count, row_bytes): (usize, usize),
        columns: [(usize, SourceNumber); 3],
        big_endian: bool,
    ) -> Result<Positions, usize> {
        let rows = self.bytes.get(start..).unwrap_or_default();
        if count
            .checked_mul(row_bytes)
            .is_none_or(|size| size > rows.len())
        {
            return Err(rows.len());
        }
        let read = |row: &[u8], (offset, number): (usize, SourceNumber)| {
            let bytes = row.get(offset..).unwrap_or_default();
            number.read(bytes, big_endian).unwrap_or(f64::NAN)
        };
        let rows = rows.chunks_exact(row_bytes.max(1)).take(count);
        Ok(rows
            .map(|row| columns.map(|column| read(row, column)))
            .collect())
    }

    /// At most `most` points as text, one per line from `offset` on, with the columns of x, y and
    /// z. Empty lines and comments are skipped.
    pub(super) fn rows(
        &self,
        mut offset: usize,
        columns: [usize; 3],
        is_separator: impl Fn(char) -> bool + Copy,
        most: usize,
    ) -> Result<Positions, ReadError> {
        let mut positions = Positions::new();
        while positions.len() < most
            && let Some((line, next)) = self.line(offset)?
        {
            if !is_comment(line) {
                let fields = || line.split(is_separator).filter(|field| !field.is_empty());
                let mut position = [0.0; 3];
                for (axis, place) in position.iter_mut().zip(columns) {
                    let field = fields().nth(place).unwrap_or("the end of the line");
                    *axis = field
                        .parse()
                        .map_err(|_| self.wrong(offset, "a number", format!("{field:?}")))?;
                }
                positions.push(position);
            }
            offset = next;
        }
        Ok(positions)
    }
}

/// Whether a line of text holds no point.
pub(super) fn is_comment(line: &str) -> bool {
    line.is_empty() || line.starts_with('#') || line.starts_with("//")
}

/// Shortens a text for a message.
pub(super) fn shown(text: &str) -> String {
    format!("{:?}", text.chars().take(40).collect::<String>())
}
