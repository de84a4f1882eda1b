//! Parts of all readers: a file with its numbers and lines, and errors.

use thiserror::Error;

use super::stored_cloud::StoredCloud;
use crate::Column;
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

/// A number of a row: a word of a text, or bytes.
#[derive(Clone, Copy)]
pub(super) struct SourceField {
    pub(super) word: usize,
    /// Offset in the row.
    pub(super) byte: usize,
    pub(super) number: SourceNumber,
}

/// The fields of columns.
#[derive(Clone, Copy, Default)]
pub(super) struct SourceColumns([Option<SourceField>; Column::ALL.len()]);

impl SourceColumns {
    /// Takes a field if its name, in any case, is that of a column without one.
    pub(super) fn insert(&mut self, name: &str, field: SourceField) {
        let name = name.to_ascii_lowercase();
        // CloudCompare's prefix.
        let column = match name.strip_prefix("scalar_").unwrap_or(&name) {
            "intensity" | "i" | "reflectance" | "reflectivity" => Column::Intensity,
            "ring" => Column::Ring,
            "time" | "time_s" | "t" | "timestamp" | "gps_time" | "gpstime" => Column::Time,
            "tilt" | "tilt_deg" => Column::Tilt,
            "laser" => Column::Laser,
            "sd" | "sd_m" => Column::Sd,
            "echo" => Column::Echo,
            _ => return,
        };
        if let Some(slot) = self.0.get_mut(column as usize) {
            slot.get_or_insert(field);
        }
    }

    pub(super) fn get(&self, column: Column) -> Option<SourceField> {
        *self.0.get(column as usize)?
    }

    /// The value of a column in a row whose fields `read` reads. Whole numbers of a time are
    /// nanoseconds, as Ouster's driver writes them.
    pub(super) fn value(
        &self,
        column: Column,
        read: impl Fn(SourceField) -> Option<f64>,
    ) -> Option<f64> {
        let field = self.get(column)?;
        let is_float = matches!(field.number, SourceNumber::F32 | SourceNumber::F64);
        let unit = match column {
            Column::Time if !is_float => 1e-9,
            _ => 1.0,
        };
        Some(read(field)? * unit)
    }
}

/// The fields of x, y and z and of the columns.
pub(super) struct SourceRow {
    pub(super) axes: [SourceField; 3],
    pub(super) columns: SourceColumns,
}

impl SourceRow {
    /// Finds fields by their names in any case. An error is the name of an axis without one.
    pub(super) fn of<'n>(
        fields: impl IntoIterator<Item = (&'n str, SourceField)>,
    ) -> Result<Self, &'static str> {
        let (mut axes, mut columns) = ([None; 3], SourceColumns::default());
        for (name, field) in fields {
            let name = name.to_ascii_lowercase();
            let axis = ["x", "y", "z"]
                .iter()
                .position(|axis| *axis == name.strip_suffix("_m").unwrap_or(&name));
            match axis.and_then(|axis| axes.get_mut(axis)) {
                Some(slot) => _ = slot.get_or_insert(field),
                None => columns.insert(&name, field),
            }
        }
        match axes {
            [Some(x), Some(y), Some(z)] => Ok(Self {
                axes: [x, y, z],
                columns,
            }),
            [None, ..] => Err("x"),
            [_, None, _] => Err("y"),
            _ => Err("z"),
        }
    }

    /// Number of words up to the last field.
    fn words(&self) -> usize {
        let columns = self.columns.0.iter().flatten();
        let words = self
            .axes
            .iter()
            .chain(columns)
            .map(|field| field.word.saturating_add(1));
        words.max().unwrap_or(0)
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

    /// Adds the points of a table of `count` binary rows at `start`. An error is the number of
    /// bytes of a file that is too short.
    pub(super) fn table(
        &self,
        start: usize,
        (count, row_bytes): (usize, usize),
        row: &SourceRow,
        big_endian: bool,
        cloud: &mut StoredCloud,
    ) -> Result<(), usize> {
        let rows = self.bytes.get(start..).unwrap_or_default();
        if count
            .checked_mul(row_bytes)
            .is_none_or(|size| size > rows.len())
        {
            return Err(rows.len());
        }
        let rows = rows.chunks_exact(row_bytes.max(1)).take(count);
        cloud.begin(&row.columns, rows.len());
        for bytes in rows {
            cloud.row(row, |field| {
                field.number.read(bytes.get(field.byte..)?, big_endian)
            });
        }
        Ok(())
    }

    /// Adds at most `most` points as text, one per line from `offset` on, and returns their number.
    /// Empty lines and comments are skipped; a column whose word is no number is zero.
    pub(super) fn rows(
        &self,
        mut offset: usize,
        row: &SourceRow,
        most: usize,
        cloud: &mut StoredCloud,
    ) -> Result<usize, ReadError> {
        cloud.begin(&row.columns, 0);
        let mut count = 0;
        let needed = row.words();
        let mut found: Vec<&str> = Vec::new();
        while count < most
            && let Some((line, next)) = self.line(offset)?
        {
            if !is_comment(line) {
                found.clear();
                found.extend(words(line).take(needed));
                let mut position = [0.0; 3];
                for (axis, field) in position.iter_mut().zip(row.axes) {
                    let word = *found.get(field.word).unwrap_or(&"the end of the line");
                    *axis = word
                        .parse()
                        .map_err(|_| self.wrong(offset, "a number", format!("{word:?}")))?;
                }
                let read = |field: SourceField| found.get(field.word)?.parse().ok();
                cloud.push(position, |column| row.columns.value(column, read));
                count += 1;
            }
            offset = next;
        }
        Ok(count)
    }
}

/// The words of a line between semicolons, else commas, else spaces.
pub(super) fn words(line: &str) -> impl Iterator<Item = &str> {
    let separator = [';', ','].into_iter().find(|c| line.contains(*c));
    let is_separator = move |c: char| match separator {
        Some(separator) => c == separator,
        None => c.is_ascii_whitespace(),
    };
    // Columns may be empty between commas.
    line.split(is_separator)
        .map(|word| word.trim().trim_matches('"'))
        .filter(move |word| separator.is_some() || !word.is_empty())
}

/// Whether a line of text holds no point.
pub(super) fn is_comment(line: &str) -> bool {
    line.is_empty() || line.starts_with('#') || line.starts_with("//")
}

/// Shortens a text for a message.
pub(super) fn shown(text: &str) -> String {
    format!("{:?}", text.chars().take(40).collect::<String>())
}
