//! Text with a row per point. A header row may name the columns; x, y and z are found by name in
//! any case, otherwise they are the first three. Lines with `#` or `//` are comments, which
//! CloudCompare writes; a comma is a decimal comma, and an error, where a semicolon separates.

use super::source::{Positions, ReadError, SourceFile, is_comment};
use crate::formats::Format;

const NAMES: [[&str; 2]; 3] = [["x_m", "x"], ["y_m", "y"], ["z_m", "z"]];

pub(super) fn positions(format: Format, bytes: &[u8]) -> Result<Positions, ReadError> {
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
        let separates = match line.contains(';') {
            true => |c: char| c == ';' || c.is_ascii_whitespace(),
            false => |c: char| c == ',' || c.is_ascii_whitespace(),
        };
        let is_header = line.split(separates).any(|field| {
            let field = field.trim();
            !field.is_empty() && field.parse::<f64>().is_err()
        });
        if !is_header {
            return text.rows(offset, [0, 1, 2], separates, usize::MAX);
        }
        let place = |names: [&str; 2]| {
            let mut fields = line.split(separates).filter(|field| !field.is_empty());
            fields.position(|field| {
                let field = field.trim().trim_matches('"');
                names.iter().any(|name| name.eq_ignore_ascii_case(field))
            })
        };
        let [Some(x), Some(y), Some(z)] = NAMES.map(place) else {
            return Err(text.wrong(
                offset,
                "columns x_m, y_m and z_m",
                super::source::shown(line),
            ));
        };
        return text.rows(next, [x, y, z], separates, usize::MAX);
    }
    Ok(Positions::new())
}
