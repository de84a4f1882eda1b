//! Gaps in so many directions that they decide whether a scan keeps a limit.
//!
//! Few directions rule out most scans and azimuths of the lidar at the start. Those that decide
//! give the figures of the chosen row, too.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;
use rayon::prelude::*;

use super::places::one_per_cell;
use super::row::{GapEffort, StartedScan, azimuths_at_starts};
use super::{PlannedPlace, PlannedScan, ScanPredictor};
use crate::density::quantile;

/// Cells of the sphere along the tilt axis and about it with one random direction in each. Of the
/// half of them that a VLP-16 sees over 45 deg, a share of 1 % is exact to 4.5 % (standard
/// deviation of random ones).
const CELLS: u32 = 320;
/// Their seed.
const SEED: u64 = 18;
/// Azimuths with the widest gaps of few directions, of which more directions find the widest.
const WIDEST_STARTS: usize = 6;
/// Part of the gap of 99 % of few directions that more directions do not go below.
const CERTAIN: f64 = 0.9;
/// Azimuths with the widest gaps of few directions, near which wider ones are sought: forty pairs
/// of azimuths of two sweeps are a sixth of a revolution apart, and between them the 99 % gap was
/// 8 % wider.
const CLIMBS: usize = 3;
/// Steps of the search for a worse azimuth, revolutions.
const CLIMB_STEPS: [f64; 4] = [1.0 / 12.0, 1.0 / 24.0, 1.0 / 48.0, 1.0 / 96.0];

/// Azimuths at the start that few directions examine first, or up to twice as many.
const SOME_STARTS: u32 = 8;
/// The worst of them, which more directions examine before the others.
const FIRST_STARTS: usize = 2;
/// Of so many directions one rules out scans first.
const FEWEST_STRIDE: usize = 8;
/// So many of the worst azimuths of each group are in doubt.
const MOST_IN_DOUBT: usize = 6;
/// So many standard deviations less than 1 % of the directions that decide may have no point: by
/// chance these have more points than others. Of 50 choices with 40 random azimuths or 120 pairs of
/// them each, three broke the limit in 200,000 other directions: at most 1.024 % of them had no
/// point, which is exact to 0.022 %.
const DECIDING_SD: f64 = -1.0;
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
    /// The narrowest one.
    pub best_p99_deg: f64,
    /// Azimuth at the start of the first sweep with it, degrees.
    pub best_start_deg: f64,
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

/// An azimuth at the start, and the directions that it leaves without a point within a gap.
struct ExaminedStart {
    number: u32,
    unseen: Vec<usize>,
}

impl ExaminedStart {
    /// The worst azimuth first.
    fn order(&self) -> (Reverse<usize>, u32) {
        (Reverse(self.unseen.len()), self.number)
    }
}

/// Few directions, more, and those that decide.
pub(super) struct Examiners<'a> {
    few: Examiner<'a>,
    more: Examiner<'a>,
    /// Made when a scan passes the others.
    deciding: Option<Examiner<'a>>,
}

impl<'a> Examiner<'a> {
    /// Directions whose numbers are in doubt by so many standard deviations of random ones.
    fn new(places: impl Iterator<Item = &'a PlannedPlace>, doubt_sd: f64) -> Self {
        let places: Vec<&PlannedPlace> = places.collect();
        let mean = 0.01 * places.len() as f64;
        let doubt = doubt_sd * mean.sqrt();
        Self {
            order: (0..places.len()).collect(),
            unseen: places.iter().map(|_| AtomicU32::new(0)).collect(),
            places,
            most: (mean + doubt).max(0.0) as usize,
            least: (mean - doubt).max(0.0).ceil() as usize,
        }
    }

    fn is_unseen(&self, number: usize, scan: &StartedScan, gap_deg: f64) -> bool {
        let place = self.places.get(number);
        let is_unseen = place.is_some_and(|place| !scan.is_within(place, gap_deg));
        if let (true, Some(count)) = (is_unseen, self.unseen.get(number)) {
            count.fetch_add(1, Relaxed);
        }
        is_unseen
    }

    /// Which of the directions have no point within a gap, up to one too many.
    fn unseen(&self, scan: &StartedScan, gap_deg: f64) -> Vec<usize> {
        let numbers = self.order.iter().copied();
        let unseen = numbers.filter(|number| self.is_unseen(*number, scan, gap_deg));
        unseen.take(self.most + 1).collect()
    }

