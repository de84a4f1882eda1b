//! `[materials.NAME]`, and the assignment of materials to objects.

use serde::Deserialize;

use super::error::{InvalidValue, invalid, within};
use super::moving::Moving;
use crate::cast::{CastError, Caster, Object};

/// `[materials.NAME]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct MaterialTable {
    /// Calibrated: 0 to 100 percent of diffuse, 101 to 255 retroreflecting.
    pub reflectivity: Option<u8>,
    /// Share of light that goes off as from a mirror, 0 to 1.
    pub specular: f64,
    /// Whether beams are lost in it.
    pub absorbing: bool,
}

/// A material.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Material {
    /// Its name in the scene.
    pub name: String,
    /// Calibrated reflectivity as the VLP-16 reports it (63-9243): 0..=100 the percentage of
    /// diffusely reflected light, 101..=255 retroreflecting.
    pub reflectivity: u8,
    /// Share of specularly reflected light, 0..=1.
    pub specular: f64,
    /// Whether nothing comes back of a beam, as of an opening.
    pub absorbing: bool,
}

impl Material {
    /// The material of objects without one.
    #[must_use]
    pub fn plain() -> Self {
        Self {
            name: String::new(),
            reflectivity: 50,
            specular: 0.0,
            absorbing: false,
        }
    }

    pub(super) fn new(name: String, table: &MaterialTable) -> Result<Self, InvalidValue> {
        within("specular", table.specular, 0.0..=1.0)?;
        if table.reflectivity.is_none() && !table.absorbing {
            let field = format!("materials.{name}");
            let expected = "reflectivity, or absorbing = true";
            return Err(invalid(&field, expected, "neither"));
        }
        Ok(Self {
            reflectivity: table.reflectivity.unwrap_or(0),
            specular: table.specular,
            absorbing: table.absorbing,
            name,
        })
    }
}

/// The material of an object, by its index among the materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialAssignment {
    /// One material for all surfaces.
    One(u32),
    /// One for each face of a box: -x, +x, -y, +y, -z, +z.
    Faces([u32; 6]),
}

/// A scene to cast rays at: its objects and, by the same index, their materials.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct PlacedScenery {
    /// The objects.
    pub objects: Vec<Object>,
    /// The material of each object.
    pub assignments: Vec<MaterialAssignment>,
    /// All materials.
    pub materials: Vec<Material>,
    /// The moving objects.
    pub moving: Vec<Moving>,
}

impl PlacedScenery {
    /// The material at a hit, by the index of the object and its primitive (see
    /// [`crate::cast::Hit`]).
    #[inline]
    #[must_use]
    pub fn material(&self, object: usize, primitive: u32) -> Option<&Material> {
        let number = match self.assignments.get(object)? {
            MaterialAssignment::One(number) => number,
            MaterialAssignment::Faces(faces) => faces.get(primitive as usize)?,
        };
        self.materials.get(*number as usize)
    }

    /// The objects as a caster.
    ///
    /// # Errors
    /// [`CastError`] for invalid geometry.
    pub fn caster(&self) -> Result<Caster, CastError> {
        Caster::new(self.objects.iter().cloned())
    }
}
