//! LAS and LAZ, by the `las` crate.

use std::io::Cursor;

use las::Reader;

use super::{Positions, ReadError};
use crate::formats::Format;

/// Points read at a time: a header may promise more than there are.
const BATCH: u64 = 1 << 16;

pub(super) fn positions(format: Format, bytes: Vec<u8>) -> Result<Positions, ReadError> {
    let size = bytes.len();
    let wrong = |offset: usize, expected: &str, got: String| ReadError {
        format,
        offset,
        expected: expected.to_owned(),
        got,
    };
    let mut reader = Reader::new(Cursor::new(bytes))
        .map_err(|error| wrong(0, "a LAS or LAZ file", error.to_string()))?;
    let count = reader.header().number_of_points();
    let mut positions = Positions::new();
    while (positions.len() as u64) < count {
        let left = count - positions.len() as u64;
        let batch = reader
            .read_points(left.min(BATCH))
            .map_err(|error| wrong(size, &format!("{count} points"), error.to_string()))?;
        if batch.is_empty() {
            let got = positions.len().to_string();
            return Err(wrong(size, &format!("{count} points"), got));
        }
        for point in batch.points() {
            let point = point.map_err(|error| wrong(size, "a point", error.to_string()))?;
            positions.push([point.x, point.y, point.z]);
        }
    }
    Ok(positions)
}
