//! The primitives of scenes and where a straight line enters and leaves them.
//!
//! Each primitive is a solid that a line enters once and leaves once, so a ray meets its surface at the entrance or,
//! having started inside, at the exit: surfaces are opaque from both sides, and a solid's own edges and corners have no
//! cracks because no edge is ever computed. Primitives with the same bounding coordinate share it exactly.
//! Left out: meshes and height fields.

mod cuboid;
mod cylinder;
mod plane;
mod sphere;

use glam::DVec3;

pub use cuboid::{Cuboid, TurnedCuboid};
pub use cylinder::Cylinder;
pub use plane::Plane;
pub use sphere::Sphere;

/// A half-line; `direction` has length 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
}

/// Where the line of a ray is inside a solid, as distances from the ray's origin in metres, and what it passes there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    pub enter: Crossing,
    pub leave: Crossing,
}

/// One crossing of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Signed distance along the ray in metres.
    pub at_m: f64,
    /// Calibrated reflectivity there.
    pub reflectivity: u8,
}

/// A primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A box along the axes: a room seen from inside, a crate seen from outside.
    Cuboid(Cuboid),
    /// A box in any attitude.
    TurnedCuboid(TurnedCuboid),
    /// An endless plane.
    Plane(Plane),
    /// A vertical cylinder with flat ends.
    Cylinder(Cylinder),
    /// A sphere.
    Sphere(Sphere),
}

impl Shape {
    /// The nearest crossing of the surface strictly ahead of the ray's origin.
    #[inline]
    pub(crate) fn meet(&self, ray: &Ray) -> Option<Crossing> {
        let Passage { enter, leave } = match self {
            Self::Cuboid(shape) => shape.passage(ray),
            Self::TurnedCuboid(shape) => shape.passage(ray),
            Self::Plane(shape) => shape.passage(ray),
            Self::Cylinder(shape) => shape.passage(ray),
            Self::Sphere(shape) => shape.passage(ray),
        }?;
        if enter.at_m > 0.0 {
            Some(enter)
        } else if leave.at_m > 0.0 {
            Some(leave)
        } else {
            None
        }
    }
}

macro_rules! shapes {
    ($($name:ident),*) => {$(
        impl From<$name> for Shape {
            fn from(shape: $name) -> Self {
                Self::$name(shape)
            }
        }
    )*};
}
shapes!(Cuboid, TurnedCuboid, Plane, Cylinder, Sphere);

/// The distances between which `origin + t * direction` is within `low..=high`, one coordinate; empty is `None`.
#[inline]
fn slab(origin: f64, direction: f64, low: f64, high: f64) -> Option<(f64, f64)> {
    if direction == 0.0 {
        // Parallel: in it for ever or never. Dividing would make 0/0 of a ray in the face.
        return (low <= origin && origin <= high).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (a, b) = ((low - origin) / direction, (high - origin) / direction);
    Some(if direction > 0.0 { (a, b) } else { (b, a) })
}
