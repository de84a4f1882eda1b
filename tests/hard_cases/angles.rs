//! Motions and samples that make arithmetic or a fit hard.

use cloud::mount::{Mount, Tilt};
use scanner::AngleSample;
use scanner::clock::Moment;
use scanner::sweeps::{Commanded, Sweep};
use scanner::trajectory::{Method, Remark, Trajectory};
use units::{DegPerS, DegPerS2, Degrees, Host, Metres, Span, Stamp};

/// 2026-11-21 02:05:33 UTC.
const TODAY: Stamp<Host> = Stamp::from_nanos(1_795_226_733_000_000_000);
/// 2100-01-01 00:00:00 UTC and a nanosecond.
const IN_2100: Stamp<Host> = Stamp::from_nanos(4_102_444_800_000_000_001);
const QUANTUM_DEG: f64 = 0.0015;
/// Beginning of the motion.
const START_S: f64 = 0.2;

/// A trapezoid, possibly with unequal ramps, or a triangle.
#[derive(Clone, Copy, Debug)]
struct Motion {
    way_deg: f64,
    speed_deg_s: f64,
    up_deg_s2: f64,
    down_deg_s2: f64,
}

const REFERENCE: Motion = Motion {
    way_deg: -45.0,
    speed_deg_s: 56.25,
    up_deg_s2: 500.0,
    down_deg_s2: 500.0,
};

impl Motion {
    /// Speed reached, and times of braking and rest after the start.
    fn corners(&self) -> (f64, f64, f64) {
        let way = self.way_deg.abs();
        let ramps = |v: f64| v * v / 2.0 * (1.0 / self.up_deg_s2 + 1.0 / self.down_deg_s2);
        let v = if ramps(self.speed_deg_s) > way {
            self.speed_deg_s * (way / ramps(self.speed_deg_s)).sqrt()
        } else {
            self.speed_deg_s
        };
        let cruise_s = if v > 0.0 { (way - ramps(v)) / v } else { 0.0 };
        let brake_s = v / self.up_deg_s2 + cruise_s;
        (v, brake_s, brake_s + v / self.down_deg_s2)
    }

    fn angle_deg(&self, t_s: f64) -> f64 {
        let (v, brake_s, end_s) = self.corners();
        let t = (t_s - START_S).clamp(0.0, end_s);
        let up_s = v / self.up_deg_s2;
        let way = if t < up_s {
            t * t / 2.0 * self.up_deg_s2
        } else if t < brake_s {
            v * (t - up_s / 2.0)
        } else {
            self.way_deg.abs() - (end_s - t).powi(2) / 2.0 * self.down_deg_s2
        };
        // Infinity times zero for a ramp without duration.
        let way = if way.is_finite() { way } else { 0.0 };
        way.copysign(self.way_deg)
    }

    /// Polls at `hz` with a symmetric round trip of twice `half_s`, from rest to rest.
    fn polls(&self, epoch: Stamp<Host>, hz: f64, half_s: f64) -> Vec<AngleSample> {
        let end_s = START_S + self.corners().2 + 0.3;
        let times = (0..).map(|k| 0.013 + f64::from(k) / hz);
        let times = times.take_while(|t| *t < end_s);
        let sample = |t| AngleSample {
            host: epoch + Span::from_secs_f64(t),
            bound: Span::from_secs_f64(half_s),
            angle: Degrees((self.angle_deg(t) / QUANTUM_DEG).floor() * QUANTUM_DEG),
        };
        times.map(sample).collect()
    }

    fn sweep(&self, epoch: Stamp<Host>) -> Sweep {
        let at = |s| epoch + Span::from_secs_f64(s);
        Sweep {
            from: Degrees(0.0),
            to: Degrees(self.way_deg),
            cruise: DegPerS(self.corners().0.copysign(self.way_deg)),
            start: at(START_S),
            end: at(START_S + self.corners().2),
            commanded: Commanded {
                speed: DegPerS(self.speed_deg_s),
                acceleration: DegPerS2(self.up_deg_s2),
                deceleration: DegPerS2(self.down_deg_s2),
            },
        }
    }

    /// Greatest error in a sweep, degrees.
    fn worst_deg(&self, trajectory: &Trajectory, sweep: &Sweep, epoch: Stamp<Host>) -> f64 {
        let (from, to) = (
            (sweep.start - epoch).as_secs_f64(),
            (sweep.end - epoch).as_secs_f64(),
        );
        let errors = (0..=5_000).map(|k| {
            let t = from + (to - from) * f64::from(k) / 5_000.0;
            let angle = trajectory.angle(at(epoch + Span::from_secs_f64(t)));
            (angle.unwrap().0 - self.angle_deg(t)).abs()
        });
        let errors: Vec<f64> = errors.collect();
        assert!(errors.iter().all(|e| e.is_finite()), "{self:?}");
        errors.into_iter().fold(0.0, f64::max)
    }
}

