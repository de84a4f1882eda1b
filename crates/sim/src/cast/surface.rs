//! Objects: surfaces at their placements.
//!
//! Materials are the scene's.

use std::sync::Arc;

use fearless_simd::Simd;
use glam::DVec3;

use super::bvh::{BoundingBox, Stack};
use super::mesh::Mesh;
use super::packet::{Best, Nearest, ObjectTest, RayLanes, loaded};
use super::placement::Placement;
use super::solids::{Crossings, Cuboid, Cylinder, Plane, Sphere, first_above};
use super::solids8::first_above8;

/// Anything that a ray can meet, in its own frame.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Surface {
    /// The endless plane z = 0.
    Plane,
    /// A sphere about the origin.
    Sphere(Sphere),
    /// A box along the axes.
    Cuboid(Cuboid),
    /// A cylinder about the z axis.
    Cylinder(Cylinder),
    /// Triangles; a height field becomes a mesh ([`super::HeightField::mesh`]). Several objects may
    /// share one.
    Mesh(Arc<Mesh>),
}

macro_rules! surfaces {
    ($($name:ident),*) => {$(
        impl From<$name> for Surface {
            fn from(surface: $name) -> Self {
                Self::$name(surface)
            }
        }
    )*};
}
surfaces!(Sphere, Cuboid, Cylinder);

impl From<Plane> for Surface {
    fn from(_: Plane) -> Self {
        Self::Plane
    }
}

impl From<Mesh> for Surface {
    fn from(mesh: Mesh) -> Self {
        Self::Mesh(Arc::new(mesh))
    }
}

impl From<Arc<Mesh>> for Surface {
    fn from(mesh: Arc<Mesh>) -> Self {
        Self::Mesh(mesh)
    }
}

/// A surface at a place.
#[derive(Clone, Debug)]
pub struct Object {
    /// In its own frame.
    pub surface: Surface,
    /// From its frame to the world's.
    pub placement: Placement,
}

impl Object {
    /// The surface where its own frame is the world's.
    #[must_use]
    pub fn new(surface: impl Into<Surface>) -> Self {
        Self {
            surface: surface.into(),
            placement: Placement::default(),
        }
    }

    /// The same elsewhere.
    #[must_use]
    pub fn placed(mut self, placement: Placement) -> Self {
        self.placement = placement;
        self
    }

    /// Bounds in the object's frame, relative to [`Object::origin_m`]; `None` for infinite
    /// surfaces.
    fn own_bounds(&self) -> Option<BoundingBox> {
        match &self.surface {
            Surface::Plane => None,
            Surface::Sphere(sphere) => Some(sphere.bounds()),
            Surface::Cuboid(cuboid) => Some(cuboid.bounds()),
            Surface::Cylinder(cylinder) => Some(cylinder.bounds()),
            Surface::Mesh(mesh) => Some(mesh.bounds()),
        }
    }

    /// The line through the middle of a finite object along its longest side, in the world, and the
    /// object's greatest distance from it, metres.
    pub(crate) fn middle_line(&self) -> Option<([DVec3; 2], f64)> {
        let bounds = self.own_bounds()?;
        let (low, high) = (DVec3::from(bounds.low), DVec3::from(bounds.high));
        let half = 0.5 * (high - low);
        let along = half.to_array();
        let longest = (0..3).max_by(|a, b| along[*a].total_cmp(&along[*b]))?;
        let mut side = DVec3::ZERO;
        side[longest] = half[longest];
        let middle = 0.5 * (low + high) + self.origin_m();
        let ends = [middle - side, middle + side].map(|end| self.placement.world_point(end));
        (half.is_finite()).then(|| (ends, (half - side).length()))
    }

