//! Beam: a pulse lights a patch, not a point. Where the patch lies across an edge, parts of the pulse come back from either side of it.
//!
//! A VLP-16's beam widens by 3 mrad along the scan and 1.5 mrad across it, all of it, and is about evenly bright (63-9243, appendix F). The patch is
//! sampled by sub-rays, each with as much of the light as any other; what comes back within `separation_m` is one return at the mean range by light (a mixed
//! pixel, which lies where nothing is), what is farther apart is two returns, of which the sensor reports the strongest, the last or both: it tells
//! them apart from 1 m on (section 6.2).
//!
//! Sub-rays are cast only where the patch can lie across an edge: not where everything around is one plane ([`plain`]), else where one of the
//! four corners of the patch is not on the plane of the others and the middle, or is of another reflectivity. Left out: the width that the
//! beam has when it leaves the lens, its side lobes, and edges of what fits between the corners.

mod footprint;
mod plain;
mod pulses;

use std::sync::{Arc, OnceLock};

use glam::DVec3;
use serde::Deserialize;

use super::returns::reported;
use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Absorb, Asked, Beam, Effect, Listed};
use crate::simulate::{Echo, Echoes, Firing, Surroundings};
use footprint::{Footprint, scan_axis};
use plain::Plain;
use pulses::{MOST_SAMPLES, Pulse, Sample};

/// `[effects.divergence]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct DivergenceSettings {
    /// Whole angle along the scan, milliradians; 3 unless said.
    pub horizontal_mrad: f64,
    /// Whole angle across it; 1.5 unless said.
    pub vertical_mrad: f64,
    /// Sub-rays along the scan; 5 unless said, 15 at most.
    pub columns: usize,
    /// Sub-rays across it; 3 unless said, 15 at most.
    pub rows: usize,
    /// Surfaces nearer to each other make one return, metres; 1 unless said.
    pub separation_m: f64,
    /// A return with less of the pulse than this goes unnoticed, 0 to 1; 0.05 unless said.
    pub least_share: f64,
    /// What is off its plane by less than this is no edge, metres; 2 mm unless said, the step of the sensor's ranges.
    pub flat_m: f64,
}

impl Default for DivergenceSettings {
    fn default() -> Self {
        Self {
            horizontal_mrad: 3.0,
            vertical_mrad: 1.5,
            columns: 5,
            rows: 3,
            separation_m: 1.0,
            least_share: 0.05,
            flat_m: 0.002,
        }
    }
}

/// A beam that widens. For one run: it remembers where that run's scene is plain.
#[derive(Clone, Debug)]
pub struct Divergence {
    /// Half the width and height of the patch at 1 m.
    half: [f64; 2],
    settings: DivergenceSettings,
    plain: OnceLock<Plain>,
}

/// Sub-rays that are cast together.
const TOGETHER: usize = 16;
/// The most sub-rays along a side.
const MOST: f64 = 15.0;

impl Divergence {
    /// What the scene file calls it.
    pub const NAME: &'static str = "divergence";

    /// With these settings.
    ///
    /// # Errors
    /// [`Unfit`] for numbers out of their range.
    pub fn new(settings: &DivergenceSettings) -> Result<Self, Unfit> {
        let check = Check(Self::NAME);
        let half = |setting, mrad| Ok(0.5e-3 * check.within(setting, mrad, 0.0..=100.0)?);
        check.within("columns", settings.columns as f64, 1.0..=MOST)?;
        check.within("rows", settings.rows as f64, 1.0..=MOST)?;
        check.within("separation_m", settings.separation_m, 0.0..=1e3)?;
        check.within("least_share", settings.least_share, 0.0..=1.0)?;
        check.above_0("flat_m", settings.flat_m)?;
        Ok(Self {
            half: [
                half("horizontal_mrad", settings.horizontal_mrad)?,
                half("vertical_mrad", settings.vertical_mrad)?,
            ],
            settings: *settings,
            plain: OnceLock::new(),
        })
    }

