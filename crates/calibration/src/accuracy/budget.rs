//! Errors of points by their distance: each alone, and all together.

use super::StudyRequest;
use crate::linear::{Matrix, dot};
use crate::model::ScannerModel;
use crate::parameters::{DELAY, DEVICE, Layout};
use crate::shots::AZIMUTH_SD_RAD;

/// Errors of angles that residuals do not show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct AngleErrors {
    /// Standard deviation of the fitted tilt, radians.
    pub tilt_sd_rad: f64,
    /// Standard deviation of the lidar's clock, seconds.
    pub clock_sd_s: f64,
}

/// The covariance of calibrated parameters.
#[derive(Clone, Copy, Debug)]
pub struct KnownCovariance<'a> {
    /// Names of the parameters.
    pub names: &'a [String],
    /// Their covariance by rows, in the units of their names.
    pub covariance: &'a [f64],
}

/// Errors of points in a range of distances: root mean squares over three dimensions, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BudgetBin {
    /// Range from here on, metres.
    pub from_m: f64,
    /// Up to here.
    pub to_m: f64,
    /// Shots.
    pub shots: u64,
    /// Noise of ranges, as measured.
    pub range_m: f64,
    /// Steps of azimuths, derived.
    pub azimuth_m: f64,
    /// Fit of the tilt.
    pub tilt_m: f64,
    /// The lidar's clock.
    pub clock_m: f64,
    /// Mount; `None` without a calibration, as the next ones.
    pub mount_m: Option<f64>,
    /// Delay, scale, ripple and play of the axis.
    pub axis_m: Option<f64>,
    /// Constants of the lasers.
    pub lasers_m: Option<f64>,
    /// Mount, axis and lasers together, with their correlations.
    pub calibration_m: Option<f64>,
    /// All together.
    pub total_m: f64,
}

/// Edges of the bins, metres.
const EDGES_M: [f64; 7] = [0.0, 5.0, 10.0, 20.0, 30.0, 50.0, 300.0];
/// One shot in as many is looked at.
const EVERY: usize = 61;
/// Mean square of the weights of two azimuths between which a firing's is interpolated.
const INTERPOLATED: f64 = 2.0 / 3.0;

pub(super) fn budget(
    request: &StudyRequest<'_>,
    layout: &Layout,
    model: &ScannerModel<'_>,
    noise_m: &[f64],
) -> Vec<BudgetBin> {
    let covariance = request.covariance.map(|known| in_order(&known, layout));
    let groups = [0..DELAY, DELAY..DEVICE, DEVICE..DEVICE + 3, 0..DEVICE + 3];
    let mut sums = vec![(0.0, [0.0; 8]); EDGES_M.len() - 1];
    for (log, scan) in request.scans.iter().enumerate() {
        for shot in scan.shots.iter().step_by(EVERY) {
            let bin = EDGES_M
                .partition_point(|edge| *edge <= shot.range_m)
                .saturating_sub(1);
            let Some((count, sums)) = sums.get_mut(bin) else {
                continue;
            };
            let laser = usize::from(shot.laser);
            let (ray, slopes) = model.ray_and_slopes(shot, log);
            let elevation = request.lasers[laser].elevation_deg.to_radians();
            let across2 = (shot.range_m * elevation.cos() * AZIMUTH_SD_RAD).powi(2);
            let arm2 = ray.end[0].powi(2) + ray.end[2].powi(2);
            let clock = shot.rate_rad_s * request.angles.clock_sd_s;
            let mut terms = [
                noise_m[laser].powi(2),
                INTERPOLATED * across2,
                arm2 * request.angles.tilt_sd_rad.powi(2),
                arm2 * clock * clock,
                0.0,
                0.0,
                0.0,
                0.0,
            ];
            if let Some(covariance) = &covariance {
                let index = |column| ScannerModel::index(layout, column, laser, log);
                for (term, columns) in terms[4..].iter_mut().zip(&groups) {
                    for i in columns.clone() {
                        for j in columns.clone() {
                            *term += dot(slopes[i], slopes[j]) * covariance.at(index(i), index(j));
                        }
                    }
                }
            }
            *count += 1.0;
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += term;
            }
        }
    }
    let bins = EDGES_M
        .windows(2)
        .zip(sums)
        .filter(|(_, (count, _))| *count > 0.0);
    let bin = |(edges, (count, sums)): (&[f64], (f64, [f64; 8]))| {
        let root = |index: usize| (sums[index] / count).max(0.0).sqrt();
        let known = |index: usize| covariance.is_some().then(|| root(index));
        let together = sums[..4].iter().sum::<f64>() + sums[7];
        BudgetBin {
            from_m: edges[0],
            to_m: edges[1],
            shots: count as u64,
            range_m: root(0),
            azimuth_m: root(1),
            tilt_m: root(2),
            clock_m: root(3),
            mount_m: known(4),
            axis_m: known(5),
            lasers_m: known(6),
            calibration_m: known(7),
            total_m: (together / count).max(0.0).sqrt(),
        }
    };
    bins.map(bin).collect()
}

/// The covariance in the order of the layout, SI; 0 for what it does not name.
fn in_order(known: &KnownCovariance<'_>, layout: &Layout) -> Matrix {
    let parameters = layout.parameters();
    let places: Vec<Option<usize>> = parameters
        .iter()
        .map(|p| known.names.iter().position(|name| *name == p.name))
        .collect();
    let mut matrix = Matrix::zero(layout.len());
    for (i, a) in places.iter().enumerate() {
        for (j, b) in places.iter().enumerate() {
            if let (Some(a), Some(b)) = (a, b) {
                let units = parameters[i].si_per_unit * parameters[j].si_per_unit;
                let index = a * known.names.len() + b;
                *matrix.at_mut(i, j) = units * known.covariance.get(index).copied().unwrap_or(0.0);
            }
        }
    }
    matrix
}
