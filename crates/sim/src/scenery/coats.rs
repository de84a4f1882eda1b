//! What things are made of, and which material is where.
//!
//! Left out: what light does with it (effects).

use crate::cast::{CastError, Caster, Object};

use super::error::{At, SceneryError, within, wrong};
use super::moving::Moving;
use super::objects::MaterialTable;

/// A material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the scene.
    pub name: String,
    /// Calibrated reflectivity as the VLP-16 reports it (63-9243): 0..=100 the percentage of light that it scatters, 101..=255 retroreflecting.
    pub reflectivity: u8,
    /// Share of the light that goes off as from a mirror instead of being scattered, 0..=1.
    pub specular: f64,
    /// Whether a beam that meets it is lost: an opening that leads nowhere.
    pub absorbing: bool,
}

impl Material {
    /// What an object is made of that does not say so.
    #[must_use]
    pub fn plain() -> Self {
        Self {
            name: String::new(),
            reflectivity: 50,
            specular: 0.0,
            absorbing: false,
        }
    }

    pub(super) fn new(name: String, table: &MaterialTable, at: &At) -> Result<Self, SceneryError> {
        let material = Self {
            reflectivity: table.reflectivity.unwrap_or(0),
            specular: table.specular,
            absorbing: table.absorbing,
            name,
        };
        within(at, "specular", table.specular, 0.0..=1.0)?;
        if table.reflectivity.is_none() && !table.absorbing {
            let what = format!("materials.{}", material.name);
            return Err(wrong(
                at,
                what,
                "reflectivity, or absorbing = true",
                "neither",
            ));
        }
        Ok(material)
    }
}

/// Which material an object has, by its number among the materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coat {
    /// All over.
    One(u32),
    /// On the faces of a box: -x, +x, -y, +y, -z, +z.
    Faces([u32; 6]),
}

/// A scene that can be cast at: its objects in order and, by the same numbers, what they are made of.
#[derive(Clone, Debug, Default)]
pub struct Placed {
    /// What rays meet.
    pub objects: Vec<Object>,
    /// What they are made of, one of each.
    pub coats: Vec<Coat>,
    /// All materials.
    pub materials: Vec<Material>,
    /// Which of them move, and how.
    pub moving: Vec<Moving>,
    /// Which line of the scene each object comes from.
    pub lines: Vec<usize>,
}

impl Placed {
    /// The material where a ray hit: by the number of the object and its primitive (a [`crate::cast::Hit`] has both).
    #[inline]
    #[must_use]
    pub fn material(&self, object: usize, primitive: u32) -> Option<&Material> {
        let number = match self.coats.get(object)? {
            Coat::One(number) => number,
            Coat::Faces(faces) => faces.get(primitive as usize)?,
        };
        self.materials.get(*number as usize)
    }

    /// The objects to cast rays at.
    ///
    /// # Errors
    /// [`CastError`] for what cannot be cast at.
    pub fn caster(&self) -> Result<Caster, CastError> {
        Caster::new(self.objects.iter().cloned())
    }
}
