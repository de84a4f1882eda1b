//! A planned scan and what it gives.

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use utoipa::ToSchema;

use super::{ErrorBudget, ErrorModel, PlanLidar, PlannedRays, StartedSweep, TiltSweep};
use crate::density::{Icosahedron, quantile};

/// What a capture sets.
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
    /// Of half of the directions in view.
    pub p50: f64,
    /// Of 95 %.
    pub p95: f64,
    /// Of 99 %.
    pub p99: f64,
    /// Of all.
    pub worst: f64,
}

/// What a scan gives.
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
    /// That azimuth of the lidar, degrees; a capture does not control it.
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
/// Bytes of a row of a PLY.
pub const ROW_BYTES: f64 = 29.0;
/// Points that a replay reads, places and writes per second, and its time without points, seconds:
/// 2.34 million in 0.384 s and 0.21 million in 0.05 s, on 2 busy cores of an AMD EPYC.
const REPLAY_POINTS_S: f64 = 6.5e6;
const REPLAY_S: f64 = 0.02;

/// Sweeps whose gaps are computed; of more, gaps are at most as wide.
const MOST_SWEEPS: usize = 8;

/// How finely gaps are looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct GapEffort {
    /// One of so many directions.
    pub stride: usize,
    /// Azimuths at the start.
    pub starts: u32,
}

impl GapEffort {
    /// Rejects hopeless settings.
    pub(super) const ROUGH: Self = Self {
        stride: 16,
        starts: 1,
    };
    /// A row of a table.
    pub(super) const ROW: Self = Self {
        stride: 3,
        starts: 4,
    };

    /// The chosen row. The gaps of sweeps of few revolutions depend on the azimuth at the start: at
    /// 10 revolutions by a tenth within 15 degrees of it, so that 64 azimuths are examined.
    pub(super) fn full(scan: &PlannedScan) -> Self {
        let shortest_s = scan.sweeps.iter().map(TiltSweep::duration_s);
        let revolutions = shortest_s.fold(f64::INFINITY, f64::min) * scan.setting.rpm / 60.0;
        Self {
            stride: 1,
            starts: (640.0 / revolutions).clamp(12.0, 64.0) as u32,
        }
    }
}

/// Predicts what scans give.
#[derive(Clone, Debug)]
pub struct ScanPredictor {
    /// The lidar.
    pub lidar: PlanLidar,
    /// What the error depends on.
    pub errors: ErrorModel,
    /// Requested gap, degrees.
    pub gap_deg: Option<f64>,
    /// Directions in view of the tilts.
    places: Vec<DVec3>,
}

impl ScanPredictor {
    /// For scans between two tilts, degrees. Directions are the centres of the 5120 bins of the
    /// density analysis.
    #[must_use]
    pub fn new(
        lidar: PlanLidar,
        errors: ErrorModel,
        gap_deg: Option<f64>,
        tilts_deg: [f64; 2],
    ) -> Self {
        let rays = PlannedRays::new(&lidar, 600.0, errors.range_m);
        let bins = Icosahedron::new(4).map(|icosahedron| {
            let centres = icosahedron.bins().iter().map(|bin| bin.centre);
            centres
                .filter(|place| rays.is_in_view(*place, tilts_deg))
                .collect()
        });
        Self {
            lidar,
            errors,
            gap_deg,
            // Level 4 is below the limit.
            places: bins.unwrap_or_default(),
        }
    }

    /// Directions in view.
    #[must_use]
    pub fn places(&self) -> &[DVec3] {
        &self.places
    }

    /// What a scan gives.
    #[must_use]
    pub fn row(&self, scan: &PlannedScan) -> PlanRow {
        self.row_with(scan, GapEffort::full(scan))
    }

    /// The same from a third of the directions and few azimuths at the start, many times
    /// as fast.
    #[must_use]
    pub fn brief_row(&self, scan: &PlannedScan) -> PlanRow {
        self.row_with(scan, GapEffort::ROW)
    }

