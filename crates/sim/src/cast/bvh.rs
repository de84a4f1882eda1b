//! The tree of boxes: up to eight children a node, one item a leaf unless its [`Quality`] says
//! otherwise, so that every triangle has a box of its own and one step tests eight of them.
//!
//! Boxes are f32 and contain their items with a margin. Their contents are tested in f64, so boxes
//! decide what is tested and never what is hit.

use fearless_simd::{Simd, prelude::*};

use super::beam::Beam;
use super::build::{self, Quality};

/// Set in a child that is items.
const LEAF: u32 = 1 << 31;
/// Bit position in a leaf of the number of items that follow its first.
const MORE: u32 = 27;
/// The most items of a leaf.
pub(super) const MOST_SHARING: usize = 16;
/// The most items: a balanced tree of them has nine levels.
pub(super) const MOST_ITEMS: usize = 1 << MORE;

/// The child of `count` items from `first` on: 1 to [`MOST_SHARING`] of them, below [`MOST_ITEMS`].
pub(super) const fn leaf(first: usize, count: usize) -> u32 {
    first as u32 | (count as u32 - 1) << MORE | LEAF
}

/// The first item of a leaf and its last.
#[inline(always)]
const fn items(leaf: u32) -> (u32, u32) {
    let first = leaf & (MOST_ITEMS as u32 - 1);
    (first, first + (leaf >> MORE & (MOST_SHARING as u32 - 1)))
}
/// The most levels that [`build`] makes.
pub(super) const LEVELS: usize = 18;
/// Room for seven waiting children on every level, and a power of two.
const STACK: usize = 128;

/// A box, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BoundingBox {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl BoundingBox {
    pub(super) const EMPTY: Self = Self {
        low: [f64::INFINITY; 3],
        high: [f64::NEG_INFINITY; 3],
    };

    /// The least box about points.
    pub(super) fn of(points: impl IntoIterator<Item = [f64; 3]>) -> Self {
        let mut bounds = Self::EMPTY;
        for point in points {
            bounds.join(&Self {
                low: point,
                high: point,
            });
        }
        bounds
    }

    pub(super) fn join(&mut self, other: &Self) {
        for axis in 0..3 {
            self.low[axis] = self.low[axis].min(other.low[axis]);
            self.high[axis] = self.high[axis].max(other.high[axis]);
        }
    }

    /// Twice the middle along an axis.
    pub(super) fn middle2(&self, axis: usize) -> f64 {
        self.low[axis] + self.high[axis]
    }

    /// Half the surface; 0 for an empty box.
    pub(super) fn area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| (self.high[axis] - self.low[axis]).max(0.0));
        x * y + y * z + z * x
    }

    /// The greatest coordinate, either sign; 0 for an empty box.
    pub(super) fn reach(&self) -> f64 {
        let greatest = |corner: &[f64; 3]| corner.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        if self.low[0] > self.high[0] {
            return 0.0;
        }
        greatest(&self.low).max(greatest(&self.high))
    }
}

/// Eight boxes and what is in them.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(super) struct BvhNode {
    /// Low x, high x, low y, high y, low z, high z; an unused child has an empty box.
    pub slabs: [[f32; 8]; 6],
    /// A node, or items with [`LEAF`] ([`leaf`]).
    pub child: [u32; 8],
}

impl BvhNode {
    pub(super) const EMPTY: Self = Self {
        slabs: [
            [f32::MAX; 8],
            [f32::MIN; 8],
            [f32::MAX; 8],
            [f32::MIN; 8],
            [f32::MAX; 8],
            [f32::MIN; 8],
        ],
        child: [LEAF; 8],
    };
}

/// A tree over items that are known by their number.
#[derive(Clone, Debug)]
pub(super) struct Bvh {
    /// The first is the root.
    pub(super) nodes: Vec<BvhNode>,
    /// The greatest coordinate of any box.
    pub(super) reach_m: f64,
}

/// A child that waits for its turn.
#[derive(Clone, Copy, Debug, Default)]
struct Waiting {
    enter: f32,
    node: u32,
}

/// Stack of waiting children; made once for many rays.
#[derive(Clone, Debug)]
pub(super) struct Stack([Waiting; STACK]);

impl Stack {
    pub(super) const fn new() -> Self {
        Self(
            [Waiting {
                enter: 0.0,
                node: 0,
            }; STACK],
        )
    }
}

impl Bvh {
    /// A tree over items with these boxes, and the order of its leaves: leaf `i` is item
    /// `order[i]`.
    pub(super) fn over(boxes: &[BoundingBox], quality: Quality) -> (Self, Vec<u32>) {
        build::build(boxes, quality)
    }

    /// Calls `visit` for every item whose box the beam may enter no farther than `up_to`, roughly
    /// the nearest first; it answers how far is of interest from then on.
    #[inline(always)]
    pub(super) fn walk<S: Simd, const THICK: bool>(
        &self,
        simd: S,
        stack: &mut Stack,
        beam: &Beam<THICK>,
        up_to: f32,
        mut visit: impl FnMut(u32) -> f32,
    ) {
        let stack = &mut stack.0;
        let mut up_to = up_to;
        let mut top = 0;
        let mut index = 0;
        while let Some(node) = self.nodes.get(index) {
            let (enter, within) = beam.enter(simd, node, up_to);
            let enter: [f32; 8] = enter.into();
            let mut within = within.to_bitmask();
            let floor = top;
            while within != 0 {
                let lane = (within.trailing_zeros() & 7) as usize;
                within &= within - 1;
                let (child, enter) = (node.child[lane], enter[lane]);
                if child & LEAF != 0 {
                    if enter <= up_to {
                        let (mut item, last) = items(child);
                        loop {
                            up_to = visit(item);
                            if item >= last {
                                break;
                            }
                            item += 1;
                        }
                    }
                    continue;
                }
                // The nearest last, so that it is taken first.
                let mut at = top;
                while at > floor && stack[(at - 1) % STACK].enter < enter {
                    stack[at % STACK] = stack[(at - 1) % STACK];
                    at -= 1;
                }
                stack[at % STACK] = Waiting { enter, node: child };
                top += 1;
            }
            index = loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                let waiting = stack[top % STACK];
                if waiting.enter <= up_to {
                    break waiting.node as usize;
                }
            };
        }
    }
}
