use super::*;
use lidar::ReturnKind;
use units::{Lidar, Stamp};

const GEARING: Gearing = match Gearing::new(500, 120, 1) {
    Ok(gearing) => gearing,
    Err(_) => unreachable!(),
};

fn point(position_m: [f64; 3]) -> SensorPoint {
    SensorPoint {
        time: Stamp::<Lidar>::from_nanos(0),
        position_m,
        range_m: 0.0,
        azimuth_variance_rad2: 0.0,
        laser: 2,
        ring: 0,
        reflectivity: 0,
        echo: ReturnKind::Strongest,
    }
}

fn correction() -> AxisCorrection {
    AxisCorrection {
        delay_us: 150.0,
        scale: 1e-3,
        ripple_deg: [0.01, -0.02],
        play_deg: 0.06,
    }
}

#[test]
fn the_tilt_follows_its_formula() {
    let calibration = DeviceCalibration {
        axis_correction: correction(),
        ..DeviceCalibration::default()
    };
    let at_work = PointCalibration::new(&calibration, GEARING);
    for (tilt, rate) in [(-31.7, 56.25), (12.3, -10.0), (0.0, 5.0)] {
        let phase = f64::to_radians(120.0 * tilt);
        let expected = tilt * 1.001 + rate * 150e-6 + 0.01 * phase.sin() - 0.02 * phase.cos()
            + 0.03 * f64::signum(rate);
        let got = at_work.tilt(Degrees(tilt), rate).0;
        assert!((got - expected).abs() < 1e-12, "{got} {expected}");
    }
}

/// Each parameter alone, against the displacement of the point when it changes by its deviation.
#[test]
fn variances_are_those_of_moved_parameters() {
    let mount = Mount::at([0.01, 0.002, 0.07], [1.5, -0.7, 2.5]);
    let (head, tilt, rate) = ([6.0, -9.0, 2.0], Degrees(-33.3), 40.0);
    let place = |calibration: &DeviceCalibration, mount: &Mount, head| {
        let at_work = PointCalibration::new(calibration, GEARING);
        mount.place(head, Tilt::new(at_work.tilt(tilt, rate)))
    };
    let base = DeviceCalibration {
        axis_correction: correction(),
        ..DeviceCalibration::default()
    };
    let sd = 1e-3;
    let turned = |axis: usize, by: f64| {
        let mut angles = mount.rotation_deg();
        angles[axis] += by;
        Mount::at(mount.position_m(), angles)
    };
    let shifted = |axis: usize, by: f64| {
        let mut position = mount.position_m();
        position[axis] += by;
        Mount::at(position, mount.rotation_deg())
    };
    let axis = |change: fn(&mut AxisCorrection, f64), by: f64| {
        let mut calibration = base.clone();
        change(&mut calibration.axis_correction, by);
        calibration
    };
    let polar = |range: f64, elevation: f64, azimuth: f64| {
        let [x, y, z] = head;
        let length = f64::hypot(f64::hypot(x, y), z) + range;
        let (e, a) = (
            f64::atan2(z, f64::hypot(x, y)) + elevation.to_radians(),
            f64::atan2(x, y) + azimuth.to_radians(),
        );
        [
            length * e.cos() * a.sin(),
            length * e.cos() * a.cos(),
            length * e.sin(),
        ]
    };
    let now = place(&base, &mount, head);
    let moved = [
        ("mount_rotation_x_deg", place(&base, &turned(0, sd), head)),
        ("mount_rotation_z_deg", place(&base, &turned(2, sd), head)),
        ("mount_position_x_m", place(&base, &shifted(0, sd), head)),
        ("mount_position_z_m", place(&base, &shifted(2, sd), head)),
        (
            "delay_us",
            place(&axis(|a, by| a.delay_us += by, sd), &mount, head),
        ),
        (
            "scale",
            place(&axis(|a, by| a.scale += by, sd), &mount, head),
        ),
        (
            "ripple_sin_deg",
            place(&axis(|a, by| a.ripple_deg[0] += by, sd), &mount, head),
        ),
        (
            "ripple_cos_deg",
            place(&axis(|a, by| a.ripple_deg[1] += by, sd), &mount, head),
        ),
        (
            "play_deg",
            place(&axis(|a, by| a.play_deg += by, sd), &mount, head),
        ),
        ("laser_2_range_m", place(&base, &mount, polar(sd, 0.0, 0.0))),
        (
            "laser_2_elevation_deg",
            place(&base, &mount, polar(0.0, sd, 0.0)),
        ),
        (
            "laser_2_azimuth_deg",
            place(&base, &mount, polar(0.0, 0.0, sd)),
        ),
    ];
    for (name, there) in moved {
        let calibration = DeviceCalibration {
            covariance: Some(ParameterCovariance {
                names: vec!["laser_3_range_m".into(), name.into()],
                sd: vec![1.0, sd],
                correlation: vec![vec![], vec![0.5]],
            }),
            ..base.clone()
        };
        let at_work = PointCalibration::new(&calibration, GEARING);
        let got = at_work.variance_m2(&mount, &point(head), tilt, rate);
        let expected: f64 = (0..3).map(|i| (there[i] - now[i]).powi(2)).sum();
        assert!(
            (got.sqrt() / expected.sqrt() - 1.0).abs() < 1e-2,
            "{name}: {got} {expected}"
        );
    }
}

