//! Exact counts for scans whose frames are rotated copies of the first, from the pairs of the first
//! frame alone.
//!
//! Points `i` of frame `k` and `j` of frame `k + d` are as far apart as `i` of frame 0 and `j` of
//! frame `d`, except for rounding. So each pair of frame 0 and any frame represents as many pairs
//! as there are frames that far apart. If it is so near to an edge that rounding could separate
//! them, each of those pairs is tested on its own. The counts equal those of [`super::exact()`].

use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use fearless_simd::{f32x16, prelude::*, u32x16};
use glam::{DQuat, DVec3};

use super::error::check;
use super::exact::{CountResult, on_threads};
use super::lanes::{AlignedLanes, LANES};
use super::leaf_pair::{F32_BAND, PairCounter, loaded};
use super::leaves_by_edge_count::{Bits, LeavesByEdgeCount};
use super::reach::BinRange;
use super::registers::LaneWork;
use super::sign_mask::SignMask;
use super::tree::{BLOCK_LEAVES, Tree};
use super::{Edges, KError, PairCounts, Registers};

/// The largest number of frames, so that all rows counted together fit in a lane of 32 bits.
pub const MOST_FRAMES: usize = 1 << 17;

/// Tolerance of a point's distance from its place in the rotated first frame; well within single
/// precision.
pub const TURNED_WITHIN: f64 = 3e-9;

/// Error of rotating a point in f64.
const TURNING_ERROR: f64 = 4e-15;

/// Rotation from each frame of a scan to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRotation {
    /// The axis, of length 1.
    pub axis: DVec3,
    /// Angle from one frame to the next in radians, right-handed.
    pub step_rad: f64,
    /// Number of frames. The points of the first frame come first, then those of the second in the
    /// same order, and so on.
    pub frames: usize,
}

impl FrameRotation {
    /// The largest distance of any point from its expected place, plus the error of that.
    fn farthest(&self, points: &[DVec3]) -> Result<f64, KError> {
        let wrong = || KError::Frames {
            points: points.len(),
            frames: self.frames,
        };
        let is_whole =
            (1..=MOST_FRAMES).contains(&self.frames) && points.len().is_multiple_of(self.frames);
        let size = points.len().checked_div(self.frames).filter(|_| is_whole);
        let size = size.ok_or_else(wrong)?;
        if (self.axis.length() - 1.0).abs() > 1e-9 {
            return Err(KError::NotTurned {
                frame: 0,
                index: 0,
                off: f64::NAN,
            });
        }
        let mut farthest = 0.0_f64;
        let (first, _) = points.split_at(size);
        for (k, frame) in points.chunks(size.max(1)).enumerate() {
            let turn = DQuat::from_axis_angle(self.axis.normalize(), k as f64 * self.step_rad);
            for (index, (p, from)) in frame.iter().zip(first).enumerate() {
                let off = (turn * *from).distance(*p) + TURNING_ERROR;
                if off.is_nan() || off > TURNED_WITHIN {
                    return Err(KError::NotTurned {
                        frame: k,
                        index,
                        off,
                    });
                }
                farthest = farthest.max(off);
            }
        }
        Ok(farthest)
    }
}

/// Counts every pair of a scan of rotated frames, bit for bit as [`super::exact()`] does.
///
/// # Errors
/// [`KError::NotTurned`] and [`KError::Frames`] if the points are not such a scan; otherwise as
/// [`super::exact()`].
pub fn turned(
    points: &[DVec3],
    rotation: &FrameRotation,
    edges: &Edges,
    threads: NonZeroUsize,
) -> Result<PairCounts, KError> {
    turned_by(Registers::Best, points, rotation, edges, threads)
}

