//! Calibrations of scans of rooms whose scanner is known.

use std::f64::consts::PI;

use cloud::mount::Mount;
use cloud::{Point, Points};
use units::{Degrees, Stamp};

use super::oracle::Oracle;
use crate::parameters::Layout;
use crate::shots::RangeShot;
use crate::tests::{draws, fixed, values};
use crate::{Calibration, CalibrationRefusal, CalibrationRequest, Scan, calibrate};

pub(crate) const LAYOUT: Layout = Layout {
    lasers: 16,
    logs: 1,
};

/// A normal draw.
fn normal(random: &mut impl FnMut() -> f64) -> f64 {
    let (u, v) = (0.5 + 0.5 * random(), PI * random());
    (-2.0 * u.max(1e-300).ln()).sqrt() * v.cos()
}

/// Parameters of a scanner, as far off as real ones, without drift.
pub(crate) fn truth(random: &mut impl FnMut() -> f64) -> Vec<f64> {
    let mut truth: Vec<f64> = values(&LAYOUT, random)
        .iter()
        .map(|value| 0.5 * value)
        .collect();
    truth[3] += 0.06;
    // Half of 20 mm, 0.1 deg and 5 ms are far for lasers and clocks.
    truth[4] *= 0.1;
    let azimuths = LAYOUT.azimuths();
    let mean = truth[azimuths.clone()].iter().sum::<f64>() / 16.0;
    truth[azimuths]
        .iter_mut()
        .for_each(|azimuth| *azimuth -= mean);
    truth[LAYOUT.drift(0)..].fill(0.0);
    truth
}

/// Distance to a surface from a point in a direction.
pub(crate) type Surfaces = fn([f64; 3], [f64; 3]) -> f64;

/// A room of 9 x 7 x 3 m with a slanted board across a corner.
pub(crate) fn room(from: [f64; 3], to: [f64; 3]) -> f64 {
    let walls = [
        (0, -5.0),
        (0, 4.0),
        (1, -3.0),
        (1, 4.0),
        (2, -1.2),
        (2, 1.8),
    ];
    let mut nearest = f64::INFINITY;
    for (axis, wall) in walls {
        let distance = (wall - from[axis]) / to[axis];
        if distance > 0.0 {
            nearest = nearest.min(distance);
        }
    }
    let board = [0.6, 0.64, 0.48];
    let along = |v: [f64; 3]| board[0] * v[0] + board[1] * v[1] + board[2] * v[2];
    let distance = (3.2 - along(from)) / along(to);
    if distance > 0.0 {
        nearest.min(distance)
    } else {
        nearest
    }
}

/// A floor, and nothing else.
fn floor(from: [f64; 3], to: [f64; 3]) -> f64 {
    let distance = (-1.2 - from[2]) / to[2];
    if distance > 0.0 {
        distance
    } else {
        f64::INFINITY
    }
}

/// A sphere about the scanner.
fn sphere(from: [f64; 3], to: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let half = dot(from, to);
    -half + (half * half - dot(from, from) + 64.0).sqrt()
}

