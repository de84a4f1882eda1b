//! Surface: independent normal noise of each range.
//!
//! The manuals give +-3 cm typical for the VLP-16 (63-9243, specifications) and +-2 cm for the
//! HDL-32E without a definition. It counts as three standard deviations (`USUAL_SD_M`), as
//! recordings of real sensors have it. Noise that depends on range or strength, and constant errors
//! of a laser, are not included.

use crate::effects::SurfaceEffect;
use crate::firing::{Echoes, SimulatedFiring};
use std::sync::Arc;

use serde::Deserialize;

use super::settings::SettingCheck;
use crate::random::RandomSource;

/// `[effects.range_noise]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct RangeNoiseSettings {
    /// Standard deviation, metres.
    pub sd_m: f64,
}

/// Normal noise of ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeNoise {
    sd_m: f64,
    random: RandomSource,
}

impl RangeNoise {
    /// Noise with a standard deviation of `sd_m` metres (0 if negative or not finite) in a run with
    /// `seed`.
    #[must_use]
    pub fn new(sd_m: f64, seed: u64) -> Self {
        let is_valid = sd_m.is_finite() && sd_m > 0.0;
        Self {
            sd_m: if is_valid { sd_m } else { 0.0 },
            random: RandomSource::new(seed, Self::NAME),
        }
    }
}

/// Standard deviation of a VLP-16: a third of its accuracy ("up to 3 cm, typical", 63-9229).
const USUAL_SD_M: f64 = 0.01;

effect! {
    RangeNoise, RangeNoiseSettings, firings.surface: Arc, "range_noise",
    idle: "nothing came back",
    usual: RangeNoiseSettings { sd_m: USUAL_SD_M },
    new: |settings, seed| {
        let sd_m = SettingCheck(RangeNoise::NAME).not_negative("sd_m", settings.sd_m)?;
        Ok(RangeNoise::new(sd_m, seed))
    }
}

impl SurfaceEffect for RangeNoise {
    fn reflect(&self, firing: &SimulatedFiring, echoes: &mut Echoes) -> u32 {
        let mut acted = 0;
        let returns = echoes.all_mut();
        for (set, echoes) in returns.enumerate() {
            // A draw gives two values, for two neighbouring lasers.
            for (pair, lasers) in echoes.chunks_mut(2).enumerate() {
                if lasers.iter().all(|echo| !echo.is_present()) {
                    continue;
                }
                let channel = 16 * set as u32 + pair as u32;
                let normals = self.random.at(firing.number, channel).normals();
                for (echo, normal) in lasers.iter_mut().zip(normals) {
                    if echo.is_present() {
                        echo.range_m += self.sd_m * normal;
                        acted += 1;
                    }
                }
            }
        }
        acted
    }

    fn range_variance_m2(&self) -> f64 {
        self.sd_m * self.sd_m
    }
}

#[cfg(test)]
mod tests {
    use super::RangeNoise;
    use super::*;

    /// Errors of one range in all lasers of many firings.
    fn changes(sd_m: f64, two: bool) -> Vec<f64> {
        let noise = RangeNoise::new(sd_m, 5);
        let mut firing = SimulatedFiring::new(32);
        let mut all = Vec::new();
        for number in 0..1_000 {
            firing.number = number;
            let mut echoes = Echoes::new(32, two);
            for echo in echoes.all_mut().flatten().filter(|_| number % 2 == 0) {
                echo.range_m = 10.0;
                echo.true_range_m = 10.0;
            }
            noise.reflect(&firing, &mut echoes);
            for echo in echoes.all_mut().flatten().filter(|echo| echo.is_present()) {
                assert_eq!(echo.true_range_m, 10.0);
                all.push(echo.range_m - 10.0);
            }
        }
        all
    }

    #[test]
    fn range_noise_has_the_requested_deviation_for_each_return() {
        let all = changes(0.02, true);
        assert_eq!(all.len(), 32_000);
        let count = all.len() as f64;
        let mean = all.iter().sum::<f64>() / count;
        let variance = all.iter().map(|x| x * x).sum::<f64>() / count;
        assert!(mean.abs() < 4.0 * 0.02 / count.sqrt(), "{mean}");
        assert!((variance.sqrt() / 0.02 - 1.0).abs() < 4.0 / (2.0 * count).sqrt());
        let mut distinct = all.clone();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        assert_eq!(distinct.len(), all.len());
    }

    #[test]
    fn invalid_deviations_change_nothing() {
        for sd_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(changes(sd_m, false).iter().all(|change| *change == 0.0));
        }
    }
}
