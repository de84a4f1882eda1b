//! Study of the angle between polls: interpolation method, poll rate, and accuracy of the polls'
//! times.

use std::hint::black_box;

use analysis::plan::TiltSweep;
use analysis::tradeoff::{
    Bench, Row, SeededNoise, Study, StudyError, StudyFindings, StudyRows, TimedChoice, Trade,
};
use scanner::AngleSample;
use scanner::clock::Moment;
use scanner::sweeps::{Commanded, Sweep};
use scanner::trajectory::{Method, Trajectory};
use units::{DegPerS, DegPerS2, Degrees, Host, Span, Stamp};

/// The study.
pub(crate) const TRAJECTORIES: Study = Study {
    name: "trajectory",
    title: "The angle between polls",
    choice: "polls, method",
    // The worst errors are those of `CIRCUMSTANCES`.
    columns: &[
        ("time_ms_per_sweep", "ms per sweep"),
        ("worst_ideal_deg", "worst, ideal polls, deg"),
        ("worst_jitter_0_1_ms_deg", "worst, 0.1 ms jitter, deg"),
        ("worst_jitter_0_5_ms_deg", "worst, 0.5 ms jitter, deg"),
        ("worst_servo_deg", "worst, 0.1 ms and servo, deg"),
        (
            "worst_underdamped_deg",
            "worst, 0.1 ms and underdamped servo, deg",
        ),
        ("worst_latch_deg", "worst, 0.1 ms and latch, deg"),
    ],
    trades: &[
        Trade::new(0, 1).down_to(LEAST_DEG),
        Trade::new(0, 2),
        Trade::new(0, 3),
        Trade::new(0, 4),
        Trade::new(0, 5),
        Trade::new(0, 6),
    ],
    finding,
    measure,
};

/// A fifteenth of the encoder's step: 0.03 mm at 20 m.
const LEAST_DEG: f64 = 1e-4;

const RATES_HZ: [(f64, &str); 3] = [
    (50.0, "50 polls a second"),
    (200.0, "200 polls a second"),
    (1000.0, "1000 polls a second"),
];
/// The paper's fast scan with the drive's factory ramps.
const SWEEP: TiltSweep = TiltSweep {
    from_deg: 0.0,
    to_deg: -45.0,
    speed_deg_s: 56.25,
    accel_deg_s2: 500.0,
};
/// An encoder of 500 lines behind 120:1.
const QUANTUM_DEG: f64 = 0.0015;
const EPOCH: Stamp<Host> = Stamp::from_nanos(1_700_002_800_000_000_000);
/// Rest before and after the sweep, seconds.
const BEFORE_S: f64 = 0.2;
const AFTER_S: f64 = 0.4;
/// Settling time of a servo after the commanded end.
const SETTLING_S: f64 = 0.1;
/// Duration of a VLP-16 block.
const BLOCK_S: f64 = 110.592e-6;
/// Step of the servo simulation.
const STEP_S: f64 = 10e-6;
/// Natural frequency of the servo, Hz, and its damping, good and poor.
const SERVO_HZ: f64 = 15.0;
const DAMPED: f64 = 0.8;
const UNDERDAMPED: f64 = 0.5;
/// Control cycle of a drive that renews its position once in each.
const CYCLE_S: f64 = 1e-3;
/// Largest error of a stamp in standard deviations.
const MOST_SD: f64 = 4.0;

/// Smallest distance of the stamps of two polls, as a share of the poll period.
const NEAREST: f64 = 0.1;
/// A poll is at most this late: the host runs other programs.
const LATEST_POLL_S: f64 = 1e-3;

/// Properties of drive and polls.
#[derive(Clone, Copy, Debug)]
struct PollingCase {
    /// Standard deviation of a poll's time, seconds.
    jitter_s: f64,
    /// Step of the encoder, degrees; 0 for none.
    quantum_deg: f64,
    /// Damping of the servo that follows the commanded motion; `None` if the axis follows exactly.
    servo: Option<f64>,
    /// Whether the drive renews its position once per [`CYCLE_S`].
    latch: bool,
}

const IDEAL: PollingCase = PollingCase {
    jitter_s: 0.0,
    quantum_deg: 0.0,
    servo: None,
    latch: false,
};
/// The case that is timed.
const USUAL: PollingCase = PollingCase {
    jitter_s: 0.1e-3,
    quantum_deg: QUANTUM_DEG,
    ..IDEAL
};
const CIRCUMSTANCES: [PollingCase; 6] = [
    IDEAL,
    USUAL,
    PollingCase {
        jitter_s: 0.5e-3,
        ..USUAL
    },
    PollingCase {
        servo: Some(DAMPED),
        ..USUAL
    },
    PollingCase {
        servo: Some(UNDERDAMPED),
        ..USUAL
    },
    PollingCase {
        latch: true,
        ..USUAL
    },
];

