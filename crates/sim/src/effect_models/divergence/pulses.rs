//! Returns of a pulse from the samples of its sub-rays.

use crate::firing::{Echo, SurfaceHit};
use glam::DVec3;

use super::super::light;
use super::super::returns::Return;

/// The most sub-rays of a pulse.
pub(super) const MOST_SAMPLES: usize = 225;
/// The most returns that are separated, the nearest first.
const MOST_RETURNS: usize = 8;
/// Light of a black surface, above 0 so that it has a range.
const BLACK: f64 = 1e-9;

/// A sample: the surface that a sub-ray meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct PulseSample {
    range_m: f64,
    /// Light head-on, 1 for a white wall.
    light: f64,
    normal: DVec3,
    /// Share of specular light.
    specular: f64,
    /// Squared distance from the centre.
    off_middle: f64,
    /// Light that reaches the sensor.
    strength: f64,
}

/// The sampling of a pulse.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pulse {
    pub rays: usize,
    pub separation_m: f64,
    pub least_share: f64,
}

impl PulseSample {
    pub const NOTHING: Self = Self {
        range_m: f64::INFINITY,
        light: 0.0,
        normal: DVec3::ZERO,
        specular: 0.0,
        off_middle: f64::INFINITY,
        strength: 0.0,
    };

    pub fn new(met: &SurfaceHit, direction: DVec3, off_middle: f64) -> Self {
        let light = light::of_reflectivity(met.reflectivity).max(BLACK);
        let back = match met.normal == DVec3::ZERO {
            true => light,
            false => light::of_surface(light, met.specular, met.normal.dot(direction).abs()),
        };
        Self {
            range_m: met.range_m,
            light,
            normal: met.normal,
            specular: met.specular,
            off_middle,
            strength: back.max(BLACK * BLACK) / (met.range_m * met.range_m),
        }
    }
}

impl Pulse {
    /// Returns in order of range, and their number. A return ends where the next surface is farther
    /// behind than the separation.
    pub fn returns(&self, samples: &mut [PulseSample]) -> ([Return; MOST_RETURNS], usize) {
        let mut returns = [Return {
            echo: Echo::NONE,
            strength: 0.0,
        }; MOST_RETURNS];
        let mut count = 0;
        samples.sort_unstable_by(|a, b| {
            let by_range = a.range_m.total_cmp(&b.range_m);
            by_range.then(a.off_middle.total_cmp(&b.off_middle))
        });
        let apart = |a: &PulseSample, b: &PulseSample| b.range_m - a.range_m < self.separation_m;
        for together in samples.chunk_by(apart) {
            if let Some(place) = returns.get_mut(count)
                && let Some(found) = self.one(together)
            {
                *place = found;
                count += 1;
            }
        }
        (returns, count)
    }

    /// The return of these samples, if it is detected.
    fn one(&self, samples: &[PulseSample]) -> Option<Return> {
        let rays = self.rays.max(1) as f64;
        let share = samples.len() as f64 / rays;
        if share < self.least_share {
            return None;
        }
        let nearest = |a: &&PulseSample, b: &&PulseSample| a.off_middle.total_cmp(&b.off_middle);
        let middle = samples.iter().min_by(nearest)?;
        let strength: f64 = samples.iter().map(|sample| sample.strength).sum();
        let light: f64 = samples.iter().map(|sample| sample.light).sum();
        let mirrored: f64 = samples.iter().map(|s| s.specular * s.light).sum();
        let ranges = samples.iter().map(|s| s.strength * s.range_m).sum::<f64>();
        Some(Return {
            echo: Echo {
                range_m: ranges / strength,
                true_range_m: middle.range_m,
                reflectivity: light::to_reflectivity(light / rays),
                share,
                normal: middle.normal,
                specular: mirrored / light,
            },
            strength: strength / rays,
        })
    }
}
