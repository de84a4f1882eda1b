//! Mechanism: an output wheel off its centre, a deviation of the platform once per turn of the
//! axis.
//!
//! The encoder on the motor shaft does not see it. Over less than a turn it looks like a zero and a
//! scale of the tilt.

use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};
use crate::effects::{AxisAngles, MechanismEffect};

/// `[effects.eccentricity]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Eccentricity {
    /// Greatest deviation, degrees.
    pub amplitude_deg: f64,
    /// Tilt at which the deviation is 0 and grows, degrees.
    #[serde(default)]
    pub zero_deg: f64,
}

impl Eccentricity {
    fn checked(self) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        check.within("amplitude_deg", self.amplitude_deg, 0.0..=10.0)?;
        check.within("zero_deg", self.zero_deg, -360.0..=360.0)?;
        Ok(self)
    }
}

effect! {
    Eccentricity, Eccentricity, mechanism: Box, "eccentricity",
    idle: "its amplitude is 0",
    new: |eccentricity, _| eccentricity.checked()
}

impl MechanismEffect for Eccentricity {
    fn step(&mut self, _: f64, axis: &mut AxisAngles) -> bool {
        let from_zero = (axis.shaft_deg - self.zero_deg).to_radians();
        axis.platform_deg += self.amplitude_deg * from_zero.sin();
        self.amplitude_deg != 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::at;

    #[test]
    fn the_platform_deviates_once_per_turn_of_the_axis() {
        let mut wheel = Eccentricity {
            amplitude_deg: 0.1,
            zero_deg: 10.0,
        }
        .checked()
        .unwrap();
        for (tilt, part) in [(10.0, 0.0), (100.0, 1.0), (-20.0, -0.5), (190.0, 0.0)] {
            let mut axis = at(tilt);
            assert!(wheel.step(0.0, &mut axis));
            assert!((axis.platform_deg - tilt - 0.1 * part).abs() < 1e-12);
            assert_eq!(axis.shaft_deg, tilt);
        }
        let invalid = Eccentricity {
            amplitude_deg: -0.1,
            zero_deg: 0.0,
        };
        assert!(invalid.checked().is_err());
    }
}