    /// Whether too many directions have no point within a gap; examined by all cores.
    fn refuses(&mut self, scan: &StartedScan, gap_deg: f64) -> bool {
        let mut unseen = 0;
        let is_refused = self.order.chunks(AT_A_TIME).any(|numbers| {
            let numbers = numbers.par_iter();
            unseen += numbers
                .filter(|number| self.is_unseen(**number, scan, gap_deg))
                .count();
            unseen > self.most
        });
        if is_refused {
            self.sort();
        }
        is_refused
    }

    fn sort(&mut self) {
        let Self { order, unseen, .. } = self;
        let count = |number: &usize| unseen.get(*number).map(|count| count.load(Relaxed));
        order.sort_by_cached_key(|number| Reverse(count(number)));
    }
}

impl Examiners<'_> {
    /// Whether so many directions are out of reach of any scan that none keeps the gap.
    pub(super) fn refuse_all(&self, reach_rad: f64) -> bool {
        let out_of_reach = |place: &&&PlannedPlace| place.least_chord() > reach_rad;
        self.more.places.iter().filter(out_of_reach).count() > self.more.most
    }

    /// How many of more directions have no point with the first azimuth at the start, unless few or
    /// these are too many.
    pub(super) fn unseen_at_first(&self, scan: &StartedScan, gap_deg: f64) -> Option<usize> {
        let unseen = |places: &Examiner| {
            let unseen = places.unseen(scan, gap_deg).len();
            (unseen <= places.most).then_some(unseen)
        };
        unseen(&self.few)?;
        unseen(&self.more)
    }

    pub(super) fn sort(&mut self) {
        self.few.sort();
        self.more.sort();
    }
}

