//! Exact counts of every pair, leaf by leaf.
//!
//! Blocks of leaves that lie within one bin of each other are counted by multiplication, and so are
//! leaves. `leaf_pair` counts the rest. Threads take blocks from a shared counter; integer sums do
//! not depend on the order.

use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use super::error::check;
use super::lanes::LANES;
use super::leaf_pair::{ExactBinTest, PairCounter, Rows, edges, leaf_pair, rows, thresholds};
use super::leaves_by_edge_count::{Bits, LeavesByEdgeCount};
use super::outline::Outline;
use super::registers::LaneWork;
use super::sign_mask::SignMask;
use super::tree::{BLOCK_LEAVES, LeafBlock, Tree};
use super::{Edges, KError, PairCounts, Registers};

/// Counts every pair of directions; the result does not depend on the number of threads.
///
/// # Errors
/// [`KError::NotUnit`] and [`KError::TooMany`] for invalid directions; [`KError::Undecided`].
pub fn exact(points: &[DVec3], edges: &Edges, threads: NonZeroUsize) -> Result<PairCounts, KError> {
    exact_by(Registers::Best, points, edges, threads)
}

/// The same with given registers.
///
/// # Errors
/// As [`exact()`].
pub fn exact_by(
    registers: Registers,
    points: &[DVec3],
    edges: &Edges,
    threads: NonZeroUsize,
) -> Result<PairCounts, KError> {
    check(points)?;
    let tree = Tree::new(points);
    let next = AtomicUsize::new(0);
    let work = || {
        let exact_test = ExactBinTest::new(&tree.points, edges);
        let mut one = ExactWorker {
            tree: &tree,
            edges,
            counter: PairCounter::new(edges.bins()),
            exact_test,
            next: &next,
        };
        registers.run(&mut one);
        one.done()
    };
    let (counts, on_edges) = on_threads(threads, edges.bins(), &work)?;
    Ok(PairCounts {
        edges: edges.clone(),
        counts: counts.into_iter().map(i64::cast_unsigned).collect(),
        points: points.len(),
        on_edges,
    })
}

/// Pairs per bin, and pairs on edges.
pub(super) type CountResult = Result<(Vec<i64>, u64), KError>;

/// Runs `work` on this thread and on as many others as the system starts, up to `threads` in all;
/// the sum of their counts.
pub(super) fn on_threads(
    threads: NonZeroUsize,
    bins: usize,
    work: &(impl Fn() -> CountResult + Sync),
) -> CountResult {
    let parts = std::thread::scope(|scope| {
        let start = |_| std::thread::Builder::new().spawn_scoped(scope, work).ok();
        let others: Vec<_> = (1..threads.get()).map_while(start).collect();
        let mut parts = vec![work()];
        let joined = others.into_iter().map(|other| other.join());
        parts.extend(joined.map(|part| part.unwrap_or_else(|panic| resume_unwind(panic))));
        parts
    });
    let mut sum = (vec![0; bins], 0);
    for part in parts {
        let (counts, on_edges) = part?;
        sum.1 += on_edges;
        for (sum, count) in sum.0.iter_mut().zip(counts) {
            *sum += count;
        }
    }
    Ok(sum)
}

/// The counts of one thread.
struct ExactWorker<'a> {
    tree: &'a Tree,
    edges: &'a Edges,
    counter: PairCounter,
    exact_test: ExactBinTest<'a>,
    /// The next block that no thread has taken.
    next: &'a AtomicUsize,
}

impl LaneWork for ExactWorker<'_> {
    #[inline(always)]
    fn run<L: SignMask>(&mut self, on: L) {
        self.all(on);
    }
}

