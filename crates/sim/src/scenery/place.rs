//! From what a scene says to what rays are cast at.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::Scenery;
use super::error::{FilePosition, InvalidValue, SceneryError, invalid};
use super::generators::{self, ObjectPart};
use super::materials::{Material, MaterialAssignment, PlacedScenery};
use super::meshes::{self, MeshFileError, MeshFormat};
use super::moving::{Moving, Travel};
use super::objects::{HeightFieldShape, MeshShape, ObjectTable};
use crate::cast::{
    Cuboid, Cylinder, HeightField, HeightFieldError, Mesh, Object, Placement, Plane, Sphere,
    Surface,
};

/// Gives the bytes of a mesh file by its name in the scene.
type Files<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// The scene as it is built up.
struct Builder<'a> {
    seed: u64,
    files: Files<'a>,
    /// Meshes that several objects share: by file, unit and which way is up.
    meshes: BTreeMap<(String, u64, Option<bool>), Arc<Mesh>>,
    placed: PlacedScenery,
}

pub(super) fn place(
    scenery: &Scenery,
    seed: u64,
    files: Files<'_>,
) -> Result<PlacedScenery, SceneryError> {
    let mut materials = scenery.materials.clone();
    materials.push(Material::plain());
    let mut builder = Builder {
        seed,
        files,
        meshes: BTreeMap::new(),
        placed: PlacedScenery {
            materials,
            ..PlacedScenery::default()
        },
    };
    for (number, (at, object)) in scenery.objects.iter().enumerate() {
        builder.object(number as u64, *at, object)?;
    }
    Ok(builder.placed)
}

impl Builder<'_> {
    fn object(
        &mut self,
        number: u64,
        at: FilePosition,
        table: &ObjectTable,
    ) -> Result<(), SceneryError> {
        let parts = self.parts(number, at, table)?;
        let turn = rotation(table.rotation_deg);
        for offset_m in table.copies.offsets_m() {
            let origin_m = DVec3::from_array(table.position_m) + turn * DVec3::from_array(offset_m);
            let first = self.placed.objects.len();
            for part in &parts {
                let rotation = turn * part.rotation;
                let position_m = origin_m + turn * part.position_m;
                let placement = Placement::new(rotation, position_m).map_err(|error| {
                    invalid("placement", "coordinates within 1e15 m", error.to_string()).at(at)
                })?;
                let object = Object::new(part.surface.clone()).placed(placement);
                self.placed.objects.push(object);
                self.placed.assignments.push(part.assignment);
            }
            if table.is_moving() {
                self.placed.moving.push(Moving {
                    objects: first..self.placed.objects.len(),
                    travel: Travel {
                        from_m: origin_m,
                        velocity_m_s: table.velocity_m_s.into(),
                        turn_deg_s: table.turn_deg_s.into(),
                    },
                    at,
                });
            }
        }
        Ok(())
    }

    /// The surfaces of a table, in its own frame.
    fn parts(
        &mut self,
        number: u64,
        at: FilePosition,
        table: &ObjectTable,
    ) -> Result<Vec<ObjectPart>, SceneryError> {
        let seed = generators::seed(self.seed, number);
        let named = |name: &str| material(&self.placed.materials, name);
        let own = table.material.as_deref().map_or_else(|| named(""), named);
        if let Some(facade) = &table.facade {
            return Ok(generators::facade(facade, own, named(&facade.glass)));
        }
        if let Some(cars) = &table.parked_cars {
            return Ok(generators::parked_cars(cars, seed, &named));
        }
        if let Some(trees) = &table.trees {
            return Ok(generators::trees(trees, seed, own, named(&trees.foliage)));
        }
        if let Some(quarry) = table
            .height_field
            .as_ref()
            .and_then(|field| field.made_up())
        {
            let field = generators::quarry(quarry, seed).and_then(|field| field.mesh());
            let mesh = field.map_err(|error| no_heights(&error).at(at))?;
            let corner_m = DVec3::new(-quarry.half_m(), -quarry.half_m(), 0.0);
            return Ok(vec![
                ObjectPart::new(mesh, MaterialAssignment::One(own)).moved(corner_m),
            ]);
        }
        let assignment = match table
            .cuboid
            .as_ref()
            .and_then(|cuboid| cuboid.faces.as_ref())
        {
            Some(faces) => MaterialAssignment::Faces(faces.each_ref().map(|name| named(name))),
            None => MaterialAssignment::One(own),
        };
        let surface = self.surface(at, table)?;
        Ok(vec![ObjectPart::new(surface, assignment)])
    }

    /// One of the shapes that are one surface.
    fn surface(&mut self, at: FilePosition, table: &ObjectTable) -> Result<Surface, SceneryError> {
        if let Some(sphere) = &table.sphere {
            let radius_m = sphere.radius_m;
            return Ok(Sphere { radius_m }.into());
        }
        if let Some(cuboid) = &table.cuboid {
            let [from, to] = cuboid.corners().map_err(|error| error.at(at))?;
            return Ok(Cuboid::new(from.into(), to.into()).into());
        }
        if let Some(cylinder) = &table.cylinder {
            let surface = Cylinder {
                radius_m: cylinder.radius_m,
                bottom_m: cylinder.bottom_m,
                top_m: cylinder.bottom_m + cylinder.height_m,
                capped: cylinder.capped,
            };
            return Ok(surface.into());
        }
        if let Some(mesh) = &table.mesh {
            return Ok(self.mesh(at, mesh)?.into());
        }
        if let Some(field) = &table.height_field {
            return height_field(field).map_err(|error| error.at(at));
        }
        Ok(Plane.into())
    }

    /// A mesh from its file, read once.
    fn mesh(&mut self, at: FilePosition, shape: &MeshShape) -> Result<Arc<Mesh>, SceneryError> {
        let key = (shape.file.clone(), shape.unit_m.to_bits(), shape.y_up);
        if let Some(mesh) = self.meshes.get(&key) {
            return Ok(Arc::clone(mesh));
        }
        let files = &mut *self.files;
        let mut read = || -> Result<Mesh, MeshFileError> {
            let format = MeshFormat::of(&shape.file)?;
            let mut file = |name: &str| files(name).map_err(MeshFileError::File);
            let bytes = file(&shape.file)?;
            let mut beside = |name: &str| file(&beside(&shape.file, name));
            let y_up = shape.y_up.unwrap_or(format == MeshFormat::Gltf);
            meshes::read(format, &bytes, &mut beside)?
                .scaled(shape.unit_m, y_up)
                .mesh()
        };
        let mesh = read().map_err(|source| SceneryError {
            at,
            what: format!("mesh {}", shape.file),
            source: Some(source),
        })?;
        let mesh = Arc::new(mesh);
        self.meshes.insert(key, Arc::clone(&mesh));
        Ok(mesh)
    }
}