/// Points of sweeps of 0.8 s from 0.8 to -0.8 rad and back, as a log's cloud without mount has
/// them.
pub(crate) fn points(
    truth: &[f64],
    surfaces: Surfaces,
    noise_m: f64,
    sweeps: usize,
    seed: u64,
) -> Points {
    let mut random = draws(seed);
    let oracle = Oracle {
        lasers: fixed(0.0, 0.0).lasers,
        rotation_y: 0.0,
        position_y: 0.0,
    };
    let mut points = Points::new(Scan::FIELDS);
    for sweep in 0..sweeps {
        let back = sweep % 2 == 1;
        for firing in 0..3_600 {
            let since_s = f64::from(firing) * 0.8 / 3_600.0;
            let rate = if back { 2.0 } else { -2.0 };
            let tilt_rad = if back { -0.8 } else { 0.8 } + rate * since_s;
            let azimuth = 2.0 * PI * 10.0 * since_s * 1.37 + f64::from(firing) * 0.003;
            for laser in 0..16 {
                let seconds = 0.9 * sweep as f64 + since_s;
                let (sin, cos) = azimuth.sin_cos();
                let shot = RangeShot {
                    range_m: 0.0,
                    azimuth: [sin, cos],
                    tilt_rad,
                    rate_rad_s: rate,
                    time_s: seconds - 0.5 * (0.9 * (sweeps - 1) as f64 + 0.8),
                    laser,
                    ..RangeShot::default()
                };
                let near = oracle.point(truth, &shot, 0, 0.0);
                let far = oracle.point(truth, &shot, 0, 1.0);
                let direction = [0, 1, 2].map(|i| far[i] - near[i]);
                let table = &oracle.lasers[usize::from(laser)];
                let distance_m = surfaces(near, direction);
                if distance_m > 100.0 {
                    continue;
                }
                let range_m =
                    distance_m - truth[9 + usize::from(laser)] + noise_m * normal(&mut random);
                let (sin_w, cos_w) = table.elevation_deg.to_radians().sin_cos();
                let (x, z) = (
                    range_m * cos_w * sin,
                    range_m * sin_w + table.vertical_offset_m,
                );
                let (sin_g, cos_g) = tilt_rad.sin_cos();
                points.push(Point {
                    position_m: [
                        x * cos_g + z * sin_g,
                        range_m * cos_w * cos,
                        z * cos_g - x * sin_g,
                    ],
                    time: Stamp::from_nanos((seconds * 1e9) as i64),
                    tilt: Degrees(tilt_rad.to_degrees()),
                    laser,
                    ..Point::default()
                });
            }
        }
    }
    points
}

fn of(points: &Points, fix: &[&str]) -> Result<Calibration, CalibrationRefusal> {
    let lasers = fixed(0.0, 0.0).lasers;
    let scans = [Scan::new(points, &lasers).unwrap()];
    let fix: Vec<String> = fix.iter().map(|name| (*name).to_owned()).collect();
    let request = CalibrationRequest {
        scans: &scans,
        lasers: &lasers,
        start: Mount::at([0.0, 0.0, 0.06], [0.0; 3]),
        gear: 120.0,
        fixed: &fix,
    };
    calibrate(&request, &mut |_, _| false)
}

#[test]
fn errors_of_calibrations_are_as_large_as_stated() {
    let (mut squares, mut count) = (0.0, 0.0);
    for seed in 0..3 {
        let truth = truth(&mut draws(100 + seed));
        let made = of(&points(&truth, room, 0.01, 2, seed), &[]).unwrap();
        assert!(
            (made.evidence.chi2 - 1.0).abs() < 0.05,
            "{:?}",
            made.evidence
        );
        let known = made.parameters.iter().zip(&truth).zip(LAYOUT.parameters());
        for ((estimate, truth), parameter) in known {
            let off = (estimate.value * parameter.si_per_unit - truth)
                / (estimate.sd * parameter.si_per_unit);
            assert!(off.abs() < 5.0, "{}: {off}", estimate.name);
            // Of a base that stands the drift is known beforehand.
            if !estimate.name.starts_with("drift") {
                squares += off * off;
                count += 1.0;
            }
        }
        let [before, after] = made.evidence.rms_m;
        assert!(
            before > 0.012 && (after - 0.01).abs() < 0.000_5,
            "{before} {after}"
        );
        let rotation = made.mount().rotation_deg();
        assert_eq!(rotation[1], 0.0);
        assert!((rotation[0] - truth[0].to_degrees()).abs() < 0.05);
    }
    let pooled = f64::sqrt(squares / count);
    assert!((0.6..1.25).contains(&pooled), "{pooled}");
}

#[test]
fn fixed_parameters_stay() {
    let mut truth = truth(&mut draws(7));
    truth[8] = 0.0;
    let made = of(&points(&truth, room, 0.01, 2, 7), &["play", "laser_3"]).unwrap();
    for name in ["play_deg", "laser_3_range_m", "laser_3_azimuth_deg"] {
        let estimate = made.parameter(name).unwrap();
        assert_eq!((estimate.value, estimate.sd), (0.0, 0.0), "{name}");
    }
}

