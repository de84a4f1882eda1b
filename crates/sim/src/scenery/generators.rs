//! Generated geometry: a car park, trees, facades, a quarry. One seed gives one result.
//!
//! Modelled on such places, not measured.

mod draws;
mod facade;
mod parked_cars;
mod quarry;
mod trees;

pub(super) use draws::seed;
pub(super) use facade::facade;
pub use parked_cars::ParkedCars;
pub(super) use parked_cars::parked_cars;
pub use quarry::Quarry;
pub(super) use quarry::quarry;
pub use trees::Trees;
pub(super) use trees::trees;

use glam::{DMat3, DVec3};

use super::materials::MaterialAssignment;
use crate::cast::{Cuboid, Surface};
use crate::random::Draws;

/// A surface of a generated object, in the object's frame.
#[derive(Clone, Debug)]
pub(super) struct ObjectPart {
    pub surface: Surface,
    pub assignment: MaterialAssignment,
    pub rotation: DMat3,
    pub position_m: DVec3,
}

impl ObjectPart {
    /// At the table's origin.
    pub fn new(surface: impl Into<Surface>, assignment: MaterialAssignment) -> Self {
        Self {
            surface: surface.into(),
            assignment,
            rotation: DMat3::IDENTITY,
            position_m: DVec3::ZERO,
        }
    }

    /// A box between two corners, of one material.
    fn cuboid(from_m: [f64; 3], to_m: [f64; 3], material: u32) -> Self {
        Self::new(
            Cuboid::new(from_m.into(), to_m.into()),
            MaterialAssignment::One(material),
        )
    }

    /// Moved and not turned, metres.
    pub fn moved(mut self, by_m: DVec3) -> Self {
        self.position_m += by_m;
        self
    }

    /// Turned about the vertical through the origin, then moved.
    fn set_down(mut self, turn: DMat3, at_m: DVec3) -> Self {
        self.rotation = turn * self.rotation;
        self.position_m = turn * self.position_m + at_m;
        self
    }
}
