//! Bit-identical hits with a tree or all triangles, one ray or eight, any number of threads and any
//! SIMD level.

use fearless_simd::Level;
use proptest::prelude::*;

use super::super::triangle::ShearedRay;
use super::*;

/// Tests every triangle in sequence, without boxes.
fn nearest_by_brute_force(
    ray: &Ray,
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
) -> Option<(f64, u32)> {
    let whole = vertices.iter().copied();
    let (low, high) = whole.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    let middle = (0.5 * (low + high)).as_vec3().as_dvec3();
    let sheared = ShearedRay::new(
        (ray.origin_m() - middle).to_array(),
        ray.direction().to_array(),
    );
    let mut best: Option<(f64, u32)> = None;
    for (corners, id) in triangles.iter().zip(0..) {
        let at = sheared.meet(&corners.map(|at| (vertices[at as usize] - middle).to_array()));
        if at > Reach::ON_SURFACE_M && best.is_none_or(|(had, _)| at < had) {
            best = Some((at, id));
        }
    }
    best
}

fn bits(hit: Option<Hit>) -> Option<(u64, u32)> {
    hit.map(|hit| (hit.range_m.to_bits(), hit.primitive))
}

/// Triangles of every kind: random, slivers, points, duplicates, distant, huge.
fn random_triangles(numbers: &mut Numbers, count: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let offset = [DVec3::ZERO, DVec3::new(5e5, 5.4e6, 120.0)][numbers.below(2)];
    let scale = [1e-3, 1.0, 50.0][numbers.below(3)];
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for _ in 0..count {
        let first = vertices.len() as u32;
        let a = numbers.vector() * 4.0;
        let (b, c) = match numbers.below(6) {
            0 => (a + numbers.vector() * 1e-9, a + numbers.vector()),
            1 => (a, a + numbers.vector()),
            2 => (a + DVec3::X, a + DVec3::Y),
            3 => (a + numbers.vector() * 9.0, a + numbers.vector() * 9.0),
            _ => (a + 0.4 * numbers.vector(), a + 0.4 * numbers.vector()),
        };
        vertices.extend([a, b, c].map(|v| v * scale + offset));
        triangles.push([first, first + 1, first + 2]);
        if numbers.below(8) == 0 {
            triangles.push([first + 1, first + 2, first]);
        }
    }
    (vertices, triangles)
}

/// A ray at a vertex, along an edge, at a centre, or anywhere.
fn aimed_ray(numbers: &mut Numbers, vertices: &[DVec3]) -> Option<Ray> {
    let target = vertices[numbers.below(vertices.len())];
    let other = vertices[numbers.below(vertices.len())];
    let origin = match numbers.below(4) {
        0 => other,
        1 => target + numbers.vector() * 1e3,
        _ => target + numbers.vector() * 10.0,
    };
    let along = match numbers.below(5) {
        0 => [DVec3::X, DVec3::NEG_Y, DVec3::Z][numbers.below(3)],
        1 => numbers.direction(),
        _ => (target - origin).normalize_or_zero(),
    };
    Ray::new(origin, along).ok()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn the_tree_agrees_with_all_triangles_bit_for_bit(seed: u64, count in 1_usize..400) {
        let mut numbers = Numbers(seed);
        let (vertices, triangles) = random_triangles(&mut numbers, count);
        let caster = mesh(&(vertices.clone(), triangles.clone()));
        let rays: Vec<Ray> = (0..64).filter_map(|_| aimed_ray(&mut numbers, &vertices)).collect();
        let mut together = vec![None; rays.len()];
        caster.nearest_of(&rays, 1, Reach::default(), &mut together);
        for (ray, together) in rays.iter().zip(together) {
            let slow = nearest_by_brute_force(ray, &vertices, &triangles).map(|(at, id)| (at.to_bits(), id));
            prop_assert_eq!(bits(first(&caster, ray)), slow);
            prop_assert_eq!(bits(together), slow);
        }
    }

    #[test]
    fn beams_of_rays_agree_with_all_triangles_bit_for_bit(
        seed: u64, step in 1e-5_f64..2e-2, tilted: bool,
    ) {
        let mut numbers = Numbers(seed);
        let (vertices, triangles) = random_triangles(&mut numbers, 200);
        let caster = mesh(&(vertices.clone(), triangles.clone()));
        let turned = if tilted { numbers.rotation() } else { DMat3::IDENTITY };
        let origin = vertices[numbers.below(vertices.len())] + numbers.vector();
        // Along the axes and the diagonals, where lanes of a packet diverge.
        let rays: Vec<Ray> = (0..35 * 4).map(|at| {
            let turn = f64::from(at / 4) * step + f64::from(at % 4) * std::f64::consts::FRAC_PI_4 - 17.0 * step;
            let along = DVec3::new(turn.sin(), turn.cos(), 0.02 * f64::from(at % 4) - 0.04);
            ray(origin + 1e-4 * f64::from(at) * DVec3::Z, (turned * along).normalize())
        }).collect();
        let mut together = vec![None; rays.len()];
        caster.nearest_of(&rays, 4, Reach::default(), &mut together);
        for (ray, together) in rays.iter().zip(together) {
            let slow = nearest_by_brute_force(ray, &vertices, &triangles).map(|(at, id)| (at.to_bits(), id));
            prop_assert_eq!(bits(together), slow);
        }
    }
}

