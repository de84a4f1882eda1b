//! A ray against a triangle in f64, without a gap between neighbours.
//!
//! After Woop, Benthin and Wald, Watertight Ray/Triangle Intersection (2013): the triangle is
//! translated and sheared until the ray is the z axis, which treats a vertex the same in every
//! triangle. The origin is inside if it is on one side of all three edges. The paper decides that
//! by a difference of products and repeats it in higher precision where it is zero. Here every
//! difference of products is Kahan's with a fused multiply-add (good to 1.5 units in the last
//! place; Jeannerod, Louvet and Muller 2013), so its sign is always right, and the weights of
//! slivers are right too: the hit is on the ray and within the triangle's box, so boxes may cull.
//! Fused and unfused operations are written out, so that every machine and every width gives the
//! same bits.

use fearless_simd::{Simd, f64x8, prelude::*};

/// Corners in the frame of a mesh, metres.
pub type Corners = [[f64; 3]; 3];

/// The axis along which a direction goes farthest; of equals the first.
#[inline(always)]
pub(super) fn steepest([x, y, z]: [f64; 3]) -> usize {
    let (x, y, z) = (x.abs(), y.abs(), z.abs());
    if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    }
}

/// Coordinates in cyclic order so that the given axis comes last.
#[inline(always)]
pub(super) fn turned<T>(axis: usize, [x, y, z]: [T; 3]) -> [T; 3] {
    match axis {
        0 => [y, z, x],
        1 => [z, x, y],
        _ => [x, y, z],
    }
}

/// A ray, and the shear that makes it the z axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShearedRay {
    axis: usize,
    origin: [f64; 3],
    shear: [f64; 2],
    stretch: f64,
}

impl ShearedRay {
    #[inline(always)]
    pub(super) fn new(origin: [f64; 3], direction: [f64; 3]) -> Self {
        let axis = steepest(direction);
        let [x, y, z] = turned(axis, direction);
        Self {
            axis,
            origin: turned(axis, origin),
            shear: [-(x / z), -(y / z)],
            stretch: z.recip(),
        }
    }

    /// A vertex where the ray is the z axis; its depth is not stretched yet.
    #[inline(always)]
    fn sheared(&self, corner: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = turned(self.axis, corner);
        let z = z - self.origin[2];
        [
            self.shear[0].mul_add(z, x - self.origin[0]),
            self.shear[1].mul_add(z, y - self.origin[1]),
            z,
        ]
    }

    /// Distance of the intersection in lengths of the direction; NaN without one.
    #[inline(always)]
    pub(super) fn meet(&self, corners: &Corners) -> f64 {
        let [a, b, c] = *corners;
        let (a, b, c) = (self.sheared(a), self.sheared(b), self.sheared(c));
        let weights = [edge(c, b), edge(a, c), edge(b, a)];
        let least = weights[0].min(weights[1]).min(weights[2]);
        let greatest = weights[0].max(weights[1]).max(weights[2]);
        if !(least >= 0.0 || greatest <= 0.0) {
            return f64::NAN;
        }
        let whole = weights[0] + weights[1] + weights[2];
        let depth = weights[0].mul_add(a[2], weights[1].mul_add(b[2], weights[2] * c[2]));
        // A triangle seen from its edge has no area: 0/0.
        depth * self.stretch / whole
    }
}

/// Twice the area between the origin and an edge: px qy - py qx.
#[inline(always)]
fn edge(p: [f64; 3], q: [f64; 3]) -> f64 {
    let product = p[1] * q[0];
    let rounding = (-p[1]).mul_add(q[0], product);
    p[0].mul_add(q[1], -product) + rounding
}

/// Eight rays with the same dominant axis, translated and sheared until each is the z axis, for
/// tests of single triangles. [`Caster`](super::Caster) is for scenes.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRays<S: Simd> {
    simd: S,
    axis: usize,
    origin: [f64x8<S>; 3],
    shear: [f64x8<S>; 2],
    stretch: f64x8<S>,
}

impl<S: Simd> ShearedRays<S> {
    /// Origins (metres) and directions by coordinate, with the dominant axis `axis` (0 x, 1 y, 2
    /// z).
    #[inline(always)]
    #[must_use]
    pub fn new(simd: S, axis: usize, origin: [f64x8<S>; 3], direction: [f64x8<S>; 3]) -> Self {
        let [x, y, z] = turned(axis, direction);
        Self {
            simd,
            axis,
            origin: turned(axis, origin),
            shear: [-(x / z), -(y / z)],
            stretch: f64x8::splat(simd, 1.0) / z,
        }
    }

    /// Like [`ShearedRay::sheared`], for eight rays.
    #[inline(always)]
    fn sheared(&self, corner: [f64; 3]) -> [f64x8<S>; 3] {
        let [x, y, z] = turned(self.axis, corner);
        let z = f64x8::splat(self.simd, z) - self.origin[2];
        let x = f64x8::splat(self.simd, x) - self.origin[0];
        let y = f64x8::splat(self.simd, y) - self.origin[1];
        [
            self.shear[0].mul_add_precise(z, x),
            self.shear[1].mul_add_precise(z, y),
            z,
        ]
    }

    /// Distances of the intersections in lengths of the directions, NaN without one; `None` if no
    /// ray meets the triangle.
    #[inline(always)]
    #[must_use]
    pub fn meet(&self, corners: &Corners) -> Option<f64x8<S>> {
        let [a, b, c] = *corners;
        let (a, b, c) = (self.sheared(a), self.sheared(b), self.sheared(c));
        let weights = [edge8(c, b), edge8(a, c), edge8(b, a)];
        let least = weights[0].min(weights[1]).min(weights[2]);
        let greatest = weights[0].max(weights[1]).max(weights[2]);
        let inside = least.simd_ge(0.0) | greatest.simd_le(0.0);
        if inside.to_bitmask() == 0 {
            return None;
        }
        let whole = weights[0] + weights[1] + weights[2];
        let depth =
            weights[0].mul_add_precise(a[2], weights[1].mul_add_precise(b[2], weights[2] * c[2]));
        let met = depth * self.stretch / whole;
        Some(inside.select(met, f64x8::splat(self.simd, f64::NAN)))
    }
}

/// Like [`edge`], for eight rays.
#[inline(always)]
fn edge8<S: Simd>(p: [f64x8<S>; 3], q: [f64x8<S>; 3]) -> f64x8<S> {
    let product = p[1] * q[0];
    let rounding = (-p[1]).mul_add_precise(q[0], product);
    p[0].mul_add_precise(q[1], -product) + rounding
}
