//! PCD 0.7 and before: text, binary, or binary compressed (LZF, columns one after the other).

use super::source::{Positions, ReadError, SourceFile, SourceNumber, shown};
use crate::formats::Format;

/// A column.
#[derive(Clone, Copy)]
struct PcdField {
    number: Option<SourceNumber>,
    size: usize,
    count: usize,
}

/// Contents of the header.
#[derive(Default)]
struct PcdHeader {
    names: Vec<String>,
    sizes: Vec<usize>,
    types: Vec<String>,
    counts: Vec<usize>,
    width: usize,
    height: usize,
    points: Option<usize>,
}

pub(super) fn positions(bytes: &[u8]) -> Result<Positions, ReadError> {
    let text = SourceFile {
        format: Format::Pcd,
        bytes,
    };
    let mut header = PcdHeader::default();
    let mut offset = 0;
    loop {
        let end = || text.wrong(bytes.len(), "a line DATA", "the end of the file");
        let (line, next) = text.line(offset)?.ok_or_else(end)?;
        let mut words = line.split_ascii_whitespace();
        let key = words.next().unwrap_or("#");
        let words: Vec<&str> = words.collect();
        if key == "DATA" {
            let read = PcdReader::new(&text, &header, next)?;
            return match words.as_slice() {
                ["ascii"] => read.text(),
                ["binary"] => read.binary(),
                ["binary_compressed"] => read.compressed(),
                _ => {
                    let expected = "DATA ascii, binary or binary_compressed";
                    Err(text.wrong(offset, expected, shown(line)))
                }
            };
        }
        let taken = header.take(key, &words);
        taken.ok_or_else(|| text.wrong(offset, "a line of a PCD header", shown(line)))?;
        offset = next;
    }
}

impl PcdHeader {
    fn take(&mut self, key: &str, words: &[&str]) -> Option<()> {
        let numbers = || {
            words
                .iter()
                .map(|word| word.parse().ok())
                .collect::<Option<Vec<usize>>>()
        };
        let one = || words.first()?.parse::<usize>().ok();
        match key {
            _ if key.starts_with('#') => {}
            "VERSION" | "VIEWPOINT" => {}
            "FIELDS" => self.names = words.iter().map(|&word| word.to_owned()).collect(),
            "SIZE" => self.sizes = numbers()?,
            "TYPE" => self.types = words.iter().map(|&word| word.to_owned()).collect(),
            "COUNT" => self.counts = numbers()?,
            "WIDTH" => self.width = one()?,
            "HEIGHT" => self.height = one()?,
            "POINTS" => self.points = Some(one()?),
            _ => return None,
        }
        Some(())
    }

    fn fields(&self) -> impl Iterator<Item = (&str, PcdField)> {
        let columns = self.names.iter().zip(&self.sizes).zip(&self.types);
        columns.enumerate().map(|(i, ((name, &size), kind))| {
            let number = match (kind.as_str(), size) {
                ("I", 1) => Some(SourceNumber::I8),
                ("U", 1) => Some(SourceNumber::U8),
                ("I", 2) => Some(SourceNumber::I16),
                ("U", 2) => Some(SourceNumber::U16),
                ("I", 4) => Some(SourceNumber::I32),
                ("U", 4) => Some(SourceNumber::U32),
                ("F", 4) => Some(SourceNumber::F32),
                ("F", 8) => Some(SourceNumber::F64),
                _ => None,
            };
            let count = self.counts.get(i).copied().unwrap_or(1);
            (
                name.as_str(),
                PcdField {
                    number,
                    size,
                    count,
                },
            )
        })
    }
}

/// Columns of x, y and z: index of the word in a row of text, byte offset in a row, and stride of
/// the column in compressed data.
struct PcdReader<'a> {
    text: SourceFile<'a>,
    start: usize,
    points: usize,
    row: usize,
    columns: [PcdColumn; 3],
}

#[derive(Clone, Copy)]
struct PcdColumn {
    word: usize,
    byte: usize,
    number: SourceNumber,
    stride: usize,
}

