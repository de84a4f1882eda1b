//! The bins of the pairs of two leaves, from one circle to sixteen at once.
//!
//! The arc cosine only selects bins. It is accurate to 7e-5 radians, and every bound is moved
//! outward by more than that.

use fearless_simd::{Simd, f32x16, i32x16, prelude::*};

use super::lanes::LANES;

/// The first and the last bin of pairs of one leaf with each of sixteen.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BinRange {
    pub first: [i32; LANES],
    pub last: [i32; LANES],
}

/// More than the error of the arc cosine's polynomial (6.7e-5, Abramowitz and Stegun 4.4.45) in
/// f32.
const COARSE: f32 = 9e-5;

/// A circle in f32.
#[derive(Clone, Copy, Debug)]
pub(super) struct CircleF32 {
    pub middle: [f32; 3],
    pub radius: f32,
}

/// Bins from one circle to the sixteen in these columns.
#[inline(always)]
pub(super) fn reach<S: Simd>(
    simd: S,
    from: CircleF32,
    [x, y, z]: [&[f32; LANES]; 3],
    radii: &[f32; LANES],
    bins: usize,
) -> BinRange {
    let x = f32x16::load_array_ref(simd, x);
    let y = f32x16::load_array_ref(simd, y);
    let z = f32x16::load_array_ref(simd, z);
    let radius = f32x16::load_array_ref(simd, radii) + from.radius;
    let [mx, my, mz] = from.middle;
    let cosine = z.mul_add(
        f32x16::splat(simd, mz),
        y.mul_add(f32x16::splat(simd, my), x * mx),
    );
    let (apart, root) = angle(simd, cosine);
    // An error of 4e-7 in the cosine moves the angle by that divided by its sine, and by up to 1e-3
    // at 0 and pi.
    let beyond = radius + COARSE + 2e-6 / (root + 1e-3);
    bins_of(apart - beyond, apart + beyond, bins)
}

/// An arc cosine within [`COARSE`], and the square root of 1 less the magnitude of the cosine.
#[inline(always)]
fn angle<S: Simd>(simd: S, cosine: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
    let near = cosine.abs();
    let root = (1.0 - near).max(f32x16::splat(simd, 0.0)).sqrt();
    let series = near * -0.018_729_3 + 0.074_261;
    let series = near * series - 0.212_114_4;
    let series = near * series + 1.570_728_8;
    let small = root * series;
    let apart = cosine
        .simd_lt(0.0)
        .select(std::f32::consts::PI - small, small);
    (apart, root)
}

/// An arc cosine within [`COARSE`], with the cosine limited to -1..1.
#[inline(always)]
pub(super) fn arc_cosine<S: Simd>(simd: S, cosine: f32x16<S>) -> f32x16<S> {
    angle(simd, cosine.max(-1.0).min(1.0)).0
}

/// The bins of angles from `least` to `greatest`, widened by the error of the arc cosine.
#[inline(always)]
pub(super) fn bins_between<S: Simd>(
    least: f32x16<S>,
    greatest: f32x16<S>,
    bins: usize,
) -> BinRange {
    bins_of(least - COARSE, greatest + COARSE, bins)
}

#[inline(always)]
fn bins_of<S: Simd>(least: f32x16<S>, greatest: f32x16<S>, bins: usize) -> BinRange {
    let per_bin = bins as f32 / std::f32::consts::PI;
    let last_bin = bins.saturating_sub(1) as f32;
    let bin = |angle: f32x16<S>| i32x16::truncate_from((angle * per_bin).max(0.0).min(last_bin));
    let mut reach = BinRange {
        first: [0; LANES],
        last: [0; LANES],
    };
    bin(least).store_array(&mut reach.first);
    bin(greatest).store_array(&mut reach.last);
    reach
}
