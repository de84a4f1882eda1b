//! From the devices' bytes to the cloud in virtual time, compared with the truth.

mod frames;
mod links;
mod live;
mod mechanism;
mod sensors;
mod tolerance;

use engine::devices::drive_session::SessionError;
use units::{DegPerS, DegPerS2, Host, Span, Stamp};
use velomotion_tests::capture::{Captured, Setting};

/// The scan of the quick start: 45 deg at 56.25 deg/s in a hall whose surfaces are within 20 m.
#[test]
fn the_default_scan_is_accurate_to_a_few_millimetres() {
    let captured = Captured::new(Setting::default());
    let (scan, cloud) = captured.scan();
    assert!(cloud.len() > 180_000, "{} points", cloud.len());
    assert_eq!(scan.points, cloud.len() as u64);
    let farthest = cloud
        .positions()
        .map(|p| p.iter().map(|x| x * x).sum::<f64>())
        .fold(0.0, f64::max);
    assert!(farthest.sqrt() <= 20.0, "{} m", farthest.sqrt());

    let error = captured.error();
    assert_eq!(error.points, scan.points, "{error:?}");
    assert_eq!((error.unmatched, error.not_finite), (0, 0), "{error:?}");
    assert!(error.rms_m < 2e-3, "{error:?}");
    assert!(error.worst_m < 10e-3, "{error:?}");

    let [sweep] = scan.sweeps[..] else {
        panic!("{:?}", scan.sweeps);
    };
    assert!(
        sweep.from_deg.abs() < 0.01 && (sweep.to_deg + 45.0).abs() < 0.01,
        "{sweep:?}"
    );
    assert!((sweep.cruise_deg_s + 56.25).abs() < 0.1, "{sweep:?}");
    // 45 / 56.25 s of cruise and the time of a ramp: 0.811 s, sampled by polls one or two
    // milliseconds apart.
    assert!((sweep.duration_s - 0.811).abs() < 0.006, "{sweep:?}");
    assert_eq!(scan.contents.lost_packets, 0);
}

/// Each seed has other phases on the same link.
#[test]
fn the_error_does_not_depend_on_the_day() {
    for seed in 2..8 {
        let mut setting = Setting::default();
        setting.links.seed = seed;
        let error = Captured::new(setting).error();
        println!(
            "seed {seed}: rms {:.2} mm, worst {:.2} mm",
            error.rms_m * 1e3,
            error.worst_m * 1e3
        );
        assert!(
            error.rms_m < 2e-3 && error.worst_m < 10e-3,
            "seed {seed}: {error:?}"
        );
    }
}

/// The lidar counts microseconds of the hour: a sweep across the hour is one sweep.
#[test]
fn a_scan_across_the_hour_is_complete() {
    let usual = Captured::new(Setting::default());
    let mut setting = Setting::default();
    // Homing takes some seconds: the hour wraps during the sweep for some of these starts, and
    // before or after it for the others.
    let usual_points = usual.cloud().len() as i64;
    let mut turned_inside = 0;
    for before in [2_000, 3_000, 3_500, 4_000, 4_500, 5_000] {
        setting.lidar_clock_us = 3_600_000_000 - before * 1_000;
        let captured = Captured::new(setting);
        let error = captured.error();
        assert!(
            error.worst_m < 10e-3,
            "{before} ms before the hour: {error:?}"
        );
        assert!(
            (error.points as i64 - usual_points).abs() < 3_000,
            "{before}: {error:?}"
        );
        let (scan, cloud) = captured.scan();
        assert_eq!(scan.contents.lost_packets, 0);
        let hour = |t: &units::Stamp<units::Lidar>| t.as_nanos().div_euclid(3_600_000_000_000);
        let first = cloud.device_time().first().map(hour);
        turned_inside += usize::from(first != cloud.device_time().last().map(hour));
    }
    assert!(
        turned_inside > 0,
        "no sweep crossed the hour: the test checks nothing"
    );
}

#[test]
fn slow_sweeps_both_ways_are_found_and_accurate() {
    let mut setting = Setting::default();
    setting.sweep_request.speed = DegPerS(20.0);
    setting.sweep_request.acceleration = DegPerS2(500.0);
    setting.sweep_request.sweeps = 2;
    setting.sweep_request.both_ways = true;
    let captured = Captured::new(setting);
    let (scan, _) = captured.scan();
    let ways: Vec<(f64, f64)> = scan
        .sweeps
        .iter()
        .map(|s| (s.from_deg.round(), s.to_deg.round()))
        .collect();
    assert_eq!(ways, [(0.0, -45.0), (-45.0, 0.0)]);
    assert!(
        (scan.sweeps[1].cruise_deg_s - 20.0).abs() < 0.02,
        "{:?}",
        scan.sweeps
    );
    assert!(captured.error().worst_m < 10e-3, "{:?}", captured.error());
}

#[test]
fn one_way_sweeps_omit_the_return_move() {
    let mut setting = Setting::default();
    setting.sweep_request.sweeps = 2;
    let (scan, cloud) = Captured::new(setting).scan();
    assert_eq!(scan.sweeps.len(), 2);
    assert!(scan.sweeps.iter().all(|s| s.cruise_deg_s < 0.0));
    assert!(
        (2 * 180_000..520_000).contains(&cloud.len()),
        "{}",
        cloud.len()
    );
}

/// After Ctrl-C at any time the axis comes to rest, is disabled, and stays; a sweep that had
/// started becomes a cloud.
#[test]
fn an_interrupted_capture_stops_the_axis_and_keeps_its_points() {
    let mut clouds = 0;
    for after_ms in (1..3_200).step_by(97) {
        let mut setting = Setting::default();
        setting.sweep_request.speed = DegPerS(30.0);
        setting.sweep_request.acceleration = DegPerS2(500.0);
        setting.interrupt_after = Some(Span::from_millis(after_ms));
        let (captured, ended) = Captured::run(setting);
        assert!(
            matches!(ended, Err(SessionError::Interrupted)),
            "{after_ms} ms: {ended:?}"
        );
        let truth = captured.truth();
        let angle = |at: Stamp<Host>| truth.tilt_deg_at(at).unwrap();
        let end = truth.end() - Span::from_millis(1);
        assert_eq!(
            angle(end),
            angle(end - Span::from_millis(10)),
            "{after_ms} ms: the axis still moves"
        );
        assert!(
            captured.brake_is_set(),
            "{after_ms} ms: the brake is not set"
        );
        if let Ok((scan, cloud)) = captured.try_scan() {
            clouds += 1;
            assert_eq!(scan.sweeps.len(), 1, "{after_ms} ms");
            assert!(
                (scan.sweeps[0].to_deg - angle(end)).abs() < 0.01,
                "{after_ms} ms: {scan:?}"
            );
            assert!(
                !cloud.is_empty() && captured.error().worst_m < 10e-3,
                "{after_ms} ms"
            );
        }
    }
    assert!(
        clouds > 5,
        "no interruption hit a sweep: the test checks nothing"
    );
}
