//! `sensor_msgs/PointCloud2`, encoded batch by batch, so that a cloud is held once.
//!
//! The fields of ROS 2's Velodyne driver in its order: x, y, z, intensity (float32), ring (uint16),
//! time (float32, seconds after the header's stamp), 22 bytes per point without padding; then
//! further columns. Clouds are unorganised, in ROS's axes (REP 103): x forward, y left, z up, or
//! east, north, up.

use std::ops::Range;

use units::{Host, Lidar, Stamp};

use super::cdr::Cdr;
use super::{Time, TimeOutOfRange, frames, header};
use crate::points::ColumnValues;
use crate::rows::{NumberType, fill, fill_values, part};
use crate::{Column, Fields, MissingColumns, Points};

/// The columns of a cloud message: always intensity, ring and time, never the tilt, which the joint
/// carries.
#[must_use]
pub fn fields_of(wanted: Fields) -> Fields {
    (wanted | Fields::INTENSITY | Fields::RING | Fields::TIME) - Fields::TILT
}

/// Number type of a column.
const fn number_type(column: Column) -> NumberType {
    match column {
        Column::Intensity | Column::Time | Column::Tilt | Column::Sd => NumberType::F32,
        Column::Ring => NumberType::U16,
        Column::Laser | Column::Echo => NumberType::U8,
        Column::DeviceTime => NumberType::F64,
    }
}

/// `datatype` of a `sensor_msgs/PointField`.
const fn datatype(number: NumberType) -> u8 {
    match number {
        NumberType::U8 => 2,
        NumberType::U16 => 4,
        NumberType::F32 => 7,
        NumberType::F64 => 8,
    }
}

/// A cloud message under construction.
#[derive(Clone, Debug)]
pub struct CloudMessage {
    columns: Fields,
    point_bytes: usize,
    cdr: Cdr,
    places: LengthPlaceholders,
    first: Stamp<Host>,
    last: Stamp<Host>,
    points: u32,
}

/// Offsets of the numbers that are known at the end.
#[derive(Clone, Copy, Debug, Default)]
struct LengthPlaceholders {
    width: usize,
    row_bytes: usize,
    length: usize,
}

