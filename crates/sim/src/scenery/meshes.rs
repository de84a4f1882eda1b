//! Mesh files: Wavefront OBJ, PLY (text and binary) and glTF 2.0 (text and GLB).
//!
//! Only triangles are read; polygons become triangle fans from their first corner. Materials,
//! normals, textures and animation are ignored.

mod gltf;
mod obj;
mod ply;

use glam::DVec3;
use thiserror::Error;

use crate::cast::{Mesh, MeshError};

/// A kind of mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// PLY.
    Ply,
    /// glTF 2.0, text or binary.
    Gltf,
}

/// An invalid mesh file.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MeshFileError {
    /// It is not there, or cannot be read.
    #[error("{0}")]
    File(String),
    /// An ending that is not known.
    #[error("expected a name that ends in .obj, .ply, .gltf or .glb, got {0}")]
    Ending(String),
    /// Contents that are not what the ending says.
    #[error("{format:?}: {message}")]
    Contents {
        /// The format it was read as.
        format: MeshFormat,
        /// The error.
        message: String,
    },
    /// Nothing to hit.
    #[error("expected triangles, got none")]
    Empty,
    /// Its triangles are none.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl MeshFormat {
    /// By the ending of a file's name.
    ///
    /// # Errors
    /// [`MeshFileError::Ending`].
    pub fn of(name: &str) -> Result<Self, MeshFileError> {
        let ending = name
            .rsplit_once('.')
            .map(|(_, ending)| ending.to_ascii_lowercase());
        match ending.as_deref() {
            Some("obj") => Ok(Self::Obj),
            Some("ply") => Ok(Self::Ply),
            Some("gltf" | "glb") => Ok(Self::Gltf),
            _ => Err(MeshFileError::Ending(name.to_owned())),
        }
    }
}

/// The triangles of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TriangleSoup {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleSoup {
    /// In metres, z up.
    pub fn scaled(mut self, unit_m: f64, y_up: bool) -> Self {
        for vertex in &mut self.vertices {
            *vertex *= unit_m;
            if y_up {
                *vertex = DVec3::new(vertex.x, -vertex.z, vertex.y);
            }
        }
        self
    }

    pub fn mesh(&self) -> Result<Mesh, MeshFileError> {
        if self.triangles.is_empty() {
            return Err(MeshFileError::Empty);
        }
        Ok(Mesh::new(&self.vertices, &self.triangles)?)
    }
}

/// Gives the bytes of a file that another names.
pub(super) type ReadReferencedFile<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, MeshFileError>;

pub(super) fn read(
    format: MeshFormat,
    bytes: &[u8],
    read_referenced: ReadReferencedFile<'_>,
) -> Result<TriangleSoup, MeshFileError> {
    match format {
        MeshFormat::Obj => obj::read(bytes),
        MeshFormat::Ply => ply::read(bytes),
        MeshFormat::Gltf => gltf::read(bytes, read_referenced),
    }
    .map_err(|fault| match fault {
        Fault::Own(message) => MeshFileError::Contents { format, message },
        Fault::ReferencedFile(error) => error,
    })
}

/// An error of a reader.
#[derive(Debug)]
enum Fault {
    /// In the file itself.
    Own(String),
    /// With a file that it names.
    ReferencedFile(MeshFileError),
}

impl<T: Into<String>> From<T> for Fault {
    fn from(message: T) -> Self {
        Self::Own(message.into())
    }
}
