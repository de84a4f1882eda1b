//! The search for a setting: every one in the order of its scan time.

use rayon::prelude::*;

use super::deciding::Examiners;
use super::{PlanRow, PlannedScan, ScanPredictor};

/// Requested limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanLimits {
    /// Error of 95 % of points at the range, millimetres.
    pub error_mm: Option<f64>,
    /// Distance from a direction to the nearest point, for 99 % of directions in view, degrees.
    pub gap_deg: Option<f64>,
    /// Time of the scan with homing, seconds.
    pub time_s: Option<f64>,
}

/// One of the limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitKind {
    /// The error.
    Error,
    /// The gap.
    Gap,
    /// The time.
    Time,
}

/// Scan that comes nearest to a limit which none keeps.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct NearestScan {
    /// The limit.
    pub limit: LimitKind,
    /// Whether it keeps others.
    pub with_others: bool,
    /// The least value that there is: millimetres, degrees or seconds.
    pub least: f64,
    /// Predicted results of the scan.
    pub row: PlanRow,
}

/// Stride through the directions that rank settings, of which the best are compared anew.
const RANKING_STRIDE: usize = 31;
/// Ratio of a gap to the least one that counts as reaching it.
pub(super) const NEARLY_LEAST: f64 = 1.04;
/// Factor by which a limit is widened where a choice by its own margin finds none.
const MARGIN: f64 = 1.01;
/// Ratio of a time to the shortest one that counts as reaching it.
const NEARLY_FASTEST: f64 = 1.03;
/// Ratio of times that are alike.
const ALIKE: f64 = 1.01;
/// Number of scans of alike times that are examined at all azimuths at the start: those with the
/// fewest directions without a point at the first one. With 16, choices took the same time to 1 %.
const HOPEFUL: usize = 4;
/// Settings of which the densest is chosen by some of the directions, and of these by all.
const FINALISTS: (usize, usize) = (12, 2);
/// Part of the given time below which scans are not compared for their density.
const SHORT: f64 = 0.6;

/// A scan that keeps a gap, and the azimuths at the starts of its sweeps that decided on it.
struct DecidedScan<'a> {
    scan: &'a PlannedScan,
    azimuths: Vec<Vec<f64>>,
}

impl ScanPredictor {
    /// The fastest scan, to 1 %, within the limits, or a faster one of those `nearby`; with a limit
    /// of time only, the densest; with one of the error only, the densest of the fastest. `None` if
    /// there is none, or no limit.
    #[must_use]
    pub fn choose(
        &self,
        scans: &[PlannedScan],
        nearby: impl Fn(&PlannedScan) -> Vec<PlannedScan>,
        limits: &PlanLimits,
    ) -> Option<PlanRow> {
        let most_s = limits.time_s.unwrap_or(f64::INFINITY);
        if let Some(gap_deg) = limits.gap_deg {
            let within = |most_s| self.fastest_nearby(scans, &nearby, limits, (gap_deg, most_s));
            let row = within(f64::INFINITY)?;
            return match row.scan_s {
                scan_s if scan_s <= most_s => Some(row),
                // Another of alike times may keep the time.
                scan_s if scan_s <= ALIKE * most_s => within(most_s),
                _ => None,
            };
        }
        let mut scans = self.accurate(scans, limits);
        scans.retain(|scan| scan.scan_s <= most_s);
        match (limits.error_mm, limits.time_s) {
            (Some(_), _) => self.densest_of_fastest(scans),
            (None, Some(time_s)) => self.densest(scans, time_s),
            (None, None) => None,
        }
    }

    /// The fastest scan, to 1 %, within a gap, a time and the limit of the error, or a faster one
    /// of those `nearby`.
    fn fastest_nearby(
        &self,
        scans: &[PlannedScan],
        nearby: impl Fn(&PlannedScan) -> Vec<PlannedScan>,
        limits: &PlanLimits,
        (gap_deg, most_s): (f64, f64),
    ) -> Option<PlanRow> {
        let mut scans = self.accurate(scans, limits);
        scans.retain(|scan| scan.scan_s <= most_s);
        let mut examiners = self.examiners();
        let found = self.fastest_within(&scans, gap_deg, &mut examiners)?;
        let mut faster = nearby(found.scan);
        faster.retain(|scan| scan.scan_s < found.scan.scan_s);
        let faster = self.fastest_within(&self.accurate(&faster, limits), gap_deg, &mut examiners);
        Some(self.row_of(faster.as_ref().unwrap_or(&found)))
    }

