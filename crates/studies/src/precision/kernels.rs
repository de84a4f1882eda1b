//! Two intersection tests of eight rays with triangles, in f32 and f64.
//!
//! All are written alike for the same registers, so that only the numbers differ.

use crate::placing::Float;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch, f32x8, f64x8, prelude::*};
use sim::cast::ShearedRays;

/// Rays per packet.
pub const LANES: usize = 8;

/// Eight rays by coordinate, whose largest direction component is on one axis.
pub struct Eight<T> {
    pub axis: usize,
    pub origin: [[T; LANES]; 3],
    pub direction: [[T; LANES]; 3],
}

/// Triangles, and rays to test against all of them.
pub struct Patch<T> {
    pub triangles: Vec<[[T; 3]; 3]>,
    pub packets: Vec<Eight<T>>,
}

/// The test of all patches: the range of every ray, packet after packet, infinite for none.
pub type Cast<T> = fn(&[Patch<T>], &mut [[T; LANES]]);

/// A test in one of the number types.
#[derive(Clone, Copy)]
pub enum Kernel {
    F32(Cast<f32>),
    F64(Cast<f64>),
}

/// Name, label and function of the tests.
pub const KERNELS: [(&str, &str, Kernel); 4] = [
    (
        "Moeller-Trumbore in f32",
        "M-T f32",
        Kernel::F32(moeller_f32),
    ),
    (
        "Moeller-Trumbore in f64",
        "M-T f64",
        Kernel::F64(moeller_f64),
    ),
    (
        "watertight in f32",
        "tight f32",
        Kernel::F32(watertight_f32),
    ),
    (
        "watertight in f64 (velomotion's)",
        "tight f64",
        Kernel::F64(casters),
    ),
];

macro_rules! kernels {
    ($($name:ident: $number:ty, $vector:ident, $test:ident;)*) => {$(
        pub fn $name(patches: &[Patch<$number>], ranges: &mut [[$number; LANES]]) {
            dispatch!(Level::new(), simd => all(patches, ranges, #[inline(always)] |triangles, rays| {
                let nearest: $vector<_> = $test(simd, triangles, rays);
                nearest.into()
            }));
        }
    )*};
}

kernels! {
    moeller_f32: f32, f32x8, moeller;
    moeller_f64: f64, f64x8, moeller;
    watertight_f32: f32, f32x8, watertight;
    casters: f64, f64x8, sheared;
}

// For comparison with the caster's own.
#[cfg(test)]
kernels! {
    watertight_f64: f64, f64x8, watertight;
}

/// Every packet of every patch.
#[inline(always)]
fn all<T: Float>(
    patches: &[Patch<T>],
    ranges: &mut [[T; LANES]],
    nearest: impl Fn(&[[[T; 3]; 3]], &Eight<T>) -> [T; LANES],
) {
    let mut ranges = ranges.iter_mut();
    for patch in patches {
        for (rays, range) in patch.packets.iter().zip(&mut ranges) {
            *range = nearest(&patch.triangles, rays);
        }
    }
}

/// A vector by coordinate, one per lane. There are no closures below, since code that is not
/// inlined is not compiled for the registers.
type Three<V> = [V; 3];

#[inline(always)]
fn loaded<S: Simd, T: Float, V: SimdFloat<S> + SimdBase<S, Element = T>>(
    simd: S,
    [x, y, z]: &[[T; LANES]; 3],
) -> Three<V> {
    [
        V::from_slice(simd, x),
        V::from_slice(simd, y),
        V::from_slice(simd, z),
    ]
}

#[inline(always)]
fn everywhere<S: Simd, T: Float, V: SimdFloat<S> + SimdBase<S, Element = T>>(
    simd: S,
    [x, y, z]: [T; 3],
) -> Three<V> {
    [V::splat(simd, x), V::splat(simd, y), V::splat(simd, z)]
}

#[inline(always)]
fn between<T: Float>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
}

