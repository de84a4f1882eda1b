//! A scene: primitives about a local origin, and the first that a ray meets.
//!
//! Coordinates are f64 metres in the frame of the platform's base: origin on the tilt axis, z up, the lidar's forward
//! direction along y. Keeping the origin local keeps the precision; map coordinates are for whoever places the scene.
//! Left out: normals, materials beyond one reflectivity a face, moving objects, acceleration structures.

use glam::DVec3;

use crate::shapes::{Ray, Shape};

/// Primitives that rays are cast at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    shapes: Vec<Shape>,
}

/// Where a ray met the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray in metres.
    pub range_m: f64,
    /// Calibrated reflectivity of what it met: 0..=100 diffuse, above that retroreflecting (manual 63-9243).
    pub reflectivity: u8,
}

impl Scene {
    /// An empty scene: no ray returns.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The scene with one more primitive.
    #[must_use]
    pub fn with(mut self, shape: impl Into<Shape>) -> Self {
        self.shapes.push(shape.into());
        self
    }

    /// The primitives.
    #[must_use]
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// The nearest surface strictly ahead of `origin_m` along `direction` (length 1), if it lies within `min_m..=max_m`.
    ///
    /// A surface nearer than `min_m` blocks the ray and does not return it. A ray that starts on a surface does not meet it
    /// there. What is not finite meets nothing.
    #[inline]
    #[must_use]
    pub fn cast(&self, origin_m: DVec3, direction: DVec3, min_m: f64, max_m: f64) -> Option<Hit> {
        if !(origin_m.is_finite() && direction.is_finite()) {
            return None;
        }
        let ray = Ray {
            origin: origin_m,
            direction,
        };
        let mut nearest = Hit {
            range_m: f64::INFINITY,
            reflectivity: 0,
        };
        for shape in &self.shapes {
            if let Some(crossing) = shape.meet(&ray)
                && crossing.at_m < nearest.range_m
            {
                nearest = Hit {
                    range_m: crossing.at_m,
                    reflectivity: crossing.reflectivity,
                };
            }
        }
        let within =
            nearest.range_m.is_finite() && min_m <= nearest.range_m && nearest.range_m <= max_m;
        within.then_some(nearest)
    }
}

#[cfg(test)]
mod tests;
