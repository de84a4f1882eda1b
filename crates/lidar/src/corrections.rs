//! Calibration of the lasers of one sensor.
//!
//! It holds the origin and direction of each beam in the sensor's frame, and its range offset.

use protocol::vlp16::{Laser, LidarModel};

/// Corrections of one laser, in place of the model's table.
///
/// With R the measured range and a the azimuth at which the laser fired, azimuth offset included,
/// its point is x = r sin a - t cos a, y = r cos a + t sin a, z = (R + range offset) sin w +
/// vertical offset, where r = (R + range offset) cos w + radial offset and t = tangential offset.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaserCorrection {
    /// Elevation of the beam above the sensor's horizontal plane (w).
    pub elevation_deg: f64,
    /// Added to the azimuth of the firing; clockwise seen from above.
    pub azimuth_offset_deg: f64,
    /// Added to every measured range.
    pub range_offset_m: f64,
    /// Origin of the beam: outwards along its azimuth (r).
    pub radial_offset_m: f64,
    /// Origin of the beam: perpendicular to its azimuth (t), positive to the left along the beam.
    pub tangential_offset_m: f64,
    /// Origin of the beam: upwards.
    pub vertical_offset_m: f64,
}

/// Every laser of one sensor, in firing order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Corrections {
    /// One entry per laser of the model.
    pub lasers: Vec<LaserCorrection>,
}

impl LaserCorrection {
    /// The point of one return by the formula above in metres, x right, y forward, z up. This is
    /// the plain definition, for tests and code that need not be fast.
    ///
    /// `range_m` is the measured range, `azimuth_deg` the rotor's azimuth at the firing of this
    /// laser, without its offset.
    #[must_use]
    pub fn place(&self, range_m: f64, azimuth_deg: f64) -> [f64; 3] {
        let (sin_w, cos_w) = self.elevation_deg.to_radians().sin_cos();
        let azimuth = (azimuth_deg + self.azimuth_offset_deg).to_radians();
        let (sin_a, cos_a) = azimuth.sin_cos();
        let range = range_m + self.range_offset_m;
        let out = range * cos_w + self.radial_offset_m;
        let tangential = self.tangential_offset_m;
        [
            out * sin_a - tangential * cos_a,
            out * cos_a + tangential * sin_a,
            range * sin_w + self.vertical_offset_m,
        ]
    }
}

impl From<&Laser> for LaserCorrection {
    /// The values of the model's table.
    fn from(laser: &Laser) -> Self {
        Self {
            elevation_deg: laser.elevation_deg,
            azimuth_offset_deg: laser.azimuth_offset_deg,
            vertical_offset_m: laser.vertical_offset_m,
            ..Self::default()
        }
    }
}

impl From<&LidarModel> for Corrections {
    /// The corrections of a sensor by its model's table.
    fn from(model: &LidarModel) -> Self {
        Self {
            lasers: model.lasers.iter().map(LaserCorrection::from).collect(),
        }
    }
}
