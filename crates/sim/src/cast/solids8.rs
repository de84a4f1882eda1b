//! Sphere, box, cylinder and plane for eight rays at a time: the operations of [`super::solids`] in
//! the same order, so that the bits are the same.
//!
//! A branch there is a selection here; distances without an intersection are NaN.

use fearless_simd::{Simd, f64x8, mask64x8, prelude::*, u64x8};

use super::solids::{Cuboid, Cylinder, Plane, Sphere};

/// Coordinates of eight points or directions.
type Eight<S> = [f64x8<S>; 3];
/// Intersections of each line with a surface, like [`super::solids::Crossings`].
type Crossings8<S> = [(f64x8<S>, u64x8<S>); 2];

/// Like [`super::solids::first_above`], for eight lines.
#[inline(always)]
pub(super) fn first_above8<S: Simd>(
    [first, second]: Crossings8<S>,
    above_m: f64,
) -> (f64x8<S>, u64x8<S>) {
    let ahead = first.0.simd_gt(above_m);
    (
        ahead.select(first.0, second.0),
        ahead.select(first.1, second.1),
    )
}

#[inline(always)]
fn dot<S: Simd>([ax, ay, az]: Eight<S>, [bx, by, bz]: Eight<S>) -> f64x8<S> {
    ax * bx + ay * by + az * bz
}

impl Plane {
    #[inline(always)]
    pub(super) fn crossings8<S: Simd>(
        simd: S,
        [_, _, from]: Eight<S>,
        [_, _, along]: Eight<S>,
    ) -> Crossings8<S> {
        let nowhere = f64x8::splat(simd, f64::NAN);
        let at = along.simd_eq(0.0).select(nowhere, -from / along);
        let only = u64x8::splat(simd, 0);
        [(at, only), (nowhere, only)]
    }
}

impl Sphere {
    #[inline(always)]
    pub(super) fn crossings8<S: Simd>(
        &self,
        simd: S,
        origin: Eight<S>,
        direction: Eight<S>,
    ) -> Crossings8<S> {
        let nearest = -dot(origin, direction);
        let [[x, y, z], [dx, dy, dz]] = [origin, direction];
        let foot = [x + nearest * dx, y + nearest * dy, z + nearest * dz];
        let miss = dot(foot, foot).sqrt();
        let radius_m = f64x8::splat(simd, self.radius_m.abs());
        // For a miss the root is of a negative number: NaN.
        let half = ((radius_m - miss) * (radius_m + miss)).sqrt();
        let only = u64x8::splat(simd, 0);
        [(nearest - half, only), (nearest + half, only)]
    }
}

impl Cuboid {
    #[inline(always)]
    pub(super) fn crossings8<S: Simd>(
        &self,
        simd: S,
        [ox, oy, oz]: Eight<S>,
        [dx, dy, dz]: Eight<S>,
    ) -> Crossings8<S> {
        let none = u64x8::splat(simd, 0);
        let mut enter = (f64x8::splat(simd, f64::NEG_INFINITY), none);
        let mut leave = (f64x8::splat(simd, f64::INFINITY), none);
        let mut through = mask64x8::splat(simd, true);
        for (o, d, low, high, face) in [
            (ox, dx, self.low_m.x, self.high_m.x, 0),
            (oy, dy, self.low_m.y, self.high_m.y, 2),
            (oz, dz, self.low_m.z, self.high_m.z, 4),
        ] {
            let (near, far, within) = slab8(simd, o, d, low, high);
            through &= within;
            let (low_face, high_face) = (u64x8::splat(simd, face), u64x8::splat(simd, face + 1));
            let backward = d.simd_le(0.0);
            let later = near.simd_gt(enter.0);
            let entered = backward.select(high_face, low_face);
            enter = (later.select(near, enter.0), later.select(entered, enter.1));
            let sooner = far.simd_lt(leave.0);
            let left = backward.select(low_face, high_face);
            leave = (sooner.select(far, leave.0), sooner.select(left, leave.1));
        }
        where_there(simd, through, enter, leave)
    }
}

