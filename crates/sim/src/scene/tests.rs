//! Casting against an independent slow reference: marching along the ray by signed distance, then
//! bisection.

use std::collections::BTreeSet;

use glam::{DMat3, DVec3, Vec3Swizzles, dvec2, dvec3};
use proptest::prelude::*;

use super::*;
use crate::cast::{Cuboid, Cylinder, Placement, Plane, Sphere};
use crate::sensor::{LidarMount, LidarSensor};

const FAR: f64 = 1e12;

/// An object described twice: to the caster, and as the signed distance to its surface.
struct Twice {
    object: Object,
    distance: Box<dyn Fn(DVec3) -> f64>,
}

fn scene(objects: impl IntoIterator<Item = (Object, u8)>) -> Scene {
    let with = |scene: Scene, (object, reflectivity)| scene.with(object, reflectivity).unwrap();
    objects.into_iter().fold(Scene::new(), with)
}

fn between(corner: DVec3, opposite: DVec3) -> Object {
    Object::new(Cuboid::new(corner, opposite))
}

fn plane_through(point: DVec3, normal: DVec3) -> Object {
    let x = normal.any_orthonormal_vector();
    let rotation = DMat3::from_cols(x, normal.cross(x), normal);
    Object::new(Plane).placed(Placement::new(rotation, point).unwrap())
}

fn drum(base: DVec3, radius_m: f64, height_m: f64) -> Object {
    let shape = Cylinder {
        radius_m,
        bottom_m: 0.0,
        top_m: height_m,
        capped: true,
    };
    Object::new(shape).placed(Placement::at(base).unwrap())
}

fn ball(centre: DVec3, radius_m: f64) -> Object {
    Object::new(Sphere { radius_m }).placed(Placement::at(centre).unwrap())
}

