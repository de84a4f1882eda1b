//! What a calibration of one sensor says of its lasers, whatever file it came from.
//!
//! Where a beam starts and points relative to the sensor's own frame, and by how much its range is off. Left out:
//! reflectivity, and how any of it was measured.

/// One laser of one sensor, in place of the model's table.
///
/// With R the measured range and a the azimuth at which the laser fired, azimuth offset included, its point is
/// x = r sin a - t cos a, y = r cos a + t sin a, z = (R + range offset) sin w + vertical offset, where
/// r = (R + range offset) cos w + radial offset and t = tangential offset.
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
