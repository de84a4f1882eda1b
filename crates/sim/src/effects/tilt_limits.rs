//! Mechanism: mechanical stops. The shaft goes no further than they are, whatever is commanded; the encoder sees that.
//!
//! Left out: bouncing, limit switches that stop the drive before, and the drive's fault when it follows too far behind (the software drive has both).

use serde::Deserialize;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Asked, Axis, Effect, Listed, Mechanism};

/// `[effects.tilt_limits]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct TiltLimitsSettings {
    /// The lower stop, degrees of tilt.
    pub from_deg: f64,
    /// The upper stop, not below the lower.
    pub to_deg: f64,
}

/// Two stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltLimits {
    from_deg: f64,
    to_deg: f64,
}

impl TiltLimits {
    /// What the scene file calls it.
    pub const NAME: &'static str = "tilt_limits";

    /// With these settings.
    ///
    /// # Errors
    /// [`Unfit`] for angles that are not finite or the wrong way round.
    pub fn new(settings: &TiltLimitsSettings) -> Result<Self, Unfit> {
        let check = Check(Self::NAME);
        let from_deg = check.within("from_deg", settings.from_deg, -360.0..=360.0)?;
        let to_deg = check.within("to_deg", settings.to_deg, from_deg..=360.0)?;
        Ok(Self { from_deg, to_deg })
    }
}

impl Settings for TiltLimitsSettings {
    fn ask(&self, _: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Box::new(TiltLimits::new(self)?);
        asked.mechanism.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for TiltLimits {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "the motion stays within the stops"
    }
}

impl Mechanism for TiltLimits {
    fn step(&mut self, _: f64, axis: &mut Axis) -> bool {
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
    use crate::effects::testing::at;

    #[test]
    fn the_shaft_stays_within() {
        let settings = TiltLimitsSettings {
            from_deg: -45.0,
            to_deg: 1.0,
        };
        let mut limits = TiltLimits::new(&settings).unwrap();
        for (commanded, held, acted) in [
            (0.0, 0.0, false),
            (-45.0, -45.0, false),
            (-50.0, -45.0, true),
            (2.0, 1.0, true),
        ] {
            let mut axis = at(commanded);
            // A gear that ran ahead before keeps what it was ahead.
            axis.platform_deg += 0.25;
            assert_eq!(limits.step(0.0, &mut axis), acted);
            assert_eq!((axis.shaft_deg, axis.platform_deg), (held, held + 0.25));
            assert_eq!(axis.commanded_deg, commanded);
        }
        let wrong = TiltLimitsSettings {
            from_deg: 1.0,
            to_deg: -1.0,
        };
        assert_eq!(TiltLimits::new(&wrong).unwrap_err().setting, "to_deg");
    }
}