fn box_distance(p: DVec3, half: DVec3) -> f64 {
    let q = p.abs() - half;
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

fn cuboid(low: DVec3, size: DVec3) -> Twice {
    Twice {
        object: between(low + size, low),
        distance: Box::new(move |p| box_distance(p - (low + 0.5 * size), 0.5 * size)),
    }
}

fn turned(centre: DVec3, size: DVec3, axis: DVec3, angle: f64) -> Twice {
    let attitude = DMat3::from_axis_angle(axis, angle);
    Twice {
        object: between(-0.5 * size, 0.5 * size).placed(Placement::new(attitude, centre).unwrap()),
        // Inverse rotation: coordinates along the columns.
        distance: Box::new(move |p| {
            let p = p - centre;
            let own = dvec3(
                p.dot(attitude.x_axis),
                p.dot(attitude.y_axis),
                p.dot(attitude.z_axis),
            );
            box_distance(own, 0.5 * size)
        }),
    }
}

fn plane(point: DVec3, normal: DVec3) -> Twice {
    Twice {
        object: plane_through(point, normal),
        distance: Box::new(move |p| (p - point).dot(normal)),
    }
}

fn cylinder(base: DVec3, radius: f64, height: f64) -> Twice {
    Twice {
        object: drum(base, radius, height),
        distance: Box::new(move |p| {
            let round = p.xy().distance(base.xy()) - radius;
            let flat = (p.z - (base.z + 0.5 * height)).abs() - 0.5 * height;
            dvec2(round.max(0.0), flat.max(0.0)).length() + round.max(flat).min(0.0)
        }),
    }
}

fn sphere(centre: DVec3, radius: f64) -> Twice {
    Twice {
        object: ball(centre, radius),
        distance: Box::new(move |p| p.distance(centre) - radius),
    }
}

/// The distance within 100 m at which some primitive is first entered or left.
fn reference(scene: &[Twice], origin: DVec3, direction: DVec3) -> Option<f64> {
    let inside = |t: f64| -> Vec<bool> {
        let p = origin + t * direction;
        scene.iter().map(|s| (s.distance)(p) < 0.0).collect()
    };
    let at_start = inside(0.0);
    let mut t = 0.0;
    while t < 100.0 {
        let p = origin + t * direction;
        let clear = scene
            .iter()
            .map(|s| (s.distance)(p).abs())
            .fold(f64::INFINITY, f64::min);
        let next = t + clear.max(1e-4);
        if inside(next) != at_start {
            let (mut before, mut after) = (t, next);
            for _ in 0..60 {
                let middle = 0.5 * (before + after);
                if inside(middle) == at_start {
                    before = middle;
                } else {
                    after = middle;
                }
            }
            return Some(after);
        }
        t = next;
    }
    None
}

fn point(extent: f64) -> impl Strategy<Value = DVec3> {
    let side = || -extent..extent;
    (side(), side(), side()).prop_map(|(x, y, z)| dvec3(x, y, z))
}

fn unit() -> impl Strategy<Value = DVec3> {
    point(1.0)
        .prop_filter("long enough to have a direction", |v| v.length() > 0.1)
        .prop_map(DVec3::normalize)
}

fn size() -> impl Strategy<Value = DVec3> {
    (0.1..8.0, 0.1..8.0, 0.1..8.0).prop_map(|(x, y, z)| dvec3(x, y, z))
}

fn any_shape() -> impl Strategy<Value = (u8, DVec3, DVec3, DVec3, f64)> {
    (0..5_u8, point(15.0), size(), unit(), -3.0..3.0)
}

fn build((kind, at, size, axis, angle): (u8, DVec3, DVec3, DVec3, f64)) -> Twice {
    match kind {
        0 => cuboid(at, size),
        1 => turned(at, size, axis, angle),
        2 => plane(at, axis),
        3 => cylinder(at, size.x, size.y),
        _ => sphere(at, size.z),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn casting_agrees_with_marching(
        shapes in prop::collection::vec(any_shape(), 1..6), origin in point(12.0), direction in unit(),
    ) {
        let twice: Vec<Twice> = shapes.into_iter().map(build).collect();
        let hit = scene(twice.iter().map(|twice| (twice.object.clone(), 5))).cast(origin, direction, 0.0, 99.0);
        let expected = reference(&twice, origin, direction).filter(|&t| t <= 99.0);
        match (hit, expected) {
            // Where the ray nearly touches, rounding along the ray is much larger than that of the
            // distance.
            (Some(hit), Some(t)) => prop_assert!((hit.range_m - t).abs() < 1e-9, "{} {t}", hit.range_m),
            (None, None) => {}
            // The march steps over chords shorter than 0.1 mm.
            (Some(hit), None) => {
                let deeper = origin + (hit.range_m + 2e-4) * direction;
                let p = origin + hit.range_m * direction;
                let grazes = twice.iter().any(|s| (s.distance)(p).abs() < 1e-9 && (s.distance)(deeper) > 0.0);
                prop_assert!(grazes, "cast found {hit:?}");
            }
            (None, Some(t)) => prop_assert!(false, "march found {t}"),
        }
    }
}

#[test]
fn the_nearest_surface_wins_with_its_reflectivity() {
    let scene = scene([
        (ball(dvec3(10.0, 0.0, 0.0), 1.0), 10),
        (plane_through(dvec3(5.0, 0.0, 0.0), DVec3::X), 20),
        (drum(dvec3(20.0, 0.0, -1.0), 1.0, 2.0), 30),
    ]);
    let hit = scene.cast(DVec3::ZERO, DVec3::X, 1.0, 100.0);
    assert_eq!(
        hit,
        Some(SceneHit {
            range_m: 5.0,
            reflectivity: 20
        })
    );
    assert_eq!(scene.caster().objects().len(), 3);
}

#[test]
fn each_face_of_a_box_has_its_own_reflectivity_from_both_sides() {
    let mut placed = scene([(between(DVec3::splat(-2.0), DVec3::splat(2.0)), 0)]).placed;
    placed.materials = (1..=6)
        .map(|reflectivity| Material {
            reflectivity,
            ..Material::plain()
        })
        .collect();
    placed.assignments = vec![MaterialAssignment::Faces([0, 1, 2, 3, 4, 5])];
    let scene = Scene::of(placed).unwrap();
    let axes = [
        -DVec3::X,
        DVec3::X,
        -DVec3::Y,
        DVec3::Y,
        -DVec3::Z,
        DVec3::Z,
    ];
    for (axis, face) in axes.into_iter().zip(1..) {
        let inside = scene.cast(DVec3::ZERO, axis, 0.0, FAR).unwrap();
        assert_eq!((inside.range_m, inside.reflectivity), (2.0, face));
        let outside = scene.cast(5.0 * axis, -axis, 0.0, FAR).unwrap();
        assert_eq!((outside.range_m, outside.reflectivity), (3.0, face));
    }
}

#[test]
fn range_limits_are_closed_and_near_surfaces_block() {
    let mut scene = scene([1.0, 50.0].map(|x| (plane_through(dvec3(x, 0.0, 0.0), DVec3::X), 0)));
    let from = |scene: &Scene, x, min, max| {
        scene
            .cast(dvec3(x, 0.0, 0.0), DVec3::X, min, max)
            .map(|hit| hit.range_m)
    };
    assert_eq!(from(&scene, 0.0, 1.0, 100.0), Some(1.0));
    assert_eq!(from(&scene, 0.0, 1.001, 100.0), None);
    assert_eq!(from(&scene, 2.0, 1.0, 48.0), Some(48.0));
    assert_eq!(from(&scene, 2.0, 1.0, 47.999), None);
    assert_eq!(from(&scene, 51.0, 0.0, FAR), None);
    // An absorbing surface blocks as well.
    scene.placed.materials[0].absorbing = true;
    assert_eq!(from(&scene, 0.0, 0.0, 100.0), None);
    assert_eq!(from(&scene, 2.0, 0.0, 100.0), Some(48.0));
}

#[test]
fn rays_along_and_from_a_face_are_handled() {
    let unit = scene([(between(DVec3::ZERO, DVec3::ONE), 0)]);
    let cast = |origin, direction| {
        unit.cast(origin, direction, 0.0, FAR)
            .map(|hit| hit.range_m)
    };
    // Along a face, along an edge, along a face from within it, and just past it.
    assert_eq!(cast(dvec3(-1.0, 0.5, 1.0), DVec3::X), Some(1.0));
    assert_eq!(cast(dvec3(-1.0, 0.0, 1.0), DVec3::X), Some(1.0));
    assert_eq!(cast(dvec3(0.5, 0.5, 1.0), DVec3::X), Some(0.5));
    assert_eq!(cast(dvec3(-1.0, 0.5, 1.0 + 1e-15), DVec3::X), None);
    // Across an edge and touching nothing else of the box.
    let diagonal = dvec3(1.0, 1.0, 0.0).normalize();
    assert!((cast(dvec3(-1.0, 0.0, 0.5), diagonal).unwrap() - 2_f64.sqrt()).abs() < 1e-15);
    assert_eq!(cast(dvec3(-1.0, 1e-15, 0.5), diagonal), None);
    // From a face: outwards hits nothing, inwards hits the opposite face.
    assert_eq!(cast(dvec3(0.5, 0.5, 1.0), DVec3::Z), None);
    assert_eq!(cast(dvec3(0.5, 0.5, 1.0), -DVec3::Z), Some(1.0));
    let plane = scene([(plane_through(DVec3::ZERO, DVec3::Z), 0)]);
    assert_eq!(plane.cast(DVec3::Z, DVec3::X, 0.0, FAR), None);
    assert_eq!(plane.cast(DVec3::ZERO, DVec3::Z, 0.0, FAR), None);
}

#[test]
fn cylinders_are_hit_from_above_below_and_inside() {
    let scene = scene([(drum(dvec3(1.0, 2.0, -1.0), 0.5, 4.0), 7)]);
    let cast = |origin, direction| {
        scene
            .cast(origin, direction, 0.0, FAR)
            .map(|hit| hit.range_m)
    };
    assert_eq!(cast(dvec3(1.2, 2.2, 10.0), -DVec3::Z), Some(7.0));
    assert_eq!(cast(dvec3(1.2, 2.2, -10.0), DVec3::Z), Some(9.0));
    assert_eq!(cast(dvec3(1.2, 2.2, 0.0), DVec3::Z), Some(3.0));
    assert_eq!(cast(dvec3(1.0, 2.6, 10.0), -DVec3::Z), None);
    assert_eq!(cast(dvec3(1.0, 2.0, 0.0), DVec3::X), Some(0.5));
    assert_eq!(cast(dvec3(-1.0, 2.0, 0.0), DVec3::X), Some(1.5));
    assert_eq!(cast(dvec3(-1.0, 2.0, 3.5), DVec3::X), None);
}

#[test]
fn non_finite_rays_hit_nothing() {
    let scene = scene([
        (between(DVec3::splat(-5.0), DVec3::splat(5.0)), 0),
        (plane_through(dvec3(0.0, 0.0, -1.0), DVec3::Z), 0),
    ]);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut v = dvec3(0.0, 0.6, -0.8);
            v[axis] = bad;
            assert_eq!(scene.cast(DVec3::ZERO, v, 0.0, FAR), None);
            assert_eq!(scene.cast(v, DVec3::X, 0.0, FAR), None);
        }
    }
    assert_eq!(scene.cast(DVec3::ZERO, DVec3::ZERO, 0.0, FAR), None);
    assert_eq!(Scene::new().cast(DVec3::ZERO, DVec3::X, 0.0, FAR), None);
}

