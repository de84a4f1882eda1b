//! The estimator: elements, Gauss-Newton, and again until nothing moves.

mod bases;
mod stage_two;

use cloud::mount::Mount;

use crate::calibration::{
    BaseEvidence, CHI2, Calibration, CalibrationEvidence, CalibrationRefusal, MAX_LOOPS,
    MIN_PATCHES, ParameterEstimate,
};
use crate::equations::{Equations, Residuals, ShotWeights};
use crate::linear::{Cholesky, Matrix};
use crate::model::{Fixed, ScannerModel};
use crate::parameters::{
    DELAY, DEVICE, Layout, POSITION_X, POSITION_Z, Parameter, ROTATION_X, ROTATION_Z,
};
use crate::patches::{Patches, SETTLED_SCALE};
use crate::shots::{NominalLaser, Scan, noise_of_all_m};

/// A request for a calibration.
#[derive(Clone, Debug)]
pub struct CalibrationRequest<'a> {
    /// The logs. They share the scanner, not the surfaces.
    pub scans: &'a [Scan],
    /// Nominal lasers, as the scans were decoded.
    pub lasers: &'a [NominalLaser],
    /// The mount to start from. Its rotation about the tilt axis and its position along it stay.
    pub start: Mount,
    /// Turns of the motor per turn of the axis: periods of the ripple.
    pub gear: f64,
    /// Parameters that stay at their start: all whose names begin with one of these.
    pub fixed: &'a [String],
}

/// Steps of Gauss-Newton on the same elements: they are a guess until the parameters fit.
const COARSE_STEPS: usize = 2;
const FINE_STEPS: usize = 1;
/// The loops end when nothing moves by more than this, standard deviations.
const SETTLED_SD: f64 = 0.3;
/// Results of two starts agree within this many standard deviations, and the last loop moves
/// nothing by more.
const STARTS_AGREE_SD: f64 = 1.0;
/// The second start from the first: 2 deg, 20 mm, 1 ms.
const SECOND_START: [(usize, f64); 5] = [
    (ROTATION_X, 0.035),
    (ROTATION_Z, -0.035),
    (POSITION_X, 0.02),
    (POSITION_Z, -0.02),
    (DELAY, 1e-3),
];
/// The mean azimuth correction is the mount's rotation about z: its standard deviation.
const GAUGE_SD_RAD: f64 = 1e-9;
/// A solution on the elements of the last loop.
struct Solution {
    values: Vec<f64>,
    covariance: Matrix,
    /// The last equations, and the values before their step.
    equations: Equations,
    values_before: Vec<f64>,
    loops: usize,
    moves: Vec<f64>,
    noise_m: Vec<f64>,
    priors: Vec<f64>,
}

/// A step of Gauss-Newton from given values.
pub(crate) struct GaussNewtonStep {
    pub step: Vec<f64>,
    /// The covariance by the equations.
    pub formal: Matrix,
    /// The larger of that and the one by the scatter of the elements' gradients.
    pub covariance: Matrix,
}

/// One calibration in progress.
pub(crate) struct Estimator<'a> {
    request: &'a CalibrationRequest<'a>,
    pub layout: Layout,
    fixed: Fixed,
    parameters: Vec<Parameter>,
    /// Standard deviations before the scan, those of bases that may move; 0 for fixed parameters.
    pub priors: Vec<f64>,
    pub start: Vec<f64>,
    noise_m: Vec<f64>,
}

/// Calibrates. `progress` is called after each loop with its number and the largest move in
/// standard deviations; `true` ends the calibration.
///
/// # Errors
/// [`CalibrationRefusal`], with the evidence.
pub fn calibrate(
    request: &CalibrationRequest<'_>,
    progress: &mut dyn FnMut(usize, f64) -> bool,
) -> Result<Calibration, CalibrationRefusal> {
    let estimator = Estimator::new(request);
    let is_known = |name: &str| estimator.parameters.iter().any(|p| p.is_in(name));
    if let Some(name) = request.fixed.iter().find(|name| !is_known(name)) {
        let known = estimator
            .parameters
            .iter()
            .take(DEVICE)
            .map(|p| p.name.clone());
        return Err(CalibrationRefusal::UnknownParameter {
            name: name.clone(),
            known: known.chain(["laser".into(), "drift".into()]).collect(),
        });
    }
    let residuals = estimator.residuals(&estimator.start)?;
    let (mut solution, bases) = estimator.solve_first(progress)?;
    let second = estimator.second_start();
    let second = estimator.solve(&second, &solution.priors, Some(&solution), progress)?;
    estimator.compare(&solution, &second.values)?;
    estimator.flatten(&mut solution)?;
    Ok(estimator.result(solution, residuals, bases))
}

