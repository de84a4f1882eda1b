//! Objects that move: at a steady velocity, turning steadily.

use glam::{DMat3, DVec3};

use super::error::At;
use crate::cast::{Placement, PlacementError};

/// How an object moves: its origin along a line, the object about its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// Which object of the placed ones.
    pub object: usize,
    /// Metres per second along the axes of the base.
    pub velocity_m_s: DVec3,
    /// Turning about an axis of that direction in the base's frame, degrees per second its length.
    pub turn_deg_s: DVec3,
    /// Which line of the scene asks for it.
    pub at: At,
    /// How it is turned at the start.
    pub rotation: DMat3,
    /// Where it is at the start, metres.
    pub position_m: DVec3,
}

impl Moving {
    /// Where the object stands so many seconds after the start.
    ///
    /// # Errors
    /// [`PlacementError`] once it has gone out of all bounds.
    pub fn at_time(&self, since_s: f64) -> Result<Placement, PlacementError> {
        let rate = self.turn_deg_s.length();
        let rotation = match self.turn_deg_s.try_normalize() {
            Some(axis) => {
                DMat3::from_axis_angle(axis, (rate * since_s).to_radians()) * self.rotation
            }
            None => self.rotation,
        };
        Placement::new(rotation, self.position_m + self.velocity_m_s * since_s)
    }
}
