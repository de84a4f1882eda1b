//! numpy's `.npz`: the structured array `points`, else the first array, if it is not compressed.
//!
//! numpy.savez writes such archives of what velomotion's Python package reads.

use super::source::{ReadError, SourceField, SourceFile, SourceNumber, SourceRow, shown};
use super::stored_cloud::StoredCloud;
use crate::formats::Format;
use crate::formats::npz::{
    CENTRAL, END, END_64, EXTRA_64, IN_64, LOCAL, LOCATOR_64, MAGIC, POINTS,
};

/// Bytes of the last part of an archive without its comment, and the most with one.
const END_BYTES: usize = 22;
const MOST_END_BYTES: usize = END_BYTES + u16::MAX as usize;

pub(super) fn read(bytes: &[u8], cloud: &mut StoredCloud) -> Result<(), ReadError> {
    let file = SourceFile {
        format: Format::Npz,
        bytes,
    };
    let entry = array(&file)?;
    let wrong = |expected: &str, got: String| file.wrong(entry.start, expected, got);
    if entry.method != 0 {
        let got = "a compressed one".to_owned();
        return Err(wrong("an array that is not compressed (numpy.savez)", got));
    }
    let end = entry.start.saturating_add(entry.size);
    let content = bytes.get(entry.start..end);
    if content.is_none_or(|content| crc32fast::hash(content) != entry.crc) {
        let got = "other bytes".to_owned();
        return Err(wrong("an array of the archive's size and checksum", got));
    }
    let header = Header::read(bytes, entry.start).ok_or_else(|| {
        let got = shown(&String::from_utf8_lossy(slice(bytes, entry.start, 40)));
        wrong("an array of numpy", got)
    })?;
    let (count, fields, row_bytes) = header.rows().ok_or_else(|| {
        let expected = "a structured array of one dimension and little-endian numbers";
        wrong(expected, shown(header.text))
    })?;
    let row = SourceRow::of(fields)
        .map_err(|axis| wrong(&format!("a field {axis}"), shown(header.text)))?;
    // Not beyond the array, into the archive's directory.
    let file = SourceFile {
        format: Format::Npz,
        bytes: bytes.get(..end).unwrap_or(bytes),
    };
    let table = file.table(header.end, (count, row_bytes), &row, false, cloud);
    table.map_err(|got| {
        let expected = format!("{count} points of {row_bytes} bytes");
        file.wrong(header.end, expected, format!("{got} bytes"))
    })
}

/// An array in an archive.
struct StoredArray {
    method: u16,
    /// Its first byte.
    start: usize,
    size: usize,
    crc: u32,
}

fn slice(bytes: &[u8], from: usize, count: usize) -> &[u8] {
    let rest = bytes.get(from..).unwrap_or_default();
    rest.get(..count).unwrap_or(rest)
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn u64_at(bytes: &[u8], at: usize) -> Option<usize> {
    let value = u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?);
    value.try_into().ok()
}

/// The array of the points.
fn array(file: &SourceFile<'_>) -> Result<StoredArray, ReadError> {
    let bytes = file.bytes;
    let least = bytes.len().saturating_sub(MOST_END_BYTES);
    let end = (least..=bytes.len().saturating_sub(END_BYTES))
        .rev()
        .find(|at| u32_at(bytes, *at) == Some(END))
        .ok_or_else(|| file.wrong(bytes.len(), "the end of a zip archive", "none"))?;
    let cut = || file.wrong(end, "the directory of a zip archive", "another end");
    let mut at = directory(bytes, end).ok_or_else(cut)?;
    let mut first = None;
    while at < end && u32_at(bytes, at) == Some(CENTRAL) {
        let (name, entry, next) = central_header(bytes, at).ok_or_else(cut)?;
        if name == POINTS.as_bytes() {
            return Ok(entry);
        }
        if name.ends_with(b".npy") {
            first.get_or_insert(entry);
        }
        at = next;
    }
    first.ok_or_else(|| file.wrong(at.min(end), format!("an array {POINTS}"), "none"))
}

/// The offset of the central directory, before the end of the archive at `end`.
fn directory(bytes: &[u8], end: usize) -> Option<usize> {
    const LOCATOR_BYTES: usize = 20;
    let locator = end.checked_sub(LOCATOR_BYTES);
    match locator.filter(|at| u32_at(bytes, *at) == Some(LOCATOR_64)) {
        None => usize::try_from(u32_at(bytes, end + 16)?).ok(),
        Some(locator) => {
            let end_64 = u64_at(bytes, locator + 8)?;
            (u32_at(bytes, end_64)? == END_64).then(|| u64_at(bytes, end_64.checked_add(48)?))?
        }
    }
}

/// Name and content of the file of a central directory header, and the offset of the next.
fn central_header(bytes: &[u8], at: usize) -> Option<(&[u8], StoredArray, usize)> {
    const CENTRAL_BYTES: usize = 46;
    const LOCAL_BYTES: usize = 30;
    let line = bytes.get(at..)?;
    let lengths = [28, 30, 32].map(|at| u16_at(line, at).map(usize::from));
    let [name_bytes, extra_bytes, comment_bytes] = lengths;
    let (name_bytes, extra_bytes) = (name_bytes?, extra_bytes?);
    let name = line.get(CENTRAL_BYTES..)?.get(..name_bytes)?;
    let extra = line.get(CENTRAL_BYTES + name_bytes..)?.get(..extra_bytes)?;
    // Those of size, compressed size and offset that need 64 bits, in this order.
    let mut wide = wide_fields(extra);
    let mut field = |at: usize| match u32_at(line, at)? {
        IN_64 => wide.next(),
        value => usize::try_from(value).ok(),
    };
    let (size, _, header) = (field(24)?, field(20)?, field(42)?);
    (u32_at(bytes, header)? == LOCAL).then_some(())?;
    let before = [26, 28].map(|at| u16_at(bytes, header.saturating_add(at)).map(usize::from));
    let [name_before, extra_before] = before;
    let start = header
        .checked_add(LOCAL_BYTES)?
        .checked_add(name_before? + extra_before?)?;
    (start <= bytes.len()).then_some(())?;
    let entry = StoredArray {
        method: u16_at(line, 10)?,
        start,
        size,
        crc: u32_at(line, 16)?,
    };
    let next = at + CENTRAL_BYTES + name_bytes + extra_bytes + comment_bytes?;
    Some((name, entry, next))
}

