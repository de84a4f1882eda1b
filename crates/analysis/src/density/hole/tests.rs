use std::f64::consts::{PI, TAU};

use proptest::prelude::*;

use super::*;

/// The nearest point, by the angle itself.
fn free(points: &[DVec3], centre: DVec3) -> f64 {
    let angles = points
        .iter()
        .map(|p| p.cross(centre).length().atan2(p.dot(centre)));
    angles.fold(f64::INFINITY, f64::min)
}

/// Tries the circle through every three points, the circle on every two points as diameter, and the
/// antipode of every point.
fn slow(points: &[DVec3]) -> f64 {
    let mut largest = 0.0_f64;
    let mut attempt = |direction: DVec3| {
        if let Some(centre) = direction.try_normalize() {
            largest = largest.max(free(points, centre)).max(free(points, -centre));
        }
    };
    for (i, &a) in points.iter().enumerate() {
        attempt(a);
        attempt(a.any_orthonormal_vector());
        for (j, &b) in points.iter().enumerate().skip(i + 1) {
            attempt(a + b);
            for &c in &points[j + 1..] {
                attempt((b - a).cross(c - a));
            }
        }
    }
    largest
}

fn at(z: f64, turn: f64) -> DVec3 {
    let r = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(r * turn.cos(), r * turn.sin(), z).normalize()
}

fn largest(points: &[DVec3]) -> LargestHole {
    let largest = largest_hole(points, TOLERANCE_RAD).unwrap().unwrap();
    // The reported hole is correct.
    let hole = largest.hole;
    assert!((free(points, hole.centre) - hole.radius_rad).abs() < 3e-8);
    assert!(hole.radius_rad <= largest.bound_rad);
    assert!(largest.bound_rad - hole.radius_rad <= 1.01 * TOLERANCE_RAD);
    largest
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_largest_hole_agrees_with_trying_all_circles(
        points in prop::collection::vec((-1.0..1.0_f64, 0.0..TAU), 1..25), squeeze in prop_oneof![Just(1.0), Just(0.3), Just(1e-3), Just(0.0)],
    ) {
        // Scaled in z, the points lie near one circle or one point; at 0 on the equator.
        let points: Vec<DVec3> = points.iter().map(|&(z, turn)| at(z * squeeze, turn)).collect();
        let (found, slow) = (largest(&points), slow(&points));
        prop_assert!((found.hole.radius_rad - slow).abs() < 1.01 * TOLERANCE_RAD, "{:?} {slow}", found);
        prop_assert!(found.bound_rad > slow - 3e-8);
    }

    #[test]
    fn clustered_points_leave_a_hole_of_nearly_the_whole_sphere(
        points in prop::collection::vec((-0.1..0.1_f64, 0.0..0.1_f64), 1..12),
    ) {
        let points: Vec<DVec3> = points.iter().map(|&(z, turn)| at(z, turn)).collect();
        let (found, slow) = (largest(&points), slow(&points));
        prop_assert!((found.hole.radius_rad - slow).abs() < 1.01 * TOLERANCE_RAD, "{:?} {slow}", found);
        prop_assert!(slow > 0.9 * PI);
    }
}

#[test]
fn holes_of_zero_one_and_two_points() {
    assert_eq!(largest_hole(&[], 1e-6).unwrap(), None);
    let one = largest(&[DVec3::Z]);
    assert!((one.hole.radius_rad - PI).abs() < 3e-8 && one.hole.centre.z < -0.999_999);
    let same = largest(&[DVec3::Z; 500]);
    assert!((same.hole.radius_rad - PI).abs() < 3e-8);
    let two = largest(&[DVec3::X, DVec3::Y]);
    assert!((two.hole.radius_rad - 0.75 * PI).abs() < 1e-7);
    let antipodes = largest(&[DVec3::X, DVec3::NEG_X]);
    assert!((antipodes.hole.radius_rad - 0.5 * PI).abs() < 1e-7);
}

#[test]
fn holes_of_rings_are_centred_on_the_pole() {
    // More points touch the hole than are tried in triples.
    let ring = |n: u32, z: f64| (0..n).map(move |k| at(z, TAU * f64::from(k) / f64::from(n)));
    let points: Vec<DVec3> = ring(900, 0.5).chain(ring(900, -0.9)).collect();
    let found = largest(&points);
    assert!(
        (found.hole.radius_rad - PI / 3.0).abs() < TOLERANCE_RAD,
        "{found:?}"
    );
    assert!(found.hole.centre.z > 0.999_999);
    let equator: Vec<DVec3> = ring(1_000, 0.0).collect();
    assert!((largest(&equator).hole.radius_rad - 0.5 * PI).abs() < TOLERANCE_RAD);
}

