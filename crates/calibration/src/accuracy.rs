//! Accuracy of the points of scans, from the scans themselves.
//!
//! Surface elements of half a metre, those of the calibration, show the noise of ranges and what
//! depends on range, incidence, tilt, speed, laser, reflectivity or time (`bins`); elements that
//! several sweeps meet show the repeatability of the axis (`sweeps`); corners of large surfaces
//! that two stations see give distances (`stations`); `budget` adds what no scan shows.

mod bins;
mod budget;
mod stations;
mod sweeps;
#[cfg(test)]
mod tests;

use cloud::mount::Mount;

pub use bins::{BinGroup, PointError, ResidualBin};
pub use budget::{AngleErrors, BudgetBin, KnownCovariance};
pub use stations::StationPair;
pub use sweeps::SweepPair;

use crate::calibration::{CalibrationRefusal, MIN_PATCHES};
use crate::equations::{CUT_SD, ShotWeights};
use crate::linear::dot;
use crate::model::{Fixed, ScannerModel};
use crate::parameters::{Layout, POSITION_X, POSITION_Z, ROTATION_X, ROTATION_Z};
use crate::patches::{Patches, Weigh};
use crate::shots::{NominalLaser, Scan, noise_of_all_m};
use crate::surface::{COEFFICIENTS, Incidence};

/// A study of scans of one scanner.
#[derive(Clone, Debug)]
pub struct StudyRequest<'a> {
    /// The scans.
    pub scans: &'a [Scan],
    /// Nominal lasers, as the scans were decoded.
    pub lasers: &'a [NominalLaser],
    /// The mount.
    pub mount: Mount,
    /// Turns of the motor per turn of the axis.
    pub gear: f64,
    /// Values of the other parameters by name, in the units of their names; 0 if not calibrated.
    pub corrections: &'a [(String, f64)],
    /// Their covariance, if they are calibrated.
    pub covariance: Option<KnownCovariance<'a>>,
    /// Errors of angles that residuals do not show.
    pub angles: AngleErrors,
    /// Errors of the points of each scan, by the index of the point, if the truth is known.
    pub truth: &'a [Vec<PointError>],
}

/// Accuracy of scans, measured from the scans themselves.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct AccuracyStudy {
    /// Surface elements.
    pub patches: usize,
    /// Shots on them that count.
    pub shots: usize,
    /// Range noise of each laser between neighbouring shots, metres; the maker's accuracy for one
    /// without.
    pub noise_m: Vec<f64>,
    /// Mean residual of each laser, metres; none without shots on elements.
    pub laser_offsets_m: Vec<Option<f64>>,
    /// Residuals by what they may depend on.
    pub groups: Vec<BinGroup>,
    /// Pairs of sweeps of one scan.
    pub sweeps: Vec<SweepPair>,
    /// Pairs of scans that see the same corners.
    pub stations: Vec<StationPair>,
    /// Errors of points by their distance.
    pub budget: Vec<BudgetBin>,
}

/// A shot on an element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ElementShot {
    /// Distance of its end from the element along the beam, metres, corrected for the coefficients
    /// that the element takes from its shots.
    pub residual_m: f64,
    /// Standard deviation of that by noise and pointing, metres.
    pub expected_m: f64,
    /// Cosine of the incidence.
    pub cosine: f64,
    /// Change of the residual by the tilt, metres per radian.
    pub by_tilt: f64,
}

