//! Moves that begin in motion (new targets, halts, new speeds) against an independent closed form
//! in f64.

extern crate std;
use std::vec::Vec;

use proptest::prelude::*;

use super::super::fixed::{FINE_PER_QC, MS, Speed, fine};
use super::super::profile::MotionLimits;
use super::super::ramp::RampShape;
use super::Generator;

const QC_PER_TURN: u32 = 2000;
/// qc/s of one rpm.
const PER_RPM: f64 = QC_PER_TURN as f64 / 60.0;

/// A phase of constant acceleration: seconds, initial speed in qc/s, acceleration in qc/s2.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    t: f64,
    v: f64,
    a: f64,
}

/// The textbook motion: phases in sequence, then constant speed.
struct Textbook {
    from: f64,
    stretches: Vec<Stretch>,
    last: f64,
}

impl Textbook {
    fn at(&self, mut t: f64) -> f64 {
        let mut x = self.from;
        for s in &self.stretches {
            let t_here = t.min(s.t);
            x += s.v * t_here + 0.5 * s.a * t_here * t_here;
            t -= t_here;
        }
        x + self.last * t
    }

    fn duration(&self) -> f64 {
        self.stretches.iter().map(|s| s.t).sum()
    }

    /// From `v0` to `v1` with at most `a` away from zero and `d` towards it.
    fn speed(from: f64, v0: f64, v1: f64, a: f64, d: f64) -> Self {
        let mut stretches = Vec::new();
        let mut v = v0;
        if v0 * v1 < 0.0 {
            stretches.push(Stretch {
                t: v0.abs() / d,
                v: v0,
                a: -v0.signum() * d,
            });
            v = 0.0;
        }
        let rate = if v1.abs() < v.abs() { d } else { a };
        if v1 != v {
            stretches.push(Stretch {
                t: (v1 - v).abs() / rate,
                v,
                a: (v1 - v).signum() * rate,
            });
        }
        Self {
            from,
            stretches,
            last: v1,
        }
    }

    /// To rest at `target`.
    fn target(from: f64, v0: f64, target: f64, vmax: f64, a: f64, d: f64) -> Self {
        let stop = v0 * v0.abs() / (2.0 * d);
        let ahead = (target - from) * v0.signum();
        let (mut stretches, mut x, mut v) = (Vec::new(), from, v0);
        if v0 != 0.0 && ahead < stop.abs() {
            stretches.push(Stretch {
                t: v0.abs() / d,
                v: v0,
                a: -v0.signum() * d,
            });
            (x, v) = (from + stop, 0.0);
        }
        let sign = (target - x).signum();
        let (length, v) = ((target - x).abs(), v.abs());
        let top = ((2.0 * length * a * d + v * v * d) / (a + d))
            .sqrt()
            .min(vmax);
        let rate = if top < v { d } else { a };
        let ramp = (top * top - v * v).abs() / (2.0 * rate);
        let cruise = (length - ramp - top * top / (2.0 * d)).max(0.0);
        stretches.push(Stretch {
            t: (top - v).abs() / rate,
            v: sign * v,
            a: sign * (top - v).signum() * rate,
        });
        if top > 0.0 {
            stretches.push(Stretch {
                t: cruise / top,
                v: sign * top,
                a: 0.0,
            });
        }
        stretches.push(Stretch {
            t: top / d,
            v: sign * top,
            a: -sign * d,
        });
        Self {
            from,
            stretches,
            last: 0.0,
        }
    }
}

fn qc(generator: &Generator) -> f64 {
    generator.position as f64 / FINE_PER_QC as f64
}

/// qc/s.
fn speed(generator: &Generator) -> f64 {
    generator.speed.0 as f64 / MS as f64 / 1000.0 * PER_RPM
}

/// Rates from slow to extreme; a case takes at most some thousand milliseconds.
fn rate() -> impl Strategy<Value = u32> {
    (5u32..31, any::<u32>()).prop_map(|(bits, r)| (1 << bits) | (r & ((1 << bits) - 1)))
}

