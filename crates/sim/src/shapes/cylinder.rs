//! Vertical cylinders: pillars, drums, poles.

use glam::{DVec2, Vec3Swizzles};

use super::{Crossing, Passage, Ray, slab};

/// A vertical cylinder with flat ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    centre: DVec2,
    radius_m: f64,
    low_m: f64,
    high_m: f64,
    reflectivity: u8,
}

impl Cylinder {
    /// The cylinder about the vertical through `centre` (x and y, metres) between the heights `bottom_m` and `top_m`.
    #[must_use]
    pub fn new(centre: DVec2, radius_m: f64, bottom_m: f64, top_m: f64, reflectivity: u8) -> Self {
        Self {
            centre,
            radius_m: radius_m.abs(),
            low_m: bottom_m.min(top_m),
            high_m: bottom_m.max(top_m),
            reflectivity,
        }
    }

    /// The overlap of the endless cylinder, in the form of [`super::Sphere`], with the slab between the ends.
    #[inline]
    pub(crate) fn passage(&self, ray: &Ray) -> Option<Passage> {
        let to_axis = self.centre - ray.origin.xy();
        let level = ray.direction.xy();
        let level_squared = level.length_squared();
        let (round_near, round_far) = if level_squared == 0.0 {
            // Straight up or down: within the circle for ever or never.
            (to_axis.length_squared() <= self.radius_m * self.radius_m)
                .then_some((f64::NEG_INFINITY, f64::INFINITY))?
        } else {
            let nearest = to_axis.dot(level) / level_squared;
            let miss = (to_axis - nearest * level).length();
            let half_squared = (self.radius_m - miss) * (self.radius_m + miss);
            if half_squared < 0.0 {
                return None;
            }
            let half = (half_squared / level_squared).sqrt();
            (nearest - half, nearest + half)
        };
        let (near, far) = slab(ray.origin.z, ray.direction.z, self.low_m, self.high_m)?;
        let (enter, leave) = (round_near.max(near), round_far.min(far));
        let crossing = |at_m| Crossing {
            at_m,
            reflectivity: self.reflectivity,
        };
        (enter <= leave).then_some(Passage {
            enter: crossing(enter),
            leave: crossing(leave),
        })
    }
}
