//! Triangle meshes.
//!
//! Vertices are relative to an origin of the mesh whose coordinates are short, so that the
//! subtraction is exact and map coordinates cost no precision.

use fearless_simd::{Simd, prelude::*, u64x8};
use glam::DVec3;
use thiserror::Error;

use super::beam::{Beam, up_to};
use super::build::Quality;
use super::bvh::{BoundingBox, Bvh, MOST_ITEMS, Stack};
use super::packet::{Best, Nearest, ObjectTest, RayLanes, loaded, spread};
use super::ray::FARTHEST_M;
use super::triangle::{Corners, ShearedRay, ShearedRays};

/// With fewer rays than this that go the same way, one by one is faster.
const LEAST_TOGETHER: u32 = 3;

/// Triangles with shared vertices, and the tree over them.
#[derive(Clone, Debug)]
pub struct Mesh {
    origin_m: DVec3,
    vertices: Vec<[f64; 3]>,
    /// In the order of the tree's leaves.
    faces: Vec<Face>,
    /// Index among the faces of each triangle of the list.
    places: Vec<u32>,
    bvh: Bvh,
    bounds: BoundingBox,
}

/// A triangle: its vertices and its number in the list.
#[derive(Clone, Copy, Debug)]
struct Face {
    corners: [u32; 3],
    id: u32,
}

/// An invalid mesh.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum MeshError {
    /// More triangles than a tree holds.
    #[error("mesh: expected at most 2^27 triangles, got {0}")]
    TooMany(usize),
    /// A vertex that is not finite, or too far away.
    #[error("vertex {vertex} of a mesh: expected coordinates within 1e15 m, got {got}")]
    Vertex {
        /// Its number, from 0.
        vertex: usize,
        /// Its coordinates, metres.
        got: DVec3,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} of a mesh: expected vertices below {vertices}, got {got}")]
    Index {
        /// Its number, from 0.
        triangle: usize,
        /// Number of vertices.
        vertices: usize,
        /// The vertex it names.
        got: u32,
    },
}

impl Mesh {
    /// A mesh of these triangles, each three vertex numbers, counterclockwise seen from outside.
    /// Vertices are in metres. Triangles without an area keep their numbers and are never hit.
    ///
    /// # Errors
    /// [`MeshError`] for a vertex that is not finite, an unknown vertex number, or more than 2^27
    /// triangles.
    pub fn new(vertices_m: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        if triangles.len() > MOST_ITEMS {
            return Err(MeshError::TooMany(triangles.len()));
        }
        for (vertex, &got) in vertices_m.iter().enumerate() {
            if got.is_nan() || got.abs().max_element() > FARTHEST_M {
                return Err(MeshError::Vertex { vertex, got });
            }
        }
        let whole = BoundingBox::of(vertices_m.iter().map(DVec3::to_array));
        let origin_m = short_middle(&whole);
        let vertices: Vec<[f64; 3]> = vertices_m
            .iter()
            .map(|vertex| (vertex - origin_m).to_array())
            .collect();
        let mut kept = Vec::with_capacity(triangles.len());
        for ((triangle, &corners), id) in triangles.iter().enumerate().zip(0_u32..) {
            let mut points = [DVec3::ZERO; 3];
            for (&got, point) in corners.iter().zip(&mut points) {
                let Some(&vertex) = vertices.get(got as usize) else {
                    return Err(MeshError::Index {
                        triangle,
                        vertices: vertices.len(),
                        got,
                    });
                };
                *point = DVec3::from_array(vertex);
            }
            // Three points on a line: rounding could let a ray meet them, where there is no normal.
            let [a, b, c] = points;
            if (b - a).cross(c - a) != DVec3::ZERO {
                kept.push(Face { corners, id });
            }
        }
        let mut mesh = Self {
            origin_m,
            vertices,
            faces: kept,
            places: vec![u32::MAX; triangles.len()],
            bvh: Bvh::over(&[], Quality::MESH).0,
            bounds: BoundingBox::EMPTY,
        };
        mesh.arrange(Quality::MESH);
        Ok(mesh)
    }

    /// The same triangles with a tree of this quality, which changes only the time of rays.
    /// [`Mesh::new`] uses [`Quality::MESH`].
    #[must_use]
    pub fn rebuilt(&self, quality: Quality) -> Self {
        let mut mesh = self.clone();
        // As they came, so that the tree does not depend on the one before.
        mesh.faces.sort_unstable_by_key(|face| face.id);
        mesh.arrange(quality);
        mesh
    }

    /// Builds the tree over the faces, which are in order of their numbers, and sorts them in the
    /// order of its leaves.
    fn arrange(&mut self, quality: Quality) {
        let mut boxes = Vec::with_capacity(self.faces.len());
        self.bounds = BoundingBox::EMPTY;
        for face in &self.faces {
            let corners = face.corners.iter();
            let points = corners.filter_map(|&at| self.vertices.get(at as usize).copied());
            let of = BoundingBox::of(points);
            self.bounds.join(&of);
            boxes.push(of);
        }
        let (bvh, order) = Bvh::over(&boxes, quality);
        self.bvh = bvh;
        self.faces = order
            .iter()
            .filter_map(|&at| self.faces.get(at as usize).copied())
            .collect();
        for (face, place) in self.faces.iter().zip(0..) {
            if let Some(of) = self.places.get_mut(face.id as usize) {
                *of = place;
            }
        }
    }