fn measure(bench: &mut Bench<'_>) -> Result<StudyRows, StudyError> {
    let seeds = bench.pick(1, 8);
    let plan = bench.plan(&format!("{seeds} runs of each"), 3, 15);
    let stiff = shaft(None);
    let mut choices = Vec::new();
    for (hz, group) in RATES_HZ {
        for method in Method::ALL {
            let mut worst = Vec::new();
            for circumstance in CIRCUMSTANCES {
                let shaft = shaft(circumstance.servo);
                worst.push(worst_deg(&shaft, hz, circumstance, method, seeds)?);
            }
            let samples = polls(&stiff, hz, USUAL, 1);
            let name = format!("{hz} Hz, {}", method.name());
            choices.push(TimedChoice {
                row: Row::new(name, method.name(), group, worst),
                scale: 1e3,
                work: Box::new(move || {
                    let trajectory = through(black_box(samples.clone()), USUAL, method)?;
                    for at in blocks() {
                        black_box(trajectory.angle(at));
                    }
                    Ok(())
                }),
            });
        }
    }
    Ok((about(seeds), bench.rows(plan, choices)?))
}

/// The curve of the commanded motion and straight lines, at the middle rate.
fn finding(findings: &StudyFindings) -> String {
    const JITTER: usize = 2;
    let worst_deg = |method: Method| findings.value(&format!("200 Hz, {}", method.name()), JITTER);
    format!(
        "From 200 polls a second, each 0.1 ms off, the commanded motion is fitted within {:.4} deg; straight lines err by {:.3} deg",
        worst_deg(Method::Profile),
        worst_deg(Method::Linear),
    )
}

fn about(seeds: u64) -> Vec<String> {
    vec![
        format!(
            "A sweep of 45 degrees at 56.25 deg/s with ramps of 500 deg/s2. The error is that of the worst block, averaged \
             over {seeds} runs; 0.01 degrees are 1.7 mm at 10 m. The time is for fitting the curve and evaluating it at each \
             block."
        ),
        format!(
            "Ideal polls are exact; others have the encoder's steps of {QUANTUM_DEG} degrees and times known to 0.1 or 0.5 ms \
             (one standard deviation). The axis moves as commanded, or as a second-order servo ({SERVO_HZ} Hz, damping \
             {DAMPED} or {UNDERDAMPED}). With latch, the drive renews its position once per millisecond; no single poll shows \
             the average delay, half of that."
        ),
    ]
}

/// The true angle, degrees, every [`STEP_S`].
fn shaft(servo: Option<f64>) -> Vec<f64> {
    let pace = SERVO_HZ * std::f64::consts::TAU;
    let end_s = BEFORE_S + SWEEP.duration_s() + AFTER_S;
    let (mut at, mut rate) = (0.0, 0.0);
    let steps = 0..(end_s / STEP_S).ceil() as u32;
    steps
        .map(|k| {
            let asked = SWEEP.angle_deg(f64::from(k) * STEP_S - BEFORE_S);
            if let Some(damping) = servo {
                rate += (pace * pace * (asked - at) - 2.0 * damping * pace * rate) * STEP_S;
                at += rate * STEP_S;
            } else {
                at = asked;
            }
            at
        })
        .collect()
}

/// The true angle at an instant, interpolated linearly.
fn truth_deg(shaft: &[f64], t_s: f64) -> f64 {
    let place = (t_s / STEP_S).max(0.0);
    let before = place as usize;
    let at = |i: usize| shaft.get(i).or(shaft.last()).copied().unwrap_or(0.0);
    at(before) + (at(before + 1) - at(before)) * (place - before as f64)
}

fn polls(shaft: &[f64], hz: f64, circumstance: PollingCase, seed: u64) -> Vec<AngleSample> {
    let PollingCase {
        jitter_s,
        quantum_deg,
        latch,
        ..
    } = circumstance;
    let mut noise = SeededNoise(seed);
    let end_s = BEFORE_S + SWEEP.duration_s() + AFTER_S - 0.01;
    // No poll falls on a corner of the motion.
    let begin_s = 0.01 + noise.uniform() / hz;
    let mut last_s = 0.0_f64;
    (0..)
        .map(|i| begin_s + f64::from(i) / hz)
        .take_while(|t_s| *t_s < end_s)
        .map(|due_s| {
            // A host that stamps late polls late, too, and not in step with a drive's cycle.
            let t_s = match jitter_s {
                0.0 => due_s,
                _ => due_s + LATEST_POLL_S * noise.uniform(),
            };
            let taken_s = match latch {
                true => (t_s / CYCLE_S).floor() * CYCLE_S,
                false => t_s,
            };
            let truth = truth_deg(shaft, taken_s);
            let angle = match quantum_deg {
                0.0 => truth,
                quantum => (truth / quantum).floor() * quantum,
            };
            let off_s = jitter_s * noise.normal().clamp(-MOST_SD, MOST_SD);
            // A poll ends before the next begins, even if its stamp is late.
            last_s = (t_s + off_s).max(last_s + NEAREST / hz);
            AngleSample {
                host: after(last_s),
                bound: Span::from_secs_f64(MOST_SD * jitter_s),
                angle: Degrees(angle),
            }
        })
        .collect()
}

