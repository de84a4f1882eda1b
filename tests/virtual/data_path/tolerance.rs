//! A tolerance in place of a method.

use cloud::{Fields, Points};
use engine::reconstruct::source::Source;
use io::recording::Recording;
use scanner::trajectory::Method;
use scanner::{Accuracy, Alignment, Placer, ScanError, Survey, TiltSource, Tolerance};
use sim::Attachment;
use velomotion_tests::capture::{Captured, Setting};

fn solve(captured: &Captured, tolerance: &str) -> Result<Alignment, ScanError> {
    let source = Source::open(&captured.log(), None).unwrap();
    let config = source.config().unwrap();
    let mut survey = Survey::new(&config, lidar::Options::default()).unwrap();
    let mut recording = Recording::open(captured.log()).unwrap();
    while let Some(record) = recording.next_record().unwrap() {
        survey.observe(&record);
    }
    let tolerance: Tolerance = tolerance.parse().unwrap();
    survey.solve(&config, &TiltSource::Log, Accuracy::Within(tolerance))
}

/// The range's part of a point's error: half of 2 mm, and 0.01 deg of azimuth at the room's
/// corners.
const RANGES_M: f64 = 2e-3;

#[test]
fn the_cheapest_method_within_the_tolerance_is_chosen() {
    let captured = Captured::new(Setting::over(Attachment::Can));
    let (mut methods, at_m) = (Vec::new(), 10.0);
    for tolerance in ["200mm@10m", "20mm@10m", "12mm@10m"] {
        let alignment = solve(&captured, tolerance).unwrap();
        let choice = alignment.choice.clone().unwrap();
        let (method, bound) = *choice.bounds.last().unwrap();
        assert_eq!(method, alignment.trajectory.method());
        assert!(bound.0 <= choice.tolerance.off.0);
        let refused = &choice.bounds[..choice.bounds.len() - 1];
        assert!(
            refused
                .iter()
                .all(|(_, bound)| bound.0 > choice.tolerance.off.0)
        );
        methods.push(method);
        // The promised tolerance holds.
        let mut points = Points::new(Fields::ALL);
        let mut placer = Placer::new(&alignment, lidar::Options::default(), &mut points);
        let mut recording = Recording::open(captured.log()).unwrap();
        while let Some(record) = recording.next_record().unwrap() {
            placer.observe(&record).unwrap();
        }
        placer.finish().unwrap();
        for point in points.iter() {
            let truth = captured
                .truth()
                .point(point.device_time.as_nanos(), point.laser)
                .unwrap();
            let off: f64 = point
                .position_m
                .iter()
                .zip(truth)
                .map(|(a, b)| (a - b).powi(2))
                .sum();
            let distance: f64 = point.position_m.iter().map(|x| x * x).sum();
            let promised = bound.0 * distance.sqrt() / at_m + RANGES_M;
            assert!(
                off.sqrt() < promised,
                "{tolerance}: {off} {promised} {point:?}"
            );
        }
    }
    // Half a millisecond at 56 deg/s is 5 mm at 10 m, and a position may be a millisecond old.
    assert_eq!(methods[..2], [Method::Nearest, Method::Linear]);
    assert_ne!(methods[2], Method::Nearest);
}

#[test]
fn a_slower_sweep_is_suggested_when_no_method_meets_the_tolerance() {
    let captured = Captured::new(Setting::over(Attachment::Usb));
    let Err(ScanError::UnreachableTolerance(out)) = solve(&captured, "1mm@100m") else {
        panic!("polls of a millisecond and more cannot be that accurate");
    };
    assert!(out.bound.0 > 1e-3 && out.fastest.0 < -55.0, "{out:?}");
    // Round trips dominate; a slower sweep meets the tolerance.
    assert!(out.delay_share > 0.5, "{out:?}");
    let slower = out.speed_that_would_do().unwrap().0;
    assert!((0.05..10.0).contains(&slower), "{slower}");
}
