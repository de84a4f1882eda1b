//! Curves through the polls of a realistic drive.

use super::simulated_drive::{Drive, EPOCH, Noise, QUANTUM, REFERENCE, Run, STEP_S};
use super::*;
use crate::sweeps::Commanded;
use units::DegPerS2;

/// Limits: 0.011 degrees at most and 0.0028 root mean square, of which the ripple alone, unseen by
/// any encoder, is 0.0021.
#[test]
fn the_best_curve_through_real_polls_is_as_accurate_as_the_gear() {
    for damping in [0.7, 1.0] {
        let seeds = 1..=4;
        let errors: Vec<_> = seeds
            .map(|seed| {
                let run = Drive {
                    seed,
                    servo: Some((15.0, damping)),
                    ..REFERENCE
                }
                .run();
                let best = run.trajectory(None);
                assert!(matches!(
                    best.method(),
                    Method::ProfileServo | Method::ProfileServo2
                ));
                let fit = &best.fits()[0];
                assert!(
                    fit.condition.unwrap() < 1e6 && fit.remarks.is_empty(),
                    "{fit:?}"
                );
                let bound = best.bound_deg(&[(run.sweep.start, run.sweep.end)]);
                let (worst, rms, delay) = run.error(&best);
                assert!(worst < 0.011 && worst < bound, "{worst}, bound {bound}");
                // Its own error estimate holds, without the ripple.
                assert!(
                    rms.hypot(0.0021) < 2.0 * fit.sd_deg.hypot(0.0021),
                    "{rms} {fit:?}"
                );
                assert!(
                    Span::from_secs_f64(-delay) > fit.delay.0
                        && Span::from_secs_f64(-delay) < fit.delay.1
                );
                rms
            })
            .collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        println!("damping {damping}: rms {errors:?}");
        assert!(mean < 0.0028, "{mean}");
    }
}

/// At SYNC, 1 kHz, with the drive's own time: the samples are so good that a spline shows what a
/// servo of first order lacks.
#[test]
fn accurate_samples_are_followed() {
    let run = Drive {
        round_trip_s: (0.1e-3, 0.14e-3),
        spikes: 0.0,
        hertz: 1_000.0,
        ..REFERENCE
    }
    .run();
    let best = run.trajectory(None);
    let (worst, rms, _) = run.error(&best);
    assert!(worst < 0.005 && rms < 0.0024, "{worst} {rms}");
}

/// On the motion it is made for, a method is never worse than the cheaper one before it.
#[test]
fn each_method_is_best_for_its_kind_of_motion() {
    let run = REFERENCE.run();
    let rms = |method| run.error(&run.trajectory(Some(method))).1;
    let [nearest, linear, profile, servo] = [
        Method::Nearest,
        Method::Linear,
        Method::Profile,
        Method::ProfileServo,
    ]
    .map(rms);
    assert!(
        nearest > 2.0 * linear && linear > 2.0 * profile && profile > servo,
        "{nearest} {linear} {profile} {servo}"
    );
}

/// For a tenth of a second the shaft is held back by up to a degree.
#[test]
fn motion_without_command_is_followed_and_reported() {
    let mut run = REFERENCE.run();
    for sample in &mut run.samples {
        let t = (sample.host - Stamp::from_nanos(EPOCH)).as_secs_f64();
        if (0.5..0.6).contains(&t) {
            sample.angle.0 += (std::f64::consts::PI * (t - 0.5) / 0.1).sin();
        }
    }
    let best = run.trajectory(None);
    let fit = &best.fits()[0];
    assert_eq!(fit.method, Method::Spline);
    assert!(
        matches!(fit.remarks[..], [Remark::NotAsCommanded { .. }]),
        "{fit:?}"
    );
    let at = Moment {
        host: Stamp::from_nanos(EPOCH) + Span::from_millis(550),
        rest_ns: 0.0,
    };
    let off = best.angle(at).unwrap().0 - run.shaft[55_000] - 1.0;
    assert!(off.abs() < 0.05, "{off}");
    // The commanded motion alone would be half a degree off, and reports it.
    let forced = run.trajectory(Some(Method::ProfileServo));
    assert!(forced.fits()[0].sd_deg > 0.1 && forced.fits()[0].rms_deg > 0.1);
}

