//! Ripley's K function on a sphere, from numbers of pairs by angle.
//!
//! `K(t) = 8 pi R2 / (n (n - 1)) x #{i < j : angle <= t}`; under complete spatial randomness
//! `K_csr(t) = 2 pi R2 (1 - cos t)`. `D` is their difference divided by the area of the sphere, and
//! independent of R.

use super::{Edges, Estimate, PairCounts};
use serde::Serialize;
use std::f64::consts::PI;

/// The K function at the upper edges of bins. Fewer than two points have no pairs: all lists but
/// the angles are empty then, and the extremes are 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    /// The largest of `|K - K_csr|`, square metres.
    pub max_abs_m2: f64,
    /// The largest `D`; at least 0, as `D(0)` is.
    pub d_max: f64,
    /// The smallest `D`; at most 0.
    pub d_min: f64,
    /// How far any `D` may be off by the method: 0 for exact counts.
    pub d_error_bound: f64,
}

impl KCurve {
    /// Of exact counts, on a sphere of this radius.
    #[must_use]
    pub fn of_counts(counts: &PairCounts, radius_m: f64) -> Self {
        let all = counts.pairs();
        let share = |sum: u64| sum as f64 / all as f64;
        let sums = counts.cumulative().into_iter().filter(|_| all > 0);
        let shares: Vec<f64> = sums.map(share).collect();
        Self::of_shares(&counts.edges, &shares, 0.0, radius_m)
    }

    /// Of an estimate, on a sphere of this radius.
    #[must_use]
    pub fn of_estimate(estimate: &Estimate, radius_m: f64) -> Self {
        let bound = estimate.largest_bound();
        let shares = match estimate.points {
            0 | 1 => &[][..],
            _ => &estimate.shares,
        };
        Self::of_shares(&estimate.edges, shares, bound, radius_m)
    }

    /// Whether there are pairs to tell anything of.
    #[must_use]
    pub fn has_pairs(&self) -> bool {
        !self.d.is_empty()
    }

    /// Of the share of all pairs up to every edge; none without pairs.
    fn of_shares(edges: &Edges, shares: &[f64], d_error_bound: f64, radius_m: f64) -> Self {
        let area = 4.0 * PI * radius_m * radius_m;
        let theta_rad = edges.upper_rad();
        // (1 - cos t) / 2 without the loss of digits near 0.
        let csr = theta_rad.iter().map(|t| (t / 2.0).sin().powi(2));
        let d: Vec<f64> = shares.iter().zip(csr).map(|(s, csr)| s - csr).collect();
        let width = PI / edges.bins() as f64;
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
            max_abs_m2: area * d_max.max(-d_min),
            theta_rad,
            d,
            d_max,
            d_min,
            d_error_bound,
        }
    }
}