impl<'a> PcdReader<'a> {
    fn new(text: &SourceFile<'a>, header: &PcdHeader, start: usize) -> Result<Self, ReadError> {
        let whole = header.width.checked_mul(header.height);
        let points = header.points.or(whole).unwrap_or(0);
        let mut columns = [None; 3];
        let (mut word, mut row) = (0_usize, 0_usize);
        for (name, field) in header.fields() {
            let axis = ["x", "y", "z"].iter().position(|axis| *axis == name);
            if let (Some(slot), Some(number)) =
                (axis.and_then(|a| columns.get_mut(a)), field.number)
            {
                *slot = Some(PcdColumn {
                    word,
                    byte: row,
                    number,
                    stride: field.size,
                });
            }
            word = word.saturating_add(field.count);
            row = row.saturating_add(field.size.saturating_mul(field.count));
        }
        let [Some(x), Some(y), Some(z)] = columns else {
            return Err(text.wrong(0, "columns x, y and z", header.names.join(" ")));
        };
        Ok(Self {
            text: *text,
            start,
            points,
            row,
            columns: [x, y, z],
        })
    }

    fn text(&self) -> Result<Positions, ReadError> {
        let places = self.columns.map(|column| column.word);
        let space = |c: char| c.is_ascii_whitespace();
        let positions = self.text.rows(self.start, places, space, self.points)?;
        if positions.len() < self.points {
            return Err(self.short(positions.len(), "points"));
        }
        Ok(positions)
    }

    fn short(&self, got: usize, what: &str) -> ReadError {
        let expected = format!("{} points of {} bytes", self.points, self.row);
        self.text
            .wrong(self.text.bytes.len(), expected, format!("{got} {what}"))
    }

    fn binary(&self) -> Result<Positions, ReadError> {
        let columns = self.columns.map(|column| (column.byte, column.number));
        let size = (self.points, self.row);
        let table = self.text.table(self.start, size, columns, false);
        table.map_err(|got| self.short(got, "bytes"))
    }

    /// Two sizes, then column by column.
    fn compressed(&self) -> Result<Positions, ReadError> {
        let bytes = self.text.bytes.get(self.start..).unwrap_or_default();
        let size = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?) as usize);
        let short = || self.short(bytes.len(), "bytes");
        let (packed, whole) = (size(0).ok_or_else(short)?, size(4).ok_or_else(short)?);
        let packed = bytes
            .get(8..)
            .and_then(|rest| rest.get(..packed))
            .ok_or_else(short)?;
        if self
            .points
            .checked_mul(self.row)
            .is_none_or(|size| size > whole)
        {
            return Err(self.short(whole, "bytes"));
        }
        let unpacked = unpack(packed, whole).ok_or_else(|| {
            self.text
                .wrong(self.start + 8, "data packed by LZF", "other bytes")
        })?;
        let read = |point: usize, column: PcdColumn| {
            let at = column.byte * self.points + point * column.stride;
            let bytes = unpacked.get(at..).unwrap_or_default();
            column.number.read(bytes, false).unwrap_or(f64::NAN)
        };
        let points = 0..self.points;
        Ok(points
            .map(|point| self.columns.map(|column| read(point, column)))
            .collect())
    }
}

/// LZF: runs of new bytes (control below 32: that many and one more), and copies of earlier ones
/// (three bits of length and 13 of distance; a length from 7 on has a byte of its own). `None` for
/// anything else, or another size than `whole`.
fn unpack(packed: &[u8], whole: usize) -> Option<Vec<u8>> {
    let mut out: Vec<u8> = Vec::new();
    let mut bytes = packed.iter().copied();
    while let Some(control) = bytes.next() {
        if control < 32 {
            let before = out.len();
            let run = usize::from(control) + 1;
            out.extend(bytes.by_ref().take(run));
            if out.len() != before + run {
                return None;
            }
        } else {
            let length = match control >> 5 {
                7 => usize::from(bytes.next()?) + 7,
                short => usize::from(short),
            };
            let back = (usize::from(control & 31) << 8 | usize::from(bytes.next()?)) + 1;
            let from = out.len().checked_sub(back)?;
            // A copy may overlap its own output.
            for from in from..from + length + 2 {
                out.push(*out.get(from)?);
            }
        }
        if out.len() > whole {
            return None;
        }
    }
    (out.len() == whole).then_some(out)
}
