//! Outlines of leaves and blocks: how far their points reach in eight directions, and which bins
//! the pairs of two of them can be in.
//!
//! Every point is `c m + u e + v f`, with `m` a unit vector and `e` and `f` at right angles to it
//! and to each other. An outline has bounds of `|u|`, `|v|`, `|u + v| / sqrt 2`,
//! `|u - v| / sqrt 2`, `sqrt(u2 + v2)` and `1 - c`. The dot product of two points is the middles'
//! plus what the first adds along the other's middle, what the other adds along the first's, the
//! product of both tangents, and `1 - c` of either. Each is within its bound at any size of the
//! outline. This module does not count pairs.

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::DVec3;

use super::lanes::LANES;
use super::reach::{BinRange, arc_cosine, bins_between};

/// Numbers per outline.
const NUMBERS: usize = 15;

/// Orientations of `e` and `f` that are tried.
const TURNS: u32 = 6;

/// Error of a dot product from lengths that are off by 1e-6 and from rounding in f32.
const ROUNDED: f32 = 6e-6;

/// `m`, `e`, `f`; the bounds of `|u|`, `|v|`, of the sum and of the difference; of the tangent's
/// length and of `1 - c`. The bounds are rounded up.
pub(super) type Outline = [f32; NUMBERS];

/// The outline of points: the narrowest of several orientations of its tangents.
pub(super) fn around(points: &[DVec3]) -> Outline {
    let sum: DVec3 = points.iter().sum();
    let middle = sum.try_normalize().unwrap_or(DVec3::X);
    let (e, f) = middle.any_orthonormal_pair();
    let mut best = (f64::INFINITY, middle, e, f);
    for turn in 0..TURNS {
        let (sin, cos) =
            (f64::from(turn) * std::f64::consts::FRAC_PI_2 / f64::from(TURNS)).sin_cos();
        let (e, f) = (e * cos + f * sin, f * cos - e * sin);
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for p in points {
            for ((low, high), at) in low.iter_mut().zip(&mut high).zip([p.dot(e), p.dot(f)]) {
                *low = low.min(at);
                *high = high.max(at);
            }
        }
        let [u, v] = [low[0] + high[0], low[1] + high[1]];
        let width = high[0] - low[0] + high[1] - low[1];
        if width < best.0 {
            best = (width, middle + e * (u / 2.0) + f * (v / 2.0), e, f);
        }
    }
    let (_, middle, e, _) = best;
    let middle = middle.try_normalize().unwrap_or(DVec3::X);
    let e = e.reject_from_normalized(middle);
    let e = e
        .try_normalize()
        .unwrap_or_else(|| middle.any_orthonormal_vector());
    measured(points, [middle, e, middle.cross(e)])
}

/// The outline of points with this middle and these tangents.
fn measured(points: &[DVec3], [middle, e, f]: [DVec3; 3]) -> Outline {
    let mut bounds = [0.0_f64; 6];
    for p in points {
        let (u, v) = (p.dot(e), p.dot(f));
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let of = [
            u.abs(),
            v.abs(),
            (u + v).abs() * half,
            (u - v).abs() * half,
            u.hypot(v),
            1.0 - p.dot(middle),
        ];
        for (bound, of) in bounds.iter_mut().zip(of) {
            *bound = bound.max(of);
        }
    }
    let mut outline = [0.0; NUMBERS];
    let vectors = [middle, e, f].map(|v| v.as_vec3().to_array());
    let bounds = bounds.map(|bound| (bound * (1.0 + 1e-6) + 1e-9) as f32);
    let numbers = vectors.iter().flatten().chain(&bounds);
    for (to, number) in outline.iter_mut().zip(numbers) {
        *to = *number;
    }
    outline
}

/// Outlines in columns, with [`LANES`] extra entries so that sixteen can be read anywhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Outlines {
    columns: [Vec<f32>; NUMBERS],
}

impl Outlines {
    pub(super) fn new(outlines: &[Outline]) -> Self {
        let empty = [0.0; NUMBERS];
        let mut columns: [Vec<f32>; NUMBERS] = Default::default();
        for outline in outlines.iter().chain([&empty; LANES]) {
            for (column, number) in columns.iter_mut().zip(outline) {
                column.push(*number);
            }
        }
        Self { columns }
    }

