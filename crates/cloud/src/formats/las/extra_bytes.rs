//! Extra bytes of a point, and the record that describes them (LAS 1.4 R15, section 5.5:
//! `LASF_Spec` 4, 192 bytes per dimension), so that readers show them by name.

use las::Vlr;

use crate::rows::NumberType;
use crate::{Column, Fields};

pub(crate) const RECORD_BYTES: usize = 192;
pub(crate) const NAME_AT: usize = 4;
const DESCRIPTION_AT: usize = 160;

/// A column among the extra bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ExtraColumn {
    pub(super) column: Column,
    pub(super) number: NumberType,
    /// Byte offset among the extra bytes.
    pub(super) offset: usize,
}

/// Number type and description (at most 32 characters); `None` for the column with a standard
/// field.
const fn kind(column: Column) -> Option<(NumberType, &'static str)> {
    use NumberType::{F32, F64, U8};
    match column {
        Column::Intensity => None,
        Column::Ring => Some((U8, "0 = lowest elevation")),
        Column::Time => Some((F64, "Unix seconds, host clock")),
        Column::Tilt => Some((F32, "tilt of the platform, degrees")),
        Column::Laser => Some((U8, "laser in firing order")),
        Column::DeviceTime => Some((F64, "seconds, clock of the lidar")),
        Column::Sd => Some((F32, "expected error (RMS), metres")),
        Column::Echo => Some((U8, "1 strongest 2 last 3 both 4 rest")),
    }
}

/// The columns that need extra bytes, with their offsets.
pub(super) fn layout(fields: Fields) -> Vec<ExtraColumn> {
    let mut offset = 0;
    let mut extras = Vec::new();
    for column in fields.columns() {
        if let Some((number, _)) = kind(column) {
            extras.push(ExtraColumn {
                column,
                number,
                offset,
            });
            offset += number.bytes();
        }
    }
    extras
}

/// Number of extra bytes of a point; at most 27, with every column.
pub(super) fn length(extras: &[ExtraColumn]) -> u16 {
    extras.iter().map(|extra| extra.number.bytes() as u16).sum()
}

/// The record that describes the extra bytes.
pub(super) fn record(extras: &[ExtraColumn]) -> Vlr {
    let mut data = Vec::with_capacity(extras.len() * RECORD_BYTES);
    for extra in extras {
        if let Some((number, description)) = kind(extra.column) {
            // Data type codes of section 5.5.
            let code = match number {
                NumberType::U8 => 1,
                NumberType::U16 => 3,
                NumberType::F32 => 9,
                NumberType::F64 => 10,
            };
            let mut record = [0; RECORD_BYTES];
            // Bytes 0 and 1 are reserved. Options (byte 3) stay 0: no nodata, minimum, maximum,
            // scale, offset.
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
    fn offsets_are_contiguous_and_texts_fit() {
        let extras = layout(Fields::ALL);
        let mut expected = 0;
        for extra in &extras {
            let (number, description) = kind(extra.column).unwrap();
            assert_eq!(extra.offset, expected);
            expected += number.bytes();
            assert!(description.len() <= 32 && extra.column.name().len() <= 32);
        }
        assert_eq!(usize::from(length(&extras)), expected);
        assert_eq!(expected, 27);
        let record = record(&extras);
        assert_eq!(record.data.len(), 7 * RECORD_BYTES);
        assert_eq!(record.description, "Extra bytes");
    }

    #[test]
    fn intensity_needs_no_extra_bytes() {
        assert!(layout(Fields::INTENSITY).is_empty());
        assert_eq!(length(&layout(Fields::FILE)), 1 + 8 + 4);
    }
}