/// The same with given registers.
///
/// # Errors
/// As [`turned()`].
pub fn turned_by(
    registers: Registers,
    points: &[DVec3],
    rotation: &FrameRotation,
    edges: &Edges,
    threads: NonZeroUsize,
) -> Result<PairCounts, KError> {
    check(points)?;
    let scan = TurnedScan::new(points, rotation, edges)?;
    let next = AtomicUsize::new(0);
    let work = || {
        let mut one = TurnedWorker {
            scan: &scan,
            counter: PairCounter::new(edges.bins()),
            on_edges: 0,
            wrong: None,
            next: &next,
        };
        registers.run(&mut one);
        one.done()
    };
    let (mut twice, mut on_edges) = on_threads(threads, edges.bins(), &work)?;
    // Every pair is counted from both ends, and every point with itself.
    for &p in points {
        let bin = edges.bin(p, p)?;
        if let Some(twice) = twice.get_mut(bin) {
            *twice -= 1;
        }
        let below = bin.checked_sub(1);
        let is_on = |bin| edges.is_on(bin, p, p);
        on_edges -= u64::from(is_on(bin) || below.is_some_and(is_on));
    }
    Ok(PairCounts {
        edges: edges.clone(),
        counts: twice
            .iter()
            .map(|twice| twice.cast_unsigned() / 2)
            .collect(),
        points: points.len(),
        on_edges: on_edges / 2,
    })
}

/// Rows that are counted together, so that leaves are fetched from memory once for all of them.
const ROWS: usize = 64;

/// The data that all threads read.
struct TurnedScan<'a> {
    points: &'a [DVec3],
    edges: &'a Edges,
    frames: usize,
    /// Points per frame.
    size: usize,
    /// Distance from an edge within which represented pairs may be on either side of it.
    band: f64,
    /// Tree of all points.
    tree: Tree,
    /// Number of pairs that a point of each leaf represents together with one of the first frame,
    /// counted from either end.
    weights: Vec<AlignedLanes<u32>>,
    /// Sums of the weights, per leaf and per block.
    leaf_weights: Vec<u64>,
    block_weights: Vec<u64>,
}

impl<'a> TurnedScan<'a> {
    fn new(
        points: &'a [DVec3],
        rotation: &FrameRotation,
        edges: &'a Edges,
    ) -> Result<Self, KError> {
        let farthest = rotation.farthest(points)?;
        let size = points.len() / rotation.frames.max(1);
        let tree = Tree::new(points);
        let frames = rotation.frames;
        // Within frame 0, both ends are counted directly.
        let weight = |index: u32| match index as usize / size.max(1) {
            0 => frames as u32,
            frame_distance => 2 * (frames.saturating_sub(frame_distance)) as u32,
        };
        let of_leaf = |leaf: &[u32]| {
            let mut weights = AlignedLanes([0; LANES]);
            for (to, index) in weights.0.iter_mut().zip(leaf) {
                *to = weight(*index);
            }
            weights
        };
        let weights: Vec<AlignedLanes<u32>> = tree.order.chunks(LANES).map(of_leaf).collect();
        let sum = |of: &AlignedLanes<u32>| of.0.iter().map(|&w| u64::from(w)).sum();
        let leaf_weights: Vec<u64> = weights.iter().map(sum).collect();
        let of_block = |first: usize, end: usize| {
            let of: &[u64] = leaf_weights.get(first..end).unwrap_or_default();
            of.iter().sum()
        };
        Ok(Self {
            // Both pairs are off by two points each; f64 and the width of an edge are added.
            band: 4.0 * farthest + 2e-14,
            block_weights: tree
                .blocks
                .iter()
                .map(|b| of_block(b.first, b.end))
                .collect(),
            points,
            edges,
            frames,
            size,
            tree,
            weights,
            leaf_weights,
        })
    }
}