impl Cylinder {
    #[inline(always)]
    pub(super) fn crossings8<S: Simd>(
        &self,
        simd: S,
        [x, y, z]: Eight<S>,
        [dx, dy, dz]: Eight<S>,
    ) -> Crossings8<S> {
        let radius_m = f64x8::splat(simd, self.radius_m.abs());
        let level_squared = dx * dx + dy * dy;
        let miss = (x * dy - y * dx).abs() / level_squared.sqrt();
        let half_squared = (radius_m - miss) * (radius_m + miss);
        let nearest = -(x * dx + y * dy) / level_squared;
        // For a miss the root is of a negative number: NaN.
        let half = (half_squared / level_squared).sqrt();
        let (mut near, mut far) = (nearest - half, nearest + half);
        let mut through = mask64x8::splat(simd, true);
        let upright = level_squared.simd_eq(0.0);
        if upright.to_bitmask() != 0 {
            // Along the axis: within the circle for ever or never.
            through = !upright | (x * x + y * y).sqrt().simd_le(radius_m);
            near = upright.select(f64x8::splat(simd, f64::NEG_INFINITY), near);
            far = upright.select(f64x8::splat(simd, f64::INFINITY), far);
        }
        let (low, high, within) = slab8(simd, z, dz, self.bottom_m, self.top_m);
        through &= within;
        let mantle = u64x8::splat(simd, 0);
        if !self.capped {
            let nowhere = f64x8::splat(simd, f64::NAN);
            let met = |at: f64x8<S>| {
                let between = low.simd_le(at) & at.simd_le(high) & through;
                (between.select(at, nowhere), mantle)
            };
            return [met(near), met(far)];
        }
        let up = dz.simd_gt(0.0);
        let (bottom, top) = (u64x8::splat(simd, 1), u64x8::splat(simd, 2));
        let (first, last) = (up.select(bottom, top), up.select(top, bottom));
        let (by_end, out_by_end) = (low.simd_gt(near), high.simd_lt(far));
        let enter = (by_end.select(low, near), by_end.select(first, mantle));
        let leave = (
            out_by_end.select(high, far),
            out_by_end.select(last, mantle),
        );
        where_there(simd, through, enter, leave)
    }
}

/// Both crossings of the lines that go through.
#[inline(always)]
fn where_there<S: Simd>(
    simd: S,
    through: mask64x8<S>,
    enter: (f64x8<S>, u64x8<S>),
    leave: (f64x8<S>, u64x8<S>),
) -> Crossings8<S> {
    let nowhere = f64x8::splat(simd, f64::NAN);
    let through = through & enter.0.simd_le(leave.0);
    [
        (through.select(enter.0, nowhere), enter.1),
        (through.select(leave.0, nowhere), leave.1),
    ]
}

/// Like [`super::solids::slab`], for eight lines; the mask is of those that are ever within.
#[inline(always)]
fn slab8<S: Simd>(
    simd: S,
    origin: f64x8<S>,
    direction: f64x8<S>,
    low: f64,
    high: f64,
) -> (f64x8<S>, f64x8<S>, mask64x8<S>) {
    let (low, high) = (f64x8::splat(simd, low), f64x8::splat(simd, high));
    let (a, b) = ((low - origin) / direction, (high - origin) / direction);
    let forward = direction.simd_gt(0.0);
    let (mut near, mut far) = (forward.select(a, b), forward.select(b, a));
    let mut within = mask64x8::splat(simd, true);
    let parallel = direction.simd_eq(0.0);
    if parallel.to_bitmask() != 0 {
        within = !parallel | (low.simd_le(origin) & origin.simd_le(high));
        near = parallel.select(f64x8::splat(simd, f64::NEG_INFINITY), near);
        far = parallel.select(f64x8::splat(simd, f64::INFINITY), far);
    }
    (near, far, within)
}
