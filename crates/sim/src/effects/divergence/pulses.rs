//! What sub-rays of one pulse say, put together to returns.
//!
//! Left out: which of them the sensor reports.

use glam::DVec3;

use crate::effects::light;
use crate::effects::returns::Return;
use crate::simulate::{Echo, Met};

/// The most sub-rays of a pulse.
pub(super) const MOST_SAMPLES: usize = 225;
/// The most returns that are told apart: the nearest ones.
const MOST_RETURNS: usize = 8;
/// Light that even a black surface sends back: so that it has a range.
const BLACK: f64 = 1e-9;

/// What a sub-ray met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    range_m: f64,
    /// How much light it sends head-on, 1 for a white wall.
    light: f64,
    normal: DVec3,
    /// Share of its light that it mirrors.
    specular: f64,
    /// The square of how far it is from the middle.
    off_middle: f64,
    /// How much of it reaches the sensor.
    strength: f64,
}

/// How a pulse is made of sub-rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pulse {
    pub rays: usize,
    pub separation_m: f64,
    pub least_share: f64,
}

impl Sample {
    pub const NOTHING: Self = Self {
        range_m: f64::INFINITY,
        light: 0.0,
        normal: DVec3::ZERO,
        specular: 0.0,
        off_middle: f64::INFINITY,
        strength: 0.0,
    };

    pub fn new(met: &Met, direction: DVec3, off_middle: f64) -> Self {
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
    /// Returns in the order of range, and how many there are. A return ends where the next surface is farther behind than the sensor can tell apart.
    pub fn returns(&self, samples: &mut [Sample]) -> ([Return; MOST_RETURNS], usize) {
        let mut returns = [Return {
            echo: Echo::NONE,
            strength: 0.0,
        }; MOST_RETURNS];
        let mut count = 0;
        samples.sort_unstable_by(|a, b| {
            let by_range = a.range_m.total_cmp(&b.range_m);
            by_range.then(a.off_middle.total_cmp(&b.off_middle))
        });
        let apart = |a: &Sample, b: &Sample| b.range_m - a.range_m < self.separation_m;
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

    /// Samples that make one return, if it is noticed.
    fn one(&self, samples: &[Sample]) -> Option<Return> {
        let rays = self.rays.max(1) as f64;
        let share = samples.len() as f64 / rays;
        if share < self.least_share {
            return None;
        }
        let nearest = |a: &&Sample, b: &&Sample| a.off_middle.total_cmp(&b.off_middle);
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