impl<'a> Estimator<'a> {
    pub fn new(request: &'a CalibrationRequest<'a>) -> Self {
        let layout = Layout {
            lasers: request.lasers.len(),
            logs: request.scans.len(),
        };
        let parameters = layout.parameters();
        let [x, y, z] = request.start.position_m();
        let [about_x, about_y, about_z] = request.start.rotation_deg().map(f64::to_radians);
        let mut start = vec![0.0; layout.len()];
        start[ROTATION_X] = about_x;
        start[ROTATION_Z] = about_z;
        start[POSITION_X] = x;
        start[POSITION_Z] = z;
        let is_fixed = |p: &Parameter| {
            let mut names = request.fixed.iter();
            names.any(|name| p.is_in(name))
        };
        let priors = parameters.iter();
        let priors = priors.map(|p| if is_fixed(p) { 0.0 } else { p.prior_sd });
        let priors = priors.collect();
        Self {
            request,
            layout,
            fixed: Fixed {
                rotation_y: about_y,
                position_y: y,
                ripple_periods: request.gear,
                lasers: request.lasers.to_vec(),
            },
            parameters,
            priors,
            start,
            noise_m: noise_of_all_m(request.scans, request.lasers.len()),
        }
    }

    /// Another start, as far off as a mount that was measured badly.
    fn second_start(&self) -> Vec<f64> {
        let mut values = self.start.clone();
        for (index, off) in SECOND_START {
            if self.priors[index] > 0.0 {
                values[index] += off;
            }
        }
        values
    }

    fn weights<'b>(&'b self, noise_m: &'b [f64]) -> Vec<ShotWeights<'b>> {
        let scans = self.request.scans.iter();
        scans.map(|scan| ShotWeights::new(scan, noise_m)).collect()
    }

    fn patches(&self, values: &[f64], noise_m: &[f64]) -> Result<Patches, CalibrationRefusal> {
        let model = ScannerModel::new(&self.layout, &self.fixed, values);
        let patches = Patches::new(self.request.scans, &model, &self.weights(noise_m));
        let found = patches.list.len();
        match found < MIN_PATCHES {
            false => Ok(patches),
            true => Err(CalibrationRefusal::FewPatches {
                patches: found,
                shots: self.request.scans.iter().map(Scan::len).sum(),
            }),
        }
    }

    fn equations(&self, patches: &Patches, values: &[f64], noise_m: &[f64]) -> Equations {
        let model = ScannerModel::new(&self.layout, &self.fixed, values);
        let (scans, layout) = (self.request.scans, &self.layout);
        Equations::new(scans, patches, layout, &model, &self.weights(noise_m))
    }

    /// Residuals under these values.
    fn residuals(&self, values: &[f64]) -> Result<Equations, CalibrationRefusal> {
        let patches = self.patches(values, &self.noise_m)?;
        Ok(self.equations(&patches, values, &self.noise_m))
    }

    /// Loops from `start` until nothing moves, or until the values agree with another solution.
    fn solve(
        &self,
        start: &[f64],
        priors: &[f64],
        other: Option<&Solution>,
        progress: &mut dyn FnMut(usize, f64) -> bool,
    ) -> Result<Solution, CalibrationRefusal> {
        let mut values = start.to_vec();
        let mut noise_m = self.noise_m.clone();
        let mut is_noise_of_surfaces = false;
        for loops in 1.. {
            let mut patches = self.patches(&values, &noise_m)?;
            if patches.scale <= 1.0 && !is_noise_of_surfaces {
                is_noise_of_surfaces = true;
                // Edges and foliage raise the noise of all shots; these are of smooth surfaces.
                noise_m = patches.noise_m(self.request.scans, &self.noise_m);
                patches = self.patches(&values, &noise_m)?;
            }
            let begin = values.clone();
            let mut last = None;
            let mut values_before = Vec::new();
            let steps = match patches.scale > 1.0 {
                true => COARSE_STEPS,
                false => FINE_STEPS,
            };
            for _ in 0..steps {
                let equations = self.equations(&patches, &values, &noise_m);
                let GaussNewtonStep {
                    step, covariance, ..
                } = self.step(&equations, &values, priors)?;
                values_before.clone_from(&values);
                for (value, step) in values.iter_mut().zip(step) {
                    *value += step;
                }
                last = Some((equations, covariance));
            }
            let Some((equations, covariance)) = last else {
                return Err(CalibrationRefusal::Singular);
            };
            let mut compared = (0..values.len()).filter(|&i| self.is_compared(i));
            if !compared.all(|i| covariance.at(i, i) > 0.0) {
                return Err(CalibrationRefusal::Singular);
            }
            let moves: Vec<f64> = (0..values.len())
                .map(|i| match self.is_compared(i) {
                    true => (values[i] - begin[i]).abs() / covariance.at(i, i).sqrt(),
                    false => 0.0,
                })
                .collect();
            let most = moves.iter().copied().fold(0.0, f64::max);
            if progress(loops, most) {
                return Err(CalibrationRefusal::Interrupted);
            }
            let agrees = other.is_some_and(|other| self.compare(other, &values).is_ok());
            let is_settled = (most < SETTLED_SD || agrees) && patches.scale < SETTLED_SCALE;
            if is_settled || loops == MAX_LOOPS {
                return Ok(Solution {
                    values,
                    covariance,
                    equations,
                    values_before,
                    loops,
                    moves,
                    noise_m,
                    priors: priors.to_vec(),
                });
            }
        }
        Err(CalibrationRefusal::Singular)
    }

