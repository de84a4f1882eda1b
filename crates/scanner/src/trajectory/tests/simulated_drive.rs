//! A realistic drive: a servo of second order at 15 Hz, gear ripple that its encoder does not see,
//! polls of 0.8 to 2.5 ms with spikes, an encoder of 0.0015 degrees.

use super::*;
use crate::sweeps::Commanded;
use units::{DegPerS, DegPerS2};

pub const EPOCH: i64 = 1_795_000_000_000_000_000;
pub const QUANTUM: f64 = 0.0015;
pub const STEP_S: f64 = 10e-6;

/// A reproducible stream of numbers in 0..1 (xorshift64*).
pub struct Noise(pub u64);
impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Properties of a drive and its polls.
#[derive(Clone, Copy)]
pub struct Drive {
    pub speed: f64,
    pub acceleration: f64,
    pub way: f64,
    /// Natural frequency and damping of the servo; `None` if it follows at once.
    pub servo: Option<(f64, f64)>,
    pub ripple_deg: f64,
    pub hertz: f64,
    pub round_trip_s: (f64, f64),
    pub spikes: f64,
    pub seed: u64,
    pub disturbance: Disturbance,
    /// Whether the position is renewed once per millisecond of a drive that is 30 ppm fast.
    pub latch: bool,
}

/// What a hand or an obstacle does to the head; the servo goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Disturbance {
    None,
    /// Held for so many seconds.
    Held(f64),
    /// Moved by so many degrees at once.
    Slipped(f64),
    /// Set to another speed by so many degrees per second at once.
    Jerked(f64),
    /// Pushed with so many degrees per second squared for a fiftieth of a second.
    Bumped(f64),
}

pub const REFERENCE: Drive = Drive {
    speed: 56.25,
    acceleration: 500.0,
    way: -45.0,
    servo: Some((15.0, 0.8)),
    ripple_deg: 0.003,
    hertz: 400.0,
    round_trip_s: (0.8e-3, 2.5e-3),
    spikes: 0.02,
    seed: 1,
    disturbance: Disturbance::None,
    latch: false,
};

pub struct Run {
    /// Shaft angle every [`STEP_S`].
    pub shaft: Vec<f64>,
    pub samples: Vec<AngleSample>,
    pub sweep: Sweep,
    pub ripple_deg: f64,
}

impl Drive {
    fn demand(&self, t: f64) -> f64 {
        let t = t - 0.2;
        let way = self.way.abs();
        let up = (self.speed / self.acceleration).min((way / self.acceleration).sqrt());
        let speed = up * self.acceleration;
        let brake = way / speed;
        let ramp = |t: f64| {
            if t <= 0.0 {
                0.0
            } else if t < up {
                t * t / 2.0 / up
            } else {
                t - up / 2.0
            }
        };
        speed * (ramp(t) - ramp(t - brake)) * self.way.signum()
    }