/// Reason why points do not fit a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CloudMessageError {
    /// A column is missing.
    #[error(transparent)]
    Columns(#[from] MissingColumns),
    /// A time outside the range of ROS.
    #[error(transparent)]
    Time(#[from] TimeOutOfRange),
}

impl CloudMessage {
    /// An empty cloud with the columns [`fields_of`] `wanted`.
    #[must_use]
    pub fn new(wanted: Fields) -> Self {
        let columns = fields_of(wanted);
        let bytes: usize = columns
            .columns()
            .map(|column| number_type(column).bytes())
            .sum();
        Self {
            columns,
            point_bytes: 3 * 4 + bytes,
            cdr: Cdr::new(),
            places: LengthPlaceholders::default(),
            first: Stamp::from_nanos(0),
            last: Stamp::from_nanos(0),
            points: 0,
        }
    }

    /// Columns other than the position.
    #[must_use]
    pub const fn fields(&self) -> Fields {
        self.columns
    }

    /// Number of points so far.
    #[must_use]
    pub const fn points(&self) -> u32 {
        self.points
    }

    /// The header's stamp, which is the time of the earliest point, and the time of the last.
    #[must_use]
    pub const fn times(&self) -> (Stamp<Host>, Stamp<Host>) {
        (self.first, self.last)
    }

    /// Adds `rows` of a batch, turned to ROS's axes unless `frame` is [`frames::MAP`], whose axes
    /// points then have. The first batch sets the header's stamp and `frame`.
    ///
    /// # Errors
    /// [`CloudMessageError`]; nothing is added then.
    pub fn push(
        &mut self,
        batch: &Points,
        rows: Range<usize>,
        frame: &str,
    ) -> Result<(), CloudMessageError> {
        batch.fields().require(self.columns)?;
        let Some(times) = batch.time().get(rows.clone()).filter(|t| !t.is_empty()) else {
            return Ok(());
        };
        let earliest = times
            .iter()
            .copied()
            .fold(Stamp::from_nanos(i64::MAX), Stamp::min);
        let latest = times
            .iter()
            .copied()
            .fold(Stamp::from_nanos(i64::MIN), Stamp::max);
        if self.points == 0 {
            self.begin(earliest, frame)?;
        }
        self.last = if self.points == 0 {
            latest
        } else {
            self.last.max(latest)
        };
        let (point_bytes, count) = (self.point_bytes, rows.len());
        let space = self.cdr.room(count * point_bytes);
        let is_turned = frame != frames::MAP;
        let columns = (point_bytes, self.columns);
        encode(space, columns, batch, &rows, self.first, is_turned);
        self.points = self
            .points
            .saturating_add(u32::try_from(count).unwrap_or(u32::MAX));
        Ok(())
    }

    /// Completes the message and returns its bytes, encapsulation header included. The next points
    /// begin a new message.
    pub fn finish(&mut self) -> &[u8] {
        let points = std::mem::take(&mut self.points);
        let bytes = u32::try_from(self.point_bytes)
            .unwrap_or(u32::MAX)
            .saturating_mul(points);
        let places = self.places;
        self.cdr.set_u32(places.width, points);
        self.cdr.set_u32(places.row_bytes, bytes);
        self.cdr.set_u32(places.length, bytes);
        // is_dense: every point has a place.
        self.cdr.u8(1);
        self.cdr.bytes()
    }

    /// Writes everything before the points.
    fn begin(&mut self, first: Stamp<Host>, frame: &str) -> Result<(), TimeOutOfRange> {
        let stamp = Time::of(first)?;
        self.first = first;
        let cdr = &mut self.cdr;
        cdr.clear();
        header(cdr, stamp, frame);
        cdr.u32(1);
        self.places.width = cdr.placeholder();
        let columns = self.columns.columns();
        cdr.length(3 + columns.count());
        let mut offset = 0;
        let mut field = |name: &str, number: NumberType| {
            cdr.string(name);
            cdr.u32(offset);
            cdr.u8(datatype(number));
            cdr.u32(1);
            offset += number.bytes() as u32;
        };
        for axis in ["x", "y", "z"] {
            field(axis, NumberType::F32);
        }
        for column in self.columns.columns() {
            field(column.name(), number_type(column));
        }
        cdr.u8(0); // is_bigendian
        cdr.u32(offset);
        self.places.row_bytes = cdr.placeholder();
        self.places.length = cdr.placeholder();
        Ok(())
    }
}

/// Turns x right, y forward to ROS's x forward, y left. It is exact.
pub(crate) const fn to_ros([right, forward, up]: [f64; 3]) -> [f64; 3] {
    [forward, -right, up]
}

/// Turns ROS's x forward, y left to x right, y forward.
pub(crate) const fn from_ros([forward, left, up]: [f64; 3]) -> [f64; 3] {
    [-left, forward, up]
}

/// Writes rows of a batch; `time` counts from `first`. Positions are turned to ROS's axes if
/// `is_turned`.
fn encode(
    space: &mut [u8],
    (point_bytes, columns): (usize, Fields),
    batch: &Points,
    rows: &Range<usize>,
    first: Stamp<Host>,
    is_turned: bool,
) {
    let since_first = |ns: i64| Stamp::from_nanos(ns).saturating_since(first).as_secs_f64();
    let of_lidar = |ns: i64| Stamp::<Lidar>::from_nanos(ns).as_secs_f64();
    let [x, y, z] =
        [batch.x_m(), batch.y_m(), batch.z_m()].map(|column| part(column, rows.clone()));
    let positions = x.iter().zip(y).zip(z).map(|((x, y), z)| {
        let position_m = [*x, *y, *z];
        let position_m = if is_turned {
            to_ros(position_m)
        } else {
            position_m
        };
        let mut bytes = [0; 12];
        for (slot, axis) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(position_m) {
            *slot = (axis as f32).to_le_bytes();
        }
        bytes
    });
    fill(space, point_bytes, 0, positions);
    let mut offset = 12;
    for column in columns.columns() {
        let (values, number) = (batch.values(column), number_type(column));
        let part = (values, rows.clone());
        match values {
            ColumnValues::LidarTimes(_) => {
                fill_values(space, point_bytes, offset, part, number, of_lidar)
            }
            _ => fill_values(space, point_bytes, offset, part, number, since_first),
        }
        offset += number.bytes();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::cdr_reader::Reader;
    use crate::tests::samples;

    const START_NS: i64 = samples::NOW_NS;

    /// Name, offset and data type.
    type Field = (String, u32, u8);

    /// Fields by name with offset and data type, the bytes of the points, and the bytes per point.
    fn read(message: &[u8]) -> (Vec<Field>, &[u8], usize) {
        let mut reader = Reader::new(message);
        let (sec, nanosec, frame) = reader.header();
        assert_eq!(
            (
                i64::from(sec) * 1_000_000_000 + i64::from(nanosec),
                frame.as_str()
            ),
            (START_NS, "lidar")
        );
        let (height, width, fields) = (reader.u32(), reader.u32(), reader.u32());
        let fields: Vec<_> = (0..fields)
            .map(|_| {
                let field = (reader.string(), reader.u32(), reader.u8());
                assert_eq!(reader.u32(), 1);
                field
            })
            .collect();
        assert_eq!(reader.u8(), 0);
        let (point_step, row_step) = (reader.u32(), reader.u32());
        let length = reader.u32();
        assert_eq!(
            (height, row_step, length),
            (1, width * point_step, row_step)
        );
        let data = reader.take(length as usize);
        assert_eq!(reader.u8(), 1);
        assert!(reader.is_done());
        (fields, data, point_step as usize)
    }

    #[test]
    fn default_fields_match_the_velodyne_driver() {
        let cloud = samples::cloud_from(100, START_NS);
        let mut message = CloudMessage::new(Fields::FILE);
        // In three batches, the middle one empty.
        for rows in [0..60, 60..60, 60..100] {
            message.push(&cloud, rows, "lidar").unwrap();
        }
        assert_eq!(message.points(), 100);
        let (fields, data, step) = read(message.finish());
        let names: Vec<_> = fields
            .iter()
            .map(|(n, o, d)| (n.as_str(), *o, *d))
            .collect();
        assert_eq!(
            names,
            [
                ("x", 0, 7),
                ("y", 4, 7),
                ("z", 8, 7),
                ("intensity", 12, 7),
                ("ring", 16, 4),
                ("time", 18, 7)
            ]
        );
        assert_eq!((step, data.len()), (22, 2200));
        for (row, point) in data.chunks(22).zip(cloud.iter()) {
            let float = |at: usize| f32::from_le_bytes(row[at..at + 4].try_into().unwrap());
            let [right, forward, up] = point.position_m;
            for (axis, metres) in [forward, -right, up].into_iter().enumerate() {
                assert_eq!(float(4 * axis), metres as f32);
            }
            assert_eq!(from_ros(to_ros(point.position_m)), point.position_m);
            assert_eq!(float(12), f32::from(point.intensity));
            assert_eq!(row[16..18], [point.ring, 0]);
            let since = (point.time.as_nanos() - START_NS) as f64 * 1e-9;
            assert!((f64::from(float(18)) - since).abs() < 1e-9);
        }
    }

    #[test]
    fn every_column_has_a_field() {
        let cloud = samples::cloud_from(3, START_NS);
        let mut message = CloudMessage::new(Fields::ALL);
        message.push(&cloud, 0..3, "lidar").unwrap();
        let (fields, data, step) = read(message.finish());
        assert_eq!(step, 22 + 1 + 8 + 4 + 1);
        assert!(!fields.iter().any(|(name, ..)| name == "tilt"));
        for (row, point) in data.chunks(step).zip(cloud.iter()) {
            let of = |name: &str| fields.iter().find(|f| f.0 == name).unwrap().1 as usize;
            assert_eq!(row[of("laser")], point.laser);
            assert_eq!(row[of("echo")], point.echo);
            let sd = f32::from_le_bytes(row[of("sd")..][..4].try_into().unwrap());
            assert_eq!(sd, point.sd_m as f32);
            let device = f64::from_le_bytes(row[of("device_time")..][..8].try_into().unwrap());
            assert_eq!(device, point.device_time.as_secs_f64());
        }
    }

    #[test]
    fn a_message_can_be_reused() {
        let cloud = samples::cloud_from(10, START_NS);
        let mut message = CloudMessage::new(Fields::FILE);
        for rows in [0..4, 4..10] {
            message.push(&cloud, rows, "lidar").unwrap();
        }
        let grown = message.finish().to_vec();
        assert_eq!(message.points(), 0);
        message.push(&cloud, 0..10, "lidar").unwrap();
        let (first, last) = message.times();
        assert_eq!((first.as_nanos(), last), (START_NS, cloud.time()[9]));
        assert_eq!(message.finish(), grown);
    }

    #[test]
    fn times_out_of_range_are_errors() {
        let mut message = CloudMessage::new(Fields::FILE);
        let late = samples::cloud(1);
        let error = message.push(&late, 0..1, "lidar").unwrap_err();
        assert!(error.to_string().contains("2038"), "{error}");
        let error = message
            .push(&Points::new(Fields::RING), 0..0, "lidar")
            .unwrap_err();
        assert!(matches!(error, CloudMessageError::Columns(_)));
        assert_eq!(message.points(), 0);
    }
}
