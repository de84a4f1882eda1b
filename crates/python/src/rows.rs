//! Points as rows of a structured array.

use cloud::mount::{Mount, Tilt};
use cloud::{Fields, Points};
use units::Degrees;

use crate::binding_error::BindingError;
use crate::table::RowField;

/// A field of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PointField {
    X,
    Y,
    Z,
    Range,
    Azimuth,
    Tilt,
    Time,
    Intensity,
    Ring,
    Laser,
    Echo,
    Sd,
    DeviceTime,
}

use PointField::{
    Azimuth, DeviceTime, Echo, Intensity, Laser, Range, Ring, Sd, Tilt as TiltAngle, Time, X, Y, Z,
};

/// All fields, by name; those without `sd` and `device_time` are usual.
const ALL: [(&str, PointField); 13] = [
    ("x", X),
    ("y", Y),
    ("z", Z),
    ("range", Range),
    ("azimuth", Azimuth),
    ("tilt", TiltAngle),
    ("time", Time),
    ("intensity", Intensity),
    ("ring", Ring),
    ("laser", Laser),
    ("echo", Echo),
    ("sd", Sd),
    ("device_time", DeviceTime),
];
/// Number of the usual fields.
const USUAL: usize = 11;

/// Fields of rows and their places.
#[derive(Clone, Debug)]
pub(crate) struct PointLayout {
    places: Vec<(PointField, usize)>,
    /// Fields for numpy, in the order requested.
    pub fields: Vec<RowField>,
    pub row_bytes: usize,
}

impl PointLayout {
    /// The layout of these fields, of the usual ones without names: in this order, each field at a
    /// multiple of its size. numpy cannot save fields in another order than that of their bytes.
    pub fn new(names: Option<&[String]>) -> Result<Self, BindingError> {
        let usual = || ALL.iter().take(USUAL).map(|(name, _)| (*name).to_owned());
        let names: Vec<String> = names.map_or_else(|| usual().collect(), <[String]>::to_vec);
        let mut fields = Vec::with_capacity(names.len());
        for name in &names {
            let Some((known, field)) = ALL.iter().find(|(known, _)| known == name) else {
                let known: Vec<&str> = ALL.iter().map(|(name, _)| *name).collect();
                let known = known.join(", ");
                return Err(BindingError::usage(format!(
                    "fields: expected some of {known}; got {name:?}"
                )));
            };
            if fields.iter().any(|(other, _)| other == known) {
                return Err(BindingError::usage(format!("fields: {name:?} twice")));
            }
            fields.push((*known, *field));
        }
        if fields.is_empty() {
            return Err(BindingError::usage(
                "fields: expected one or more, got none",
            ));
        }
        let mut end = 0_usize;
        let mut largest = 1;
        let mut places = Vec::with_capacity(fields.len());
        for (_, field) in &fields {
            let (_, bytes) = field.format();
            let offset = end.next_multiple_of(bytes);
            places.push((*field, offset));
            end = offset + bytes;
            largest = largest.max(bytes);
        }
        Ok(Self {
            fields: (fields.iter().zip(&places))
                .map(|((name, field), (_, offset))| (*name, field.format().0, *offset))
                .collect(),
            row_bytes: end.next_multiple_of(largest),
            places,
        })
    }

    /// Columns of points that the rows need.
    pub fn columns(&self) -> Fields {
        let columns = self.places.iter().map(|(field, _)| field.columns());
        columns.fold(Fields::NONE, |all, these| all | these)
    }

    /// Whether a row has the expected error.
    pub fn has_sd(&self) -> bool {
        self.columns().contains(Fields::SD)
    }

    fn needs_lidar_frame(&self) -> bool {
        let is_polar = |(field, _): &(PointField, usize)| matches!(field, Range | Azimuth);
        self.places.iter().any(is_polar)
    }
}

impl PointField {
    /// Format of numpy, and bytes.
    const fn format(self) -> (&'static str, usize) {
        match self {
            Time | DeviceTime => ("f8", 8),
            X | Y | Z | Range | Azimuth | TiltAngle | Sd => ("f4", 4),
            Intensity | Ring | Laser | Echo => ("u1", 1),
        }
    }

    const fn columns(self) -> Fields {
        match self {
            X | Y | Z => Fields::NONE,
            // Back into the lidar's frame.
            Range | Azimuth | TiltAngle => Fields::TILT,
            Time => Fields::TIME,
            Intensity => Fields::INTENSITY,
            Ring => Fields::RING,
            Laser => Fields::LASER,
            Echo => Fields::ECHO,
            Sd => Fields::SD,
            DeviceTime => Fields::DEVICE_TIME,
        }
    }
}