#[test]
fn a_moving_base_is_refused() {
    let mut truth = truth(&mut draws(8));
    truth[LAYOUT.drift(0)] = 0.02;
    let refusal = of(&points(&truth, room, 0.01, 2, 8), &[]).unwrap_err();
    assert!(
        matches!(refusal, CalibrationRefusal::Drift { log: 1, mm_s, .. } if mm_s > 15.0),
        "{refusal}"
    );
}

/// Below what is refused: fixed at 0 it would be a part of delay, scale and position.
#[test]
fn a_slow_drift_is_estimated() {
    let mut truth = truth(&mut draws(8));
    truth[LAYOUT.drift(0)] = 0.000_8;
    let made = of(&points(&truth, room, 0.01, 2, 8), &[]).unwrap();
    let found = made.parameter("drift_1_velocity_x_m_s").unwrap();
    assert!(
        (found.value - 0.000_8).abs() < 4.0 * found.sd && found.sd < 2e-4,
        "{found:?}"
    );
}

/// A drift that the residuals do not show would double the errors of the delay.
#[test]
fn a_base_that_stands_is_known_to_stand() {
    let truth = truth(&mut draws(8));
    let made = of(&points(&truth, room, 0.01, 2, 8), &["play"]).unwrap();
    assert!(made.evidence.bases[0].stands, "{:?}", made.evidence.bases);
    let delay = made.parameter("delay_us").unwrap();
    let moving = made.evidence.bases[0].unseen_m_s;
    assert!(delay.sd < 12.0 && moving < 0.005, "{delay:?} {moving}");
}

/// In one sweep a drift resembles scale and position: it must not pass for a base that stands.
#[test]
fn one_sweep_does_not_show_that_its_base_stands() {
    for drift_m_s in [0.0, 0.003, 0.02] {
        let mut truth = truth(&mut draws(8));
        truth[8] = 0.0;
        truth[LAYOUT.drift(0)] = drift_m_s;
        match of(&points(&truth, room, 0.01, 1, 8), &["play"]) {
            Err(CalibrationRefusal::Drift { .. }) => assert!(drift_m_s > 0.0),
            Ok(made) => {
                let base = made.evidence.bases[0];
                assert!(!base.stands || drift_m_s < base.unseen_m_s, "{base:?}");
                let scale = made.parameter("scale").unwrap();
                let off = (scale.value - truth[5]) / scale.sd;
                assert!(off.abs() < 5.0, "{drift_m_s} {scale:?} {off} {base:?}");
            }
            Err(other) => panic!("{drift_m_s}: {other}"),
        }
    }
}

/// The log whose base moves is named, and the other one is taken to stand.
#[test]
fn of_two_logs_the_one_that_moved_is_refused() {
    let mut truth = truth(&mut draws(8));
    let still = points(&truth, room, 0.01, 2, 8);
    truth[LAYOUT.drift(0) + 1] = 0.01;
    let moved = points(&truth, room, 0.01, 2, 9);
    let lasers = fixed(0.0, 0.0).lasers;
    let scans = [&still, &moved].map(|points| Scan::new(points, &lasers).unwrap());
    let request = CalibrationRequest {
        scans: &scans,
        lasers: &lasers,
        start: Mount::at([0.0, 0.0, 0.06], [0.0; 3]),
        gear: 120.0,
        fixed: &[],
    };
    let refusal = calibrate(&request, &mut |_, _| false).unwrap_err();
    assert!(
        matches!(refusal, CalibrationRefusal::Drift { log: 2, .. }),
        "{refusal}"
    );
}

#[test]
fn a_drift_that_is_fixed_is_not_tested() {
    let truth = truth(&mut draws(8));
    let points = points(&truth, room, 0.01, 2, 8);
    for fix in ["drift_", "drift_1_velocity"] {
        let made = of(&points, &[fix]).unwrap();
        let base = made.evidence.bases[0];
        assert!(base.stands && base.chi2.is_finite(), "{fix}: {base:?}");
        let velocity = made.parameter("drift_1_velocity_y_m_s").unwrap();
        assert_eq!((velocity.value, velocity.sd), (0.0, 0.0), "{fix}");
    }
}