/// A file's name relative to another's folder.
fn beside(of: &str, name: &str) -> String {
    match of.rsplit_once('/') {
        Some((folder, _)) => format!("{folder}/{name}"),
        None => name.to_owned(),
    }
}

/// The number of a material; the last one where there is none of the name.
fn material(materials: &[Material], name: &str) -> u32 {
    let number = materials.iter().position(|material| material.name == name);
    number.unwrap_or(materials.len().saturating_sub(1)) as u32
}

/// A grid of heights that the scene itself gives.
fn height_field(shape: &HeightFieldShape) -> Result<Surface, InvalidValue> {
    match (shape.columns, shape.spacing_m, &shape.heights_m) {
        (Some(columns), Some(spacing_m), Some(heights_m)) => {
            let field = HeightField::new(columns, heights_m.clone(), spacing_m);
            let mesh = field.and_then(|field| field.mesh());
            Ok(mesh.map_err(|error| no_heights(&error))?.into())
        }
        _ => {
            let expected = "columns, spacing_m and heights_m, or quarry";
            Err(invalid("height_field", expected, shape))
        }
    }
}

fn no_heights(error: &HeightFieldError) -> InvalidValue {
    let got =
        std::error::Error::source(error).map_or_else(|| error.to_string(), ToString::to_string);
    invalid("height_field", "a grid of finite heights", got)
}

/// Turned about x, then y, then z of the outer frame, degrees.
pub(crate) fn rotation([x, y, z]: [f64; 3]) -> DMat3 {
    let about = |axis: usize, degrees: f64| {
        let (sin, cos) = sin_cos_deg(degrees);
        let mut columns = [DVec3::X, DVec3::Y, DVec3::Z];
        // y follows x, z follows y, x follows z.
        let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
        let (a, b) = (columns[first], columns[second]);
        columns[first] = cos * a + sin * b;
        columns[second] = cos * b - sin * a;
        DMat3::from_cols(columns[0], columns[1], columns[2])
    };
    about(2, z) * about(1, y) * about(0, x)
}

/// Exact at quarter turns, so that a wall that is to be upright is.
fn sin_cos_deg(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    let (sin, cos) = (degrees - 90.0 * quarters).to_radians().sin_cos();
    match quarters.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}
