//! The surroundings of the scanner: objects and materials of a scene file.
//!
//! [`Scenery::parse`] reads and checks the text. [`Scenery::place`] makes the objects that rays are
//! cast at ([`PlacedScenery`]); the caller provides the bytes of mesh files. [`SHIPPED`] has the
//! scenes of the simulator. Errors have a line and a column.

mod error;
mod generators;
mod materials;
mod meshes;
mod moving;
mod objects;
mod place;
mod shipped;

pub use error::{FilePosition, SceneryError};
pub(crate) use error::{InvalidValue, line_of_value, toml_message};
pub use materials::{Material, MaterialAssignment, MaterialTable, PlacedScenery};
pub use meshes::{MeshFileError, MeshFormat};
pub use moving::{Moving, Travel};
pub use objects::ObjectTable;
pub(crate) use place::rotation;
pub use shipped::{SHIPPED, shipped};

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

/// The materials and objects of a scene file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Scenery {
    /// Materials in the order of their names.
    pub materials: Vec<Material>,
    /// Objects, each with its position in the file.
    pub objects: Vec<(FilePosition, ObjectTable)>,
}

/// The two sections of a scene file that also has others.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct ScenerySections {
    pub materials: BTreeMap<Spanned<String>, Spanned<MaterialTable>>,
    pub objects: Vec<Spanned<ObjectTable>>,
}

impl Scenery {
    /// Reads `[materials]` and `[[objects]]` of a scene file and ignores its other sections.
    ///
    /// # Errors
    /// [`SceneryError`] with line and column, for text that is not TOML, an unknown key, a value
    /// out of range or an unknown material.
    pub fn parse(text: &str) -> Result<Self, SceneryError> {
        let sections: ScenerySections =
            toml::from_str(text).map_err(|error| SceneryError::toml(text, &error))?;
        Self::new(text, sections)
    }

    /// From sections that were read from this text.
    pub(crate) fn new(text: &str, sections: ScenerySections) -> Result<Self, SceneryError> {
        let mut materials = Vec::new();
        for (name, table) in sections.materials {
            let begin = name.span().start;
            let material = Material::new(name.into_inner(), table.get_ref());
            materials.push(material.map_err(|error| error.in_text(text, begin))?);
        }
        let mut objects = Vec::new();
        for object in sections.objects {
            let begin = object.span().start;
            let object = object.into_inner();
            (object.check(&materials)).map_err(|error| error.in_text(text, begin))?;
            objects.push((FilePosition::of(text, begin), object));
        }
        Ok(Self { materials, objects })
    }

    /// Places the objects that rays are cast at. `seed` decides generated geometry; `files` returns
    /// the bytes of a mesh file by its name in the scene, or the reason why it cannot.
    ///
    /// # Errors
    /// [`SceneryError`] for a mesh file that is missing or invalid, and for invalid geometry.
    pub fn place(
        &self,
        seed: u64,
        files: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<PlacedScenery, SceneryError> {
        place::place(self, seed, files)
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
