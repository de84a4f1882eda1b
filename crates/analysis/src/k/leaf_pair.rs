//! Two leaves of sixteen points: how many of their 256 pairs are beyond each of a few edges.
//!
//! A row is one point of the first leaf against all of the second: dot products in f32, less the cosine of an edge. The sign says on which side of the edge a pair is,
//! unless it is nearer to it than [`F32_BAND`]: those few pairs are judged one by one, in f64 and without rounding. Left out: which leaves.

use fearless_simd::{Simd, f32x16, prelude::*, u32x16};

use super::lanes::{LANES, Lanes};
use super::tree::Leaf;

/// How far a dot product less a cosine in f32 may be off: 2^-21.
///
/// With u = 2^-24, lengths within 1e-6 of 1 and the cosine c: rounding of coordinates 2 u, of c 1 u, of products (none where they are fused) 1 u, of
/// the first sum 1 u, of the second 1 u, of the third 1 u where the cosine comes last; the last operation's own error is relative to its result and turns no sign. Together
/// below 7.1 u; 8 u is 2^-21. Sums are bounded by Cauchy's inequality.
pub(super) const F32_BAND: f32 = 1.0 / (1_u32 << 21) as f32;

/// Who says on which side of an edge a pair is.
pub(super) trait Judge {
    /// Whether the pair is beyond the edge above this bin: of these places among the points of one tree and the other.
    fn is_beyond(&mut self, edge: usize, a: usize, b: usize) -> bool;
}

/// What has been counted.
#[derive(Clone, Debug)]
pub(super) struct Tally {
    /// Pairs by the first bin that their leaves can reach.
    pub from: Vec<u64>,
    /// Pairs beyond the edge above each bin.
    pub beyond: Vec<i64>,
    /// The same by lanes, not yet added up.
    pub lanes: Vec<[u32; LANES]>,
    /// The most that a lane can hold.
    held: u32,
}

impl Tally {
    pub(super) fn new(bins: usize) -> Self {
        Self {
            from: vec![0; bins],
            beyond: vec![0; bins],
            lanes: vec![[0; LANES]; bins],
            held: 0,
        }
    }

    /// Adds up lanes before they can overflow by what is coming for each.
    pub(super) fn settle(&mut self, coming: usize) {
        let coming = u32::try_from(coming).unwrap_or(u32::MAX);
        if self.held.checked_add(coming).is_none() {
            self.add_up();
        }
        self.held = self.held.saturating_add(coming);
    }

    /// Adds pairs whose first bin this is.
    #[inline(always)]
    pub(super) fn add(&mut self, bin: usize, pairs: Option<u64>) {
        if let (Some(from), Some(pairs)) = (self.from.get_mut(bin), pairs) {
            *from += pairs;
        }
    }

    fn add_up(&mut self) {
        for (lanes, beyond) in self.lanes.iter_mut().zip(&mut self.beyond) {
            *beyond += lanes.iter().map(|&count| i64::from(count)).sum::<i64>();
            *lanes = [0; LANES];
        }
        self.held = 0;
    }

    /// Pairs by bin.
    pub(super) fn counts(mut self) -> Vec<i64> {
        self.add_up();
        let before = std::iter::once(&0).chain(&self.beyond);
        let all = self.from.iter().zip(&self.beyond).zip(before);
        all.map(|((&from, beyond), before)| from.cast_signed() - beyond + before)
            .collect()
    }
}

/// Counts the pairs of two full leaves that can be in the bins from `first` to `last`.
#[inline(always)]
pub(super) fn leaf_pair<L: Lanes>(
    on: L,
    (a, b): (&Leaf, &Leaf),
    (place_a, place_b): (usize, usize),
    (first, last): (usize, usize),
    cosines: &[f32],
    tally: &mut Tally,
    judge: &mut impl Judge,
) {
    if let Some(from) = tally.from.get_mut(first) {
        *from += (LANES * LANES) as u64;
    }
    let mut edge = first;
    while edge < last {
        let places = (place_a, place_b, edge);
        edge += match cosines.get(edge..last) {
            Some(&[a0]) => edges(on, a, b, places, [a0], tally, judge),
            Some(&[a0, a1]) => edges(on, a, b, places, [a0, a1], tally, judge),
            Some(&[a0, a1, a2]) => edges(on, a, b, places, [a0, a1, a2], tally, judge),
            Some(&[a0, a1, a2, a3, ..]) => edges(on, a, b, places, [a0, a1, a2, a3], tally, judge),
            _ => return,
        };
    }
}

