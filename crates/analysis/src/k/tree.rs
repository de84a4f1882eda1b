//! Directions in leaves of sixteen neighbours, with the extent of leaves and of blocks of leaves.
//!
//! The points are halved along the sphere down to leaves. The extent is a circle, rounded outward.

use glam::{DVec3, Vec3};

use super::lanes::{AlignedLanes, LANES};
use super::outline::{self, Outline, Outlines};
use super::reach::CircleF32;

/// The largest number of leaves in a block.
pub(super) const BLOCK_LEAVES: usize = 32;

/// A circle on the sphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    pub middle: DVec3,
    /// Radians, up to pi.
    pub radius: f64,
}

impl Circle {
    /// The bounding circle of points; the whole sphere if their sum is zero.
    pub(super) fn around<'a>(points: impl Iterator<Item = &'a DVec3> + Clone) -> Self {
        let sum: DVec3 = points.clone().sum();
        let Some(middle) = sum.try_normalize() else {
            return Self {
                middle: DVec3::X,
                radius: std::f64::consts::PI,
            };
        };
        let chord = points.map(|p| p.distance_squared(middle));
        let chord = chord.fold(0.0, f64::max).sqrt();
        // Lengths of 1 within 1e-6 turn a chord by less than 2e-6.
        let radius = 2.0 * (chord / 2.0).min(1.0).asin() + 4e-6;
        Self { middle, radius }
    }

    /// The smallest and the largest angle between points of the two circles in radians, rounded
    /// outward.
    pub(super) fn angles(&self, other: &Self) -> (f64, f64) {
        let apart = self.middle.dot(other.middle).clamp(-1.0, 1.0).acos();
        let reach = self.radius + other.radius + 1e-6;
        ((apart - reach).max(0.0), apart + reach)
    }
}

/// Circles in f32 in columns, with [`LANES`] extra entries so that sixteen can be read anywhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Circles {
    middles: [Vec<f32>; 3],
    /// Rounded up.
    radii: Vec<f32>,
}

impl Circles {
    pub(super) fn new(circles: &[Circle]) -> Self {
        let column = |of: fn(DVec3) -> f64| {
            let middles = circles.iter().map(|circle| of(circle.middle) as f32);
            middles.chain([0.0; LANES]).collect::<Vec<f32>>()
        };
        let radii = circles.iter().map(|circle| circle.radius as f32);
        let radii = radii.map(|radius| radius * (1.0 + 1e-6) + 1e-6);
        Self {
            middles: [column(|m| m.x), column(|m| m.y), column(|m| m.z)],
            radii: radii.chain([0.0; LANES]).collect(),
        }
    }

    #[inline(always)]
    pub(super) fn one(&self, at: usize) -> Option<CircleF32> {
        let [x, y, z] = &self.middles;
        Some(CircleF32 {
            middle: [*x.get(at)?, *y.get(at)?, *z.get(at)?],
            radius: *self.radii.get(at)?,
        })
    }

    /// Sixteen circles from one on, in columns.
    #[inline(always)]
    pub(super) fn sixteen(&self, from: usize) -> Option<([&[f32; LANES]; 3], &[f32; LANES])> {
        let [x, y, z] = &self.middles;
        let x = x.get(from..)?.first_chunk()?;
        let y = y.get(from..)?.first_chunk()?;
        let z = z.get(from..)?.first_chunk()?;
        Some(([x, y, z], self.radii.get(from..)?.first_chunk()?))
    }
}

/// Consecutive leaves, at most [`BLOCK_LEAVES`].
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafBlock {
    pub first: usize,
    /// End (exclusive).
    pub end: usize,
    pub circle: Circle,
}

/// Consecutive blocks: a node above the blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreeNode {
    pub first_block: usize,
    pub end_block: usize,
    pub circle: Circle,
    /// Indices of its halves among the nodes; `None` for a single block.
    pub halves: Option<(usize, usize)>,
}

/// Coordinates of sixteen points; missing ones are zero.
pub(super) type Leaf = [AlignedLanes<f32>; 3];

/// Directions in leaves.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    /// The points in the order of the leaves.
    pub points: Vec<DVec3>,
    /// Index in the input of each point.
    pub order: Vec<u32>,
    pub leaves: Vec<Leaf>,
    pub around_leaves: Outlines,
    pub blocks: Vec<LeafBlock>,
    pub around_blocks: Outlines,
    /// The last is the root; empty without points.
    pub nodes: Vec<TreeNode>,
}

/// A point to be sorted.
#[derive(Clone, Copy)]
struct TreePoint {
    at: [f32; 3],
    index: u32,
    /// Its coordinate along the direction of the current cut.
    key: f32,
}

impl Tree {
    pub(super) fn new(points: &[DVec3]) -> Self {
        let sorted = points.iter().zip(0_u32..);
        let mut sorted: Vec<TreePoint> = sorted
            .map(|(p, index)| TreePoint {
                at: p.as_vec3().to_array(),
                index,
                key: 0.0,
            })
            .collect();
        let mut blocks = Vec::new();
        halve(&mut sorted, 0, &mut blocks);
        let order: Vec<u32> = sorted.iter().map(|s| s.index).collect();
        Self::ordered(points, order, blocks)
    }

