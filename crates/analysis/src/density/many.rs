//! Many points in few places, and on one circle: the holes are those of fewer points, and the time
//! does not grow with the square of the points.
//!
//! If every point were tested for every cell near a hole, each of these tests would take minutes.
//! They do not measure times, which depend on the machine's load.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::hole::EVERYWHERE;
use super::{Hole, TOLERANCE_RAD, gaps, holes, largest_hole};

const MANY: u32 = 70_000;

/// Seven places, none opposite to another.
fn places() -> Vec<DVec3> {
    let at = |k: u32| {
        let z = 0.9 - 0.27 * f64::from(k);
        let (sin, cos) = (2.4 * f64::from(k)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z).normalize()
    };
    (0..7).map(at).collect()
}

/// Evenly spaced points on a circle at an angle from z.
fn circle(points: u32, from_z_rad: f64) -> Vec<DVec3> {
    let (r, z) = from_z_rad.sin_cos();
    let at = |k: u32| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(points)).sin_cos();
        DVec3::new(r * cos, r * sin, z)
    };
    (0..points).map(at).collect()
}

/// The largest hole, and all of 0.9 of its size and more.
fn found(points: &[DVec3]) -> (f64, Vec<Hole>) {
    let largest = largest_hole(points, TOLERANCE_RAD).unwrap().unwrap();
    let radius_rad = largest.hole.radius_rad;
    assert!(largest.bound_rad - radius_rad <= 1.01 * TOLERANCE_RAD);
    let all = holes(points, 0.9 * radius_rad, usize::MAX, &EVERYWHERE).unwrap();
    // More than ten points touch it: to a hundredth.
    assert!((all[0].radius_rad - radius_rad).abs() < 1e-2 * radius_rad);
    (radius_rad, all)
}

#[test]
fn seventy_thousand_points_in_seven_places_have_the_holes_of_seven_points() {
    let places = places();
    let (radius_rad, all) = found(&places);
    let many: Vec<DVec3> = places.iter().cycle().copied().take(MANY as usize).collect();
    assert_eq!(found(&many), (radius_rad, all.clone()));
    // Roundings of what is one direction do not make it many.
    let rounded: Vec<DVec3> = (0..MANY)
        .zip(many)
        .map(|(k, p)| (p * (1.0 + f64::from(k))).normalize())
        .collect();
    let (of_rounded_rad, all_of_rounded) = found(&rounded);
    assert!((of_rounded_rad - radius_rad).abs() < 1e-9);
    assert_eq!(all_of_rounded.len(), all.len());
    let gaps = gaps(&rounded, &places).unwrap();
    assert!(gaps.iter().all(|gap| *gap < 1e-8), "{gaps:?}");
}

#[test]
fn seventy_thousand_equal_points_leave_a_hole_at_the_antipode() {
    for place in places() {
        let (radius_rad, all) = found(&vec![place; MANY as usize]);
        assert!((radius_rad - PI).abs() < 3e-8);
        assert_eq!(all.len(), 1);
        assert!(all[0].centre.distance(-place) < 1e-6);
    }
}

#[test]
fn seventy_thousand_points_on_a_circle_leave_holes_at_its_poles() {
    for from_z_rad in [0.4_f64, 1.2, 2.0, 3.1] {
        let (few_rad, few) = found(&circle(500, from_z_rad));
        let (many_rad, many) = found(&circle(MANY, from_z_rad));
        let far_rad = from_z_rad.max(PI - from_z_rad);
        assert!((many_rad - far_rad).abs() < 1e-6 && (few_rad - far_rad).abs() < 1e-6);
        assert_eq!((many.len(), few.len()), (1, 1));
        assert!(many[0].centre.distance(few[0].centre) < 1e-3);
    }
}

#[test]
fn points_on_a_great_circle_leave_holes_at_both_poles() {
    for points in [500, 20_000, MANY] {
        let (radius_rad, all) = found(&circle(points, FRAC_PI_2));
        assert!((radius_rad - FRAC_PI_2).abs() < 1e-6);
        assert_eq!(all.len(), 2, "{all:?}");
        for hole in &all {
            assert!(hole.centre.z.abs() > 1.0 - 1e-5);
        }
    }
}
