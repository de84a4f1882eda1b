//! `.bin` of KITTI, in the axes of the other formats: x right, y forward. The reflectance becomes
//! an intensity up to 255.

use super::source::{ReadError, SourceFile};
use super::stored_cloud::StoredCloud;
use crate::Column;
use crate::formats::Format;
use crate::formats::kitti::{FULL, ROW_BYTES};

pub(super) fn read(bytes: &[u8], cloud: &mut StoredCloud) -> Result<(), ReadError> {
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
    cloud.keep(|column| column == Column::Intensity);
    cloud.reserve(rows.len());
    for row in rows {
        let (values, _) = row.as_chunks::<4>();
        let [forward, left, up, reflectance] = [0, 1, 2, 3].map(|index| {
            let value = values.get(index).copied().unwrap_or_default();
            f64::from(f32::from_le_bytes(value))
        });
        cloud.push([-left, forward, up], |_| {
            Some(reflectance * f64::from(FULL))
        });
    }
    Ok(())
}
