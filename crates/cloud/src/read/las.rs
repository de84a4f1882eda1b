//! LAS and LAZ, by the `las` crate.

mod promises;

use std::io::Cursor;

use las::{LazParallelism, Reader, ReaderOptions};

use super::source::{ReadError, SourceColumns, SourceField, SourceNumber};
use super::stored_cloud::StoredCloud;
use crate::Column;
use crate::formats::Format;
use crate::formats::las::{INTENSITY_STEP, extra_bytes};

/// Bytes read at a time: a header may declare more points than the file has.
const BATCH_BYTES: u64 = 1 << 22;
/// Offset of the return number and the number of returns.
const RETURNS: usize = 14;
/// Code of velomotion's column echo for the last return.
const LAST: f64 = 2.0;

pub(super) fn read(
    format: Format,
    bytes: Vec<u8>,
    cloud: &mut StoredCloud,
) -> Result<(), ReadError> {
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
    let columns = columns(reader.header());
    cloud.keep(|column| column == Column::Echo || columns.get(column).is_some());
    let is_own = reader
        .header()
        .generating_software()
        .starts_with("velomotion");
    let return_bits = match reader.header().point_format().is_extended {
        true => 4,
        false => 3,
    };
    let mut done = 0;
    while done < count {
        let batch = reader
            .read_points((count - done).min(batch))
            .map_err(|error| wrong(size, &format!("{count} points"), error.to_string()))?;
        if batch.is_empty() {
            return Err(wrong(size, &format!("{count} points"), done.to_string()));
        }
        done += batch.len() as u64;
        let rows = batch.raw_bytes().chunks_exact(batch.record_len());
        for (((x, y), z), row) in batch.x().zip(batch.y()).zip(batch.z()).zip(rows) {
            cloud.push([x, y, z], |column| {
                let read = |field: SourceField| field.number.read(row.get(field.byte..)?, false);
                let value = columns.value(column, read);
                match column {
                    Column::Intensity if is_own => Some(value? / f64::from(INTENSITY_STEP)),
                    // Of several returns, the last: which is the strongest is not known.
                    Column::Echo if value.is_none() => {
                        let returns = row.get(RETURNS)?;
                        let number = returns & ((1 << return_bits) - 1);
                        let of = (returns >> return_bits) & ((1 << return_bits) - 1);
                        Some(if number == of && of > 1 { LAST } else { 0.0 })
                    }
                    _ => value,
                }
            });
        }
    }
    // Zeros are in place of what a file of LAS lacks.
    cloud
        .columns
        .retain(|(_, values)| values.iter().any(|value| *value != 0.0));
    Ok(())
}

/// The columns of a record: standard fields, and described extra bytes.
fn columns(header: &las::Header) -> SourceColumns {
    let mut columns = SourceColumns::default();
    let mut insert = |name: &str, byte, number| {
        let field = SourceField {
            word: 0,
            byte,
            number,
        };
        columns.insert(name, field);
    };
    let format = header.point_format();
    insert("intensity", 12, SourceNumber::U16);
    if format.has_gps_time {
        let byte = if format.is_extended { 22 } else { 20 };
        insert("gps_time", byte, SourceNumber::F64);
    }
    let is_description = |vlr: &&las::Vlr| vlr.user_id == "LASF_Spec" && vlr.record_id == 4;
    let mut byte = usize::from(format.len() - format.extra_bytes);
    let records = header.all_vlrs().filter(is_description);
    for record in records.flat_map(|vlr| vlr.data.as_chunks::<{ extra_bytes::RECORD_BYTES }>().0) {
        let [_, _, code, options, ..] = *record;
        let number = match code {
            1 => SourceNumber::U8,
            2 => SourceNumber::I8,
            3 => SourceNumber::U16,
            4 => SourceNumber::I16,
            5 => SourceNumber::U32,
            6 => SourceNumber::I32,
            9 => SourceNumber::F32,
            10 => SourceNumber::F64,
            7 | 8 => {
                byte += 8;
                continue;
            }
            0 => {
                byte += usize::from(options);
                continue;
            }
            // Arrays are of a draft only.
            _ => break,
        };
        // Without scale and offset.
        if options & 0b1_1000 == 0 {
            let name = record.get(extra_bytes::NAME_AT..).unwrap_or_default();
            let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
            insert(&String::from_utf8_lossy(name), byte, number);
        }
        byte += number.bytes();
    }
    columns
}
