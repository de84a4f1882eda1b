//! Known problems of ray casters, against the exact reference.

use super::*;

/// A flat grid of 2 x 40 x 40 triangles about `middle` with irregular coordinates.
fn sheet(middle: DVec3, cell: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut numbers = Numbers(3);
    let mut vertices = Vec::new();
    for at in 0..41 * 41 {
        let (x, y) = (f64::from(at % 41) - 20.0, f64::from(at / 41) - 20.0);
        let off = numbers.vector() * DVec3::new(0.3, 0.3, 0.1);
        vertices.push(middle + (DVec3::new(x, y, 0.0) + off) * cell);
    }
    let mut triangles = Vec::new();
    for at in (0..40).flat_map(|row| (0..40).map(move |column| row * 41 + column)) {
        triangles.extend([[at, at + 1, at + 42], [at, at + 42, at + 41]]);
    }
    (vertices, triangles)
}

#[test]
fn no_ray_passes_through_a_shared_edge_or_vertex() {
    let shape = ball(40, 60, 7.3, 0.3);
    let caster = mesh(&shape);
    let (vertices, triangles) = &shape;
    let mut numbers = Numbers(1);
    let mut rays = Vec::with_capacity(1_000_000);
    for at in 0..1_000_000 {
        let origin = numbers.vector();
        let corners = triangles[numbers.below(triangles.len())];
        let [a, b] = [corners[0], corners[1]].map(|at| vertices[at as usize]);
        // One third each: at a vertex, at the middle of an edge, anywhere on it.
        let target = match at % 3 {
            0 => a,
            1 => 0.5 * (a + b),
            _ => a + (b - a) * (0.5 + 0.5 * numbers.signed()),
        };
        rays.push(ray(origin, (target - origin).normalize()));
    }
    let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
    caster.nearest_of(&rays, 1, Reach::default(), &mut hits);
    assert_eq!(hits.iter().filter(|hit| hit.is_none()).count(), 0);
}

#[test]
fn rays_through_vertices_and_along_edges_agree_with_exact_fractions() {
    // Integers: every edge function is exactly zero.
    let vertices: Vec<DVec3> = (0..25)
        .map(|at| DVec3::new(f64::from(at % 5) - 2.0, f64::from(at / 5) - 2.0, 3.0))
        .collect();
    let cells = (0..4).flat_map(|row| (0..4).map(move |column| row * 5 + column));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|at| [[at, at + 1, at + 6], [at, at + 6, at + 5]])
        .collect();
    let caster = mesh(&(vertices.clone(), triangles.clone()));
    let mut hits = 0;
    for x in -10..=10 {
        for y in -10..=10 {
            let origin = DVec3::new(0.25 * f64::from(x), 0.25 * f64::from(y), 0.0);
            let ray = ray(origin, DVec3::Z);
            let exact = exact::nearest(&ray, &vertices, &triangles);
            assert_eq!(
                first(&caster, &ray).map(|hit| hit.range_m),
                exact,
                "{origin}"
            );
            hits += usize::from(exact.is_some());
        }
    }
    assert_eq!(hits, 17 * 17);
}

#[test]
fn a_surface_at_a_grazing_angle_of_0_02_deg_is_hit() {
    let shape = sheet(DVec3::ZERO, 2.5);
    let caster = mesh(&shape);
    let mut numbers = Numbers(8);
    let graze = 0.02_f64.to_radians();
    let mut met = 0;
    for _ in 0..60 {
        let turn = numbers.signed() * 3.1;
        let along = DVec3::new(
            graze.cos() * turn.cos(),
            graze.cos() * turn.sin(),
            -graze.sin(),
        );
        let target = numbers.vector() * DVec3::new(45.0, 45.0, 0.2);
        let ray = ray(target - along * 90.0, along);
        let exact = exact::nearest(&ray, &shape.0, &shape.1);
        let ours = first(&caster, &ray).map(|hit| hit.range_m);
        assert_eq!(ours.is_some(), exact.is_some(), "{ray:?}");
        if let Some((ours, exact)) = ours.zip(exact) {
            met += 1;
            assert!((ours - exact).abs() < 1e-9, "{ours} {exact}");
        }
    }
    assert!(met > 40, "{met}");
    // A flat floor 1.5 m below, seen at that angle: 4297 m away.
    let floor = Caster::new([Object::new(Plane)]).unwrap();
    let low = ray(DVec3::Z * 1.5, DVec3::new(graze.cos(), 0.0, -graze.sin()));
    let hit = first(&floor, &low).unwrap();
    assert!((hit.range_m - 1.5 / graze.sin()).abs() < 1e-9);
}

