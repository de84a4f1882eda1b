//! A planned scan and what it gives.

use std::f64::consts::PI;
use std::sync::OnceLock;

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use utoipa::ToSchema;

use super::places::{climb, evenly_spread, random};
use super::{ErrorBudget, ErrorModel, PlanLidar, PlannedPlace, PlannedRays, TiltSweep};
use crate::density::quantile;

/// Settings of a capture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct ScanSetting {
    /// Cruise speed, degrees per second: whole revolutions per minute of the motor.
    pub speed_deg_s: f64,
    /// Acceleration of the ramps, degrees per second squared.
    pub accel_deg_s2: f64,
    /// Revolutions of the lidar per minute.
    pub rpm: f64,
    /// Number of sweeps; 2 or more are both ways.
    pub sweeps: u32,
}

/// A scan that the axis can run.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedScan {
    /// Its setting.
    pub setting: ScanSetting,
    /// The sweeps.
    pub sweeps: Vec<TiltSweep>,
    /// Time of the whole scan with homing, seconds.
    pub scan_s: f64,
}

/// Distances of directions from the nearest ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct GapQuantiles {
    /// Gap of half of the directions in view.
    pub p50: f64,
    /// Gap of 95 %.
    pub p95: f64,
    /// Gap of 99 %.
    pub p99: f64,
    /// The widest found, from the widest of those examined to the widest nearby. In fewer than 1 in
    /// 1000 directions it is wider, with a risk of 1 in 1000.
    pub worst: f64,
}

/// Predicted results of a scan.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct PlanRow {
    /// Its setting.
    #[serde(flatten)]
    pub setting: ScanSetting,
    /// Time of the whole scan with homing, seconds.
    pub scan_s: f64,
    /// Points, if every shot returns.
    pub points: u64,
    /// Mean angle between rays of one sweep that are neighbours in elevation, degrees.
    pub resolution_deg: f64,
    /// Distances from a direction in view to the nearest point, degrees, at the worst azimuth of
    /// the lidar at the start.
    pub gap_deg: GapQuantiles,
    /// The same at the range, millimetres.
    pub gap_mm: GapQuantiles,
    /// Smallest distance that 99 % of directions are within, at the best azimuth at the start.
    pub best_start_p99_deg: f64,
    /// Best azimuth of the lidar at the start, degrees; a capture does not control it.
    pub best_start_deg: f64,
    /// Share of directions in view without a point within the requested gap; 0.5 deg without one.
    pub share_without_point: f64,
    /// Error of a point at the range.
    pub error_mm: ErrorBudget,
    /// Estimated time of a replay, seconds; null for a lidar whose packets velomotion cannot read.
    pub replay_s: Option<f64>,
    /// Bytes of the log; null as well.
    pub log_bytes: Option<u64>,
    /// Bytes of the cloud as PLY.
    pub cloud_bytes: u64,
}

/// Gap that counts as unseen if none is requested, degrees.
const UNSEEN_DEG: f64 = 0.5;
/// Bytes of a packet and its frames in a log.
pub const PACKET_BYTES: f64 = 1_320.0;
/// Bytes per second of the drive's part of a log: up to 1000 polls of two frames.
pub const DRIVE_BYTES_S: f64 = 2e5;
/// Time in a log before the first sweep and after the last, seconds: 1.6 to 1.8 of captures of the
/// simulator from 2 to 98 deg/s. Homing is not in it.
const LOGGED_AROUND_S: f64 = 1.8;
/// Bytes of a row of a PLY.
pub const ROW_BYTES: f64 = 29.0;
/// Points that a replay reads, places and writes per second, and its time without points, seconds:
/// 2.34 million in 0.384 s and 0.21 million in 0.05 s, on 2 busy cores of an AMD EPYC.
const REPLAY_POINTS_S: f64 = 6.5e6;
const REPLAY_S: f64 = 0.02;

/// Directions of the sphere, 2 deg apart; those in view are examined.
const DIRECTIONS: u32 = 10_000;
/// Random directions in view: if gaps are wider than all of theirs in 1 of 1000 directions, one so
/// lucky is drawn with a probability of 0.999^n = 0.001.
const RANDOM_DIRECTIONS: usize = 6_905;
/// Directions from which a wider gap is sought nearby.
const CLIMBS: usize = 6;

