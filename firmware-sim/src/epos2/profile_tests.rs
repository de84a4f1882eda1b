//! The profile against an independent closed form in f64, and its exact limits.

extern crate std;

use proptest::prelude::*;

use super::super::fixed::{FINE_PER_QC, MAX_QC_PER_TURN, MS, Speed, WORLD_END, fine};
use super::super::generator::Generator;
use super::super::ramp::RampShape;
use super::{MotionLimits, TrapezoidalProfile, UnusableParameters};

const QC_PER_TURN: u32 = 2000;

fn limits(speed_rpm: i32, acceleration: u32, deceleration: u32) -> MotionLimits {
    MotionLimits {
        speed: Speed::from_rpm(speed_rpm),
        acceleration,
        deceleration,
        shape: RampShape::Linear,
    }
}

/// The textbook trapezoid from rest: position in qc at `t` seconds, and its duration.
struct Textbook {
    from: f64,
    sign: f64,
    length: f64,
    v: f64,
    a: f64,
    d: f64,
}

impl Textbook {
    fn new(from: f64, to: f64, l: MotionLimits, qc_per_turn: u32) -> Self {
        let per_rpm = f64::from(qc_per_turn) / 60.0;
        let a = f64::from(l.acceleration) * per_rpm;
        let d = f64::from(l.deceleration) * per_rpm;
        let v = f64::from(l.speed.to_rpm()) * per_rpm;
        let length = (to - from).abs();
        let v = v.min((2.0 * length * a * d / (a + d)).sqrt());
        Self {
            from,
            sign: (to - from).signum(),
            length,
            v,
            a,
            d,
        }
    }

    fn duration(&self) -> f64 {
        if self.length == 0.0 {
            return 0.0;
        }
        self.v / self.a + self.cruise() + self.v / self.d
    }

    fn cruise(&self) -> f64 {
        (self.length - self.v * self.v / (2.0 * self.a) - self.v * self.v / (2.0 * self.d)) / self.v
    }

    fn at(&self, t: f64) -> f64 {
        let (ta, tc) = (self.v / self.a, self.cruise());
        let left = self.duration() - t;
        let s = if left <= 0.0 {
            self.length
        } else if t < ta {
            0.5 * self.a * t * t
        } else if t < ta + tc {
            self.v * (t - 0.5 * ta)
        } else {
            self.length - 0.5 * self.d * left * left
        };
        self.from + self.sign * s
    }
}

fn qc(position: i64) -> f64 {
    position as f64 / FINE_PER_QC as f64
}

/// Steps a generator to the target and checks each step against the limits; returns the
/// milliseconds it took.
fn run(
    generator: &mut Generator,
    target: i64,
    l: MotionLimits,
    most_ms: usize,
    mut each: impl FnMut(usize, f64),
) -> usize {
    let mut steps = 0;
    // Largest change of position per ms, and of that change per ms; 1 unit each for rounding down,
    // and 2^-32 ms at phase boundaries.
    let top = i128::from(l.speed.0.max(generator.speed.0.abs()));
    let most = ((top * 2 * i128::from(QC_PER_TURN)) >> 32) + 64;
    let steepest = i128::from(l.acceleration.max(l.deceleration));
    let change = (steepest * 2 * i128::from(QC_PER_TURN)) + 128;
    let mut last = None;
    while generator.is_moving() {
        let before = generator.position;
        generator.step();
        steps += 1;
        let moved = i128::from(generator.position - before);
        assert!(moved.abs() <= most, "{moved} > {most} at {steps}");
        if let Some(last) = last {
            let differs: i128 = moved - last;
            assert!(differs.abs() <= change, "{differs} > {change} at {steps}");
        }
        assert!(generator.speed.0.abs() <= top as i64);
        last = Some(moved);
        each(steps, qc(generator.position));
        assert!(steps <= most_ms, "target not reached after {most_ms} ms");
    }
    assert_eq!(generator.position, target);
    assert_eq!(generator.speed, Speed::ZERO);
    steps
}