/// A limit switch ends the sweep half way: later samples are at rest elsewhere.
#[test]
fn an_interrupted_sweep_keeps_its_angles() {
    let run = Drive {
        way: -20.0,
        ..REFERENCE
    }
    .run();
    let mut sweep = run.sweep;
    sweep.commanded.speed = DegPerS(56.25);
    let stopped = Run {
        sweep: Sweep {
            to: Degrees(-20.0),
            ..sweep
        },
        ..run
    };
    let best = stopped.trajectory(None);
    assert!(stopped.error(&best).0 < 0.011);
}

/// A way shorter than v^2/a: the cruise is never reached.
#[test]
fn triangular_profiles_are_fitted() {
    for way in [-3.0, 3.0, -0.4] {
        let run = Drive {
            way,
            servo: Some((15.0, 1.0)),
            ..REFERENCE
        }
        .run();
        let best = run.trajectory(None);
        let (worst, ..) = run.error(&best);
        assert!(worst < 0.011, "{way}: {worst} by {:?}", best.fits());
    }
}

/// Degenerate profiles: an acceleration without samples, a speed near zero, a way of two counts.
#[test]
fn degenerate_profiles_are_fitted_or_joined() {
    let still = Drive {
        servo: None,
        ripple_deg: 0.0,
        ..REFERENCE
    };
    for (name, drive, allowed) in [
        (
            "ramps within a sample",
            Drive {
                acceleration: 50_000.0,
                ..still
            },
            0.06,
        ),
        (
            "hardly any speed",
            Drive {
                speed: 0.05,
                way: -0.2,
                ..still
            },
            0.003,
        ),
        (
            "two counts",
            Drive {
                speed: 0.05,
                way: -0.003,
                ..still
            },
            0.003,
        ),
        ("up", Drive { way: 45.0, ..still }, 0.011),
    ] {
        let run = drive.run();
        let best = run.trajectory(None);
        let (worst, ..) = run.error(&best);
        assert!(worst < allowed, "{name}: {worst}, {:?}", best.fits());
        for fit in best.fits() {
            assert!(fit.condition.is_none_or(|c| c < 1e6), "{name}: {fit:?}");
        }
    }
    // Ramps without samples are reported as regularised.
    let run = Drive {
        acceleration: 5_000.0,
        hertz: 40.0,
        ..still
    }
    .run();
    let servo = run.trajectory(Some(Method::Profile));
    assert!(matches!(
        servo.fits()[0].remarks[..],
        [Remark::Regularised(RegularisedParameters {
            ramp_up: true,
            ramp_down: true,
            ..
        })]
    ));
}

/// At 0.05 deg/s a ramp of 0.1 ms covers a thousandth of a count.
#[test]
fn ramps_and_servos_of_less_than_a_count_are_not_reported() {
    let run = Drive {
        speed: 0.05,
        way: -0.1,
        ..REFERENCE
    }
    .run();
    let fits = run.trajectory(None);
    assert_eq!(fits.fits()[0].remarks, [], "{:?}", fits.fits());
}

/// A filter by round-trip time must keep some polls.
#[test]
fn polls_of_equal_round_trip_are_fitted() {
    let run = Drive {
        round_trip_s: (1e-3, 1e-3),
        spikes: 0.0,
        ..REFERENCE
    }
    .run();
    let (worst, ..) = run.error(&run.trajectory(None));
    assert!(worst < 0.011, "{worst}");
}

