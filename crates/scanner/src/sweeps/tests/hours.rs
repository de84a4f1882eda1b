//! Host clocks that were set by hours in a sweep.

use super::*;

/// The lidar's stamps repeat hourly: a host whose clock was set by hours while it slept leaves a
/// silence of hours, though the axis moved on for moments.
#[test]
fn hours_that_the_axis_did_not_need_are_a_step_of_the_clock() {
    let hours = |silence_ms: i64, before_deg: f64, meanwhile_deg: f64| {
        let mut axis = Axis::new();
        axis.command(-45.0, 0x1F);
        axis.travel(-before_deg, 56.25);
        axis.now += silence_ms;
        axis.angle -= meanwhile_deg;
        axis.travel(before_deg + meanwhile_deg - 45.0, 56.25);
        let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN)).seen;
        assert_eq!(sweeps.len(), 1);
        sweeps[0].hours_too_many(&axis.samples)
    };
    let found = hours(7_200_400, 10.0, 22.5).unwrap();
    assert!(
        (found.silence.as_secs_f64() - 7_200.4).abs() < 0.01,
        "{found:?}"
    );
    assert!((found.motion.as_secs_f64() - 0.4).abs() < 0.02, "{found:?}");
    assert!((found.at.0 + 10.0).abs() < 1e-6, "{found:?}");
    // Held by hand.
    assert!(hours(3_600_000, 10.0, 0.0).is_some());
    // Not whole hours; no hour at all.
    assert_eq!(hours(1_800_400, 10.0, 22.5), None);
    assert_eq!(hours(400, 10.0, 22.5), None);
    // At its target the axis may rest for hours, and before it leaves its place.
    assert_eq!(hours(7_200_400, 15.0, 29.95), None);
    assert_eq!(hours(7_200_400, 0.05, 22.5), None);
}
