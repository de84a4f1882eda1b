//! Mechanism: [`GearRipple`] in a scene: the platform ahead of and behind the motor's shaft, periodically with its turns.
//!
//! The encoder does not see it. Left out: what [`GearRipple`] leaves out.

use serde::Deserialize;
use units::Degrees;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Asked, Axis, Effect, GearRipple, Listed, Mechanism};

/// `[effects.gear_ripple]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct GearRippleSettings {
    /// The most that the platform is off, degrees.
    pub amplitude_deg: f64,
    /// Periods in a turn of the motor, 1 unless said.
    #[serde(default = "once")]
    pub per_motor_turn: u32,
    /// Where in its period it is at the motor's zero, degrees.
    #[serde(default)]
    pub phase_deg: f64,
    /// Turns of the motor in a turn of the platform, 120 unless said.
    #[serde(default = "rig_gear")]
    pub gear: f64,
}

const fn once() -> u32 {
    1
}

const fn rig_gear() -> f64 {
    120.0
}

/// A gear that is not true.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnevenGear {
    ripple: GearRipple,
    motor_turns_per_deg: f64,
}

impl UnevenGear {
    /// What the scene file calls it.
    pub const NAME: &'static str = "gear_ripple";

    /// With these settings.
    ///
    /// # Errors
    /// [`Unfit`] for numbers out of their range.
    pub fn new(settings: &GearRippleSettings) -> Result<Self, Unfit> {
        let check = Check(Self::NAME);
        let amplitude = check.within("amplitude_deg", settings.amplitude_deg, 0.0..=10.0)?;
        Ok(Self {
            ripple: GearRipple {
                amplitude: Degrees(amplitude),
                per_motor_turn: settings.per_motor_turn,
                phase: Degrees(check.finite("phase_deg", settings.phase_deg)?),
            },
            motor_turns_per_deg: check.within("gear", settings.gear, 1e-3..=1e6)? / 360.0,
        })
    }
}

impl Settings for GearRippleSettings {
    fn ask(&self, _: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Box::new(UnevenGear::new(self)?);
        asked.mechanism.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for UnevenGear {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "its amplitude is 0"
    }
}

impl Mechanism for UnevenGear {
    fn step(&mut self, _: f64, axis: &mut Axis) -> bool {
        let ahead = self.ripple.ahead(axis.shaft_deg * self.motor_turns_per_deg);
        axis.platform_deg += ahead.0;
        ahead.0 != 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::at;

    #[test]
    fn the_platform_is_ahead_by_the_ripple_of_the_shaft() {
        let mut gear = UnevenGear::new(&GearRippleSettings {
            amplitude_deg: 0.01,
            per_motor_turn: 2,
            phase_deg: 0.0,
            gear: 120.0,
        })
        .unwrap();
        // 3 degrees of tilt are a turn of the motor, two periods.
        for (tilt, part) in [(0.0, 0.0), (0.375, 1.0), (1.125, -1.0), (1.5, 0.0)] {
            let mut axis = at(tilt);
            gear.step(0.0, &mut axis);
            assert!((axis.platform_deg - tilt - 0.01 * part).abs() < 1e-12);
            assert_eq!(axis.shaft_deg, tilt);
        }
    }
}
