//! Pairs by the cells that their points are in: a proof, and no pair looked at.
//!
//! The pairs of two cells are between two angles. Those that are within one bin are counted by multiplication; of the others it is known between which edges they are.
//! So the share up to every edge is between two numbers, for any points. The estimate lies between them. Left out: narrowing it down, which [`super::sampled()`] does.

use fearless_simd::{Simd, dispatch};
use glam::DVec3;

use super::cells::Cells;
use super::counts::pairs;
use super::lanes::LANES;
use super::plain::check;
use super::reach::reach;
use super::{Bound, Edges, Estimate, KError, Registers};

/// Estimates from cells, so many along each edge of a cube around the sphere.
///
/// # Errors
/// [`KError::NotUnit`] and [`KError::TooMany`] for what are not directions.
pub fn gridded(points: &[DVec3], edges: &Edges, side: usize) -> Result<Estimate, KError> {
    check(points)?;
    if points.len() < 2 {
        return Ok(Estimate::without_pairs("gridded", edges, points.len()));
    }
    let cells = Cells::new(points, side.clamp(1, 512));
    let mut between = Between::new(edges.bins());
    let level = Registers::Best.level();
    dispatch!(level, simd => all(simd, &cells, edges.bins(), &mut between));
    let all = pairs(points.len()).max(1) as f64;
    let (mut low, mut high) = (0_u64, 0_u64);
    let (mut shares, mut bounds) = (Vec::new(), Vec::new());
    for (last, first) in between.last.iter().zip(&between.first) {
        low += last;
        high += first;
        shares.push(f64::midpoint(low as f64, high as f64) / all);
        // Whole numbers until here; what follows is rounded by less than this.
        bounds.push((high - low) as f64 / 2.0 / all + 1e-12);
    }
    Ok(Estimate {
        method: "gridded",
        edges: edges.clone(),
        shares,
        bound: Bound::Proven { shares: bounds },
        points: points.len(),
        on_edges: None,
    })
}

/// Pairs by the first bin that they may be in, and by the last.
struct Between {
    first: Vec<u64>,
    last: Vec<u64>,
}

impl Between {
    fn new(bins: usize) -> Self {
        Self {
            first: vec![0; bins],
            last: vec![0; bins],
        }
    }
}

#[inline(always)]
fn all<S: Simd>(simd: S, cells: &Cells, bins: usize, between: &mut Between) {
    for (a, cell) in cells.cells.iter().enumerate() {
        let Some(around) = cells.around.one(a) else {
            return;
        };
        for start in (a..cells.cells.len()).step_by(LANES) {
            let Some((middles, radii)) = cells.around.sixteen(start) else {
                return;
            };
            let of = reach(simd, around, middles, radii, bins);
            let others = cells.cells.get(start..).unwrap_or_default();
            for ((other, first), last) in others.iter().zip(&of.first).zip(&of.last) {
                let count = if other.first == cell.first {
                    pairs(cell.len)
                } else {
                    cell.len as u64 * other.len as u64
                };
                if let Some(from) = between.first.get_mut(*first as usize) {
                    *from += count;
                }
                if let Some(to) = between.last.get_mut(*last as usize) {
                    *to += count;
                }
            }
        }
    }
}
