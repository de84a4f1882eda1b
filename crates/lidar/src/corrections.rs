//! What a calibration of one sensor says of its lasers, whatever file it came from.
//!
//! Where a beam starts and points relative to the sensor's own frame, and by how much its range is
//! off. Left out: reflectivity, and how any of it was measured.

use protocol::vlp16::{Laser, Model};

/// One laser of one sensor, in place of the model's table.
///
/// With R the measured range and a the azimuth at which the laser fired, azimuth offset included,
/// its point is x = r sin a - t cos a, y = r cos a + t sin a, z = (R + range offset) sin w +
/// vertical offset, where r = (R + range offset) cos w + radial offset and t = tangential offset.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaserCorrection {
    /// Angle of the beam above the sensor's horizontal (w).
    pub elevation_deg: f64,
    /// Added to the azimuth of the firing; clockwise seen from above.
    pub azimuth_offset_deg: f64,
    /// Added to every measured range.
    pub range_offset_m: f64,
    /// Where the beam starts: outwards along its own azimuth.
    pub radial_offset_m: f64,
    /// Where the beam starts: square to its azimuth, positive to the left seen along the beam.
    pub tangential_offset_m: f64,
    /// Where the beam starts: upwards.
    pub vertical_offset_m: f64,
}

/// Every laser of one sensor, in firing order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Corrections {
    /// One entry a laser of the model.
    pub lasers: Vec<LaserCorrection>,
}

impl LaserCorrection {
    /// The point of one return by the formula above, in metres, x right, y forward, z up: exact and
    /// plain, for what need not be fast, and to hold against what is.
    ///
    /// `range_m` is the measured range, `azimuth_deg` the rotor's azimuth when this laser fired,
    /// its offset not yet added.
    #[must_use]
    pub fn place(&self, range_m: f64, azimuth_deg: f64) -> [f64; 3] {
        let (sin_w, cos_w) = self.elevation_deg.to_radians().sin_cos();
        let azimuth = (azimuth_deg + self.azimuth_offset_deg).to_radians();
        let (sin_a, cos_a) = azimuth.sin_cos();
        let range = range_m + self.range_offset_m;
        let out = range * cos_w + self.radial_offset_m;
        let aside = self.tangential_offset_m;
        [
            out * sin_a - aside * cos_a,
            out * cos_a + aside * sin_a,
            range * sin_w + self.vertical_offset_m,
        ]
    }
}

impl From<&Laser> for LaserCorrection {
    /// What the model's table says of a laser.
    fn from(laser: &Laser) -> Self {
        Self {
            elevation_deg: laser.elevation_deg,
            azimuth_offset_deg: laser.azimuth_offset_deg,
            vertical_offset_m: laser.vertical_offset_m,
            ..Self::default()
        }
    }
}

impl From<&Model> for Corrections {
    /// A sensor that is what its model's table says.
    fn from(model: &Model) -> Self {
        Self {
            lasers: model.lasers.iter().map(LaserCorrection::from).collect(),
        }
    }
}
