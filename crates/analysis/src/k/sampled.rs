//! Pairs drawn by chance from every pair of cells, with a confidence interval that holds for any points.
//!
//! The pairs of two cells are between two angles; where an edge lies between those, pairs are drawn. A draw is two rows of sixteen: sixteen points of one cell from a
//! place of chance on, against sixteen of the other. Every pair of the two cells is as likely in every lane, so a row's share beyond an edge is right in the mean, and rows are
//! independent of each other. Bernstein's inequality bounds the sum. The variance in it is bounded by squares of the differences between the two rows of a draw.
//! Nothing is assumed of the points. Left out: the pseudo-randomness of the draws, which is taken for chance.

use fearless_simd::{dispatch, f32x16, prelude::*};
use glam::DVec3;

use super::cells::{Cell, Cells, Chance, scaled};
use super::counts::pairs;
use super::lanes::{LANES, Lanes, Portable};
use super::leaf_pair::F32_BAND;
use super::plain::check;
use super::reach::reach;
use super::{Bound, Edges, Estimate, KError, Registers};

/// What is wished of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// How far a share may be off at most. The estimate's own bound says how far it may be: it is below this but for points of which cells know nothing.
    pub tolerance: f64,
    /// The probability that the bound does not hold for all bins at once.
    pub risk: f64,
    /// Of the draws.
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

/// Rounds before a tolerance is given up.
const MOST_ROUNDS: u32 = 6;

/// Estimates by draws, more of them until the tolerance is met, or six rounds are over.
///
/// # Errors
/// [`KError::NotUnit`] and [`KError::TooMany`] for what are not directions, [`KError::Wish`] for a tolerance or a risk not between 0 and 1, [`KError::Undecided`].
pub fn sampled(points: &[DVec3], edges: &Edges, wish: &Sampling) -> Result<Estimate, KError> {
    check(points)?;
    for (name, got) in [("tolerance", wish.tolerance), ("risk", wish.risk)] {
        if !(got > 0.0 && got < 1.0) {
            return Err(KError::Wish { name, got });
        }
    }
    let mut chance = Chance::new(wish.seed);
    if points.len() < 2 {
        return Ok(Estimate::without_pairs("sampled", edges, points.len()));
    }
    // 17 cells along an edge reach 1e-4 at once; the variance falls with the sixth power of the side.
    let side = (17.0 * (1e-4 / wish.tolerance).cbrt())
        .round()
        .clamp(4.0, 64.0);
    let cells = Cells::new(points, side as usize, &mut chance);
    let mut draws = 1.0;
    let mut round = 1;
    loop {
        // Rounds share the risk, so that looking at a bound before going on costs nothing that is not counted.
        let risk = wish.risk / f64::from(1_u32 << round);
        let estimate = drawn(points, &cells, edges, draws, risk, &mut chance)?;
        let bound = estimate.bound.largest();
        if bound <= wish.tolerance || round == MOST_ROUNDS {
            return Ok(Estimate {
                bound: match estimate.bound {
                    Bound::Confidence { shares, .. } => Bound::Confidence {
                        shares,
                        risk: wish.risk,
                    },
                    other => other,
                },
                ..estimate
            });
        }
        let more = (bound / wish.tolerance).powi(2) * 1.1;
        draws = (draws * more).min(1e4);
        round += 1;
    }
}

/// One round: about so many draws for each pair of cells of mean weight.
fn drawn(
    points: &[DVec3],
    cells: &Cells,
    edges: &Edges,
    draws: f64,
    risk: f64,
    chance: &mut Chance,
) -> Result<Estimate, KError> {
    let of_cells = cells.cells.len() as f64;
    let mut one = One {
        points,
        cells,
        edges,
        chance,
        draws: draws * (of_cells * (of_cells + 1.0) / 2.0).max(1.0),
        all: pairs(points.len()).max(1) as f64,
        from: vec![0.0; edges.bins()],
        beyond: vec![0.0; edges.bins()],
        variance: vec![0.0; edges.bins()],
        heaviest: 0.0,
        wrong: None,
    };
    let level = Registers::Best.level();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(avx512) = level.as_avx512() {
        use fearless_simd::Simd as _;
        avx512.vectorize(
            #[inline(always)]
            || one.all_cells(super::lanes::Wide(avx512)),
        );
        return one.done(risk);
    }
    dispatch!(level, simd => one.all_cells(Portable(simd)));
    one.done(risk)
}

/// Where a row starts in both cells: in the columns; the cell's first place in the order; and how far behind that.
type Row = [(usize, usize, usize); 2];

/// Cells of a tile: two of them are within the second-level cache, a million points in 1734 cells.
const TILE: usize = 64;

