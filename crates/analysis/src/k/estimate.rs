//! Shares of pairs by angle, with a bound on their error.

use super::{Edges, PairCounts};
use serde::Serialize;

/// Bound on the error of a share of pairs, that is, of a count divided by `n (n - 1) / 2`. `D` has
/// the same error.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum ErrorBound {
    /// The shares are exact.
    Exact,
    /// The error is unknown; it has been measured for some scans.
    Unknown,
    /// Bounds that hold for all bins at once with a probability over the draws, for any points.
    Confidence {
        /// Bound on the share up to the upper edge of each bin.
        shares: Vec<f64>,
        /// Upper bound of the probability that any of them fails.
        risk: f64,
    },
}

impl ErrorBound {
    /// The largest over all bins; infinite if unknown.
    #[must_use]
    pub fn largest(&self) -> f64 {
        match self {
            Self::Exact => 0.0,
            Self::Unknown => f64::INFINITY,
            Self::Confidence { shares, .. } => shares.iter().copied().fold(0.0, f64::max),
        }
    }

    /// Bound on the share up to the upper edge of a bin.
    #[must_use]
    pub fn of(&self, bin: usize) -> f64 {
        match self {
            Self::Exact => 0.0,
            Self::Unknown => f64::INFINITY,
            Self::Confidence { shares, .. } => shares.get(bin).copied().unwrap_or(0.0),
        }
    }
}

/// Pairs by angle, with a bound on the error.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name of the method in lower case.
    pub method: &'static str,
    /// The bins.
    pub edges: Edges,
    /// Share of all pairs up to the upper edge of each bin, 0 to 1; the last is 1.
    pub shares: Vec<f64>,
    /// Bound on the error of each share.
    pub bound: ErrorBound,
    /// Number of directions.
    pub points: usize,
    /// Pairs on an inner edge within rounding ([`super::ON_EDGE`]), counted or estimated; `None` if
    /// the method cannot tell. If they are a relevant share of all, another number of bins is more
    /// meaningful.
    pub on_edges: Option<u64>,
}

impl Estimate {
    /// The shares under randomness, for fewer than two points.
    pub(super) fn without_pairs(method: &'static str, edges: &Edges, points: usize) -> Self {
        let csr = |t: &f64| (t / 2.0).sin().powi(2);
        Self {
            method,
            shares: edges.upper_rad().iter().map(csr).collect(),
            edges: edges.clone(),
            bound: ErrorBound::Exact,
            points,
            on_edges: Some(0),
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
            bound: ErrorBound::Exact,
            points: counts.points,
            on_edges: Some(counts.on_edges),
            edges: counts.edges,
        }
    }
}
