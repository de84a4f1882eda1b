//! Counts of every pair one by one: the reference for the fast methods.

use glam::DVec3;

use super::error::check;
use super::{Edges, KError, PairCounts};

/// Counts pairs one by one.
///
/// # Errors
/// [`KError::NotUnit`] and [`KError::TooMany`] for invalid directions; [`KError::Undecided`].
pub(super) fn plain(points: &[DVec3], edges: &Edges) -> Result<PairCounts, KError> {
    check(points)?;
    let mut counts = vec![0_u64; edges.bins()];
    let mut on_edges = 0;
    for (i, &a) in points.iter().enumerate() {
        for &b in points.iter().take(i) {
            let bin = edges.bin(a, b)?;
            if let Some(count) = counts.get_mut(bin) {
                *count += 1;
            }
            let below = bin.checked_sub(1);
            let is_on = |bin| edges.is_on(bin, a, b);
            on_edges += u64::from(is_on(bin) || below.is_some_and(is_on));
        }
    }
    Ok(PairCounts {
        edges: edges.clone(),
        counts,
        points: points.len(),
        on_edges,
    })
}