    /// Builds leaves and blocks from a known order.
    fn ordered(points: &[DVec3], order: Vec<u32>, blocks: Vec<(usize, usize)>) -> Self {
        let of = |index: &u32| points.get(*index as usize).copied();
        let points: Vec<DVec3> = order.iter().filter_map(of).collect();
        let leaves: Vec<Leaf> = points.chunks(LANES).map(leaf).collect();
        let around_leaves: Vec<Outline> = points.chunks(LANES).map(outline::around).collect();
        let of_block = |&(first, end): &(usize, usize)| {
            let from = first * LANES..(end * LANES).min(points.len());
            points.get(from).unwrap_or_default()
        };
        let around_blocks = blocks.iter().map(|block| outline::around(of_block(block)));
        let around_blocks: Vec<Outline> = around_blocks.collect();
        let block = |of: &(usize, usize)| LeafBlock {
            first: of.0,
            end: of.1,
            circle: Circle::around(of_block(of).iter()),
        };
        let blocks: Vec<LeafBlock> = blocks.iter().map(block).collect();
        let mut tree = Self {
            around_leaves: Outlines::new(&around_leaves),
            blocks,
            around_blocks: Outlines::new(&around_blocks),
            points,
            order,
            leaves,
            nodes: Vec::new(),
        };
        if !tree.blocks.is_empty() {
            tree.add_nodes(0, tree.blocks.len());
        }
        tree
    }

    /// Whether a leaf has sixteen points.
    #[inline]
    pub(super) fn is_full(&self, leaf: usize) -> bool {
        (leaf + 1) * LANES <= self.points.len()
    }

    /// Number of points of these leaves.
    pub(super) fn points_of(&self, first: usize, end: usize) -> usize {
        (end * LANES)
            .min(self.points.len())
            .saturating_sub(first * LANES)
    }

    fn add_nodes(&mut self, first_block: usize, end_block: usize) -> usize {
        let (halves, circle) = if end_block - first_block <= 1 {
            (None, self.blocks.get(first_block).map(|block| block.circle))
        } else {
            let middle = first_block.midpoint(end_block);
            let halves = (
                self.add_nodes(first_block, middle),
                self.add_nodes(middle, end_block),
            );
            let first = self.blocks.get(first_block).map_or(0, |block| block.first);
            let end = self.blocks.get(end_block - 1).map_or(0, |block| block.end);
            let points = first * LANES..(end * LANES).min(self.points.len());
            let points = self.points.get(points).unwrap_or_default();
            (Some(halves), Some(Circle::around(points.iter())))
        };
        let everything = Circle {
            middle: DVec3::X,
            radius: std::f64::consts::PI,
        };
        self.nodes.push(TreeNode {
            first_block,
            end_block,
            circle: circle.unwrap_or(everything),
            halves,
        });
        self.nodes.len() - 1
    }
}

/// Sorts points into leaves, and records the leaves of every block.
fn halve(points: &mut [TreePoint], first_leaf: usize, blocks: &mut Vec<(usize, usize)>) {
    let leaves = points.len().div_ceil(LANES);
    if leaves == 0 {
        return;
    }
    let is_block = leaves <= BLOCK_LEAVES;
    // The first block on the way down that is small enough; its halves are within it.
    if is_block && blocks.last().is_none_or(|&(_, end)| end <= first_leaf) {
        blocks.push((first_leaf, first_leaf + leaves));
    }
    if leaves == 1 {
        return;
    }
    let left = leaves / 2;
    let middle = left * LANES;
    let along = widest(points);
    for s in points.iter_mut() {
        s.key = Vec3::from(s.at).dot(along);
    }
    points.select_nth_unstable_by(middle, |a, b| a.key.total_cmp(&b.key));
    let (before, behind) = points.split_at_mut(middle);
    halve(before, first_leaf, blocks);
    halve(behind, first_leaf + left, blocks);
}

/// The one of two tangents along which the points extend farther. The tangents change little from
/// place to place, so that leaves are nearly square.
fn widest(points: &[TreePoint]) -> Vec3 {
    let sum: Vec3 = points.iter().map(|s| Vec3::from(s.at)).sum();
    let (e, f) = sum
        .try_normalize()
        .unwrap_or(Vec3::X)
        .any_orthonormal_pair();
    let width = |along: Vec3| {
        let places = points.iter().map(|s| Vec3::from(s.at).dot(along));
        let (low, high) = places.fold((f32::MAX, f32::MIN), |(low, high), at| {
            (low.min(at), high.max(at))
        });
        high - low
    };
    if width(e) >= width(f) { e } else { f }
}

fn leaf(points: &[DVec3]) -> Leaf {
    let mut leaf = [AlignedLanes([0.0; LANES]); 3];
    let [AlignedLanes(x), AlignedLanes(y), AlignedLanes(z)] = &mut leaf;
    for (((p, x), y), z) in points.iter().zip(x).zip(y).zip(z) {
        (*x, *y, *z) = (p.x as f32, p.y as f32, p.z as f32);
    }
    leaf
}