/// Writes points as rows.
#[derive(Debug)]
pub(crate) struct PointRows {
    layout: PointLayout,
    /// Mount of a tilted lidar.
    mount: Option<Mount>,
    pub bytes: Vec<u8>,
    /// Range and azimuth of each point of a batch.
    polar: Vec<[f32; 2]>,
}

impl PointRows {
    pub const fn new(layout: PointLayout) -> Self {
        Self {
            layout,
            mount: None,
            bytes: Vec::new(),
            polar: Vec::new(),
        }
    }

    pub const fn layout(&self) -> &PointLayout {
        &self.layout
    }

    /// Sets the mount of a tilted lidar.
    pub const fn set_mount(&mut self, mount: Option<Mount>) {
        self.mount = mount;
    }

    /// Adds points.
    pub fn add(&mut self, points: &Points) {
        if self.layout.needs_lidar_frame() {
            self.find_polar(points);
        }
        let row_bytes = self.layout.row_bytes;
        let begin = self.bytes.len();
        self.bytes.resize(begin + points.len() * row_bytes, 0);
        let Some(rows) = self.bytes.get_mut(begin..) else {
            return;
        };
        for &(field, offset) in &self.layout.places {
            let mut floats = |values: &mut dyn Iterator<Item = f32>| {
                put(rows, row_bytes, offset, values.map(f32::to_ne_bytes));
            };
            match field {
                X => put_floats(rows, row_bytes, offset, points.x_m()),
                Y => put_floats(rows, row_bytes, offset, points.y_m()),
                Z => put_floats(rows, row_bytes, offset, points.z_m()),
                TiltAngle => put_floats(rows, row_bytes, offset, points.tilt_deg()),
                Sd => put_floats(rows, row_bytes, offset, points.sd_m()),
                Range => floats(&mut self.polar.iter().map(|[range, _]| *range)),
                Azimuth => floats(&mut self.polar.iter().map(|[_, azimuth]| *azimuth)),
                Intensity => put_bytes(rows, row_bytes, offset, points.intensity()),
                Ring => put_bytes(rows, row_bytes, offset, points.ring()),
                Laser => put_bytes(rows, row_bytes, offset, points.laser()),
                Echo => put_bytes(rows, row_bytes, offset, points.echo()),
                Time => {
                    let times = points.time().iter().map(|time| time.as_secs_f64());
                    put(rows, row_bytes, offset, times.map(f64::to_ne_bytes));
                }
                DeviceTime => {
                    let times = points.device_time().iter().map(|time| time.as_secs_f64());
                    put(rows, row_bytes, offset, times.map(f64::to_ne_bytes));
                }
            }
        }
    }

    /// Finds range and azimuth of all points in the lidar's frame.
    fn find_polar(&mut self, points: &Points) {
        self.polar.clear();
        let positions = points.positions();
        match self.mount {
            None => self.polar.extend(positions.map(polar)),
            Some(mount) => {
                let tilted = positions.zip(points.tilt_deg());
                let in_lidar_frame = tilted.map(|(position_m, tilt)| {
                    mount.in_lidar_frame(position_m, Tilt::new(Degrees(*tilt)))
                });
                self.polar.extend(in_lidar_frame.map(polar));
            }
        }
    }
}

/// Distance and azimuth of a point in the lidar's frame: metres; degrees clockwise from y, 0 to
/// 360.
fn polar([x, y, z]: [f64; 3]) -> [f32; 2] {
    let range_m = (x * x + y * y + z * z).sqrt();
    let azimuth_deg = (x as f32).atan2(y as f32).to_degrees();
    let azimuth_deg = match azimuth_deg < 0.0 {
        true => azimuth_deg + 360.0,
        false => azimuth_deg,
    };
    // A small negative angle rounds to a whole revolution.
    let azimuth_deg = if azimuth_deg < 360.0 {
        azimuth_deg
    } else {
        0.0
    };
    [range_m as f32, azimuth_deg]
}

/// Writes a column at byte `offset` of every row.
#[inline(always)]
fn put<const N: usize>(
    rows: &mut [u8],
    row_bytes: usize,
    offset: usize,
    values: impl Iterator<Item = [u8; N]>,
) {
    for (row, value) in rows.chunks_exact_mut(row_bytes).zip(values) {
        if let Some(cell) = row.get_mut(offset..offset + N) {
            cell.copy_from_slice(&value);
        }
    }
}

fn put_floats(rows: &mut [u8], row_bytes: usize, offset: usize, values: &[f64]) {
    let values = values.iter().map(|value| (*value as f32).to_ne_bytes());
    put(rows, row_bytes, offset, values);
}

fn put_bytes(rows: &mut [u8], row_bytes: usize, offset: usize, values: &[u8]) {
    put(rows, row_bytes, offset, values.iter().map(|value| [*value]));
}