#[inline(always)]
fn minus<S: Simd, V: SimdFloat<S>>(a: Three<V>, b: Three<V>) -> Three<V> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn cross<S: Simd, V: SimdFloat<S>>(a: Three<V>, b: Three<V>) -> Three<V> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
fn dot<S: Simd, V: SimdFloat<S>>(a: Three<V>, b: Three<V>) -> V {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection (1997), for both sides of
/// a triangle.
#[inline(always)]
fn moeller<S: Simd, T: Float, V: SimdFloat<S> + SimdBase<S, Element = T>>(
    simd: S,
    triangles: &[[[T; 3]; 3]],
    rays: &Eight<T>,
) -> V {
    let from: Three<V> = loaded(simd, &rays.origin);
    let along: Three<V> = loaded(simd, &rays.direction);
    let zero = V::splat(simd, T::of(0.0));
    let one = V::splat(simd, T::of(1.0));
    let mut nearest = V::splat(simd, T::of(f64::INFINITY));
    for [a, b, c] in triangles {
        let ab: Three<V> = everywhere(simd, between(a, b));
        let ac: Three<V> = everywhere(simd, between(a, c));
        let across = cross(along, ac);
        let inverse = one / dot(ab, across);
        let off = minus(from, everywhere(simd, *a));
        let u = dot(off, across) * inverse;
        let around = cross(off, ab);
        let v = dot(along, around) * inverse;
        // Comparisons with NaN are false.
        let inside = u.simd_ge(zero) & v.simd_ge(zero) & (u + v).simd_le(one);
        if !inside.any_true() {
            continue;
        }
        let range = dot(ac, around) * inverse;
        let nearer = inside & range.simd_gt(zero) & range.simd_lt(nearest);
        nearest = nearer.select(range, nearest);
    }
    nearest
}

/// The caster's test (`sim::cast::ShearedRays`) in any number type.
#[inline(always)]
fn watertight<S: Simd, T: Float, V: SimdFloat<S> + SimdBase<S, Element = T>>(
    simd: S,
    triangles: &[[[T; 3]; 3]],
    rays: &Eight<T>,
) -> V {
    let zero = V::splat(simd, T::of(0.0));
    let axis = rays.axis;
    let from: Three<V> = turned(axis, loaded(simd, &rays.origin));
    let [x, y, z]: Three<V> = turned(axis, loaded(simd, &rays.direction));
    let shear = [zero - x / z, zero - y / z];
    let stretch = V::splat(simd, T::of(1.0)) / z;
    let mut nearest = V::splat(simd, T::of(f64::INFINITY));
    for [a, b, c] in triangles {
        let a = moved(shear, minus(everywhere(simd, turned(axis, *a)), from));
        let b = moved(shear, minus(everywhere(simd, turned(axis, *b)), from));
        let c = moved(shear, minus(everywhere(simd, turned(axis, *c)), from));
        let weights = [edge(zero, c, b), edge(zero, a, c), edge(zero, b, a)];
        let least = weights[0].min(weights[1]).min(weights[2]);
        let greatest = weights[0].max(weights[1]).max(weights[2]);
        let inside = least.simd_ge(zero) | greatest.simd_le(zero);
        if !inside.any_true() {
            continue;
        }
        let whole = weights[0] + weights[1] + weights[2];
        let depth =
            weights[0].mul_add_precise(a[2], weights[1].mul_add_precise(b[2], weights[2] * c[2]));
        let range = depth * stretch / whole;
        let nearer = inside & range.simd_gt(zero) & range.simd_lt(nearest);
        nearest = nearer.select(range, nearest);
    }
    nearest
}

/// A vertex in coordinates with the ray as the z axis.
#[inline(always)]
fn moved<S: Simd, V: SimdFloat<S>>(shear: [V; 2], [x, y, z]: Three<V>) -> Three<V> {
    [
        shear[0].mul_add_precise(z, x),
        shear[1].mul_add_precise(z, y),
        z,
    ]
}

/// px qy - py qx, with the correct sign despite rounding.
#[inline(always)]
fn edge<S: Simd, V: SimdFloat<S>>(zero: V, p: Three<V>, q: Three<V>) -> V {
    let product = p[1] * q[0];
    let rounding = (zero - p[1]).mul_add_precise(q[0], product);
    p[0].mul_add_precise(q[1], zero - product) + rounding
}

/// Cyclic order, with the given axis last.
#[inline(always)]
fn turned<T>(axis: usize, [x, y, z]: [T; 3]) -> [T; 3] {
    match axis {
        0 => [y, z, x],
        1 => [z, x, y],
        _ => [x, y, z],
    }
}

/// The caster's own.
#[inline(always)]
fn sheared<S: Simd>(simd: S, triangles: &[[[f64; 3]; 3]], rays: &Eight<f64>) -> f64x8<S> {
    let (origin, direction) = (loaded(simd, &rays.origin), loaded(simd, &rays.direction));
    let sheared = ShearedRays::new(simd, rays.axis, origin, direction);
    let mut nearest = f64x8::splat(simd, f64::INFINITY);
    for corners in triangles {
        if let Some(range) = sheared.meet(corners) {
            let nearer = range.simd_gt(0.0) & range.simd_lt(nearest);
            nearest = nearer.select(range, nearest);
        }
    }
    nearest
}
