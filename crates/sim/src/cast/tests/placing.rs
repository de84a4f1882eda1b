//! Translated and rotated objects.

use super::*;

#[test]
fn rotating_object_and_ray_together_changes_nothing() {
    let mut numbers = Numbers(21);
    let (vertices, triangles) = ball(10, 12, 1.0, 0.3);
    let shape = Arc::new(Mesh::new(&vertices, &triangles).unwrap());
    let surfaces: [Surface; 4] = [
        shape.into(),
        Sphere { radius_m: 0.8 }.into(),
        Cuboid::new(DVec3::splat(-0.5), DVec3::new(0.5, 0.6, 0.7)).into(),
        Cylinder {
            radius_m: 0.5,
            bottom_m: -0.6,
            top_m: 0.9,
            capped: true,
        }
        .into(),
    ];
    let mut met = 0;
    for surface in surfaces {
        let own = Caster::new([Object::new(surface.clone())]).unwrap();
        for _ in 0..300 {
            let (rotation, translation) = (numbers.rotation(), numbers.vector() * 100.0);
            let place = Placement::new(rotation, translation).unwrap();
            let placed = Caster::new([Object::new(surface.clone()).placed(place)]).unwrap();
            let origin = numbers.direction() * 3.0;
            let along = (numbers.vector() * 0.4 - origin).normalize();
            let there = ray(
                rotation * origin + translation,
                (rotation * along).normalize(),
            );
            let a = first_with_normal(&own, &ray(origin, along));
            let b = first_with_normal(&placed, &there);
            if let (Some((a, normal)), Some((b, there))) = (a, b) {
                met += 1;
                assert!((a.range_m - b.range_m).abs() < 1e-11);
                if a.primitive == b.primitive {
                    assert!((rotation * normal - there).length() < 1e-9);
                }
                assert!(normal.dot(along) < 1e-9, "seen from outside");
            } else {
                assert!(a.is_none() && b.is_none());
            }
        }
    }
    assert!(met > 1_000, "{met}");
}

#[test]
fn scaling_and_mirroring_are_rejected() {
    for bad in [
        DMat3::IDENTITY * 2.0,
        DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)),
        DMat3::ZERO,
        DMat3::NAN,
    ] {
        assert!(matches!(
            Placement::new(bad, DVec3::ZERO),
            Err(PlacementError::Rotation(_))
        ));
    }
}

#[test]
fn the_first_object_wins_at_equal_distance() {
    let wall = || Object::new(Cuboid::new(DVec3::X, DVec3::new(2.0, 1.0, 1.0)));
    for copies in [2, 9] {
        let caster = Caster::new((0..copies).map(|_| wall())).unwrap();
        let hit = first(
            &caster,
            &ray(DVec3::splat(0.5) * DVec3::new(0.0, 1.0, 1.0), DVec3::X),
        );
        assert_eq!(hit.unwrap().object.index(), 0);
    }
}

#[test]
fn hits_are_small() {
    assert_eq!(size_of::<Option<Hit>>(), 16);
}