/// Low-discrepancy numbers in 0..1: many different rays without random numbers.
fn spread(i: u32) -> DVec3 {
    let i = f64::from(i);
    dvec3(
        (i * 0.819_172_513_396_164_4).fract(),
        (i * 0.671_043_606_703_789_2).fract(),
        (i * 0.549_700_477_901_970_8).fract(),
    )
}

/// Points exactly on the edges (one coordinate free) or corners of the box `low..high`.
fn on_edges(low: DVec3, high: DVec3, i: u32) -> DVec3 {
    let pick = |bit: u32, axis: usize| {
        if i >> bit & 1 == 0 {
            low[axis]
        } else {
            high[axis]
        }
    };
    let mut p = dvec3(pick(0, 0), pick(1, 1), pick(2, 2));
    let free = (i >> 3) as usize % 4;
    if free < 3 {
        p[free] = low[free] + (high[free] - low[free]) * spread(i).x;
    }
    p
}

#[test]
fn a_closed_room_returns_every_ray_aimed_at_its_edges_and_corners() {
    let (low, high) = (dvec3(-15.4, -10.3, -1.2), dvec3(14.6, 9.7, 4.8));
    let scene = scene([(between(low, high), 0)]);
    for i in 0..400_000 {
        let origin = low + (high - low) * (0.001 + 0.998 * spread(i + 1));
        let target = on_edges(low, high, i);
        let length = origin.distance(target);
        let hit = scene.cast(origin, (target - origin) / length, 0.0, FAR);
        let range = hit.map(|hit| hit.range_m).unwrap();
        // The direction is rounded: near the target the ray may be some 1e-15 m off, and more at a
        // grazing angle.
        assert!((range - length).abs() < 1e-11, "{origin} {target} {range}");
    }
}

