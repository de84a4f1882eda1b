//! Plans of moves: the drive's whole rpm and the resulting timing.
//!
//! The profile is the symmetric trapezoid of motion profile type 0 (6086): acceleration a for v/a,
//! cruise at v, deceleration a. A distance below v2/a never reaches v and gives a triangle.

use units::{DegPerS, DegPerS2, Degrees, Quadcounts, Rpm, RpmPerS, Span};

use crate::command::MoveCommand;
use crate::config::AxisConfig;
use crate::error::DriveError;

/// A move in the drive's units, with its timing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MovePlan {
    /// Start, rounded to quadcounts.
    pub from: Degrees,
    /// Target, rounded to quadcounts.
    pub to: Degrees,
    /// Profile velocity (6081): the requested speed in whole rpm.
    pub speed: Rpm,
    /// Profile acceleration and deceleration (6083, 6084).
    pub acceleration: RpmPerS,
    /// Requested speed.
    pub requested: DegPerS,
    /// Highest speed: that of `speed`, or the peak of the triangle.
    pub cruise: DegPerS,
    /// Distance over duration; zero without motion.
    pub mean: DegPerS,
    /// Duration of each ramp.
    pub ramp: Span,
    /// Duration at constant speed.
    pub cruising: Span,
    /// Duration from start to standstill.
    pub duration: Span,
    /// Whether the distance is too short to reach the profile velocity.
    pub triangle: bool,
}

/// A validated move command in the drive's units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ValidatedMove {
    pub target: Quadcounts,
    pub speed: Rpm,
    pub acceleration: RpmPerS,
}

impl MovePlan {
    /// Distance from the start at a time after the start, degrees: the area under the trapezoid.
    #[must_use]
    pub fn travelled(&self, since_start: Span) -> Degrees {
        let (ramp, cruising) = (self.ramp.as_secs_f64(), self.cruising.as_secs_f64());
        let t = since_start
            .as_secs_f64()
            .clamp(0.0, self.duration.as_secs_f64());
        // A ramp of no duration covers no distance.
        let on_ramp = |t: f64| {
            if ramp > 0.0 {
                self.cruise.0 * t * t / (2.0 * ramp)
            } else {
                0.0
            }
        };
        let left = 2.0 * ramp + cruising - t;
        Degrees(if t < ramp {
            on_ramp(t)
        } else if left > ramp {
            self.cruise.0 * (t - ramp / 2.0)
        } else {
            self.cruise.0 * (ramp + cruising) - on_ramp(left.max(0.0))
        })
    }
}

impl AxisConfig {
    /// Plans a move at a cruise speed and an acceleration in degrees of tilt.
    ///
    /// # Errors
    /// [`DriveError::Limits`] for a target outside the limits. [`DriveError::Speed`] and
    /// [`DriveError::Acceleration`] for a value that is not a number, not positive, less than half
    /// an rpm or above the axis' maximum.
    pub fn plan(
        &self,
        from: Degrees,
        to: Degrees,
        speed: DegPerS,
        acceleration: DegPerS2,
    ) -> Result<MovePlan, DriveError> {
        let rpm = self.gearing.rpm(speed);
        // Written so that NaN is not positive either.
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
        let planned = self.validate(MoveCommand {
            to,
            speed: rpm,
            acceleration: rpm_per_s,
        })?;
        Ok(MovePlan {
            requested: speed,
            ..self.plan_move(from, planned)
        })
    }

    /// Plans a validated move.
    pub(crate) fn plan_move(&self, from: Quadcounts, planned: ValidatedMove) -> MovePlan {
        let ValidatedMove {
            target,
            speed,
            acceleration,
        } = planned;
        let (from, to) = (self.gearing.angle(from), self.gearing.angle(target));
        let distance = (to.0 - from.0).abs();
        let v = self.gearing.rate(speed).0;
        let a = self.gearing.acceleration(acceleration).0;
        let triangle = distance < v * v / a;
        let peak = if triangle { (distance * a).sqrt() } else { v };
        let ramp = peak / a;
        let cruising = if triangle { 0.0 } else { distance / v - ramp };
        let duration = 2.0 * ramp + cruising;
        let mean = if duration > 0.0 {
            distance / duration
        } else {
            0.0
        };
        MovePlan {
            from,
            to,
            speed,
            acceleration,
            requested: DegPerS(v),
            cruise: DegPerS(peak),
            mean: DegPerS(mean),
            ramp: Span::from_secs_f64(ramp),
            cruising: Span::from_secs_f64(cruising),
            duration: Span::from_secs_f64(duration),
            triangle,
        }
    }

