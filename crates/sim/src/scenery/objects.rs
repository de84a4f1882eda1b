//! `[[objects]]`.

use serde::Deserialize;

use super::error::{InvalidValue, above_0, finite, invalid};
use super::generators::{ParkedCars, Quarry, Trees};
use super::materials::Material;

/// One of `[[objects]]`: exactly one shape, and its placement. The rotation comes first, then the
/// translation.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct ObjectTable {
    /// For people.
    pub name: String,
    /// Its material; without one, it reflects half the light diffusely.
    pub material: Option<String>,
    /// Position of its origin, metres in the frame of the base: origin on the tilt axis, y along
    /// it, z up.
    pub position_m: [f64; 3],
    /// Rotation about x, then y, then z of the base, degrees.
    pub rotation_deg: [f64; 3],
    /// Velocity of its origin, metres per second.
    pub velocity_m_s: [f64; 3],
    /// Rotation about its origin: the axis, with degrees per second as its length.
    pub turn_deg_s: [f64; 3],
    /// The same thing several times.
    pub copies: CopyLayout,
    /// A sphere.
    pub sphere: Option<SphereShape>,
    /// A plane.
    pub plane: Option<PlaneShape>,
    /// A box.
    #[serde(rename = "box")]
    pub cuboid: Option<BoxShape>,
    /// A cylinder.
    pub cylinder: Option<CylinderShape>,
    /// A mesh from a file.
    pub mesh: Option<MeshShape>,
    /// A grid of heights.
    pub height_field: Option<HeightFieldShape>,
    /// A wall with windows.
    pub facade: Option<Facade>,
    /// A row of parked cars.
    pub parked_cars: Option<ParkedCars>,
    /// Trees.
    pub trees: Option<Trees>,
}

/// Copies of an object: offsets from its position, rotated with it. Without any, there is one at
/// its position.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CopyLayout {
    /// Offsets one by one, metres.
    pub at_m: Vec<[f64; 3]>,
    /// Number along x, y and z; with `step_m`.
    pub counts: Option<[u32; 3]>,
    /// From one to the next along x, y and z, metres.
    pub step_m: [f64; 3],
}

/// `sphere = { radius_m = R }`: about the origin, seen from inside and outside.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereShape {
    /// Metres.
    pub radius_m: f64,
}

/// `plane = {}`: endless, z = 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneShape {}

/// `box = { size_m = [x, y, z] }` about the origin, or `box = { from_m = .., to_m = .. }`: visible
/// from inside and outside.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BoxShape {
    /// Length of its edges, metres.
    pub size_m: Option<[f64; 3]>,
    /// A corner, metres.
    pub from_m: Option<[f64; 3]>,
    /// The opposite corner.
    pub to_m: Option<[f64; 3]>,
    /// Materials of the faces -x, +x, -y, +y, -z, +z.
    pub faces: Option<[String; 6]>,
}

/// `cylinder = { radius_m = R, height_m = H }`: about z, from z = 0 or `bottom_m` up.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CylinderShape {
    /// Metres.
    pub radius_m: f64,
    /// Metres.
    pub height_m: f64,
    /// Height of its bottom, metres.
    #[serde(default)]
    pub bottom_m: f64,
    /// Whether its ends are closed: a drum, not a pipe.
    #[serde(default = "yes")]
    pub capped: bool,
}

const fn yes() -> bool {
    true
}

/// `mesh = { file = "NAME" }`: OBJ, PLY, glTF or GLB by the name's ending.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshShape {
    /// Path from the scene file.
    pub file: String,
    /// Length of one unit of the file, metres.
    #[serde(default = "one")]
    pub unit_m: f64,
    /// Whether the file's up is y, as glTF has it; without it, whether it is glTF.
    pub y_up: Option<bool>,
}

const fn one() -> f64 {
    1.0
}