    /// The fastest of the scans that come nearest to a limit which none keeps, if
    /// [`Self::choose`] finds none.
    #[must_use]
    pub fn nearest(
        &self,
        scans: &[PlannedScan],
        nearby: impl Fn(&PlannedScan) -> Vec<PlannedScan>,
        limits: &PlanLimits,
    ) -> Option<NearestScan> {
        let error_mm = |scan: &PlannedScan| self.errors.budget(&self.lidar, &scan.sweeps).total;
        let least_mm = scans.iter().map(error_mm).fold(f64::INFINITY, f64::min);
        if limits.error_mm.is_some_and(|limit| least_mm > limit) {
            let near = PlanLimits {
                error_mm: Some(NEARLY_LEAST * least_mm),
                ..*limits
            };
            let near = self.accurate(scans, &near);
            let fastest = *near.first()?;
            let row = match limits.gap_deg {
                None => self.row(fastest),
                Some(gap_deg) => match self.fastest_within(&near, gap_deg, &mut self.examiners()) {
                    Some(found) => self.row_of(&found),
                    None => self.densest(near, f64::INFINITY)?,
                },
            };
            return Some(NearestScan {
                limit: LimitKind::Error,
                with_others: limits
                    .gap_deg
                    .is_some_and(|gap_deg| row.gap_deg.p99 <= gap_deg),
                least: least_mm,
                row,
            });
        }
        // Without a limit of time the choice would have found it.
        let fastest = limits.time_s.and_then(|_| match limits.gap_deg {
            Some(gap_deg) => self.fastest_nearby(scans, nearby, limits, (gap_deg, f64::INFINITY)),
            None => self.densest_of_fastest(self.accurate(scans, limits)),
        });
        let scans = self.accurate(scans, limits);
        if let Some(row) = fastest {
            return Some(NearestScan {
                limit: LimitKind::Time,
                with_others: limits.gap_deg.is_some() || limits.error_mm.is_some(),
                least: row.scan_s,
                row,
            });
        }
        let densest = self.densest(scans.clone(), f64::INFINITY)?;
        let least_deg = densest.gap_deg.p99;
        let nearly_deg = NEARLY_LEAST * least_deg;
        // The least gap may be within the limit by less than a choice is.
        let limit_deg = limits.gap_deg.filter(|gap_deg| least_deg <= *gap_deg);
        let most_deg = limit_deg.map_or(nearly_deg, |deg| nearly_deg.min(MARGIN * deg));
        let cheaper = self.fastest_within(&scans, most_deg, &mut self.examiners());
        let cheaper = cheaper.map(|found| self.row_of(&found));
        let cheaper = cheaper.filter(|row| limit_deg.is_none_or(|deg| row.gap_deg.p99 <= deg));
        Some(NearestScan {
            limit: LimitKind::Gap,
            with_others: limits.error_mm.is_some(),
            least: least_deg,
            row: cheaper.unwrap_or(densest),
        })
    }

