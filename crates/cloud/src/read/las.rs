//! LAS and LAZ, by the `las` crate.

mod promises;

use std::io::Cursor;

use las::{LazParallelism, Reader, ReaderOptions};

use super::source::{Positions, ReadError};
use crate::formats::Format;

/// Bytes read at a time: a header may declare more points than the file has.
const BATCH_BYTES: u64 = 1 << 22;

pub(super) fn positions(format: Format, bytes: Vec<u8>) -> Result<Positions, ReadError> {
    let size = bytes.len();
    let wrong = |offset: usize, expected: &str, got: String| ReadError {
        format,
        offset,
        expected: expected.to_owned(),
        got,
    };
    let no_las = |error: las::Error| wrong(0, "a LAS or LAZ file", error.to_string());
    let raw = las::raw::Header::read_from(Cursor::new(bytes.as_slice())).map_err(no_las)?;
    let promised = match raw.large_file {
        Some(large) => large.number_of_point_records,
        None => raw.number_of_point_records.into(),
    };
    promises::kept(&bytes, promised)
        .map_err(|(offset, expected, got)| wrong(offset.min(size), expected, got))?;
    let batch = (BATCH_BYTES / u64::from(raw.point_data_record_length).max(1)).max(1);
    // On several cores the library panics at damaged bytes.
    let options = ReaderOptions::default().with_laz_parallelism(LazParallelism::No);
    let mut reader = Reader::with_options(Cursor::new(bytes), options).map_err(no_las)?;
    let count = reader.header().number_of_points();
    let mut positions = Positions::new();
    while (positions.len() as u64) < count {
        let left = count - positions.len() as u64;
        let batch = reader
            .read_points(left.min(batch))
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
