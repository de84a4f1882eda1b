//! Two leaves of sixteen points: how many of their 256 pairs are beyond each of a few edges.
//!
//! A row is one point of the first leaf against all of the second: dot products in f32, less the
//! cosine of an edge. The sign says on which side of the edge a pair is, unless it is nearer to it
//! than [`F32_BAND`]: those few pairs are decided one by one, in f64 and without rounding.

use fearless_simd::{Simd, f32x16, prelude::*, u32x16};
use glam::DVec3;

use super::edges::{ON_EDGE, dot};
use super::lanes::{AlignedLanes, LANES};
use super::sign_mask::SignMask;
use super::tree::Leaf;
use super::{Edges, KError};

/// Bound of the error of a dot product less a cosine in f32: 2^-21.
///
/// With u = 2^-24, lengths within 1e-6 of 1 and the cosine c: rounding of coordinates 2 u, of c 1
/// u, of products (none where they are fused) 1 u, of the first sum 1 u, of the second 1 u, of the
/// third 1 u where the cosine comes last; the last operation's own error is relative to its result
/// and turns no sign. Together below 7.1 u; 8 u is 2^-21. Sums are bounded by Cauchy's inequality.
pub(super) const F32_BAND: f32 = 1.0 / (1_u32 << 21) as f32;

/// The exact test of the side of an edge on which a pair lies, with a queue of pairs.
pub(super) struct ExactBinTest<'a> {
    points: &'a [DVec3],
    edges: &'a Edges,
    /// Pairs are tested together, since their points are far apart in memory.
    waiting: Vec<QueuedPair>,
    /// Tested pairs beyond each edge, less those already counted as beyond it.
    pub beyond: Vec<i64>,
    pub on_edges: u64,
    pub wrong: Option<KError>,
}

/// A pair, an edge, and whether the pair is counted as beyond it.
struct QueuedPair {
    edge: usize,
    pair: (usize, usize),
    counted: bool,
}

impl<'a> ExactBinTest<'a> {
    pub(super) fn new(points: &'a [DVec3], edges: &'a Edges) -> Self {
        Self {
            points,
            edges,
            waiting: Vec::new(),
            beyond: vec![0; edges.bins()],
            on_edges: 0,
            wrong: None,
        }
    }

    pub(super) fn is_beyond(&mut self, edge: usize, a: usize, b: usize) -> bool {
        let (Some(&a), Some(&b)) = (self.points.get(a), self.points.get(b)) else {
            return false;
        };
        self.on_edges += u64::from(self.edges.is_on(edge, a, b));
        match self.edges.reaches(edge, a, b) {
            Ok(reaches) => !reaches,
            Err(wrong) => {
                self.wrong = Some(wrong);
                false
            }
        }
    }

    /// Tests the queued pairs.
    #[inline(never)]
    pub(super) fn settle(&mut self) {
        let mut waiting = std::mem::take(&mut self.waiting);
        for QueuedPair {
            edge,
            pair,
            counted,
        } in waiting.drain(..)
        {
            let (Some(&a), Some(&b)) = (self.points.get(pair.0), self.points.get(pair.1)) else {
                continue;
            };
            let above = dot(a, b) - self.edges.cosine(edge);
            // Without a branch to predict, the next points are fetched before these have arrived.
            let is_beyond = if above.abs() > ON_EDGE {
                above < 0.0
            } else {
                self.is_beyond(edge, pair.0, pair.1)
            };
            if let Some(beyond) = self.beyond.get_mut(edge) {
                *beyond += i64::from(is_beyond) - i64::from(counted);
            }
        }
        self.waiting = waiting;
    }

    /// Queues the pair of points `a` and `b`, which f32 cannot assign to a side of the upper edge
    /// of a bin. `counted` tells whether it is counted as beyond the edge.
    #[inline(always)]
    fn recheck(&mut self, edge: usize, a: usize, b: usize, counted: bool) {
        let pair = (a, b);
        self.waiting.push(QueuedPair {
            edge,
            pair,
            counted,
        });
    }
}

/// Counts of pairs.
#[derive(Clone, Debug)]
pub(super) struct PairCounter {
    /// Pairs by the first bin that their leaves can reach.
    pub from: Vec<u64>,
    /// Pairs beyond the edge above each bin.
    pub beyond: Vec<i64>,
    /// The same by lanes, not yet added up.
    pub lanes: Vec<AlignedLanes<u32>>,
    /// Bound on the count in a lane.
    held: u32,
}