    /// Boxes of eight in the tree.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.bvh.nodes.len()
    }

    /// Number of triangles with an area.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.faces.len()
    }

    /// Origin of the mesh's own coordinates, metres.
    #[inline(always)]
    pub(super) fn origin_m(&self) -> DVec3 {
        self.origin_m
    }

    /// From [`Mesh::origin_m`].
    pub(super) fn bounds(&self) -> BoundingBox {
        self.bounds
    }

    /// The normal of a triangle; zero for one without an area.
    pub(super) fn normal(&self, primitive: u32) -> DVec3 {
        let face = self
            .places
            .get(primitive as usize)
            .and_then(|&place| self.face(place));
        let Some((_, corners)) = face else {
            return DVec3::ZERO;
        };
        let [a, b, c] = corners.map(DVec3::from_array);
        (b - a).cross(c - a).normalize_or_zero()
    }

    #[inline(always)]
    fn face(&self, leaf: u32) -> Option<(u32, Corners)> {
        let face = self.faces.get(leaf as usize)?;
        let [a, b, c] = face.corners;
        Some((
            face.id,
            [
                *self.vertices.get(a as usize)?,
                *self.vertices.get(b as usize)?,
                *self.vertices.get(c as usize)?,
            ],
        ))
    }

    /// Offers what one ray hits.
    #[inline(always)]
    pub(super) fn one<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        (origin, direction): ([f64; 3], [f64; 3]),
        ask: ObjectTest,
        best: &mut Best,
    ) {
        // A function of its own in machine code: it is called from several places.
        simd.vectorize(
            #[inline(always)]
            || self.walk_one(simd, stack, (origin, direction), ask, best),
        );
    }

    #[inline(always)]
    fn walk_one<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        (origin, direction): ([f64; 3], [f64; 3]),
        ask: ObjectTest,
        best: &mut Best,
    ) {
        let ray = ShearedRay::new(origin, direction);
        let beam = Beam::thin(origin, direction, self.bvh.reach_m);
        let far = up_to(best.range_m);
        self.bvh.walk(
            simd,
            stack,
            &beam,
            far,
            #[inline(always)]
            |leaf| {
                if let Some((id, corners)) = self.face(leaf) {
                    let range_m = ray.meet(&corners);
                    if range_m > ask.above_m {
                        best.offer(range_m, ask.object, id);
                    }
                }
                up_to(best.range_m)
            },
        );
    }

    /// Offers what these lanes hit.
    #[inline(always)]
    pub(super) fn eight<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        lanes: &RayLanes,
        mut wanted: u64,
        ask: ObjectTest,
        nearest: &mut Nearest,
    ) {
        while wanted != 0 {
            let (alike, axis) = lanes.alike(simd, wanted);
            wanted &= !alike;
            if alike.count_ones() >= LEAST_TOGETHER {
                simd.vectorize(
                    #[inline(always)]
                    || self.together(simd, stack, lanes, (alike, axis), ask, nearest),
                );
                continue;
            }
            let mut alone = alike;
            while alone != 0 {
                let lane = alone.trailing_zeros() as usize;
                alone &= alone - 1;
                let mut best = nearest.best(lane);
                self.one(simd, stack, lanes.ray(lane), ask, &mut best);
                nearest.put(lane, best);
            }
        }
    }

    /// Lanes that go the same way.
    #[inline(always)]
    fn together<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        lanes: &RayLanes,
        (alike, axis): (u64, usize),
        ask: ObjectTest,
        nearest: &mut Nearest,
    ) {
        let mut lanes = *lanes;
        if alike != ALL {
            lanes.fill(alike);
        }
        let (origin, direction) = (loaded(simd, &lanes.origin), loaded(simd, &lanes.direction));
        let rays = ShearedRays::new(simd, axis, origin, direction);
        let beam = Beam::<true>::about(&spread(origin), &spread(direction), self.bvh.reach_m);
        let mut far = up_to(nearest.farthest(simd, alike));
        self.bvh.walk(
            simd,
            stack,
            &beam,
            far,
            #[inline(always)]
            |leaf| {
                if let Some((id, corners)) = self.face(leaf)
                    && let Some(met) = rays.meet(&corners)
                    && nearest.offer8(simd, alike, met, ask, u64x8::splat(simd, u64::from(id)))
                {
                    far = up_to(nearest.farthest(simd, alike));
                }
                far
            },
        );
    }
}

/// Every lane of a packet.
const ALL: u64 = 0xff;

/// The middle of a box in coordinates of 24 bits; zero for an empty one.
pub(super) fn short_middle(bounds: &BoundingBox) -> DVec3 {
    if bounds.low[0] > bounds.high[0] {
        return DVec3::ZERO;
    }
    let middle = |axis| f64::from((0.5 * bounds.middle2(axis)) as f32);
    DVec3::new(middle(0), middle(1), middle(2))
}
