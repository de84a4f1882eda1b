//! Mechanism: a linear servo of first or second order that lags behind the command.
//!
//! The command is linear over each step and the first-order response is exact. The simulated drive
//! has the same servo in integers ([`firmware_sim::epos2::Servo`]). Current limits and friction are
//! not included.

use crate::effects::{AxisAngles, MechanismEffect, STEP_S};
use core::f64::consts::TAU;

use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};

/// `[effects.servo_lag]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct ServoLagSettings {
    /// Corner (first order) or natural (second order) frequency, 0.1 to 200 Hz.
    pub frequency_hz: f64,
    /// Damping ratio of the second order, 0.1 to 4; absent: first order.
    #[serde(default)]
    pub damping: Option<f64>,
}

/// A servo in motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoLag {
    rad_s: f64,
    damping: Option<f64>,
    state: Option<State>,
}

/// State of the shaft, and the command at that time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    shaft_deg: f64,
    rate_deg_s: f64,
    commanded_deg: f64,
}

/// Integration steps of the second order per step of the mechanism.
const FINE: u32 = 8;

impl ServoLag {
    /// With these settings.
    ///
    /// # Errors
    /// [`InvalidSetting`] for a frequency or damping out of range.
    pub fn new(settings: &ServoLagSettings) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        let hz = check.within("frequency_hz", settings.frequency_hz, 0.1..=200.0)?;
        let damping = settings.damping;
        let damping = damping.map(|ratio| check.within("damping", ratio, 0.1..=4.0));
        Ok(Self {
            rad_s: TAU * hz,
            damping: damping.transpose()?,
            state: None,
        })
    }

    /// The state after a step in which the command moves linearly to `to_deg`.
    fn follow(&self, from: State, to_deg: f64) -> State {
        let rate = (to_deg - from.commanded_deg) / STEP_S;
        let Some(damping) = self.damping else {
            // x' = w (d - x): the lag behind a ramp approaches rate / w.
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

    /// x'' = w^2 (d - x) - 2 z w x', one step of the fourth-order Runge-Kutta method.
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

effect! {
    ServoLag, ServoLagSettings, mechanism: Box, "servo_lag",
    idle: "the axis never moves",
    new: |settings, _| ServoLag::new(settings)
}

impl MechanismEffect for ServoLag {
    fn step(&mut self, _: f64, axis: &mut AxisAngles) -> bool {
        let to_deg = axis.shaft_deg;
        let state = match self.state {
            Some(from) => self.follow(from, to_deg),
            // At rest at the commanded angle.
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
    use crate::effect_models::testing::at;

    /// The lag behind a ramp is 1/w for the first order and 2 z / w for the second.
    #[test]
    fn the_lag_behind_a_ramp_matches_theory() {
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
                let time_s = f64::from(step) * STEP_S;
                let mut axis = at(-56.25 * time_s);
                servo.step(time_s, &mut axis);
                behind = axis.shaft_deg - axis.commanded_deg;
                assert!((axis.shaft_deg - axis.platform_deg).abs() < 1e-12);
            }
            assert!((behind - 56.25 * lag_s).abs() < 1e-8, "{behind}");
        }
    }

    /// The step response of the first order is exponential (the command takes one step).
    #[test]
    fn a_first_order_servo_approaches_exponentially() {
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
