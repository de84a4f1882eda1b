use cloud::mount::Mount;

use super::*;
use crate::tests::scans::{LAYOUT, Surfaces, points, room, truth};
use crate::tests::{draws, fixed};

/// A scan by a scanner with parameters `truth`.
fn scan(truth: &[f64], surfaces: Surfaces, seed: u64) -> Scan {
    let points = points(truth, surfaces, 0.01, 2, seed);
    Scan::new(&points, &fixed(0.0, 0.0).lasers).unwrap()
}

/// Studies scans by the values of parameters, SI.
fn by(values: &[f64], scans: &[Scan], truth: &[Vec<PointError>]) -> AccuracyStudy {
    let parameters = LAYOUT.parameters();
    let named = parameters.iter().zip(values);
    let corrections: Vec<(String, f64)> = named
        .map(|(p, value)| (p.name.clone(), value / p.si_per_unit))
        .collect();
    // Only the position is uncertain, by 2 mm and 1 mm.
    let names = ["mount_position_x_m", "mount_position_z_m"].map(str::to_owned);
    let request = StudyRequest {
        scans,
        lasers: &fixed(0.0, 0.0).lasers,
        mount: Mount::at(
            [values[2], 0.0, values[3]],
            [values[0].to_degrees(), 0.0, values[1].to_degrees()],
        ),
        gear: 120.0,
        corrections: &corrections,
        covariance: Some(KnownCovariance {
            names: &names,
            covariance: &[4e-6, 0.0, 0.0, 1e-6],
        }),
        angles: AngleErrors {
            tilt_sd_rad: 1e-4,
            clock_sd_s: 0.0,
        },
        truth,
    };
    study(&request).unwrap()
}

#[test]
fn residuals_are_as_large_as_noise_in_every_bin() {
    let truth = truth(&mut draws(30));
    let scan = scan(&truth, room, 30);
    // Every second firing is known: off by 20 mm where 10 mm are stated.
    let known = |index: usize| PointError {
        error_m: if (index / 16).is_multiple_of(2) {
            0.02
        } else {
            f64::NAN
        },
        sd_m: 0.01,
    };
    let errors: Vec<PointError> = (0..120_000).map(known).collect();
    let study = by(&truth, &[scan], &[errors]);
    assert!(study.shots > 50_000, "{}", study.shots);
    for group in &study.groups {
        assert!(!group.bins.is_empty(), "{}", group.name);
        for bin in group.bins.iter().filter(|bin| bin.shots > 1_000) {
            let ratio = bin.rms_m / bin.expected_m;
            assert!((0.93..1.07).contains(&ratio), "{} {bin:?}", group.name);
            let [error_m, sd_m, ratio] = bin.truth.unwrap();
            assert!((error_m - 0.02).abs() + (sd_m - 0.01).abs() + (ratio - 2.0).abs() < 1e-9);
        }
    }
    let [pair] = study.sweeps[..] else {
        panic!("{:?}", study.sweeps)
    };
    assert!(pair.both_ways && pair.patches > 100, "{pair:?}");
    assert!(pair.tilt_rad[0].abs() < 5.0 * pair.tilt_rad[1], "{pair:?}");
    assert!(
        (0.8..1.2).contains(&(pair.rms_m / pair.expected_m)),
        "{pair:?}"
    );
    assert!(study.stations.is_empty());
}

#[test]
fn play_that_is_not_corrected_is_the_difference_of_the_two_ways() {
    let truth = truth(&mut draws(31));
    let scan = scan(&truth, room, 31);
    let mut wrong = truth.clone();
    wrong[8] += 1e-3;
    let [pair] = by(&wrong, &[scan], &[]).sweeps[..] else {
        panic!()
    };
    // The first sweep goes back, the second forward.
    assert!((pair.tilt_rad[0] - 1e-3).abs() < 5e-5, "{pair:?}");
}

#[test]
fn a_laser_that_is_not_corrected_shows() {
    let truth = truth(&mut draws(32));
    let scan = scan(&truth, room, 32);
    let mut wrong = truth.clone();
    wrong[9 + 5] += 0.01;
    let study = by(&wrong, &[scan], &[]);
    let offset = study.laser_offsets_m[5].unwrap();
    assert!(
        (0.005..0.011).contains(&offset),
        "{:?}",
        study.laser_offsets_m
    );
    assert!(
        study
            .laser_offsets_m
            .iter()
            .flatten()
            .all(|other| *other <= offset)
    );
    assert!(
        study
            .noise_m
            .iter()
            .all(|noise| (noise / 0.01 - 1.0).abs() < 0.1)
    );
}

#[test]
fn a_budget_has_each_error_alone_and_all_together() {
    let truth = truth(&mut draws(33));
    let scan = scan(&truth, room, 33);
    let budget = by(&truth, &[scan], &[]).budget;
    assert!(!budget.is_empty());
    for bin in budget {
        let mount = bin.mount_m.unwrap();
        assert!((mount - 5_f64.sqrt() * 1e-3).abs() < 1e-6, "{bin:?}");
        assert!((bin.calibration_m.unwrap() - mount).abs() < 1e-9);
        assert_eq!((bin.axis_m, bin.lasers_m), (Some(0.0), Some(0.0)));
        assert!(bin.tilt_m <= 1e-4 * bin.to_m && bin.tilt_m > 0.0, "{bin:?}");
        let all = [bin.range_m, bin.azimuth_m, bin.tilt_m, bin.clock_m, mount];
        let all = all.into_iter().fold(0.0, f64::hypot);
        assert!((bin.total_m - all).abs() < 1e-9, "{bin:?}");
    }
}

#[test]
fn two_stations_agree_on_the_distances_of_corners() {
    /// The room from elsewhere, turned by 0.4 rad.
    fn elsewhere(from: [f64; 3], to: [f64; 3]) -> f64 {
        let (sin, cos) = 0.4_f64.sin_cos();
        let turned = |[x, y, z]: [f64; 3]| [x * cos - y * sin, x * sin + y * cos, z];
        let [x, y, z] = turned(from);
        room([x - 0.9, y + 0.7, z + 0.1], turned(to))
    }
    let truth = truth(&mut draws(34));
    let scans = [scan(&truth, room, 34), scan(&truth, elsewhere, 35)];
    let [pair] = by(&truth, &scans, &[]).stations[..] else {
        panic!()
    };
    assert!(pair.corners >= 4 && pair.lengths_m[1] > 3.0, "{pair:?}");
    assert!(pair.rms_m < 0.01, "{pair:?}");
}
