//! Endless planes.

use glam::DVec3;

use super::{Crossing, Passage, Ray};

/// An endless plane, seen from both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    normal: DVec3,
    offset_m: f64,
    reflectivity: u8,
}

impl Plane {
    /// The plane through `point` (metres) across `normal` (any length above zero; a plane without one is met by no ray).
    #[must_use]
    pub fn new(point: DVec3, normal: DVec3, reflectivity: u8) -> Self {
        let normal = normal.normalize_or_zero();
        Self {
            normal,
            offset_m: normal.dot(point),
            reflectivity,
        }
    }

    /// A plane is entered and left at once; not at all by a ray along it.
    #[inline]
    pub(crate) fn passage(&self, ray: &Ray) -> Option<Passage> {
        let approach = self.normal.dot(ray.direction);
        if approach == 0.0 {
            return None;
        }
        let crossing = Crossing {
            at_m: (self.offset_m - self.normal.dot(ray.origin)) / approach,
            reflectivity: self.reflectivity,
        };
        Some(Passage {
            enter: crossing,
            leave: crossing,
        })
    }
}