/// `height_field = { columns = N, spacing_m = [dx, dy], heights_m = [..] }` from the origin on, or
/// `height_field = { quarry = { .. } }`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HeightFieldShape {
    /// Number of heights along x.
    pub columns: Option<usize>,
    /// From one to the next along x and y, metres.
    pub spacing_m: Option<[f64; 2]>,
    /// Row by row along y, metres.
    pub heights_m: Option<Vec<f64>>,
    /// A made-up quarry around the origin.
    pub quarry: Option<Quarry>,
}

/// `facade = { width_m = W, height_m = H, .. }`: a wall of a building in the plane y = 0 from the
/// origin along x, its storeys of windows its panes on it, its front looking to -y.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Facade {
    /// Metres.
    pub width_m: f64,
    /// Metres.
    pub height_m: f64,
    /// Depth of the building, metres.
    pub depth_m: f64,
    /// Windows per storey.
    pub columns: u32,
    /// Windows above one another.
    pub storeys: u32,
    /// Width and height of a window, metres.
    pub window_m: [f64; 2],
    /// Height of the first row's sill above the ground, metres.
    pub sill_m: f64,
    /// Material of the panes.
    pub glass: String,
}

impl ObjectTable {
    /// Whether it moves.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        [self.velocity_m_s, self.turn_deg_s].as_flattened() != [0.0; 6]
    }

    /// Names of the shapes it says it has.
    fn shapes(&self) -> Vec<&'static str> {
        [
            ("sphere", self.sphere.is_some()),
            ("plane", self.plane.is_some()),
            ("box", self.cuboid.is_some()),
            ("cylinder", self.cylinder.is_some()),
            ("mesh", self.mesh.is_some()),
            ("height_field", self.height_field.is_some()),
            ("facade", self.facade.is_some()),
            ("parked_cars", self.parked_cars.is_some()),
            ("trees", self.trees.is_some()),
        ]
        .into_iter()
        .filter_map(|(name, there)| there.then_some(name))
        .collect()
    }

    pub(super) fn check(&self, materials: &[Material]) -> Result<(), InvalidValue> {
        let shapes = self.shapes();
        if shapes.len() != 1 {
            let expected = "exactly one of sphere, plane, box, cylinder, mesh, height_field, facade, \
                            parked_cars, trees";
            return Err(invalid("object", expected, shapes));
        }
        for name in self.materials() {
            if !materials.iter().any(|material| &material.name == name) {
                let names: Vec<_> = materials.iter().map(|m| m.name.as_str()).collect();
                let expected = match names.as_slice() {
                    [] => "a name of [materials], where none is".to_owned(),
                    names => format!("one of {}", names.join(", ")),
                };
                return Err(invalid("material", &expected, name));
            }
        }
        finite("position_m", &self.position_m)?;
        finite("rotation_deg", &self.rotation_deg)?;
        finite("velocity_m_s", &self.velocity_m_s)?;
        finite("turn_deg_s", &self.turn_deg_s)?;
        self.copies.check()?;
        self.check_shape()
    }

    /// All materials that it names.
    fn materials(&self) -> impl Iterator<Item = &String> {
        let faces = self
            .cuboid
            .iter()
            .filter_map(|cuboid| cuboid.faces.as_ref());
        self.material
            .iter()
            .chain(faces.flatten())
            .chain(self.facade.iter().map(|facade| &facade.glass))
            .chain(self.parked_cars.iter().flat_map(ParkedCars::materials))
            .chain(self.trees.iter().map(|trees| &trees.foliage))
    }

    fn check_shape(&self) -> Result<(), InvalidValue> {
        if let Some(sphere) = &self.sphere {
            above_0("sphere.radius_m", sphere.radius_m)?;
        }
        if let Some(cylinder) = &self.cylinder {
            above_0("cylinder.radius_m", cylinder.radius_m)?;
            above_0("cylinder.height_m", cylinder.height_m)?;
            finite("cylinder.bottom_m", &[cylinder.bottom_m])?;
        }
        if let Some(cuboid) = &self.cuboid {
            cuboid.corners()?;
        }
        if let Some(mesh) = &self.mesh {
            above_0("mesh.unit_m", mesh.unit_m)?;
        }
        if let Some(facade) = &self.facade {
            facade.check()?;
        }
        if let Some(cars) = &self.parked_cars {
            cars.check()?;
        }
        if let Some(trees) = &self.trees {
            trees.check()?;
        }
        if let Some(quarry) = self
            .height_field
            .as_ref()
            .and_then(|field| field.quarry.as_ref())
        {
            quarry.check()?;
        }
        Ok(())
    }
}