/// Many objects, some shared, some rotated, and planes.
fn scene() -> Caster {
    let mut numbers = Numbers(5);
    let (vertices, triangles) = ball(12, 14, 1.0, 0.2);
    let shared = Arc::new(Mesh::new(&vertices, &triangles).unwrap());
    let mut objects = vec![
        Object::new(Plane).placed(Placement::at(DVec3::NEG_Z * 3.0).unwrap()),
        Object::new(Cuboid::new(DVec3::splat(-60.0), DVec3::splat(60.0))),
    ];
    for at in 0..60 {
        let place = Placement::new(numbers.rotation(), numbers.vector() * 40.0).unwrap();
        let surface: Surface = match at % 4 {
            0 => Sphere { radius_m: 1.5 }.into(),
            1 => Cuboid::new(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)).into(),
            2 => Cylinder {
                radius_m: 0.5,
                bottom_m: -1.0,
                top_m: 2.0,
                capped: at % 8 == 2,
            }
            .into(),
            _ => shared.clone().into(),
        };
        objects.push(Object::new(surface).placed(place));
    }
    Caster::new(objects).unwrap()
}

fn firings(count: usize) -> Vec<Ray> {
    let tilt = DMat3::from_rotation_x(-0.3);
    (0..count * 16)
        .map(|at| {
            let azimuth = (at / 16) as f64 * 0.0035;
            let elevation = ((at % 16) as f64 * 2.0 - 15.0).to_radians();
            let along = DVec3::new(
                elevation.cos() * azimuth.sin(),
                elevation.cos() * azimuth.cos(),
                elevation.sin(),
            );
            ray(tilt * DVec3::new(0.0, 0.2, 0.1), (tilt * along).normalize())
        })
        .collect()
}

#[test]
fn ray_count_and_simd_level_do_not_change_any_bit() {
    let caster = scene();
    let rays = firings(1800);
    let alone: Vec<Option<Hit>> = rays
        .iter()
        .map(|ray| caster.nearest(ray, Reach::default()))
        .collect();
    assert!(alone.iter().all(Option::is_some));
    assert!(alone.iter().flatten().any(|hit| hit.object.index() > 2));
    let mut plain = caster.clone();
    plain.level = Level::baseline();
    for (caster, beams) in [
        (&caster, 16),
        (&caster, 1),
        (&plain, 16),
        (&caster, 0),
        (&caster, usize::MAX),
    ] {
        let mut hits = vec![None; rays.len()];
        caster.nearest_of(&rays, beams, Reach::default(), &mut hits);
        assert!(hits == alone, "{beams}");
    }
    for ray in rays.iter().step_by(37) {
        let hit = plain.nearest(ray, Reach::default());
        assert_eq!(hit, caster.nearest(ray, Reach::default()));
    }
}

