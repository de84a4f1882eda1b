//! Gaps in so many directions that they decide whether a scan keeps a limit.
//!
//! Few directions rule out most scans and azimuths of the lidar at the start. Those that decide
//! give the figures of the chosen row, too.

use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;
use rayon::prelude::*;

use super::places::one_per_cell;
use super::{PlannedPlace, PlannedScan, ScanPredictor};
use crate::density::quantile;

/// Cells of the sphere along the tilt axis and about it with one random direction in each. Of the
/// half of them that a VLP-16 sees over 45 deg, a share of 1 % is exact to 4.5 % (standard
/// deviation of random ones).
const CELLS: u32 = 320;
/// Their seed.
const SEED: u64 = 18;
/// Azimuths with the widest gaps of few directions, of which more directions find the widest.
const WIDEST_STARTS: usize = 12;
/// Part of the gap of 99 % of few directions that more directions do not go below.
const CERTAIN: f64 = 0.9;

/// What more directions give with several azimuths of the lidar at the start.
#[derive(Clone, Copy, Debug)]
pub(super) struct DecidingGaps {
    /// The widest gap of 99 %, degrees.
    pub p99_deg: f64,
    /// The narrowest one, and at which azimuth.
    pub best_p99_deg: (f64, u32),
    /// The widest gap of all.
    pub worst_deg: f64,
    /// The greatest share of directions without a point within the limit.
    pub unseen: f64,
}

impl ScanPredictor {
    /// The directions that decide, in view of the tilts. The first call is not one of many in
    /// parallel, which would wait for each other.
    fn deciding(&self) -> &[PlannedPlace] {
        self.deciding.get_or_init(|| {
            let rays = self.rays_at(600.0);
            let directions: Vec<DVec3> = one_per_cell(CELLS, SEED).collect();
            let in_view = directions.into_par_iter();
            let in_view = in_view.filter(|place| rays.is_in_view(*place, self.tilts_deg));
            let places = in_view.map(|place| rays.place(place, self.tilts_deg));
            places.collect()
        })
    }

    /// Whether more than 1 % of the directions that decide have no point within the gap, with one
    /// of so many azimuths at the start.
    pub(super) fn is_refused(
        &self,
        scan: &PlannedScan,
        gap_deg: f64,
        (start, of): (u32, u32),
    ) -> bool {
        let (rays, sweeps) = (self.rays(scan), self.started(scan, start, of));
        let places = self.deciding();
        let most = places.len() / 100;
        let unseen = AtomicUsize::new(0);
        places.par_iter().any(|place| {
            !rays.is_within(&sweeps, place, gap_deg) && unseen.fetch_add(1, Relaxed) >= most
        })
    }

    /// The gaps of the directions that decide, from those of few with each azimuth at the start.
    pub(super) fn deciding_gaps(
        &self,
        scan: &PlannedScan,
        few_p99_deg: &[f64],
        limit_deg: f64,
    ) -> DecidingGaps {
        let of = few_p99_deg.len() as u32;
        let mut ranked: Vec<(f64, u32)> = few_p99_deg.iter().copied().zip(0..of).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let narrowest = ranked.last().map_or(0.0, |(gap, _)| *gap);
        let widest = ranked.iter().take(WIDEST_STARTS);
        let starts = widest.chain(ranked.iter().skip(WIDEST_STARTS).last());
        let rays = self.rays(scan);
        let least_deg = limit_deg.min(CERTAIN * narrowest);
        let mut found = DecidingGaps {
            p99_deg: 0.0,
            best_p99_deg: (f64::INFINITY, 0),
            worst_deg: 0.0,
            // A share of no directions is no number.
            unseen: f64::NAN,
        };
        for (_, number) in starts {
            let sweeps = self.started(scan, *number, of);
            let gap = |place: &PlannedPlace| match rays.is_within(&sweeps, place, least_deg) {
                true => least_deg,
                false => rays.gap_deg(&sweeps, place),
            };
            let gaps: Vec<f64> = self.deciding().par_iter().map(gap).collect();
            let p99 = quantile(&gaps, 0.99).unwrap_or(180.0);
            let unseen = gaps.iter().filter(|gap| **gap > limit_deg).count();
            found = DecidingGaps {
                p99_deg: found.p99_deg.max(p99),
                best_p99_deg: match p99 < found.best_p99_deg.0 {
                    true => (p99, *number),
                    false => found.best_p99_deg,
                },
                worst_deg: gaps.iter().copied().fold(found.worst_deg, f64::max),
                unseen: found.unseen.max(unseen as f64 / gaps.len() as f64),
            };
        }
        found
    }
}
