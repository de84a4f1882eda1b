//! Mechanism: backlash between gear and platform. The platform stands until the gear crosses the
//! play, then follows on its other side.
//!
//! It starts in the middle of the play. The encoder on the motor shaft does not see it. Elasticity
//! and gravity are not included.

use crate::effects::{AxisAngles, MechanismEffect};
use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};

/// `[effects.backlash]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct BacklashSettings {
    /// The whole play at the platform, degrees.
    pub play_deg: f64,
}

/// The play, and the platform's last position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backlash {
    half_deg: f64,
    left_deg: Option<f64>,
}

impl Backlash {
    /// With these settings.
    ///
    /// # Errors
    /// [`InvalidSetting`] for a play outside 0 to 10 degrees.
    pub fn new(settings: &BacklashSettings) -> Result<Self, InvalidSetting> {
        let play_deg =
            SettingCheck(Self::NAME).within("play_deg", settings.play_deg, 0.0..=10.0)?;
        Ok(Self {
            half_deg: 0.5 * play_deg,
            left_deg: None,
        })
    }
}

effect! {
    Backlash, BacklashSettings, mechanism: Box, "backlash",
    idle: "the axis never moves, or there is no play",
    new: |settings, _| Backlash::new(settings)
}

impl MechanismEffect for Backlash {
    fn step(&mut self, _: f64, axis: &mut AxisAngles) -> bool {
        let gear_deg = axis.platform_deg;
        let left_deg = self.left_deg.unwrap_or(gear_deg);
        let (low, high) = (gear_deg - self.half_deg, gear_deg + self.half_deg);
        let platform_deg = left_deg.max(low).min(high);
        self.left_deg = Some(platform_deg);
        axis.platform_deg = platform_deg;
        platform_deg != gear_deg
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::at;

    #[test]
    fn the_platform_lags_by_half_the_backlash_in_either_direction() {
        let mut backlash = Backlash::new(&BacklashSettings { play_deg: 0.2 }).unwrap();
        let mut platform = |gear: f64| {
            let mut axis = at(gear);
            backlash.step(0.0, &mut axis);
            assert_eq!(axis.shaft_deg, gear);
            axis.platform_deg
        };
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        near(platform(0.0), 0.0);
        near(platform(0.05), 0.0);
        near(platform(1.0), 0.9);
        near(platform(0.85), 0.9);
        near(platform(0.7), 0.8);
        near(platform(1.0), 0.9);
        assert!(Backlash::new(&BacklashSettings { play_deg: -0.1 }).is_err());
    }
}