#[test]
fn the_papers_sweep_takes_912_5_ms_on_the_drive() {
    // 45 deg at 56.25 deg/s (1125 rpm) with a gear of 120:1, 10000 rpm/s: 0.8 s and 0.1125 s of
    // ramp.
    let mut generator = Generator::new(fine(-15_000), QC_PER_TURN);
    let l = limits(1125, 10_000, 10_000);
    generator.go_to(fine(15_000), l).unwrap();
    let mut at_cruise = 0;
    let steps = run(&mut generator, fine(15_000), l, 2000, |ms, position| {
        if ms == 500 {
            // Ramp 0.1125 s at half speed, then 37500 qc/s.
            at_cruise = 1;
            assert!((position - (-15_000.0 + 37_500.0 * (0.5 - 0.05625))).abs() < 1e-6);
        }
    });
    assert_eq!((steps, at_cruise), (913, 1));
}

#[test]
fn no_distance_takes_no_time() {
    let profile =
        TrapezoidalProfile::plan(fine(5), Speed::ZERO, fine(5), limits(1, 1, 1), QC_PER_TURN)
            .unwrap();
    assert_eq!((profile.duration(), profile.at(0)), (0, None));
}

#[test]
fn motions_that_never_end_are_refused() {
    for l in [
        limits(0, 1, 1),
        limits(1, 0, 1),
        limits(1, 1, 0),
        limits(-5, 1, 1),
    ] {
        assert_eq!(
            TrapezoidalProfile::plan(0, Speed::ZERO, fine(1), l, QC_PER_TURN),
            Err(UnusableParameters)
        );
    }
    // The whole range at 1 rpm: 2 years.
    assert_eq!(
        TrapezoidalProfile::plan(
            fine(-(1 << 30)),
            Speed::ZERO,
            fine(1 << 30),
            limits(1, 1, 1),
            QC_PER_TURN
        ),
        Err(UnusableParameters)
    );
}

#[test]
fn degenerate_profiles_are_valid() {
    let most = u32::MAX;
    for (length, l) in [
        (1, limits(1, 1, 1)),            // the smallest values
        (1, limits(25_000, most, most)), // finished in the first millisecond
        (100, limits(1, most, 1)),       // low speed, asymmetric ramps
        (30_000, limits(1, 10, 10)),     // 900 s
        (3, limits(25_000, 1, most)),    // a triangle with a steep deceleration
        (3, limits(25_000, most, 1)),
        (60_000, limits(25_000, most, most)),
    ] {
        for sign in [1, -1] {
            let mut generator = Generator::new(0, QC_PER_TURN);
            generator.go_to(fine(sign * length), l).unwrap();
            let textbook = Textbook::new(0.0, (sign * length) as f64, l, QC_PER_TURN);
            let steps = run(
                &mut generator,
                fine(sign * length),
                l,
                1_000_000,
                |ms, position| {
                    let expected = textbook.at(ms as f64 * 1e-3);
                    assert!(
                        (position - expected).abs() < 1e-3,
                        "{l:?} {ms}: {position} {expected}"
                    );
                },
            );
            // Phases are rounded up to 2^-32 ms, so a whole number of milliseconds may take one
            // more.
            let expected = (textbook.duration() * 1e3 - 1e-6).ceil().max(1.0) as usize;
            assert!(
                steps == expected || steps == expected + 1,
                "{steps} {expected}"
            );
        }
    }
}

fn shape() -> impl Strategy<Value = RampShape> {
    prop_oneof![Just(RampShape::Linear), Just(RampShape::Sin2)]
}

fn any_limits() -> impl Strategy<Value = MotionLimits> {
    // Log-uniform, so that slow and fast are equally likely.
    let power = |bits: u32| {
        (0..=bits, any::<u32>()).prop_map(move |(b, r)| (1u32 << b).max(r & ((2u32 << b) - 1)))
    };
    (power(13), power(30), power(30), any::<bool>())
        .prop_map(|(v, a, d, same)| limits((v as i32).min(25_000), a, if same { a } else { d }))
}

