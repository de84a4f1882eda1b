//! Surface: ranges that are off by chance, each return by itself, normally distributed.
//!
//! The VLP-16's manual (63-9243, specifications) says +-3 cm typical, the HDL-32E's +-2 cm, without saying of what kind; here the number is one
//! standard deviation. Left out: noise that depends on range or strength, and errors that stay the same for a laser.

use super::{Absorb, Effect, Surface};
use crate::random::Source;
use crate::simulate::{Echoes, Firing};

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