impl CopyLayout {
    /// The most that one object may be copied.
    const MOST: u64 = 100_000;

    fn check(&self) -> Result<(), InvalidValue> {
        finite("copies.at_m", self.at_m.as_flattened())?;
        finite("copies.step_m", &self.step_m)?;
        let counts = self.counts.unwrap_or([1; 3]).map(u64::from);
        let all = counts
            .iter()
            .fold(1_u64, |all, count| all.saturating_mul(*count));
        let all = all.saturating_mul(self.at_m.len().max(1) as u64);
        match (1..=Self::MOST).contains(&all) {
            true => Ok(()),
            false => Err(invalid("copies", &format!("1 to {}", Self::MOST), all)),
        }
    }

    /// All offsets, metres.
    pub(super) fn offsets_m(&self) -> Vec<[f64; 3]> {
        let [nx, ny, nz] = self.counts.unwrap_or([1; 3]);
        let [dx, dy, dz] = self.step_m;
        let singles: &[[f64; 3]] = match self.at_m.as_slice() {
            [] => &[[0.0; 3]],
            some => some,
        };
        let mut offsets = Vec::new();
        for &[x, y, z] in singles {
            for i in 0..nx {
                for j in 0..ny {
                    for k in 0..nz {
                        let [i, j, k] = [i, j, k].map(f64::from);
                        offsets.push([x + i * dx, y + j * dy, z + k * dz]);
                    }
                }
            }
        }
        offsets
    }
}

impl BoxShape {
    /// Its two corners, metres.
    pub(super) fn corners(&self) -> Result<[[f64; 3]; 2], InvalidValue> {
        let corners = match (self.size_m, self.from_m, self.to_m) {
            (Some(size), None, None) => [size.map(|edge| -0.5 * edge), size.map(|edge| 0.5 * edge)],
            (None, Some(from), Some(to)) => [from, to],
            _ => {
                let given = [
                    ("size_m", self.size_m.is_some()),
                    ("from_m", self.from_m.is_some()),
                    ("to_m", self.to_m.is_some()),
                ];
                let given: Vec<_> = (given.iter().filter(|(_, is_given)| *is_given))
                    .map(|(name, _)| *name)
                    .collect();
                let expected = "either size_m, or from_m and to_m";
                return Err(invalid("box", expected, given));
            }
        };
        finite("box", corners.as_flattened())?;
        let [from, to] = corners;
        if from.iter().zip(&to).any(|(from, to)| from == to) {
            return Err(invalid("box", "edges longer than 0", corners));
        }
        if let Some(size) = self.size_m
            && size.iter().any(|edge| *edge <= 0.0)
        {
            return Err(invalid("box.size_m", "edges longer than 0", size));
        }
        Ok(corners)
    }
}

impl HeightFieldShape {
    /// The quarry, if that is all there is.
    pub(super) fn made_up(&self) -> Option<&Quarry> {
        let given = self.columns.is_some() || self.spacing_m.is_some() || self.heights_m.is_some();
        self.quarry.as_ref().filter(|_| !given)
    }
}

impl Facade {
    fn check(&self) -> Result<(), InvalidValue> {
        above_0("facade.width_m", self.width_m)?;
        above_0("facade.height_m", self.height_m)?;
        above_0("facade.depth_m", self.depth_m)?;
        above_0("facade.sill_m", self.sill_m)?;
        let [width, height] = self.window_m;
        let room = self.columns <= 1_000
            && self.storeys <= 1_000
            && width > 0.0
            && height > 0.0
            && f64::from(self.columns) * width < self.width_m
            && self.sill_m + f64::from(self.storeys) * height < self.height_m;
        match room {
            true => Ok(()),
            false => Err(invalid("facade", "room for its windows", self)),
        }
    }
}
