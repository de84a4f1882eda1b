//! Rays and hits.
//!
//! Object and primitive of a hit identify its material.

use std::num::NonZeroU32;

use glam::DVec3;
use thiserror::Error;

/// Largest deviation of a direction's length from 1.
pub(super) const LENGTH_TOLERANCE: f64 = 1e-6;
/// The greatest coordinate of anything, metres: within it no f32 of a tree overflows.
pub(super) const FARTHEST_M: f64 = 1e15;

/// A half-line whose origin is finite and whose direction has length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin_m: DVec3,
    direction: DVec3,
}

/// An invalid ray.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum RayError {
    /// The origin is not finite, or so far away that nothing is known there.
    #[error("origin of a ray: expected coordinates within 1e15 m, got {0}")]
    Origin(DVec3),
    /// The direction is not finite or not of length 1.
    #[error("direction of a ray: expected length 1 within 1e-6, got {0}")]
    Direction(DVec3),
}

impl Ray {
    /// The ray from `origin_m` (metres) along `direction` (length 1 within 1e-6).
    ///
    /// # Errors
    /// [`RayError`] for an origin or direction that is not finite, or a direction of another
    /// length.
    #[inline]
    pub fn new(origin_m: DVec3, direction: DVec3) -> Result<Self, RayError> {
        // A NaN fails either comparison.
        let known = origin_m.abs().max_element() <= FARTHEST_M && !origin_m.is_nan();
        if !known {
            return Err(RayError::Origin(origin_m));
        }
        let sound = (direction.length_squared() - 1.0).abs() <= 2.0 * LENGTH_TOLERANCE;
        if !sound {
            return Err(RayError::Direction(direction));
        }
        Ok(Self {
            origin_m,
            direction,
        })
    }

    /// Origin of the ray, metres.
    #[inline]
    #[must_use]
    pub const fn origin_m(&self) -> DVec3 {
        self.origin_m
    }

    /// Direction of the ray, length 1.
    #[inline]
    #[must_use]
    pub const fn direction(&self) -> DVec3 {
        self.direction
    }

    /// The point at a distance from the origin, metres.
    #[inline]
    #[must_use]
    pub fn at(&self, range_m: f64) -> DVec3 {
        self.origin_m + range_m * self.direction
    }
}

/// Distances at which hits count, from the ray's origin, metres: farther than `above_m` and no
/// farther than `up_to_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Exclusive; what is below zero counts as zero. At zero a ray that starts on a surface can hit
    /// it at once, as its origin was rounded to one side or the other: see [`Reach::ON_SURFACE_M`].
    pub above_m: f64,
    /// Inclusive.
    pub up_to_m: f64,
}

impl Default for Reach {
    fn default() -> Self {
        Self::up_to(f64::INFINITY)
    }
}

impl Reach {
    /// Surfaces no farther than this are the one on which the ray starts: a nanometre, some
    /// rounding of coordinates of half a million metres.
    pub const ON_SURFACE_M: f64 = 1e-9;

    /// From just ahead of the origin ([`Reach::ON_SURFACE_M`]) to a distance in metres.
    #[must_use]
    pub const fn up_to(up_to_m: f64) -> Self {
        Self {
            above_m: Self::ON_SURFACE_M,
            up_to_m,
        }
    }

    /// With a lower end of zero at least; a NaN at either end makes it empty.
    #[inline]
    pub(super) fn clean(self) -> Self {
        let empty = self.above_m.is_nan() || self.up_to_m.is_nan();
        Self {
            above_m: self.above_m.max(0.0),
            up_to_m: if empty { -1.0 } else { self.up_to_m },
        }
    }
}

/// The number of an object in its caster, from 0 in the order in which they were given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(NonZeroU32);

impl ObjectId {
    #[inline]
    pub(super) const fn new(index: u32) -> Self {
        // Casters hold fewer than 2^27 objects.
        Self(NonZeroU32::MIN.saturating_add(index))
    }

    /// The number.
    #[inline]
    #[must_use]
    pub const fn index(self) -> usize {
        (self.0.get() - 1) as usize
    }
}

/// The first hit of a ray. At equal distances the lowest object counts, then the lowest primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, metres.
    pub range_m: f64,
    /// Object that the ray hits.
    pub object: ObjectId,
    /// Part of the object: the triangle of a mesh by its number, the face of a box (-x, +x, -y, +y,
    /// -z, +z), of a cylinder 0 for the mantle, 1 for the bottom, 2 for the top; else 0.
    pub primitive: u32,
}
