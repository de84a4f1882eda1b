//! Mechanism: a gear that is not true. The platform runs ahead of and behind what the motor's encoder says, periodically.
//!
//! Left out: backlash, elasticity, and errors of a whole turn of the platform.

use units::Degrees;

/// A sine over the motor's turns between encoder and platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearRipple {
    /// The most that the platform is off.
    pub amplitude: Degrees,
    /// Periods in a turn of the motor: 1 for a gear that runs out of centre, the number of teeth for theirs.
    pub per_motor_turn: u32,
    /// Where in its period it is at the motor's zero.
    pub phase: Degrees,
}

impl GearRipple {
    /// How far the platform is ahead after `motor_turns`.
    #[must_use]
    pub fn ahead(&self, motor_turns: f64) -> Degrees {
        let turns = motor_turns * f64::from(self.per_motor_turn) + self.phase.0 / 360.0;
        // Whole turns are taken off before the sine, which would lose them to rounding.
        let angle = (turns - turns.floor()) * core::f64::consts::TAU;
        Degrees(self.amplitude.0 * angle.sin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_comes_back_after_each_of_its_periods() {
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