#[test]
fn coordinates_of_half_a_million_metres_cost_no_precision() {
    let middle = DVec3::new(500_012.345_6, 5_412_345.678_9, 312.5);
    let shape = sheet(middle, 0.25);
    let caster = mesh(&shape);
    let mut numbers = Numbers(2);
    for _ in 0..100 {
        let origin = middle + numbers.vector() * 3.0 + DVec3::Z * 8.0;
        let target = middle + numbers.vector() * DVec3::new(4.0, 4.0, 0.0);
        let ray = ray(origin, (target - origin).normalize());
        let exact = exact::nearest(&ray, &shape.0, &shape.1).unwrap();
        let ours = first(&caster, &ray).unwrap().range_m;
        // The corners themselves are whole multiples of a nanometre.
        assert!((ours - exact).abs() < 1e-12, "{ours} {exact}");
    }
}

#[test]
fn a_sphere_of_a_metre_is_hit_a_kilometre_away() {
    let mut numbers = Numbers(4);
    let (mut met, mut missed) = (0, 0);
    for _ in 0..300 {
        let centre = numbers.direction() * 1_000.0;
        let sphere = Object::new(Sphere { radius_m: 1.0 }).placed(Placement::at(centre).unwrap());
        let caster = Caster::new([sphere]).unwrap();
        let aim = centre + numbers.vector() * 0.9;
        let ray = ray(numbers.vector(), aim.normalize());
        let exact = exact::sphere(&ray, centre, 1.0);
        let ours = first(&caster, &ray).map(|hit| hit.range_m);
        assert_eq!(ours.is_some(), exact.is_some());
        match ours.zip(exact) {
            None => missed += 1,
            Some((ours, exact)) => {
                met += 1;
                // Rounding of the direction's length alone is 1e-13 of a kilometre; near the rim
                // its square root applies.
                assert!((ours - exact).abs() < 1e-10, "{ours} {exact}");
            }
        }
    }
    assert!(met > 100 && missed > 5, "{met} {missed}");
}

#[test]
fn triangles_without_area_are_ignored() {
    // Whole multiples of a sixteenth: the middle of an edge is exactly on it.
    let a = DVec3::new(0.125, 0.25, 5.0);
    let (b, c) = (DVec3::new(1.25, -0.5, 5.0), DVec3::new(-1.125, -1.75, 5.0));
    let vertices = [a, b, c, 0.5 * (a + b)];
    // A point, degenerate lines, a line in three pieces, and a proper triangle.
    let triangles = [
        [0, 0, 0],
        [0, 1, 0],
        [1, 0, 0],
        [0, 1, 1],
        [0, 1, 3],
        [0, 1, 2],
    ];
    let caster = mesh(&(vertices.to_vec(), triangles.to_vec()));
    let towards = |target: DVec3| ray(DVec3::ZERO, target.normalize());
    for target in [a, b, c, 0.5 * (a + b), (a + b + c) / 3.0] {
        let ray = towards(target);
        if let Some((hit, normal)) = first_with_normal(&caster, &ray) {
            assert_eq!(hit.primitive, 5);
            assert_eq!(normal.abs(), DVec3::Z);
        }
    }
    let inside = towards((a + b + c) / 3.0);
    let exact = exact::nearest(&inside, &vertices, &triangles).unwrap();
    assert!((first(&caster, &inside).unwrap().range_m - exact).abs() < 1e-14);
    let only = mesh(&(vertices.to_vec(), triangles[..4].to_vec()));
    assert_eq!(first(&only, &towards(a)), None);
    assert_eq!(first(&mesh(&(Vec::new(), Vec::new())), &towards(a)), None);
}