/// Studies scans.
///
/// # Errors
/// [`CalibrationRefusal::FewPatches`].
pub fn study(request: &StudyRequest<'_>) -> Result<AccuracyStudy, CalibrationRefusal> {
    let scans = request.scans;
    let layout = Layout {
        lasers: request.lasers.len(),
        logs: scans.len(),
    };
    let (fixed, values) = model_of(request, &layout);
    let model = ScannerModel::new(&layout, &fixed, &values);
    let all_m = noise_of_all_m(scans, request.lasers.len());
    let weights = |noise_m| -> Vec<ShotWeights<'_>> {
        let scans = scans.iter();
        scans.map(|scan| ShotWeights::new(scan, noise_m)).collect()
    };
    let first = Patches::new(scans, &model, &weights(&all_m));
    // Edges and foliage raise the noise of all shots; these are of smooth surfaces.
    let noise_m = first.noise_m(scans, &all_m);
    let weigh = weights(&noise_m);
    let patches = Patches::new(scans, &model, &weigh);
    if patches.list.len() < MIN_PATCHES {
        return Err(CalibrationRefusal::FewPatches {
            patches: patches.list.len(),
            shots: scans.iter().map(Scan::len).sum(),
        });
    }
    let mut groups = bins::Groups::new(request);
    let mut sweeps = sweeps::SweepDifferences::default();
    let mut study = AccuracyStudy::default();
    let mut lasers = vec![(0.0, 0.0); layout.lasers];
    for patch in &patches.list {
        let (scan, frame) = (&scans[patch.log], &patch.frame);
        let rays = patch.shots.iter().map(|&index| {
            let ray = model.ray(&scan.shots[index as usize], patch.log);
            let weight = weigh[patch.log].weight(index as usize, &ray, frame.normal);
            (ray, frame.incidence(&ray, weight))
        });
        let (rays, incidences): (Vec<_>, Vec<Incidence>) = rays.unzip();
        let cut = CUT_SD * patches.scale;
        let Some(fit) = frame.fit(&incidences, patch.coefficients, cut) else {
            continue;
        };
        let freedom = fit.used.saturating_sub(COEFFICIENTS).max(1) as f64;
        let spread = (fit.used as f64 / freedom).sqrt();
        study.patches += 1;
        sweeps.begin(patch.log);
        for ((&index, ray), incidence) in patch.shots.iter().zip(&rays).zip(&incidences) {
            let residual = frame.residual(&fit.coefficients, incidence);
            if !residual.counts(incidence, cut) {
                continue;
            }
            let shot = &scan.shots[index as usize];
            let by_tilt = [ray.end[2], 0.0, -ray.end[0]];
            let on_element = ElementShot {
                residual_m: spread * residual.range_m,
                expected_m: 1.0 / incidence.weight().sqrt(),
                cosine: residual.cosine,
                by_tilt: dot(residual.normal, by_tilt) / residual.cosine,
            };
            study.shots += 1;
            let laser = &mut lasers[usize::from(shot.laser)];
            *laser = (laser.0 + residual.range_m, laser.1 + 1.0);
            groups.add(patch.log, shot, &on_element);
            sweeps.add(shot, &on_element);
        }
    }
    study.laser_offsets_m = lasers
        .iter()
        .map(|(sum, count)| (*count > 0.0).then(|| sum / count))
        .collect();
    study.groups = groups.result();
    study.sweeps = sweeps.result();
    study.stations = stations::pairs(&patches, scans.len());
    study.budget = budget::budget(request, &layout, &model, &noise_m);
    study.noise_m = noise_m;
    Ok(study)
}

/// The model of the request's mount and corrections.
fn model_of(request: &StudyRequest<'_>, layout: &Layout) -> (Fixed, Vec<f64>) {
    let [x, y, z] = request.mount.position_m();
    let [about_x, about_y, about_z] = request.mount.rotation_deg().map(f64::to_radians);
    let parameters = layout.parameters();
    let mut values: Vec<f64> = parameters
        .iter()
        .map(|p| {
            let known = request.corrections.iter().find(|(name, _)| *name == p.name);
            known.map_or(0.0, |(_, value)| value * p.si_per_unit)
        })
        .collect();
    values[layout.drift(0)..].fill(0.0);
    for (index, value) in [
        (ROTATION_X, about_x),
        (ROTATION_Z, about_z),
        (POSITION_X, x),
        (POSITION_Z, z),
    ] {
        values[index] = value;
    }
    let fixed = Fixed {
        rotation_y: about_y,
        position_y: y,
        ripple_periods: request.gear,
        lasers: request.lasers.to_vec(),
    };
    (fixed, values)
}
