//! Columns into rows of bytes, in one pass per column over the rows of a batch.

use std::ops::Range;

use crate::points::ColumnValues;

/// Number type of a column in a row, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NumberType {
    U8,
    U16,
    F32,
    F64,
}

impl NumberType {
    /// Its size in bytes.
    pub(crate) const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// Rows of one length, reused from batch to batch.
#[derive(Clone, Debug)]
pub(crate) struct RowBuffer {
    row_bytes: usize,
    bytes: Vec<u8>,
}

impl RowBuffer {
    /// A buffer for rows of `row_bytes` bytes (at least one).
    pub(crate) fn new(row_bytes: usize) -> Self {
        Self {
            row_bytes: row_bytes.max(1),
            bytes: Vec::new(),
        }
    }

    /// Sets the number of rows to `count`; their content is unspecified.
    pub(crate) fn reset(&mut self, count: usize) {
        self.bytes.resize(count * self.row_bytes, 0);
    }

    /// Every row; none if rows are not of `N` bytes.
    pub(crate) fn each<const N: usize>(&mut self) -> impl Iterator<Item = &mut [u8; N]> {
        let fits = N == self.row_bytes;
        let (rows, _) = self.bytes.as_chunks_mut::<N>();
        rows.iter_mut().take(if fits { usize::MAX } else { 0 })
    }

    /// All rows, to be filled.
    pub(crate) fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    pub(crate) const fn row_bytes(&self) -> usize {
        self.row_bytes
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// Writes a column at byte `offset` of every row of `rows`.
pub(crate) fn fill<const N: usize>(
    rows: &mut [u8],
    row_bytes: usize,
    offset: usize,
    values: impl Iterator<Item = [u8; N]>,
) {
    for (row, value) in rows.chunks_exact_mut(row_bytes.max(1)).zip(values) {
        if let Some(slot) = row.get_mut(offset..offset + N) {
            slot.copy_from_slice(&value);
        }
    }
}

/// Writes `range` of a column as numbers of `number`; `seconds` converts the nanoseconds of times.
pub(crate) fn fill_values(
    rows: &mut [u8],
    row_bytes: usize,
    offset: usize,
    (values, range): (ColumnValues<'_>, Range<usize>),
    number: NumberType,
    seconds: impl Fn(i64) -> f64,
) {
    use NumberType::{F32, F64, U8, U16};
    match values {
        ColumnValues::Bytes(column) => {
            let column = part(column, range).iter();
            match number {
                U8 => fill(rows, row_bytes, offset, column.map(|v| [*v])),
                U16 => fill(
                    rows,
                    row_bytes,
                    offset,
                    column.map(|v| u16::from(*v).to_le_bytes()),
                ),
                F32 => fill(
                    rows,
                    row_bytes,
                    offset,
                    column.map(|v| f32::from(*v).to_le_bytes()),
                ),
                F64 => fill(
                    rows,
                    row_bytes,
                    offset,
                    column.map(|v| f64::from(*v).to_le_bytes()),
                ),
            }
        }
        ColumnValues::Floats(column) => {
            fill_floats(
                rows,
                row_bytes,
                offset,
                part(column, range).iter().copied(),
                number,
            );
        }
        ColumnValues::HostTimes(column) => {
            let seconds = part(column, range).iter().map(|t| seconds(t.as_nanos()));
            fill_floats(rows, row_bytes, offset, seconds, number);
        }
        ColumnValues::LidarTimes(column) => {
            let seconds = part(column, range).iter().map(|t| seconds(t.as_nanos()));
            fill_floats(rows, row_bytes, offset, seconds, number);
        }
    }
}

/// Writes floats as f32, or as f64 for any wider type.
fn fill_floats(
    rows: &mut [u8],
    row_bytes: usize,
    offset: usize,
    values: impl Iterator<Item = f64>,
    number: NumberType,
) {
    match number {
        NumberType::F64 => fill(rows, row_bytes, offset, values.map(f64::to_le_bytes)),
        _ => fill(
            rows,
            row_bytes,
            offset,
            values.map(|v| (v as f32).to_le_bytes()),
        ),
    }
}

/// Some rows of a column; none if it is shorter.
pub(crate) fn part<T>(column: &[T], range: Range<usize>) -> &[T] {
    column.get(range).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_become_rows() {
        let mut rows = RowBuffer::new(3);
        rows.reset(2);
        fill(rows.bytes_mut(), 3, 0, [1u8, 2].iter().map(|v| [*v]));
        fill(
            rows.bytes_mut(),
            3,
            1,
            [0x0304u16, 0x0506].iter().map(|v| v.to_be_bytes()),
        );
        assert_eq!(rows.bytes(), [1, 3, 4, 2, 5, 6]);
        rows.reset(1);
        assert_eq!(rows.bytes(), [1, 3, 4]);
        rows.each::<3>().for_each(|row| *row = [7, 8, 9]);
        assert_eq!(rows.bytes(), [7, 8, 9]);
        assert_eq!(rows.each::<2>().count(), 0);
    }
}
