//! Test of one ray, or of eight nearly parallel rays, against boxes: which they may enter, and
//! where.
//!
//! Errors are on the safe side only. Everything is f32; slabs are moved outward by [`Beam::slack`],
//! more than all rounding of the test together (after Ize, Robust BVH Ray Traversal, 2013, whose
//! factors are relative to the slab; this slack is absolute and holds for beams of rays as well).

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};

use super::bvh::BvhNode;

/// Rounding of the test is below 2^-21 of the coordinates; doubled for both ends of an interval,
/// and doubled as a margin.
const SLACK: f64 = 1.0 / (1 << 19) as f64;
/// Smallest component of a direction; within any scene its effect is less than the slack.
const LEAST_DIRECTION: f64 = 1e-18;

/// The least and the greatest coordinate of rays along each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spread {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Spread {
    /// The greatest difference along any axis.
    #[inline(always)]
    pub(super) fn width(&self) -> f64 {
        let ([a, b, c], [d, e, f]) = (self.low, self.high);
        (d - a).max(e - b).max(f - c)
    }
}

/// Along one axis, where rays of one sign of direction meet the planes of boxes.
#[derive(Clone, Copy, Debug, Default)]
struct Axis {
    /// Number of the node's slab that is met first, 0..6.
    near: usize,
    far: usize,
    near_origin: f32,
    far_origin: f32,
    /// One over the direction: of the steepest and of the flattest ray.
    inverse: [f32; 2],
}

impl Axis {
    #[inline(always)]
    fn new(axis: usize, origin: &Spread, direction: &Spread, slack: f64) -> Self {
        let (from, to) = (origin.low[axis], origin.high[axis]);
        let (least, most) = (direction.low[axis], direction.high[axis]);
        let (low, high) = (2 * axis, 2 * axis + 1);
        if most >= 0.0 {
            let (steep, flat) = (most.max(LEAST_DIRECTION), least.max(LEAST_DIRECTION));
            Self {
                near: low,
                far: high,
                near_origin: (to + slack) as f32,
                far_origin: (from - slack) as f32,
                inverse: [1.0 / steep as f32, 1.0 / flat as f32],
            }
        } else {
            let (steep, flat) = (least.min(-LEAST_DIRECTION), most.min(-LEAST_DIRECTION));
            Self {
                near: high,
                far: low,
                near_origin: (from - slack) as f32,
                far_origin: (to + slack) as f32,
                inverse: [1.0 / steep as f32, 1.0 / flat as f32],
            }
        }
    }
}

/// Rays whose directions have the same signs: one, or several if `THICK`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam<const THICK: bool>([Axis; 3]);

impl Beam<false> {
    /// One ray, in a tree whose coordinates reach so far.
    #[inline(always)]
    pub(super) fn thin(origin: [f64; 3], direction: [f64; 3], reach_m: f64) -> Self {
        let origin = Spread {
            low: origin,
            high: origin,
        };
        let direction = Spread {
            low: direction,
            high: direction,
        };
        Self::about(&origin, &direction, reach_m)
    }
}

impl<const THICK: bool> Beam<THICK> {
    /// All rays between these origins and directions, in a tree with coordinates up to `reach_m`.
    #[inline(always)]
    pub(super) fn about(origin: &Spread, direction: &Spread, reach_m: f64) -> Self {
        let slack = Self::slack(origin, reach_m);
        Self([
            Axis::new(0, origin, direction, slack),
            Axis::new(1, origin, direction, slack),
            Axis::new(2, origin, direction, slack),
        ])
    }

    /// Distance by which slabs are moved outward, metres: the f32 rounding of the coordinates.
    #[inline(always)]
    fn slack(origin: &Spread, reach_m: f64) -> f64 {
        let mut far = reach_m;
        for axis in 0..3 {
            far = far.max(origin.low[axis].abs()).max(origin.high[axis].abs());
        }
        far * SLACK
    }

    /// Distances at which the beam may enter a node's boxes, and the mask of those that it enters
    /// no farther than `up_to`.
    #[inline(always)]
    pub(super) fn enter<S: Simd>(
        &self,
        simd: S,
        node: &BvhNode,
        up_to: f32,
    ) -> (f32x8<S>, mask32x8<S>) {
        let mut enter = f32x8::splat(simd, 0.0);
        let mut leave = f32x8::splat(simd, up_to);
        for axis in &self.0 {
            let [steep, flat] = axis.inverse;
            let near = f32x8::load_array_ref(simd, &node.slabs[axis.near % 6]) - axis.near_origin;
            let far = f32x8::load_array_ref(simd, &node.slabs[axis.far % 6]) - axis.far_origin;
            let (mut first, mut last) = (near * steep, far * steep);
            if THICK {
                first = first.min(near * flat);
                last = last.max(far * flat);
            }
            enter = enter.max(first);
            leave = leave.min(last);
        }
        (enter, enter.simd_le(leave))
    }
}

/// The largest distance at which a walk looks for hits.
#[inline(always)]
pub(super) fn up_to(range_m: f64) -> f32 {
    // The rounding is within the slack.
    range_m as f32
}
