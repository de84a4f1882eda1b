//! Columns as attributes of E57 points: standard ones, and an extension for the rest.

use e57::{RawValues, Record, RecordDataType, RecordName, RecordValue};
use units::{Host, Stamp};

use crate::{Column, Fields, Point};

/// The extension's prefix in attribute names.
pub(super) const NAMESPACE: &str = "velomotion";
/// URL of the extension; a name only.
pub(super) const URL: &str = "https://velomotion.invalid/e57/1";

const SINGLE: RecordDataType = RecordDataType::Single {
    min: None,
    max: None,
};
const DOUBLE: RecordDataType = RecordDataType::Double {
    min: None,
    max: None,
};
const BYTE: RecordDataType = RecordDataType::Integer { min: 0, max: 255 };
/// Every point is valid. Readers such as pye57 ask for this state.
const VALID: RecordDataType = RecordDataType::Integer { min: 0, max: 2 };

/// The attributes of a point.
pub(super) struct PointAttributes {
    columns: Vec<Column>,
}

impl PointAttributes {
    /// The attributes of positions and `fields`.
    pub(super) fn new(fields: Fields) -> Self {
        Self {
            columns: fields.columns().collect(),
        }
    }

    /// Whether the extension is needed.
    pub(super) fn are_extended(&self) -> bool {
        let names = self.columns.iter().map(|column| name(*column));
        names
            .into_iter()
            .any(|name| matches!(name, RecordName::Unknown { .. }))
    }

    /// Declarations of the attributes.
    pub(super) fn prototype(&self) -> Vec<Record> {
        let axes = [
            RecordName::CartesianX,
            RecordName::CartesianY,
            RecordName::CartesianZ,
        ];
        let axes = axes.map(|name| Record {
            name,
            data_type: SINGLE,
        });
        let columns = self.columns.iter().map(|column| Record {
            name: name(*column),
            data_type: data_type(*column),
        });
        let state = Record {
            name: RecordName::CartesianInvalidState,
            data_type: VALID,
        };
        axes.into_iter().chain([state]).chain(columns).collect()
    }

    /// Values of the attributes.
    pub(super) fn values(&self, point: &Point, start: Stamp<Host>) -> RawValues {
        let mut values = RawValues::with_capacity(4 + self.columns.len());
        values.extend(point.position_m.map(|v| RecordValue::Single(v as f32)));
        values.push(RecordValue::Integer(0));
        values.extend(self.columns.iter().map(|column| match column {
            Column::Intensity => RecordValue::Integer(point.intensity.into()),
            Column::Ring => RecordValue::Integer(point.ring.into()),
            Column::Laser => RecordValue::Integer(point.laser.into()),
            Column::Echo => RecordValue::Integer(point.echo.into()),
            Column::Time => RecordValue::Double((point.time.saturating_since(start)).as_secs_f64()),
            Column::DeviceTime => RecordValue::Double(point.device_time.as_secs_f64()),
            Column::Tilt => RecordValue::Single(point.tilt.0 as f32),
            Column::Sd => RecordValue::Single(point.sd_m as f32),
        }));
        values
    }
}

fn name(column: Column) -> RecordName {
    match column {
        Column::Intensity => RecordName::Intensity,
        Column::Ring => RecordName::RowIndex,
        Column::Time => RecordName::TimeStamp,
        Column::Laser | Column::Echo | Column::DeviceTime | Column::Tilt | Column::Sd => {
            RecordName::Unknown {
                namespace: NAMESPACE.to_owned(),
                name: column.name().to_owned(),
            }
        }
    }
}

const fn data_type(column: Column) -> RecordDataType {
    match column {
        Column::Intensity | Column::Ring | Column::Laser | Column::Echo => BYTE,
        Column::Time | Column::DeviceTime => DOUBLE,
        Column::Tilt | Column::Sd => SINGLE,
    }
}
