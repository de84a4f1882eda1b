//! Spheres.

use glam::DVec3;

use super::{Crossing, Passage, Ray};

/// A sphere, seen from outside or inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    centre: DVec3,
    radius_m: f64,
    reflectivity: u8,
}

impl Sphere {
    /// The sphere about `centre`, metres.
    #[must_use]
    pub fn new(centre: DVec3, radius_m: f64, reflectivity: u8) -> Self {
        Self {
            centre,
            radius_m: radius_m.abs(),
            reflectivity,
        }
    }

    /// By the perpendicular from the centre to the ray. The discriminant of the quadratic would subtract squares of the
    /// distance, which for a small sphere far away leaves nothing of its radius.
    #[inline]
    pub(crate) fn passage(&self, ray: &Ray) -> Option<Passage> {
        let to_centre = self.centre - ray.origin;
        let nearest = to_centre.dot(ray.direction);
        let miss = (to_centre - nearest * ray.direction).length();
        let half_squared = (self.radius_m - miss) * (self.radius_m + miss);
        if half_squared < 0.0 {
            return None;
        }
        let half = half_squared.sqrt();
        let crossing = |at_m| Crossing {
            at_m,
            reflectivity: self.reflectivity,
        };
        Some(Passage {
            enter: crossing(nearest - half),
            leave: crossing(nearest + half),
        })
    }
}