/// Part of the requested gap from which on the 99 % gap of a choice binds it.
const BINDING: f64 = 0.9;

/// Resolution of the search for gaps.
#[derive(Clone, Copy, Debug)]
pub(super) struct GapEffort {
    /// One of so many directions.
    pub stride: usize,
    /// Azimuths at the start.
    pub starts: u32,
}

impl GapEffort {
    /// The first of many settings that a rougher look has ranked.
    pub(super) const BRIEF: Self = Self {
        stride: 6,
        starts: 4,
    };

    /// Effort for a capture, and for a row of a table. The 99 % gap of fast sweeps both ways
    /// depends on the pair of azimuths: 4 pairs missed a third of it, 12 are within 5 % of 48.
    const USUAL: Self = Self {
        stride: 1,
        starts: 12,
    };

    /// For the 99 % gap of the chosen row. The gaps of sweeps of few revolutions depend on the
    /// azimuth at the start: at 10 revolutions that of 99 % by a tenth within 15 degrees of it, and
    /// by less than 1 % within half of a step of 40 azimuths.
    pub(super) fn full(scan: &PlannedScan) -> Self {
        let shortest_s = scan.sweeps.iter().map(TiltSweep::duration_s);
        let revolutions = shortest_s.fold(f64::INFINITY, f64::min) * scan.setting.rpm / 60.0;
        Self {
            stride: 1,
            starts: (400.0 / revolutions).clamp(12.0, 40.0) as u32,
        }
    }
}

/// Predicts what scans give.
#[derive(Clone, Debug)]
pub struct ScanPredictor {
    /// The lidar.
    pub lidar: PlanLidar,
    /// Model of the error of a point.
    pub errors: ErrorModel,
    /// Requested gap, degrees.
    pub gap_deg: Option<f64>,
    /// Tilts at the ends.
    pub(super) tilts_deg: [f64; 2],
    /// Directions in view of the tilts.
    pub(super) places: Vec<PlannedPlace>,
    /// Random ones.
    random_places: Vec<PlannedPlace>,
    /// Those that decide a choice, made when one needs them.
    pub(super) deciding: OnceLock<Vec<PlannedPlace>>,
}

impl ScanPredictor {
    /// For scans between two tilts, degrees.
    #[must_use]
    pub fn new(
        lidar: PlanLidar,
        errors: ErrorModel,
        gap_deg: Option<f64>,
        tilts_deg: [f64; 2],
    ) -> Self {
        let rays = PlannedRays::new(&lidar, 600.0, errors.range_m);
        let in_view = |place: &DVec3| rays.is_in_view(*place, tilts_deg);
        let place = |place| rays.place(place, tilts_deg);
        let places = evenly_spread(DIRECTIONS).filter(in_view).map(place);
        let random_places = random().filter(in_view).take(RANDOM_DIRECTIONS).map(place);
        // One of so many then has its part of those that no scan comes near to. A VLP-32C does not
        // for just 1 % of them.
        let mut places: Vec<PlannedPlace> = places.collect();
        places.sort_by(|a, b| a.least_chord().total_cmp(&b.least_chord()));
        Self {
            places,
            random_places: random_places.collect(),
            deciding: OnceLock::new(),
            lidar,
            errors,
            gap_deg,
            tilts_deg,
        }
    }

    /// Whether so many directions are in view that shares of gaps hold: a short sweep has fewer.
    #[must_use]
    pub const fn sees_enough(&self) -> bool {
        self.random_places.len() == RANDOM_DIRECTIONS && self.places.len() >= 100
    }

    /// Predicts the results of a scan.
    #[must_use]
    pub fn row(&self, scan: &PlannedScan) -> PlanRow {
        self.row_decided(scan, &[])
    }

