//! What a requested move becomes in the drive's whole rpm, and how long it will take.
//!
//! The profile is the symmetric trapezoid of 6086 = 0: acceleration a over v/a, cruise at v, deceleration a; a way shorter
//! than v2/a never reaches v and is a triangle. What the axis really does is measured, not planned.

use units::{DegPerS, DegPerS2, Degrees, Quadcounts, Rpm, RpmPerS, Span};

use crate::command::Move;
use crate::config::AxisConfig;
use crate::error::DriveError;

/// A move in the drive's units with its timing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Start, at the nearest quadcount.
    pub from: Degrees,
    /// Target, at the nearest quadcount.
    pub to: Degrees,
    /// Profile velocity (6081): the requested cruise speed in whole rpm.
    pub speed: Rpm,
    /// Profile acceleration and deceleration (6083, 6084).
    pub acceleration: RpmPerS,
    /// The speed that was asked for.
    pub requested: DegPerS,
    /// Highest speed reached: that of `speed`, or the peak of the triangle.
    pub cruise: DegPerS,
    /// Way over duration; zero for no way.
    pub mean: DegPerS,
    /// Length of each of the two ramps.
    pub ramp: Span,
    /// Time at constant speed.
    pub cruising: Span,
    /// Whole time from start to standstill.
    pub duration: Span,
    /// Whether the way is too short to reach the profile velocity.
    pub triangle: bool,
}

/// A move that has passed the checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Aim {
    pub target: Quadcounts,
    pub speed: Rpm,
    pub acceleration: RpmPerS,
}

impl AxisConfig {
    /// Plans a move at a cruise speed and an acceleration in degrees of tilt.
    ///
    /// # Errors
    /// [`DriveError::Limits`] for a target outside the limits; [`DriveError::Speed`] and [`DriveError::Acceleration`]
    /// for what is not a number, not above zero, less than half an rpm, or above the axis' maximum.
    pub fn plan(
        &self,
        from: Degrees,
        to: Degrees,
        speed: DegPerS,
        acceleration: DegPerS2,
    ) -> Result<Plan, DriveError> {
        let rpm = self.gearing.rpm(speed);
        // Not a number is not above zero either.
        let is_positive = speed.0 > 0.0;
        if !is_positive || rpm.0 == 0 || rpm > self.max_speed {
            return Err(self.speed_error(speed));
        }
        let rpm_per_s = self.gearing.rpm_per_s(acceleration);
        let is_positive = acceleration.0 > 0.0;
        if !is_positive || rpm_per_s.0 == 0 || rpm_per_s > self.max_acceleration {
            return Err(self.acceleration_error(acceleration));
        }
        let from = self.quadcounts("from", from)?;
        let to = self.target(to)?;
        let plan = self.plan_move(from, to, rpm, rpm_per_s)?;
        Ok(Plan {
            requested: speed,
            ..plan
        })
    }

    /// Plans a move that is already in the drive's units.
    ///
    /// # Errors
    /// As for [`AxisConfig::plan`].
    pub fn plan_move(
        &self,
        from: Quadcounts,
        to: Quadcounts,
        speed: Rpm,
        acceleration: RpmPerS,
    ) -> Result<Plan, DriveError> {
        self.check_rates(speed, acceleration)?;
        let (from, to) = (self.gearing.angle(from), self.gearing.angle(to));
        let way = (to.0 - from.0).abs();
        let v = self.gearing.rate(speed).0;
        let a = self.gearing.acceleration(acceleration).0;
        let triangle = way < v * v / a;
        let peak = if triangle { (way * a).sqrt() } else { v };
        let ramp = peak / a;
        let cruising = if triangle { 0.0 } else { way / v - ramp };
        let duration = 2.0 * ramp + cruising;
        Ok(Plan {
            from,
            to,
            speed,
            acceleration,
            requested: DegPerS(v),
            cruise: DegPerS(peak),
            mean: DegPerS(if duration > 0.0 { way / duration } else { 0.0 }),
            ramp: Span::from_secs_f64(ramp),
            cruising: Span::from_secs_f64(cruising),
            duration: Span::from_secs_f64(duration),
            triangle,
        })
    }

    /// A commanded move in quadcounts, refused where the axis cannot or must not make it.
    pub(crate) fn aim(&self, to: Move) -> Result<Aim, DriveError> {
        self.check_rates(to.speed, to.acceleration)?;
        Ok(Aim {
            target: self.target(to.to)?,
            speed: to.speed,
            acceleration: to.acceleration,
        })
    }

    /// A target in quadcounts, refused outside the limits.
    fn target(&self, to: Degrees) -> Result<Quadcounts, DriveError> {
        let outside = DriveError::Limits {
            target: to,
            min: self.limits.min,
            max: self.limits.max,
        };
        let limits = self.limits_qc()?;
        let Ok(target) = self.gearing.position(to) else {
            return Err(outside);
        };
        if target < limits.min || target > limits.max {
            return Err(outside);
        }
        Ok(target)
    }

