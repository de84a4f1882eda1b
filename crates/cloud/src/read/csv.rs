//! Text with a row per point. A header row may name the columns, in any case; otherwise x, y and z
//! are the first three. Lines with `#` or `//` are comments, which CloudCompare writes; a comma is
//! a decimal comma, and an error, where a semicolon separates.

use super::source::{
    ReadError, SourceField, SourceFile, SourceNumber, SourceRow, is_comment, shown, words,
};
use super::stored_cloud::StoredCloud;
use crate::formats::Format;

pub(super) fn read(format: Format, bytes: &[u8], cloud: &mut StoredCloud) -> Result<(), ReadError> {
    let text = SourceFile { format, bytes };
    // UTF-8 with a byte order mark.
    let mut offset = if bytes.starts_with("\u{feff}".as_bytes()) {
        3
    } else {
        0
    };
    while let Some((line, next)) = text.line(offset)? {
        if is_comment(line) {
            offset = next;
            continue;
        }
        let field = |(word, name)| {
            let (byte, number) = (0, SourceNumber::F64);
            (name, SourceField { word, byte, number })
        };
        let is_header = words(line).any(|word| !word.is_empty() && word.parse::<f64>().is_err());
        let row = match is_header {
            true => SourceRow::of(words(line).enumerate().map(field)),
            false => SourceRow::of(["x", "y", "z"].into_iter().enumerate().map(field)),
        };
        let row = row.map_err(|_| text.wrong(offset, "columns x_m, y_m and z_m", shown(line)))?;
        let start = if is_header { next } else { offset };
        text.rows(start, &row, usize::MAX, cloud)?;
        break;
    }
    Ok(())
}
