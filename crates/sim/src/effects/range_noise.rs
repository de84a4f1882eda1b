//! Surface: ranges that are off by chance, each return by itself, normally distributed.
//!
//! The VLP-16's manual (63-9243, specifications) says +-3 cm typical, the HDL-32E's +-2 cm, without saying of what kind; here the number is one
//! standard deviation. Left out: noise that depends on range or strength, and errors that stay the same for a laser.

use std::sync::Arc;

use serde::Deserialize;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Absorb, Asked, Effect, Listed, Surface};
use crate::random::Source;
use crate::simulate::{Echoes, Firing};

/// `[effects.range_noise]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct RangeNoiseSettings {
    /// One standard deviation, metres.
    pub sd_m: f64,
}

impl Settings for RangeNoiseSettings {
    fn ask(&self, seed: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let sd_m = Check(RangeNoise::NAME).not_negative("sd_m", self.sd_m)?;
        let effect = Arc::new(RangeNoise::new(sd_m, seed));
        asked.firings.surface.push(Listed::new(effect, clock));
        Ok(())
    }
}

/// Normal noise of ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeNoise {
    sd_m: f64,
    random: Source,
}

impl RangeNoise {
    /// What the scene file calls it.
    pub const NAME: &'static str = "range_noise";

    /// Noise with a standard deviation of `sd_m` metres (not negative, finite; else none) in a run with `seed`.
    #[must_use]
    pub fn new(sd_m: f64, seed: u64) -> Self {
        let sound = sd_m.is_finite() && sd_m > 0.0;
        Self {
            sd_m: if sound { sd_m } else { 0.0 },
            random: Source::new(seed, Self::NAME),
        }
    }
}

impl Effect for RangeNoise {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "nothing came back"
    }
}

impl Absorb for RangeNoise {}

impl Surface for RangeNoise {
    fn reflect(&self, firing: &Firing, echoes: &mut Echoes) -> u32 {
        let mut acted = 0;
        let returns = echoes.all_mut();
        for (set, echoes) in returns.enumerate() {
            // A draw gives two: one for each of two neighbours.
            for (pair, two) in echoes.chunks_mut(2).enumerate() {
                if two.iter().all(|echo| !echo.is_there()) {
                    continue;
                }
                let channel = 16 * set as u32 + pair as u32;
                let normals = self.random.at(firing.number, channel).normals();
                for (echo, normal) in two.iter_mut().zip(normals) {
                    if echo.is_there() {
                        echo.range_m += self.sd_m * normal;
                        acted += 1;
                    }
                }
            }
        }
        acted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same length for all lasers of many firings: what it is changed by.
    fn changes(sd_m: f64, two: bool) -> Vec<f64> {
        let noise = RangeNoise::new(sd_m, 5);
        let mut firing = Firing::new(32);
        let mut all = Vec::new();
        for number in 0..1_000 {
            firing.number = number;
            let mut echoes = Echoes::new(32, two);
            for echo in echoes.all_mut().flatten().filter(|_| number % 2 == 0) {
                echo.range_m = 10.0;
                echo.true_range_m = 10.0;
            }
            noise.reflect(&firing, &mut echoes);
            for echo in echoes.all_mut().flatten().filter(|echo| echo.is_there()) {
                assert_eq!(echo.true_range_m, 10.0);
                all.push(echo.range_m - 10.0);
            }
        }
        all
    }

    #[test]
    fn it_is_as_large_as_asked_for_and_every_return_has_its_own() {
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
    fn what_is_no_deviation_changes_nothing() {
        for sd_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(changes(sd_m, false).iter().all(|change| *change == 0.0));
        }
    }
}
