//! Gear ripple: a periodic deviation of the platform from what the motor's encoder measures.
//!
//! Backlash, elasticity and deviations with the period of the platform are not included.

use core::f64::consts::TAU;

use units::Degrees;

/// A sine over the motor's revolutions between encoder and platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearRipple {
    /// Largest deviation of the platform.
    pub amplitude: Degrees,
    /// Periods per motor revolution: 1 for an eccentric gear, the number of teeth for their error.
    pub per_motor_turn: u32,
    /// Phase at the motor's zero.
    pub phase: Degrees,
}

impl GearRipple {
    /// Deviation of the platform after `motor_turns`.
    #[must_use]
    pub fn ahead(&self, motor_turns: f64) -> Degrees {
        Degrees(self.amplitude.0 * self.angle_rad(motor_turns).sin())
    }

    /// Change of [`GearRipple::ahead`] per motor revolution.
    pub(crate) fn ahead_per_turn(&self, motor_turns: f64) -> Degrees {
        let rad_per_turn = TAU * f64::from(self.per_motor_turn);
        Degrees(self.amplitude.0 * rad_per_turn * self.angle_rad(motor_turns).cos())
    }

    fn angle_rad(&self, motor_turns: f64) -> f64 {
        let periods = motor_turns * f64::from(self.per_motor_turn) + self.phase.0 / 360.0;
        // Whole periods are removed first: the sine would lose them to rounding.
        (periods - periods.floor()) * TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ripple_is_periodic() {
        let ripple = GearRipple {
            amplitude: Degrees(0.003),
            per_motor_turn: 2,
            phase: Degrees(30.0),
        };
        for (turns, part) in [
            (0.0, 0.5),
            (1.0 / 6.0, 0.5),
            (1.0 / 12.0, 1.0),
            (0.25, -0.5),
            (-0.5, 0.5),
            (1e6, 0.5),
        ] {
            let ahead = ripple.ahead(turns).0;
            assert!((ahead - 0.003 * part).abs() < 1e-11, "{turns}: {ahead}");
        }
    }
}