#[test]
fn a_ray_that_starts_on_a_surface_does_not_hit_it_there() {
    let shape = ball(8, 8, 2.0, 0.0);
    let caster = mesh(&shape);
    let (vertices, triangles) = &shape;
    for corners in triangles {
        // Vertices are on the surface to the last bit.
        for at in corners {
            let inward = ray(vertices[*at as usize], -vertices[*at as usize].normalize());
            let hit = first(&caster, &inward).unwrap();
            assert!(hit.range_m > 3.0, "{hit:?}");
        }
    }
    let wall = mesh(&(
        vec![
            DVec3::new(-1.0, -1.0, 0.0),
            DVec3::new(3.0, -1.0, 0.0),
            DVec3::new(-1.0, 3.0, 0.0),
        ],
        vec![[0, 1, 2]],
    ));
    let mut numbers = Numbers(6);
    for _ in 0..100 {
        let origin = numbers.vector() * DVec3::new(0.9, 0.9, 0.0);
        assert_eq!(first(&wall, &ray(origin, numbers.direction())), None);
    }
    let solids: [(Surface, DVec3, DVec3, f64); 4] = [
        (
            Sphere { radius_m: 2.0 }.into(),
            DVec3::X * 2.0,
            DVec3::NEG_X,
            4.0,
        ),
        (
            Cuboid::new(DVec3::ZERO, DVec3::ONE).into(),
            DVec3::new(1.0, 0.5, 0.5),
            DVec3::NEG_X,
            1.0,
        ),
        (
            Plane.into(),
            DVec3::new(3.0, 4.0, 0.0),
            DVec3::Z,
            f64::INFINITY,
        ),
        (
            Cylinder {
                radius_m: 1.0,
                bottom_m: 0.0,
                top_m: 2.0,
                capped: true,
            }
            .into(),
            DVec3::Z * 2.0,
            DVec3::NEG_Z,
            2.0,
        ),
    ];
    for (solid, origin, along, expected) in solids {
        let caster = Caster::new([Object::new(solid.clone())]).unwrap();
        let inward = first(&caster, &ray(origin, along)).map_or(f64::INFINITY, |hit| hit.range_m);
        assert_eq!(inward, expected, "{solid:?}");
        assert_eq!(first(&caster, &ray(origin, -along)), None, "{solid:?}");
    }
    // Also where a point of the surface has to be rounded.
    for _ in 0..1_000 {
        let start = ray(numbers.vector(), numbers.direction());
        let hit = first(&caster, &start).unwrap();
        let on = ray(start.at(hit.range_m), start.direction());
        assert_eq!(first(&caster, &on), None);
    }
}

#[test]
fn a_ray_from_inside_a_box_hits_the_wall_ahead() {
    let (low, high) = (DVec3::new(-3.0, -2.0, -1.0), DVec3::new(5.0, 4.0, 2.0));
    let room = Caster::new([Object::new(Cuboid::new(low, high))]).unwrap();
    let faces = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let corner = |at: u32| {
        let pick = |bit: u32, low: f64, high: f64| if at >> bit & 1 == 0 { low } else { high };
        DVec3::new(
            pick(2, low.x, high.x),
            pick(1, low.y, high.y),
            pick(0, low.z, high.z),
        )
    };
    let vertices: Vec<DVec3> = (0..8).map(corner).collect();
    let triangles: Vec<[u32; 3]> = faces
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    let walls = mesh(&(vertices.clone(), triangles.clone()));
    let mut numbers = Numbers(12);
    for at in 0..400 {
        let origin = numbers.vector();
        // Also along the axes and into the corners.
        let along = match at % 4 {
            0 => [
                DVec3::X,
                DVec3::NEG_X,
                DVec3::Y,
                DVec3::NEG_Y,
                DVec3::Z,
                DVec3::NEG_Z,
            ][at / 4 % 6],
            1 => (corner(at as u32 / 4 % 8) - origin).normalize(),
            _ => numbers.direction(),
        };
        let ray = ray(origin, along);
        let exact = exact::nearest(&ray, &vertices, &triangles);
        let (hit, normal) = first_with_normal(&room, &ray).unwrap();
        let wall = first(&walls, &ray).unwrap();
        if let Some(exact) = exact {
            assert!((hit.range_m - exact).abs() < 1e-14 && (wall.range_m - exact).abs() < 1e-14);
        }
        assert!(normal.dot(along) > 0.0);
        if at % 4 > 1 {
            assert_eq!(wall.primitive / 2, hit.primitive);
        }
    }
}