impl ScanPredictor {
    pub(super) fn examiners(&self) -> Examiners<'_> {
        let few = self.places.iter().step_by(FEWEST_STRIDE);
        Examiners {
            few: Examiner::new(few, DOUBT_SD),
            more: Examiner::new(self.places.iter(), DOUBT_SD),
            deciding: None,
        }
    }

    /// Whether the gaps of a scan are within the limit at all azimuths of the lidar at the start.
    pub(super) fn keeps<'a>(
        &'a self,
        scan: &PlannedScan,
        gap_deg: f64,
        examiners: &mut Examiners<'a>,
    ) -> bool {
        self.examine(scan, gap_deg, examiners).is_some()
    }

    /// Nothing when an azimuth breaks the limit.
    fn examine<'a>(
        &'a self,
        scan: &PlannedScan,
        gap_deg: f64,
        Examiners {
            few,
            more,
            deciding,
        }: &mut Examiners<'a>,
    ) -> Option<()> {
        let starts = GapEffort::full(scan).starts;
        // The worst azimuth first.
        let rank = |numbers: Vec<u32>, places: &Examiner<'_>| {
            let examined = numbers.into_par_iter().map(|number| {
                let unseen = places.unseen(&self.started(scan, number, starts), gap_deg);
                (unseen.len() <= places.most).then_some(ExaminedStart { number, unseen })
            });
            let mut examined: Vec<ExaminedStart> = examined.collect::<Option<_>>()?;
            examined.sort_unstable_by_key(ExaminedStart::order);
            Some(examined)
        };
        let mut keeps = |starts: &[f64]| {
            let deciding =
                deciding.get_or_insert_with(|| Examiner::new(self.deciding().iter(), DECIDING_SD));
            let is_refused = deciding.refuses(&self.started_at(scan, starts), gap_deg);
            (!is_refused).then_some(())
        };
        let mut decide = |numbers: Vec<u32>| {
            let examined = rank(numbers, more)?;
            for worst in examined.iter().take(MOST_IN_DOUBT) {
                if worst.unseen.len() >= more.least {
                    keeps(&azimuths_at_starts(scan, worst.number, starts))?;
                }
            }
            Some(examined)
        };
        // A few azimuths apart refuse most scans.
        let apart = (starts / SOME_STARTS).max(1);
        let (some, others) = (0..starts).partition(|number| number % apart == 0);
        let numbers = |examined: Vec<ExaminedStart>| examined.into_iter().map(|start| start.number);
        let mut few_starts = numbers(rank(some, few)?);
        let mut ranked = decide(few_starts.by_ref().take(FIRST_STARTS).collect())?;
        let few_starts = few_starts.chain(numbers(rank(others, few)?));
        ranked.extend(decide(few_starts.collect())?);
        ranked.sort_unstable_by_key(ExaminedStart::order);
        for worse in self.worse_starts(scan, &ranked, gap_deg) {
            keeps(&worse)?;
        }
        Some(())
    }

    /// Azimuths at the starts of the sweeps near the worst of those examined that leave more
    /// directions without a point, of those that some azimuth examined left without one.
    fn worse_starts(
        &self,
        scan: &PlannedScan,
        ranked: &[ExaminedStart],
        gap_deg: f64,
    ) -> impl Iterator<Item = Vec<f64>> {
        let of = ranked.len() as u32;
        let places: BTreeSet<usize> = ranked
            .iter()
            .flat_map(|examined| examined.unseen.iter().copied())
            .collect();
        let places: Vec<&PlannedPlace> = places
            .into_iter()
            .filter_map(|number| self.places.get(number))
            .collect();
        let unseen = move |starts: &[f64]| {
            let scan = self.started_at(scan, starts);
            let unseen = places
                .iter()
                .filter(|place| !scan.is_within(place, gap_deg));
            unseen.count()
        };
        ranked.iter().take(CLIMBS).map(move |examined| {
            let mut worst = azimuths_at_starts(scan, examined.number, of);
            let mut most = examined.unseen.len();
            for step in CLIMB_STEPS {
                loop {
                    let moves = (0..2 * worst.len()).into_par_iter().map(|number| {
                        let mut starts = worst.clone();
                        if let Some(start) = starts.get_mut(number / 2) {
                            *start += if number % 2 == 0 { step } else { -step };
                        }
                        (unseen(&starts), starts)
                    });
                    let moves: Vec<(usize, Vec<f64>)> = moves.collect();
                    match moves.into_iter().max_by_key(|(unseen, _)| *unseen) {
                        Some((unseen, starts)) if unseen > most => (most, worst) = (unseen, starts),
                        _ => break,
                    }
                }
            }
            worst
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

    /// The gaps of the directions that decide, of a scan whose 99 % gap is near a known one.
    pub(super) fn deciding_gaps(
        &self,
        scan: &PlannedScan,
        near_deg: f64,
        limit_deg: f64,
    ) -> DecidingGaps {
        let effort = GapEffort::full(scan);
        let of = effort.starts;
        let examined = (0..of).into_par_iter().map(|number| {
            let started = self.started(scan, number, of);
            let unseen = self.places.iter().enumerate();
            let unseen = unseen.filter(|(_, place)| !started.is_within(place, near_deg));
            let unseen = unseen.map(|(place, _)| place).collect();
            ExaminedStart { number, unseen }
        });
        let mut ranked: Vec<ExaminedStart> = examined.collect();
        ranked.sort_unstable_by_key(ExaminedStart::order);
        let narrowest = ranked.last().map_or(0, |examined| examined.number);
        let narrowest_deg = self.p99_deg(scan, effort, narrowest);
        let least_deg = limit_deg.min(CERTAIN * narrowest_deg);
        let widest = ranked.iter().take(WIDEST_STARTS);
        let numbers = widest.map(|examined| examined.number).chain([narrowest]);
        let starts = numbers.map(|number| azimuths_at_starts(scan, number, of));
        let starts = starts.chain(self.worse_starts(scan, &ranked, near_deg));
        let mut found = DecidingGaps {
            p99_deg: 0.0,
            best_p99_deg: f64::INFINITY,
            best_start_deg: 0.0,
            worst_deg: 0.0,
            // A share of no directions is no number.
            unseen: f64::NAN,
        };
        for starts in starts {
            let started = self.started_at(scan, &starts);
            let gap = |place| started.gap_beyond_deg(place, least_deg);
            let gaps: Vec<f64> = self.deciding().par_iter().map(gap).collect();
            let p99 = quantile(&gaps, 0.99).unwrap_or(180.0);
            let unseen = gaps.iter().filter(|gap| **gap > limit_deg).count();
            if p99 < found.best_p99_deg {
                let first = starts.first().copied().unwrap_or_default();
                found.best_p99_deg = p99;
                found.best_start_deg = 360.0 * first.rem_euclid(1.0);
            }
            found.p99_deg = found.p99_deg.max(p99);
            found.worst_deg = gaps.iter().copied().fold(found.worst_deg, f64::max);
            found.unseen = found.unseen.max(unseen as f64 / gaps.len() as f64);
        }
        found
    }
}
