//! Objects that move: at a steady velocity, turning steadily.

use std::ops::Range;

use glam::{DMat3, DVec3};

use super::error::FilePosition;
use super::materials::Placed;
use crate::cast::{Object, Placement, PlacementError};

/// How something moves: its origin along a line, the thing about its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel {
    /// Where its origin is at the start, metres in the frame of the base.
    pub from_m: DVec3,
    /// Metres per second along the axes of the base.
    pub velocity_m_s: DVec3,
    /// Turning about an axis of that direction in the base's frame, degrees per second its length.
    pub turn_deg_s: DVec3,
}

impl Travel {
    /// Where its frame is so many seconds after the start; then its axes are those of the base.
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

/// Something of a scene that moves as one: all parts of an object, or of one of its copies.
#[derive(Clone, Debug, PartialEq)]
pub struct Moving {
    /// Which of the placed objects, as they stand at the start.
    pub objects: Range<usize>,
    /// How they move together.
    pub travel: Travel,
    /// Which line of the scene asks for it.
    pub at: FilePosition,
}

impl Placed {
    /// What stands, and what moves, each in a frame of its own whose origin is the travel's and whose axes are the base's at the start.
    ///
    /// # Errors
    /// [`PlacementError`] for what stands out of all bounds.
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
            let all = (
                self.objects.get(at),
                self.assignments.get(at),
                self.lines.get(at),
            );
            let (Some(object), Some(assignment), Some(line)) = all else {
                continue;
            };
            let placement = object.placement().moved(-from_m)?;
            only.objects.push(Object::clone(object).placed(placement));
            only.assignments.push(*assignment);
            only.lines.push(*line);
        }
        Ok(only)
    }
}
