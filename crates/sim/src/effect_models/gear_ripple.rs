//! Mechanism: [`GearRipple`] in a scene. The encoder does not see it.

use crate::effects::{AxisAngles, MechanismEffect};
use crate::gear_ripple::GearRipple;
use serde::Deserialize;
use units::Degrees;

use super::settings::{InvalidSetting, SettingCheck};

/// `[effects.gear_ripple]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct GearRippleSettings {
    /// Largest deviation of the platform, degrees.
    pub amplitude_deg: f64,
    /// Periods per motor revolution; default 1.
    #[serde(default = "once")]
    pub per_motor_turn: u32,
    /// Phase at the motor's zero, degrees.
    #[serde(default)]
    pub phase_deg: f64,
    /// Motor revolutions per platform revolution; default 120.
    #[serde(default = "rig_gear")]
    pub gear: f64,
}

const fn once() -> u32 {
    1
}

const fn rig_gear() -> f64 {
    120.0
}

/// A gear with ripple.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnevenGear {
    ripple: GearRipple,
    motor_turns_per_deg: f64,
}

impl UnevenGear {
    /// With these settings.
    ///
    /// # Errors
    /// [`InvalidSetting`] for numbers out of range.
    pub fn new(settings: &GearRippleSettings) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
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

effect! {
    UnevenGear, GearRippleSettings, mechanism: Box, "gear_ripple",
    idle: "its amplitude is 0",
    new: |settings, _| UnevenGear::new(settings)
}

impl MechanismEffect for UnevenGear {
    fn step(&mut self, _: f64, axis: &mut AxisAngles) -> bool {
        let ahead = self.ripple.ahead(axis.shaft_deg * self.motor_turns_per_deg);
        axis.platform_deg += ahead.0;
        ahead.0 != 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::at;

    #[test]
    fn the_platform_leads_by_the_ripple_of_the_shaft() {
        let mut gear = UnevenGear::new(&GearRippleSettings {
            amplitude_deg: 0.01,
            per_motor_turn: 2,
            phase_deg: 0.0,
            gear: 120.0,
        })
        .unwrap();
        // 3 degrees of tilt are one motor revolution, two periods.
        for (tilt, part) in [(0.0, 0.0), (0.375, 1.0), (1.125, -1.0), (1.5, 0.0)] {
            let mut axis = at(tilt);
            gear.step(0.0, &mut axis);
            assert!((axis.platform_deg - tilt - 0.01 * part).abs() < 1e-12);
            assert_eq!(axis.shaft_deg, tilt);
        }
    }
}
