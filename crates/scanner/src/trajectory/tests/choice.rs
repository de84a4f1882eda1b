//! The chosen curve against the best by hindsight, over servos, accelerations and disturbances.

use super::simulated_drive::{Disturbance, Drive, QUANTUM, REFERENCE};
use super::*;

/// Natural frequency and damping, underdamped to overdamped.
const SERVOS: [(f64, f64); 5] = [
    (15.0, 0.3),
    (15.0, 0.5),
    (30.0, 0.5),
    (8.0, 0.8),
    (15.0, 1.4),
];
const FITS: [Method; 4] = [
    Method::Profile,
    Method::ProfileServo,
    Method::ProfileServo2,
    Method::Spline,
];

struct Comparison {
    /// Greatest and root mean square error of the chosen curve, degrees.
    chosen: (f64, f64),
    /// The least of each over all methods.
    best: (f64, f64),
    bound: f64,
    method: Method,
}

fn compared(drive: Drive) -> Comparison {
    let run = drive.run();
    let error = |trajectory: &Trajectory| {
        let (worst, rms, _) = run.error(trajectory);
        (worst, rms)
    };
    let all = FITS.map(|method| error(&run.trajectory(Some(method))));
    let chosen = run.trajectory(None);
    Comparison {
        chosen: error(&chosen),
        best: all
            .into_iter()
            .fold((f64::INFINITY, f64::INFINITY), |a, b| {
                (a.0.min(b.0), a.1.min(b.1))
            }),
        bound: chosen.bound_deg(&[(run.sweep.start, run.sweep.end)]),
        method: chosen.method(),
    }
}

/// A candidate that was compared with its own scatter won by being hopeless: 0.16 degrees at 5,000
/// deg/s^2 with a servo damped by a half. By one scale all are below 0.0109 degrees.
#[test]
fn the_curve_that_predicts_best_is_chosen_for_any_servo() {
    for servo in SERVOS {
        for acceleration in [500.0, 2_000.0, 5_000.0, 10_000.0] {
            for seed in 1..=4 {
                let Comparison {
                    chosen,
                    best,
                    bound,
                    method,
                } = compared(Drive {
                    servo: Some(servo),
                    acceleration,
                    ripple_deg: 0.0,
                    seed,
                    ..REFERENCE
                });
                let what = format!(
                    "{servo:?} {acceleration} deg/s^2 seed {seed}: {chosen:?} by {method:?}, best {best:?}, bound {bound}"
                );
                assert!(chosen.0 < 0.0109 && chosen.0 < bound, "{what}");
                assert!(chosen.1 < 1.3 * best.1 + 0.0003, "{what}");
                assert!(chosen.0 < 1.3 * best.0 + QUANTUM, "{what}");
            }
        }
    }
}

/// A head held for 0.15 s or more was 7 degrees off, as a fit with large residuals has a large
/// scatter. What remains happens between two polls, 2.5 ms apart, and is within the bound. All but
/// a few of 140 are within 1.3 times the best by hindsight, as with other seeds: cross-validation
/// predicts samples, and where two curves differ between samples only, they cannot tell.
#[test]
fn a_disturbed_head_is_followed() {
    let mut far = Vec::new();
    for servo in SERVOS {
        for disturbance in [
            Disturbance::Held(0.03),
            Disturbance::Held(0.15),
            Disturbance::Held(0.2),
            Disturbance::Slipped(-0.3),
            Disturbance::Jerked(60.0),
            Disturbance::Bumped(2_000.0),
            Disturbance::Bumped(-500.0),
        ] {
            for seed in 1..=4 {
                let Comparison {
                    chosen,
                    best,
                    bound,
                    method,
                } = compared(Drive {
                    servo: Some(servo),
                    disturbance,
                    ripple_deg: 0.0,
                    seed,
                    ..REFERENCE
                });
                let what = format!(
                    "{servo:?} {disturbance:?} seed {seed}: {chosen:?} by {method:?}, best {best:?}, bound {bound}"
                );
                assert!(chosen.0 < bound, "{what}");
                let ratio = (chosen.0 / best.0, chosen.1 / best.1);
                assert!(ratio.0 < 2.2 && ratio.1 < 1.4, "{what}");
                if ratio.0 > 1.3 || ratio.1 > 1.3 {
                    far.push(what);
                }
            }
        }
    }
    assert!(far.len() <= 4, "{}", far.join("\n"));
}

/// A drive that renews its position once per millisecond exceeded the bound in four of five runs.
#[test]
fn the_bound_contains_the_age_of_positions() {
    let mut estimated = 0;
    for hertz in [200.0, 400.0, 1_000.0] {
        for speed in [5.0, 56.25, 98.0] {
            for latch in [true, false] {
                for seed in 1..=4 {
                    let run = Drive {
                        hertz,
                        speed,
                        latch,
                        seed,
                        ripple_deg: 0.0,
                        ..REFERENCE
                    }
                    .run();
                    for method in [None, Some(Method::Linear), Some(Method::Profile)] {
                        let curve = run.trajectory(method);
                        let bound = curve.bound_deg(&[(run.sweep.start, run.sweep.end)]);
                        let worst = run.worst_with_delay(&curve);
                        let what = format!(
                            "latch {latch}, {hertz} Hz, {speed} deg/s, seed {seed}, {:?}: {worst} of {bound}",
                            curve.method()
                        );
                        assert!(worst <= bound + QUANTUM, "{what}");
                        // Without the estimate it is at least half of a cycle.
                        if method.is_none() && latch && worst < 0.25e-3 * speed {
                            estimated += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(estimated > 18, "{estimated} of 36");
}