impl TurnedScan<'_> {
    /// Counts a row with a leaf that edges cross; returns the dot products if any is too near to an
    /// edge.
    #[inline(always)]
    fn leaf<L: SignMask>(
        &self,
        on: L,
        [x, y, z]: [f32; 3],
        leaf: usize,
        cosines: &[f32],
        counted_lanes: &mut [AlignedLanes<u32>],
    ) -> Option<[f32; LANES]> {
        let simd = on.simd();
        let weights = u32x16::load_array_ref(simd, &self.weights.get(leaf)?.0);
        let [bx, by, bz] = loaded(simd, self.tree.leaves.get(leaf)?);
        let dot = bz.mul_add(z, by.mul_add(y, bx * x));
        let mut nearest = f32x16::splat(simd, 4.0);
        for (cosine, lanes) in cosines.iter().zip(counted_lanes) {
            let above = dot - *cosine;
            let beyond = above.simd_lt(0.0).select(weights, u32x16::splat(simd, 0));
            (u32x16::load_array_ref(simd, &lanes.0) + beyond).store_array(&mut lanes.0);
            nearest = on.nearer_zero(nearest, above);
        }
        nearest.simd_le(F32_BAND).any_true().then(|| {
            let mut dots = [0.0; LANES];
            dot.store_array(&mut dots);
            dots
        })
    }
}

/// The counts of one thread.
struct TurnedWorker<'a> {
    scan: &'a TurnedScan<'a>,
    counter: PairCounter,
    on_edges: u64,
    wrong: Option<KError>,
    /// The first row that no thread has taken.
    next: &'a AtomicUsize,
}

impl LaneWork for TurnedWorker<'_> {
    #[inline(always)]
    fn run<L: SignMask>(&mut self, on: L) {
        self.all(on);
    }
}

