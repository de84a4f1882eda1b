//! A scene: objects that rays are cast at, and what they are made of.
//!
//! Coordinates are f64 metres in the frame of the platform's base: origin on the tilt axis, z up, the lidar's forward direction along y. Left out: how rays
//! are cast ([`crate::cast`]), how a scene is described ([`crate::scenery`]), what moves.

use glam::DVec3;

use crate::cast::{CastError, Caster, Hit as CastHit, Normal, Object, Ray, Reach};
use crate::scenery::{Coat, Material, Placed};

/// Objects and materials.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    placed: Placed,
    caster: Caster,
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

    /// What a scene file places.
    ///
    /// # Errors
    /// [`CastError`] for what cannot be cast at.
    pub fn of(placed: Placed) -> Result<Self, CastError> {
        let caster = placed.caster()?;
        Ok(Self { placed, caster })
    }

    /// The scene with one more object, of one calibrated reflectivity all over.
    ///
    /// # Errors
    /// [`CastError`] for what cannot be cast at.
    pub fn with(self, object: Object, reflectivity: u8) -> Result<Self, CastError> {
        let mut placed = self.placed;
        placed.coats.push(Coat::One(placed.materials.len() as u32));
        placed.materials.push(Material {
            reflectivity,
            ..Material::plain()
        });
        placed.objects.push(object);
        placed.lines.push(0);
        Self::of(placed)
    }

    /// Objects and materials as they were placed.
    #[must_use]
    pub const fn placed(&self) -> &Placed {
        &self.placed
    }

    /// The objects, to cast rays at.
    #[must_use]
    pub const fn caster(&self) -> &Caster {
        &self.caster
    }

    /// What a hit of the caster is made of.
    #[inline]
    pub(crate) fn material<N>(&self, hit: &CastHit<N>) -> Option<&Material> {
        self.placed.material(hit.object.index(), hit.primitive)
    }

    /// The nearest surface ahead of `origin_m` along `direction` no farther than `up_to_m`, whatever it is made of. What is no ray meets nothing.
    pub(crate) fn nearest<N: Normal>(
        &self,
        origin_m: DVec3,
        direction: DVec3,
        up_to_m: f64,
    ) -> Option<(CastHit<N>, &Material)> {
        let ray = Ray::new(origin_m, direction).ok()?;
        let hit = self.caster.nearest(&ray, Reach::up_to(up_to_m))?;
        Some((hit, self.material(&hit)?))
    }

    /// The nearest surface ahead of `origin_m` along `direction` (length 1), if it lies within `min_m..=max_m`.
    ///
    /// A surface nearer than `min_m` blocks the ray and does not return it, as does one that absorbs. A ray that starts on a surface does not
    /// meet it there. What is not finite meets nothing.
    #[must_use]
    pub fn cast(&self, origin_m: DVec3, direction: DVec3, min_m: f64, max_m: f64) -> Option<Hit> {
        let (hit, material) = self.nearest::<()>(origin_m, direction, max_m)?;
        let seen = Hit {
            range_m: hit.range_m,
            reflectivity: material.reflectivity,
        };
        (hit.range_m >= min_m && !material.absorbing).then_some(seen)
    }
}

#[cfg(test)]
mod tests;