    /// A step of Gauss-Newton with the priors, and the covariance of the parameters.
    pub fn step(
        &self,
        equations: &Equations,
        values: &[f64],
        priors: &[f64],
    ) -> Result<GaussNewtonStep, CalibrationRefusal> {
        let size = self.layout.len();
        // In units of the priors, which keeps the matrix well scaled.
        let unit = |i: usize| priors[i];
        let is_fixed = |i: usize| priors[i] == 0.0;
        let mut hessian = Matrix::zero(size);
        let mut scatter = Matrix::zero(size);
        let mut right = vec![0.0; size];
        for i in 0..size {
            if is_fixed(i) {
                *hessian.at_mut(i, i) = 1.0;
                continue;
            }
            right[i] = -equations.gradient[i] * unit(i) - (values[i] - self.start[i]) / unit(i);
            for j in (0..size).filter(|&j| !is_fixed(j)) {
                let units = unit(i) * unit(j);
                *hessian.at_mut(i, j) = equations.hessian.at(i, j) * units;
                *scatter.at_mut(i, j) = equations.scatter.at(i, j) * units;
            }
            *hessian.at_mut(i, i) += 1.0;
            *scatter.at_mut(i, i) += 1.0;
        }
        let azimuths = self.layout.azimuths();
        let mean: f64 = values[azimuths.clone()].iter().sum();
        for i in azimuths.clone().filter(|&i| !is_fixed(i)) {
            let count = self.layout.lasers as f64;
            let weight = 1.0 / (GAUGE_SD_RAD * count).powi(2);
            right[i] -= weight * mean * unit(i);
            for j in azimuths.clone().filter(|&j| !is_fixed(j)) {
                *hessian.at_mut(i, j) += weight * unit(i) * unit(j);
            }
        }
        let factor = Cholesky::new(&hessian).ok_or(CalibrationRefusal::Singular)?;
        factor.solve(&mut right);
        let step = right
            .iter()
            .enumerate()
            .map(|(i, step)| step * unit(i))
            .collect();
        let inverse = factor.inverse();
        let mut covariance = inverse.clone();
        let mut formal = inverse.clone();
        let robust = sandwich(&inverse, &scatter);
        for i in 0..size {
            for j in 0..size {
                let grow = |i: usize| (robust[i] / inverse.at(i, i)).max(1.0).sqrt();
                let free = !is_fixed(i) && !is_fixed(j);
                let units = if free {
                    unit(i) * unit(j) * grow(i) * grow(j)
                } else {
                    0.0
                };
                *covariance.at_mut(i, j) *= units;
                *formal.at_mut(i, j) *= if free { unit(i) * unit(j) } else { 0.0 };
            }
        }
        Ok(GaussNewtonStep {
            step,
            formal,
            covariance,
        })
    }

    /// Whether a parameter must settle and agree. A drift along all surfaces, as over a bare floor,
    /// moves with the noise of their normals, and is not part of the result.
    fn is_compared(&self, index: usize) -> bool {
        self.priors[index] > 0.0 && index < self.layout.drift(0)
    }

