//! Gaps in so many directions that they decide whether a scan keeps a limit.
//!
//! Rough and evenly spread directions, which are fewer, rule out most scans and azimuths of the
//! lidar at the start. The deciding ones give the figures of a row, too.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;
use rayon::prelude::*;

use super::places::one_per_cell;
use super::row::GapEffort;
use super::started::{StartedScan, azimuths_at_starts};
use super::{PlannedPlace, PlannedScan, ScanPredictor};
use crate::density::quantile;

/// Cells of the sphere along the tilt axis and about it with one random direction in each. Of the
/// half of them that a VLP-16 sees over 45 deg, a share of 1 % is exact to 4.5 % (standard
/// deviation of random ones).
const CELLS: u32 = 320;
/// Their seed.
const SEED: u64 = 18;
/// Part of the 99 % gap of the evenly spread directions that the deciding ones do not go below.
const CERTAIN: f64 = 0.9;
/// Worst azimuths by the evenly spread directions, near which worse ones are sought: forty pairs of
/// azimuths of two sweeps are a sixth of a revolution apart, and between them the 99 % gap was 8 %
/// wider.
const START_CLIMBS: usize = 3;
/// Steps of the search for a worse azimuth, revolutions.
const CLIMB_STEPS: [f64; 4] = [1.0 / 12.0, 1.0 / 24.0, 1.0 / 48.0, 1.0 / 96.0];

/// Part of the gap by which worse azimuths are sought as well: within it so many more directions
/// have no point that their number rises towards the worst azimuth from farther away.
const NARROWER: f64 = 0.8;

/// Azimuths at the start that rough directions examine first, or up to twice as many.
const SOME_STARTS: u32 = 8;
/// The worst of them, which all examine before the others.
const FIRST_STARTS: usize = 2;
/// One of so many evenly spread directions is a rough one.
const ROUGH_STRIDE: usize = 8;
/// At most so many of the worst azimuths by the evenly spread directions are decided, and give the
/// figures of a row.
const MOST_DECIDED: usize = 6;
/// Fewest evenly spread directions whose number without a point ranks azimuths: 1 % of fewer is
/// within the doubt.
const FEW_PLACES: usize = 784;
/// Directions examined by all cores at a time.
const AT_A_TIME: usize = 2_048;
/// Possible deviation by chance of a number of directions without a point, in standard deviations
/// of random ones; that of evenly spread ones varies less.
const DOUBT_SD: f64 = 2.8;
/// Margin below the 1 % of the deciding directions that may have no point, standard deviations: by
/// chance they have more points than others. Of 50 choices with 40 random azimuths or 120 pairs of
/// them each, three broke the limit in 200,000 other directions: at most 1.024 % of them had no
/// point, and the standard deviation of such a share is 0.022 %.
const MARGIN_SD: f64 = 1.0;

/// Gaps in the deciding directions with several azimuths of the lidar at the start.
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
    /// More than so many without a point refuse a scan.
    most: usize,
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

/// One in eight of the evenly spread directions, all of them, and the deciding ones.
pub(super) struct Examiners<'a> {
    rough: Examiner<'a>,
    even: Examiner<'a>,
    /// Made when a scan passes the others.
    deciding: Option<Examiner<'a>>,
}