fn rpm() -> impl Strategy<Value = i32> {
    prop_oneof![1i32..100, 100i32..5_000, Just(25_000)]
}

#[derive(Clone, Copy, Debug)]
struct DemandMotion {
    speed_rpm: i32,
    a: u32,
    d: u32,
}

fn motion() -> impl Strategy<Value = DemandMotion> {
    (rpm(), rate(), rate(), any::<bool>()).prop_map(|(speed_rpm, a, d, same)| DemandMotion {
        speed_rpm,
        a,
        d: if same { a } else { d },
    })
}

impl DemandMotion {
    fn limits(self) -> MotionLimits {
        MotionLimits {
            speed: Speed::from_rpm(self.speed_rpm),
            acceleration: self.a,
            deceleration: self.d,
            shape: RampShape::Linear,
        }
    }

    fn scaled(self) -> [f64; 3] {
        [
            f64::from(self.speed_rpm),
            f64::from(self.a),
            f64::from(self.d),
        ]
        .map(|x| x * PER_RPM)
    }
}

/// A generator that has run for this many milliseconds.
fn running(first: i64, m: DemandMotion, after: usize) -> Generator {
    let mut generator = Generator::new(0, QC_PER_TURN);
    generator.go_to(fine(first), m.limits()).unwrap();
    for _ in 0..after {
        generator.step();
    }
    generator
}

/// Compares with the textbook until some milliseconds after its end, for at most 2 s.
fn follow(generator: &mut Generator, textbook: &Textbook) {
    let ms = (textbook.duration() * 1e3).min(2_000.0) as usize + 3;
    for step in 1..=ms {
        generator.step();
        let expected = textbook.at(step as f64 * 1e-3);
        let off = (qc(generator) - expected).abs();
        assert!(
            off < 0.01,
            "{step} ms: {} instead of {expected}",
            qc(generator)
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn a_new_target_in_motion_matches_the_textbook_profile(
        first in -50_000i64..50_000,
        second in -50_000i64..50_000,
        m in motion(),
        n in motion(),
        after in 0usize..400,
    ) {
        let mut generator = running(first, m, after);
        let [vmax, a, d] = n.scaled();
        let textbook = Textbook::target(qc(&generator), speed(&generator), second as f64, vmax, a, d);
        if generator.go_to(fine(second), n.limits()).is_err() {
            // Only moves longer than 2^31 ms are refused: far past the target at 25,000 rpm, and
            // back at 1 rpm.
            prop_assert!(textbook.duration() > f64::from(1u32 << 31) * 0.999e-3);
            return Ok(());
        }
        follow(&mut generator, &textbook);
        if textbook.duration() < 2.0 {
            prop_assert_eq!(generator.position, fine(second));
            prop_assert!(!generator.is_moving());
        }
    }

    #[test]
    fn a_halt_in_motion_matches_the_textbook_profile(
        first in -50_000i64..50_000,
        m in motion(),
        d in rate(),
        after in 0usize..400,
    ) {
        let mut generator = running(first, m, after);
        let v0 = speed(&generator);
        let textbook = Textbook::speed(qc(&generator), v0, 0.0, 1.0, f64::from(d) * PER_RPM);
        generator.stop(d, RampShape::Linear);
        follow(&mut generator, &textbook);
        prop_assert!(textbook.duration() > 2.0 || !generator.is_moving());
    }

    #[test]
    fn a_new_speed_in_motion_matches_the_textbook_profile(
        first in -50_000i64..50_000,
        m in motion(),
        n in motion(),
        backwards in any::<bool>(),
        after in 0usize..400,
    ) {
        let mut generator = running(first, m, after);
        let rpm = if backwards { -n.speed_rpm } else { n.speed_rpm };
        let [_, a, d] = n.scaled();
        let v1 = f64::from(rpm) * PER_RPM;
        let textbook = Textbook::speed(qc(&generator), speed(&generator), v1, a, d);
        generator.run_at(MotionLimits { speed: Speed::from_rpm(rpm), ..n.limits() });
        follow(&mut generator, &textbook);
    }
}
