//! Every pair, leaf by leaf.
//!
//! Blocks of leaves that lie within one bin of each other are counted by multiplication, leaves likewise; what is left is
//! `leaf_pair`'s. Threads take blocks from a common list; sums of whole numbers do not know who made them. Left out: trees.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};

use fearless_simd::dispatch;
use glam::DVec3;

use super::lanes::{LANES, Lanes, Portable};
use super::leaf_pair::{Judge, Tally, leaf_pair};
use super::plain::check;
use super::reach::reach;
use super::tree::{BLOCK_LEAVES, Block, Tree};
use super::{Counts, Edges, KError, Registers};

/// Counts every pair of directions, on so many threads; the counts do not hang on how many.
///
/// # Errors
/// [`KError::NotUnit`] and [`KError::TooMany`] for what are not directions, [`KError::Undecided`].
pub fn exact(points: &[DVec3], edges: &Edges, threads: NonZeroUsize) -> Result<Counts, KError> {
    exact_by(Registers::Best, points, edges, threads)
}

/// The same with some registers.
///
/// # Errors
/// As [`exact()`].
pub fn exact_by(
    registers: Registers,
    points: &[DVec3],
    edges: &Edges,
    threads: NonZeroUsize,
) -> Result<Counts, KError> {
    check(points)?;
    let level = registers.level();
    let tree = Tree::new(points);
    let next = AtomicUsize::new(0);
    let work = || {
        let judge = ByReals::new(&tree.points, edges);
        let mut one = One {
            tree: &tree,
            edges,
            tally: Tally::new(edges.bins()),
            judge,
        };
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        if let Some(avx512) = level.as_avx512() {
            use fearless_simd::Simd as _;
            avx512.vectorize(
                #[inline(always)]
                || one.all(super::lanes::Wide(avx512), &next),
            );
            return one.done();
        }
        dispatch!(level, simd => one.all(Portable(simd), &next));
        one.done()
    };
    let parts = on_threads(threads, &work);
    let mut counts = vec![0_u64; edges.bins()];
    let mut on_edges = 0;
    for part in parts {
        let (of, on) = part?;
        on_edges += on;
        for (count, of) in counts.iter_mut().zip(of) {
            *count = count.wrapping_add_signed(of);
        }
    }
    Ok(Counts {
        edges: edges.clone(),
        counts,
        points: points.len(),
        on_edges,
    })
}

/// Does the same on the caller's thread and on others, as many as the system starts.
pub(super) fn on_threads<T: Send>(threads: NonZeroUsize, work: &(impl Fn() -> T + Sync)) -> Vec<T> {
    std::thread::scope(|scope| {
        let start = |_| std::thread::Builder::new().spawn_scoped(scope, work).ok();
        let others: Vec<_> = (1..threads.get()).map_while(start).collect();
        let mut parts = vec![work()];
        for other in others {
            match other.join() {
                Ok(part) => parts.push(part),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        parts
    })
}

/// Sides by the real numbers.
pub(super) struct ByReals<'a> {
    points: &'a [DVec3],
    edges: &'a Edges,
    pub on_edges: u64,
    pub wrong: Option<KError>,
}

impl<'a> ByReals<'a> {
    pub(super) const fn new(points: &'a [DVec3], edges: &'a Edges) -> Self {
        Self {
            points,
            edges,
            on_edges: 0,
            wrong: None,
        }
    }
}

impl Judge for ByReals<'_> {
    #[inline]
    fn is_beyond(&mut self, edge: usize, a: usize, b: usize) -> bool {
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
}

/// What one thread counts.
struct One<'a> {
    tree: &'a Tree,
    edges: &'a Edges,
    tally: Tally,
    judge: ByReals<'a>,
}

impl One<'_> {
    fn done(self) -> Result<(Vec<i64>, u64), KError> {
        match self.judge.wrong {
            Some(wrong) => Err(wrong),
            None => Ok((self.tally.counts(), self.judge.on_edges)),
        }
    }

    /// Takes blocks until none is left, each with all that are not before it.
    #[inline(always)]
    fn all<L: Lanes>(&mut self, on: L, next: &AtomicUsize) {
        let tree = self.tree;
        let mut waiting = Vec::new();
        loop {
            let first = next.fetch_add(1, Ordering::Relaxed);
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
                    (None, Some(other)) => self.blocks(on, block, other),
                    (None, None) => {}
                }
            }
        }
    }

    /// Whether all pairs of a block and a node behind it are in one bin; they are counted then.
    fn is_in_one_bin(&mut self, block: &Block, at: usize) -> bool {
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
        // The angles are rounded outward by more than this arithmetic is off.
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
        if let Some(from) = self.tally.from.get_mut(bin(least)) {
            *from += pairs as u64;
        }
        true
    }

    /// All pairs of leaves of two blocks, or of one with itself.
    #[inline(always)]
    fn blocks<L: Lanes>(&mut self, on: L, block: &Block, other: &Block) {
        let tree = self.tree;
        let (bins, cosines) = (self.edges.bins(), self.edges.cosines_f32());
        // So many rows at most are added to a lane.
        self.tally.settle(BLOCK_LEAVES * BLOCK_LEAVES * LANES);
        for leaf in block.first..block.end {
            let Some(around) = tree.around_leaves.one(leaf) else {
                continue;
            };
            let mut start = other.first.max(leaf);
            while start < other.end {
                let Some((middles, radii)) = tree.around_leaves.sixteen(start) else {
                    break;
                };
                let of = reach(on.simd(), around, middles, radii, bins);
                let others = (start..other.end).zip(&of.first).zip(&of.last);
                for ((other, first), last) in others {
                    let bins = (*first as usize, *last as usize);
                    if other == leaf || !tree.is_full(other) || !tree.is_full(leaf) {
                        self.one_by_one(leaf, other, bins);
                        continue;
                    }
                    if let (Some(a), Some(b)) = (tree.leaves.get(leaf), tree.leaves.get(other)) {
                        let places = (leaf * LANES, other * LANES);
                        let (tally, judge) = (&mut self.tally, &mut self.judge);
                        leaf_pair(on, (a, b), places, bins, cosines, tally, judge);
                    }
                }
                start += LANES;
            }
        }
    }

    /// The pairs of a leaf with itself, or of leaves of which one is not full.
    fn one_by_one(&mut self, leaf: usize, other: usize, (first, last): (usize, usize)) {
        let end = |leaf: usize| ((leaf + 1) * LANES).min(self.tree.points.len());
        for a in leaf * LANES..end(leaf) {
            let start = if leaf == other { a + 1 } else { other * LANES };
            for b in start..end(other) {
                let mut bin = first;
                while bin < last && self.judge.is_beyond(bin, a, b) {
                    bin += 1;
                }
                if let Some(from) = self.tally.from.get_mut(bin) {
                    *from += 1;
                }
            }
        }
    }
}