fn at(host: Stamp<Host>) -> Moment {
    Moment { host, rest_ns: 0.0 }
}

fn through(samples: Vec<AngleSample>, sweep: Sweep, method: Option<Method>) -> Trajectory {
    Trajectory::through(samples, Degrees(QUANTUM_DEG), &[sweep], method).unwrap()
}

/// Every method, and the choice between them.
fn methods() -> impl Iterator<Item = Option<Method>> {
    Method::ALL.map(Some).into_iter().chain([None])
}

/// Checks that a fit is well conditioned or reports its regularisation.
fn is_regularised_or_conditioned(trajectory: &Trajectory) -> bool {
    trajectory.fits().iter().all(|fit| {
        let regularised = fit
            .remarks
            .iter()
            .any(|r| matches!(r, Remark::Regularised(_)));
        let well = fit.condition.is_none_or(|condition| condition < 1e6);
        // Encoder steps cannot determine the angle of a moving axis exactly.
        let exact = fit.method.is_fit() && fit.rms_deg > 0.0 && fit.sd_deg < 1e-6;
        let humble = fit.sd_deg.is_finite() && !exact;
        (well || regularised) && humble
    })
}

/// Nanoseconds since 1970 exceed a double. Conversion to one costs a quarter of a microsecond;
/// conversion to f32 seconds of the hour costs 244 us, 0.014 deg here.
#[test]
fn angles_in_2100_equal_those_of_today() {
    for method in methods() {
        let [today, then] = [TODAY, IN_2100].map(|epoch| {
            let samples = REFERENCE.polls(epoch, 400.0, 0.5e-3);
            through(samples, REFERENCE.sweep(epoch), method)
        });
        for ns in (250_000_000..1_050_000_000).step_by(1_234_567) {
            let angle = |t: &Trajectory, epoch: Stamp<Host>| {
                t.angle(at(epoch + Span::from_nanos(ns))).unwrap()
            };
            assert_eq!(angle(&today, TODAY), angle(&then, IN_2100), "{method:?}");
        }
        // One nanosecond changes the angle.
        let angle = |ns| then.angle(at(IN_2100 + Span::from_nanos(ns))).unwrap().0;
        if method != Some(Method::Nearest) {
            let step = angle(700_000_001) - angle(700_000_000);
            assert!((step / -56.25e-9 - 1.0).abs() < 0.2, "{method:?}: {step}");
        }
    }
}

/// Degenerate motions: divisions by a ramp, a speed or a distance would be divisions by zero.
#[test]
fn degenerate_motions_are_followed() {
    for (name, motion, most_deg) in [
        ("the usual one", REFERENCE, 0.003),
        (
            "reversed",
            Motion {
                way_deg: 45.0,
                ..REFERENCE
            },
            0.003,
        ),
        (
            "unequal ramps",
            Motion {
                up_deg_s2: 300.0,
                down_deg_s2: 900.0,
                ..REFERENCE
            },
            0.003,
        ),
        (
            "shorter than v2/a",
            Motion {
                way_deg: -3.0,
                ..REFERENCE
            },
            0.003,
        ),
        (
            "a triangle with unequal ramps",
            Motion {
                way_deg: 3.0,
                up_deg_s2: 900.0,
                down_deg_s2: 300.0,
                ..REFERENCE
            },
            0.003,
        ),
        // A ramp shorter than a poll: its start is known to half a poll.
        (
            "unlimited acceleration",
            Motion {
                up_deg_s2: 1e12,
                down_deg_s2: 1e12,
                ..REFERENCE
            },
            0.07,
        ),
        (
            "one unlimited ramp",
            Motion {
                up_deg_s2: 1e12,
                ..REFERENCE
            },
            0.07,
        ),
        (
            "a speed near zero",
            Motion {
                way_deg: -0.3,
                speed_deg_s: 0.05,
                ..REFERENCE
            },
            0.002,
        ),
        (
            "a distance of one count",
            Motion {
                way_deg: -QUANTUM_DEG,
                ..REFERENCE
            },
            0.002,
        ),
        (
            "no distance",
            Motion {
                way_deg: 0.0,
                ..REFERENCE
            },
            0.002,
        ),
    ] {
        let sweep = motion.sweep(TODAY);
        let samples = motion.polls(TODAY, 400.0, 0.2e-3);
        for method in methods() {
            let trajectory = through(samples.clone(), sweep, method);
            let worst = motion.worst_deg(&trajectory, &sweep, TODAY);
            let printed = format!("{name}, {method:?}: {worst}, {:?}", trajectory.fits());
            assert!(is_regularised_or_conditioned(&trajectory), "{printed}");
            let bound = trajectory.bound_deg(&[(sweep.start, sweep.end)]);
            // A spline has no corners; an unlimited acceleration makes one.
            let corner = method == Some(Method::Spline) && motion.up_deg_s2 > 1e6;
            // Over few counts a fit is limited by the resolution of the counts; over a single one
            // homing leaves a part of it unseen, too, and no sample shows the age of another.
            let known = match motion.way_deg.abs() <= QUANTUM_DEG {
                true => bound + QUANTUM_DEG,
                false => bound.max(QUANTUM_DEG),
            };
            assert!(corner || worst <= known, "{printed}, bound {bound}");
            if method.is_none() {
                assert!(worst < most_deg, "{printed}");
            }
        }
    }
}