    /// The same of a scan that keeps the requested gap, with the azimuths that decided on it.
    pub(super) fn row_decided(&self, scan: &PlannedScan, decided: &[Vec<f64>]) -> PlanRow {
        let mut row = self.row_with(scan, GapEffort::USUAL);
        let beyond_deg = self.unseen_beyond_deg();
        let at = |near_deg, azimuths| self.deciding_gaps(scan, near_deg, beyond_deg, azimuths);
        let at_decided = self.gap_deg.filter(|_| !decided.is_empty());
        let at_decided = at_decided.map(|gap_deg| (at(gap_deg, decided), BINDING * gap_deg));
        // Azimuths that are worst for a much wider gap need not be for this one.
        let decided = match at_decided {
            Some((gaps, least_deg)) if gaps.p99_deg >= least_deg => gaps,
            _ => at(self.brief_p99_deg(scan), &[]),
        };
        row.gap_deg.p99 = decided.p99_deg;
        row.gap_mm.p99 = self.gap_mm(decided.p99_deg);
        row.best_start_p99_deg = decided.best_p99_deg;
        row.best_start_deg = decided.best_start_deg;
        row.gap_deg.worst = row.gap_deg.worst.max(decided.worst_deg);
        row.gap_mm.worst = self.gap_mm(row.gap_deg.worst);
        row.share_without_point = decided.unseen;
        row
    }

    /// The same with fewer azimuths at the start, several times as fast.
    #[must_use]
    pub fn capture_row(&self, scan: &PlannedScan) -> PlanRow {
        self.row_with(scan, GapEffort::USUAL)
    }

    /// Gap beyond which a direction counts as one without a point, degrees: the requested one, or
    /// 0.5.
    #[must_use]
    pub fn unseen_beyond_deg(&self) -> f64 {
        self.gap_deg.unwrap_or(UNSEEN_DEG)
    }

    /// A gap at the range, millimetres.
    fn gap_mm(&self, deg: f64) -> f64 {
        1e3 * self.errors.range_m * deg.to_radians()
    }

    fn row_with(&self, scan: &PlannedScan, effort: GapEffort) -> PlanRow {
        let limit_deg = self.unseen_beyond_deg();
        let mut worst = GapQuantiles {
            p50: 0.0,
            p95: 0.0,
            p99: 0.0,
            worst: 0.0,
        };
        // A share of no directions is no number.
        let (mut best_p99, mut best_start_deg, mut without) = (f64::INFINITY, 0.0, f64::NAN);
        for start in 0..effort.starts {
            // Narrower gaps change no figure of the row.
            let least_deg = worst.p50.min(best_p99).min(limit_deg);
            let gaps = self.gaps_deg(scan, effort, start, least_deg);
            let of = |share| quantile(&gaps, share).unwrap_or(180.0);
            worst = GapQuantiles {
                p50: worst.p50.max(of(0.5)),
                p95: worst.p95.max(of(0.95)),
                p99: worst.p99.max(of(0.99)),
                worst: worst.worst,
            };
            worst.worst = self.widest_deg(scan, (start, effort), &gaps, worst.worst);
            if of(0.99) < best_p99 {
                best_p99 = of(0.99);
                best_start_deg = 360.0 * f64::from(start) / f64::from(effort.starts);
            }
            let unseen = gaps.iter().filter(|gap| **gap > limit_deg).count();
            without = without.max(unseen as f64 / gaps.len() as f64);
        }
        let mm = |deg: f64| self.gap_mm(deg);
        let points = self.lidar.rays(&scan.sweeps);
        let period_s = self.lidar.packet_period_s;
        let sweeps_s: f64 = scan.sweeps.iter().map(TiltSweep::duration_s).sum();
        let logged_s = sweeps_s + LOGGED_AROUND_S;
        let log_bytes = period_s.map(|s| logged_s * (PACKET_BYTES / s + DRIVE_BYTES_S));
        let resolution_deg = scan.sweeps.first().map_or(f64::INFINITY, |sweep| {
            self.lidar.mean_resolution_deg(sweep, scan.setting.rpm)
        });
        PlanRow {
            setting: scan.setting,
            scan_s: scan.scan_s,
            points: points as u64,
            resolution_deg,
            gap_deg: worst,
            gap_mm: GapQuantiles {
                p50: mm(worst.p50),
                p95: mm(worst.p95),
                p99: mm(worst.p99),
                worst: mm(worst.worst),
            },
            best_start_p99_deg: best_p99,
            best_start_deg,
            share_without_point: without,
            error_mm: self.errors.budget(&self.lidar, &scan.sweeps),
            replay_s: period_s.map(|_| REPLAY_S + points / REPLAY_POINTS_S),
            log_bytes: log_bytes.map(|bytes| bytes as u64),
            cloud_bytes: (points * ROW_BYTES) as u64,
        }
    }