    /// Checks a move against the axis' ranges and converts its target to quadcounts.
    pub(crate) fn validate(&self, command: MoveCommand) -> Result<ValidatedMove, DriveError> {
        let MoveCommand {
            to,
            speed,
            acceleration,
        } = command;
        if speed.0 == 0 || speed > self.max_speed {
            return Err(self.speed_error(self.gearing.rate(speed)));
        }
        if acceleration.0 == 0 || acceleration > self.max_acceleration {
            return Err(self.acceleration_error(self.gearing.acceleration(acceleration)));
        }
        let limits = self.limits_qc()?;
        match self.gearing.position(to) {
            Ok(target) if limits.contains(target, Quadcounts(0)) => Ok(ValidatedMove {
                target,
                speed,
                acceleration,
            }),
            _ => Err(DriveError::Limits {
                target: to,
                min: self.limits.min,
                max: self.limits.max,
            }),
        }
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

    fn plan(to: f64, speed: f64, acceleration: f64) -> Result<MovePlan, DriveError> {
        AxisConfig::default().plan(
            Degrees(0.0),
            Degrees(to),
            DegPerS(speed),
            DegPerS2(acceleration),
        )
    }

    /// The paper's sweep: 45 deg at 56.25 deg/s; with 500 deg/s2 the two ramps add v/a = 112.5 ms
    /// to the 0.8 s.
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
    fn a_short_distance_is_a_triangle() {
        let plan = plan(1.0, 56.25, 500.0).unwrap();
        assert!(plan.triangle);
        assert!(plan.cruise.0 < 56.25);
        assert_eq!(plan.cruising, Span::ZERO);
        // Two ramps of sqrt(distance / a) each; 1 deg is 666.67 qc, so 667 qc = 1.0005 deg.
        assert!((plan.duration.as_secs_f64() - 2.0 * (1.0005f64 / 500.0).sqrt()).abs() < 1e-8);
    }

    #[test]
    fn no_distance_takes_no_time() {
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

    #[test]
    fn errors_print_huge_and_tiny_requests_briefly() {
        for (error, message) in [
            (plan(1e300, 10.0, 100.0), "1e300 deg is"),
            (plan(-61.25, 10.0, 100.0), "-61.25 deg is"),
            (plan(f64::NAN, 10.0, 100.0), "NaN deg is"),
            (plan(1.0, 1e300, 100.0), "speed 1e300 deg/s is"),
            (plan(1.0, 1e-300, 100.0), "speed 1e-300 deg/s is"),
            (plan(1.0, 0.0, 100.0), "speed 0 deg/s is"),
            (plan(1.0, 10.0, 1e6), "acceleration 1e6 deg/s2 is"),
            (
                plan(1.0, 10.0, 999_999.5),
                "acceleration 999999.5 deg/s2 is",
            ),
        ] {
            let error = error.unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
    }

    #[test]
    fn the_distance_travelled_is_the_area_under_the_speed() {
        for to in [45.0, 1.0] {
            let plan = plan(to, 56.25, 500.0).unwrap();
            let (steps, mut area) = (20_000, 0.0);
            let step = plan.duration.as_secs_f64() / f64::from(steps);
            let ramp = plan.ramp.as_secs_f64();
            for n in 0..steps {
                let t = (f64::from(n) + 0.5) * step;
                let left = plan.duration.as_secs_f64() - t;
                area += step * plan.cruise.0 * (t / ramp).min(left / ramp).min(1.0);
                let travelled = plan
                    .travelled(Span::from_secs_f64(f64::from(n + 1) * step))
                    .0;
                assert!((travelled - area).abs() < 1e-5, "{t} s: {travelled} {area}");
            }
        }
    }

    #[test]
    fn no_distance_is_travelled_before_the_start_and_all_after_the_end() {
        let plan = plan(45.0, 56.25, 500.0).unwrap();
        assert_eq!(plan.travelled(Span::from_secs(-1)), Degrees(0.0));
        assert!((plan.travelled(Span::from_secs(9)).0 - 45.0).abs() < 1e-9);
    }

    proptest! {
        /// The area under the planned speed is the distance.
        #[test]
        fn the_profile_covers_the_distance(to in -60.0..60.0f64, speed in 0.05..75.0f64, acceleration in 1.0..1000.0f64) {
            let plan = plan(to, speed, acceleration).unwrap();
            let distance = (plan.to.0 - plan.from.0).abs();
            let area = plan.cruise.0 * (plan.ramp.as_secs_f64() + plan.cruising.as_secs_f64());
            prop_assert!((area - distance).abs() < 1e-6, "{area} {distance}");
            prop_assert!(plan.cruise.0 <= 75.0);
        }
    }
}
