//! `.bin` of KITTI, in the axes of the other formats: x right, y forward.

use super::source::{Positions, ReadError, SourceFile};
use crate::formats::Format;
use crate::formats::kitti::ROW_BYTES;

pub(super) fn positions(bytes: &[u8]) -> Result<Positions, ReadError> {
    let (rows, rest) = bytes.as_chunks::<ROW_BYTES>();
    if !rest.is_empty() {
        let file = SourceFile {
            format: Format::Kitti,
            bytes,
        };
        let got = format!("{} bytes", bytes.len());
        let expected = format!("rows of {ROW_BYTES} bytes");
        return Err(file.wrong(bytes.len() - rest.len(), expected, got));
    }
    let position = |row: &[u8; ROW_BYTES]| {
        let (values, _) = row.as_chunks::<4>();
        let axis = |index: usize| {
            values
                .get(index)
                .map_or(f64::NAN, |v| f32::from_le_bytes(*v).into())
        };
        [-axis(1), axis(0), axis(2)]
    };
    Ok(rows.iter().map(position).collect())
}