#[test]
fn two_or_three_samples_are_connected_by_lines() {
    let run = REFERENCE.run();
    for count in [1, 2, 3, 5] {
        let step = run.samples.len() / count;
        let few: Vec<_> = run
            .samples
            .iter()
            .step_by(step.max(1))
            .take(count)
            .copied()
            .collect();
        for method in Method::ALL.map(Some).into_iter().chain([None]) {
            let trajectory =
                Trajectory::through(few.clone(), Degrees(QUANTUM), &[run.sweep], method).unwrap();
            let inside = trajectory.angle(Moment {
                host: few[0].host,
                rest_ns: 0.0,
            });
            assert!(
                (inside.unwrap().0 - few[0].angle.0).abs() < 1.0,
                "{count} {method:?}"
            );
        }
    }
}

/// Both ways, each sweep with a motion of its own.
#[test]
fn several_sweeps_have_a_fit_each() {
    let one = Drive {
        servo: Some((15.0, 1.0)),
        ..REFERENCE
    };
    let (there, back) = (
        one.run(),
        Drive {
            way: 45.0,
            seed: 9,
            ..one
        }
        .run(),
    );
    let later = Span::from_secs_f64(there.shaft.len() as f64 * STEP_S);
    let shifted = back.samples.iter().map(|s| AngleSample {
        host: s.host + later,
        angle: Degrees(s.angle.0 - 45.0),
        ..*s
    });
    let samples: Vec<_> = there.samples.iter().copied().chain(shifted).collect();
    let second = Sweep {
        from: Degrees(-45.0),
        to: Degrees(0.0),
        start: back.sweep.start + later,
        end: back.sweep.end + later,
        ..back.sweep
    };
    let both =
        Trajectory::through(samples, Degrees(QUANTUM), &[there.sweep, second], None).unwrap();
    assert_eq!(both.fits().len(), 2);
    assert!(there.error(&both).0 < 0.011);
    let alone = back.trajectory(None);
    for ms in (250..1_000).step_by(50) {
        let at = Stamp::from_nanos(EPOCH) + Span::from_millis(ms);
        let angle = |t: &Trajectory, host| t.angle(Moment { host, rest_ns: 0.0 }).unwrap().0;
        let off = angle(&both, at + later) + 45.0 - angle(&alone, at);
        assert!(off.abs() < 1e-3, "{ms}: {off}");
    }
}

/// 45 degrees in a quarter of an hour: 360,000 polls, a cruise of 900 s between ramps of a tenth of
/// a millisecond.
#[test]
fn a_sweep_of_a_quarter_of_an_hour_is_followed() {
    let speed = 0.05;
    let mut noise = Noise(5);
    let mut samples = Vec::new();
    let truth = |t: f64| -speed * (t - 1.0).clamp(0.0, 900.0);
    let mut t = 0.0;
    while t < 902.0 {
        let half = 0.4e-3 + 0.85e-3 * noise.next();
        let counts = (truth(t + 2.0 * half * noise.next()) / QUANTUM).floor();
        samples.push(AngleSample {
            host: Stamp::from_nanos(EPOCH) + Span::from_secs_f64(t + half),
            bound: Span::from_secs_f64(half),
            angle: Degrees(counts * QUANTUM),
        });
        t += 2.5e-3;
    }
    let at = |s: f64| Stamp::from_nanos(EPOCH) + Span::from_secs_f64(s);
    let sweep = Sweep {
        from: Degrees(0.0),
        to: Degrees(-45.0),
        cruise: DegPerS(-speed),
        start: at(1.0),
        end: at(901.0),
        commanded: Commanded {
            speed: DegPerS(speed),
            acceleration: DegPerS2(500.0),
            deceleration: DegPerS2(500.0),
        },
    };
    let best = Trajectory::through(samples, Degrees(QUANTUM), &[sweep], None).unwrap();
    let worst = (0..9_000)
        .map(|k| {
            let t = 1.0 + f64::from(k) / 10.0;
            (best
                .angle(Moment {
                    host: at(t),
                    rest_ns: 0.0,
                })
                .unwrap()
                .0
                - truth(t))
            .abs()
        })
        .fold(0.0, f64::max);
    assert!(worst < 0.0005, "{worst} by {:?}", best.fits());
}
