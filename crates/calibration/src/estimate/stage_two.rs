//! The second stage: the flatness of large surfaces.

use super::{Estimator, Solution};
use crate::calibration::CalibrationRefusal;
use crate::flatness::{COMMON_SD_M, WallElement, flatness};
use crate::linear::{add, dot};
use crate::model::ScannerModel;
use crate::patches::SurfacePatch;

impl Estimator<'_> {
    /// Adds what the flatness of large surfaces says, of the common range of all lasers above all.
    pub(super) fn flatten(&self, solution: &mut Solution) -> Result<(), CalibrationRefusal> {
        let size = self.layout.len();
        let ranges = self.layout.range(0)..self.layout.range(self.layout.lasers);
        if ranges.clone().any(|index| self.priors[index] == 0.0) {
            return Ok(());
        }
        // Covariance of the mean range with every parameter, and its variance.
        let share = 1.0 / self.layout.lasers as f64;
        let row = |i: usize| {
            ranges
                .clone()
                .map(|j| solution.covariance.at(i, j))
                .sum::<f64>()
        };
        let with_mean: Vec<f64> = (0..size).map(|i| share * row(i)).collect();
        let variance: f64 = share * ranges.clone().map(|i| with_mean[i]).sum::<f64>();
        let step_m = 1e-4;
        let moved = solution.values.iter().zip(&with_mean);
        let moved: Vec<f64> = moved.map(|(v, c)| v + step_m * c / variance).collect();
        let patches = self.patches(&solution.values, &solution.noise_m)?;
        let models =
            [&solution.values, &moved].map(|v| ScannerModel::new(&self.layout, &self.fixed, v));
        let elements: Vec<WallElement> = patches
            .list
            .iter()
            .enumerate()
            .map(|(number, patch)| {
                let shots = &self.request.scans[patch.log].shots;
                let [centre, there] = models.each_ref().map(|model| {
                    let ends = patch.shots.iter();
                    let ends = ends.map(|&shot| model.ray(&shots[shot as usize], patch.log).end);
                    let sum = ends.fold([0.0; 3], |sum, end| add(sum, 1.0, end));
                    sum.map(|sum| sum / patch.shots.len() as f64)
                });
                WallElement {
                    log: patch.log,
                    centre,
                    slope: add(there, -1.0, centre).map(|part| part / step_m),
                    normal: patch.frame.normal,
                    shots: patch.shots.len(),
                    number,
                }
            })
            .collect();
        let slopes: Vec<Vec<f64>> = patches
            .list
            .iter()
            .map(|patch| self.height_slopes(&models[0], patch))
            .collect();
        let mut moves = vec![0.0; size];
        for measured in flatness(&elements, &slopes) {
            // A scalar update of Kalman's filter.
            let covariance = &solution.covariance;
            let with: Vec<f64> = (0..size)
                .map(|i| {
                    (0..size)
                        .map(|j| covariance.at(i, j) * measured.slopes[j])
                        .sum()
                })
                .collect();
            let along =
                |v: &[f64]| -> f64 { measured.slopes.iter().zip(v).map(|(a, b)| a * b).sum() };
            let innovation = along(&with) + measured.variance_m2;
            let gain = -(measured.height_m + along(&moves)) / innovation;
            for i in 0..size {
                moves[i] += gain * with[i];
                for j in 0..size {
                    *solution.covariance.at_mut(i, j) -= with[i] * with[j] / innovation;
                }
            }
        }
        if moves.iter().all(|change| *change == 0.0) {
            return Ok(());
        }
        for (value, change) in solution.values.iter_mut().zip(&moves) {
            *value += change;
        }
        let floor = (COMMON_SD_M / variance).powi(2);
        for i in 0..size {
            for j in 0..size {
                *solution.covariance.at_mut(i, j) += floor * with_mean[i] * with_mean[j];
            }
        }
        Ok(())
    }

    /// Change of an element's height by each parameter.
    fn height_slopes(&self, model: &ScannerModel<'_>, patch: &SurfacePatch) -> Vec<f64> {
        let mut slopes = vec![0.0; self.layout.len()];
        let share = 1.0 / patch.shots.len() as f64;
        for &index in &patch.shots {
            let shot = &self.request.scans[patch.log].shots[index as usize];
            let (_, by_column) = model.ray_and_slopes(shot, patch.log);
            for (column, slope) in by_column.into_iter().enumerate() {
                let laser = usize::from(shot.laser);
                let place = ScannerModel::index(&self.layout, column, laser, patch.log);
                slopes[place] += share * dot(patch.frame.normal, slope);
            }
        }
        slopes
    }
}
