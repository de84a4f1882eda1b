//! How densely a scan covers the directions about it: points a bin, the largest hole, and blind spots.
//!
//! All of it is of directions, length 1, in the frame of the base: x right, y along the tilt axis, z up. The 2018 paper counts points in the 5120 faces of
//! an icosahedron cut four times. A direction belongs here to the bin with the nearest centre, not to the face that contains it: so the paper's figures come out
//! closest (sd 56.23 for its 56.24, where containment gives 56.36), and what is nearest is defined wherever faces meet. Where two centres are equally near, it is
//! the bin with the lower number. Left out: where directions come from, and how pairs of points are spread ([`crate`]'s K function).

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
use thiserror::Error;

pub use blind::{EmptyBand, HoleRow, bands, holes, rows};
pub use count::{BinCounts, HistogramClass, Statistics};
pub use gaps::{gaps, quantile};
pub use hole::{Hole, LargestHole, RegionDepth, TOLERANCE_RAD, largest_hole, largest_hole_within};
pub use icosahedron::{Icosahedron, IcosahedronFace, MOST_LEVEL};
pub use locator::Locator;

/// Square degrees of the whole sphere.
pub const SPHERE_DEG2: f64 = 129_600.0 / std::f64::consts::PI;

/// What cannot be analysed.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum DensityError {
    /// More cuts than memory is for.
    #[error("density: expected a level of at most {MOST_LEVEL}, got {got}")]
    Level {
        /// What was asked for.
        got: u32,
    },
    /// No direction: not finite, or not of length 1.
    #[error("density: point {index}: expected a direction of length 1, got ({}, {}, {})", got.x, got.y, got.z)]
    Direction {
        /// Which, from 0.
        index: usize,
        /// What is there.
        got: DVec3,
    },
    /// Holes that are to be of no size.
    #[error("density: expected a least radius above 0 rad, got {got}")]
    Least {
        /// What was asked for.
        got: f64,
    },
}

/// How far off 1 a length may be.
const LENGTH: f64 = 1e-6;

fn is_direction(direction: DVec3) -> bool {
    (direction.length_squared() - 1.0).abs() <= 2.0 * LENGTH
}

/// That all are directions.
fn check(directions: &[DVec3]) -> Result<(), DensityError> {
    match directions.iter().position(|d| !is_direction(*d)) {
        None => Ok(()),
        Some(index) => Err(DensityError::Direction {
            index,
            got: directions.get(index).copied().unwrap_or(DVec3::NAN),
        }),
    }
}
