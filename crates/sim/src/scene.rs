//! A scene: objects to cast rays at, and their materials.
//!
//! Coordinates are f64 metres in the frame of the platform's base: origin on the tilt axis, z up,
//! the lidar's forward direction along y.

use glam::DVec3;

use crate::cast::{CastError, Caster, Hit, Object, Ray, Reach};
use crate::scenery::{Material, MaterialAssignment, PlacedScenery, Scenery, no_files, shipped};

/// Objects and materials.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    placed: PlacedScenery,
    caster: Caster,
}

/// Intersection of a ray with the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneHit {
    /// Distance along the ray, metres.
    pub range_m: f64,
    /// Calibrated reflectivity of the surface: 0..=100 diffuse, above that retroreflecting (manual
    /// 63-9243).
    pub reflectivity: u8,
}

impl Scene {
    /// A building hall of 30 x 20 x 6 m with six pillars, crates, a cabinet and a retroreflecting
    /// sign: the scene of the rig.
    ///
    /// The scanner is near the middle, its tilt axis at the origin and the floor 1.2 m below.
    /// Every surface is from 1 m to 20 m away, so every firing returns.
    #[must_use]
    pub fn hall() -> Self {
        // A test checks that the scene exists.
        let placed = shipped("hall")
            .and_then(|text| Scenery::parse(text).ok()?.place(0, &mut no_files).ok());
        placed
            .and_then(|placed| Self::of(placed).ok())
            .unwrap_or_default()
    }

    /// An empty scene: no ray returns.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The scene of placed objects.
    ///
    /// # Errors
    /// [`CastError`] for invalid geometry.
    pub fn of(placed: PlacedScenery) -> Result<Self, CastError> {
        let caster = placed.caster()?;
        Ok(Self { placed, caster })
    }

    /// The scene with another object of one reflectivity.
    ///
    /// # Errors
    /// [`CastError`] for invalid geometry.
    pub fn with(self, object: Object, reflectivity: u8) -> Result<Self, CastError> {
        let mut placed = self.placed;
        placed
            .assignments
            .push(MaterialAssignment::One(placed.materials.len() as u32));
        placed.materials.push(Material {
            reflectivity,
            ..Material::plain()
        });
        placed.objects.push(object);
        Self::of(placed)
    }

    /// The placed objects and materials.
    #[must_use]
    pub const fn placed(&self) -> &PlacedScenery {
        &self.placed
    }

    /// The objects as a caster.
    #[must_use]
    pub const fn caster(&self) -> &Caster {
        &self.caster
    }

    /// The material at a hit of the caster.
    #[inline]
    pub(crate) fn material(&self, hit: &Hit) -> Option<&Material> {
        self.placed.material(hit.object.index(), hit.primitive)
    }

    /// The nearest surface ahead of `origin_m` in `direction` no farther than `up_to_m`, of any
    /// material. `None` for an invalid ray.
    pub(crate) fn nearest(&self, origin_m: DVec3, direction: DVec3, up_to_m: f64) -> Option<Hit> {
        let ray = Ray::new(origin_m, direction).ok()?;
        self.caster.nearest(&ray, Reach::up_to(up_to_m))
    }

    /// The nearest surface ahead of `origin_m` in `direction` (length 1), if it is within
    /// `min_m..=max_m`.
    ///
    /// A surface nearer than `min_m` or an absorbing one blocks the ray without a return. A ray
    /// that starts on a surface does not meet it there. `None` for numbers that are not finite.
    #[must_use]
    pub fn cast(
        &self,
        origin_m: DVec3,
        direction: DVec3,
        min_m: f64,
        max_m: f64,
    ) -> Option<SceneHit> {
        let hit = self.nearest(origin_m, direction, max_m)?;
        let material = self.material(&hit)?;
        let seen = SceneHit {
            range_m: hit.range_m,
            reflectivity: material.reflectivity,
        };
        (hit.range_m >= min_m && !material.absorbing).then_some(seen)
    }
}

#[cfg(test)]
mod tests;
