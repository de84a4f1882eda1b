//! Which bins the pairs of two leaves can be in: from a circle to sixteen circles at once.
//!
//! The arc cosine here only says where to look. It is 7e-5 radians coarse, and every bound is moved outward by more than that.
//! Left out: counting.

use fearless_simd::{Simd, f32x16, i32x16, prelude::*};

use super::lanes::LANES;

/// The first and the last bin that the pairs of each of sixteen leaves with another can be in.
pub(super) struct Reach {
    pub first: [i32; LANES],
    pub last: [i32; LANES],
}

/// What is beyond the error of the arc cosine's polynomial (6.7e-5, Abramowitz and Stegun 4.4.45) and of f32 in it.
const COARSE: f32 = 9e-5;

/// A circle in f32.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    pub middle: [f32; 3],
    pub radius: f32,
}

/// From one circle to the sixteen at these columns.
#[inline(always)]
pub(super) fn reach<S: Simd>(
    simd: S,
    from: Around,
    [x, y, z]: [&[f32; LANES]; 3],
    radii: &[f32; LANES],
    bins: usize,
) -> Reach {
    let x = f32x16::load_array_ref(simd, x);
    let y = f32x16::load_array_ref(simd, y);
    let z = f32x16::load_array_ref(simd, z);
    let radius = f32x16::load_array_ref(simd, radii) + from.radius;
    let [mx, my, mz] = from.middle;
    let cosine = z.mul_add(
        f32x16::splat(simd, mz),
        y.mul_add(f32x16::splat(simd, my), x * mx),
    );
    let near = cosine.abs();
    let root = (1.0 - near).max(0.0).sqrt();
    let series = near * -0.018_729_3 + 0.074_261;
    let series = near * series - 0.212_114_4;
    let series = near * series + 1.570_728_8;
    let small = root * series;
    let apart = cosine
        .simd_lt(0.0)
        .select(std::f32::consts::PI - small, small);
    // An error of 4e-7 in the cosine moves the angle by up to that over its sine, and by 1e-3 at 0 and pi.
    let beyond = radius + COARSE + 2e-6 / (root + 1e-3);
    let per_bin = bins as f32 / std::f32::consts::PI;
    let last_bin = bins.saturating_sub(1) as f32;
    let first = ((apart - beyond) * per_bin).max(0.0).min(last_bin);
    let last = ((apart + beyond) * per_bin).max(0.0).min(last_bin);
    let mut reach = Reach {
        first: [0; LANES],
        last: [0; LANES],
    };
    i32x16::truncate_from(first).store_array(&mut reach.first);
    i32x16::truncate_from(last).store_array(&mut reach.last);
    reach
}