    /// Scans within the limit of the error, in the order of their time.
    fn accurate<'a>(&self, scans: &'a [PlannedScan], limits: &PlanLimits) -> Vec<&'a PlannedScan> {
        let error_mm = |scan: &PlannedScan| self.errors.budget(&self.lidar, &scan.sweeps).total;
        let is_accurate =
            |scan: &&PlannedScan| limits.error_mm.is_none_or(|most| error_mm(scan) <= most);
        let mut scans: Vec<&PlannedScan> = scans.iter().filter(is_accurate).collect();
        scans.sort_by(|a, b| a.scan_s.total_cmp(&b.scan_s));
        scans
    }

    /// The fastest scan, or one that takes nearly the same time, whose gaps are within the limit at
    /// all azimuths of the lidar at the start. The scans are in the order of their time.
    fn fastest_within<'s, 'a>(
        &'s self,
        scans: &[&'a PlannedScan],
        gap_deg: f64,
        examiners: &mut Examiners<'s>,
    ) -> Option<DecidedScan<'a>> {
        // Ends of sweeps are whole counts of the encoder.
        let reach_rad = (gap_deg + self.errors.count_deg).to_radians();
        if examiners.refuse_all(reach_rad) {
            return None;
        }
        let mut slower = scans;
        while let Some(first) = slower.first() {
            let alike = slower.partition_point(|scan| scan.scan_s <= ALIKE * first.scan_s);
            let (block, others) = slower.split_at(alike);
            let hopeful = block.par_iter().filter_map(|scan| {
                let started = self.started(scan, 0, 1);
                Some((examiners.unseen_at_first(&started, gap_deg)?, *scan))
            });
            let mut hopeful: Vec<(usize, &PlannedScan)> = hopeful.collect();
            hopeful.sort_by_key(|(unseen, _)| *unseen);
            let mut hopeful = hopeful.into_iter().take(HOPEFUL);
            let found = hopeful.find_map(|(_, scan)| {
                let azimuths = self.keeps(scan, gap_deg, examiners)?;
                Some(DecidedScan { scan, azimuths })
            });
            if found.is_some() {
                return found;
            }
            examiners.sort();
            slower = others;
        }
        None
    }

    fn row_of(&self, found: &DecidedScan<'_>) -> PlanRow {
        self.row_decided(found.scan, &found.azimuths)
    }

    /// Densest of the fastest scans, which take nearly the same time.
    fn densest_of_fastest(&self, mut scans: Vec<&PlannedScan>) -> Option<PlanRow> {
        let most_s = NEARLY_FASTEST * scans.first()?.scan_s;
        scans.retain(|scan| scan.scan_s <= most_s);
        self.densest(scans, most_s)
    }

    fn densest(&self, mut scans: Vec<&PlannedScan>, time_s: f64) -> Option<PlanRow> {
        let (roughly, briefly) = FINALISTS;
        let longest_s = scans.last()?.scan_s.min(time_s);
        scans.retain(|scan| scan.scan_s >= SHORT * longest_s);
        let rough = scans
            .par_iter()
            .map(|scan| self.rough_p99_deg(scan, RANKING_STRIDE));
        let rough: Vec<f64> = rough.collect();
        let mut ranked: Vec<(&PlannedScan, f64)> = scans.into_iter().zip(rough).collect();
        ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
        let finalists = ranked.into_iter().take(roughly);
        let mut rows: Vec<(&PlannedScan, f64)> = finalists
            .map(|(scan, _)| (scan, self.brief_p99_deg(scan)))
            .collect();
        rows.sort_by(|a, b| a.1.total_cmp(&b.1));
        let rows = rows.into_iter().take(briefly);
        let rows = rows.map(|(scan, _)| self.row(scan));
        rows.min_by(|a, b| a.gap_deg.p99.total_cmp(&b.gap_deg.p99))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::lidar::tests::vlp_16;
    use super::super::{ErrorModel, LinkTiming, ScanSetting, TiltSweep};
    use super::*;

    fn scan(speed_deg_s: f64, accel_deg_s2: f64, rpm: f64, sweeps: u32) -> PlannedScan {
        let way = |back: bool| {
            let (from_deg, to_deg) = if back { (-45.0, 0.0) } else { (0.0, -45.0) };
            TiltSweep {
                from_deg,
                to_deg,
                speed_deg_s,
                accel_deg_s2,
            }
        };
        let sweeps_: Vec<TiltSweep> = (0..sweeps).map(|number| way(number % 2 == 1)).collect();
        PlannedScan {
            setting: ScanSetting {
                speed_deg_s,
                accel_deg_s2,
                rpm,
                sweeps,
            },
            scan_s: 2.0 + sweeps_.iter().map(TiltSweep::duration_s).sum::<f64>(),
            sweeps: sweeps_,
        }
    }

    pub fn scans() -> Vec<PlannedScan> {
        let speeds = (0..9).map(|step| 5.0 * 1.4_f64.powi(step));
        let settings = speeds.flat_map(|speed| {
            [500.0, 5_000.0].into_iter().flat_map(move |accel| {
                [600.0, 1_200.0]
                    .into_iter()
                    .flat_map(move |rpm| [1, 2].map(|sweeps| scan(speed, accel, rpm, sweeps)))
            })
        });
        settings.collect()
    }

    pub fn predictor(gap_deg: Option<f64>) -> ScanPredictor {
        let errors = ErrorModel {
            range_m: 20.0,
            range_sd_m: 0.6e-3,
            count_deg: 0.0015,
            link: LinkTiming::USB,
            mount_sd_deg: None,
        };
        ScanPredictor::new(vlp_16(), errors, gap_deg, [0.0, -45.0])
    }

    fn none(_: &PlannedScan) -> Vec<PlannedScan> {
        Vec::new()
    }

    /// Against every setting at full effort.
    #[test]
    fn choices_agree_with_brute_force() {
        let all: Vec<PlanRow> = {
            let predictor = predictor(None);
            scans().iter().map(|scan| predictor.row(scan)).collect()
        };
        // Limits of the gap that one of the settings keeps by little.
        let tight = all.iter().step_by(7);
        let tight = tight.map(|row| (None, Some(row.gap_deg.p99 / 0.96)));
        let mut refused = Vec::new();
        for (error_mm, gap_deg) in tight.chain([
            (None, Some(2.0)),
            (None, Some(0.8)),
            (Some(6.0), Some(0.8)),
            (Some(4.0), Some(0.4)),
            (None, Some(0.25)),
            (Some(4.0), None),
            (Some(1.0), None),
            (None, Some(0.05)),
        ]) {
            let limits = PlanLimits {
                error_mm,
                gap_deg,
                time_s: None,
            };
            let fits = |row: &&PlanRow| {
                gap_deg.is_none_or(|limit| row.gap_deg.p99 <= limit)
                    && error_mm.is_none_or(|limit| row.error_mm.total <= limit)
            };
            let best = all.iter().filter(fits).map(|row| row.scan_s);
            let best_s = best.fold(f64::INFINITY, f64::min);
            let chosen = predictor(gap_deg).choose(&scans(), none, &limits);
            println!("{limits:?}: {best_s} {chosen:?}");
            match chosen {
                Some(row) => {
                    assert!(fits(&&row), "{row:?}");
                    // Without a limit of the gap, the densest of those that take nearly as long;
                    // with one, those much faster leave more directions without a point than a
                    // choice does.
                    let longer = match gap_deg {
                        Some(_) => ALIKE,
                        None => NEARLY_FASTEST,
                    };
                    for (scan, faster) in scans().iter().zip(&all) {
                        if fits(&faster) && longer * faster.scan_s < row.scan_s {
                            let share = predictor(gap_deg).row(scan).share_without_point;
                            assert!(gap_deg.is_some() && share > 0.0095, "{share} {faster:?}");
                        }
                    }
                }
                None => {
                    assert_eq!(best_s, f64::INFINITY);
                    let nearest = predictor(gap_deg).nearest(&scans(), none, &limits).unwrap();
                    let value = |row: &PlanRow| match nearest.limit {
                        LimitKind::Error => row.error_mm.total,
                        LimitKind::Gap => row.gap_deg.p99,
                        LimitKind::Time => row.scan_s,
                    };
                    // None is much better, and none as good is much faster.
                    let best = all.iter().map(value).fold(f64::INFINITY, f64::min);
                    let found = value(&nearest.row);
                    assert!(found <= 1.05 * best, "{best} {nearest:?}");
                    let as_good = all.iter().filter(|row| value(row) <= found);
                    let best_s = as_good.map(|row| row.scan_s).fold(f64::INFINITY, f64::min);
                    assert!(nearest.row.scan_s <= 1.05 * best_s, "{best_s} {nearest:?}");
                    refused.push(nearest.limit);
                }
            }
        }
        assert_eq!(refused, [LimitKind::Error, LimitKind::Gap]);
        // The densest in a given time.
        for time_s in [4.0, 8.0] {
            let limits = PlanLimits {
                time_s: Some(time_s),
                ..PlanLimits::default()
            };
            let best = all.iter().filter(|row| row.scan_s <= time_s);
            let best = best
                .map(|row| row.gap_deg.p99)
                .fold(f64::INFINITY, f64::min);
            let row = predictor(None).choose(&scans(), none, &limits).unwrap();
            assert!(
                row.scan_s <= time_s && row.gap_deg.p99 <= 1.05 * best,
                "{best} {row:?}"
            );
        }
        let free = predictor(None).choose(&scans(), none, &PlanLimits::default());
        assert_eq!(free, None);
    }

    /// At 20 deg/s and 600 rpm the tilt per revolution is the spacing of the lasers: all lines
    /// coincide.
    #[test]
    fn resonances_show_as_gaps() {
        let predictor = predictor(None);
        let p99 = |speed: f64| predictor.row(&scan(speed, 5_000.0, 600.0, 1)).gap_deg.p99;
        println!("{} {} {}", p99(19.0), p99(20.0), p99(21.0));
        assert!(p99(20.0) > 1.15 * p99(19.0), "{} {}", p99(20.0), p99(19.0));
        // Longer ramps fill the ends of the field of view.
        let ramps = |accel: f64| predictor.row(&scan(56.25, accel, 600.0, 1)).gap_deg;
        println!("{:?} {:?}", ramps(5_000.0), ramps(500.0));
        assert!(ramps(500.0).p99 < 0.6 * ramps(5_000.0).p99);
        assert!(ramps(500.0).worst < 0.6 * ramps(5_000.0).worst);
    }
}