#[test]
fn stacked_boxes_have_no_cracks() {
    // 4 x 4 adjacent boxes with coordinates without a finite binary representation: every ray at
    // their joints from the front hits one.
    let edge = |i: u32| 0.1 + 0.7 * f64::from(i);
    let places = (0..4).flat_map(|i| (0..4).map(move |j| (i, j)));
    let boxes = places.map(|(i, j)| {
        let low = dvec3(edge(i), 3.3, edge(j));
        between(low, dvec3(edge(i + 1), 4.1, edge(j + 1)))
    });
    let scene = scene(boxes.map(|object| (object, 0)));
    for i in 0..200_000 {
        let s = spread(i + 1);
        let origin = dvec3(9.0 * s.x - 4.0, 3.0 * s.y - 1.0, 9.0 * s.z - 4.0);
        let along = edge(0) + (edge(4) - edge(0)) * spread(i + 77).y * 0.999;
        let crossing = edge(1 + i % 3);
        let (x, z) = match i % 5 {
            0 | 1 => (crossing, along.max(edge(0) + 0.01)),
            2 | 3 => (along.max(edge(0) + 0.01), crossing),
            _ => (crossing, edge(1 + i / 5 % 3)),
        };
        let to = dvec3(x, 3.3, z) - origin;
        let hit = scene.cast(origin, to.normalize(), 0.0, FAR).unwrap();
        assert!((hit.range_m - to.length()).abs() < 1e-9, "{origin} {to}");
    }
}

