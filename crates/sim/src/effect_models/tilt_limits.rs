//! Mechanism: mechanical stops of the shaft; the encoder sees them. Bouncing, limit switches and
//! the drive's following error are not included (the simulated drive has the last two).

use crate::effects::{AxisAngles, MechanismEffect};
use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};

/// `[effects.tilt_limits]`: two stops.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct TiltLimits {
    /// The lower stop, degrees of tilt.
    pub from_deg: f64,
    /// The upper stop, not below the lower one.
    pub to_deg: f64,
}

impl TiltLimits {
    /// Checks that the angles are finite and in order.
    fn checked(self) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        check.within("from_deg", self.from_deg, -360.0..=360.0)?;
        check.within("to_deg", self.to_deg, self.from_deg..=360.0)?;
        Ok(self)
    }
}

effect! {
    TiltLimits, TiltLimits, mechanism: Box, "tilt_limits",
    idle: "the motion stays within the stops",
    new: |limits, _| limits.checked()
}

impl MechanismEffect for TiltLimits {
    fn step(&mut self, _: f64, axis: &mut AxisAngles) -> bool {
        let held_deg = axis.shaft_deg.max(self.from_deg).min(self.to_deg);
        let back_deg = held_deg - axis.shaft_deg;
        axis.shaft_deg = held_deg;
        axis.platform_deg += back_deg;
        back_deg != 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::at;

    #[test]
    fn the_shaft_stays_within_its_limits() {
        let limits = TiltLimits {
            from_deg: -45.0,
            to_deg: 1.0,
        };
        let mut limits = limits.checked().unwrap();
        for (commanded, held, acted) in [
            (0.0, 0.0, false),
            (-45.0, -45.0, false),
            (-50.0, -45.0, true),
            (2.0, 1.0, true),
        ] {
            let mut axis = at(commanded);
            // A deviation of the gear before the stop is kept.
            axis.platform_deg += 0.25;
            assert_eq!(limits.step(0.0, &mut axis), acted);
            assert_eq!((axis.shaft_deg, axis.platform_deg), (held, held + 0.25));
            assert_eq!(axis.commanded_deg, commanded);
        }
        let wrong = TiltLimits {
            from_deg: 1.0,
            to_deg: -1.0,
        };
        assert_eq!(wrong.checked().unwrap_err().setting, "to_deg");
    }
}
