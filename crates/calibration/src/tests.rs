//! Tests of the whole estimator, and what the tests of its parts share.

mod oracle;
pub(crate) mod scans;

use units::random::{split_mix_64, unit_interval};

use crate::model::Fixed;
use crate::parameters::Layout;
use crate::shots::{NominalLaser, RangeShot};

/// Draws from -1 to 1 (SplitMix64).
pub(crate) fn draws(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || 2.0 * unit_interval(split_mix_64(&mut state)) - 1.0
}

/// A VLP-16 on a mount with this rotation about y and position along y.
pub(crate) fn fixed(rotation_y: f64, position_y: f64) -> Fixed {
    let lasers = (0..16).map(|laser| NominalLaser {
        elevation_deg: -15.0 + 2.0 * f64::from(laser),
        vertical_offset_m: 0.0112 - 0.0015 * f64::from(laser),
    });
    Fixed {
        rotation_y,
        position_y,
        ripple_periods: 120.0,
        lasers: lasers.collect(),
    }
}

/// Random values of all parameters, of the size of their priors.
pub(crate) fn values(layout: &Layout, random: &mut impl FnMut() -> f64) -> Vec<f64> {
    let parameters = layout.parameters();
    parameters.iter().map(|p| p.prior_sd * random()).collect()
}

/// A random shot.
pub(crate) fn shot(random: &mut impl FnMut() -> f64) -> RangeShot {
    let azimuth = std::f64::consts::PI * random();
    RangeShot {
        range_m: 20.0 + 18.0 * random(),
        azimuth: [azimuth.sin(), azimuth.cos()],
        tilt_rad: 0.8 * random(),
        rate_rad_s: random(),
        time_s: 2.0 * random(),
        laser: (8.0 + 7.99 * random()) as u8,
        ..RangeShot::default()
    }
}
