//! Ray casting: the first surface along a ray, its distance, and on request the normal there.
//!
//! A [`Caster`] holds objects: surfaces, each at its [`Placement`]. It casts one ray
//! ([`Caster::nearest`]) or many ([`Caster::nearest_of`]), in f64 and without gaps
//! between triangles. Every result is a function of its ray and the objects alone: the same bits
//! for one ray or many, in any order, on any number of threads, with any registers.
//!
//! It is fast by trees of boxes with eight children (`bvh`), boxes in f32 with contents in f64
//! (`beam`, `triangle`), and eight rays at a time where they go nearly the same way (`packet`).
//! docs/src/rays.md compares it with published crates.

mod batch;
mod beam;
mod build;
mod bvh;
mod caster;
mod height_field;
mod mesh;
mod packet;
mod placement;
mod ray;
mod solids;
mod solids8;
mod surface;
mod triangle;

pub(crate) use batch::Packets;
pub use build::Quality;
pub use caster::{CastError, Caster};
pub use height_field::{HeightField, HeightFieldError};
pub use mesh::{Mesh, MeshError};
pub(crate) use packet::{LANES, Nearest, RayLanes};
pub use placement::{Placement, PlacementError};
pub use ray::{Hit, ObjectId, Ray, RayError, Reach};
pub use solids::{Cuboid, Cylinder, Plane, Sphere};
pub use surface::{Object, Surface};
pub use triangle::ShearedRays;

#[cfg(test)]
mod tests;