/// The commanded motion may be missing or wrong: the samples alone then give the motion.
#[test]
fn motions_without_a_known_command_follow_the_samples() {
    let reported = |speed, up, down| Commanded {
        speed: DegPerS(speed),
        acceleration: DegPerS2(up),
        deceleration: DegPerS2(down),
    };
    for commanded in [
        Commanded::default(),
        reported(56.25, f64::INFINITY, f64::INFINITY),
        reported(56.25, 0.0, 500.0),
        reported(1e-9, 500.0, 500.0),
        reported(f64::INFINITY, 500.0, 500.0),
    ] {
        let sweep = Sweep {
            commanded,
            ..REFERENCE.sweep(TODAY)
        };
        let best = through(REFERENCE.polls(TODAY, 400.0, 0.2e-3), sweep, None);
        let worst = REFERENCE.worst_deg(&best, &sweep, TODAY);
        assert!(worst < 0.01, "{commanded:?}: {worst} by {:?}", best.fits());
        assert!(is_regularised_or_conditioned(&best), "{:?}", best.fits());
    }
}

/// A recording may end anywhere in a sweep (cable, power, Ctrl-C). Nothing after the last sample is
/// known, so distance and last ramp cannot be fitted.
#[test]
fn samples_that_end_in_mid_sweep_give_no_angle_after() {
    for part in [0.02, 0.06, 0.125, 0.2, 0.5, 0.88, 0.95, 0.99] {
        let whole = REFERENCE.sweep(TODAY);
        let end = whole.start + Span::from_secs_f64((whole.end - whole.start).as_secs_f64() * part);
        let mut samples = REFERENCE.polls(TODAY, 400.0, 0.2e-3);
        samples.retain(|s| s.host <= end);
        let last = *samples.last().unwrap();
        let sweep = Sweep {
            to: last.angle,
            end: last.host,
            ..whole
        };
        for method in methods() {
            let cut = through(samples.clone(), sweep, method);
            assert!(
                is_regularised_or_conditioned(&cut),
                "{part} {method:?}: {:?}",
                cut.fits()
            );
            let worst = REFERENCE.worst_deg(&cut, &sweep, TODAY);
            let bound = cut.bound_deg(&[(sweep.start, sweep.end)]);
            assert!(
                worst <= bound,
                "{part} {method:?}: {worst}, bound {bound}, {:?}",
                cut.fits()
            );
            if method.is_none() {
                assert!(worst < 0.01, "{part}: {worst} by {:?}", cut.fits());
            }
        }
    }
}

/// Without ramps start time, start angle, ramps and distance are one straight line, and an
/// unregularised fit's condition number exceeds 1e7. With both ramps it is some tens.
#[test]
fn a_fit_of_the_cruise_alone_reports_its_condition() {
    let whole = REFERENCE.sweep(TODAY);
    let samples = REFERENCE.polls(TODAY, 400.0, 0.2e-3);
    let conditions: Vec<f64> = [Method::Profile, Method::ProfileServo, Method::ProfileServo2]
        .into_iter()
        .map(|method| {
            let fit = through(samples.clone(), whole, Some(method));
            fit.fits()[0].condition.unwrap()
        })
        .collect();
    println!("conditions {conditions:.1?}");
    assert!(conditions[0] < 100.0 && conditions.iter().all(|c| *c < 1e6));

    let ramp = Span::from_millis(120);
    let inside = |s: &AngleSample| whole.start + ramp < s.host && s.host + ramp < whole.end;
    let cruise: Vec<_> = samples.into_iter().filter(inside).collect();
    let (first, last) = (cruise[0], *cruise.last().unwrap());
    let sweep = Sweep {
        from: first.angle,
        to: last.angle,
        start: first.host,
        end: last.host,
        ..whole
    };
    for method in methods() {
        let trajectory = through(cruise.clone(), sweep, method);
        let worst = REFERENCE.worst_deg(&trajectory, &sweep, TODAY);
        assert!(
            is_regularised_or_conditioned(&trajectory),
            "{method:?}: {:?}",
            trajectory.fits()
        );
        let bound = trajectory.bound_deg(&[(sweep.start, sweep.end)]);
        assert!(worst <= bound, "{method:?}: {worst}, bound {bound}");
        if method.is_none() {
            assert!(worst < 0.003, "{worst} by {:?}", trajectory.fits());
        }
    }
}