impl ExactWorker<'_> {
    fn done(self) -> CountResult {
        match self.exact_test.wrong {
            Some(wrong) => Err(wrong),
            None => Ok((
                self.counter.counts(&self.exact_test.beyond),
                self.exact_test.on_edges,
            )),
        }
    }

    /// Takes blocks until none is left, and pairs each with those that are not before it.
    #[inline(always)]
    fn all<L: SignMask>(&mut self, on: L) {
        let tree = self.tree;
        let thresholds = thresholds::<L>(self.edges);
        let mut waiting = Vec::new();
        loop {
            let first = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(block) = tree.blocks.get(first) else {
                return;
            };
            waiting.extend(tree.nodes.len().checked_sub(1));
            while let Some(at) = waiting.pop() {
                let Some(node) = tree.nodes.get(at) else {
                    continue;
                };
                if node.end_block <= first {
                    continue;
                }
                let is_behind = node.first_block > first;
                if is_behind && self.is_in_one_bin(block, at) {
                    continue;
                }
                match (node.halves, tree.blocks.get(node.first_block)) {
                    (Some((left, right)), _) => waiting.extend([right, left]),
                    (None, Some(other)) => self.blocks(on, (block, other), &thresholds),
                    (None, None) => {}
                }
            }
        }
    }

    /// Whether all pairs of a block and a later node are in one bin; counts them if so.
    fn is_in_one_bin(&mut self, block: &LeafBlock, at: usize) -> bool {
        let tree = self.tree;
        let Some(node) = tree.nodes.get(at) else {
            return false;
        };
        let (least, greatest) = block.circle.angles(&node.circle);
        let bins = self.edges.bins();
        let bin = |angle: f64| {
            let bin = angle * bins as f64 / std::f64::consts::PI;
            (bin as usize).min(bins - 1)
        };
        // The angles are rounded outward by more than the error of this arithmetic.
        if bin(least) != bin(greatest) {
            return false;
        }
        let ends = (
            tree.blocks.get(node.first_block),
            tree.blocks.get(node.end_block - 1),
        );
        let (Some(first), Some(end)) = ends else {
            return false;
        };
        let pairs = tree.points_of(block.first, block.end) * tree.points_of(first.first, end.end);
        if let Some(from) = self.counter.from.get_mut(bin(least)) {
            *from += pairs as u64;
        }
        true
    }

    /// Counts all pairs of leaves of two blocks, or of one block with itself.
    #[inline(always)]
    fn blocks<L: SignMask>(
        &mut self,
        on: L,
        (block, other): (&LeafBlock, &LeafBlock),
        thresholds: &[f32],
    ) {
        let tree = self.tree;
        // The largest number of rows added to a lane.
        self.counter.settle(BLOCK_LEAVES * BLOCK_LEAVES * LANES * 2);
        // All ranges are computed first, so that none waits for another.
        let mut found = [(0, LeavesByEdgeCount::default()); BLOCK_LEAVES];
        for (leaf, found) in (block.first..block.end).zip(&mut found) {
            *found = self.reached(on, leaf, other);
        }
        for (leaf, (start, others)) in (block.first..block.end).zip(&found) {
            let Some(a) = tree.leaves.get(leaf) else {
                continue;
            };
            let rows = rows::<L>(a);
            let leaves = (leaf, &rows, *start);
            self.few::<L, 0>(on, leaves, others, thresholds);
            self.few::<L, 1>(on, leaves, others, thresholds);
            self.few::<L, 2>(on, leaves, others, thresholds);
            self.few::<L, 3>(on, leaves, others, thresholds);
            self.few::<L, 4>(on, leaves, others, thresholds);
            self.many(on, leaves, others, thresholds);
        }
        self.exact_test.settle();
    }

    /// Bin ranges of a leaf and the later full leaves of a block, and the first of those leaves.
    /// Pairs with incomplete leaves are counted.
    #[inline(always)]
    fn reached<L: SignMask>(
        &mut self,
        on: L,
        leaf: usize,
        other: &LeafBlock,
    ) -> (usize, LeavesByEdgeCount) {
        let tree = self.tree;
        let mut others = LeavesByEdgeCount::default();
        let Some(around) = tree.around_leaves.one(leaf) else {
            return (other.end, others);
        };
        if !tree.is_full(leaf) {
            self.not_full(on, leaf, &around, other.first.max(leaf)..other.end);
            return (other.end, others);
        }
        let start = if other.first <= leaf {
            self.not_full(on, leaf, &around, leaf..leaf + 1);
            leaf + 1
        } else {
            other.first
        };
        // Only the very last leaf may be incomplete.
        let end = other.end.min(tree.points.len() / LANES);
        self.not_full(on, leaf, &around, end.max(start)..other.end);
        for (of, start) in others.reach.iter_mut().zip((start..end).step_by(LANES)) {
            let (bins, leaves) = (self.edges.bins(), &tree.around_leaves);
            if let Some(reach) = leaves.span(on.simd(), &around, start, bins) {
                *of = reach;
            }
        }
        others.sort(on.simd(), end.saturating_sub(start));
        (start, others)
    }

    /// Counts a leaf with others to which it has `E` edges.
    #[inline(always)]
    fn few<L: SignMask, const E: usize>(
        &mut self,
        on: L,
        (leaf, rows, start): (usize, &Rows, usize),
        others: &LeavesByEdgeCount,
        thresholds: &[f32],
    ) {
        for at in others.of::<E>() {
            let (first, _) = others.bins(at);
            self.counter.add(first, Some((LANES * LANES) as u64));
            if E == 0 {
                continue;
            }
            let of = thresholds.get(first..).and_then(<[f32]>::first_chunk);
            if let (Some(b), Some(of)) = (self.tree.leaves.get(start + at), of) {
                let places = (leaf * LANES, (start + at) * LANES, first);
                let (counter, exact_test) = (&mut self.counter, &mut self.exact_test);
                // Rows are read from memory each time. A compiler that keeps 48 numbers in
                // registers of sixteen lanes has to spill them all.
                let rows = std::hint::black_box(rows);
                edges::<L, E>(on, rows, b, places, *of, counter, exact_test);
            }
        }
    }

    /// Counts a leaf with others to which it has more edges.
    #[inline(always)]
    fn many<L: SignMask>(
        &mut self,
        on: L,
        (leaf, rows, start): (usize, &Rows, usize),
        others: &LeavesByEdgeCount,
        thresholds: &[f32],
    ) {
        for at in Bits(others.many) {
            let bins = others.bins(at);
            self.counter.add(bins.0, Some((LANES * LANES) as u64));
            if let Some(b) = self.tree.leaves.get(start + at) {
                let places = (leaf * LANES, (start + at) * LANES);
                let (counter, exact_test) = (&mut self.counter, &mut self.exact_test);
                leaf_pair(on, (rows, b), places, bins, thresholds, counter, exact_test);
            }
        }
    }

    /// Counts a leaf with itself or with incomplete leaves.
    #[inline(always)]
    fn not_full<L: SignMask>(
        &mut self,
        on: L,
        leaf: usize,
        around: &Outline,
        others: std::ops::Range<usize>,
    ) {
        for other in others {
            let leaves = &self.tree.around_leaves;
            let Some(of) = leaves.span(on.simd(), around, other, self.edges.bins()) else {
                continue;
            };
            let ([first, ..], [last, ..]) = (of.first, of.last);
            self.one_by_one(leaf, other, (first as usize, last as usize));
        }
    }

    /// Counts the pairs of a leaf with itself or with an incomplete leaf, one by one.
    fn one_by_one(&mut self, leaf: usize, other: usize, (first, last): (usize, usize)) {
        let end = |leaf: usize| ((leaf + 1) * LANES).min(self.tree.points.len());
        for a in leaf * LANES..end(leaf) {
            let start = if leaf == other { a + 1 } else { other * LANES };
            for b in start..end(other) {
                let mut bin = first;
                while bin < last && self.exact_test.is_beyond(bin, a, b) {
                    bin += 1;
                }
                if let Some(from) = self.counter.from.get_mut(bin) {
                    *from += 1;
                }
            }
        }
    }
}
