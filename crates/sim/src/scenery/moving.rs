//! Objects that move: at a steady velocity, turning steadily.

use std::ops::Range;

use glam::{DMat3, DVec3};

use super::error::FilePosition;
use super::materials::PlacedScenery;
use crate::cast::{Object, Placement, PlacementError};

/// A motion: the origin moves along a line, the object rotates about it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Travel {
    /// Position of its origin at the start, metres in the frame of the base.
    pub from_m: DVec3,
    /// Metres per second along the axes of the base.
    pub velocity_m_s: DVec3,
    /// Rotation about this axis in the base's frame, with degrees per second as its length.
    pub turn_deg_s: DVec3,
}

impl Travel {
    /// The placement of its frame at a time after the start; at the start its axes are those of the
    /// base.
    ///
    /// # Errors
    /// [`PlacementError`] once it has gone out of all bounds.
    pub fn at(&self, since_s: f64) -> Result<Placement, PlacementError> {
        let rate = self.turn_deg_s.length();
        let rotation = match self.turn_deg_s.try_normalize() {
            Some(axis) => DMat3::from_axis_angle(axis, (rate * since_s).to_radians()),
            None => DMat3::IDENTITY,
        };
        Placement::new(rotation, self.from_m + self.velocity_m_s * since_s)
    }
}

/// Objects that move as one: all parts of an object, or of one of its copies.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Moving {
    /// Indices of the placed objects.
    pub objects: Range<usize>,
    /// Their common motion.
    pub travel: Travel,
    /// Line of the scene that requests it.
    pub at: FilePosition,
}

impl PlacedScenery {
    /// The static objects, and the moving ones, each in a frame whose origin is the motion's and
    /// whose axes are the base's at the start.
    ///
    /// # Errors
    /// [`PlacementError`] for coordinates out of range.
    pub fn divided(&self) -> Result<(Self, Vec<(Moving, Self)>), PlacementError> {
        let mut moves = vec![false; self.objects.len()];
        for moving in &self.moving {
            let of = moves.get_mut(moving.objects.clone());
            of.unwrap_or_default().fill(true);
        }
        let stands = moves.iter().enumerate().filter(|(_, moves)| !**moves);
        let stands = self.only(stands.map(|(object, _)| object), DVec3::ZERO)?;
        let bodies = self.moving.iter().map(|moving| {
            let body = self.only(moving.objects.clone(), moving.travel.from_m)?;
            Ok((moving.clone(), body))
        });
        Ok((stands, bodies.collect::<Result<_, _>>()?))
    }

    /// Some of the objects, from an origin of their own.
    fn only(
        &self,
        objects: impl Iterator<Item = usize>,
        from_m: DVec3,
    ) -> Result<Self, PlacementError> {
        let mut only = Self {
            materials: self.materials.clone(),
            ..Self::default()
        };
        for at in objects {
            let (Some(object), Some(assignment)) = (self.objects.get(at), self.assignments.get(at))
            else {
                continue;
            };
            let placement = object.placement.moved(-from_m)?;
            only.objects.push(Object::clone(object).placed(placement));
            only.assignments.push(*assignment);
        }
        Ok(only)
    }
}
