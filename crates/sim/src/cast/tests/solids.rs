//! Solids against their meshes and against manual geometry.

use super::*;

fn alone(surface: impl Into<Surface>) -> Caster {
    Caster::new([Object::new(surface)]).unwrap()
}

/// Range and normal.
fn first_hit(caster: &Caster, origin: [f64; 3], along: [f64; 3]) -> Option<(f64, [f64; 3])> {
    let ray = ray(origin.into(), along.into());
    let (hit, normal) = first_with_normal(caster, &ray)?;
    Some((hit.range_m, normal.to_array()))
}

#[test]
fn spheres_are_hit_from_outside_and_inside() {
    let sphere = alone(Sphere { radius_m: -2.0 });
    assert_eq!(
        first_hit(&sphere, [5.0, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        Some((3.0, [1.0, 0.0, 0.0]))
    );
    assert_eq!(
        first_hit(&sphere, [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        Some((3.0, [-1.0, 0.0, 0.0]))
    );
    assert_eq!(first_hit(&sphere, [5.0, 0.0, 0.0], [1.0, 0.0, 0.0]), None);
    assert_eq!(first_hit(&sphere, [5.0, 2.1, 0.0], [-1.0, 0.0, 0.0]), None);
}

#[test]
fn capped_and_open_cylinders_are_hit_correctly() {
    let shape = Cylinder {
        radius_m: 1.0,
        bottom_m: 0.0,
        top_m: 3.0,
        capped: true,
    };
    let (drum, pipe) = (
        alone(shape),
        alone(Cylinder {
            capped: false,
            ..shape
        }),
    );
    assert_eq!(
        first_hit(&drum, [0.2, 0.0, 5.0], [0.0, 0.0, -1.0]),
        Some((2.0, [0.0, 0.0, 1.0]))
    );
    assert_eq!(first_hit(&pipe, [0.2, 0.0, 5.0], [0.0, 0.0, -1.0]), None);
    assert_eq!(
        first_hit(&drum, [0.2, 0.0, -1.0], [0.0, 0.0, 1.0]),
        Some((1.0, [0.0, 0.0, -1.0]))
    );
    for caster in [&drum, &pipe] {
        assert_eq!(
            first_hit(caster, [4.0, 0.0, 1.0], [-1.0, 0.0, 0.0]),
            Some((3.0, [1.0, 0.0, 0.0]))
        );
        assert_eq!(
            first_hit(caster, [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]),
            Some((1.0, [0.0, -1.0, 0.0]))
        );
        assert_eq!(first_hit(caster, [4.0, 0.0, 3.1], [-1.0, 0.0, 0.0]), None);
    }
    // In through the open end and onto the wall from inside.
    let (range, normal) = first_hit(&pipe, [0.0, 0.0, 4.0], [0.6, 0.0, -0.8]).unwrap();
    assert!((range - 1.0 / 0.6).abs() < 1e-15 && normal == [1.0, 0.0, 0.0]);
    let (range, normal) = first_hit(&drum, [0.0, 0.0, 4.0], [0.6, 0.0, -0.8]).unwrap();
    assert!((range - 1.25).abs() < 1e-15 && normal == [0.0, 0.0, 1.0]);
    let flipped = Cylinder {
        bottom_m: 1.0,
        top_m: 0.0,
        ..shape
    };
    assert!(matches!(
        Caster::new([Object::new(flipped)]),
        Err(CastError::Size { .. })
    ));
}

/// A many-sided prism against the cylinder, for steep and flat rays.
#[test]
fn a_cylinder_is_the_limit_of_its_meshes() {
    let sides = 4_000_u32;
    let mut vertices = vec![];
    for side in 0..sides {
        let (y, x) = (f64::from(side) * std::f64::consts::TAU / f64::from(sides)).sin_cos();
        vertices.extend([DVec3::new(x, y, -1.0), DVec3::new(x, y, 1.0)]);
    }
    let triangles: Vec<[u32; 3]> = (0..sides)
        .flat_map(|side| {
            let (at, next) = (2 * side, 2 * ((side + 1) % sides));
            [[at, next, next + 1], [at, next + 1, at + 1]]
        })
        .collect();
    let faceted = mesh(&(vertices, triangles));
    let round = alone(Cylinder {
        radius_m: 1.0,
        bottom_m: -1.0,
        top_m: 1.0,
        capped: false,
    });
    let mut numbers = Numbers(9);
    let mut compared = 0;
    for _ in 0..3_000 {
        let ray = ray(numbers.vector() * 3.0, numbers.direction());
        let ranges = first(&faceted, &ray).zip(first(&round, &ray));
        if let Some((faceted, round)) = ranges {
            // Facets are 3e-7 m off the circle; grazing rays amplify that.
            let apart = (faceted.range_m - round.range_m).abs();
            let through = round.range_m - ray.direction().dot(-ray.origin_m());
            if through.abs() > 0.1 && apart < 0.5 {
                compared += 1;
                assert!(apart < 1e-4, "{apart} {ray:?}");
            }
        }
    }
    assert!(compared > 150, "{compared}");
}

#[test]
fn height_fields_are_hit_on_their_planes() {
    // z = 0.5 x - 0.25 y over 30 x 20 m: one plane, many triangles.
    let (columns, rows, spacing_m) = (61, 41, [0.5, 0.5]);
    let height = |x: f64, y: f64| 0.5 * x - 0.25 * y;
    let heights = (0..columns * rows)
        .map(|at| height((at % columns) as f64 * 0.5, (at / columns) as f64 * 0.5))
        .collect();
    let field = HeightField::new(columns, heights, spacing_m).unwrap();
    let caster = alone(field.mesh().unwrap());
    let mut numbers = Numbers(10);
    for _ in 0..500 {
        let (x, y) = (
            15.0 + 14.9 * numbers.signed(),
            10.0 + 9.9 * numbers.signed(),
        );
        let down = ray(DVec3::new(x, y, 40.0), DVec3::NEG_Z);
        let (hit, normal) = first_with_normal(&caster, &down).unwrap();
        assert!((hit.range_m - (40.0 - height(x, y))).abs() < 1e-12);
        assert!((normal - DVec3::new(-0.5, 0.25, 1.0).normalize()).length() < 1e-12);
        let cell = (y / 0.5).floor() as u32 * 60 + (x / 0.5).floor() as u32;
        assert_eq!(hit.primitive / 2, cell);
    }
    let outside = ray(DVec3::new(-0.1, 1.0, 40.0), DVec3::NEG_Z);
    assert_eq!(first(&caster, &outside), None);
    assert!(matches!(
        HeightField::new(3, vec![0.0; 7], spacing_m),
        Err(HeightFieldError::Shape {
            columns: 3,
            rows: 2,
            got: 7
        })
    ));
    assert!(HeightField::new(0, Vec::new(), spacing_m).is_err());
    assert!(HeightField::new(2, vec![0.0; 4], [0.0, 1.0]).is_err());
    let hole = HeightField::new(2, vec![0.0, 0.0, f64::NAN, 0.0], spacing_m).unwrap();
    assert!(matches!(
        hole.mesh(),
        Err(HeightFieldError::Mesh(MeshError::Vertex { vertex: 2, .. }))
    ));
}
