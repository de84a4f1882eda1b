//! E57, by the `e57` crate: every cloud of the file, at its pose.
//!
//! Points are placed here: the library's own reader of positions has no times and no attributes of
//! extensions, and fails at packets without a whole point.

use std::io::Cursor;

use e57::{E57Reader, Error, RecordDataType, RecordName, Transform};

use super::source::{ReadError, SourceColumns, SourceField, SourceNumber};
use super::stored_cloud::StoredCloud;
use crate::Column;
use crate::formats::Format;

pub(super) fn read(bytes: &[u8], cloud: &mut StoredCloud) -> Result<(), ReadError> {
    let wrong = |error: Error| ReadError {
        format: Format::E57,
        offset: 0,
        expected: "an E57 file".to_owned(),
        got: error.to_string(),
    };
    let mut reader = E57Reader::new(Cursor::new(bytes)).map_err(wrong)?;
    let mut first_s = None;
    for scan in reader.pointclouds() {
        let records = &scan.prototype;
        let place = |name| records.iter().position(|record| record.name == name);
        let cartesian = [
            RecordName::CartesianX,
            RecordName::CartesianY,
            RecordName::CartesianZ,
            RecordName::CartesianInvalidState,
        ]
        .map(place);
        let spherical = [
            RecordName::SphericalRange,
            RecordName::SphericalAzimuth,
            RecordName::SphericalElevation,
            RecordName::SphericalInvalidState,
        ]
        .map(place);
        let columns = columns(records);
        cloud.begin(&columns, 0);
        let pose = scan.transform.clone().unwrap_or_default();
        // Times count from the beginning of their scan.
        let start_s = scan
            .acquisition_start
            .as_ref()
            .map_or(0.0, |at| at.gps_time);
        let start_s = start_s - *first_s.get_or_insert(start_s);
        for row in reader.pointcloud_raw(&scan).map_err(wrong)? {
            let row = row.map_err(wrong)?;
            let value = |at: usize| row.get(at)?.to_f64(&records.get(at)?.data_type).ok();
            // Other states are directions of shots without a return.
            let valid = |[a, b, c, state]: [Option<usize>; 4]| {
                let is_valid = state.is_none_or(|state| value(state) == Some(0.0));
                is_valid.then_some([value(a?)?, value(b?)?, value(c?)?])
            };
            let position = valid(cartesian).or_else(|| {
                let [range, azimuth, elevation] = valid(spherical)?;
                let level = range * elevation.cos();
                let up = range * elevation.sin();
                Some([level * azimuth.cos(), level * azimuth.sin(), up])
            });
            let position = position.map_or([f64::NAN; 3], |local| placed(local, &pose));
            cloud.push(position, |column| {
                let value = columns.value(column, |field| value(field.word))?;
                Some(match column {
                    Column::Time => start_s + value,
                    _ => value,
                })
            });
        }
    }
    Ok(())
}

/// A point of a scan in the frame of the file. The quaternion need not be of length one.
fn placed(local: [f64; 3], pose: &Transform) -> [f64; 3] {
    let cross =
        |[a, b, c]: [f64; 3], [x, y, z]: [f64; 3]| [b * z - c * y, c * x - a * z, a * y - b * x];
    let (turn, shift) = (&pose.rotation, &pose.translation);
    let axis = [turn.x, turn.y, turn.z];
    let length_2 = turn.w * turn.w + turn.x * turn.x + turn.y * turn.y + turn.z * turn.z;
    let around = cross(axis, local).map(|value| 2.0 / length_2 * value);
    let [x, y, z] = local;
    let [turned_x, turned_y, turned_z] = around.map(|value| turn.w * value);
    let [more_x, more_y, more_z] = cross(axis, around);
    [
        x + turned_x + more_x + shift.x,
        y + turned_y + more_y + shift.y,
        z + turned_z + more_z + shift.z,
    ]
}

/// The columns of a point; the word of a field is the number of its attribute.
fn columns(records: &[e57::Record]) -> SourceColumns {
    let mut columns = SourceColumns::default();
    for (word, record) in records.iter().enumerate() {
        let name = match (&record.name, &record.data_type) {
            (RecordName::Intensity, _) => "intensity",
            // Rows of a grid are more than the rings of a lidar.
            (RecordName::RowIndex, RecordDataType::Integer { max: ..=255, .. }) => "ring",
            (RecordName::TimeStamp, _) => "time",
            (RecordName::Unknown { name, .. }, _) => name,
            _ => continue,
        };
        let (byte, number) = (0, SourceNumber::F64);
        columns.insert(name, SourceField { word, byte, number });
    }
    columns
}