#[test]
fn a_floor_at_a_grazing_angle_of_0_02_deg_is_hit() {
    let (sin, cos) = 0.02_f64.to_radians().sin_cos();
    let floor = scene([(plane_through(dvec3(0.0, 0.0, -0.03), DVec3::Z), 0)]);
    let room = between(dvec3(-500.0, -500.0, -0.03), dvec3(500.0, 500.0, 5.0));
    let room = scene([(room, 0)]);
    for scene in [floor, room] {
        let hit = scene
            .cast(DVec3::ZERO, dvec3(0.0, cos, -sin), 1.0, 100.0)
            .unwrap();
        assert!((hit.range_m - 0.03 / sin).abs() < 1e-11, "{hit:?}");
    }
}

#[test]
fn a_sphere_of_one_metre_is_hit_at_a_kilometre() {
    for i in 0..1_000 {
        let miss = 0.99 * f64::from(i) / 1_000.0;
        // Rotated out of the axes, so that no errors cancel by chance.
        let turn = DMat3::from_axis_angle(dvec3(0.6, 0.0, 0.8), 0.3 + f64::from(i));
        let scene = scene([(ball(turn * dvec3(1_000.0, miss, 0.0), 1.0), 0)]);
        let hit = scene.cast(DVec3::ZERO, turn * DVec3::X, 0.0, FAR).unwrap();
        let exact = 1_000.0 - (1.0 - miss * miss).sqrt();
        assert!(
            (hit.range_m - exact).abs() < 5e-12,
            "{miss}: {hit:?} {exact}"
        );
    }
    let past = scene([(ball(dvec3(1_000.0, 1.000_001, 0.0), 1.0), 0)]);
    assert_eq!(past.cast(DVec3::ZERO, DVec3::X, 0.0, FAR), None);
}

#[test]
fn every_firing_in_the_hall_returns_within_20_m_at_every_tilt() {
    let (scene, sensor, mount) = (Scene::hall(), LidarSensor::vlp16(), LidarMount::above(0.06));
    let mut seen = BTreeSet::new();
    for tilt in (-90..=0).map(|half| f64::from(half) / 2.0) {
        for azimuth in (0..1_800).map(|i| f64::from(i) / 5.0) {
            for laser in 0..16 {
                let (origin, direction) = sensor.ray(laser, azimuth, tilt, &mount).unwrap();
                let hit = scene.cast(origin, direction, 1.0, 100.0).unwrap();
                assert!((1.2..20.0).contains(&hit.range_m), "{hit:?}");
                seen.insert(hit.reflectivity);
            }
        }
    }
    // Floor, both kinds of wall, ceiling, pillars, cardboard, wood, steel and the sign are all
    // hit.
    assert_eq!(
        seen.into_iter().collect::<Vec<_>>(),
        [12, 22, 28, 33, 35, 40, 45, 62, 210]
    );
}

#[test]
fn the_floor_is_one_tripod_height_below_the_axis() {
    let down = Scene::hall()
        .cast(DVec3::ZERO, -DVec3::Z, 0.0, 100.0)
        .unwrap();
    assert_eq!((down.range_m, down.reflectivity), (1.2, 28));
}
