//! Random pairs from every pair of cells, with a confidence interval that holds for any points.
//!
//! The pairs of two cells lie between two angles; pairs are drawn if an edge lies between those. A
//! draw is two rows of 32 pairs. A row pairs 32 points of one cell, from a random place on, with 32
//! of the other, in layouts that spread any 32 points over their cell. Every pair of the two cells
//! is equally likely at every place of a row. So the share of a row beyond an edge is unbiased, and
//! rows are independent. Bernstein's inequality bounds the sum. Its variance is bounded by the
//! squared differences between the two rows of each draw. The draws are pseudo-random.

use fearless_simd::{f32x16, prelude::*};
use glam::DVec3;

use super::cells::{PointCell, PointCells, ROW, scaled};
use super::counts::pairs;
use super::error::check;
use super::lanes::LANES;
use super::leaf_pair::F32_BAND;
use super::reach::reach;
use super::registers::LaneWork;
use super::sign_mask::SignMask;
use super::{Edges, Estimate, KError, Registers};
use crate::noise::SeededNoise;

/// Settings of [`sampled()`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Largest error of a share. The bound of the estimate is smaller, except for points that lie
    /// unevenly within cells.
    pub tolerance: f64,
    /// The probability that the bound does not hold for all bins at once.
    pub risk: f64,
    /// Seed of the draws.
    pub seed: u64,
}

impl Default for Sampling {
    /// 1e-4, with a risk of 1 in 1000.
    fn default() -> Self {
        Self {
            tolerance: 1e-4,
            risk: 1e-3,
            seed: 1,
        }
    }
}

/// Cells along an edge for a tolerance of 1e-4.
const SIDE: f64 = 10.0;

/// Draws per pair of cells of mean weight.
const DRAWS: f64 = 3.0;

/// Rounds after which a tolerance is given up.
const MOST_ROUNDS: i32 = 6;

/// Estimates by draws, with up to six rounds of more draws until the tolerance is met.
///
/// # Errors
/// [`KError::NotUnit`] and [`KError::TooMany`] for invalid directions, [`KError::Setting`] for a
/// tolerance or a risk not between 0 and 1, [`KError::Undecided`].
pub fn sampled(points: &[DVec3], edges: &Edges, sampling: &Sampling) -> Result<Estimate, KError> {
    check(points)?;
    check_setting(sampling)?;
    let mut chance = SeededNoise(sampling.seed);
    if points.len() < 2 {
        return Ok(Estimate::without_pairs("sampled", edges, points.len()));
    }
    // `SIDE` cells along an edge reach 1e-4 in one round; the deviation falls with the third power.
    let side = (SIDE * (1e-4 / sampling.tolerance).cbrt())
        .round()
        .clamp(4.0, 64.0);
    let cells = PointCells::new(points, side as usize);
    let mut draws = DRAWS;
    let mut round = 1;
    loop {
        // Rounds share the risk, so that stopping at a bound that suffices is valid.
        let risk = sampling.risk * 0.9 * 0.1_f64.powi(round - 1);
        let estimate = drawn(points, &cells, edges, draws, risk, &mut chance)?;
        let bound = estimate.largest_bound();
        if bound <= sampling.tolerance || round == MOST_ROUNDS {
            return Ok(Estimate {
                risk: sampling.risk,
                ..estimate
            });
        }
        // The next round has a tenth of the risk, which widens its bound.
        let more = (bound / sampling.tolerance).powi(2) * 1.3;
        draws = (draws * more).min(1e4);
        round += 1;
    }
}

/// Checks the ranges of tolerance and risk.
pub(super) fn check_setting(sampling: &Sampling) -> Result<(), KError> {
    let settings = [("tolerance", sampling.tolerance), ("risk", sampling.risk)];
    let is_wrong = |(_, got): &(&str, f64)| !(*got > 0.0 && *got < 1.0);
    match settings.into_iter().find(is_wrong) {
        Some((name, got)) => Err(KError::Setting { name, got }),
        None => Ok(()),
    }
}

/// One round with about `draws` draws per pair of cells of mean weight.
fn drawn(
    points: &[DVec3],
    cells: &PointCells,
    edges: &Edges,
    draws: f64,
    risk: f64,
    chance: &mut SeededNoise,
) -> Result<Estimate, KError> {
    let of_cells = cells.cells.len() as f64;
    let mut one = SamplingWorker {
        points,
        cells,
        edges,
        chance,
        draws: draws * (of_cells * (of_cells + 1.0) / 2.0).max(1.0),
        all: pairs(points.len()).max(1) as f64,
        from: vec![0.0; edges.bins()],
        beyond: vec![0.0; edges.bins() + LANES],
        variance: vec![0.0; edges.bins() + LANES],
        heaviest: 0.0,
        on_edges: 0.0,
        wrong: None,
    };
    Registers::Best.run(&mut one);
    one.done(risk)
}

