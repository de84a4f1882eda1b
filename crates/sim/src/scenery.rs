//! What stands around the scanner: the objects and materials of a scene file.
//!
//! [`Scenery::parse`] gives what the text says, every number in its range and every key known. [`Scenery::place`] makes of it
//! what rays are cast at ([`Placed`]); mesh files it gets through a function, for there are no files here. Scenes that come with the
//! simulator are in [`SHIPPED`]. Whatever is wrong is told with its line and column, and what was expected.
//!
//! Left out: the other sections of a scene file; what light does with materials, and moving what moves (effects); files.

mod coats;
mod error;
mod generators;
mod meshes;
mod moving;
mod objects;
mod place;
mod shipped;

pub use coats::{Coat, Material, Placed};
pub use error::{At, SceneryError};
pub use generators::{ParkedCars, Quarry, Trees};
pub use meshes::{MeshFileError, MeshFormat};
pub use moving::{Moving, Travel};
pub use objects::{
    BoxShape, Copies, CylinderShape, Facade, HeightFieldShape, MaterialTable, MeshShape,
    ObjectTable, PlaneShape, SphereShape,
};
pub(crate) use place::rotation;
pub use shipped::{SHIPPED, shipped};

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

/// What a scene file says of what stands around the scanner.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenery {
    /// What things are made of, in the order of their names.
    pub materials: Vec<Material>,
    /// What there is, each with where it stands in the file.
    pub objects: Vec<(At, ObjectTable)>,
}

/// The two sections as they stand, for a document that has others too.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Sections {
    pub materials: BTreeMap<Spanned<String>, Spanned<MaterialTable>>,
    pub objects: Vec<Spanned<ObjectTable>>,
}

impl Scenery {
    /// Reads `[materials]` and `[[objects]]` of a scene file and passes over its other sections.
    ///
    /// # Errors
    /// [`SceneryError`] with line and column, for text that is no TOML, a key that is not known, a value out of its range, or a material
    /// that is not there.
    pub fn parse(text: &str) -> Result<Self, SceneryError> {
        let sections: Sections =
            toml::from_str(text).map_err(|error| SceneryError::toml(text, &error))?;
        Self::new(text, sections)
    }

    /// Of sections that were read from this text.
    pub(crate) fn new(text: &str, sections: Sections) -> Result<Self, SceneryError> {
        let at = |span: std::ops::Range<usize>| At::of(text, span.start);
        let mut materials = Vec::new();
        for (name, table) in sections.materials {
            let begin = name.span().start;
            let material = Material::new(name.into_inner(), table.get_ref(), &At::of(text, begin));
            materials.push(material.map_err(|error| error.at_its_value(text, begin))?);
        }
        let mut objects = Vec::new();
        for object in sections.objects {
            let span = object.span();
            let (begin, at, object) = (span.start, at(span), object.into_inner());
            (object.check(&at, &materials)).map_err(|error| error.at_its_value(text, begin))?;
            objects.push((at, object));
        }
        Ok(Self { materials, objects })
    }

    /// Makes what rays are cast at. What is made up depends on `seed`; `file` gives the bytes of a mesh file by its name in the scene, or
    /// says why it cannot.
    ///
    /// # Errors
    /// [`SceneryError`] for a mesh that cannot be had or is none, and for geometry that cannot be.
    pub fn place(
        &self,
        seed: u64,
        file: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Placed, SceneryError> {
        place::place(self, seed, file)
    }
}

/// No file: for scenes that need none, as all that are [`SHIPPED`].
///
/// # Errors
/// Always, with the name.
pub fn no_files(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("there are no files here, got {name}"))
}

#[cfg(test)]
mod tests;