/// A distance that takes some thousand milliseconds with these limits, so that 10,000 cases take
/// seconds.
fn shorten(length: i64, l: MotionLimits) -> i64 {
    let per_rpm = f64::from(QC_PER_TURN) / 60.0;
    let slowest = f64::from(l.acceleration.min(l.deceleration)) * per_rpm;
    let v = f64::from(l.speed.to_rpm()) * per_rpm;
    let in_a_second = v.min(slowest / 4.0) + 1.0;
    length % (4 * in_a_second as i64 + 1)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn profiles_end_exactly_keep_their_limits_and_match_the_textbook(
        from in -1_000_000i64..1_000_000,
        length in -1_000_000i64..=1_000_000,
        l in any_limits(),
    ) {
        let to = from + shorten(length, l);
        let mut generator = Generator::new(fine(from), QC_PER_TURN);
        generator.go_to(fine(to), l).unwrap();
        let textbook = Textbook::new(from as f64, to as f64, l, QC_PER_TURN);
        // All limits are checked at about a hundred instants.
        let every = (textbook.duration() * 10.0) as usize + 1;
        let steps = run(&mut generator, fine(to), l, 1_000_000, |ms, position| {
            if ms % every == 0 {
                let expected = textbook.at(ms as f64 * 1e-3);
                assert!((position - expected).abs() < 1e-3, "{ms}: {position} {expected}");
            }
        });
        let expected = textbook.duration() * 1e3;
        prop_assert!((steps as f64) < expected + 1.001 && steps as f64 > expected - 0.001, "{steps} {expected}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn a_new_target_in_motion_keeps_the_limits(
        first in -100_000i64..100_000,
        second in -100_000i64..100_000,
        l in any_limits(),
        slower in 1i32..25_000,
        after in 0usize..400,
    ) {
        let first = shorten(first, l);
        let second = shorten(second, l);
        let mut generator = Generator::new(0, QC_PER_TURN);
        generator.go_to(fine(first), l).unwrap();
        for _ in 0..after {
            generator.step();
        }
        let l = MotionLimits { speed: l.speed.min(Speed::from_rpm(slower)), ..l };
        generator.go_to(fine(second), l).unwrap();
        run(&mut generator, fine(second), l, 10_000_000, |_, _| {});
    }

    #[test]
    fn a_stop_in_motion_has_the_textbook_braking_distance(
        length in -100_000i64..100_000,
        l in any_limits(),
        after in 0usize..400,
    ) {
        let mut generator = Generator::new(0, QC_PER_TURN);
        generator.go_to(fine(shorten(length, l)), l).unwrap();
        for _ in 0..after {
            generator.step();
        }
        let (from, speed) = (qc(generator.position), generator.speed);
        generator.stop(l.deceleration, l.shape);
        let mut steps = 0u32;
        while generator.is_moving() {
            generator.step();
            steps += 1;
            prop_assert!(steps < 1_000_000);
        }
        let v = speed.0 as f64 / MS as f64 / 1000.0 * f64::from(QC_PER_TURN) / 60.0;
        let d = f64::from(l.deceleration) * f64::from(QC_PER_TURN) / 60.0;
        let expected = from + v * v.abs() / (2.0 * d);
        prop_assert!((qc(generator.position) - expected).abs() < 1e-3);
    }
}

#[derive(Clone, Copy, Debug)]
enum Operation {
    GoTo(i64, MotionLimits),
    RunAt(MotionLimits),
    Steps(u16),
}

fn operation() -> impl Strategy<Value = Operation> {
    let extreme = prop_oneof![any::<u32>(), 0u32..3, Just(u32::MAX)];
    let limits = |slowest: i32| {
        (slowest..=25_000, extreme.clone(), extreme.clone(), shape()).prop_map(
            |(v, a, d, shape)| MotionLimits {
                shape,
                ..limits(v, a, d)
            },
        )
    };
    // Outside the position range: a 32-bit position from an origin equally far away.
    let target = (any::<i32>(), any::<i32>()).prop_map(|(a, b)| fine(i64::from(a) + i64::from(b)));
    prop_oneof![
        (target, limits(0)).prop_map(|(target, limits)| Operation::GoTo(target, limits)),
        limits(-25_000).prop_map(Operation::RunAt),
        (0u16..300).prop_map(Operation::Steps),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn large_numbers_do_not_overflow(
        from in any::<i32>(),
        qc_per_turn in prop_oneof![Just(MAX_QC_PER_TURN), 4..=MAX_QC_PER_TURN],
        operations in prop::collection::vec(operation(), 1..30),
    ) {
        let mut generator = Generator::new(fine(from.into()).clamp(-WORLD_END, WORLD_END), qc_per_turn);
        for operation in operations {
            match operation {
                Operation::GoTo(target, limits) => {
                    let _ = generator.go_to(target, limits);
                }
                Operation::RunAt(limits) => generator.run_at(limits),
                Operation::Steps(n) => {
                    for _ in 0..n {
                        generator.step();
                        prop_assert!(generator.position.abs() <= WORLD_END);
                        prop_assert!(generator.speed.0.abs() <= Speed::from_rpm(25_000).0);
                    }
                }
            }
        }
    }
}

/// A sin2 ramp of `seconds` between two speeds (qc/s): the way after `t` seconds.
fn sin2_way(v0: f64, v1: f64, seconds: f64, t: f64) -> f64 {
    use std::f64::consts::PI;
    v0 * t + (v1 - v0) * (t / 2.0 - seconds / (2.0 * PI) * (PI * t / seconds).sin())
}

#[test]
fn the_papers_sweep_with_sin2_ramps_has_the_peak_acceleration_of_6083() {
    use std::f64::consts::PI;
    let l = MotionLimits {
        shape: RampShape::Sin2,
        ..limits(1125, 10_000, 10_000)
    };
    let (v, a) = (37_500.0, 10_000.0 * 2000.0 / 60.0);
    // The peak acceleration of a sin2 ramp is pi/2 times its mean.
    let ramp = PI / 2.0 * v / a;
    let cruise = 30_000.0 / v - ramp;
    let mut generator = Generator::new(fine(-15_000), QC_PER_TURN);
    generator.go_to(fine(15_000), l).unwrap();
    let (mut last, mut speed, mut steepest) = (-15_000.0, 0.0, 0.0_f64);
    let steps = run(&mut generator, fine(15_000), l, 2_000, |ms, position| {
        let t = ms as f64 * 1e-3;
        let way = if t < ramp {
            sin2_way(0.0, v, ramp, t)
        } else if t < ramp + cruise {
            v * (t - ramp / 2.0)
        } else {
            let left = (2.0 * ramp + cruise - t).max(0.0);
            30_000.0 - sin2_way(0.0, v, ramp, left)
        };
        // Whole rpm/s in the mean: 4e-5 of the ramps.
        assert!(
            (position + 15_000.0 - way).abs() < 0.3,
            "{ms}: {position} {way}"
        );
        let now = (position - last) / 1e-3;
        steepest = steepest.max((now - speed).abs() / 1e-3);
        (last, speed) = (position, now);
    });
    assert!((steepest / a - 1.0).abs() < 1e-3, "{steepest} {a}");
    let expected = (ramp + 30_000.0 / v) * 1e3;
    assert!((steps as f64 - expected).abs() < 1.5, "{steps} {expected}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Targets, halts and speeds in motion have the distance and the duration of the linear ramp of
    /// the same mean acceleration, and keep the peak.
    #[test]
    fn sin2_motions_end_exactly_and_keep_their_peaks(
        first in -100_000i64..100_000,
        second in -100_000i64..100_000,
        l in any_limits(),
        after in 0usize..400,
    ) {
        let sin2 = MotionLimits { shape: RampShape::Sin2, ..l };
        let (first, second) = (shorten(first, l), shorten(second, l));
        let mut generator = Generator::new(0, QC_PER_TURN);
        generator.go_to(fine(first), sin2).unwrap();
        for _ in 0..after {
            generator.step();
        }
        let [a, d] = [l.acceleration, l.deceleration].map(|rate| RampShape::Sin2.mean_rate(rate));
        let mean = MotionLimits { acceleration: a, deceleration: d, ..l };
        let mut linear = generator;
        let mut halted = generator;
        generator.go_to(fine(second), sin2).unwrap();
        linear.go_to(fine(second), mean).unwrap();
        // A mean of 1 rpm/s may stand for a peak of 1 rpm/s: two at most.
        let rates = MotionLimits {
            acceleration: l.acceleration.saturating_mul(2),
            deceleration: l.deceleration.saturating_mul(2),
            ..l
        };
        let steps = run(&mut generator, fine(second), rates, 10_000_000, |_, _| {});
        let expected = run(&mut linear, fine(second), mean, 10_000_000, |_, _| {});
        prop_assert_eq!(steps, expected);
        let mut linear = halted;
        halted.stop(l.deceleration, RampShape::Sin2);
        linear.stop(d, RampShape::Linear);
        while halted.is_moving() {
            prop_assert!(linear.is_moving());
            halted.step();
            linear.step();
        }
        prop_assert!(!linear.is_moving());
        prop_assert!((halted.position - linear.position).abs() < FINE_PER_QC / 1_000);
    }
}