    #[inline(always)]
    pub(super) fn one(&self, at: usize) -> Option<Outline> {
        let mut outline = [0.0; NUMBERS];
        for (to, column) in outline.iter_mut().zip(&self.columns) {
            *to = *column.get(at)?;
        }
        Some(outline)
    }

    /// The first and the last bin of pairs of an outline with each of sixteen.
    #[inline(always)]
    pub(super) fn span<S: Simd>(
        &self,
        simd: S,
        one: &Outline,
        from: usize,
        bins: usize,
    ) -> Option<BinRange> {
        let mut columns = [f32x16::splat(simd, 0.0); NUMBERS];
        for (to, column) in columns.iter_mut().zip(&self.columns) {
            *to = f32x16::load_array_ref(simd, column.get(from..)?.first_chunk()?);
        }
        let mut splat = [f32x16::splat(simd, 0.0); NUMBERS];
        for (to, number) in splat.iter_mut().zip(one) {
            *to = f32x16::splat(simd, *number);
        }
        let [m, e, f] = vectors(&columns);
        let [one_m, one_e, one_f] = vectors(&splat);
        let cosine = dot(m, one_m);
        let reach = along(dot(e, one_m), dot(f, one_m), &columns)
            + along(dot(m, one_e), dot(m, one_f), &splat);
        let reach = columns[13].mul_add(splat[13], reach) + ROUNDED;
        let shorter = columns[14] + splat[14];
        Some(between(simd, cosine, reach, shorter, bins))
    }

    /// The same for a point.
    #[inline(always)]
    pub(super) fn span_of_point<S: Simd>(
        &self,
        simd: S,
        point: [f32; 3],
        from: usize,
        bins: usize,
    ) -> Option<BinRange> {
        let mut columns = [f32x16::splat(simd, 0.0); NUMBERS];
        for (to, column) in columns.iter_mut().zip(&self.columns) {
            *to = f32x16::load_array_ref(simd, column.get(from..)?.first_chunk()?);
        }
        let [m, e, f] = vectors(&columns);
        let [x, y, z] = point;
        let point = [
            f32x16::splat(simd, x),
            f32x16::splat(simd, y),
            f32x16::splat(simd, z),
        ];
        let reach = along(dot(e, point), dot(f, point), &columns) + ROUNDED;
        Some(between(simd, dot(m, point), reach, columns[14], bins))
    }
}

/// The bins of dot products around `cosine`, within `reach`, and scaled down by up to `shorter`.
#[inline(always)]
fn between<S: Simd>(
    simd: S,
    cosine: f32x16<S>,
    reach: f32x16<S>,
    shorter: f32x16<S>,
    bins: usize,
) -> BinRange {
    let zero = f32x16::splat(simd, 0.0);
    let least = cosine - reach - shorter * cosine.max(zero);
    let greatest = cosine + reach - shorter * cosine.min(zero);
    bins_between(arc_cosine(simd, greatest), arc_cosine(simd, least), bins)
}

#[inline(always)]
fn vectors<S: Simd>(of: &[f32x16<S>; NUMBERS]) -> [[f32x16<S>; 3]; 3] {
    [
        [of[0], of[1], of[2]],
        [of[3], of[4], of[5]],
        [of[6], of[7], of[8]],
    ]
}

#[inline(always)]
fn dot<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> f32x16<S> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Extent of an outline along a vector with the parts `p` along `e` and `q` along `f`.
///
/// With `|p| >= |q|`, the vector is `|p| - |q|` of `e` and `|q| sqrt 2` of the sum's direction, or
/// of the difference's where the signs differ.
#[inline(always)]
fn along<S: Simd>(p: f32x16<S>, q: f32x16<S>, of: &[f32x16<S>; NUMBERS]) -> f32x16<S> {
    let [e, f, sum, difference] = [of[9], of[10], of[11], of[12]];
    let diagonal = (p * q).simd_lt(0.0).select(difference, sum);
    let (p, q) = (p.abs(), q.abs());
    let straight = p.simd_lt(q).select(f, e);
    let less = p.min(q);
    let more = p.max(q);
    (more - less) * straight + less * std::f32::consts::SQRT_2 * diagonal
}
