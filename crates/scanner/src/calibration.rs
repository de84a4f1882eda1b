//! A calibration of axis and lasers, carried in the log as TOML, and its use at each point.
//!
//! The tilt of a firing is g' = (1 + k) g + rate dt + A sin n g + B cos n g + sign(rate) play / 2,
//! with g the trajectory's angle and n the turns of the motor per turn of the axis. The covariance
//! adds to the expected error of each point.

use cloud::mount::{Mount, Tilt};
use lidar::{Corrections, LaserCorrection, SensorPoint};
use serde::{Deserialize, Serialize};
use units::{Degrees, Gearing};
use utoipa::ToSchema;

/// Results of a calibration except the mount.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default)]
pub struct DeviceCalibration {
    /// Model of the calibrated lidar, such as `VLP-16`; with lasers only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Correction of the tilt angle.
    #[serde(skip_serializing_if = "AxisCorrection::is_none")]
    pub axis_correction: AxisCorrection,
    /// Corrections of the lasers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub laser: Vec<LaserCalibration>,
    /// Errors of the parameters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub covariance: Option<ParameterCovariance>,
}

/// Correction of the tilt angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
pub struct AxisCorrection {
    /// Time by which the platform is ahead of its angle samples, microseconds.
    pub delay_us: f64,
    /// Relative error of the angle (k).
    pub scale: f64,
    /// Ripple with the period of a motor turn: factors of sine and cosine, degrees.
    pub ripple_deg: [f64; 2],
    /// Angle between moving forward and moving back, degrees.
    pub play_deg: f64,
}

/// Correction of a laser, as calibration files have it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LaserCalibration {
    /// Index in firing order.
    pub id: u8,
    /// Elevation, degrees.
    pub elevation_deg: f64,
    /// Added to the azimuth of the firing, degrees.
    pub azimuth_offset_deg: f64,
    /// Added to every range, metres.
    pub range_offset_m: f64,
}

/// Errors of parameters: standard deviations and correlations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ParameterCovariance {
    /// Names of the parameters, with units.
    pub names: Vec<String>,
    /// Their standard deviations.
    pub sd: Vec<f64>,
    /// Their correlations: the lower triangle by rows, without the diagonal.
    pub correlation: Vec<Vec<f64>>,
}

/// Numbers in a calibration that no device has.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidCalibration {
    /// A number outside its range.
    #[error("{key}: expected a number from -{most} to {most}, got {number}")]
    OutOfRange {
        /// Key in the file.
        key: &'static str,
        /// Largest magnitude.
        most: f64,
        /// The number found.
        number: f64,
    },
    /// A covariance whose parts differ in size.
    #[error("covariance: expected {count} standard deviations and the triangle below them")]
    CovarianceShape {
        /// Number of its parameters.
        count: usize,
    },
    /// A standard deviation or correlation outside its range.
    #[error("covariance: expected standard deviations from 0 and correlations from -1 to 1")]
    CovarianceValues,
}

impl AxisCorrection {
    /// Whether it corrects nothing.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl DeviceCalibration {
    /// Whether it says nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Refuses numbers that no device has.
    ///
    /// # Errors
    /// `InvalidCalibration`: the first invalid value.
    pub fn check(&self) -> Result<(), InvalidCalibration> {
        let axis = &self.axis_correction;
        let [ripple_sin, ripple_cos] = axis.ripple_deg;
        let mut numbers = vec![
            ("axis_correction.delay_us", axis.delay_us, 1e5),
            ("axis_correction.scale", axis.scale, 0.1),
            ("axis_correction.ripple_deg", ripple_sin, 1.0),
            ("axis_correction.ripple_deg", ripple_cos, 1.0),
            ("axis_correction.play_deg", axis.play_deg, 5.0),
        ];
        for laser in &self.laser {
            numbers.push(("laser.elevation_deg", laser.elevation_deg, 90.0));
            numbers.push(("laser.azimuth_offset_deg", laser.azimuth_offset_deg, 90.0));
            numbers.push(("laser.range_offset_m", laser.range_offset_m, 1.0));
        }
        for (key, number, most) in numbers {
            if !(-most..=most).contains(&number) {
                return Err(InvalidCalibration::OutOfRange { key, most, number });
            }
        }
        self.covariance
            .as_ref()
            .map_or(Ok(()), ParameterCovariance::check)
    }