    /// Box in the world, with room for what the motion rounds off; `None` of what is endless. An
    /// object without extent in its own frame (NaN, ends the wrong way round) gives `Err`.
    pub(super) fn bounds(&self) -> Result<Option<BoundingBox>, BoundingBox> {
        let Some(own) = self.own_bounds() else {
            return Ok(None);
        };
        if matches!(&self.surface, Surface::Mesh(mesh) if mesh.triangles() == 0) {
            return Ok(Some(BoundingBox::EMPTY));
        }
        let sound = (0..3).all(|axis| own.low[axis] <= own.high[axis]);
        if !sound || own.reach() > super::ray::FARTHEST_M {
            return Err(own);
        }
        let origin_m = self.origin_m();
        let corners = (0..8).map(|corner: u32| {
            let [x, y, z] = [0, 1, 2].map(|axis| {
                if corner >> axis & 1 == 0 {
                    own.low[axis]
                } else {
                    own.high[axis]
                }
            });
            let corner = DVec3::new(x, y, z) + origin_m;
            self.placement.world_point(corner).to_array()
        });
        let mut bounds = BoundingBox::of(corners);
        // 2^-40 of the coordinates that went in: thousands of roundings.
        let room = (bounds.reach() + own.reach() + origin_m.abs().max_element()) * 1e-12;
        for axis in 0..3 {
            bounds.low[axis] -= room;
            bounds.high[axis] += room;
        }
        Ok(Some(bounds))
    }

    /// Origin of the surface's coordinates in its frame: meshes have an origin of their own.
    #[inline(always)]
    fn origin_m(&self) -> DVec3 {
        match &self.surface {
            Surface::Mesh(mesh) => mesh.origin_m(),
            _ => DVec3::ZERO,
        }
    }

    /// A ray in the object's frame.
    #[inline(always)]
    fn own_ray(&self, (origin, direction): ([f64; 3], [f64; 3])) -> (DVec3, DVec3) {
        let origin = self.placement.own_point(DVec3::from_array(origin)) - self.origin_m();
        let direction = self.placement.own_direction(DVec3::from_array(direction));
        (origin, direction)
    }

    /// Intersections of a line with a surface that is not a mesh.
    #[inline(always)]
    fn crossings(&self, origin: DVec3, direction: DVec3) -> Crossings {
        match &self.surface {
            Surface::Plane | Surface::Mesh(_) => Plane::crossings(origin, direction),
            Surface::Sphere(sphere) => sphere.crossings(origin, direction),
            Surface::Cuboid(cuboid) => cuboid.crossings(origin, direction),
            Surface::Cylinder(cylinder) => cylinder.crossings(origin, direction),
        }
    }

    /// Offers what one ray hits.
    #[inline(always)]
    pub(super) fn one<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        ray: ([f64; 3], [f64; 3]),
        ask: ObjectTest,
        best: &mut Best,
    ) {
        let (origin, direction) = self.own_ray(ray);
        if let Surface::Mesh(mesh) = &self.surface {
            let own = (origin.to_array(), direction.to_array());
            mesh.one(simd, stack, own, ask, best);
        } else if let Some((range_m, primitive)) =
            first_above(self.crossings(origin, direction), ask.above_m)
        {
            best.offer(range_m, ask.object, primitive);
        }
    }

    /// Offers what these lanes hit.
    #[inline(always)]
    pub(super) fn eight<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        lanes: &RayLanes,
        wanted: u64,
        ask: ObjectTest,
        nearest: &mut Nearest,
    ) {
        let origin = self.placement.own_points(loaded(simd, &lanes.origin));
        let direction = self
            .placement
            .own_directions(loaded(simd, &lanes.direction));
        let met = match &self.surface {
            Surface::Mesh(mesh) => {
                let from = mesh.origin_m();
                let [x, y, z] = origin;
                let own = RayLanes {
                    origin: [x - from.x, y - from.y, z - from.z].map(Into::into),
                    direction: direction.map(Into::into),
                };
                mesh.eight(simd, stack, &own, wanted, ask, nearest);
                return;
            }
            Surface::Plane => Plane::crossings8(simd, origin, direction),
            Surface::Sphere(sphere) => sphere.crossings8(simd, origin, direction),
            Surface::Cuboid(cuboid) => cuboid.crossings8(simd, origin, direction),
            Surface::Cylinder(cylinder) => cylinder.crossings8(simd, origin, direction),
        };
        let (met, primitives) = first_above8(met, ask.above_m);
        nearest.offer8(simd, wanted, met, ask, primitives);
    }

    /// The normal in the world at a point of a primitive.
    pub(super) fn normal(&self, primitive: u32, point: DVec3) -> DVec3 {
        let own = self.placement.own_point(point);
        self.placement.world_direction(match &self.surface {
            Surface::Plane => DVec3::Z,
            Surface::Sphere(_) => Sphere::normal(own),
            Surface::Cuboid(_) => Cuboid::normal(primitive),
            Surface::Cylinder(_) => Cylinder::normal(primitive, own),
            Surface::Mesh(mesh) => mesh.normal(primitive),
        })
    }
}