struct One<'a> {
    points: &'a [DVec3],
    cells: &'a Cells,
    edges: &'a Edges,
    chance: &'a mut Chance,
    /// Draws if every pair of cells had its share of them.
    draws: f64,
    /// All pairs of points.
    all: f64,
    /// Shares by the first bin that cells can reach.
    from: Vec<f64>,
    /// Estimated shares beyond the edge above each bin, and the estimated variances of those.
    beyond: Vec<f64>,
    variance: Vec<f64>,
    /// The greatest weight of a row.
    heaviest: f64,
    wrong: Option<KError>,
}

impl One<'_> {
    /// All pairs of cells, tile by tile: the points of two tiles stay at hand.
    #[inline(always)]
    fn all_cells<L: Lanes>(&mut self, on: L) {
        let len = self.cells.cells.len();
        for tile in (0..len).step_by(TILE) {
            for other in (tile..len).step_by(TILE) {
                for at in tile..(tile + TILE).min(len) {
                    self.some_cells(on, at, (at.max(other), (other + TILE).min(len)));
                }
            }
        }
    }

    /// A cell with some.
    #[inline(always)]
    fn some_cells<L: Lanes>(&mut self, on: L, at: usize, (first, end): (usize, usize)) {
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
    fn two_cells<L: Lanes>(&mut self, on: L, a: &Cell, b: &Cell, (first, last): (usize, usize)) {
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
            self.draw(on, rows, (first, last), weight);
        }
    }

    /// Where a row starts, in the columns and in the order, of both cells.
    #[inline(always)]
    fn row(&mut self, a: &Cell, b: &Cell, is_same: bool) -> Row {
        let bits = self.chance.draw();
        let from_a = scaled(bits, a.len);
        let from_b = if is_same {
            // Any other point of the cell, so that no point is paired with itself.
            (from_a + 1 + scaled(bits >> 32, a.len.saturating_sub(1))) % a.len.max(1)
        } else {
            scaled(bits >> 32, b.len)
        };
        [
            (a.column + from_a, a.first, from_a),
            (b.column + from_b, b.first, from_b),
        ]
    }

    /// Two rows at all edges that may be between.
    #[inline(always)]
    fn draw<L: Lanes>(
        &mut self,
        on: L,
        rows: [Row; 2],
        (first, last): (usize, usize),
        weight: f64,
    ) {
        let [row, other] = &rows;
        let (Some(dots), Some(others)) = (self.dots(on, row), self.dots(on, other)) else {
            return;
        };
        let cosines = self
            .edges
            .cosines_f32()
            .get(first..last)
            .unwrap_or_default();
        let beyond = self.beyond.get_mut(first..last).unwrap_or_default();
        let variance = self.variance.get_mut(first..last).unwrap_or_default();
        let share = weight / LANES as f64;
        let squared = share * share;
        let mut near = f32x16::splat(on.simd(), 4.0);
        let mut near_other = near;
        for ((cosine, beyond), variance) in cosines.iter().zip(beyond).zip(variance) {
            let (above, above_other) = (dots - *cosine, others - *cosine);
            near = on.nearer_nought(near, above);
            near_other = on.nearer_nought(near_other, above_other);
            let count = above.simd_lt(0.0).to_bitmask().count_ones().cast_signed();
            let count_other = above_other
                .simd_lt(0.0)
                .to_bitmask()
                .count_ones()
                .cast_signed();
            let difference = count - count_other;
            *beyond += share * f64::from(count + count_other);
            *variance += squared * f64::from(difference * difference);
        }
        if on
            .nearer_nought(near, near_other)
            .simd_le(F32_BAND)
            .any_true()
        {
            let mut stored = [[0.0; LANES]; 2];
            let [to, to_other] = &mut stored;
            dots.store_array(to);
            others.store_array(to_other);
            self.near(&rows, stored, (first, last), share);
        }
    }

    /// Puts right what f32 said of pairs too near to an edge for it.
    #[inline(never)]
    fn near(
        &mut self,
        rows: &[Row; 2],
        dots: [[f32; LANES]; 2],
        (first, last): (usize, usize),
        share: f64,
    ) {
        for edge in first..last {
            let Some(&cosine) = self.edges.cosines_f32().get(edge) else {
                return;
            };
            let is_near = |dot: &f32| (dot - cosine).abs() <= F32_BAND;
            if !dots.iter().flatten().any(is_near) {
                continue;
            }
            let [said, said_other] =
                dots.map(|dots| dots.iter().filter(|dot| **dot - cosine < 0.0).count() as f64);
            let [row, other] = rows
                .each_ref()
                .map(|row| exactly(self.points, self.cells, self.edges, row, edge));
            match (row, other) {
                (Ok(count), Ok(count_other)) => {
                    let more = count + count_other - said - said_other;
                    let squares = (count - count_other).powi(2) - (said - said_other).powi(2);
                    if let Some(beyond) = self.beyond.get_mut(edge) {
                        *beyond += share * more;
                    }
                    if let Some(variance) = self.variance.get_mut(edge) {
                        *variance += share * share * squares;
                    }
                }
                (Err(wrong), _) | (_, Err(wrong)) => self.wrong = Some(wrong),
            }
        }
    }

    /// Dot products of the pairs of a row.
    #[inline(always)]
    fn dots<L: Lanes>(&self, on: L, row: &Row) -> Option<f32x16<L::S>> {
        let [x, y, z] = &self.cells.columns;
        let [(a, ..), (b, ..)] = *row;
        let simd = on.simd();
        let ax = f32x16::load_array_ref(simd, x.get(a..)?.first_chunk()?);
        let ay = f32x16::load_array_ref(simd, y.get(a..)?.first_chunk()?);
        let az = f32x16::load_array_ref(simd, z.get(a..)?.first_chunk()?);
        let bx = f32x16::load_array_ref(simd, x.get(b..)?.first_chunk()?);
        let by = f32x16::load_array_ref(simd, y.get(b..)?.first_chunk()?);
        let bz = f32x16::load_array_ref(simd, z.get(b..)?.first_chunk()?);
        Some(az.mul_add(bz, ay.mul_add(by, ax * bx)))
    }

    fn done(self, risk: f64) -> Result<Estimate, KError> {
        if let Some(wrong) = self.wrong {
            return Err(wrong);
        }
        let largest_cell = self.cells.cells.iter().map(|cell| cell.len).max();
        // Places are not quite evenly drawn, by 32 bits; and sums of so many shares are rounded.
        let uneven = largest_cell.unwrap_or(0) as f64 / f64::from(1_u32 << 31) + 1e-9;
        let bins = self.edges.bins();
        // Three inequalities an edge: two sides of the sum, and one of the variance.
        let log = (3.0 * bins as f64 / risk).ln();
        let (mut shares, mut bounds) = (Vec::with_capacity(bins), Vec::with_capacity(bins));
        let mut sum = 0.0;
        for ((from, beyond), variance) in self.from.iter().zip(&self.beyond).zip(&self.variance) {
            sum += from;
            shares.push((sum - beyond).clamp(0.0, 1.0));
            let is_drawn = *beyond > 0.0 || *variance > 0.0 || shares.len() < bins;
            let bound = if is_drawn {
                bernstein(*variance, self.heaviest, log) + uneven
            } else {
                0.0
            };
            bounds.push(bound);
        }
        // All pairs are within pi.
        if let (Some(share), Some(bound)) = (shares.last_mut(), bounds.last_mut()) {
            (*share, *bound) = (1.0, 0.0);
        }
        Ok(Estimate {
            method: "sampled",
            edges: self.edges.clone(),
            shares,
            bound: Bound::Confidence {
                shares: bounds,
                risk,
            },
            points: self.points.len(),
        })
    }
}