/// The fields of 64 bits among further fields.
fn wide_fields(mut extra: &[u8]) -> impl Iterator<Item = usize> {
    let mut found: &[u8] = &[];
    while let (Some(kind), Some(length)) = (u16_at(extra, 0), u16_at(extra, 2)) {
        let length = usize::from(length);
        let content = slice(extra, 4, length);
        if kind == EXTRA_64 {
            found = content;
        }
        extra = extra.get(4 + length..).unwrap_or_default();
    }
    found.chunks_exact(8).map_while(|field| u64_at(field, 0))
}

/// Fields of a row with their names.
type NamedFields<'a> = Vec<(&'a str, SourceField)>;

/// Header of an array.
struct Header<'a> {
    /// A dictionary in Python's notation.
    text: &'a str,
    /// Offset of the rows.
    end: usize,
}

impl<'a> Header<'a> {
    fn read(bytes: &'a [u8], at: usize) -> Option<Self> {
        let version = bytes.get(at..)?.strip_prefix(MAGIC.as_slice())?.first()?;
        let length_at = at + MAGIC.len() + 2;
        let (length, text_at) = match version {
            1 => (usize::from(u16_at(bytes, length_at)?), length_at + 2),
            _ => (u32_at(bytes, length_at)? as usize, length_at + 4),
        };
        let text = bytes.get(text_at..)?.get(..length)?;
        Some(Self {
            text: std::str::from_utf8(text).ok()?,
            end: text_at + length,
        })
    }

    /// Number of rows, their fields of numbers, and bytes of a row.
    fn rows(&self) -> Option<(usize, NamedFields<'a>, usize)> {
        let (_, shape) = self.text.split_once("'shape': (")?;
        let (count, rest) = shape.split_once(',')?;
        rest.trim_start().starts_with(')').then_some(())?;
        let (_, columns) = self.text.split_once("'descr': [(")?;
        let (columns, _) = columns.split_once(")]")?;
        let (mut fields, mut byte) = (Vec::new(), 0_usize);
        for (word, column) in columns.split("), (").enumerate() {
            // A column of several numbers has a third word.
            let (name, kind) = column.split_once(", ")?;
            let [name, kind] = [name, kind].map(|word| word.strip_prefix('\'')?.strip_suffix('\''));
            let (kind, name) = (kind?, name?);
            let (size, number) = number_type(kind)?;
            if let Some(number) = number {
                fields.push((name, SourceField { word, byte, number }));
            }
            byte = byte.checked_add(size)?;
        }
        Some((count.trim().parse().ok()?, fields, byte))
    }
}

/// Size of a type, and the number that it is; other types are skipped.
fn number_type(kind: &str) -> Option<(usize, Option<SourceNumber>)> {
    let number = match kind {
        "|i1" => SourceNumber::I8,
        "|u1" => SourceNumber::U8,
        "<i2" => SourceNumber::I16,
        "<u2" => SourceNumber::U16,
        "<i4" => SourceNumber::I32,
        "<u4" => SourceNumber::U32,
        "<f4" => SourceNumber::F32,
        "<f8" => SourceNumber::F64,
        _ => {
            // Gaps between fields, and long numbers.
            let size = kind.strip_prefix(['|', '<'])?.get(1..)?;
            let is_known = ["|V", "|b", "<i", "<u"]
                .iter()
                .any(|of| kind.starts_with(of));
            return is_known.then(|| Some((size.parse().ok()?, None)))?;
        }
    };
    Some((number.bytes(), Some(number)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &str) -> Option<(usize, NamedFields<'_>, usize)> {
        Header { text, end: 0 }.rows()
    }

    #[test]
    fn fields_are_found_behind_gaps_and_other_types() {
        let text = "{'descr': [('x', '<f4'), ('', '|V4'), ('stamp', '<i8'), ('ring', '|u1')], 'fortran_order': False, 'shape': (7,), }";
        let (count, fields, row_bytes) = rows(text).unwrap();
        assert_eq!((count, row_bytes), (7, 17));
        let places: Vec<_> = fields.iter().map(|(name, at)| (*name, at.byte)).collect();
        assert_eq!(places, [("x", 0), ("ring", 16)]);
    }

    /// A wrong width of one column would shift all others.
    #[test]
    fn columns_that_are_no_single_little_endian_numbers_are_refused() {
        let text = |columns: &str, shape: &str| {
            format!("{{'descr': {columns}, 'fortran_order': False, 'shape': {shape}, }}")
        };
        for (columns, shape) in [
            ("[('x', '>f4')]", "(7,)"),
            ("[('x', '<f4', (3,))]", "(7,)"),
            ("[('x', '<f4'), ('name', '<U9')]", "(7,)"),
            ("'<f4'", "(7, 3)"),
            ("[('x', '<f4')]", "(7, 3)"),
            ("[('x', '<f4')]", "()"),
        ] {
            assert!(rows(&text(columns, shape)).is_none(), "{columns} {shape}");
        }
    }
}
