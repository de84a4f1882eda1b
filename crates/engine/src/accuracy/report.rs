//! The object of `velomotion accuracy --json`.

use calibration::{BudgetBin, ResidualBin, StationPair, SweepPair};
use serde::Serialize;
use utoipa::ToSchema;

use super::AccuracyResult;
use crate::calibrate::LogReport;

/// Report of a study of accuracy.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct AccuracyReport {
    /// The logs.
    pub logs: Vec<LogReport>,
    /// Model of the lidar.
    pub model: String,
    /// Whether the devices were simulated.
    pub simulated: bool,
    /// Whether the points have a calibration.
    pub calibrated: bool,
    /// Surface elements.
    pub patches: usize,
    /// Shots on them.
    pub shots: usize,
    /// Noise and offset of each laser.
    pub lasers: Vec<LaserNoise>,
    /// Residuals of ranges by what they may depend on.
    pub residuals: Vec<ResidualGroup>,
    /// Sweeps against the next ones of their log.
    pub sweeps: Vec<SweepDifference>,
    /// Distances of corners that two logs see.
    pub stations: Vec<StationReport>,
    /// Errors of points by their distance, each alone and all together.
    pub budget: Vec<BudgetReport>,
    /// Points that no surface returned, such as echoes of fog: they have no error; null without a
    /// truth.
    pub points_without_truth: Option<usize>,
    /// Points compared with the truth, these included; null without one.
    pub points: Option<usize>,
}

/// A laser.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct LaserNoise {
    /// Index in firing order.
    pub laser: usize,
    /// Standard deviation of its ranges between neighbouring shots, millimetres; none without shots
    /// on elements.
    pub noise_mm: Option<f64>,
    /// Mean residual against elements that other lasers meet too, millimetres.
    pub offset_mm: Option<f64>,
}

/// Residuals by one quantity.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct ResidualGroup {
    /// The quantity, with its unit.
    pub by: String,
    /// Its bins.
    pub bins: Vec<ResidualReport>,
}

/// Residuals of a bin.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct ResidualReport {
    /// The quantity from here on.
    pub from: f64,
    /// Up to here.
    pub to: f64,
    /// Shots.
    pub shots: u64,
    /// Mean residual.
    pub mean_mm: f64,
    /// Root mean square.
    pub rms_mm: f64,
    /// What noise and steps of angles let expect.
    pub expected_mm: f64,
    /// Against the truth, if it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<PointErrors>,
}

/// Errors of points against the truth.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct PointErrors {
    /// Root mean square error.
    pub rms_mm: f64,
    /// Root mean square of the stated standard deviations.
    pub stated_mm: f64,
    /// Root mean square of error over stated standard deviation.
    pub error_over_sd: f64,
}

/// Two sweeps of a log, by the elements that both meet.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct SweepDifference {
    /// The log, from 1.
    pub log: usize,
    /// Number of the first sweep, from 1.
    pub first: usize,
    /// Number of the second.
    pub second: usize,
    /// Whether they went opposite ways.
    pub both_ways: bool,
    /// Elements.
    pub patches: usize,
    /// Mean difference of ranges, second less first.
    pub mean_mm: f64,
    /// Root mean square difference of elements.
    pub rms_mm: f64,
    /// What the noise of their shots lets expect.
    pub expected_mm: f64,
    /// Tilt by which the second is ahead.
    pub tilt_mdeg: f64,
    /// Standard deviation of that.
    pub tilt_sd_mdeg: f64,
}

/// Two logs that see the same corners.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct StationReport {
    /// The first log, from 1.
    pub first: usize,
    /// The second.
    pub second: usize,
    /// Common corners.
    pub corners: usize,
    /// Distances between them.
    pub distances: usize,
    /// The shortest.
    pub shortest_m: f64,
    /// The longest.
    pub longest_m: f64,
    /// Mean difference, second less first.
    pub mean_mm: f64,
    /// Root mean square difference.
    pub rms_mm: f64,
    /// Largest difference.
    pub worst_mm: f64,
}

