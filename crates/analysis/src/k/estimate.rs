//! Shares of pairs by angle, with a bound on their error.

use super::{Edges, PairCounts};

/// Pairs by angle, with a bound on the error.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Estimate {
    /// Name of the method in lower case.
    pub method: &'static str,
    /// The bins.
    pub edges: Edges,
    /// Share of all pairs up to the upper edge of each bin, 0 to 1; the last is 1.
    pub shares: Vec<f64>,
    /// Bound on the error of each share, and so of `D`: 0 for exact counts. Those of samples hold
    /// for all bins at once, except with the probability [`Estimate::risk`] over the draws.
    pub bounds: Vec<f64>,
    /// Probability that a bound does not hold: 0 for exact counts.
    pub risk: f64,
    /// Number of directions.
    pub points: usize,
    /// Pairs on an inner edge within rounding ([`super::ON_EDGE`]), counted or estimated. If they
    /// are a relevant share of all, another number of bins is more meaningful.
    pub on_edges: u64,
}

impl Estimate {
    /// The largest bound of all bins.
    #[must_use]
    pub fn largest_bound(&self) -> f64 {
        self.bounds.iter().copied().fold(0.0, f64::max)
    }

    /// The shares under randomness, for fewer than two points.
    pub(super) fn without_pairs(method: &'static str, edges: &Edges, points: usize) -> Self {
        let csr = |t: &f64| (t / 2.0).sin().powi(2);
        Self {
            method,
            shares: edges.upper_rad().iter().map(csr).collect(),
            edges: edges.clone(),
            bounds: vec![0.0; edges.bins()],
            risk: 0.0,
            points,
            on_edges: 0,
        }
    }
}

impl From<PairCounts> for Estimate {
    fn from(counts: PairCounts) -> Self {
        if counts.points < 2 {
            return Self::without_pairs("exact", &counts.edges, counts.points);
        }
        let all = counts.pairs() as f64;
        let shares = counts.cumulative();
        Self {
            method: "exact",
            shares: shares.into_iter().map(|sum| sum as f64 / all).collect(),
            bounds: vec![0.0; counts.edges.bins()],
            risk: 0.0,
            points: counts.points,
            on_edges: counts.on_edges,
            edges: counts.edges,
        }
    }
}