    pub fn run(&self) -> Run {
        let up = (self.speed / self.acceleration).min((self.way.abs() / self.acceleration).sqrt());
        let duration = self.way.abs() / (up * self.acceleration) + up;
        let end = 0.2 + duration + 0.4;
        let (mut at, mut rate, mut shaft) = (0.0, 0.0, Vec::new());
        // A third of the way.
        let struck = 0.2 + duration / 3.0;
        for k in 0..(end / STEP_S) as usize {
            let t = k as f64 * STEP_S;
            let demand = self.demand(t);
            let is_instant = (t - struck).abs() < STEP_S / 2.0;
            match self.disturbance {
                Disturbance::Held(s) if t >= struck && t < struck + s => {
                    rate = 0.0;
                    shaft.push(at);
                    continue;
                }
                Disturbance::Slipped(deg) if is_instant => at += deg,
                Disturbance::Jerked(deg_s) if is_instant => rate += deg_s,
                Disturbance::Bumped(deg_s2) if t >= struck && t < struck + 0.02 => {
                    rate += deg_s2 * STEP_S;
                }
                _ => {}
            }
            match self.servo {
                Some((hertz, damping)) => {
                    let w = hertz * std::f64::consts::TAU;
                    rate += (w * w * (demand - at) - 2.0 * damping * w * rate) * STEP_S;
                    at += rate * STEP_S;
                }
                None => at = demand,
            }
            shaft.push(at);
        }
        let mut noise = Noise(self.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        let angle = |t: f64| shaft[((t / STEP_S) as usize).min(shaft.len() - 1)];
        let mut samples = Vec::new();
        let mut t = 0.01;
        while t < end - 0.02 {
            let (least, most) = self.round_trip_s;
            let legs = [(); 2].map(|()| (least + (most - least) * noise.next()) / 2.0);
            let spike = if noise.next() < self.spikes {
                5e-3 * noise.next()
            } else {
                0.0
            };
            let (there, back) = if noise.next() < 0.5 {
                (legs[0] + spike, legs[1])
            } else {
                (legs[0], legs[1] + spike)
            };
            let cycle = 1e-3 * (1.0 - 30e-6);
            let taken = if self.latch {
                ((t + there) / cycle).floor() * cycle
            } else {
                t + there
            };
            let counts = (angle(taken) / QUANTUM).floor();
            let half = (there + back) / 2.0;
            samples.push(AngleSample {
                host: Stamp::from_nanos(EPOCH) + Span::from_secs_f64(t + half),
                bound: Span::from_secs_f64(half),
                angle: Degrees(counts * QUANTUM),
            });
            t += (1.0 / self.hertz).max(there + back);
        }
        let sweep = Sweep {
            from: Degrees(0.0),
            to: Degrees(self.way),
            cruise: DegPerS(self.speed.copysign(self.way)),
            start: Stamp::from_nanos(EPOCH) + Span::from_secs_f64(0.2),
            end: Stamp::from_nanos(EPOCH) + Span::from_secs_f64(0.2 + duration + 0.1),
            commanded: Commanded {
                speed: DegPerS(self.speed),
                acceleration: DegPerS2(self.acceleration),
                deceleration: DegPerS2(self.acceleration),
            },
        };
        Run {
            shaft,
            samples,
            sweep,
            ripple_deg: self.ripple_deg,
        }
    }
}

impl Run {
    /// Greatest difference to the shaft during the sweep, delay included, degrees.
    pub fn worst_with_delay(&self, trajectory: &Trajectory) -> f64 {
        let from = (self.sweep.start - Stamp::from_nanos(EPOCH)).as_secs_f64();
        let to = (self.sweep.end - Stamp::from_nanos(EPOCH)).as_secs_f64();
        let times = (0..).map(|k| from + f64::from(k) * 100e-6);
        let off = times.take_while(|t| *t < to).map(|t| {
            let at = Moment {
                host: Stamp::from_nanos(EPOCH) + Span::from_secs_f64(t),
                rest_ns: 0.0,
            };
            let angle = trajectory.angle(at).unwrap().0;
            (angle - self.shaft[(t / STEP_S) as usize]).abs()
        });
        off.fold(0.0, f64::max)
    }

    /// Greatest and root mean square difference to the platform during the sweep, degrees, after
    /// the best constant delay; and that delay, seconds.
    pub fn error(&self, trajectory: &Trajectory) -> (f64, f64, f64) {
        let truth = |t: f64| {
            let at = self.shaft[(t / STEP_S) as usize];
            // Once per motor revolution.
            at + self.ripple_deg * (at * 120.0).to_radians().sin()
        };
        let from = (self.sweep.start - Stamp::from_nanos(EPOCH)).as_secs_f64();
        let to = (self.sweep.end - Stamp::from_nanos(EPOCH)).as_secs_f64();
        let times: Vec<f64> = (0..)
            .map(|k| from + f64::from(k) * 100e-6)
            .take_while(|t| *t < to)
            .collect();
        let off = |delay: f64| -> Vec<f64> {
            times
                .iter()
                .map(|t| {
                    let at = Moment {
                        host: Stamp::from_nanos(EPOCH) + Span::from_secs_f64(*t),
                        rest_ns: 0.0,
                    };
                    trajectory.angle(at).unwrap().0 - truth(t + delay)
                })
                .collect()
        };
        let rms = |delay: f64| {
            (off(delay).iter().map(|e| e * e).sum::<f64>() / times.len() as f64).sqrt()
        };
        let mut best = 0.0;
        let mut step = 0.5e-3;
        while step > 1e-6 {
            for to in [best - step, best + step] {
                if rms(to) < rms(best) {
                    best = to;
                }
            }
            step /= 1.5;
        }
        let worst = off(best).iter().map(|e| e.abs()).fold(0.0, f64::max);
        (worst, rms(best), best)
    }

    pub fn trajectory(&self, method: Option<Method>) -> Trajectory {
        Trajectory::through(
            self.samples.clone(),
            Degrees(QUANTUM),
            &[self.sweep],
            method,
        )
        .unwrap()
    }
}
