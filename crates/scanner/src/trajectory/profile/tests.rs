use proptest::prelude::*;

use super::*;

fn reference() -> Profile {
    Profile {
        start_s: 0.1,
        speed_deg_s: -56.25,
        ramp_up_s: 0.1125,
        ramp_down_s: 0.1125,
        from_deg: 0.0,
        way_deg: -45.0,
        lag_s: 0.0,
        inertia_s2: 0.0,
    }
}

#[test]
fn the_reference_sweep_has_the_expected_duration_and_angle() {
    let reference = reference();
    assert!((reference.duration_s() - 0.9125).abs() < 1e-12);
    assert_eq!(reference.angle_deg(0.0), 0.0);
    assert!((reference.angle_deg(2.0) + 45.0).abs() < 1e-12);
    assert!((reference.angle_deg(0.1 + 0.9125 / 2.0) + 22.5).abs() < 1e-12);
    // In the cruise a lag is a delay.
    let slow = Profile {
        lag_s: 0.0106,
        ..reference
    };
    assert!((slow.angle_deg(0.5) - reference.angle_deg(0.5 - 0.0106)).abs() < 1e-3);
}

/// An independent computation: the demand's speed by cases, the servo's differential equation by
/// small steps.
fn stepped(profile: &Profile, until_s: f64) -> f64 {
    let speed = |t: f64| {
        let t = t - profile.start_s;
        let (up, brake) = (profile.ramp_up_s, profile.braking_s());
        let end = brake + profile.ramp_down_s;
        let part = if t <= 0.0 || t >= end {
            0.0
        } else if t < up.min(brake) {
            t / up
        } else if t < brake {
            1.0
        } else {
            (end - t) / profile.ramp_down_s
        };
        profile.speed_deg_s * part
    };
    let step = 1e-6;
    let (mut demand, mut shaft, mut rate) = (profile.from_deg, profile.from_deg, 0.0);
    for k in 0..(until_s / step).round() as i64 {
        let before = demand;
        demand += speed((k as f64 + 0.5) * step) * step;
        if profile.inertia_s2 > 0.0 {
            rate += (0.5 * (before + demand) - shaft - profile.lag_s * rate) / profile.inertia_s2
                * step;
            shaft += rate * step;
        } else if profile.lag_s > 0.0 {
            shaft += (0.5 * (before + demand) - shaft) * -f64::exp_m1(-step / profile.lag_s);
        } else {
            shaft = demand;
        }
    }
    shaft
}

#[test]
fn the_closed_form_agrees_with_stepping_the_servo() {
    for lag_s in [0.0, 1e-3, 0.0106, 0.08] {
        for ramp_up_s in [0.02, 0.1125] {
            let profile = Profile {
                lag_s,
                ramp_up_s,
                ramp_down_s: 0.2,
                ..reference()
            };
            for until in [0.11, 0.15, 0.3, 0.85, 0.95, 1.2] {
                let off = profile.angle_deg(until) - stepped(&profile, until);
                assert!(off.abs() < 2e-4, "{profile:?} at {until}: {off}");
            }
        }
    }
}

/// The derivatives by the servo's parameters, whose closed forms are the least obvious:
/// underdamped, overdamped, and with a double pole.
#[test]
fn derivatives_by_lag_and_inertia_agree_with_differences() {
    for damping in [
        0.1, 0.4, 0.8, 0.999, 0.999_999, 1.0, 1.000_001, 1.001, 1.5, 4.0,
    ] {
        for hertz in [3.0, 15.0, 60.0] {
            let w = hertz * std::f64::consts::TAU;
            let profile = Profile {
                lag_s: 2.0 * damping / w,
                inertia_s2: 1.0 / (w * w),
                ..reference()
            };
            for ms in [
                1, 5, 30, 80, 113, 120, 180, 400, 801, 850, 920, 1_000, 1_500,
            ] {
                let at = profile.start_s + f64::from(ms) * 1e-3;
                let (angle, [.., by_lag, by_inertia]) = profile.with_gradient(at);
                assert!((angle - profile.angle_deg(at)).abs() < 1e-12);
                let by = |change: fn(&mut Profile) -> &mut f64, step: f64| {
                    let angle = |step: f64| {
                        let mut moved = profile;
                        *change(&mut moved) += step;
                        moved.angle_deg(at)
                    };
                    (angle(step) - angle(-step)) / (2.0 * step)
                };
                let case = format!("damping {damping}, {hertz} Hz, {ms} ms");
                let difference = by(|p| &mut p.lag_s, profile.lag_s * 1e-5);
                let off = (by_lag - difference).abs();
                assert!(
                    off < 1e-4 * profile.speed_deg_s.abs(),
                    "{case}: {by_lag} {difference}"
                );
                // By the root of the inertia, as in the fit: also degrees per second.
                let root = profile.inertia_s2.sqrt();
                let difference = by(|p| &mut p.inertia_s2, profile.inertia_s2 * 1e-5);
                let off = 2.0 * root * (by_inertia - difference).abs();
                assert!(
                    off < 1e-4 * profile.speed_deg_s.abs(),
                    "{case}: {by_inertia} {difference}"
                );
            }
        }
    }
}

