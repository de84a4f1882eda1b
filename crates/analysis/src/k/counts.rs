//! Pairs of directions by their angle, as whole numbers.
//!
//! Left out: how they are counted, and the K function made of them.

use super::Edges;

/// Pairs in bins of angle: exact.
#[derive(Clone, Debug, PartialEq)]
pub struct PairCounts {
    /// The bins.
    pub edges: Edges,
    /// Pairs in each bin; together `n (n - 1) / 2`.
    pub counts: Vec<u64>,
    /// Directions, `n`.
    pub points: usize,
    /// Pairs that lie on an inner edge within rounding ([`super::ON_EDGE`]). On which side such a pair counts is defined, but it hangs on the
    /// last bit of its coordinates: where there are many, other bins say more.
    pub on_edges: u64,
}

impl PairCounts {
    /// All pairs: `n (n - 1) / 2`.
    #[must_use]
    pub const fn pairs(&self) -> u64 {
        pairs(self.points)
    }

    /// Whether no pair lies on an inner edge, so that counts do not hang on roundings of the points.
    #[must_use]
    pub const fn is_well_posed(&self) -> bool {
        self.on_edges == 0
    }

    /// Pairs up to the upper edge of each bin.
    #[must_use]
    pub fn cumulative(&self) -> Vec<u64> {
        let sums = self.counts.iter().scan(0_u64, |sum, count| {
            *sum = sum.saturating_add(*count);
            Some(*sum)
        });
        sums.collect()
    }
}

/// `n (n - 1) / 2`, for any number of points that is counted (below 2^32).
pub(super) const fn pairs(points: usize) -> u64 {
    let n = points as u64;
    if n.is_multiple_of(2) {
        (n / 2).saturating_mul(n.saturating_sub(1))
    } else {
        n.saturating_mul(n.saturating_sub(1) / 2)
    }
}