impl TurnedWorker<'_> {
    fn done(self) -> CountResult {
        match self.wrong {
            Some(wrong) => Err(wrong),
            None => Ok((self.counter.counts(&[]), self.on_edges)),
        }
    }

    /// Takes rows until none is left, and pairs each with all points.
    #[inline(always)]
    fn all<L: SignMask>(&mut self, on: L) {
        let scan = self.scan;
        loop {
            let start = self.next.fetch_add(ROWS, Ordering::Relaxed);
            let end = start.saturating_add(ROWS).min(scan.size);
            if start >= end {
                return;
            }
            for first_block in (0..scan.tree.blocks.len()).step_by(LANES) {
                self.rows(on, start..end, first_block);
            }
        }
    }

    /// Counts rows with sixteen blocks: one block with all rows before the next, so that it stays
    /// in the cache.
    #[inline(always)]
    fn rows<L: SignMask>(&mut self, on: L, rows: Range<usize>, first_block: usize) {
        let scan = self.scan;
        let (blocks, bins) = (&scan.tree.around_blocks, scan.edges.bins());
        let mut found = [([0.0; 3], BinRange::default()); ROWS];
        for (point, found) in scan.points.iter().skip(rows.start).zip(&mut found) {
            let at = point.as_vec3().to_array();
            if let Some(reach) = blocks.span_of_point(on.simd(), at, first_block, bins) {
                *found = (at, reach);
            }
        }
        for lane in 0..LANES.min(scan.tree.blocks.len() - first_block) {
            let block = first_block + lane;
            self.counter.settle(ROWS * BLOCK_LEAVES * 2 * scan.frames);
            for (row, (at, reach)) in rows.clone().zip(&found) {
                let first = reach.first[lane];
                if first == reach.last[lane] {
                    let weight = scan.block_weights.get(block);
                    self.counter.add(first as usize, weight.copied());
                } else {
                    self.block(on, (row, *at), block);
                }
            }
        }
    }

    /// Counts a row with the leaves of a block.
    #[inline(always)]
    fn block<L: SignMask>(&mut self, on: L, (row, at): (usize, [f32; 3]), block: usize) {
        let scan = self.scan;
        let Some(block) = scan.tree.blocks.get(block) else {
            return;
        };
        let (bins, leaves) = (scan.edges.bins(), &scan.tree.around_leaves);
        let mut others = LeavesByEdgeCount::default();
        let starts = (block.first..block.end).step_by(LANES);
        for (of, start) in others.reach.iter_mut().zip(starts) {
            if let Some(reach) = leaves.span_of_point(on.simd(), at, start, bins) {
                *of = reach;
            }
        }
        others.sort(on.simd(), block.end - block.first);
        for (leaf, index) in (block.first..block.end).zip(0..) {
            let weight = scan.leaf_weights.get(leaf);
            self.counter.add(others.bins(index).0, weight.copied());
        }
        let row = (row, at, block.first);
        self.few::<L, 1>(on, row, &others);
        self.few::<L, 2>(on, row, &others);
        self.few::<L, 3>(on, row, &others);
        for index in others.of::<4>().chain(Bits(others.many)) {
            let (first, last) = others.bins(index);
            let (cosines, lanes) = (scan.edges.cosines_f32(), &mut self.counter.lanes);
            let (Some(cosines), Some(lanes)) =
                (cosines.get(first..last), lanes.get_mut(first..last))
            else {
                continue;
            };
            let leaf = block.first + index;
            if let Some(dots) = scan.leaf(on, at, leaf, cosines, lanes) {
                self.near(row.0, leaf, first, last, dots);
            }
        }
    }

    /// Counts a row with leaves that `E` edges cross.
    #[inline(always)]
    fn few<L: SignMask, const E: usize>(
        &mut self,
        on: L,
        (row, at, start): (usize, [f32; 3], usize),
        others: &LeavesByEdgeCount,
    ) {
        let scan = self.scan;
        for index in others.of::<E>() {
            let (first, _) = others.bins(index);
            let (cosines, lanes) = (scan.edges.cosines_f32(), &mut self.counter.lanes);
            let (Some(cosines), Some(lanes)) = (cosines.get(first..), lanes.get_mut(first..))
            else {
                continue;
            };
            let (Some(cosines), Some(lanes)) =
                (cosines.first_chunk::<E>(), lanes.first_chunk_mut::<E>())
            else {
                continue;
            };
            if let Some(dots) = scan.leaf(on, at, start + index, cosines, lanes) {
                self.near(row, start + index, first, first + E, dots);
            }
        }
    }

    /// Tests the pairs that are too near to an edge for f32, and corrects their counts.
    #[inline(never)]
    fn near(&mut self, row: usize, leaf: usize, first: usize, last: usize, dots: [f32; LANES]) {
        let scan = self.scan;
        let cosines = scan
            .edges
            .cosines_f32()
            .get(first..last)
            .unwrap_or_default();
        let order = scan.tree.order.chunks(LANES).nth(leaf).unwrap_or_default();
        for (edge, cosine) in (first..).zip(cosines) {
            for (lane, (dot, index)) in dots.iter().zip(order).enumerate() {
                let above = dot - cosine;
                if above.abs() > F32_BAND {
                    continue;
                }
                let weights = scan.weights.get(leaf);
                let weight = weights
                    .and_then(|of| of.0.get(lane))
                    .map_or(0, |&w| i64::from(w));
                let counted = if above < 0.0 { weight } else { 0 };
                let beyond = self.beyond(edge, row, *index as usize, weight);
                if let Some(of) = self.counter.beyond.get_mut(edge) {
                    *of += beyond - counted;
                }
            }
        }
    }

    /// Number of represented pairs that are beyond an edge.
    fn beyond(&mut self, edge: usize, row: usize, index: usize, weight: i64) -> i64 {
        let scan = self.scan;
        let at = |index: usize| scan.points.get(index).copied().unwrap_or_default();
        let above = at(row).dot(at(index)) - scan.edges.cosine(edge);
        if above.abs() > scan.band {
            return if above < 0.0 { weight } else { 0 };
        }
        let frame_distance = index / scan.size.max(1);
        let ends = if frame_distance == 0 { 1 } else { 2 };
        let mut beyond = 0;
        for frame in 0..scan.frames.saturating_sub(frame_distance) {
            let (a, b) = (at(frame * scan.size + row), at(frame * scan.size + index));
            self.on_edges += u64::from(scan.edges.is_on(edge, a, b)) * ends;
            match scan.edges.reaches(edge, a, b) {
                Ok(reaches) => beyond += if reaches { 0 } else { ends.cast_signed() },
                Err(wrong) => self.wrong = Some(wrong),
            }
        }
        beyond
    }
}
