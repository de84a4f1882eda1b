//! Motor-side integers (quadcounts, rpm) and the gearing that converts them to degrees of tilt.

use core::fmt;

use crate::{DegPerS, DegPerS2, Degrees};

/// A position of the motor shaft in quadcounts (four per encoder line).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Quadcounts(pub i32);

/// A speed of the motor shaft in whole revolutions per minute.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Rpm(pub u32);

/// An acceleration of the motor shaft in whole rpm per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RpmPerS(pub u32);

/// Encoder and gear between the motor shaft and the tilt axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gearing {
    qc_per_turn: u32,
    motor_turns: u32,
    axis_turns: u32,
}

/// An impossible gearing, or a quantity that exceeds the drive's integers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GearingError {
    /// One of the gearing's numbers is zero.
    Zero,
    /// The quadcounts of a revolution exceed 32 bits.
    EncoderLines(u32),
    /// The angle is not finite or its quadcounts exceed 32 bits.
    AngleRange(Degrees),
}

impl fmt::Display for GearingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Zero => write!(f, "encoder lines and gear turns must be above zero"),
            Self::EncoderLines(lines) => {
                write!(f, "{lines} encoder lines: expected at most 1073741823")
            }
            Self::AngleRange(angle) => {
                write!(
                    f,
                    "{} deg does not fit the drive's 32-bit quadcounts",
                    angle.0
                )
            }
        }
    }
}

impl core::error::Error for GearingError {}

impl Gearing {
    /// A gear of `motor_turns` : `axis_turns` after an encoder of `encoder_lines` lines per
    /// revolution.
    ///
    /// # Errors
    /// [`GearingError::Zero`] if any of the three is zero, [`GearingError::EncoderLines`] from 2^30
    /// lines on.
    pub const fn new(
        encoder_lines: u32,
        motor_turns: u32,
        axis_turns: u32,
    ) -> Result<Self, GearingError> {
        if encoder_lines == 0 || motor_turns == 0 || axis_turns == 0 {
            return Err(GearingError::Zero);
        }
        if encoder_lines >= 1 << 30 {
            return Err(GearingError::EncoderLines(encoder_lines));
        }
        Ok(Self {
            qc_per_turn: 4 * encoder_lines,
            motor_turns,
            axis_turns,
        })
    }

    /// Quadcounts in one revolution of the motor.
    #[must_use]
    pub const fn qc_per_motor_turn(self) -> u32 {
        self.qc_per_turn
    }

    /// The gear ratio as given, motor first: `[120, 1]` is 120:1.
    #[must_use]
    pub const fn turns(self) -> [u32; 2] {
        [self.motor_turns, self.axis_turns]
    }

    /// Degrees of tilt in one quadcount.
    #[must_use]
    pub fn degrees_per_qc(self) -> f64 {
        360.0 * f64::from(self.axis_turns)
            / (f64::from(self.qc_per_turn) * f64::from(self.motor_turns))
    }

    /// Degrees per second of tilt in one rpm of the motor (0.05 with a gear of 120:1).
    #[must_use]
    pub fn deg_s_per_rpm(self) -> f64 {
        6.0 * f64::from(self.axis_turns) / f64::from(self.motor_turns)
    }

    /// The tilt angle at a motor position.
    #[must_use]
    pub fn angle(self, position: Quadcounts) -> Degrees {
        Degrees(f64::from(position.0) * self.degrees_per_qc())
    }

    /// The motor position nearest to a tilt angle.
    ///
    /// # Errors
    /// [`GearingError::AngleRange`] where it does not fit 32 bits or is not finite.
    pub fn position(self, angle: Degrees) -> Result<Quadcounts, GearingError> {
        let qc = round(angle.0 / self.degrees_per_qc());
        if qc.is_finite() && qc >= f64::from(i32::MIN) && qc <= f64::from(i32::MAX) {
            Ok(Quadcounts(qc as i32))
        } else {
            Err(GearingError::AngleRange(angle))
        }
    }

    /// The tilt rate at a motor speed.
    #[must_use]
    pub fn rate(self, speed: Rpm) -> DegPerS {
        DegPerS(f64::from(speed.0) * self.deg_s_per_rpm())
    }

    /// The whole motor rpm nearest to the magnitude of a tilt rate; 0 for NaN.
    #[must_use]
    pub fn rpm(self, rate: DegPerS) -> Rpm {
        Rpm(round(rate.0.abs() / self.deg_s_per_rpm()) as u32)
    }

    /// The tilt acceleration at a motor acceleration.
    #[must_use]
    pub fn acceleration(self, acceleration: RpmPerS) -> DegPerS2 {
        DegPerS2(f64::from(acceleration.0) * self.deg_s_per_rpm())
    }

    /// The whole motor rpm/s nearest to the magnitude of a tilt acceleration; 0 for NaN.
    #[must_use]
    pub fn rpm_per_s(self, acceleration: DegPerS2) -> RpmPerS {
        RpmPerS(round(acceleration.0.abs() / self.deg_s_per_rpm()) as u32)
    }
}

/// To the nearest integer, halves away from zero (`f64::round` is not in `core`).
fn round(x: f64) -> f64 {
    const WHOLE: f64 = 4_503_599_627_370_496.0; // 2^52: no fraction from here on
    if x.is_nan() || x.abs() >= WHOLE {
        return x;
    }
    let nearest = (x.abs() + 0.5) as i64 as f64;
    if x < 0.0 { -nearest } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> Gearing {
        Gearing::new(500, 120, 1).unwrap()
    }

    #[test]
    fn the_papers_top_speed_is_1125_rpm() {
        assert_eq!(paper().rpm(DegPerS(56.25)), Rpm(1125));
        assert_eq!(paper().rate(Rpm(1125)), DegPerS(56.25));
        assert_eq!(paper().rate(Rpm(1)), DegPerS(0.05));
    }

    #[test]
    fn a_quadcount_is_1_5_millidegrees_with_a_gear_of_120_to_1() {
        assert!((paper().degrees_per_qc() - 0.0015).abs() < 1e-18);
        assert_eq!(paper().position(Degrees(-45.0)), Ok(Quadcounts(-30_000)));
        assert!((paper().angle(Quadcounts(-30_000)).0 + 45.0).abs() < 1e-12);
    }

    #[test]
    fn angles_out_of_range_are_refused() {
        for angle in [f64::NAN, f64::INFINITY, 1e9, -1e9] {
            assert!(paper().position(Degrees(angle)).is_err(), "{angle}");
        }
    }

    #[test]
    fn a_gearing_without_teeth_is_refused() {
        assert_eq!(Gearing::new(0, 120, 1), Err(GearingError::Zero));
        assert_eq!(Gearing::new(500, 0, 1), Err(GearingError::Zero));
        assert_eq!(Gearing::new(500, 1, 0), Err(GearingError::Zero));
        let most = (1 << 30) - 1;
        assert!(Gearing::new(most, 1, 1).is_ok());
        let refused = Gearing::new(most + 1, 1, 1).unwrap_err();
        assert_eq!(refused, GearingError::EncoderLines(most + 1));
    }

    #[test]
    fn rounding_is_to_the_nearest() {
        assert_eq!(round(2.5), 3.0);
        assert_eq!(round(-2.5), -3.0);
        assert_eq!(round(-0.4), 0.0);
        assert_eq!(round(1e300), 1e300);
        assert!(round(f64::NAN).is_nan());
    }
}
