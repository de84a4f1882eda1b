//! Placement of an object: a rotation, then a translation. Scaling and shear would change ranges.
//!

use fearless_simd::{Simd, f64x8};
use glam::{DMat3, DVec3};
use thiserror::Error;

use super::ray::FARTHEST_M;

/// Largest deviation of a rotation's columns from orthonormal ones.
const TOLERANCE: f64 = 1e-9;

/// The rigid motion from an object's own frame to the world's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    rotation: DMat3,
    translation_m: DVec3,
    /// Whether there is a rotation; most objects have none.
    turned: bool,
}

/// An invalid rigid motion.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum PlacementError {
    /// Columns that are not orthonormal and right-handed.
    #[error("rotation of an object: expected orthonormal, right-handed columns, got {0}")]
    Rotation(DMat3),
    /// Not finite, or too far away.
    #[error("translation of an object: expected coordinates within 1e15 m, got {0}")]
    Translation(DVec3),
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            rotation: DMat3::IDENTITY,
            translation_m: DVec3::ZERO,
            turned: false,
        }
    }
}

impl Placement {
    /// A rotation, whose columns are the object's axes, then a translation in metres.
    ///
    /// # Errors
    /// [`PlacementError`] if the rotation is not one within 1e-9, or the translation is not finite.
    pub fn new(rotation: DMat3, translation_m: DVec3) -> Result<Self, PlacementError> {
        let off = rotation.transpose() * rotation - DMat3::IDENTITY;
        let orthonormal = off
            .to_cols_array()
            .iter()
            .all(|entry| entry.abs() <= TOLERANCE);
        if !orthonormal || rotation.determinant() <= 0.0 {
            return Err(PlacementError::Rotation(rotation));
        }
        if translation_m.is_nan() || translation_m.abs().max_element() > FARTHEST_M {
            return Err(PlacementError::Translation(translation_m));
        }
        Ok(Self {
            rotation,
            translation_m,
            turned: rotation != DMat3::IDENTITY,
        })
    }

    /// Moved and not turned, metres.
    ///
    /// # Errors
    /// [`PlacementError::Translation`] if it is not finite.
    pub fn at(translation_m: DVec3) -> Result<Self, PlacementError> {
        Self::new(DMat3::IDENTITY, translation_m)
    }

    /// The same, moved further in the world, metres.
    ///
    /// # Errors
    /// [`PlacementError::Translation`] if it is not finite or too far away then.
    pub fn moved(&self, by_m: DVec3) -> Result<Self, PlacementError> {
        Self::new(self.rotation, self.translation_m + by_m)
    }

    /// A point of the world in the object's frame.
    #[inline(always)]
    pub(crate) fn own_point(&self, point: DVec3) -> DVec3 {
        self.own_direction(point - self.translation_m)
    }

    /// A direction of the world in the object's frame.
    #[inline(always)]
    pub(crate) fn own_direction(&self, direction: DVec3) -> DVec3 {
        if !self.turned {
            return direction;
        }
        DVec3::new(
            self.rotation.x_axis.dot(direction),
            self.rotation.y_axis.dot(direction),
            self.rotation.z_axis.dot(direction),
        )
    }

    /// Like [`Placement::own_point`], for eight points.
    #[inline(always)]
    pub(super) fn own_points<S: Simd>(&self, [x, y, z]: [f64x8<S>; 3]) -> [f64x8<S>; 3] {
        let at = self.translation_m;
        self.own_directions([x - at.x, y - at.y, z - at.z])
    }

    /// Like [`Placement::own_direction`], for eight directions.
    #[inline(always)]
    pub(super) fn own_directions<S: Simd>(&self, [x, y, z]: [f64x8<S>; 3]) -> [f64x8<S>; 3] {
        if !self.turned {
            return [x, y, z];
        }
        let along = |axis: DVec3| x * axis.x + y * axis.y + z * axis.z;
        [
            along(self.rotation.x_axis),
            along(self.rotation.y_axis),
            along(self.rotation.z_axis),
        ]
    }

    /// A point of the object in the world.
    pub(crate) fn world_point(&self, point: DVec3) -> DVec3 {
        self.world_direction(point) + self.translation_m
    }

    /// A direction of the object in the world.
    pub(crate) fn world_direction(&self, direction: DVec3) -> DVec3 {
        if self.turned {
            self.rotation * direction
        } else {
            direction
        }
    }
}