#[test]
fn rays_within_a_plane_or_face_are_handled() {
    let plane = Caster::new([Object::new(Plane)]).unwrap();
    for along in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.6, 0.8, 0.0)] {
        for height in [-1.0, -1e-300, 0.0, 1e-300, 1.0] {
            assert_eq!(first(&plane, &ray(DVec3::Z * height, along)), None);
        }
    }
    let sheet = mesh(&(
        vec![
            DVec3::new(1.0, -1.0, 0.0),
            DVec3::new(3.0, -1.0, 0.0),
            DVec3::new(2.0, 3.0, 0.0),
        ],
        vec![[0, 1, 2]],
    ));
    assert_eq!(first(&sheet, &ray(DVec3::ZERO, DVec3::X)), None);
    // A ray in the plane of a face meets the box where it enters, not that face.
    let crate_ = Caster::new([Object::new(Cuboid::new(DVec3::ZERO, DVec3::ONE))]).unwrap();
    let in_face = ray(DVec3::new(-2.0, 0.5, 1.0), DVec3::X);
    assert_eq!(
        first(&crate_, &in_face).map(|hit| (hit.range_m, hit.primitive)),
        Some((2.0, 0))
    );
    let above = ray(DVec3::new(-2.0, 0.5, 1.0_f64.next_up()), DVec3::X);
    assert_eq!(first(&crate_, &above), None);
}

#[test]
fn numbers_that_are_not_finite_are_rejected() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        for axis in 0..3 {
            let mut off = DVec3::X;
            off[axis] = bad;
            assert!(
                matches!(Ray::new(off, DVec3::Y), Err(RayError::Origin(_))),
                "{bad}"
            );
            assert!(
                matches!(Ray::new(DVec3::ZERO, off), Err(RayError::Direction(_))),
                "{bad}"
            );
            assert!(Placement::at(off).is_err());
            let corners = [DVec3::ZERO, DVec3::X, off];
            assert!(matches!(
                Mesh::new(&corners, &[[0, 1, 2]]),
                Err(MeshError::Vertex { vertex: 2, .. })
            ));
            if !bad.is_nan() {
                let cuboid = Cuboid::new(DVec3::ZERO, off);
                assert!(matches!(
                    Caster::new([Object::new(Plane), Object::new(cuboid)]),
                    Err(CastError::Size { object: 1, .. })
                ));
            }
        }
    }
    assert!(matches!(
        Ray::new(DVec3::ZERO, DVec3::ZERO),
        Err(RayError::Direction(_))
    ));
    assert!(matches!(
        Ray::new(DVec3::ZERO, DVec3::ONE),
        Err(RayError::Direction(_))
    ));
    let message = Ray::new(DVec3::ZERO, DVec3::X * 2.0)
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("expected length 1 within 1e-6, got [2, 0, 0]"),
        "{message}"
    );
    assert_eq!(
        Mesh::new(&[DVec3::ZERO; 3], &[[0, 1, 2], [0, 3, 1]]).unwrap_err(),
        MeshError::Index {
            triangle: 1,
            vertices: 3,
            got: 3
        }
    );
    let sphere = Caster::new([Object::new(Sphere { radius_m: 1.0 })]).unwrap();
    for (above_m, up_to_m) in [(f64::NAN, 9.0), (0.0, f64::NAN), (0.0, -1.0), (5.0, 2.0)] {
        let reach = Reach { above_m, up_to_m };
        let ray = ray(DVec3::X * 3.0, DVec3::NEG_X);
        assert_eq!(sphere.nearest(&ray, reach), None);
    }
    for radius_m in [f64::NAN, f64::INFINITY] {
        assert!(
            Caster::new([Object::new(Sphere { radius_m })]).is_err(),
            "{radius_m}"
        );
    }
}
