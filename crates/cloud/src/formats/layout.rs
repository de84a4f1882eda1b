//! Rows of little-endian bytes as PLY and PCD have them: f32 positions, then the columns asked for.

use super::rows::Rows;
use super::seconds::seconds;
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
            Column::Intensity | Column::Tilt => Self::Float,
            Column::Time | Column::DeviceTime => Self::Double,
            Column::Ring | Column::Laser => Self::Byte,
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
        let mut at = 0;
        for axis in [batch.x_m(), batch.y_m(), batch.z_m()] {
            rows.fill(at, axis.iter().map(|v| (*v as f32).to_le_bytes()));
            at += Kind::Float.bytes();
        }
        for column in self.fields.columns() {
            fill(rows, at, column, batch);
            at += Kind::of(column).bytes();
        }
        Ok(self.rows.bytes())
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
    }
}
