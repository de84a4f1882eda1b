//! Light from scene file to decoder: range, reflectivity and incidence.

use scanner::TiltSource;

use super::{Simulated, replayed};

/// Simulates a VLP-16 in a scene. Returns each decoded return (position from the sensor, metres,
/// and reflectivity) and the number of shots.
fn seen(scene: &str, duration_s: f64) -> (Vec<([f64; 3], u8)>, u64) {
    let text = format!(
        "[effects]\nall = false\n[motion]\nkind = \"fixed\"\nduration_s = {duration_s}\n{scene}"
    );
    let scene = Simulated::new(&text, |_| {});
    let (_, cloud) = replayed(&scene.log(), TiltSource::None);
    let reported = cloud.intensity().iter().copied();
    let points = cloud.positions().zip(reported).collect();
    (points, scene.report.shots)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// The normal distribution's probability below `x`, by adding up its density.
fn normal_below(x: f64) -> f64 {
    let steps = 20_000;
    let width = (x + 10.0).max(0.0) / f64::from(steps);
    let density = |step: i32| {
        let at = -10.0 + width * (f64::from(step) + 0.5);
        (-0.5 * at * at).exp() / std::f64::consts::TAU.sqrt()
    };
    (0..steps).map(|step| width * density(step)).sum()
}

/// Detection from 1 to 100 m: a target of 10 % is detected half the time at 50 m; light falls with
/// the square of range, and noise is a fifth of the threshold. Detected returns report their
/// reflectivity at any range.
#[test]
fn known_targets_have_the_range_and_reflectivity_of_the_manual() {
    for (range_m, reflectivities) in [
        (0.5, &[100, 255][..]),
        (0.9, &[100, 255]),
        (1.1, &[5, 10, 50, 100, 255]),
        (20.0, &[5, 10, 50, 100, 255]),
        (36.0, &[5, 10]),
        (50.0, &[5, 10, 50, 100]),
        (60.0, &[10, 50]),
        (99.0, &[10, 40, 50, 100, 101, 255]),
        (100.5, &[100, 255]),
        (130.0, &[100, 255]),
    ] {
        for &reflectivity in reflectivities {
            let scene = format!(
                "[materials]\nof = {{ reflectivity = {reflectivity} }}\n[[objects]]\nmaterial = \"of\"\n\
                 sphere = {{ radius_m = {range_m} }}\n[effects.reflectance]\n"
            );
            let (points, shots) = seen(&scene, 0.014);
            let what = format!("{reflectivity} % at {range_m} m");
            let light = f64::from(reflectivity) * 0.1 * (2_500.0 / (range_m * range_m));
            let within = (1.0..=100.0).contains(&range_m);
            let expected = match within {
                true => normal_below(5.0 * (light - 1.0).min(2.0)),
                false => 0.0,
            };
            let share = points.len() as f64 / shots as f64;
            let error = 4.0 * (expected * (1.0 - expected) / shots as f64).sqrt() + 1e-6;
            assert!(
                (share - expected).abs() <= error,
                "{what}: {share}, expected {expected}"
            );
            for (point, reported) in points {
                assert_eq!(reported, reflectivity, "{what}");
                // The lasers are up to 11 mm from the centre.
                assert!((length(point) - range_m).abs() < 0.013, "{what}: {point:?}");
            }
        }
    }
}

/// The caster gives the normal, and the reported value shows the cosine of incidence.
#[test]
fn reflectivity_falls_with_the_cosine_of_incidence() {
    let wall = "[materials]\nwhite = { reflectivity = 90 }\n[[objects]]\nmaterial = \"white\"\nplane = {}\nposition_m = [0, 12, 0]\n\
                rotation_deg = [60, 0, 30]\n";
    // About x by 60 deg, then about z by 30 deg.
    let (sin, cos) = (60_f64.to_radians().sin(), 0.5);
    let normal = [0.5 * sin, -30_f64.to_radians().cos() * sin, cos];
    let (points, _) = seen(&format!("{wall}[effects.reflectance]\n"), 0.1);
    let mut least = u8::MAX;
    for (point, reported) in &points {
        let cosine = dot(*point, normal).abs() / length(*point);
        let off = f64::from(*reported) - 90.0 * cosine;
        assert!(off.abs() < 0.7, "{reported} at a cosine of {cosine}");
        least = least.min(*reported);
    }
    assert!(
        points.len() > 5_000 && least < 30,
        "{} {least}",
        points.len()
    );
    // Without incidence every return is equally bright.
    for extra in ["", "[effects.reflectance]\nincidence = false\n"] {
        let (points, _) = seen(&format!("{wall}{extra}"), 0.02);
        assert!(!points.is_empty() && points.iter().all(|(_, reported)| *reported == 90));
    }
}

/// Asphalt from 1.2 m above: `0.14 sin(e)^3 / 1.2^2` returns at e below level, and 4e-5 is detected
/// half the time: at 4.3 deg.
#[test]
fn ground_at_grazing_incidence_is_not_detected() {
    let ground = "[materials]\nasphalt = { reflectivity = 14 }\n[[objects]]\nmaterial = \"asphalt\"\nplane = {}\nposition_m = [0, 0, -1.2]\n";
    let shares = |effect: &str| {
        let (points, shots) = seen(&format!("{ground}{effect}"), 0.1);
        let each = shots as f64 / 16.0;
        [-15.0, -5.0, -3.0, -1.0].map(|elevation_deg: f64| {
            let of = |point: [f64; 3]| (point[2] / length(point)).asin().to_degrees();
            let there = points
                .iter()
                .filter(|(point, _)| (of(*point) - elevation_deg).abs() < 0.7);
            there.count() as f64 / each
        })
    };
    assert_eq!(shares(""), [1.0; 4]);
    let [steep, five, three, one] = shares("[effects.reflectance]\n");
    assert_eq!((steep, one), (1.0, 0.0));
    assert!(five > 0.98 && three < 0.01, "{five} {three}");
}

/// A window 25 m ahead: it reflects strongly where it faces the sensor and is elsewhere too dark to
/// be detected, 1.2 % of a white wall.
#[test]
fn glass_returns_only_where_it_faces_the_sensor() {
    let window = "[materials]\nglass = { reflectivity = 6, specular = 0.8 }\n[[objects]]\nmaterial = \"glass\"\nplane = {}\n\
                  position_m = [0, 25, 0]\nrotation_deg = [90, 0, 0]\n";
    let from_head_on_deg = |point: [f64; 3]| (point[1] / length(point)).acos().to_degrees();
    let of = |effect: &str| {
        let (points, _) = seen(&format!("{window}{effect}"), 0.1);
        let angles = points
            .into_iter()
            .map(|(point, reported)| (from_head_on_deg(point), reported));
        let (facing, slanting): (Vec<_>, Vec<_>) = angles
            .filter(|(deg, _)| *deg < 2.0 || *deg > 10.0)
            .partition(|(deg, _)| *deg < 2.0);
        (facing, slanting)
    };
    let (facing, slanting) = of("");
    assert!(facing.len() > 10 && slanting.len() > 5_000);
    assert!(
        facing
            .iter()
            .chain(&slanting)
            .all(|(_, reported)| *reported == 6)
    );
    let (bright, left) = of("[effects.reflectance]\n");
    assert_eq!(bright.len(), facing.len());
    assert!(
        bright.iter().all(|(_, reported)| *reported > 100),
        "{bright:?}"
    );
    assert!(left.len() * 200 < slanting.len(), "{}", left.len());
}