/// A drift along the floor changes nothing that the lidar sees, and refuses nothing.
#[test]
fn a_bare_floor_is_accepted() {
    for (seed, sweeps) in [(0, 1), (1, 1), (2, 2)] {
        let mut truth = truth(&mut draws(20 + seed));
        truth[8] = 0.0;
        let made = of(&points(&truth, floor, 0.01, sweeps, seed), &["play"]);
        let made = made.unwrap_or_else(|refusal| panic!("{seed}: {refusal}"));
        let known = made.parameters.iter().zip(&truth).zip(LAYOUT.parameters());
        let known = known.take(LAYOUT.drift(0));
        for ((estimate, truth), parameter) in known.filter(|((made, _), _)| made.sd > 0.0) {
            let off = (estimate.value * parameter.si_per_unit - truth)
                / (estimate.sd * parameter.si_per_unit);
            assert!(off.abs() < 5.0, "{seed} {}: {off}", estimate.name);
        }
    }
}

/// Every mount sees the same sphere.
#[test]
fn the_centre_of_a_sphere_determines_nothing() {
    let truth = truth(&mut draws(9));
    let made = of(&points(&truth, sphere, 0.01, 2, 9), &[]);
    match made {
        Err(CalibrationRefusal::NotSettled { .. } | CalibrationRefusal::StartsDisagree { .. }) => {}
        other => panic!("{:?}", other.map(|made| made.parameters)),
    }
}

#[test]
fn a_handful_of_points_is_refused() {
    let truth = truth(&mut draws(10));
    let all = points(&truth, room, 0.01, 1, 10);
    let mut few = Points::new(Scan::FIELDS);
    for index in 0..2_000 {
        few.push(all.get(index).unwrap());
    }
    assert!(matches!(
        of(&few, &[]),
        Err(CalibrationRefusal::FewPatches { shots: 2_000, .. })
    ));
    assert!(matches!(
        of(&Points::new(Scan::FIELDS), &[]),
        Err(CalibrationRefusal::FewPatches { .. })
    ));
}

/// Ranges with other noise within an element than between neighbours: surfaces that vibrate.
#[test]
fn surfaces_that_move_are_refused() {
    fn vibrating(from: [f64; 3], to: [f64; 3]) -> f64 {
        let phase = 1e4 * (to[0] + 2.0 * to[1]);
        room(from, to) + 0.02 * (phase / 300.0).sin()
    }
    let truth = truth(&mut draws(12));
    let refusal = of(&points(&truth, vibrating, 0.003, 2, 12), &[]).unwrap_err();
    assert!(
        matches!(
            refusal,
            CalibrationRefusal::Misfit { .. }
                | CalibrationRefusal::NotSettled { .. }
                | CalibrationRefusal::StartsDisagree { .. }
                | CalibrationRefusal::FewPatches { .. }
        ),
        "{refusal}"
    );
}

#[test]
fn the_floor_sets_the_zero_of_the_tilt() {
    fn tilted(from: [f64; 3], to: [f64; 3]) -> f64 {
        let (sin, cos) = 0.02_f64.sin_cos();
        let back = |v: [f64; 3]| [v[0] * cos - v[2] * sin, v[1], v[2] * cos + v[0] * sin];
        room(back(from), back(to))
    }
    let truth = truth(&mut draws(13));
    let points = points(&truth, tilted, 0.005, 2, 13);
    let made = of(&points, &[]).unwrap();
    let scans = [Scan::new(&points, &fixed(0.0, 0.0).lasers).unwrap()];
    let leveled = made.clone().level(&scans).unwrap();
    let turned = leveled.mount().rotation_deg()[1] - made.mount().rotation_deg()[1];
    assert!((turned + 0.02_f64.to_degrees()).abs() < 0.05, "{turned}");
}