    /// Refuses rates that the axis cannot run at.
    fn check_rates(&self, speed: Rpm, acceleration: RpmPerS) -> Result<(), DriveError> {
        if speed.0 == 0 || speed > self.max_speed {
            return Err(self.speed_error(self.gearing.rate(speed)));
        }
        if acceleration.0 == 0 || acceleration > self.max_acceleration {
            return Err(self.acceleration_error(self.gearing.acceleration(acceleration)));
        }
        Ok(())
    }

    fn speed_error(&self, requested: DegPerS) -> DriveError {
        DriveError::Speed {
            requested,
            slowest: self.gearing.rate(Rpm(1)),
            fastest: self.gearing.rate(self.max_speed),
            max_rpm: self.max_speed,
        }
    }

    fn acceleration_error(&self, requested: DegPerS2) -> DriveError {
        DriveError::Acceleration {
            requested,
            slowest: self.gearing.acceleration(RpmPerS(1)),
            fastest: self.gearing.acceleration(self.max_acceleration),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn plan(to: f64, speed: f64, acceleration: f64) -> Result<Plan, DriveError> {
        AxisConfig::default().plan(
            Degrees(0.0),
            Degrees(to),
            DegPerS(speed),
            DegPerS2(acceleration),
        )
    }

    /// The paper's sweep: 45 deg at 56.25 deg/s; with 500 deg/s2 the two ramps add v/a = 112.5 ms to 0.8 s of way.
    #[test]
    fn the_papers_sweep_takes_912_5_ms() {
        let plan = plan(45.0, 56.25, 500.0).unwrap();
        assert_eq!(plan.speed, Rpm(1125));
        assert_eq!(plan.acceleration, RpmPerS(10_000));
        assert_eq!(plan.duration, Span::from_micros(912_500));
        assert_eq!(plan.ramp, Span::from_micros(112_500));
        assert!(!plan.triangle);
        assert!((plan.mean.0 - 45.0 / 0.9125).abs() < 1e-9);
    }

    #[test]
    fn a_short_way_is_a_triangle() {
        let plan = plan(1.0, 56.25, 500.0).unwrap();
        assert!(plan.triangle);
        assert!(plan.cruise.0 < 56.25);
        assert_eq!(plan.cruising, Span::ZERO);
        // Two ramps of sqrt(way / a) each; 1 deg is 666.67 qc, so 667 qc = 1.0005 deg.
        assert!((plan.duration.as_secs_f64() - 2.0 * (1.0005f64 / 500.0).sqrt()).abs() < 1e-8);
    }

    #[test]
    fn no_way_takes_no_time() {
        let plan = plan(0.0, 10.0, 100.0).unwrap();
        assert_eq!((plan.duration, plan.mean), (Span::ZERO, DegPerS(0.0)));
    }

    #[test]
    fn speeds_become_whole_rpm() {
        assert_eq!(plan(10.0, 1.07, 100.0).unwrap().speed, Rpm(21));
        assert_eq!(
            plan(10.0, 1.07, 100.0).unwrap().cruise,
            DegPerS(21.0 * 0.05)
        );
        assert_eq!(plan(10.0, 1.07, 100.0).unwrap().requested, DegPerS(1.07));
    }

    #[test]
    fn impossible_speeds_are_refused() {
        for speed in [0.0, -1.0, 0.02, 75.1, 1e300, f64::NAN, f64::INFINITY, -0.0] {
            assert!(
                matches!(plan(10.0, speed, 100.0), Err(DriveError::Speed { .. })),
                "{speed}"
            );
            assert!(
                matches!(
                    plan(10.0, 10.0, speed * 100.0),
                    Err(DriveError::Acceleration { .. })
                ) || speed == 0.02
                    || speed == 75.1,
                "{speed}"
            );
        }
    }

    #[test]
    fn targets_outside_the_limits_are_refused() {
        for to in [60.01, -60.01, 1e12, f64::NAN, f64::INFINITY] {
            assert!(
                matches!(plan(to, 10.0, 100.0), Err(DriveError::Limits { .. })),
                "{to}"
            );
        }
        assert!(plan(60.0, 10.0, 100.0).is_ok());
    }

    proptest! {
        /// The area under the planned speed is the way.
        #[test]
        fn the_profile_covers_the_way(to in -60.0..60.0f64, speed in 0.05..75.0f64, acceleration in 1.0..1000.0f64) {
            let plan = plan(to, speed, acceleration).unwrap();
            let way = (plan.to.0 - plan.from.0).abs();
            let area = plan.cruise.0 * (plan.ramp.as_secs_f64() + plan.cruising.as_secs_f64());
            prop_assert!((area - way).abs() < 1e-6, "{area} {way}");
            prop_assert!(plan.cruise.0 <= 75.0);
        }
    }
}
