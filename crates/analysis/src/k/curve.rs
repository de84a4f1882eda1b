//! Ripley's K function on a sphere, from numbers of pairs by angle.
//!
//! `K(t) = 8 pi R2 / (n (n - 1)) x #{i < j : angle <= t}`; under complete spatial randomness
//! `K_csr(t) = 2 pi R2 (1 - cos t)`. `D` is their difference divided by the area of the sphere, and
//! independent of R.

use super::Estimate;
use std::f64::consts::PI;

/// The K function at the upper edges of bins. Fewer than two points have no pairs: all lists but
/// the angles are empty then, and the extremes are 0.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct KCurve {
    /// `t_j`, radians; the last is pi.
    pub theta_rad: Vec<f64>,
    /// `K(t_j)`, square metres.
    pub k_m2: Vec<f64>,
    /// `K(t_j) - K_csr(t_j)`, square metres; positive values mean clustering.
    pub k_minus_csr_m2: Vec<f64>,
    /// `D(t_j) = (K - K_csr) / (4 pi R2)`: the excess share of all pairs within `t_j` over
    /// randomness.
    pub d: Vec<f64>,
    /// The first derivative of `K - K_csr` by the angle at the middle of each bin, square metres
    /// per radian: the difference of its ends divided by its width.
    pub derivative_m2_rad: Vec<f64>,
    /// The largest `D`; at least 0, as `D(0)` is.
    pub d_max: f64,
    /// The smallest `D`; at most 0.
    pub d_min: f64,
    /// Bound of the error of any `D` by the method: 0 for exact counts.
    pub d_error_bound: f64,
}

impl KCurve {
    /// The curve of an estimate, on a sphere of this radius.
    #[must_use]
    pub fn new(estimate: &Estimate, radius_m: f64) -> Self {
        let shares = match estimate.points {
            0 | 1 => &[][..],
            _ => &estimate.shares,
        };
        let area = 4.0 * PI * radius_m * radius_m;
        let theta_rad = estimate.edges.upper_rad();
        // (1 - cos t) / 2 without the loss of digits near 0.
        let csr = theta_rad.iter().map(|t| (t / 2.0).sin().powi(2));
        let d: Vec<f64> = shares.iter().zip(csr).map(|(s, csr)| s - csr).collect();
        let width = PI / estimate.edges.bins() as f64;
        let before = std::iter::once(&0.0).chain(&d);
        let slopes = d
            .iter()
            .zip(before)
            .map(|(d, before)| area * (d - before) / width);
        let d_max = d.iter().copied().fold(0.0, f64::max);
        let d_min = d.iter().copied().fold(0.0, f64::min);
        Self {
            k_m2: shares.iter().map(|s| area * s).collect(),
            k_minus_csr_m2: d.iter().map(|d| area * d).collect(),
            derivative_m2_rad: slopes.collect(),
            theta_rad,
            d,
            d_max,
            d_min,
            d_error_bound: estimate.largest_bound(),
        }
    }

    /// Whether there are pairs to tell anything of.
    #[must_use]
    pub fn has_pairs(&self) -> bool {
        !self.d.is_empty()
    }
}