/// How far a sum of independent numbers, each between 0 and `most`, is off its mean at most, but for `3 exp(-log)`.
///
/// The squares `Y` of differences within draws are independent, between 0 and `most2`, and their sum's mean is the variance `V`. So `V <= sum + sqrt(2 most2 V log)` but for
/// `exp(-log)` (Maurer 2003), which is solved for `V`. With it `e2 = 2 log (V + most e / 3)` (Bernstein) is solved for `e`.
fn bernstein(squares: f64, most: f64, log: f64) -> f64 {
    let root = most * (log / 2.0).sqrt();
    let deviation = root + (root * root + squares).sqrt();
    let third = most * log / 3.0;
    third + (third * third + 2.0 * log * deviation * deviation).sqrt()
}

/// How many pairs of a row are beyond an edge, by the real numbers.
#[cold]
fn exactly(
    points: &[DVec3],
    cells: &Cells,
    edges: &Edges,
    row: &Row,
    edge: usize,
) -> Result<f64, KError> {
    let len = |first: usize| {
        let at = cells.cells.partition_point(|cell| cell.first < first);
        cells.cells.get(at).map_or(1, |cell| cell.len)
    };
    let [a, b] = row.map(|(_, first, from)| (first, from, len(first)));
    let at = |(first, from, len): (usize, usize, usize), lane: usize| {
        let index = cells.order.get(first + (from + lane) % len);
        index.and_then(|index| points.get(*index as usize)).copied()
    };
    let mut beyond = 0.0;
    for lane in 0..LANES {
        let (Some(a), Some(b)) = (at(a, lane), at(b, lane)) else {
            continue;
        };
        if !edges.reaches(edge, a, b)? {
            beyond += 1.0;
        }
    }
    Ok(beyond)
}