    pub(super) fn rays_at(&self, rpm: f64) -> PlannedRays {
        PlannedRays::new(&self.lidar, rpm, self.errors.range_m)
    }

    /// Gaps of directions with one of the azimuths at the start. Gaps narrower than `least_deg`
    /// count as `least_deg`.
    fn gaps_deg(
        &self,
        scan: &PlannedScan,
        effort: GapEffort,
        start: u32,
        least_deg: f64,
    ) -> Vec<f64> {
        let started = self.started(scan, start, effort.starts);
        let places = self.places.par_iter().step_by(effort.stride);
        let gap = |place| started.gap_beyond_deg(place, least_deg);
        places.map(gap).collect()
    }

    /// The gap of 99 % of some of the directions with one of the azimuths at the start.
    pub(super) fn p99_deg(&self, scan: &PlannedScan, effort: GapEffort, start: u32) -> f64 {
        self.quantile_deg(scan, effort, start, 0.99)
    }

    /// The same of another share.
    fn quantile_deg(&self, scan: &PlannedScan, effort: GapEffort, start: u32, share: f64) -> f64 {
        let started = self.started(scan, start, effort.starts);
        let places = self.places.iter().step_by(effort.stride);
        let count = places.len();
        // One more than the others of them, in order.
        let wanted = count - (share * count as f64).ceil() as usize + 1;
        let mut widest: Vec<f64> = Vec::with_capacity(wanted + 1);
        for place in places {
            let is_full = widest.len() == wanted;
            let least_deg = widest.first().copied().filter(|_| is_full).unwrap_or(0.0);
            let gap_deg = started.gap_beyond_deg(place, least_deg);
            if !is_full || gap_deg > least_deg {
                widest.insert(widest.partition_point(|gap| *gap < gap_deg), gap_deg);
                widest.drain(..usize::from(is_full));
            }
        }
        widest.first().copied().unwrap_or(180.0)
    }

    /// The widest gap with one of the azimuths at the start, or a wider one already found.
    fn widest_deg(
        &self,
        scan: &PlannedScan,
        (start, effort): (u32, GapEffort),
        gaps: &[f64],
        found_deg: f64,
    ) -> f64 {
        let started = self.started(scan, start, effort.starts);
        let rays = &started.rays;
        let gap = |place: DVec3| started.gap_deg(&rays.place(place, self.tilts_deg));
        let in_view = |place: &DVec3| rays.is_in_view(*place, self.tilts_deg);
        let examined = self.places.iter().step_by(effort.stride);
        let mut ranked: Vec<(f64, DVec3)> = gaps
            .iter()
            .copied()
            .zip(examined.map(PlannedPlace::direction))
            .collect();
        if ranked.len() > CLIMBS {
            ranked.select_nth_unstable_by(CLIMBS, |a, b| b.0.total_cmp(&a.0));
        }
        // No laser points along the tilt axis.
        let poles = [DVec3::Y, DVec3::NEG_Y].into_iter().filter(in_view);
        let from: Vec<DVec3> = ranked
            .iter()
            .take(CLIMBS)
            .map(|(_, place)| *place)
            .chain(poles)
            .collect();
        let apart_rad = (4.0 * PI / f64::from(DIRECTIONS) * effort.stride as f64).sqrt();
        let widest = from.into_par_iter();
        let widest = widest.map(|place| climb(place, apart_rad, in_view, gap));
        let widest = widest.reduce(|| found_deg, f64::max);
        let wider = self.random_places.par_iter();
        let wider = wider.map(|place| started.gap_beyond_deg(place, widest));
        wider.reduce(|| widest, f64::max)
    }

