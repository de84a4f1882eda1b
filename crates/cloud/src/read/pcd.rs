//! PCD 0.7 and before: text, binary, or binary compressed (LZF, columns one after the other).

use super::source::{ReadError, SourceField, SourceFile, SourceNumber, SourceRow, shown};
use super::stored_cloud::StoredCloud;
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

pub(super) fn read(bytes: &[u8], cloud: &mut StoredCloud) -> Result<(), ReadError> {
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
                ["ascii"] => read.text(cloud),
                ["binary"] => read.binary(cloud),
                ["binary_compressed"] => read.compressed(cloud),
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

struct PcdReader<'a> {
    text: SourceFile<'a>,
    start: usize,
    points: usize,
    row_bytes: usize,
    row: SourceRow,
}

impl<'a> PcdReader<'a> {
    fn new(text: &SourceFile<'a>, header: &PcdHeader, start: usize) -> Result<Self, ReadError> {
        let whole = header.width.checked_mul(header.height);
        let points = header.points.or(whole).unwrap_or(0);
        let mut fields = Vec::new();
        let (mut word, mut byte) = (0_usize, 0_usize);
        for (name, field) in header.fields() {
            // Other counts are no number of a point.
            if let (Some(number), 1) = (field.number, field.count) {
                fields.push((name, SourceField { word, byte, number }));
            }
            word = word.saturating_add(field.count);
            byte = byte.saturating_add(field.size.saturating_mul(field.count));
        }
        let row = SourceRow::of(fields)
            .map_err(|_| text.wrong(0, "columns x, y and z", header.names.join(" ")))?;
        Ok(Self {
            text: *text,
            start,
            points,
            row_bytes: byte,
            row,
        })
    }

    fn text(&self, cloud: &mut StoredCloud) -> Result<(), ReadError> {
        let count = self.text.rows(self.start, &self.row, self.points, cloud)?;
        match count < self.points {
            true => Err(self.short(count, "points")),
            false => Ok(()),
        }
    }

    fn short(&self, got: usize, what: &str) -> ReadError {
        let expected = format!("{} points of {} bytes", self.points, self.row_bytes);
        self.text
            .wrong(self.text.bytes.len(), expected, format!("{got} {what}"))
    }

    fn binary(&self, cloud: &mut StoredCloud) -> Result<(), ReadError> {
        let size = (self.points, self.row_bytes);
        let table = self.text.table(self.start, size, &self.row, false, cloud);
        table.map_err(|got| self.short(got, "bytes"))
    }

    /// Two sizes, then column by column.
    fn compressed(&self, cloud: &mut StoredCloud) -> Result<(), ReadError> {
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
            .checked_mul(self.row_bytes)
            .is_none_or(|size| size > whole)
        {
            return Err(self.short(whole, "bytes"));
        }
        let unpacked = unpack(packed, whole).ok_or_else(|| {
            self.text
                .wrong(self.start + 8, "data packed by LZF", "other bytes")
        })?;
        cloud.begin(&self.row.columns, self.points);
        for point in 0..self.points {
            cloud.row(&self.row, |field| {
                let at = field.byte * self.points + point * field.number.bytes();
                field.number.read(unpacked.get(at..)?, false)
            });
        }
        Ok(())
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
