//! Rows of little-endian bytes as PLY and PCD have them: f32 positions, then the columns asked for.

use super::seconds::seconds;
use crate::rows::Rows;
use crate::{Column, Fields, Points, SinkError};

/// How a value stands in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Four bytes.
    Float,
    /// Eight bytes.
    Double,
    /// One byte, not negative.
    Byte,
}

impl Kind {
    /// Its size in bytes.
    pub(super) const fn bytes(self) -> usize {
        match self {
            Self::Float => 4,
            Self::Double => 8,
            Self::Byte => 1,
        }
    }

    const fn of(column: Column) -> Self {
        match column {
            Column::Intensity | Column::Tilt | Column::Sd => Self::Float,
            Column::Time | Column::DeviceTime => Self::Double,
            Column::Ring | Column::Laser | Column::Echo => Self::Byte,
        }
    }
}

/// Which column stands where in a row.
#[derive(Debug)]
pub(super) struct Layout {
    fields: Fields,
    rows: Rows,
}

impl Layout {
    pub(super) fn new(fields: Fields) -> Self {
        let position = 3 * Kind::Float.bytes();
        let columns: usize = fields
            .columns()
            .map(|column| Kind::of(column).bytes())
            .sum();
        Self {
            fields,
            rows: Rows::new(position + columns),
        }
    }

    pub(super) const fn fields(&self) -> Fields {
        self.fields
    }

    /// Names and kinds in their order.
    pub(super) fn properties(&self) -> impl Iterator<Item = (&'static str, Kind)> {
        let columns = self.fields.columns();
        ["x", "y", "z"]
            .map(|axis| (axis, Kind::Float))
            .into_iter()
            .chain(columns.map(|column| (column.name(), Kind::of(column))))
    }

    /// The rows of a batch.
    pub(super) fn encode(&mut self, batch: &Points) -> Result<&[u8], SinkError> {
        batch.fields().require(self.fields)?;
        let rows = &mut self.rows;
        rows.reset(batch.len());
        if self.fields == Fields::FILE {
            usual_rows(rows, batch);
            return Ok(rows.bytes());
        }
        columns_into(rows, self.fields, batch);
        Ok(rows.bytes())
    }
}

/// Bytes of a row of the usual columns: x, y, z, intensity, ring, time, tilt.
const USUAL: usize = 29;

/// The usual columns in one pass, a row at a time, as all but few files have them.
fn usual_rows(rows: &mut Rows, batch: &Points) {
    let (x, y, z) = (batch.x_m(), batch.y_m(), batch.z_m());
    let reflected = batch.intensity().iter().zip(batch.ring());
    let stood = batch.time().iter().zip(batch.tilt_deg());
    let columns = x.iter().zip(y).zip(z).zip(reflected).zip(stood);
    for (row, (((xy, z), (intensity, ring)), (time, tilt))) in rows.each::<USUAL>().zip(columns) {
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
fn columns_into(rows: &mut Rows, fields: Fields, batch: &Points) {
    let mut at = 0;
    for axis in [batch.x_m(), batch.y_m(), batch.z_m()] {
        rows.fill(at, axis.iter().map(|v| (*v as f32).to_le_bytes()));
        at += Kind::Float.bytes();
    }
    for column in fields.columns() {
        fill(rows, at, column, batch);
        at += Kind::of(column).bytes();
    }
}
/// A column of a batch into its place in every row.
fn fill(rows: &mut Rows, at: usize, column: Column, batch: &Points) {
    match column {
        Column::Intensity => {
            let values = batch.intensity().iter();
            rows.fill(at, values.map(|v| f32::from(*v).to_le_bytes()));
        }
        Column::Ring => rows.fill(at, batch.ring().iter().map(|v| [*v])),
        Column::Laser => rows.fill(at, batch.laser().iter().map(|v| [*v])),
        Column::Echo => rows.fill(at, batch.echo().iter().map(|v| [*v])),
        Column::Time => {
            let times = batch.time().iter();
            rows.fill(at, times.map(|t| seconds(t.as_nanos()).to_le_bytes()));
        }
        Column::DeviceTime => {
            let times = batch.device_time().iter();
            rows.fill(at, times.map(|t| seconds(t.as_nanos()).to_le_bytes()));
        }
        Column::Tilt => {
            let angles = batch.tilt_deg().iter();
            rows.fill(at, angles.map(|v| (*v as f32).to_le_bytes()));
        }
        Column::Sd => {
            let sds = batch.sd_m().iter();
            rows.fill(at, sds.map(|v| (*v as f32).to_le_bytes()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::testing;

    #[test]
    fn the_usual_columns_in_one_pass_are_the_columns_one_by_one() {
        let batch = testing::cloud(100);
        let mut layout = Layout::new(Fields::FILE);
        let usual = layout.encode(&batch).unwrap().to_vec();
        assert_eq!(usual.len(), 100 * USUAL);
        let mut rows = Rows::new(USUAL);
        rows.reset(100);
        columns_into(&mut rows, Fields::FILE, &batch);
        assert_eq!(usual, rows.bytes());
    }
}