/// The same for a few edges from one; says how many.
#[inline(always)]
fn edges<L: Lanes, const E: usize>(
    on: L,
    a: &Leaf,
    b: &Leaf,
    (place_a, place_b, edge): (usize, usize, usize),
    cosines: [f32; E],
    tally: &mut Tally,
    judge: &mut impl Judge,
) -> usize {
    let simd = on.simd();
    let lanes = b
        .each_ref()
        .map(|column| f32x16::load_array_ref(simd, column));
    let [ax, ay, az] = a;
    let mut notes = [u32x16::splat(simd, 0); E];
    // One an edge, so that none waits for another.
    let mut nearest = [f32x16::splat(simd, 4.0); E];
    for row in 0..LANES {
        let above = row_above(on, [ax[row], ay[row], az[row]], lanes, cosines);
        for ((notes, nearest), above) in notes.iter_mut().zip(&mut nearest).zip(&above) {
            *notes = on.note_negative(*notes, *above);
            *nearest = on.nearer_nought(*nearest, *above);
        }
    }
    let tallied = tally.lanes.get_mut(edge..edge + E).unwrap_or_default();
    for (notes, lanes) in notes.iter().zip(tallied) {
        let sum = u32x16::load_array_ref(simd, lanes) + on.notes(*notes);
        sum.store_array(lanes);
    }
    let mut least = f32x16::splat(simd, 4.0);
    for nearest in &nearest {
        least = on.nearer_nought(least, *nearest);
    }
    if least.simd_le(F32_BAND).any_true() {
        near(on, (a, b), (place_a, place_b, edge), cosines, tally, judge);
    }
    E
}

/// Dot products of one point with sixteen, less each cosine.
#[inline(always)]
fn row_above<L: Lanes, const E: usize>(
    on: L,
    [x, y, z]: [f32; 3],
    [bx, by, bz]: [f32x16<L::S>; 3],
    cosines: [f32; E],
) -> [f32x16<L::S>; E] {
    let simd = on.simd();
    let x = f32x16::splat(simd, x);
    let y = f32x16::splat(simd, y);
    let z = f32x16::splat(simd, z);
    if let [cosine] = cosines[..] {
        let first = bx.mul_add(x, f32x16::splat(simd, -cosine));
        let above = bz.mul_add(z, by.mul_add(y, first));
        return [above; E];
    }
    let mut above = [bz.mul_add(z, by.mul_add(y, bx * x)); E];
    // Not by `map`, which leaves the function that has the registers.
    for (above, cosine) in above.iter_mut().zip(&cosines) {
        *above -= f32x16::splat(simd, *cosine);
    }
    above
}

#[inline(always)]
pub(super) fn loaded<S: Simd>(simd: S, [x, y, z]: &Leaf) -> [f32x16<S>; 3] {
    [
        f32x16::load_array_ref(simd, x),
        f32x16::load_array_ref(simd, y),
        f32x16::load_array_ref(simd, z),
    ]
}

/// Judges those pairs that are too near to an edge for f32, and puts right what their signs had said.
#[inline(always)]
fn near<L: Lanes, const E: usize>(
    on: L,
    (a, b): (&Leaf, &Leaf),
    (place_a, place_b, edge): (usize, usize, usize),
    cosines: [f32; E],
    tally: &mut Tally,
    judge: &mut impl Judge,
) {
    let lanes = b
        .each_ref()
        .map(|column| f32x16::load_array_ref(on.simd(), column));
    let [ax, ay, az] = a;
    for row in 0..LANES {
        let above = row_above(on, [ax[row], ay[row], az[row]], lanes, cosines);
        for (edge, above) in (edge..).zip(&above) {
            let mut undecided = above.abs().simd_le(F32_BAND).to_bitmask();
            let negative = above
                .bitcast::<u32x16<L::S>>()
                .simd_ge(1 << 31)
                .to_bitmask();
            while undecided != 0 {
                let lane = undecided.trailing_zeros() as usize;
                undecided &= undecided - 1;
                let is_beyond = judge.is_beyond(edge, place_a + row, place_b + lane);
                let said = i64::from(negative >> lane & 1 == 1);
                if let Some(beyond) = tally.beyond.get_mut(edge) {
                    *beyond += i64::from(is_beyond) - said;
                }
            }
        }
    }
}
