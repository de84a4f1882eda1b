//! Methods against known motions.

use super::*;

mod choice;
mod realistic;
mod simulated_drive;

fn at(ns: i64, angle: f64) -> AngleSample {
    AngleSample {
        host: Stamp::from_nanos(ns),
        bound: Span::ZERO,
        angle: Degrees(angle),
    }
}

fn at_once(ns: i64) -> Moment {
    Moment {
        host: Stamp::from_nanos(ns),
        rest_ns: 0.0,
    }
}

fn joined(samples: Vec<AngleSample>, method: Method) -> Option<Trajectory> {
    Trajectory::through(samples, Degrees(0.0), &[], Some(method))
}

#[test]
fn linear_interpolation_passes_through_its_samples() {
    let linear = joined(vec![at(10, 1.0), at(0, 0.0), at(30, -1.0)], Method::Linear).unwrap();
    let angle = |ns| linear.angle(at_once(ns)).map(|a| a.0);
    assert_eq!(angle(0), Some(0.0));
    assert_eq!(angle(5), Some(0.5));
    assert_eq!(angle(20), Some(0.0));
    assert_eq!(angle(30), Some(-1.0));
}

#[test]
fn no_method_extrapolates() {
    for method in [Method::Nearest, Method::Linear, Method::Hermite] {
        let two = joined(vec![at(0, 0.0), at(10, 1.0)], method).unwrap();
        assert_eq!(two.angle(at_once(-1)), None);
        assert_eq!(two.angle(at_once(11)), None);
        assert!(two.angle(at_once(0)).is_some() && two.angle(at_once(10)).is_some());
        assert!(joined(Vec::new(), method).is_none());
        let one = joined(vec![at(3, 2.0)], method).unwrap();
        assert_eq!(one.angle(at_once(3)), Some(Degrees(2.0)));
        assert_eq!(one.angle(at_once(4)), None);
    }
}

#[test]
fn identical_timestamps_do_not_divide_by_zero() {
    for method in [Method::Nearest, Method::Linear, Method::Hermite] {
        let twice = joined(vec![at(0, 0.0), at(0, 9.0), at(10, 1.0)], method).unwrap();
        let angle = twice.angle(at_once(4)).unwrap().0;
        assert!((0.0..=1.0).contains(&angle), "{method:?}: {angle}");
    }
}

#[test]
fn the_bound_contains_slow_polls_and_gaps() {
    let all = [(Stamp::from_nanos(0), Stamp::from_nanos(1_000_000_000))];
    let moving = |holes: &[i64], bound_us: i64| {
        let samples = (0..100)
            .filter(|i| !holes.contains(i))
            .map(|i| AngleSample {
                bound: Span::from_micros(bound_us),
                ..at(
                    i * 1_000_000,
                    0.05 * f64::from(i32::try_from(i - 50).unwrap().max(0)),
                )
            });
        joined(samples.collect(), Method::Linear)
            .unwrap()
            .bound_deg(&all)
    };
    // At 50 deg/s, 1 ms of uncertainty and 1 ms of age are 0.1 deg; the change from rest to 50
    // deg/s within a millisecond, or within 11 ms, is 50 x 0.011 / 4.
    assert!((moving(&[], 1_000) - (0.1 + 0.0125)).abs() < 1e-3);
    let hole: Vec<i64> = (45..55).collect();
    assert!((moving(&hole, 0) - 50.0 * 0.011 / 4.0).abs() < 1e-3);
    // The line from 44 to 55 ms is wrong where the axis set off, at 50 ms.
    assert!(moving(&hole, 0) >= 50.0 * 5e-3 * 6.0 / 11.0);
    assert!(moving(&[], 0) < 0.02);
}

#[test]
fn leave_one_out_detects_noise_but_not_uniform_motion() {
    let all = [(Stamp::from_nanos(0), Stamp::from_nanos(1_000))];
    let smooth = (0..100).map(|i| at(i * 10, i as f64)).collect();
    let rms = joined(smooth, Method::Linear).unwrap().rms_deg(&all);
    assert!(rms.unwrap() < 1e-12);
    let noisy = (0..100)
        .map(|i| at(i * 10, i as f64 + if i % 2 == 0 { 0.1 } else { -0.1 }))
        .collect();
    let rms = joined(noisy, Method::Linear).unwrap().rms_deg(&all);
    assert!((rms.unwrap() - 0.2).abs() < 1e-9);
}

/// Jitter may bring two stamps together; the speed between them is then arbitrary.
#[test]
fn cubics_stay_between_samples_of_close_stamps() {
    let samples = vec![
        at(0, 0.0),
        at(1_000_000, 1.0),
        at(1_000_010, 1.5),
        at(2_000_000, 2.0),
    ];
    let cubic = joined(samples.clone(), Method::Hermite).unwrap();
    for pair in samples.windows(2) {
        let (from, to) = (pair[0].host.as_nanos(), pair[1].host.as_nanos());
        for k in 0..=10 {
            let angle = cubic.angle(at_once(from + (to - from) * k / 10)).unwrap().0;
            assert!(
                (pair[0].angle.0 - 1e-9..=pair[1].angle.0 + 1e-9).contains(&angle),
                "{angle}"
            );
        }
    }
}