/// The start of a row in both cells: index in the columns, cell, layout, position in the layout.
type Row<'a> = [(usize, &'a PointCell, usize, usize); 2];

/// Registers per row.
const REGISTERS: usize = ROW / LANES;

/// Cells per tile: two tiles are within half of the second-level cache, for a million points in 600
/// cells.
const TILE: usize = 16;

struct SamplingWorker<'a> {
    points: &'a [DVec3],
    cells: &'a PointCells,
    edges: &'a Edges,
    chance: &'a mut SeededNoise,
    /// Number of draws in all, shared by weight.
    draws: f64,
    /// Number of pairs.
    all: f64,
    /// Shares of pairs by the first bin that their cells can reach.
    from: Vec<f64>,
    /// Estimated shares beyond the upper edge of each bin, and their estimated variances, with
    /// sixteen extra entries that stay 0.
    beyond: Vec<f64>,
    variance: Vec<f64>,
    /// The largest weight of a row.
    heaviest: f64,
    /// The estimated share of pairs on an inner edge.
    on_edges: f64,
    wrong: Option<KError>,
}

impl LaneWork for SamplingWorker<'_> {
    #[inline(always)]
    fn run<L: SignMask>(&mut self, on: L) {
        self.all_cells(on);
    }
}

impl<'a> SamplingWorker<'a> {
    /// All pairs of cells, tile by tile, so that the points of two tiles stay in the cache.
    #[inline(always)]
    fn all_cells<L: SignMask>(&mut self, on: L) {
        let len = self.cells.cells.len();
        for tile in (0..len).step_by(TILE) {
            for other in (tile..len).step_by(TILE) {
                for at in tile..(tile + TILE).min(len) {
                    self.some_cells(on, at, (at.max(other), (other + TILE).min(len)));
                }
            }
        }
    }

    /// Draws pairs of a cell with a range of cells.
    #[inline(always)]
    fn some_cells<L: SignMask>(&mut self, on: L, at: usize, (first, end): (usize, usize)) {
        let cells = self.cells;
        let (Some(a), Some(around)) = (cells.cells.get(at), cells.around.one(at)) else {
            return;
        };
        for start in (first..end).step_by(LANES) {
            let Some((middles, radii)) = cells.around.sixteen(start) else {
                return;
            };
            let of = reach(on.simd(), around, middles, radii, self.edges.bins());
            let others = cells.cells.get(start..end).unwrap_or_default();
            for ((b, first), last) in others.iter().zip(&of.first).zip(&of.last) {
                self.two_cells(on, a, b, (*first as usize, *last as usize));
            }
        }
    }

    #[inline(always)]
    fn two_cells<L: SignMask>(
        &mut self,
        on: L,
        a: &'a PointCell,
        b: &'a PointCell,
        (first, last): (usize, usize),
    ) {
        let is_same = a.first == b.first;
        let count = if is_same {
            pairs(a.len) as f64
        } else {
            a.len as f64 * b.len as f64
        };
        let weight = count / self.all;
        if let Some(from) = self.from.get_mut(first) {
            *from += weight;
        }
        if first == last || count == 0.0 {
            return;
        }
        let draws = (self.draws * weight).ceil().max(1.0);
        let weight = weight / (2.0 * draws);
        self.heaviest = self.heaviest.max(weight);
        for _ in 0..draws as u64 {
            let rows = [self.row(a, b, is_same), self.row(a, b, is_same)];
            self.draw(on, &rows, (first, last), weight);
        }
    }

    /// Draws the start of a row.
    #[inline(always)]
    fn row<'c>(&mut self, a: &'c PointCell, b: &'c PointCell, is_same: bool) -> Row<'c> {
        let bits = self.chance.bits();
        let other_bits = self.chance.bits();
        let from_a = scaled(bits, a.len);
        let (layout, from_b) = if is_same {
            // Another point of the cell in the same layout, so that no point is paired with itself.
            let other = from_a + 1 + scaled(other_bits, a.len.saturating_sub(1));
            (0, other % a.len.max(1))
        } else {
            (1, scaled(other_bits, b.len))
        };
        let [(column_a, _), _] = a.layouts;
        let column_b = b.layouts.get(layout).map_or(0, |(column, _)| *column);
        [
            (column_a + from_a, a, 0, from_a),
            (column_b + from_b, b, layout, from_b),
        ]
    }

