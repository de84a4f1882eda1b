//! Residuals of shots by what they may depend on.

use super::{ElementShot, StudyRequest};
use crate::shots::RangeShot;

/// The error of a point against a truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointError {
    /// Distance from the true point, metres; NaN where there is none.
    pub error_m: f64,
    /// The point's stated standard deviation, metres.
    pub sd_m: f64,
}

/// Residuals by one quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct BinGroup {
    /// The quantity, with its unit.
    pub name: &'static str,
    /// Its bins that have shots.
    pub bins: Vec<ResidualBin>,
}

/// The residuals of a bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ResidualBin {
    /// The quantity from here on.
    pub from: f64,
    /// Up to here.
    pub to: f64,
    /// Shots.
    pub shots: u64,
    /// Mean residual, metres.
    pub mean_m: f64,
    /// Root mean square, metres.
    pub rms_m: f64,
    /// Root mean square expected from noise and pointing, metres.
    pub expected_m: f64,
    /// Root mean square of the points' errors against the truth and of their stated standard
    /// deviations, metres, and of the first over the second.
    pub truth: Option<[f64; 3]>,
}

/// Sums of a bin: shots, residuals, their squares, expected squares; true ones: count, errors,
/// stated deviations, both's ratio, squared.
type Sums = [f64; 8];

pub(super) struct Groups<'a> {
    truth: &'a [Vec<PointError>],
    kinds: Vec<(BinKind, Vec<f64>, Vec<Sums>)>,
}

#[derive(Clone, Copy)]
enum BinKind {
    Range,
    Incidence,
    Tilt,
    Speed,
    Laser,
    Reflectivity,
    Time,
}

impl BinKind {
    const fn name(self) -> &'static str {
        match self {
            Self::Range => "range_m",
            Self::Incidence => "incidence_deg",
            Self::Tilt => "tilt_deg",
            Self::Speed => "speed_deg_s",
            Self::Laser => "laser",
            Self::Reflectivity => "reflectivity",
            Self::Time => "time_s",
        }
    }

    fn of(self, shot: &RangeShot, on_element: &ElementShot) -> f64 {
        match self {
            Self::Range => shot.range_m,
            Self::Incidence => on_element.cosine.abs().min(1.0).acos().to_degrees(),
            Self::Tilt => shot.tilt_rad.to_degrees(),
            Self::Speed => shot.rate_rad_s.to_degrees().abs(),
            Self::Laser => f64::from(shot.laser),
            Self::Reflectivity => f64::from(shot.reflectivity),
            Self::Time => shot.time_s,
        }
    }
}

/// Bins of the time.
const TIMES: usize = 10;

impl<'a> Groups<'a> {
    pub fn new(request: &StudyRequest<'a>) -> Self {
        let shots = || request.scans.iter().flat_map(|scan| &scan.shots);
        let end_s = shots().map(|shot| shot.time_s).fold(1e-3, f64::max);
        let steps = |from: f64, step: f64, count: usize| -> Vec<f64> {
            (0..=count)
                .map(|index| from + step * index as f64)
                .collect()
        };
        // The speeds of real sweeps, and beyond.
        let speeds = vec![0.0, 2.0, 7.5, 15.0, 30.0, 45.0, 70.0, 150.0, 1e4];
        let kinds = [
            (
                BinKind::Range,
                vec![0.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 50.0, 300.0],
            ),
            (BinKind::Incidence, steps(0.0, 15.0, 6)),
            (BinKind::Tilt, steps(-180.0, 10.0, 36)),
            (BinKind::Speed, speeds),
            (BinKind::Laser, steps(0.0, 1.0, request.lasers.len())),
            (
                BinKind::Reflectivity,
                vec![0.0, 10.0, 25.0, 50.0, 101.0, 256.0],
            ),
            (
                BinKind::Time,
                steps(-end_s, 2.0 * end_s / TIMES as f64, TIMES),
            ),
        ];
        Self {
            truth: request.truth,
            kinds: kinds
                .into_iter()
                .map(|(kind, edges)| {
                    let sums = vec![[0.0; 8]; edges.len() - 1];
                    (kind, edges, sums)
                })
                .collect(),
        }
    }

    pub fn add(&mut self, log: usize, shot: &RangeShot, on_element: &ElementShot) {
        let truth = self
            .truth
            .get(log)
            .and_then(|all| all.get(shot.point as usize));
        let truth = truth.filter(|known| known.error_m.is_finite() && known.sd_m > 0.0);
        let (residual, expected) = (on_element.residual_m, on_element.expected_m);
        for (kind, edges, sums) in &mut self.kinds {
            let value = kind.of(shot, on_element);
            let bin = edges
                .partition_point(|edge| *edge <= value)
                .saturating_sub(1);
            let Some(sums) = sums.get_mut(bin) else {
                continue;
            };
            let known = truth.map_or([0.0; 4], |known| {
                let ratio = known.error_m / known.sd_m;
                [
                    1.0,
                    known.error_m.powi(2),
                    known.sd_m.powi(2),
                    ratio * ratio,
                ]
            });
            let [one, error, sd, ratio] = known;
            let all = [
                1.0,
                residual,
                residual * residual,
                expected * expected,
                one,
                error,
                sd,
                ratio,
            ];
            for (sum, value) in sums.iter_mut().zip(all) {
                *sum += value;
            }
        }
    }

    pub fn result(self) -> Vec<BinGroup> {
        let group = |(kind, edges, sums): (BinKind, Vec<f64>, Vec<Sums>)| {
            let bins = edges.windows(2).zip(sums).filter(|(_, sums)| sums[0] > 0.0);
            // From the beginning of the log on.
            let zero = if matches!(kind, BinKind::Time) {
                edges[0]
            } else {
                0.0
            };
            let bins = bins.map(|(edges, sums)| {
                let root = |sum: usize, count: usize| (sums[sum] / sums[count]).sqrt();
                ResidualBin {
                    from: edges[0] - zero,
                    to: edges[1] - zero,
                    shots: sums[0] as u64,
                    mean_m: sums[1] / sums[0],
                    rms_m: root(2, 0),
                    expected_m: root(3, 0),
                    truth: (sums[4] > 0.0).then(|| [root(5, 4), root(6, 4), root(7, 4)]),
                }
            });
            BinGroup {
                name: kind.name(),
                bins: bins.collect(),
            }
        };
        self.kinds.into_iter().map(group).collect()
    }
}