    /// Whether a patch needs no look at all.
    fn is_plain(&self, patch: &Footprint, range_m: f64, surroundings: &Surroundings) -> bool {
        // What moves is not in the map: it must not be near.
        let half = self.half[0].hypot(self.half[1]);
        !surroundings.may_move_near(patch.origin_m, patch.direction, half)
            && self
                .plain
                .get_or_init(|| Plain::new(surroundings, self.settings.flat_m))
                .is_around(patch.origin_m, patch.direction, range_m)
    }

    /// As [`Beam::receive`], but with sub-rays at every shot, edge or not: what looking for edges is measured against.
    pub fn receive_everywhere(
        &self,
        firing: &Firing,
        surroundings: &Surroundings,
        echoes: &mut Echoes,
    ) -> u32 {
        self.act(firing, surroundings, echoes, |_, _| true)
    }

    /// Samples the patches that can lie across an edge; how many.
    #[inline(always)]
    fn act(
        &self,
        firing: &Firing,
        surroundings: &Surroundings,
        echoes: &mut Echoes,
        can_straddle: impl Fn(&Footprint, &Echo) -> bool,
    ) -> u32 {
        let Some(scan) = scan_axis(firing) else {
            return 0;
        };
        let mut acted = 0;
        for laser in firing.alive() {
            let (Some(origin_m), Some(direction), Some(strongest), Some(other)) = (
                firing.origins_m.get(laser),
                firing.directions.get(laser),
                echoes.strongest.get_mut(laser),
                echoes.other.get_mut(laser),
            ) else {
                continue;
            };
            let patch = Footprint::new(*origin_m, *direction, scan, self.half);
            if can_straddle(&patch, strongest) {
                [*strongest, *other] = self.pulse(&patch, surroundings);
                acted += 1;
            }
        }
        acted
    }

    /// What comes back of a pulse: the strongest return and the other.
    fn pulse(&self, patch: &Footprint, surroundings: &Surroundings) -> [Echo; 2] {
        let (columns, rows) = (self.settings.columns, self.settings.rows);
        let along = |place: usize, of: usize| (2 * place + 1) as f64 / of as f64 - 1.0;
        let place = |ray: usize| (along(ray % columns, columns), along(ray / columns, rows));
        let rays = (columns * rows).min(MOST_SAMPLES);
        let mut samples = [Sample::NOTHING; MOST_SAMPLES];
        let mut count = 0;
        for first in (0..rays).step_by(TOGETHER) {
            let fan = first..rays.min(first + TOGETHER);
            let mut directions = [DVec3::ZERO; TOGETHER];
            for (direction, ray) in directions.iter_mut().zip(fan.clone()) {
                let (x, y) = place(ray);
                *direction = patch.towards(x, y);
            }
            let mut mets = [None; TOGETHER];
            let directions = directions.get(..fan.len()).unwrap_or_default();
            surroundings.meet_fan(patch.origin_m, directions, &mut mets);
            for ((met, direction), ray) in mets.iter().zip(directions).zip(fan) {
                if let (Some(met), Some(sample)) = (met, samples.get_mut(count)) {
                    let (x, y) = place(ray);
                    *sample = Sample::new(met, *direction, x * x + y * y);
                    count += 1;
                }
            }
        }
        let pulse = Pulse {
            rays: columns * rows,
            separation_m: self.settings.separation_m,
            least_share: self.settings.least_share,
        };
        let samples = samples.get_mut(..count).unwrap_or_default();
        let (returns, found) = pulse.returns(samples);
        reported(returns.get(..found).unwrap_or_default())
    }
}

impl Settings for DivergenceSettings {
    fn ask(&self, _: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Arc::new(Divergence::new(self)?);
        asked.firings.beam.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for Divergence {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "no edge lies within a footprint: 0 % of firings took sub-rays"
    }
}

impl Absorb for Divergence {}

impl Beam for Divergence {
    fn receive(&self, firing: &Firing, surroundings: &Surroundings, echoes: &mut Echoes) -> u32 {
        self.act(firing, surroundings, echoes, |patch, middle| {
            !self.is_plain(patch, middle.range_m, surroundings)
                && !patch.is_flat(middle, self.settings.flat_m, surroundings)
        })
    }
}

#[cfg(test)]
mod tests;
