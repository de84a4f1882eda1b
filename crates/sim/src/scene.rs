//! A scene: primitives about a local origin, or what a scene file places, and the first that a ray meets.
//!
//! Coordinates are f64 metres in the frame of the platform's base: origin on the tilt axis, z up, the lidar's forward
//! direction along y. Keeping the origin local keeps the precision; map coordinates are for whoever places the scene.
//! A few primitives are asked one after the other; what a scene file places has its own trees ([`crate::cast`]). Left out: moving objects.

use std::sync::Arc;

use glam::DVec3;

use crate::cast::{CastError, Caster, Normal, Ray as CastRay, Reach};
use crate::scenery::Placed;
use crate::shapes::{Ray, Shape};

/// Primitives that rays are cast at.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    shapes: Vec<Shape>,
    placed: Option<Arc<(Placed, Caster)>>,
}

/// Where a ray met the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray in metres.
    pub range_m: f64,
    /// Calibrated reflectivity of what it met: 0..=100 diffuse, above that retroreflecting (manual 63-9243).
    pub reflectivity: u8,
}

/// The surface there, as light meets it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Facet {
    /// Its normal, length 1, whichever way it points; zero for primitives, whose normals nobody keeps.
    pub normal: DVec3,
    /// Share of the light that goes off as from a mirror, 0..=1.
    pub specular: f64,
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

    /// What a scene file places.
    ///
    /// # Errors
    /// [`CastError`] for what cannot be cast at.
    pub fn of(placed: Placed) -> Result<Self, CastError> {
        let caster = placed.caster()?;
        Ok(Self {
            shapes: Vec::new(),
            placed: Some(Arc::new((placed, caster))),
        })
    }

    /// What a scene file placed, and the caster of it.
    #[must_use]
    pub fn placed(&self) -> Option<(&Placed, &Caster)> {
        self.placed
            .as_deref()
            .map(|(placed, caster)| (placed, caster))
    }

    /// As [`Scene::cast`], with what light needs to know of the surface.
    #[inline]
    #[must_use]
    pub fn cast_with_facet(
        &self,
        origin_m: DVec3,
        direction: DVec3,
        min_m: f64,
        max_m: f64,
    ) -> Option<(Hit, Facet)> {
        let Some(scene) = self.placed() else {
            let hit = self.cast(origin_m, direction, min_m, max_m)?;
            return Some((hit, Facet::default()));
        };
        let (hit, normal, specular) = meet::<DVec3>(scene, origin_m, direction, min_m, max_m)?;
        Some((hit, Facet { normal, specular }))
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
    // One copy for all who call it: else their number decides what is inlined in it, and one more slows the others down.
    #[inline(never)]
    #[must_use]
    pub fn cast(&self, origin_m: DVec3, direction: DVec3, min_m: f64, max_m: f64) -> Option<Hit> {
        if !(origin_m.is_finite() && direction.is_finite()) {
            return None;
        }
        if let Some(scene) = self.placed() {
            let (hit, (), _) = meet::<()>(scene, origin_m, direction, min_m, max_m)?;
            return Some(hit);
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

/// What a ray meets of what a scene file placed, its normal and how much of it is a mirror. What absorbs returns nothing.
#[inline]
fn meet<N: Normal>(
    (placed, caster): (&Placed, &Caster),
    origin_m: DVec3,
    direction: DVec3,
    min_m: f64,
    max_m: f64,
) -> Option<(Hit, N, f64)> {
    let ray = CastRay::new(origin_m, direction).ok()?;
    let hit = caster.nearest::<N>(&ray, Reach::up_to(max_m))?;
    let material = placed.material(hit.object.index(), hit.primitive)?;
    let seen = Hit {
        range_m: hit.range_m,
        reflectivity: material.reflectivity,
    };
    let returns = hit.range_m >= min_m && !material.absorbing;
    returns.then_some((seen, hit.normal, material.specular))
}

#[cfg(test)]
mod tests;
