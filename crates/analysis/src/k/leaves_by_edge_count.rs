//! The leaves of a block by the number of edges to them, so that each number has a loop without
//! branches.

use fearless_simd::{Simd, i32x16, prelude::*};

use super::lanes::LANES;
use super::reach::BinRange;
use super::tree::BLOCK_LEAVES;

/// Leaves of a block, and the bins of pairs with them.
#[derive(Clone, Copy, Default)]
pub(super) struct LeavesByEdgeCount {
    pub reach: [BinRange; BLOCK_LEAVES / LANES],
    /// Leaves with 0 to 4 edges, one bit per leaf.
    pub by_edges: [u32; 5],
    /// Leaves with more edges.
    pub many: u32,
}

impl LeavesByEdgeCount {
    /// Leaves with `E` edges.
    #[inline(always)]
    pub(super) fn of<const E: usize>(&self) -> Bits {
        Bits(self.by_edges.get(E).copied().unwrap_or_default())
    }

    /// Sorts `count` leaves by their number of edges.
    #[inline(always)]
    pub(super) fn sort<S: Simd>(&mut self, simd: S, count: usize) {
        let mut left = 1_u32
            .checked_shl(count as u32)
            .map_or(u32::MAX, |end| end - 1);
        for (edges, sorted) in (0..).zip(&mut self.by_edges) {
            for (reach, shift) in self.reach.iter().zip((0..).step_by(LANES)) {
                let first = i32x16::load_array_ref(simd, &reach.first);
                let last = i32x16::load_array_ref(simd, &reach.last);
                *sorted |= ((last - first).simd_eq(edges).to_bitmask() as u32) << shift;
            }
            *sorted &= left;
            left &= !*sorted;
        }
        self.many = left;
    }

    #[inline(always)]
    pub(super) fn bins(&self, at: usize) -> (usize, usize) {
        let reach = self.reach.get(at / LANES);
        reach.map_or((0, 0), |reach| {
            let at = at % LANES;
            (reach.first[at] as usize, reach.last[at] as usize)
        })
    }
}

/// Positions of set bits, the last first.
pub(super) struct Bits(pub u32);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let at = self.0.checked_ilog2()?;
        self.0 &= !(1 << at);
        Some(at as usize)
    }
}