    /// The corrections of the lasers for a decoder, in place of those of `table`; `None` if there
    /// are none, or for another model.
    #[must_use]
    pub fn corrections(&self, model: &str, table: Corrections) -> Option<Corrections> {
        if self.laser.is_empty() || self.model.as_deref() != Some(model) {
            return None;
        }
        let mut corrections = table;
        for laser in &self.laser {
            let of_model = corrections.lasers.get_mut(usize::from(laser.id))?;
            *of_model = LaserCorrection {
                elevation_deg: laser.elevation_deg,
                azimuth_offset_deg: laser.azimuth_offset_deg,
                range_offset_m: laser.range_offset_m,
                ..*of_model
            };
        }
        Some(corrections)
    }
}

impl ParameterCovariance {
    fn check(&self) -> Result<(), InvalidCalibration> {
        let count = self.names.len();
        let rows = &self.correlation;
        let is_triangle = self.correlation.len() == count
            && rows
                .iter()
                .enumerate()
                .all(|(row, numbers)| numbers.len() == row);
        if self.sd.len() != count || !is_triangle {
            return Err(InvalidCalibration::CovarianceShape { count });
        }
        let are_valid = self.sd.iter().all(|sd| (0.0..1e6).contains(sd))
            && rows.iter().flatten().all(|r| (-1.0..=1.0).contains(r));
        match are_valid {
            true => Ok(()),
            false => Err(InvalidCalibration::CovarianceValues),
        }
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }

    fn covariance(&self, a: usize, b: usize) -> f64 {
        let (low, high) = (a.min(b), a.max(b));
        let r = match low == high {
            true => 1.0,
            false => self
                .correlation
                .get(high)
                .and_then(|row| row.get(low))
                .copied()
                .unwrap_or(0.0),
        };
        let sd = |index: usize| self.sd.get(index).copied().unwrap_or(0.0);
        r * sd(a) * sd(b)
    }
}

/// Derivatives of a point: four of the mount, five of the axis, three of its laser.
const COLUMNS: usize = 12;
/// Names of the parameters of mount and axis, in the order of the derivatives, with SI units per
/// unit.
const DEVICE: [(&str, f64); 9] = [
    ("mount_rotation_x_deg", DEG),
    ("mount_rotation_z_deg", DEG),
    ("mount_position_x_m", 1.0),
    ("mount_position_z_m", 1.0),
    ("delay_us", 1e-6),
    ("scale", 1.0),
    ("ripple_sin_deg", DEG),
    ("ripple_cos_deg", DEG),
    ("play_deg", DEG),
];
const DEG: f64 = std::f64::consts::PI / 180.0;
/// Lasers of the largest model.
const LASERS: usize = 32;

/// A calibration at work.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PointCalibration {
    axis: AxisCorrection,
    /// Turns of the motor per turn of the axis.
    motor_turns: f64,
    /// Covariance of the parameters behind each laser's points, SI; empty without one.
    lasers: Vec<[[f64; COLUMNS]; COLUMNS]>,
}

impl PointCalibration {
    pub fn new(calibration: &DeviceCalibration, gearing: Gearing) -> Self {
        let [motor, axis] = gearing.turns();
        Self {
            axis: calibration.axis_correction,
            motor_turns: f64::from(motor) / f64::from(axis),
            lasers: calibration
                .covariance
                .as_ref()
                .map_or_else(Vec::new, by_laser),
        }
    }

    /// The tilt of the platform where the trajectory has `tilt`.
    pub fn tilt(&self, tilt: Degrees, rate_deg_s: f64) -> Degrees {
        let (axis, slopes) = (&self.axis, self.tilt_slopes(tilt, rate_deg_s));
        let [delay, scale, sin, cos, play] = slopes.map(|slope| slope / DEG);
        let [ripple_sin, ripple_cos] = axis.ripple_deg;
        Degrees(
            tilt.0
                + delay * axis.delay_us * 1e-6
                + scale * axis.scale
                + (sin * ripple_sin + cos * ripple_cos + play * axis.play_deg) * DEG,
        )
    }