impl PairCounter {
    pub(super) fn new(bins: usize) -> Self {
        Self {
            from: vec![0; bins],
            beyond: vec![0; bins],
            lanes: vec![AlignedLanes([0; LANES]); bins],
            held: 0,
        }
    }

    /// Adds up the lanes if `coming` more pairs per lane could overflow them.
    pub(super) fn settle(&mut self, coming: usize) {
        let coming = u32::try_from(coming).unwrap_or(u32::MAX);
        if self.held.checked_add(coming).is_none() {
            self.add_up();
        }
        self.held = self.held.saturating_add(coming);
    }

    /// Adds pairs whose first bin is `bin`.
    #[inline(always)]
    pub(super) fn add(&mut self, bin: usize, pairs: Option<u64>) {
        if let (Some(from), Some(pairs)) = (self.from.get_mut(bin), pairs) {
            *from += pairs;
        }
    }

    fn add_up(&mut self) {
        for (lanes, beyond) in self.lanes.iter_mut().zip(&mut self.beyond) {
            *beyond += lanes.0.iter().map(|&count| i64::from(count)).sum::<i64>();
            lanes.0 = [0; LANES];
        }
        self.held = 0;
    }

    /// Pairs per bin, with `more` pairs beyond each edge.
    pub(super) fn counts(mut self, more: &[i64]) -> Vec<i64> {
        self.add_up();
        for (beyond, more) in self.beyond.iter_mut().zip(more) {
            *beyond += more;
        }
        let before = std::iter::once(&0).chain(&self.beyond);
        let all = self.from.iter().zip(&self.beyond).zip(before);
        all.map(|((&from, beyond), before)| from.cast_signed() - beyond + before)
            .collect()
    }
}

/// The points of a leaf as rows, in the scale of the sign masks.
pub(super) type Rows = [[f32; 3]; LANES];

/// The points of a full leaf as rows.
#[inline(always)]
pub(super) fn rows<L: SignMask>(leaf: &Leaf) -> Rows {
    let [AlignedLanes(x), AlignedLanes(y), AlignedLanes(z)] = leaf;
    let mut rows = [[0.0; 3]; LANES];
    for (((row, x), y), z) in rows.iter_mut().zip(x).zip(y).zip(z) {
        *row = [x * L::SCALE, y * L::SCALE, z * L::SCALE];
    }
    rows
}

/// Thresholds of dot products: the cosine of every inner edge, shifted and scaled for the
/// sign masks.
pub(super) fn thresholds<L: SignMask>(edges: &Edges) -> Vec<f32> {
    let inner = 0..edges.bins().saturating_sub(1);
    let moved = inner.map(|edge| edges.cosine(edge) - f64::from(L::MOVED));
    moved
        .map(|cosine| (cosine * f64::from(L::SCALE)) as f32)
        .collect()
}

/// Counts the pairs of two full leaves beyond each of the edges `first..last`.
#[inline(always)]
pub(super) fn leaf_pair<L: SignMask>(
    on: L,
    (a, b): (&Rows, &Leaf),
    (place_a, place_b): (usize, usize),
    (first, last): (usize, usize),
    thresholds: &[f32],
    counter: &mut PairCounter,
    exact_test: &mut ExactBinTest<'_>,
) {
    let mut edge = first;
    while edge < last {
        let places = (place_a, place_b, edge);
        edge += match thresholds.get(edge..last) {
            Some(&[a0]) => edges(on, a, b, places, [a0], counter, exact_test),
            Some(&[a0, a1]) => edges(on, a, b, places, [a0, a1], counter, exact_test),
            Some(&[a0, a1, a2]) => edges(on, a, b, places, [a0, a1, a2], counter, exact_test),
            Some(&[a0, a1, a2, a3, ..]) => {
                edges(on, a, b, places, [a0, a1, a2, a3], counter, exact_test)
            }
            _ => return,
        };
    }
}