fn after(t_s: f64) -> Stamp<Host> {
    EPOCH.saturating_add(Span::from_secs_f64(t_s))
}

fn through(
    samples: Vec<AngleSample>,
    circumstance: PollingCase,
    method: Method,
) -> Result<Trajectory, StudyError> {
    let sweep = Sweep {
        from: Degrees(0.0),
        to: Degrees(SWEEP.to_deg),
        cruise: DegPerS(-SWEEP.speed_deg_s),
        start: after(BEFORE_S),
        end: after(BEFORE_S + SWEEP.duration_s() + SETTLING_S),
        commanded: Commanded {
            speed: DegPerS(SWEEP.speed_deg_s),
            acceleration: DegPerS2(SWEEP.accel_deg_s2),
            deceleration: DegPerS2(SWEEP.accel_deg_s2),
        },
    };
    let quantum = Degrees(circumstance.quantum_deg);
    Trajectory::through(samples, quantum, &[sweep], Some(method))
        .ok_or_else(|| StudyError::workload("polls that make no trajectory"))
}

/// The times of the blocks from the start of the sweep until it has settled.
fn blocks() -> impl Iterator<Item = Moment> {
    block_times_s().map(|t_s| Moment {
        host: after(t_s),
        rest_ns: 0.0,
    })
}

fn block_times_s() -> impl Iterator<Item = f64> {
    let end_s = BEFORE_S + SWEEP.duration_s() + SETTLING_S;
    let times = (0..).map(|k| BEFORE_S + f64::from(k) * BLOCK_S);
    times.take_while(move |t_s| *t_s < end_s)
}

fn worst_deg(
    shaft: &[f64],
    hz: f64,
    circumstance: PollingCase,
    method: Method,
    seeds: u64,
) -> Result<f64, StudyError> {
    let mut sum = 0.0;
    for seed in 1..=seeds {
        let samples = polls(shaft, hz, circumstance, seed);
        let trajectory = through(samples, circumstance, method)?;
        let errors = blocks().zip(block_times_s()).map(|(at, t_s)| {
            let angle = trajectory.angle(at).map_or(f64::INFINITY, |angle| angle.0);
            (angle - truth_deg(shaft, t_s)).abs()
        });
        sum += errors.fold(0.0, f64::max);
    }
    Ok(sum / seeds as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worst errors of such a sweep in degrees, computed independently (numpy) with another seed
    /// and other phases of the polls, which affect the ramps.
    #[test]
    fn errors_are_those_of_an_independent_computation() {
        let stiff = shaft(None);
        let [ideal, tenth, half, ..] = CIRCUMSTANCES;
        for (hz, circumstance, method, expected_deg) in [
            (50.0, ideal, Method::Nearest, 0.56),
            (50.0, ideal, Method::Linear, 0.025),
            (200.0, ideal, Method::Nearest, 0.14),
            (200.0, ideal, Method::Linear, 0.0016),
            (1000.0, ideal, Method::Nearest, 0.028),
            (1000.0, ideal, Method::Linear, 6.3e-5),
            (200.0, tenth, Method::Linear, 0.017),
            (200.0, half, Method::Linear, 0.085),
            (200.0, tenth, Method::Profile, 0.0016),
            (200.0, half, Method::Profile, 0.0076),
        ] {
            let got_deg = worst_deg(&stiff, hz, circumstance, method, 3).unwrap();
            let case = format!("{hz} Hz, {}, {circumstance:?}", method.name());
            let ratio = got_deg / expected_deg;
            assert!(
                (0.4..1.5).contains(&ratio),
                "{case}: {got_deg} {expected_deg}"
            );
        }
        let exact = worst_deg(&stiff, 200.0, ideal, Method::Profile, 1).unwrap();
        assert!(exact < 1e-6, "{exact}");
    }

    #[test]
    fn a_lagging_servo_arrives() {
        let (stiff, soft) = (shaft(None), shaft(Some(DAMPED)));
        // The lag in the cruise is 2 damping / w: 56.25 x 2 x 0.8 / 94.2 = 0.955 degrees.
        let lag = truth_deg(&soft, 0.7) - truth_deg(&stiff, 0.7);
        let expected = 56.25 * 2.0 * DAMPED / (SERVO_HZ * std::f64::consts::TAU);
        assert!((lag - expected).abs() < 0.01, "{lag} {expected}");
        assert!((soft.last().unwrap() + 45.0).abs() < 1e-6);
    }
}
