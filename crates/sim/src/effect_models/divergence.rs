//! Beam: the divergence of the pulse. Where its footprint spans an edge, parts of the pulse come
//! back from either side.
//!
//! The beam of a VLP-16 diverges by 3 mrad along the scan and 1.5 mrad across it (full angles) with
//! about uniform brightness (63-9243, appendix F). The footprint is sampled by sub-rays of equal
//! light. Surfaces within `separation_m` make one return at the mean range weighted by light (a
//! mixed pixel); surfaces farther apart make two returns, of which the sensor reports the
//! strongest, the last or both. The VLS-128 separates them from 1 m on (63-9483, section 6.2.3).
//!
//! Sub-rays are cast only where the footprint may span an edge: not where the surroundings are one
//! plane ([`plain`]), else where one of the four corners is off the plane of the others or of
//! another reflectivity. The beam's width at the lens, side lobes, and edges of objects between the
//! corners are not included.

mod footprint;
mod plain;
mod pulses;

use crate::effects::BeamEffect;
use crate::firing::{Echo, Echoes, SimulatedFiring, Surroundings};
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use serde::Deserialize;

use super::returns::reported;
use super::settings::{InvalidSetting, SettingCheck};
use footprint::{Footprint, scan_axis};
use plain::UniformCells;
use pulses::{MOST_SAMPLES, Pulse, PulseSample};

/// `[effects.divergence]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct DivergenceSettings {
    /// Full angle along the scan, milliradians; default 3.
    pub horizontal_mrad: f64,
    /// Full angle across the scan, milliradians; default 1.5.
    pub vertical_mrad: f64,
    /// Sub-rays along the scan, 1 to 15; default 5.
    pub columns: usize,
    /// Sub-rays across the scan, 1 to 15; default 3.
    pub rows: usize,
    /// Surfaces closer than this make one return, metres; default 1.
    pub separation_m: f64,
    /// A return with a smaller share of the pulse is not detected, 0 to 1; default 0.05.
    pub least_share: f64,
    /// Smallest deviation from a plane that counts as an edge, metres; default 2 mm, the step of
    /// the sensor's ranges.
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

/// A diverging beam, for one run: it caches where that run's scene is plain.
#[derive(Clone, Debug)]
pub struct Divergence {
    /// Half the width and height of the footprint at 1 m.
    half: [f64; 2],
    settings: DivergenceSettings,
    plain: OnceLock<UniformCells>,
}

/// Sub-rays cast together.
const TOGETHER: usize = 16;
/// The most sub-rays per side.
const MOST: f64 = 15.0;

impl Divergence {
    /// With these settings.
    ///
    /// # Errors
    /// [`InvalidSetting`] for numbers out of range.
    pub fn new(settings: &DivergenceSettings) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
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

    /// Whether a footprint needs no sub-rays.
    fn is_plain(&self, patch: &Footprint, range_m: f64, surroundings: &Surroundings) -> bool {
        // Moving objects are not in the map, so none may be near.
        let half = self.half[0].hypot(self.half[1]);
        !surroundings.may_move_near(patch.origin_m, patch.direction, half)
            && self
                .plain
                .get_or_init(|| UniformCells::new(surroundings, self.settings.flat_m))
                .is_around(patch.origin_m, patch.direction, range_m)
    }

    /// Like [`BeamEffect::receive`], with sub-rays at every shot: the reference for the search for
    /// edges.
    pub fn receive_everywhere(
        &self,
        firing: &SimulatedFiring,
        surroundings: &Surroundings,
        echoes: &mut Echoes,
    ) -> u32 {
        self.act(firing, surroundings, echoes, |_, _| true)
    }

    /// Samples the footprints that may span an edge. Returns how many.
    #[inline(always)]
    fn act(
        &self,
        firing: &SimulatedFiring,
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

    /// The strongest return of a pulse and the other.
    fn pulse(&self, patch: &Footprint, surroundings: &Surroundings) -> [Echo; 2] {
        let (columns, rows) = (self.settings.columns, self.settings.rows);
        let along = |place: usize, of: usize| (2 * place + 1) as f64 / of as f64 - 1.0;
        let place = |ray: usize| (along(ray % columns, columns), along(ray / columns, rows));
        let rays = (columns * rows).min(MOST_SAMPLES);
        let mut samples = [PulseSample::NOTHING; MOST_SAMPLES];
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
            surroundings.cast_fan(patch.origin_m, directions, &mut mets);
            for ((met, direction), ray) in mets.iter().zip(directions).zip(fan) {
                if let (Some(met), Some(sample)) = (met, samples.get_mut(count)) {
                    let (x, y) = place(ray);
                    *sample = PulseSample::new(met, *direction, x * x + y * y);
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

effect! {
    Divergence, DivergenceSettings, firings.beam: Arc, "divergence",
    idle: "no edge lies within a footprint: 0 % of firings took sub-rays",
    new: |settings, _| Divergence::new(settings)
}

impl BeamEffect for Divergence {
    fn receive(
        &self,
        firing: &SimulatedFiring,
        surroundings: &Surroundings,
        echoes: &mut Echoes,
    ) -> u32 {
        self.act(firing, surroundings, echoes, |patch, middle| {
            !self.is_plain(patch, middle.range_m, surroundings)
                && !patch.is_flat(middle, self.settings.flat_m, surroundings)
        })
    }
}

#[cfg(test)]
mod tests;
