//! Gaps in so many directions that they decide whether a scan keeps a limit.
//!
//! Few directions rule out most scans and azimuths of the lidar at the start. Those that decide
//! give the figures of the chosen row, too.

use std::cmp::Reverse;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;
use rayon::prelude::*;

use super::places::one_per_cell;
use super::row::{GapEffort, StartedScan};
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

/// Azimuths at the start that few directions examine first, or up to twice as many.
const SOME_STARTS: u32 = 8;
/// Numbers of azimuths that more directions examine at a time, the worst by few directions first:
/// the first refuse most scans. The last are all others.
const GROUPS: [usize; 3] = [2, 4, usize::MAX];
/// Of so many directions one rules out scans first.
const FEWEST_STRIDE: usize = 8;
/// Directions examined by all cores at a time.
const AT_A_TIME: usize = 2_048;
/// What a number of directions without a point may be off by chance, in standard deviations of
/// random ones; that of evenly spread ones varies less.
const DOUBT_SD: f64 = 2.8;

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

/// Directions that rule out scans, first those that most scans left without a point: they do it
/// soonest. Their order changes no answer.
struct Examiner<'a> {
    places: Vec<&'a PlannedPlace>,
    order: Vec<usize>,
    unseen: Vec<AtomicU32>,
    /// With more than so many without a point more than 1 % of all directions have none.
    most: usize,
    /// With fewer than so many without a point fewer than 1 % of all have none.
    least: usize,
}

/// Few directions, and more.
pub(super) struct Examiners<'a> {
    few: Examiner<'a>,
    more: Examiner<'a>,
}

impl<'a> Examiner<'a> {
    fn new(places: impl Iterator<Item = &'a PlannedPlace>) -> Self {
        let places: Vec<&PlannedPlace> = places.collect();
        let mean = 0.01 * places.len() as f64;
        let doubt = DOUBT_SD * mean.sqrt();
        Self {
            order: (0..places.len()).collect(),
            unseen: places.iter().map(|_| AtomicU32::new(0)).collect(),
            places,
            most: (mean + doubt) as usize,
            least: (mean - doubt).max(0.0).ceil() as usize,
        }
    }

    /// How many of the directions have no point within a gap, up to one too many.
    fn unseen(&self, scan: &StartedScan, gap_deg: f64) -> usize {
        let unseen = self.order.iter().filter(|number| {
            let place = self.places.get(**number);
            let is_unseen = place.is_some_and(|place| !scan.is_within(place, gap_deg));
            if let (true, Some(count)) = (is_unseen, self.unseen.get(**number)) {
                count.fetch_add(1, Relaxed);
            }
            is_unseen
        });
        unseen.take(self.most + 1).count()
    }

    fn sort(&mut self) {
        let Self { order, unseen, .. } = self;
        let count = |number: &usize| unseen.get(*number).map(|count| count.load(Relaxed));
        order.sort_by_key(|number| Reverse(count(number)));
    }
}

impl Examiners<'_> {
    /// Whether so many directions are out of reach of any scan that none keeps the gap.
    pub(super) fn refuse_all(&self, reach_rad: f64) -> bool {
        let out_of_reach = |place: &&&PlannedPlace| place.least_chord() > reach_rad;
        self.more.places.iter().filter(out_of_reach).count() > self.more.most
    }

    /// Whether few and more directions let a scan pass with the first azimuth at the start.
    pub(super) fn let_pass(&self, scan: &StartedScan, gap_deg: f64) -> bool {
        let mut both = [&self.few, &self.more].into_iter();
        both.all(|places| places.unseen(scan, gap_deg) <= places.most)
    }

    pub(super) fn sort(&mut self) {
        self.few.sort();
        self.more.sort();
    }
}

impl ScanPredictor {
    pub(super) fn examiners(&self) -> Examiners<'_> {
        Examiners {
            few: Examiner::new(self.places.iter().step_by(FEWEST_STRIDE)),
            more: Examiner::new(self.places.iter()),
        }
    }

    /// Whether the gaps of a scan are within the limit at all azimuths of the lidar at the start.
    pub(super) fn keeps(&self, scan: &PlannedScan, gap_deg: f64, examiners: &Examiners) -> bool {
        let Examiners { few, more } = examiners;
        let starts = GapEffort::full(scan).starts;
        // With the number of directions without a point, the worst azimuth first.
        let examine = |numbers: Vec<u32>, places: &Examiner| {
            let unseen = numbers.into_par_iter().map(|number| {
                let unseen = places.unseen(&self.started(scan, number, starts), gap_deg);
                (unseen <= places.most).then_some((unseen, number))
            });
            let mut unseen: Vec<(usize, u32)> = unseen.collect::<Option<_>>()?;
            unseen.sort_unstable_by_key(|(unseen, _)| Reverse(*unseen));
            Some(unseen)
        };
        // A few azimuths apart refuse most scans.
        let apart = (starts / SOME_STARTS).max(1);
        let (some, others) = (0..starts).partition(|number| number % apart == 0);
        let Some(mut ranked) = examine(some, few) else {
            return false;
        };
        let Some(others) = examine(others, few) else {
            return false;
        };
        ranked.extend(others);
        ranked.sort_unstable_by_key(|(unseen, _)| Reverse(*unseen));
        let mut numbers = ranked.into_iter().map(|(_, number)| number);
        GROUPS.into_iter().all(|count| {
            let Some(unseen) = examine(numbers.by_ref().take(count).collect(), more) else {
                return false;
            };
            let mut in_doubt = unseen.iter().filter(|(unseen, _)| *unseen >= more.least);
            in_doubt.all(|(_, number)| !self.refuses(&self.started(scan, *number, starts), gap_deg))
        })
    }

    /// Whether more than 1 % of the directions that decide have no point within a gap.
    fn refuses(&self, scan: &StartedScan, gap_deg: f64) -> bool {
        let places = self.deciding();
        let most = places.len() / 100;
        let mut unseen = 0;
        places.chunks(AT_A_TIME).any(|places| {
            let places = places.par_iter();
            unseen += places
                .filter(|place| !scan.is_within(place, gap_deg))
                .count();
            unseen > most
        })
    }

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
        let least_deg = limit_deg.min(CERTAIN * narrowest);
        let mut found = DecidingGaps {
            p99_deg: 0.0,
            best_p99_deg: (f64::INFINITY, 0),
            worst_deg: 0.0,
            // A share of no directions is no number.
            unseen: f64::NAN,
        };
        for (_, number) in starts {
            let started = self.started(scan, *number, of);
            let gap = |place| started.gap_beyond_deg(place, least_deg);
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