/// Rays along faces, edges and axes, from inside and outside, where single rays take another
/// branch.
#[test]
fn solids_give_equal_bits_for_one_ray_and_for_eight() {
    let mut numbers = Numbers(77);
    let (mut met, mut faces) = (0, [false; 6]);
    for round in 0..4_000 {
        let surface: Surface = match round % 5 {
            0 => Plane.into(),
            1 => Sphere { radius_m: 1.0 }.into(),
            2 => Cuboid::new(DVec3::NEG_ONE, DVec3::new(1.0, 2.0, 3.0)).into(),
            _ => Cylinder {
                radius_m: 1.0,
                bottom_m: -1.0,
                top_m: 2.0,
                capped: round % 5 == 3,
            }
            .into(),
        };
        let place = match numbers.below(3) {
            0 => Placement::default(),
            1 => Placement::at(numbers.vector()).unwrap(),
            _ => Placement::new(numbers.rotation(), numbers.vector()).unwrap(),
        };
        // Another object, so that there is a tree with bounds for packets of rays.
        let far = Sphere { radius_m: 1e4 };
        let objects = [Object::new(surface).placed(place), Object::new(far)];
        let caster = Caster::new(objects).unwrap();
        let mut plain = caster.clone();
        plain.level = Level::baseline();
        let corner = |numbers: &mut Numbers| [-3.0, -1.0, 0.0, 1.0, 2.0, 5.0][numbers.below(6)];
        let origin = DVec3::from_array([0; 3].map(|_| corner(&mut numbers)));
        let along = match numbers.below(4) {
            0 => numbers.direction(),
            1 => DVec3::new(numbers.signed(), numbers.signed(), 0.0).normalize(),
            _ => [DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z][numbers.below(4)],
        };
        let world = |own: DVec3| place.world_direction(own);
        let rays: Vec<Ray> = (0..8)
            .map(|_| {
                let off = match numbers.below(3) {
                    0 => DVec3::ZERO,
                    1 => 0.03 * numbers.vector(),
                    _ => 0.03 * numbers.signed() * DVec3::X,
                };
                let from = match numbers.below(2) {
                    0 => DVec3::ZERO,
                    _ => 0.01 * numbers.vector(),
                };
                ray(
                    place.world_point(origin + from),
                    world((along + off).normalize()).normalize(),
                )
            })
            .collect();
        for caster in [&caster, &plain] {
            let mut together = vec![None; rays.len()];
            caster.nearest_of(&rays, 1, Reach::default(), &mut together);
            for (ray, together) in rays.iter().zip(together) {
                let one = first(caster, ray);
                let exactly =
                    |hit: Option<Hit>| hit.map(|hit| (hit.object.index(), bits(Some(hit))));
                assert_eq!(exactly(together), exactly(one), "{round} {ray:?}");
                if let Some(hit) = one.filter(|hit| hit.object.index() == 0) {
                    met += 1;
                    faces[hit.primitive as usize] = true;
                }
            }
        }
    }
    assert!(met > 5_000 && faces == [true; 6], "{met} {faces:?}");
}

#[test]
fn objects_in_a_tree_agree_with_each_object_alone() {
    let caster = scene();
    let alone: Vec<Caster> = caster
        .objects()
        .iter()
        .map(|object| Caster::new([object.clone()]).unwrap())
        .collect();
    let mut numbers = Numbers(11);
    for _ in 0..2_000 {
        let ray = ray(numbers.vector() * 50.0, numbers.direction());
        let mut best: Option<(f64, usize, u32)> = None;
        for (number, one) in alone.iter().enumerate() {
            if let Some(hit) = first(one, &ray)
                && best.is_none_or(|(range, ..)| hit.range_m < range)
            {
                best = Some((hit.range_m, number, hit.primitive));
            }
        }
        let hit = first(&caster, &ray).map(|hit| (hit.range_m, hit.object.index(), hit.primitive));
        assert_eq!(hit, best);
        // A shorter range gives none.
        let range = best.unwrap().0;
        assert!(caster.nearest(&ray, Reach::up_to(range)).is_some());
        let short = Reach::up_to(range.next_down());
        assert_eq!(caster.nearest(&ray, short), None);
    }
}