/// Errors of points in a range of distances, root mean squares in millimetres.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct BudgetReport {
    /// Range from here on.
    pub from_m: f64,
    /// Up to here.
    pub to_m: f64,
    /// Noise of ranges, measured.
    pub range_mm: f64,
    /// Steps of azimuths, derived.
    pub azimuth_mm: f64,
    /// Fit of the tilt, by the residuals of its samples.
    pub tilt_mm: f64,
    /// The lidar's clock, by its bound.
    pub clock_mm: f64,
    /// Mount, by the covariance of its calibration; null without one, as the next three.
    pub mount_mm: Option<f64>,
    /// Delay, scale, ripple and play of the axis.
    pub axis_mm: Option<f64>,
    /// Constants of the lasers.
    pub lasers_mm: Option<f64>,
    /// Mount, axis and lasers together, with their correlations.
    pub calibration_mm: Option<f64>,
    /// All together.
    pub total_mm: f64,
}

impl AccuracyReport {
    /// The report of a study.
    #[must_use]
    pub fn new(studied: &AccuracyResult) -> Self {
        let study = &studied.study;
        let logs = studied.logs.iter().map(|(path, shots)| LogReport {
            path: path.display().to_string(),
            shots: *shots,
        });
        let lasers = study.noise_m.iter().zip(&study.laser_offsets_m).enumerate();
        let lasers = lasers.map(|(laser, (noise_m, offset_m))| LaserNoise {
            laser,
            noise_mm: offset_m.map(|_| 1e3 * noise_m),
            offset_mm: offset_m.map(|offset_m| 1e3 * offset_m),
        });
        let group = |group: &calibration::BinGroup| ResidualGroup {
            by: group.name.to_owned(),
            bins: group.bins.iter().map(ResidualReport::new).collect(),
        };
        Self {
            logs: logs.collect(),
            model: studied.model.name.to_owned(),
            simulated: studied.simulated,
            calibrated: studied.calibrated,
            patches: study.patches,
            shots: study.shots,
            lasers: lasers.collect(),
            residuals: study.groups.iter().map(group).collect(),
            sweeps: study.sweeps.iter().map(SweepDifference::new).collect(),
            stations: study.stations.iter().map(StationReport::new).collect(),
            budget: study.budget.iter().map(BudgetReport::new).collect(),
            points_without_truth: studied.without_truth.map(|[without, _]| without),
            points: studied.without_truth.map(|[_, points]| points),
        }
    }
}

impl ResidualReport {
    fn new(bin: &ResidualBin) -> Self {
        Self {
            from: bin.from,
            to: bin.to,
            shots: bin.shots,
            mean_mm: 1e3 * bin.mean_m,
            rms_mm: 1e3 * bin.rms_m,
            expected_mm: 1e3 * bin.expected_m,
            truth: bin.truth.map(|[error_m, sd_m, error_over_sd]| PointErrors {
                rms_mm: 1e3 * error_m,
                stated_mm: 1e3 * sd_m,
                error_over_sd,
            }),
        }
    }
}

impl SweepDifference {
    fn new(pair: &SweepPair) -> Self {
        let [first, second] = pair.sweeps.map(|sweep| sweep + 1);
        let [tilt_mdeg, tilt_sd_mdeg] = pair.tilt_rad.map(|rad| 1e3 * rad.to_degrees());
        Self {
            log: pair.log + 1,
            first,
            second,
            both_ways: pair.both_ways,
            patches: pair.patches,
            mean_mm: 1e3 * pair.mean_m,
            rms_mm: 1e3 * pair.rms_m,
            expected_mm: 1e3 * pair.expected_m,
            tilt_mdeg,
            tilt_sd_mdeg,
        }
    }
}

impl StationReport {
    fn new(pair: &StationPair) -> Self {
        let [first, second] = pair.logs.map(|log| log + 1);
        let [shortest_m, longest_m] = pair.lengths_m;
        Self {
            first,
            second,
            corners: pair.corners,
            distances: pair.distances,
            shortest_m,
            longest_m,
            mean_mm: 1e3 * pair.mean_m,
            rms_mm: 1e3 * pair.rms_m,
            worst_mm: 1e3 * pair.worst_m,
        }
    }
}

impl BudgetReport {
    fn new(bin: &BudgetBin) -> Self {
        let mm = |m: f64| 1e3 * m;
        Self {
            from_m: bin.from_m,
            to_m: bin.to_m,
            range_mm: mm(bin.range_m),
            azimuth_mm: mm(bin.azimuth_m),
            tilt_mm: mm(bin.tilt_m),
            clock_mm: mm(bin.clock_m),
            mount_mm: bin.mount_m.map(mm),
            axis_mm: bin.axis_m.map(mm),
            lasers_mm: bin.lasers_m.map(mm),
            calibration_mm: bin.calibration_m.map(mm),
            total_mm: mm(bin.total_m),
        }
    }
}