/// The same for `E` edges from one on; returns `E`.
#[inline(always)]
pub(super) fn edges<L: SignMask, const E: usize>(
    on: L,
    a: &Rows,
    b: &Leaf,
    (place_a, place_b, edge): (usize, usize, usize),
    thresholds: [f32; E],
    counter: &mut PairCounter,
    exact_test: &mut ExactBinTest<'_>,
) -> usize {
    let lanes = loaded(on.simd(), b);
    // One per edge, so that none waits for another.
    let mut masks = [on.empty_mask(); E];
    for [row, next] in a.as_chunks().0 {
        let above = row_above(on, *row, lanes, thresholds);
        let next_above = row_above(on, *next, lanes, thresholds);
        for ((masks, above), next) in masks.iter_mut().zip(above).zip(next_above) {
            on.record(masks, above, next);
        }
    }
    let counted_lanes = counter.lanes.get_mut(edge..edge + E).unwrap_or_default();
    if !on.add_up(&masks, counted_lanes) {
        return E;
    }
    if L::MASK_NAMES_PAIRS {
        for (edge, masks) in (edge..).zip(masks) {
            recheck_masked(on, masks, (place_a, place_b, edge), exact_test);
        }
    } else {
        near(on, (a, b), (place_a, place_b, edge), thresholds, exact_test);
    }
    E
}

/// Tests the pairs that the mask marks as too near to an edge for f32; none of them is counted as
/// beyond it.
#[inline(always)]
fn recheck_masked<L: SignMask>(
    on: L,
    masks: L::Mask,
    (place_a, place_b, edge): (usize, usize, usize),
    exact_test: &mut ExactBinTest<'_>,
) {
    let (mut words, which) = on.which(masks);
    while words != 0 {
        let word = words.trailing_zeros() as usize;
        words &= words - 1;
        let mut rows = which.get(word).copied().unwrap_or_default();
        while rows != 0 {
            // Two bits per row from the top, of two rows in turn.
            let row = rows.leading_zeros() as usize + word % 2;
            let lane = word / 2;
            rows &= !(0x8000_u16 >> rows.leading_zeros());
            exact_test.recheck(edge, place_a + row, place_b + lane, false);
        }
    }
}

/// Dot products of one point with sixteen, less each threshold.
#[inline(always)]
fn row_above<L: SignMask, const E: usize>(
    on: L,
    [x, y, z]: [f32; 3],
    [bx, by, bz]: [f32x16<L::S>; 3],
    thresholds: [f32; E],
) -> [f32x16<L::S>; E] {
    let simd = on.simd();
    let x = f32x16::splat(simd, x);
    let y = f32x16::splat(simd, y);
    let z = f32x16::splat(simd, z);
    if let [threshold] = thresholds[..] {
        let first = bx.mul_add(x, f32x16::splat(simd, -threshold));
        let above = bz.mul_add(z, by.mul_add(y, first));
        return [above; E];
    }
    let mut above = [bz.mul_add(z, by.mul_add(y, bx * x)); E];
    // `map` would leave the function that has the registers.
    for (above, threshold) in above.iter_mut().zip(&thresholds) {
        *above -= f32x16::splat(simd, *threshold);
    }
    above
}

#[inline(always)]
pub(super) fn loaded<S: Simd>(simd: S, [x, y, z]: &Leaf) -> [f32x16<S>; 3] {
    [
        f32x16::load_array_ref(simd, &x.0),
        f32x16::load_array_ref(simd, &y.0),
        f32x16::load_array_ref(simd, &z.0),
    ]
}

/// Tests the pairs that are too near to an edge for f32.
#[inline(always)]
fn near<L: SignMask, const E: usize>(
    on: L,
    (a, b): (&Rows, &Leaf),
    (place_a, place_b, edge): (usize, usize, usize),
    thresholds: [f32; E],
    exact_test: &mut ExactBinTest<'_>,
) {
    let lanes = loaded(on.simd(), b);
    for (row, at) in a.iter().enumerate() {
        let above = row_above(on, *at, lanes, thresholds);
        for (edge, above) in (edge..).zip(&above) {
            let mut undecided = on.undecided(*above);
            let negative = above
                .bitcast::<u32x16<L::S>>()
                .simd_ge(1 << 31)
                .to_bitmask();
            while undecided != 0 {
                let lane = undecided.trailing_zeros() as usize;
                undecided &= undecided - 1;
                let counted = negative >> lane & 1 == 1;
                exact_test.recheck(edge, place_a + row, place_b + lane, counted);
            }
        }
    }
}