impl<'a> Examiner<'a> {
    /// Examiner of directions of which 1 % may have no point, plus `more_sd` standard deviations.
    fn new(places: impl Iterator<Item = &'a PlannedPlace>, more_sd: f64) -> Self {
        let places: Vec<&PlannedPlace> = places.collect();
        Self {
            order: (0..places.len()).collect(),
            unseen: places.iter().map(|_| AtomicU32::new(0)).collect(),
            most: one_percent(places.len(), more_sd),
            places,
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

    /// Numbers of the directions without a point within a gap, up to one too many.
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

/// One percent of so many directions, and so many standard deviations more.
fn one_percent(count: usize, more_sd: f64) -> usize {
    let mean = 0.01 * count as f64;
    (mean + more_sd * mean.sqrt()).max(0.0) as usize
}

impl Examiners<'_> {
    /// Whether so many directions are out of reach of any scan that none keeps the gap.
    pub(super) fn refuse_all(&self, reach_rad: f64) -> bool {
        let out_of_reach = |place: &&&PlannedPlace| place.least_chord() > reach_rad;
        self.even.places.iter().filter(out_of_reach).count() > self.even.most
    }

    /// Number of evenly spread directions without a point with the first azimuth at the start,
    /// unless they are too many.
    pub(super) fn unseen_at_first(&self, scan: &StartedScan, gap_deg: f64) -> Option<usize> {
        let unseen = |places: &Examiner| {
            let unseen = places.unseen(scan, gap_deg).len();
            (unseen <= places.most).then_some(unseen)
        };
        unseen(&self.rough)?;
        unseen(&self.even)
    }

    pub(super) fn sort(&mut self) {
        self.rough.sort();
        self.even.sort();
    }
}

impl ScanPredictor {
    pub(super) fn examiners(&self) -> Examiners<'_> {
        let rough = self.places.iter().step_by(ROUGH_STRIDE);
        Examiners {
            rough: Examiner::new(rough, DOUBT_SD),
            even: Examiner::new(self.places.iter(), DOUBT_SD),
            deciding: None,
        }
    }

    /// Greatest number of the worst azimuths at the start that are decided.
    const fn most_decided(&self) -> usize {
        match self.places.len() < FEW_PLACES {
            true => usize::MAX,
            false => MOST_DECIDED,
        }
    }

    /// The azimuths at the starts of the sweeps that were in doubt, if the gaps of a scan are
    /// within the limit at all azimuths of the lidar at the start.
    pub(super) fn keeps<'a>(
        &'a self,
        scan: &PlannedScan,
        gap_deg: f64,
        examiners: &mut Examiners<'a>,
    ) -> Option<Vec<Vec<f64>>> {
        let Examiners {
            rough,
            even,
            deciding,
        } = examiners;
        let count = GapEffort::full(scan).starts;
        // The worst azimuth first.
        let rank = |numbers: Vec<u32>, places: &Examiner<'_>| {
            let examined = numbers.into_par_iter().map(|number| {
                let unseen = places.unseen(&self.started(scan, number, count), gap_deg);
                (unseen.len() <= places.most).then_some(ExaminedStart { number, unseen })
            });
            let mut examined: Vec<ExaminedStart> = examined.collect::<Option<_>>()?;
            examined.sort_unstable_by_key(ExaminedStart::order);
            Some(examined)
        };
        let mut decided = Vec::new();
        let mut decide = |azimuths: Vec<f64>| {
            let deciding =
                deciding.get_or_insert_with(|| Examiner::new(self.deciding().iter(), -MARGIN_SD));
            let is_refused = deciding.refuses(&self.started_at(scan, &azimuths), gap_deg);
            decided.push(azimuths);
            (!is_refused).then_some(())
        };
        let in_doubt = one_percent(even.places.len(), -DOUBT_SD);
        let mut decide_worst = |numbers: Vec<u32>| {
            let examined = rank(numbers, even)?;
            for worst in examined.iter().take(self.most_decided()) {
                if worst.unseen.len() > in_doubt {
                    decide(azimuths_at_starts(scan, worst.number, count))?;
                }
            }
            Some(examined)
        };
        // A few azimuths apart refuse most scans.
        let apart = (count / SOME_STARTS).max(1);
        let (some, others) = (0..count).partition(|number| number % apart == 0);
        let numbers = |examined: Vec<ExaminedStart>| examined.into_iter().map(|start| start.number);
        let mut passed = numbers(rank(some, rough)?);
        let mut ranked = decide_worst(passed.by_ref().take(FIRST_STARTS).collect())?;
        let passed = passed.chain(numbers(rank(others, rough)?));
        ranked.extend(decide_worst(passed.collect())?);
        ranked.sort_unstable_by_key(ExaminedStart::order);
        for azimuths in self.worse_starts(scan, &ranked, gap_deg) {
            decide(azimuths)?;
        }
        let narrower_deg = NARROWER * gap_deg;
        let ranked = self.ranked_starts(scan, narrower_deg);
        for azimuths in self.worse_starts(scan, &ranked, narrower_deg) {
            decide(azimuths)?;
        }
        Some(decided)
    }

    /// Azimuths at the start by the evenly spread directions that they leave without a point within
    /// a gap, the worst first.
    fn ranked_starts(&self, scan: &PlannedScan, gap_deg: f64) -> Vec<ExaminedStart> {
        let of = GapEffort::full(scan).starts;
        let examined = (0..of).into_par_iter().map(|number| {
            let started = self.started(scan, number, of);
            let unseen = self.places.iter().enumerate();
            let unseen = unseen.filter(|(_, place)| !started.is_within(place, gap_deg));
            let unseen = unseen.map(|(place, _)| place).collect();
            ExaminedStart { number, unseen }
        });
        let mut ranked: Vec<ExaminedStart> = examined.collect();
        ranked.sort_unstable_by_key(ExaminedStart::order);
        ranked
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
        ranked
            .iter()
            .take(START_CLIMBS)
            .filter_map(move |examined| {
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
                            Some((unseen, starts)) if unseen > most => {
                                (most, worst) = (unseen, starts)
                            }
                            _ => break,
                        }
                    }
                }
                (most > examined.unseen.len()).then_some(worst)
            })
    }

    /// The deciding directions, in view of the tilts. The first call is not one of many in
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

    /// The gaps of the deciding directions, of a scan whose 99 % gap is near a known one, at the
    /// azimuths at which it was decided; without those, at the worst.
    pub(super) fn deciding_gaps(
        &self,
        scan: &PlannedScan,
        near_deg: f64,
        limit_deg: f64,
        decided: &[Vec<f64>],
    ) -> DecidingGaps {
        let effort = GapEffort::full(scan);
        let of = effort.starts;
        let ranked = self.ranked_starts(scan, near_deg);
        let narrowest = ranked.last().map_or(0, |examined| examined.number);
        let narrowest_deg = self.p99_deg(scan, effort, narrowest);
        let least_deg = limit_deg.min(CERTAIN * narrowest_deg);
        let mut starts = vec![azimuths_at_starts(scan, narrowest, of)];
        if decided.is_empty() {
            let widest = ranked.iter().take(self.most_decided());
            starts.extend(widest.map(|worst| azimuths_at_starts(scan, worst.number, of)));
            starts.extend(self.worse_starts(scan, &ranked, near_deg));
        }
        starts.extend_from_slice(decided);
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
