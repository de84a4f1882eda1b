//! Mechanism: backlash between gear and platform. The platform stands until the gear crosses the
//! play, then follows on its other side.
//!
//! It starts in the middle of the play. The encoder on the motor shaft does not see it. Elasticity
//! and gravity are not included.

use crate::effects::{AxisAngles, MechanismEffect};
use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};

/// `[effects.backlash]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Backlash {
    /// The whole play at the platform, degrees.
    pub play_deg: f64,
    /// The platform's last position.
    #[serde(skip)]
    left_deg: Option<f64>,
}

impl Backlash {
    /// Checks that the play is within 0 to 10 degrees.
    fn checked(self) -> Result<Self, InvalidSetting> {
        SettingCheck(Self::NAME).within("play_deg", self.play_deg, 0.0..=10.0)?;
        Ok(self)
    }
}

effect! {
    Backlash, Backlash, mechanism: Box, "backlash",
    idle: "the axis never moves, or there is no play",
    new: |backlash, _| backlash.checked()
}

impl MechanismEffect for Backlash {
    fn step(&mut self, _: f64, axis: &mut AxisAngles) -> bool {
        let gear_deg = axis.platform_deg;
        let left_deg = self.left_deg.unwrap_or(gear_deg);
        let half_deg = 0.5 * self.play_deg;
        let (low, high) = (gear_deg - half_deg, gear_deg + half_deg);
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
        let of_play = |play_deg| Backlash {
            play_deg,
            ..Backlash::default()
        };
        let mut backlash = of_play(0.2).checked().unwrap();
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
        assert!(of_play(-0.1).checked().is_err());
    }
}
