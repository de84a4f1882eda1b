//! Whole numbers of pairs of directions per bin of angle.

use super::Edges;

/// Exact numbers of pairs per bin of angle.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PairCounts {
    /// The bins.
    pub edges: Edges,
    /// Pairs per bin; `n (n - 1) / 2` in all.
    pub counts: Vec<u64>,
    /// Number of directions, `n`.
    pub points: usize,
    /// Pairs on an inner edge within rounding ([`super::ON_EDGE`]). The bin of such a pair is
    /// defined, but depends on the last bit of its coordinates. If there are many, another number
    /// of bins is more meaningful.
    pub on_edges: u64,
}

impl PairCounts {
    /// Number of pairs, `n (n - 1) / 2`.
    #[must_use]
    pub const fn pairs(&self) -> u64 {
        pairs(self.points)
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

/// `n (n - 1) / 2` for fewer than 2^32 points.
pub(super) const fn pairs(points: usize) -> u64 {
    let n = points as u64;
    if n.is_multiple_of(2) {
        (n / 2).saturating_mul(n.saturating_sub(1))
    } else {
        n.saturating_mul(n.saturating_sub(1) / 2)
    }
}