#[test]
fn correlated_errors_can_cancel() {
    let of = |correlation: f64| {
        let calibration = DeviceCalibration {
            covariance: Some(ParameterCovariance {
                names: vec!["mount_position_z_m".into(), "laser_2_range_m".into()],
                sd: vec![0.01, 0.01],
                correlation: vec![vec![], vec![correlation]],
            }),
            ..DeviceCalibration::default()
        };
        let at_work = PointCalibration::new(&calibration, GEARING);
        let straight_up = point([0.0, 1e-6, 5.0]);
        at_work.variance_m2(
            &Mount::new(units::Metres(0.06)),
            &straight_up,
            Degrees(0.0),
            1.0,
        )
    };
    assert!(of(-1.0) < 1e-9);
    assert!((of(0.0) - 2e-4).abs() < 1e-8);
    assert!((of(1.0) - 4e-4).abs() < 1e-8);
}

#[test]
fn invalid_calibrations_are_refused() {
    let of = |text: &str| {
        let calibration: DeviceCalibration = toml::from_str(text).unwrap();
        calibration.check()
    };
    assert_eq!(of("[axis_correction]\ndelay_us = 100.0"), Ok(()));
    for (text, key) in [
        (
            "[axis_correction]\ndelay_us = nan",
            "axis_correction.delay_us",
        ),
        (
            "[axis_correction]\nplay_deg = 6.0",
            "axis_correction.play_deg",
        ),
        (
            "[[laser]]\nid = 0\nelevation_deg = -15.0\nazimuth_offset_deg = 0.0\nrange_offset_m = 2.0",
            "laser.range_offset_m",
        ),
        (
            "[covariance]\nnames = ['a']\nsd = []\ncorrelation = [[]]",
            "covariance",
        ),
        (
            "[covariance]\nnames = ['a', 'b']\nsd = [1.0, 1.0]\ncorrelation = [[], [1.5]]",
            "covariance",
        ),
    ] {
        let error = of(text).unwrap_err().to_string();
        assert!(error.starts_with(key), "{error}");
    }
}

#[test]
fn lasers_become_corrections_of_their_model_alone() {
    use protocol::vlp16::models::{VLP_16, VLP_32C};
    let text = "model = 'VLP-16'\n[[laser]]\nid = 3\nelevation_deg = 3.05\nazimuth_offset_deg = -0.02\nrange_offset_m = 0.012";
    let calibration: DeviceCalibration = toml::from_str(text).unwrap();
    let corrections = calibration
        .corrections("VLP-16", Corrections::from(&VLP_16))
        .unwrap();
    let laser = corrections.lasers[3];
    assert_eq!((laser.elevation_deg, laser.range_offset_m), (3.05, 0.012));
    assert_eq!(laser.vertical_offset_m, VLP_16.lasers[3].vertical_offset_m);
    assert_eq!(
        corrections.lasers[4],
        LaserCorrection::from(&VLP_16.lasers[4])
    );
    assert!(
        calibration
            .corrections("VLP-32C", Corrections::from(&VLP_32C))
            .is_none()
    );
}