    /// Counts two rows at all edges between `first` and `last`.
    #[inline(always)]
    fn draw<L: SignMask>(
        &mut self,
        on: L,
        rows: &[Row<'_>; 2],
        (first, last): (usize, usize),
        weight: f64,
    ) {
        let simd = on.simd();
        let [row, other] = rows;
        let (Some(dots), Some(others)) = (self.dots(on, row), self.dots(on, other)) else {
            return;
        };
        let edges = self.edges;
        let cosines = edges.cosines_f32().get(first..last).unwrap_or_default();
        let share = weight / ROW as f64;
        let squared = share * share;
        let mut near = f32x16::splat(simd, 4.0);
        let mut near_other = near;
        let mut at = first;
        for cosines in cosines.chunks(LANES) {
            let (mut counts, mut differences) = ([0_i32; LANES], [0_i32; LANES]);
            for ((cosine, count), difference) in
                cosines.iter().zip(&mut counts).zip(&mut differences)
            {
                let (mut one, mut two) = (0, 0);
                for (dots, others) in dots.iter().zip(&others) {
                    let (above, above_other) = (*dots - *cosine, *others - *cosine);
                    near = on.nearer_zero(near, above);
                    near_other = on.nearer_zero(near_other, above_other);
                    one += above.simd_lt(0.0).to_bitmask().count_ones();
                    two += above_other.simd_lt(0.0).to_bitmask().count_ones();
                }
                let (one, two) = (one.cast_signed(), two.cast_signed());
                (*count, *difference) = (one + two, one - two);
            }
            // Sixteen edges at once; entries behind the last edge count nothing.
            if let Some(beyond) = sixteen(&mut self.beyond, at) {
                for (beyond, count) in beyond.iter_mut().zip(counts) {
                    *beyond += share * f64::from(count);
                }
            }
            if let Some(variance) = sixteen(&mut self.variance, at) {
                for (variance, difference) in variance.iter_mut().zip(differences) {
                    *variance += squared * f64::from(difference * difference);
                }
            }
            at += LANES;
        }
        if on
            .nearer_zero(near, near_other)
            .simd_le(F32_BAND)
            .any_true()
        {
            let mut stored = [[[0.0; LANES]; REGISTERS]; 2];
            for (stored, dots) in stored.iter_mut().zip([&dots, &others]) {
                for (stored, dots) in stored.iter_mut().zip(dots) {
                    dots.store_array(stored);
                }
            }
            self.near(rows, &stored, (first, last), share);
        }
    }

    /// Corrects the counts of pairs that are too near to an edge for f32.
    #[inline(never)]
    fn near(
        &mut self,
        rows: &[Row<'_>; 2],
        dots: &[[[f32; LANES]; REGISTERS]; 2],
        (first, last): (usize, usize),
        share: f64,
    ) {
        for edge in first..last {
            let Some(&cosine) = self.edges.cosines_f32().get(edge) else {
                return;
            };
            let is_near = |dot: &f32| (dot - cosine).abs() <= F32_BAND;
            if !dots.iter().flatten().flatten().any(is_near) {
                continue;
            }
            // The counts of both rows in f32 and by the exact test.
            let (mut in_f32, mut exact) = ([0.0; 2], [0.0; 2]);
            for (number, (row, dots)) in rows.iter().zip(dots).enumerate() {
                for (lane, dot) in dots.iter().flatten().enumerate() {
                    let is_beyond = dot - cosine < 0.0;
                    let is_so = match is_near(dot) {
                        true => self.is_beyond(row, lane, edge, share),
                        false => is_beyond,
                    };
                    for (sums, is) in [(&mut in_f32, is_beyond), (&mut exact, is_so)] {
                        if let Some(sum) = sums.get_mut(number) {
                            *sum += f64::from(u8::from(is));
                        }
                    }
                }
            }
            let ([in_f32, in_f32_other], [exact, exact_other]) = (in_f32, exact);
            let squares = (exact - exact_other).powi(2) - (in_f32 - in_f32_other).powi(2);
            if let Some(beyond) = self.beyond.get_mut(edge) {
                *beyond += share * (exact + exact_other - in_f32 - in_f32_other);
            }
            if let Some(variance) = self.variance.get_mut(edge) {
                *variance += share * share * squares;
            }
        }
    }

    /// Whether a pair of a row is beyond an edge, by the exact test.
    fn is_beyond(&mut self, row: &Row<'_>, lane: usize, edge: usize, share: f64) -> bool {
        let [a, b] = row.map(|(_, cell, layout, along)| {
            let index = self.cells.index(cell.point_index(layout, along + lane));
            index.and_then(|index| self.points.get(index))
        });
        let (Some(a), Some(b)) = (a, b) else {
            return true;
        };
        if self.edges.is_on(edge, *a, *b) {
            self.on_edges += share;
        }
        match self.edges.reaches(edge, *a, *b) {
            Ok(reaches) => !reaches,
            Err(wrong) => {
                self.wrong = Some(wrong);
                true
            }
        }
    }

    /// Dot products of the pairs of a row.
    #[inline(always)]
    fn dots<L: SignMask>(&self, on: L, row: &Row<'_>) -> Option<[f32x16<L::S>; REGISTERS]> {
        let [x, y, z] = &self.cells.columns;
        let [(a, ..), (b, ..)] = *row;
        let simd = on.simd();
        let mut dots = [f32x16::splat(simd, 0.0); REGISTERS];
        for (number, dots) in dots.iter_mut().enumerate() {
            let (a, b) = (a + number * LANES, b + number * LANES);
            let ax = f32x16::load_array_ref(simd, x.get(a..)?.first_chunk()?);
            let ay = f32x16::load_array_ref(simd, y.get(a..)?.first_chunk()?);
            let az = f32x16::load_array_ref(simd, z.get(a..)?.first_chunk()?);
            let bx = f32x16::load_array_ref(simd, x.get(b..)?.first_chunk()?);
            let by = f32x16::load_array_ref(simd, y.get(b..)?.first_chunk()?);
            let bz = f32x16::load_array_ref(simd, z.get(b..)?.first_chunk()?);
            *dots = az.mul_add(bz, ay.mul_add(by, ax * bx));
        }
        Some(dots)
    }

    fn done(self, risk: f64) -> Result<Estimate, KError> {
        if let Some(wrong) = self.wrong {
            return Err(wrong);
        }
        let largest_cell = self.cells.cells.iter().map(|cell| cell.len).max();
        // Errors of the distribution of 64-bit draws and of rounding in the sums.
        let uneven = 2.0 * largest_cell.unwrap_or(0) as f64 / 2.0_f64.powi(64) + 1e-9;
        let bins = self.edges.bins();
        // Three inequalities per edge: two sides of the sum, and one of the variance.
        let log = (3.0 * bins as f64 / risk).ln();
        let (mut shares, mut bounds) = (Vec::with_capacity(bins), Vec::with_capacity(bins));
        let mut sum = 0.0;
        for ((from, beyond), variance) in self.from.iter().zip(&self.beyond).zip(&self.variance) {
            sum += from;
            shares.push((sum - beyond).clamp(0.0, 1.0));
            bounds.push(bernstein(*variance, self.heaviest, log) + uneven);
        }
        // All pairs are within pi.
        if let (Some(share), Some(bound)) = (shares.last_mut(), bounds.last_mut()) {
            (*share, *bound) = (1.0, 0.0);
        }
        Ok(Estimate {
            method: "sampled",
            edges: self.edges.clone(),
            shares,
            bounds,
            risk,
            points: self.points.len(),
            on_edges: (self.on_edges * self.all).round() as u64,
        })
    }
}

/// Sixteen entries from one on.
#[inline(always)]
fn sixteen(of: &mut [f64], from: usize) -> Option<&mut [f64; LANES]> {
    of.get_mut(from..)?.first_chunk_mut()
}

/// Bound on the deviation of a sum of independent numbers in `0..=most` from its mean, except with
/// probability `3 exp(-log)`.
///
/// The squares `Y` of differences within draws are independent, between 0 and `most2`, and the mean
/// of their sum is the variance `V`. So `V <= sum + sqrt(2 most2 V log)` except with probability
/// `exp(-log)` (Maurer 2003), solved for `V`. Then `e2 = 2 log (V + most e / 3)` (Bernstein) is
/// solved for `e`.
fn bernstein(squares: f64, most: f64, log: f64) -> f64 {
    let root = most * (log / 2.0).sqrt();
    let deviation = root + (root * root + squares).sqrt();
    let third = most * log / 3.0;
    third + (third * third + 2.0 * log * deviation * deviation).sqrt()
}
