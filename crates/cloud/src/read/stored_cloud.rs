//! A cloud while it is read.

use super::source::{Positions, SourceColumns, SourceField, SourceRow};
use crate::{Column, Fields};

/// A time of the year 5138. One after it is in nanoseconds, as Livox's driver writes them: those
/// since the sensor's start pass it after 100 s.
const LATEST_S: f64 = 1e11;

/// The points of a file. A point takes 24 bytes, and 4 per column.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StoredCloud {
    /// Positions of the points.
    pub positions: Positions,
    /// The requested columns that every part of the file has, each with a value per point. Times
    /// are seconds after the first point, within 2 us in a minute; other values are those of the
    /// file. A value that is not finite is 0.
    pub columns: Vec<(Column, Vec<f32>)>,
    /// Rows left out for a coordinate that is not finite, such as shots without a return in
    /// organised clouds.
    pub without_numbers: u64,
    /// The time of the first point in its file, and its unit in seconds.
    start: Option<(f64, f64)>,
}

impl StoredCloud {
    /// No points yet.
    pub(super) fn new(wanted: Fields) -> Self {
        let columns = wanted.columns().map(|column| (column, Vec::new()));
        Self {
            columns: columns.collect(),
            ..Self::default()
        }
    }

    /// Drops the columns that the next part of the file lacks.
    pub(super) fn keep(&mut self, has: impl Fn(Column) -> bool) {
        self.columns.retain(|(column, _)| has(*column));
    }

    /// Makes room for points whose bytes are there.
    pub(super) fn reserve(&mut self, points: usize) {
        self.positions.reserve(points);
        for (_, values) in &mut self.columns {
            values.reserve(points);
        }
    }

    /// Begins a part of the file.
    pub(super) fn begin(&mut self, columns: &SourceColumns, points: usize) {
        self.keep(|column| columns.get(column).is_some());
        self.reserve(points);
    }

    /// Adds a row, or counts it if its position is not finite.
    pub(super) fn push(&mut self, position: [f64; 3], value: impl Fn(Column) -> Option<f64>) {
        if !position.iter().all(|axis| axis.is_finite()) {
            self.without_numbers += 1;
            return;
        }
        self.positions.push(position);
        for (column, values) in &mut self.columns {
            let mut value = value(*column).filter(|value| value.is_finite());
            if *column == Column::Time {
                value = value.map(|time| {
                    // The first time has the unit of all.
                    let unit_s = if time > LATEST_S { 1e-9 } else { 1.0 };
                    let (start, unit_s) = *self.start.get_or_insert((time, unit_s));
                    (time - start) * unit_s
                });
            }
            let value = value.unwrap_or(0.0) as f32;
            values.push(if value.is_finite() { value } else { 0.0 });
        }
    }

    /// Adds a row whose fields `read` reads.
    pub(super) fn row(&mut self, row: &SourceRow, read: impl Fn(SourceField) -> Option<f64>) {
        let position = row.axes.map(|field| read(field).unwrap_or(f64::NAN));
        self.push(position, |column| row.columns.value(column, &read));
    }
}