    /// Refuses parameters that still move.
    fn check_settled(&self, solution: &Solution) -> Result<(), CalibrationRefusal> {
        let moves = solution.moves.iter().copied().enumerate();
        match moves.max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((index, moves_sd)) if moves_sd >= STARTS_AGREE_SD => {
                Err(CalibrationRefusal::NotSettled {
                    name: self.parameters[index].name.clone(),
                    moves_sd,
                })
            }
            _ => Ok(()),
        }
    }

    /// Refuses residuals that the model does not describe.
    fn check_fit(&self, solution: &Solution) -> Result<(), CalibrationRefusal> {
        let chi2 = self.chi2(&solution.equations);
        match (CHI2[0]..=CHI2[1]).contains(&chi2) {
            true => Ok(()),
            false => Err(CalibrationRefusal::Misfit { chi2 }),
        }
    }

    /// Refuses results that depend on the start.
    fn compare(&self, solution: &Solution, second: &[f64]) -> Result<(), CalibrationRefusal> {
        let off = |index: usize| {
            let off = solution.values[index] - second[index];
            off.abs() / solution.covariance.at(index, index).sqrt()
        };
        let free = (0..self.layout.len()).filter(|&index| self.is_compared(index));
        let worst = free.max_by(|&a, &b| off(a).total_cmp(&off(b)));
        match worst.map(|index| (index, off(index))) {
            Some((index, sds)) if sds > STARTS_AGREE_SD || sds.is_nan() => {
                Err(CalibrationRefusal::StartsDisagree {
                    name: self.parameters[index].name.clone(),
                    sds,
                })
            }
            _ => Ok(()),
        }
    }

    fn chi2(&self, equations: &Equations) -> f64 {
        let free = self.priors.iter().filter(|prior| **prior > 0.0).count() as f64;
        equations.squares / (equations.freedom - free).max(1.0)
    }

    fn result(
        &self,
        solution: Solution,
        before: Equations,
        bases: Vec<BaseEvidence>,
    ) -> Calibration {
        let Solution {
            values,
            covariance,
            equations,
            loops,
            moves,
            noise_m,
            priors,
            ..
        } = solution;
        let size = values.len();
        let unit = |i: usize| self.parameters[i].si_per_unit;
        let mut scaled = vec![0.0; size * size];
        for i in 0..size {
            for j in 0..size {
                scaled[i * size + j] = covariance.at(i, j) / (unit(i) * unit(j));
            }
        }
        let sd = |i: usize| covariance.at(i, i).sqrt();
        let correlation = |i: usize| {
            let others = (0..size).filter(|&j| j != i && sd(i) > 0.0 && sd(j) > 0.0);
            let others = others.map(|j| (j, covariance.at(i, j) / (sd(i) * sd(j))));
            let strongest = others.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            strongest.map(|(j, r)| (self.parameters[j].name.clone(), r))
        };
        let parameters = self
            .parameters
            .iter()
            .enumerate()
            .map(|(i, p)| ParameterEstimate {
                kind: p.kind,
                name: p.name.clone(),
                value: values[i] / unit(i),
                sd: sd(i) / unit(i),
                posterior_over_prior: if priors[i] > 0.0 {
                    sd(i) / priors[i]
                } else {
                    0.0
                },
                correlation: correlation(i),
                at_20_m: [values[i] - self.start[i], sd(i)].map(|error| error.abs() * p.m_at_20_m),
            });
        let chi2 = self.chi2(&equations);
        Calibration {
            parameters: parameters.collect(),
            covariance: scaled,
            evidence: CalibrationEvidence {
                loops,
                last_move_sd: moves.iter().copied().fold(0.0, f64::max),
                patches: equations.patches,
                shots: equations.shots,
                chi2,
                noise_m,
                bases,
                before_m: before.lasers.iter().map(mean_and_rms).collect(),
                after_m: equations.lasers.iter().map(mean_and_rms).collect(),
                rms_m: [rms(&before.lasers), rms(&equations.lasers)],
                patches_m: [before.patch_rms_m, equations.patch_rms_m],
            },
            layout: self.layout.clone(),
            fixed: self.fixed.clone(),
            values,
        }
    }
}

/// Diagonal of A^-1 S A^-1.
fn sandwich(inverse: &Matrix, scatter: &Matrix) -> Vec<f64> {
    let size = inverse.size;
    let mut product = Matrix::zero(size);
    for i in 0..size {
        for k in 0..size {
            let factor = inverse.at(i, k);
            for j in 0..size {
                product.values[i * size + j] += factor * scatter.at(k, j);
            }
        }
    }
    let entry = |i: usize| (0..size).map(|j| product.at(i, j) * inverse.at(i, j)).sum();
    (0..size).map(entry).collect()
}

fn mean_and_rms(residuals: &Residuals) -> [f64; 2] {
    let shots = residuals.shots.max(1) as f64;
    [
        residuals.sum_m / shots,
        (residuals.squares_m2 / shots).sqrt(),
    ]
}

fn rms(lasers: &[Residuals]) -> f64 {
    let shots: u64 = lasers.iter().map(|laser| laser.shots).sum();
    let squares: f64 = lasers.iter().map(|laser| laser.squares_m2).sum();
    (squares / shots.max(1) as f64).sqrt()
}