prop_compose! {
    fn any_profile()(
        start_s in -1.0..1.0f64,
        speed_deg_s in prop_oneof![0.05..100.0f64, -100.0..-0.05f64],
        ramp_up_s in prop_oneof![1e-6..1e-3f64, 1e-3..0.5f64],
        ramp_down_s in prop_oneof![1e-6..1e-3f64, 1e-3..0.5f64],
        from_deg in -180.0..180.0f64,
        cruise_s in 1e-3..900.0f64,
        lag_s in prop_oneof![Just(0.0), 1e-5..0.1f64],
        swings in prop_oneof![Just(0.0), 0.3..3.0f64],
    ) -> Profile {
        let way_deg = speed_deg_s * (cruise_s + (ramp_up_s + ramp_down_s) / 2.0);
        Profile { start_s, speed_deg_s, ramp_up_s, ramp_down_s, from_deg, way_deg, lag_s, inertia_s2: (swings * lag_s).powi(2) }
    }
}

proptest! {
    #[test]
    fn derivatives_agree_with_differences(profile in any_profile(), part in -0.05..1.2f64) {
        // Away from the corners, which a difference would span.
        let at = profile.start_s + part * profile.duration_s();
        let near = profile.corners_s().iter().any(|corner| (corner - at).abs() < 1e-5);
        prop_assume!(!near && profile.ramp_up_s > 1e-4 && profile.ramp_down_s > 1e-4);
        let (angle, gradient) = profile.with_gradient(at);
        prop_assert_eq!(angle, profile.angle_deg(at));
        let h = 1e-6;
        let moved = |change: fn(&mut Profile) -> &mut f64, i: usize| {
            let [mut low, mut high] = [profile; 2];
            *change(&mut low) -= h;
            *change(&mut high) += h;
            let difference = (high.angle_deg(at) - low.angle_deg(at)) / (2.0 * h);
            let off = (difference - gradient[i]).abs();
            off <= 1e-4 * (1.0 + gradient[i].abs() + profile.speed_deg_s.abs() / profile.ramp_up_s.min(profile.ramp_down_s).min(profile.lag_s.max(1e-3)) * 0.1)
        };
        prop_assert!(moved(|p| &mut p.start_s, 0));
        prop_assert!(moved(|p| &mut p.ramp_up_s, 2));
        prop_assert!(moved(|p| &mut p.ramp_down_s, 3));
        prop_assert!(moved(|p| &mut p.from_deg, 4));
        prop_assert!(moved(|p| &mut p.way_deg, 5));
        if profile.lag_s > 1e-5 {
            prop_assert!(profile.inertia_s2 > 0.0 || moved(|p| &mut p.lag_s, 6));
        }
        if at - profile.start_s < 20.0 {
            prop_assert!(moved(|p| &mut p.speed_deg_s, 1));
        }
    }

    #[test]
    fn profiles_rest_before_the_start_and_after_the_end(profile in any_profile()) {
        prop_assert_eq!(profile.angle_deg(profile.start_s - 1.0), profile.from_deg);
        let after = profile.start_s + profile.duration_s() + 40.0 * profile.lag_s.max(20.0 * profile.inertia_s2 / profile.lag_s.max(1e-9)) + 1e-9;
        let end = profile.from_deg + profile.way_deg;
        prop_assert!((profile.angle_deg(after) - end).abs() < 1e-9 + 1e-13 * profile.way_deg.abs());
    }
}
