//! Rows of little-endian bytes in PLY and PCD: f32 positions, then the requested columns.

use super::seconds::seconds;
use crate::points::ColumnValues;
use crate::rows::{NumberType, RowBuffer, fill_values};
use crate::{Column, Fields, Points};

/// Number type of a column.
pub(super) const fn number_type(column: Column) -> NumberType {
    match column {
        Column::Intensity | Column::Tilt | Column::Sd => NumberType::F32,
        Column::Time | Column::DeviceTime => NumberType::F64,
        Column::Ring | Column::Laser | Column::Echo => NumberType::U8,
    }
}

/// The columns of a row.
#[derive(Debug)]
pub(super) struct RowLayout {
    fields: Fields,
    rows: RowBuffer,
}

impl RowLayout {
    pub(super) fn new(fields: Fields) -> Self {
        let position = 3 * NumberType::F32.bytes();
        let columns: usize = fields
            .columns()
            .map(|column| number_type(column).bytes())
            .sum();
        Self {
            fields,
            rows: RowBuffer::new(position + columns),
        }
    }

    /// Bytes of a row.
    pub(super) const fn row_bytes(&self) -> usize {
        self.rows.row_bytes()
    }

    /// Names and number types, in order.
    pub(super) fn properties(&self) -> impl Iterator<Item = (&'static str, NumberType)> {
        let columns = self.fields.columns();
        ["x", "y", "z"]
            .map(|axis| (axis, NumberType::F32))
            .into_iter()
            .chain(columns.map(|column| (column.name(), number_type(column))))
    }

    /// The rows of a batch that has the columns.
    pub(super) fn encode(&mut self, batch: &Points) -> &[u8] {
        let rows = &mut self.rows;
        rows.reset(batch.len());
        if self.fields == Fields::FILE {
            default_rows(rows, batch);
        } else {
            columns_into(rows, self.fields, batch);
        }
        rows.bytes()
    }
}

/// Bytes of a row of the default columns: x, y, z, intensity, ring, time, tilt.
const DEFAULT_ROW_BYTES: usize = 29;

/// The default columns, row by row in one pass: faster, and most files have them.
fn default_rows(rows: &mut RowBuffer, batch: &Points) {
    let (x, y, z) = (batch.x_m(), batch.y_m(), batch.z_m());
    let intensity_ring = batch.intensity().iter().zip(batch.ring());
    let time_tilt = batch.time().iter().zip(batch.tilt_deg());
    let columns = x.iter().zip(y).zip(z).zip(intensity_ring).zip(time_tilt);
    for (row, (((xy, z), (intensity, ring)), (time, tilt))) in
        rows.each::<DEFAULT_ROW_BYTES>().zip(columns)
    {
        let [x, y, z, intensity, tilt] =
            [*xy.0, *xy.1, *z, f64::from(*intensity), *tilt].map(|v| (v as f32).to_le_bytes());
        let [t0, t1, t2, t3, t4, t5, t6, t7] = seconds(time.as_nanos()).to_le_bytes();
        let ([x0, x1, x2, x3], [y0, y1, y2, y3]) = (x, y);
        let ([z0, z1, z2, z3], [i0, i1, i2, i3]) = (z, intensity);
        let [a0, a1, a2, a3] = tilt;
        *row = [
            x0, x1, x2, x3, y0, y1, y2, y3, z0, z1, z2, z3, i0, i1, i2, i3, *ring, t0, t1, t2, t3,
            t4, t5, t6, t7, a0, a1, a2, a3,
        ];
    }
}

/// Any columns, one after the other.
fn columns_into(rows: &mut RowBuffer, fields: Fields, batch: &Points) {
    let (row_bytes, all) = (rows.row_bytes(), 0..batch.len());
    let axes = [batch.x_m(), batch.y_m(), batch.z_m()];
    let axes = axes.map(|axis| (ColumnValues::Floats(axis), NumberType::F32));
    let columns = fields
        .columns()
        .map(|column| (batch.values(column), number_type(column)));
    let mut offset = 0;
    for (values, number) in axes.into_iter().chain(columns) {
        let values = (values, all.clone());
        fill_values(rows.bytes_mut(), row_bytes, offset, values, number, seconds);
        offset += number.bytes();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::samples;

    #[test]
    fn default_columns_in_one_pass_equal_columns_one_by_one() {
        let batch = samples::cloud(100);
        let mut layout = RowLayout::new(Fields::FILE);
        let usual = layout.encode(&batch).to_vec();
        assert_eq!(usual.len(), 100 * DEFAULT_ROW_BYTES);
        let mut rows = RowBuffer::new(DEFAULT_ROW_BYTES);
        rows.reset(100);
        columns_into(&mut rows, Fields::FILE, &batch);
        assert_eq!(usual, rows.bytes());
    }
}
