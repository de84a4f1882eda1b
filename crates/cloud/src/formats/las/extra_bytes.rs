//! The extra bytes of a point and the record that describes them (LAS 1.4 R15, section 5.5: `LASF_Spec` 4, 192
//! bytes a dimension), so that readers show them by name.

use las::Vlr;

use crate::{Column, Fields};

const RECORD_BYTES: usize = 192;
const NAME_AT: usize = 4;
const DESCRIPTION_AT: usize = 160;

/// A column among the extra bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Extra {
    pub(super) column: Column,
    /// Byte offset among the extra bytes.
    pub(super) offset: usize,
}

/// LAS data type code, size in bytes, description (at most 32 characters). `None`: the column has a place of its own.
const fn kind(column: Column) -> Option<(u8, usize, &'static str)> {
    const U8: u8 = 1;
    const F32: u8 = 9;
    const F64: u8 = 10;
    match column {
        Column::Intensity => None,
        Column::Ring => Some((U8, 1, "0 = lowest elevation")),
        Column::Time => Some((F64, 8, "Unix seconds, host clock")),
        Column::Tilt => Some((F32, 4, "tilt of the platform, degrees")),
        Column::Laser => Some((U8, 1, "laser in firing order")),
        Column::DeviceTime => Some((F64, 8, "seconds, clock of the lidar")),
        Column::Sd => Some((F32, 4, "expected error (RMS), metres")),
        Column::Echo => Some((U8, 1, "1 strongest 2 last 3 both 4 rest")),
    }
}

/// Where each of the columns that need extra bytes stands.
pub(super) fn layout(fields: Fields) -> Vec<Extra> {
    let mut offset = 0;
    let mut extras = Vec::new();
    for column in fields.columns() {
        if let Some((_, size, _)) = kind(column) {
            extras.push(Extra { column, offset });
            offset += size;
        }
    }
    extras
}

/// Bytes that they take in a point; at most 26, with every column.
pub(super) fn length(extras: &[Extra]) -> u16 {
    extras
        .iter()
        .filter_map(|extra| kind(extra.column))
        .map(|(_, size, _)| size as u16)
        .sum()
}

/// The record that describes them.
pub(super) fn record(extras: &[Extra]) -> Vlr {
    let mut data = Vec::with_capacity(extras.len() * RECORD_BYTES);
    for extra in extras {
        if let Some((code, _, description)) = kind(extra.column) {
            let mut record = [0; RECORD_BYTES];
            // Bytes 0 and 1 are reserved; options (byte 3) stay 0: no nodata, minimum, maximum, scale or offset.
            put(&mut record, 2, &[code]);
            put(&mut record, NAME_AT, extra.column.name().as_bytes());
            put(&mut record, DESCRIPTION_AT, description.as_bytes());
            data.extend_from_slice(&record);
        }
    }
    Vlr {
        user_id: "LASF_Spec".to_owned(),
        record_id: 4,
        description: "Extra bytes".to_owned(),
        data,
    }
}

fn put(record: &mut [u8; RECORD_BYTES], offset: usize, bytes: &[u8]) {
    for (slot, byte) in record.iter_mut().skip(offset).zip(bytes) {
        *slot = *byte;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_follow_one_another_and_texts_fit() {
        let extras = layout(Fields::ALL);
        let mut expected = 0;
        for extra in &extras {
            let (_, size, description) = kind(extra.column).unwrap();
            assert_eq!(extra.offset, expected);
            expected += size;
            assert!(description.len() <= 32 && extra.column.name().len() <= 32);
        }
        assert_eq!(usize::from(length(&extras)), expected);
        assert_eq!(expected, 27);
        assert_eq!(record(&extras).data.len(), 7 * RECORD_BYTES);
    }

    #[test]
    fn intensity_needs_no_extra_bytes() {
        assert!(layout(Fields::INTENSITY).is_empty());
        assert_eq!(length(&layout(Fields::FILE)), 1 + 8 + 4);
    }
}