/// Three samples within a sweep: fewer than a motion has parameters.
#[test]
fn a_sweep_of_three_samples_is_interpolated() {
    let sweep = REFERENCE.sweep(TODAY);
    let samples = REFERENCE.polls(TODAY, 3.0, 0.5e-3);
    let inside = samples
        .iter()
        .filter(|s| sweep.start < s.host && s.host < sweep.end);
    assert_eq!(inside.count(), 3);
    for method in methods() {
        let trajectory = through(samples.clone(), sweep, method);
        let worst = REFERENCE.worst_deg(&trajectory, &sweep, TODAY);
        assert!(
            is_regularised_or_conditioned(&trajectory),
            "{method:?}: {:?}",
            trajectory.fits()
        );
        // At worst half of the distance between two samples.
        assert!(worst < 56.25 / 3.0, "{method:?}: {worst}");
        let bound = trajectory.bound_deg(&[(sweep.start, sweep.end)]);
        assert!(worst <= bound, "{method:?}: {worst}, bound {bound}");
    }
}

/// Samples with equal stamps, from a coarse clock or one read buffer. Differences of time are
/// divisors.
#[test]
fn samples_of_identical_times_are_handled() {
    let sweep = REFERENCE.sweep(TODAY);
    let samples = REFERENCE.polls(TODAY, 400.0, 0.2e-3);
    // In pairs whose second sample is late by a poll and disagrees.
    let mut pairs = samples.clone();
    for pair in pairs.chunks_mut(2) {
        let host = pair[0].host;
        pair.iter_mut().for_each(|s| s.host = host);
    }
    // All samples at one instant.
    let mut instant = samples;
    instant.iter_mut().for_each(|s| s.host = sweep.start);
    for method in methods() {
        let best = through(pairs.clone(), sweep, method);
        let worst = REFERENCE.worst_deg(&best, &sweep, TODAY);
        assert!(worst < 0.3, "{method:?}: {worst}");
        assert!(
            is_regularised_or_conditioned(&best),
            "{method:?}: {:?}",
            best.fits()
        );
        let one = through(instant.clone(), sweep, method);
        assert!(one.angle(at(sweep.start)).unwrap().0.is_finite());
        assert!(one.angle(at(sweep.start + Span::from_nanos(1))).is_none());
        assert!(one.bound_deg(&[(sweep.start, sweep.end)]).is_finite());
    }
}

/// A rotation accumulated step by step drifts: in f32 quaternions by thousandths of a degree over
/// the 2e5 firings of a slow scan. Here each tilt follows from its own angle.
#[test]
fn tilts_do_not_drift_over_a_slow_scan() {
    const STEPS: u32 = 200_000;
    let step_deg = -45.0 / f64::from(STEPS);
    // About one axis a quaternion is a complex number.
    let half = (step_deg / 2.0).to_radians();
    let (step_sin, step_cos) = (half.sin() as f32, half.cos() as f32);
    let (mut sin, mut cos) = (0.0_f32, 1.0_f32);
    let mount = Mount::new(Metres(0.06));
    let mut worst_m = 0.0_f64;
    for k in 1..=STEPS {
        (sin, cos) = (
            sin * step_cos + cos * step_sin,
            cos * step_cos - sin * step_sin,
        );
        let gamma = Degrees(step_deg * f64::from(k));
        // As in the placement of a block: from the angle at its beginning, a fraction of a degree
        // ahead.
        let block = Tilt::new(Degrees(gamma.0 - 0.005));
        let ahead = block.ahead(0.005_f64.to_radians());
        let point = [60.0, 20.0, -70.0];
        let (near, exact) = (
            mount.place(point, ahead),
            mount.place(point, Tilt::new(gamma)),
        );
        for (a, b) in near.iter().zip(exact) {
            worst_m = worst_m.max((a - b).abs());
        }
    }
    let by_steps = 2.0 * f64::from(sin).atan2(f64::from(cos)).to_degrees();
    println!("drift {:.4} deg, {worst_m:.1e} m", by_steps + 45.0);
    assert!((by_steps + 45.0).abs() > 0.001, "{by_steps}");
    assert!(worst_m < 1e-9, "{worst_m}");
}