#[test]
fn repeated_points_count_as_one() {
    let corners = [
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::Z,
        DVec3::NEG_Z,
    ];
    let points: Vec<DVec3> = corners.into_iter().flat_map(|c| [c; 300]).collect();
    let found = largest(&points);
    assert!((found.hole.radius_rad - (1.0 / 3.0_f64.sqrt()).acos()).abs() < 1e-7);
}

#[test]
fn removing_a_point_leaves_a_hole_in_its_place() {
    let n = 60_000;
    let turn = PI * (3.0 - 5.0_f64.sqrt());
    let mut points: Vec<DVec3> = (0..n)
        .map(|i| {
            at(
                1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n),
                turn * f64::from(i),
            )
        })
        .collect();
    let before = largest(&points).hole;
    // Six neighbours per point: 0.83 of the spacing sqrt(4 pi / n), and slightly more at the poles.
    assert!(before.radius_rad < 1.1 * (4.0 * PI / f64::from(n)).sqrt());
    let out = points.swap_remove(31_234);
    let after = largest(&points).hole;
    assert!(after.centre.distance(out) < before.radius_rad);
    assert!(after.radius_rad > before.radius_rad);
}

#[test]
fn invalid_directions_are_refused_by_index() {
    let error = largest_hole(&[DVec3::X, DVec3::NAN], 1e-6).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("density: point 1: expected a direction")
    );
}

/// Depth in the belt within this many radians of the equator.
fn belt(half_rad: f64) -> impl Fn(DVec3) -> f64 {
    move |direction| half_rad - direction.z.clamp(-1.0, 1.0).asin().abs()
}

#[test]
fn a_region_counts_only_holes_inside_it() {
    // Along the edge holes may be equally large: a coarser tolerance avoids millions of cells.
    const TOLERANCE: f64 = 1e-4;
    // Rings at 40 and -40 deg and a few points between: the largest holes are the poles, outside
    // the belt.
    let ring = |z: f64| (0..400).map(move |k| at(z, TAU * f64::from(k) / 400.0));
    let (sin, degrees) = (40_f64.to_radians().sin(), 1_f64.to_radians());
    let few = (0..6).map(|k| at(0.0, f64::from(k)));
    let points: Vec<DVec3> = ring(sin).chain(ring(-sin)).chain(few).collect();
    assert!((largest(&points).hole.radius_rad - 50.0 * degrees).abs() < 1e-4);
    let within = |half_rad: f64| {
        let found = largest_hole_within(&points, TOLERANCE, &belt(half_rad))
            .unwrap()
            .unwrap();
        assert!(belt(half_rad)(found.hole.centre) > -TOLERANCE);
        assert!((free(&points, found.hole.centre) - found.hole.radius_rad).abs() < 3e-8);
        assert!(found.bound_rad - found.hole.radius_rad <= 1.01 * TOLERANCE);
        // No centre of a fine grid in the region has a larger hole.
        let lattice = (-30..=30).flat_map(|z| (0..360).map(move |a| (z, a)));
        let most = lattice
            .map(|(z, a)| {
                at(
                    (half_rad * f64::from(z) / 30.0).sin(),
                    f64::from(a) * degrees,
                )
            })
            .map(|place| free(&points, place))
            .fold(0.0, f64::max);
        assert!(most <= found.bound_rad + 1e-12, "{most} {found:?}");
        assert!(found.hole.radius_rad - most < degrees, "{most} {found:?}");
        found.hole.radius_rad
    };
    // The widest gap between two of these points is 73.5 deg, around +-143 deg, up to where the
    // poles are the largest hole.
    assert!(within(2.0 * degrees) < within(20.0 * degrees) + TOLERANCE);
    assert!((within(85.0 * degrees) - 45.0 * degrees).abs() < 0.1 * degrees);
    let nowhere = largest_hole_within(&points, TOLERANCE_RAD, &|_| -2.0).unwrap();
    assert_eq!(nowhere, None);
}
