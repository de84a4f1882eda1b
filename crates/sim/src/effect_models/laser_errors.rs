//! Surface: constant errors of each laser, of its range, elevation and azimuth.
//!
//! A laser points where its errors put it, while a reader of its packets trusts the manual's table.
//! Real VLP-16s are off by millimetres to centimetres in range. Errors that depend on range,
//! strength or temperature are not included.

use std::sync::Arc;

use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};
use crate::effects::SurfaceEffect;
use crate::firing::{Echoes, SimulatedFiring};
use crate::random::RandomSource;
use crate::sensor::{LaserBeam, MAX_SENSOR_LASERS};

/// `[effects.laser_errors]`. Errors are drawn per laser; lists by laser in firing order add to
/// them.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct LaserErrorsSettings {
    /// Standard deviation of the errors of range, metres.
    pub range_sd_m: f64,
    /// Standard deviation of the errors of elevation, degrees.
    pub elevation_sd_deg: f64,
    /// Standard deviation of the errors of azimuth, degrees.
    pub azimuth_sd_deg: f64,
    /// Errors of range, metres: what a laser reports too much.
    pub range_m: Vec<f64>,
    /// Errors of elevation, degrees.
    pub elevation_deg: Vec<f64>,
    /// Errors of azimuth, degrees.
    pub azimuth_deg: Vec<f64>,
}

/// Errors of lasers in firing order: range (metres), elevation and azimuth (degrees).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserErrors {
    range_m: [f64; MAX_SENSOR_LASERS],
    elevation_deg: [f64; MAX_SENSOR_LASERS],
    azimuth_deg: [f64; MAX_SENSOR_LASERS],
}

impl LaserErrors {
    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`InvalidSetting`] for numbers out of range.
    pub fn new(settings: &LaserErrorsSettings, seed: u64) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        let random = RandomSource::new(seed, Self::NAME);
        let kind = |channel, names: [&'static str; 2], sd: f64, list: &[f64], most: f64| {
            check.within(names[0], sd, 0.0..=most)?;
            let mut errors = [0.0; MAX_SENSOR_LASERS];
            for (laser, error) in errors.iter_mut().enumerate() {
                let given = list.get(laser).copied().unwrap_or(0.0);
                check.within(names[1], given, -most..=most)?;
                *error = given + sd * random.at(laser as u64, channel).normal();
            }
            Ok(errors)
        };
        let LaserErrorsSettings {
            range_sd_m,
            elevation_sd_deg,
            azimuth_sd_deg,
            range_m,
            elevation_deg,
            azimuth_deg,
        } = settings;
        Ok(Self {
            range_m: kind(0, ["range_sd_m", "range_m"], *range_sd_m, range_m, 1.0)?,
            elevation_deg: kind(
                1,
                ["elevation_sd_deg", "elevation_deg"],
                *elevation_sd_deg,
                elevation_deg,
                5.0,
            )?,
            azimuth_deg: kind(
                2,
                ["azimuth_sd_deg", "azimuth_deg"],
                *azimuth_sd_deg,
                azimuth_deg,
                5.0,
            )?,
        })
    }
}

effect! {
    LaserErrors, LaserErrorsSettings, firings.surface: Arc, "laser_errors",
    idle: "nothing came back",
    new: LaserErrors::new
}

impl SurfaceEffect for LaserErrors {
    fn reflect(&self, firing: &SimulatedFiring, echoes: &mut Echoes) -> u32 {
        let mut acted = 0;
        let range_m = self.range_m.get(firing.first_laser..).unwrap_or_default();
        for echoes in echoes.all_mut() {
            for (echo, error_m) in echoes.iter_mut().zip(range_m) {
                if echo.is_present() {
                    echo.range_m += error_m;
                    acted += 1;
                }
            }
        }
        acted
    }

    fn misalign(&self, beams: &mut [LaserBeam]) {
        let errors = self.elevation_deg.iter().zip(&self.azimuth_deg);
        for (beam, (elevation_deg, azimuth_deg)) in beams.iter_mut().zip(errors) {
            beam.elevation_deg += elevation_deg;
            beam.azimuth_deg += azimuth_deg;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::LidarSensor;

    #[test]
    fn drawn_errors_have_their_deviation_and_lists_add_to_them() {
        let drawn = LaserErrorsSettings {
            range_sd_m: 0.01,
            ..LaserErrorsSettings::default()
        };
        let squares: f64 = (0..200)
            .flat_map(|seed| LaserErrors::new(&drawn, seed).unwrap().range_m)
            .map(|error| error * error)
            .sum();
        let sd = (squares / (200 * MAX_SENSOR_LASERS) as f64).sqrt();
        assert!((sd / 0.01 - 1.0).abs() < 0.05, "{sd}");
        let both = LaserErrorsSettings {
            range_m: vec![0.5],
            ..drawn.clone()
        };
        let (drawn, both) = (
            LaserErrors::new(&drawn, 3).unwrap(),
            LaserErrors::new(&both, 3).unwrap(),
        );
        assert!((both.range_m[0] - drawn.range_m[0] - 0.5).abs() < 1e-15);
        assert_eq!(both.range_m[1..], drawn.range_m[1..]);
    }

    #[test]
    fn rays_leave_at_the_wrong_angles_and_reports_have_the_wrong_range() {
        let settings = LaserErrorsSettings {
            range_m: vec![0.0, 0.02],
            elevation_deg: vec![0.1],
            azimuth_deg: vec![0.0, -0.2],
            ..LaserErrorsSettings::default()
        };
        let errors = LaserErrors::new(&settings, 1).unwrap();
        let table = LidarSensor::vlp16();
        let mut beams = table.beams.clone();
        errors.misalign(&mut beams);
        assert_eq!(beams[0].elevation_deg, table.beams[0].elevation_deg + 0.1);
        assert_eq!(beams[1].azimuth_deg, table.beams[1].azimuth_deg - 0.2);
        let mut echoes = Echoes::new(16, false);
        for echo in echoes.all_mut().flatten() {
            echo.range_m = 10.0;
        }
        assert_eq!(errors.reflect(&SimulatedFiring::new(16), &mut echoes), 16);
        let ranges: Vec<f64> = echoes.all_mut().flatten().map(|e| e.range_m).collect();
        assert_eq!(ranges[..3], [10.0, 10.02, 10.0]);
        let invalid = LaserErrorsSettings {
            range_m: vec![f64::NAN],
            ..LaserErrorsSettings::default()
        };
        assert!(LaserErrors::new(&invalid, 1).is_err());
    }
}