    /// The 99 % gap of a sixth of the directions, with few azimuths at the start.
    #[must_use]
    pub fn brief_p99_deg(&self, scan: &PlannedScan) -> f64 {
        self.brief_gap_deg(scan, 0.99)
    }

    /// The same of another share.
    #[must_use]
    pub fn brief_gap_deg(&self, scan: &PlannedScan, share: f64) -> f64 {
        let starts = (0..GapEffort::BRIEF.starts).into_par_iter();
        let gaps_deg = starts.map(|start| self.quantile_deg(scan, GapEffort::BRIEF, start, share));
        gaps_deg.reduce(|| 0.0, f64::max)
    }

    /// The 99 % gap from every so many directions, at one azimuth.
    pub(super) fn rough_p99_deg(&self, scan: &PlannedScan, stride: usize) -> f64 {
        self.p99_deg(scan, GapEffort { stride, starts: 1 }, 0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::LinkTiming;
    use super::super::lidar::tests::vlp_16;
    use super::*;

    /// Against 200,000 other directions, near the poles of the tilt axis another 2000.
    #[test]
    fn no_direction_has_a_wider_gap_than_the_worst() {
        let errors = ErrorModel {
            range_m: 20.0,
            range_sd_m: 0.6e-3,
            count_deg: 0.0015,
            link: LinkTiming::USB,
            mount_sd_deg: None,
        };
        let tilts_deg = [0.0, -45.0];
        let predictor = ScanPredictor::new(vlp_16(), errors, None, tilts_deg);
        let mut noise = crate::noise::SeededNoise(5);
        let mut uniform = |most: f64| most * (2.0 * noise.uniform() - 1.0);
        let cube = |_| DVec3::new(uniform(1.0), uniform(1.0), uniform(1.0));
        let mut others: Vec<DVec3> = (0..400_000).map(cube).collect();
        others.retain(|place| (0.1..1.0).contains(&place.length_squared()));
        let even = others.len();
        let near = |_| DVec3::new(uniform(0.05), 1.0_f64.copysign(uniform(1.0)), uniform(0.05));
        others.extend((0..2_000).map(near));
        for (speed_deg_s, accel_deg_s2, sweeps) in [
            (98.0, 22.0, 2),
            (30.0, 500.0, 1),
            (17.5, 175.9, 1),
            (10.0, 500.0, 1),
            (1.0, 500.0, 1),
        ] {
            let sweep = |number: u32| TiltSweep {
                from_deg: [0.0, -45.0][(number % 2) as usize],
                to_deg: [-45.0, 0.0][(number % 2) as usize],
                speed_deg_s,
                accel_deg_s2,
            };
            let scan = PlannedScan {
                setting: ScanSetting {
                    speed_deg_s,
                    accel_deg_s2,
                    rpm: 600.0,
                    sweeps,
                },
                sweeps: (0..sweeps).map(sweep).collect(),
                scan_s: 1.0,
            };
            let row = predictor.row(&scan);
            let started = predictor.started(&scan, 1, GapEffort::full(&scan).starts);
            let rays = &started.rays;
            let gaps = |others: &[DVec3]| -> Vec<f64> {
                let others = others.par_iter().map(|place| place.normalize());
                let seen = others.filter(|place| rays.is_in_view(*place, tilts_deg));
                let place = |place| rays.place(place, tilts_deg);
                seen.map(|direction| started.gap_deg(&place(direction)))
                    .collect()
            };
            let widest = gaps(&others).into_iter().fold(0.0, f64::max);
            let p99 = quantile(&gaps(&others[..even]), 0.99).unwrap();
            println!("{speed_deg_s}: {widest} {p99} {:?}", row.gap_deg);
            assert!(
                widest <= 1.001 * row.gap_deg.worst,
                "{speed_deg_s}: {widest} {row:?}"
            );
            assert!(
                p99 <= 1.03 * row.gap_deg.p99,
                "{speed_deg_s}: {p99} {row:?}"
            );
        }
    }
}
