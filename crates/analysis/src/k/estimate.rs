//! What a faster method says of the pairs, and how far it may be off.
//!
//! Left out: the methods.

use super::{Edges, PairCounts};
use serde::Serialize;

/// How far a share of pairs may be off: a share is a count over `n (n - 1) / 2`, as `D` is.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum ErrorBound {
    /// Nothing is off.
    Exact,
    /// None: how far it is off has been measured for some scans, and is not known of others.
    Unknown,
    /// Holds for all bins at once with a probability over the method's own draws, whatever the points: one number a bin.
    Confidence {
        /// Of the share up to the bin's upper edge.
        shares: Vec<f64>,
        /// The probability that one of them does not hold is at most this.
        risk: f64,
    },
}

impl ErrorBound {
    /// The largest over all bins; infinite where none is known.
    #[must_use]
    pub fn largest(&self) -> f64 {
        match self {
            Self::Exact => 0.0,
            Self::Unknown => f64::INFINITY,
            Self::Confidence { shares, .. } => shares.iter().copied().fold(0.0, f64::max),
        }
    }

    /// Of the share up to a bin's upper edge.
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
    /// The method, lower-case.
    pub method: &'static str,
    /// The bins.
    pub edges: Edges,
    /// The share of all pairs up to the upper edge of each bin, 0 to 1; the last is 1.
    pub shares: Vec<f64>,
    /// How far each may be off.
    pub bound: ErrorBound,
    /// Directions.
    pub points: usize,
    /// Pairs that lie on an inner edge within rounding ([`super::ON_EDGE`]): counted, or of samples estimated; none where the method cannot tell. Where they are a share of
    /// all that matters, other bins say more.
    pub on_edges: Option<u64>,
}

impl Estimate {
    /// Of fewer than two points, which have no pairs: the shares of randomness, exactly.
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
