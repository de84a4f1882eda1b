//! Density of a scan over the sphere: points per bin, the largest hole, and blind spots.
//!
//! All functions take unit vectors in the frame of the base: x right, y along the tilt axis, z up.
//! The 2018 paper counts points in the 5120 faces of an icosahedron cut four times. Here a
//! direction belongs to the bin with the nearest centre, not to the face that contains it. That
//! reproduces the paper's figures best (sd 56.23 for its 56.24, where containment gives 56.36), and
//! is defined where faces meet. Of two equally near centres, the bin with the lower number counts.

mod blind;
mod cells;
mod count;
mod gaps;
mod hole;
mod icosahedron;
mod locator;
#[cfg(test)]
mod many;
mod nearby;

use glam::DVec3;
use rayon::prelude::*;
use thiserror::Error;

pub use blind::{EmptyBand, HoleRow, bands, holes, rows};
pub use count::{BinCounts, HistogramClass, Statistics};
pub use gaps::{gaps, quantile};
pub use hole::{Hole, LargestHole, RegionDepth, TOLERANCE_RAD, largest_hole, largest_hole_within};
pub use icosahedron::{Icosahedron, IcosahedronFace, MOST_LEVEL};
pub use locator::Locator;

/// Square degrees of the whole sphere.
pub const SPHERE_DEG2: f64 = 129_600.0 / std::f64::consts::PI;

/// Errors of the density analysis.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum DensityError {
    /// Too many cuts.
    #[error("density: expected a level of at most {MOST_LEVEL}, got {got}")]
    Level {
        /// Requested number of cuts.
        got: u32,
    },
    /// No direction: not finite, or not of length 1.
    #[error("density: point {index}: expected a direction of length 1, got ({}, {}, {})", got.x, got.y, got.z)]
    Direction {
        /// Its index.
        index: usize,
        /// The value.
        got: DVec3,
    },
    /// A least radius of holes that is not above 0.
    #[error("density: expected a least radius above 0 rad, got {got}")]
    Least {
        /// Requested radius.
        got: f64,
    },
}

/// Tolerance of the length of a direction.
const LENGTH: f64 = 1e-6;

fn is_direction(direction: DVec3) -> bool {
    (direction.length_squared() - 1.0).abs() <= 2.0 * LENGTH
}

/// Checks that all are directions.
fn check(directions: &[DVec3]) -> Result<(), DensityError> {
    match directions.par_iter().position_first(|d| !is_direction(*d)) {
        None => Ok(()),
        Some(index) => Err(DensityError::Direction {
            index,
            got: directions.get(index).copied().unwrap_or(DVec3::NAN),
        }),
    }
}
