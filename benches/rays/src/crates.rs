//! The crates that could stand in place of our own tree, as their documentation shows them, one ray
//! at a time: neither casts several.

use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::Bvh;
use glam::Vec3A;
use nalgebra::{Point3, Vector3};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::RayHit;
use obvhs::triangle::Triangle;
use sim::cast::Ray;

use crate::scene::Triangles;
use crate::timed;

/// obvhs: eight children in 80 bytes, triangles by Moller and Trumbore, all f32, slowest and best
/// build.
pub fn obvhs(of: &Triangles, rays: &[Ray]) -> String {
    let corner = |at: u32| of.vertices[at as usize].as_vec3().into();
    let triangles: Vec<Triangle> = of
        .triangles
        .iter()
        .map(|&[a, b, c]| Triangle {
            v0: corner(a),
            v1: corner(b),
            v2: corner(c),
        })
        .collect();
    let tree = build_cwbvh_from_tris(
        &triangles,
        BvhBuildParams::very_slow_build(),
        &mut Default::default(),
    );
    let ordered: Vec<Triangle> = tree
        .primitive_indices
        .iter()
        .map(|&at| triangles[at as usize])
        .collect();
    let rays: Vec<(Vec3A, Vec3A)> = rays
        .iter()
        .map(|ray| (ray.origin_m().as_vec3a(), ray.direction().as_vec3a()))
        .collect();
    let mut ranges = vec![0.0; rays.len()];
    timed(rays.len(), || {
        for ((origin, direction), range) in rays.iter().zip(&mut ranges) {
            let mut hit = RayHit::none();
            let ray = obvhs::ray::Ray::new_inf(*origin, *direction);
            tree.ray_traverse(ray, &mut hit, |ray, at| ordered[at].intersect(ray));
            *range = hit.t;
        }
    })
}

/// A triangle as the crate bvh wants it.
struct Shape {
    corners: [Point3<f64>; 3],
    node: usize,
}

impl Bounded<f64, 3> for Shape {
    fn aabb(&self) -> Aabb<f64, 3> {
        let [a, b, c] = self.corners;
        Aabb::with_bounds(a, a).grow(&b).grow(&c)
    }
}

impl BHShape<f64, 3> for Shape {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

/// bvh: two children, f64 as ours. Its triangle test takes one side only, so that each triangle is
/// asked from both.
pub fn bvh(of: &Triangles, rays: &[Ray]) -> String {
    let corner = |at: u32| Point3::from(of.vertices[at as usize].to_array());
    let mut shapes: Vec<Shape> = of
        .triangles
        .iter()
        .map(|corners| Shape {
            corners: corners.map(corner),
            node: 0,
        })
        .collect();
    let tree = Bvh::build(&mut shapes);
    // A hundredth of the rays: it takes long.
    let rays: Vec<bvh::ray::Ray<f64, 3>> = rays
        .iter()
        .step_by(100)
        .map(|ray| {
            let [origin, along] = [ray.origin_m(), ray.direction()].map(|of| of.to_array());
            bvh::ray::Ray::new(Point3::from(origin), Vector3::from(along))
        })
        .collect();
    let mut ranges = vec![0.0; rays.len()];
    timed(rays.len(), || {
        for (ray, range) in rays.iter().zip(&mut ranges) {
            let mut nearest = f64::INFINITY;
            // Boxes in their order along the ray.
            for shape in tree.nearest_traverse_iterator(ray, &shapes) {
                if ray
                    .intersection_slice_for_aabb(&shape.aabb())
                    .is_some_and(|(enter, _)| enter > nearest)
                {
                    break;
                }
                let [a, b, c] = &shape.corners;
                let there = ray
                    .intersects_triangle(a, b, c)
                    .distance
                    .min(ray.intersects_triangle(a, c, b).distance);
                nearest = nearest.min(there);
            }
            *range = nearest;
        }
    })
}