    pub(super) fn row_with(&self, scan: &PlannedScan, effort: GapEffort) -> PlanRow {
        let limit_deg = self.gap_deg.unwrap_or(UNSEEN_DEG);
        let mut worst = GapQuantiles {
            p50: 0.0,
            p95: 0.0,
            p99: 0.0,
            worst: 0.0,
        };
        let (mut best_p99, mut best_start_deg, mut without) = (f64::INFINITY, 0.0, 0.0_f64);
        for start in 0..effort.starts {
            let gaps = self.gaps_deg(scan, effort, start);
            let of = |share| quantile(&gaps, share).unwrap_or(180.0);
            worst = GapQuantiles {
                p50: worst.p50.max(of(0.5)),
                p95: worst.p95.max(of(0.95)),
                p99: worst.p99.max(of(0.99)),
                worst: worst.worst.max(of(1.0)),
            };
            if of(0.99) < best_p99 {
                best_p99 = of(0.99);
                best_start_deg = 360.0 * f64::from(start) / f64::from(effort.starts);
            }
            let unseen = gaps.iter().filter(|gap| **gap > limit_deg).count();
            without = without.max(unseen as f64 / gaps.len().max(1) as f64);
        }
        let mm = |deg: f64| 1e3 * self.errors.range_m * deg.to_radians();
        let points = self.lidar.rays(&scan.sweeps);
        let period_s = self.lidar.packet_period_s;
        let log_bytes = period_s.map(|s| scan.scan_s * (PACKET_BYTES / s + DRIVE_BYTES_S));
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

    fn rays(&self, scan: &PlannedScan) -> PlannedRays {
        PlannedRays::new(&self.lidar, scan.setting.rpm, self.errors.range_m)
    }

    /// Gaps of directions with one of the azimuths at the start.
    fn gaps_deg(&self, scan: &PlannedScan, effort: GapEffort, start: u32) -> Vec<f64> {
        let (rays, sweeps) = (self.rays(scan), started(scan, start, effort.starts));
        let places = self.places.par_iter().step_by(effort.stride);
        places.map(|place| rays.gap_deg(&sweeps, *place)).collect()
    }

    /// The 99 % gap from few directions.
    pub(super) fn rough_p99_deg(&self, scan: &PlannedScan) -> f64 {
        let gaps = self.gaps_deg(scan, GapEffort::ROUGH, 0);
        quantile(&gaps, 0.99).unwrap_or(180.0)
    }

    /// Whether more than a share of the directions, and so many more, have no point within a gap,
    /// at any of the azimuths at the start.
    pub(super) fn exceeds(
        &self,
        scan: &PlannedScan,
        gap_deg: f64,
        effort: GapEffort,
        (share, more): (f64, usize),
    ) -> bool {
        let rays = self.rays(scan);
        let most = (self.places.len().div_ceil(effort.stride) as f64 * share) as usize + more;
        (0..effort.starts).any(|start| {
            let sweeps = started(scan, start, effort.starts);
            let places = self.places.iter().step_by(effort.stride);
            let unseen = places.filter(|place| !rays.is_within(&sweeps, **place, gap_deg));
            unseen.take(most + 1).count() > most
        })
    }
}

/// Sweeps of a scan with one of so many azimuths at the start: evenly spaced for the first sweep,
/// and by the golden ratio for later ones, since the time between sweeps is not controlled.
fn started(scan: &PlannedScan, start: u32, starts: u32) -> Vec<StartedSweep> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let first = f64::from(start) / f64::from(starts);
    let begin = |(number, sweep): (usize, &TiltSweep)| StartedSweep {
        sweep: *sweep,
        start: (first + number as f64 * GOLDEN * (1.0 + f64::from(start))).fract(),
    };
    let sweeps = scan.sweeps.iter().take(MOST_SWEEPS);
    sweeps.enumerate().map(begin).collect()
}