    /// Derivatives of the tilt (radians) by the parameters of the axis (SI).
    fn tilt_slopes(&self, tilt: Degrees, rate_deg_s: f64) -> [f64; 5] {
        let angle = tilt.to_radians().0;
        let (sin, cos) = (self.motor_turns * angle).sin_cos();
        let side = if rate_deg_s == 0.0 {
            0.0
        } else {
            0.5 * rate_deg_s.signum()
        };
        [rate_deg_s * DEG, angle, sin, cos, side]
    }

    /// Variance of a placed point by the errors of the parameters, summed over its axes, square
    /// metres. `tilt` is that of the trajectory.
    pub fn variance_m2(
        &self,
        mount: &Mount,
        point: &SensorPoint,
        tilt: Degrees,
        rate_deg_s: f64,
    ) -> f64 {
        let Some(covariance) = self.lasers.get(usize::from(point.laser)) else {
            return 0.0;
        };
        let slopes = self.slopes(mount, point.position_m, tilt, rate_deg_s);
        let mut variance = 0.0;
        for (a, row) in slopes.iter().zip(covariance) {
            for (b, covariance) in slopes.iter().zip(row) {
                variance += covariance * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
            }
        }
        variance.max(0.0)
    }

    fn slopes(
        &self,
        mount: &Mount,
        head: [f64; 3],
        tilt: Degrees,
        rate_deg_s: f64,
    ) -> [[f64; 3]; COLUMNS] {
        let corrected = Tilt::new(self.tilt(tilt, rate_deg_s));
        let placed = |mount: &Mount, v| mount.place(v, corrected);
        let level = Mount::at([0.0; 3], [0.0; 3]);
        let turn = Mount::at([0.0; 3], mount.rotation_deg());
        let [_, rotation_y, rotation_z] = mount.rotation_deg();
        let after_x = Mount::at([0.0; 3], [0.0, rotation_y, rotation_z]);
        let axis_x = after_x.on_platform([1.0, 0.0, 0.0]);
        let on_platform = turn.on_platform(head);
        let [x, y, z] = head;
        let (across, range) = (
            x.hypot(y).max(1e-9),
            (x * x + y * y + z * z).sqrt().max(1e-9),
        );
        let [px, _, pz] = placed(mount, head);
        let by_tilt = [pz, 0.0, -px];
        let mut slopes = [[0.0; 3]; COLUMNS];
        slopes[0] = placed(&level, cross(axis_x, on_platform));
        slopes[1] = placed(&level, cross([0.0, 0.0, 1.0], on_platform));
        slopes[2] = placed(&level, [1.0, 0.0, 0.0]);
        slopes[3] = placed(&level, [0.0, 0.0, 1.0]);
        for (slope, factor) in slopes[4..9]
            .iter_mut()
            .zip(self.tilt_slopes(tilt, rate_deg_s))
        {
            *slope = by_tilt.map(|part| part * factor);
        }
        slopes[9] = placed(&turn, [x / range, y / range, z / range]);
        slopes[10] = placed(&turn, [-z * x / across, -z * y / across, across]);
        slopes[11] = placed(&turn, [y, -x, 0.0]);
        slopes
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The covariance of the parameters behind each laser's points.
fn by_laser(all: &ParameterCovariance) -> Vec<[[f64; COLUMNS]; COLUMNS]> {
    let of_laser = |laser: usize| {
        let own = [
            ("range_m", 1.0),
            ("elevation_deg", DEG),
            ("azimuth_deg", DEG),
        ];
        let own = own.map(|(kind, unit)| (all.place(&format!("laser_{laser}_{kind}")), unit));
        let device = DEVICE.map(|(name, unit)| (all.place(name), unit));
        let columns: Vec<_> = device.into_iter().chain(own).collect();
        let mut covariance = [[0.0; COLUMNS]; COLUMNS];
        for (row, (a, a_unit)) in covariance.iter_mut().zip(&columns) {
            for (entry, (b, b_unit)) in row.iter_mut().zip(&columns) {
                if let (Some(a), Some(b)) = (a, b) {
                    *entry = all.covariance(*a, *b) * a_unit * b_unit;
                }
            }
        }
        covariance
    };
    (0..LASERS).map(of_laser).collect()
}

#[cfg(test)]
mod tests;
