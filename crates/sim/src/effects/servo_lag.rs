//! Mechanism: the servo is behind what is commanded: a linear one of first or second order.
//!
//! The command is a line over each step, and the answer to that is exact, so the step does not show. The software drive has the same servo in
//! integers ([`firmware_sim::epos2::Servo`]). Left out: the current's limits and friction.

use core::f64::consts::TAU;

use serde::Deserialize;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Asked, Axis, Effect, Listed, Mechanism, STEP_S};

/// `[effects.servo_lag]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct ServoLagSettings {
    /// Corner (first order) or natural (second order) frequency, 0.1 to 200 Hz.
    pub frequency_hz: f64,
    /// Damping ratio of a second order, 0.1 to 4; first order without.
    #[serde(default)]
    pub damping: Option<f64>,
}

/// A servo on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoLag {
    rad_s: f64,
    damping: Option<f64>,
    state: Option<State>,
}

/// Where the shaft is, and what was commanded then.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    shaft_deg: f64,
    rate_deg_s: f64,
    commanded_deg: f64,
}

/// Steps of the second order within one of the mechanism.
const FINE: u32 = 8;

impl ServoLag {
    /// What the scene file calls it.
    pub const NAME: &'static str = "servo_lag";

    /// With these settings.
    ///
    /// # Errors
    /// [`Unfit`] for a frequency or damping out of its range.
    pub fn new(settings: &ServoLagSettings) -> Result<Self, Unfit> {
        let check = Check(Self::NAME);
        let hz = check.within("frequency_hz", settings.frequency_hz, 0.1..=200.0)?;
        let damping = match settings.damping {
            Some(damping) => Some(check.within("damping", damping, 0.1..=4.0)?),
            None => None,
        };
        Ok(Self {
            rad_s: TAU * hz,
            damping,
            state: None,
        })
    }

    /// From a command that goes evenly to `to_deg` in a step.
    fn follow(&self, from: State, to_deg: f64) -> State {
        let rate = (to_deg - from.commanded_deg) / STEP_S;
        let Some(damping) = self.damping else {
            // x' = w (d - x): behind a ramp by rate / w, and nearing that.
            let behind = rate / self.rad_s;
            let left = (-self.rad_s * STEP_S).exp();
            let shaft_deg = to_deg - behind + (from.shaft_deg - from.commanded_deg + behind) * left;
            return State {
                shaft_deg,
                rate_deg_s: self.rad_s * (to_deg - shaft_deg),
                commanded_deg: to_deg,
            };
        };
        let step_s = STEP_S / f64::from(FINE);
        let mut state = from;
        for _ in 0..FINE {
            state = self.runge_kutta(state, damping, rate, step_s);
        }
        State {
            commanded_deg: to_deg,
            ..state
        }
    }

    /// x'' = w^2 (d - x) - 2 z w x', a step of fourth order.
    fn runge_kutta(&self, at: State, damping: f64, rate: f64, step_s: f64) -> State {
        let change = |x: f64, v: f64, after_s: f64| {
            let commanded = at.commanded_deg + rate * after_s;
            let pull = self.rad_s * self.rad_s * (commanded - x);
            (v, pull - 2.0 * damping * self.rad_s * v)
        };
        let (x, v, half) = (at.shaft_deg, at.rate_deg_s, 0.5 * step_s);
        let (a, b) = change(x, v, 0.0);
        let (c, d) = change(x + half * a, v + half * b, half);
        let (e, f) = change(x + half * c, v + half * d, half);
        let (g, h) = change(x + step_s * e, v + step_s * f, step_s);
        State {
            shaft_deg: x + step_s / 6.0 * (a + 2.0 * (c + e) + g),
            rate_deg_s: v + step_s / 6.0 * (b + 2.0 * (d + f) + h),
            commanded_deg: at.commanded_deg + rate * step_s,
        }
    }
}

impl Settings for ServoLagSettings {
    fn ask(&self, _: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Box::new(ServoLag::new(self)?);
        asked.mechanism.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for ServoLag {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "the axis never moves"
    }
}

impl Mechanism for ServoLag {
    fn step(&mut self, _: f64, axis: &mut Axis) -> bool {
        let to_deg = axis.shaft_deg;
        let state = match self.state {
            Some(from) => self.follow(from, to_deg),
            // At rest where it is commanded.
            None => State {
                shaft_deg: to_deg,
                rate_deg_s: 0.0,
                commanded_deg: to_deg,
            },
        };
        self.state = Some(state);
        let behind_deg = state.shaft_deg - to_deg;
        axis.shaft_deg = state.shaft_deg;
        axis.platform_deg += behind_deg;
        behind_deg.abs() > 1e-9
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::at;

    /// Both fall behind a ramp by a time that is known: 1/w, and 2 z / w.
    #[test]
    fn behind_a_ramp_by_a_known_time() {
        for (damping, lag_s) in [
            (None, 1.0 / (TAU * 20.0)),
            (Some(0.7), 1.4 / (TAU * 20.0)),
            (Some(2.0), 4.0 / (TAU * 20.0)),
        ] {
            let settings = ServoLagSettings {
                frequency_hz: 20.0,
                damping,
            };
            let mut servo = ServoLag::new(&settings).unwrap();
            let mut behind = 0.0;
            for step in 0..8_000 {
                let at_s = f64::from(step) * STEP_S;
                let mut axis = at(-56.25 * at_s);
                servo.step(at_s, &mut axis);
                behind = axis.shaft_deg - axis.commanded_deg;
                assert!((axis.shaft_deg - axis.platform_deg).abs() < 1e-12);
            }
            assert!((behind - 56.25 * lag_s).abs() < 1e-8, "{behind}");
        }
    }

    /// The step answer of the first order is an exponential (the command takes one step to get there).
    #[test]
    fn first_order_nears_exponentially() {
        let settings = ServoLagSettings {
            frequency_hz: 5.0,
            damping: None,
        };
        let mut servo = ServoLag::new(&settings).unwrap();
        servo.step(0.0, &mut at(0.0));
        servo.step(STEP_S, &mut at(1.0));
        let mut one = at(1.0);
        servo.step(2.0 * STEP_S, &mut one);
        let mut two = at(1.0);
        servo.step(3.0 * STEP_S, &mut two);
        let ratio = (1.0 - two.shaft_deg) / (1.0 - one.shaft_deg);
        assert!((ratio - (-TAU * 5.0 * STEP_S).exp()).abs() < 1e-12);
    }
}
