//! Commanded motion of the tilt axis: angle over time, exact, in closed form.
//!
//! Time is in seconds from the start of the simulation.
//! [`MechanismEffect`](crate::effects::MechanismEffect) applies servo and gear.

use thiserror::Error;
use units::ShortNumber;

/// Angle and rate of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisState {
    /// Degrees of tilt.
    pub angle_deg: f64,
    /// Degrees per second.
    pub rate_deg_s: f64,
}

/// A move from one angle to another.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AxisMove {
    /// Beginning, seconds.
    pub begin_s: f64,
    /// End, seconds.
    pub end_s: f64,
    /// First angle, degrees.
    pub from_deg: f64,
    /// Last angle, degrees.
    pub to_deg: f64,
    /// Signed speed between the ramps, degrees per second; the peak speed of a triangle.
    pub cruise_deg_s: f64,
    /// Duration of each ramp, seconds; 0 for none.
    pub ramp_s: f64,
    /// Whether it is a sweep and not a way back.
    pub sweep: bool,
}

/// A number of sweeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweeps {
    /// First angle, degrees.
    pub from_deg: f64,
    /// Last angle, degrees.
    pub to_deg: f64,
    /// Speed, degrees per second, above 0.
    pub speed_deg_s: f64,
    /// Acceleration, degrees per second squared, above 0; `None` for an instant change of speed.
    pub accel_deg_s2: Option<f64>,
    /// Number of sweeps.
    pub count: u32,
    /// Whether the way back is a sweep too, and counts.
    pub both_ways: bool,
    /// Rest of the axis before, between and after, seconds.
    pub rest_s: f64,
}

/// The commanded motion.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisMotion {
    start_deg: f64,
    /// The moves in order of time.
    pub moves: Vec<AxisMove>,
    /// End of the motion, rests included, seconds.
    pub end_s: f64,
}

/// An invalid motion.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("motion: {what}")]
#[non_exhaustive]
pub struct MotionError {
    /// The invalid number's name in [`Sweeps`] or [`AxisMotion::fixed`].
    pub key: &'static str,
    /// The expected value and the value.
    pub what: String,
}

/// The most sweeps of a motion.
const MAX_SWEEPS: u32 = 10_000;

impl AxisMotion {
    /// An axis at rest.
    ///
    /// # Errors
    /// [`MotionError`] for an angle that is not finite or a duration that is not above 0.
    pub fn fixed(angle_deg: f64, duration_s: f64) -> Result<Self, MotionError> {
        finite("angle_deg", "an angle in degrees", angle_deg)?;
        above_0("duration_s", "a duration above 0 s", duration_s)?;
        Ok(Self {
            start_deg: angle_deg,
            moves: Vec::new(),
            end_s: duration_s,
        })
    }

    /// Consecutive sweeps. With `accel_deg_s2` each is a trapezoid, or a triangle where the
    /// distance is too short; without, the speed changes at once, as in ideal scan patterns.
    ///
    /// # Errors
    /// [`MotionError`] for numbers outside the ranges in [`Sweeps`].
    pub fn sweeps(sweeps: &Sweeps) -> Result<Self, MotionError> {
        finite("from_deg", "an angle in degrees", sweeps.from_deg)?;
        finite("to_deg", "an angle in degrees", sweeps.to_deg)?;
        above_0("speed_deg_s", "a speed above 0 deg/s", sweeps.speed_deg_s)?;
        if let Some(accel) = sweeps.accel_deg_s2 {
            above_0("accel_deg_s2", "an acceleration above 0 deg/s2", accel)?;
        }
        let rest_s = sweeps.rest_s;
        let valid_rest = rest_s >= 0.0 && rest_s.is_finite();
        number("rest_s", "a rest of 0 s or more", rest_s, valid_rest)?;
        if sweeps.count > MAX_SWEEPS {
            let got = sweeps.count;
            return Err(MotionError {
                key: "count",
                what: format!("expected at most {MAX_SWEEPS} sweeps, got {got}"),
            });
        }
        let mut motion = Self {
            start_deg: sweeps.from_deg,
            moves: Vec::new(),
            end_s: sweeps.rest_s,
        };
        for number in 0..sweeps.count {
            let back = sweeps.both_ways && number % 2 == 1;
            let (from, to) = match back {
                false => (sweeps.from_deg, sweeps.to_deg),
                true => (sweeps.to_deg, sweeps.from_deg),
            };
            if number > 0 && !sweeps.both_ways {
                motion.add_move(to, from, sweeps, false);
            }
            motion.add_move(from, to, sweeps, true);
        }
        Ok(motion)
    }

    fn add_move(&mut self, from_deg: f64, to_deg: f64, sweeps: &Sweeps, sweep: bool) {
        let distance_deg = (to_deg - from_deg).abs();
        let (speed, ramp_s) = match sweeps.accel_deg_s2 {
            None => (sweeps.speed_deg_s, 0.0),
            Some(accel) => {
                // A distance shorter than both ramps gives a triangle.
                let speed = sweeps.speed_deg_s.min((accel * distance_deg).sqrt());
                (speed, speed / accel)
            }
        };
        let duration_s = if speed > 0.0 {
            distance_deg / speed + ramp_s
        } else {
            0.0
        };
        let begin_s = self.end_s;
        self.moves.push(AxisMove {
            begin_s,
            end_s: begin_s + duration_s,
            from_deg,
            to_deg,
            cruise_deg_s: speed.copysign(to_deg - from_deg),
            ramp_s,
            sweep,
        });
        self.end_s = begin_s + duration_s + sweeps.rest_s;
    }

    /// Whether the axis never moves.
    #[must_use]
    pub fn is_fixed(&self) -> bool {
        self.moves.is_empty()
    }

    /// Angle and rate at a time; at rest before the beginning and after the end.
    #[inline]
    #[must_use]
    pub fn at(&self, time_s: f64) -> AxisState {
        let begun = (self.moves).partition_point(|next| next.begin_s <= time_s);
        match begun.checked_sub(1).and_then(|last| self.moves.get(last)) {
            None => AxisState {
                angle_deg: self.start_deg,
                rate_deg_s: 0.0,
            },
            Some(current) => current.at(time_s),
        }
    }
}

impl AxisMove {
    /// Computed from the nearer end, so that both ends are exact.
    fn at(&self, time_s: f64) -> AxisState {
        if time_s >= self.end_s {
            return AxisState {
                angle_deg: self.to_deg,
                rate_deg_s: 0.0,
            };
        }
        let (since, left) = (time_s - self.begin_s, self.end_s - time_s);
        let first_half = since <= left;
        let near = if first_half { since } else { left };
        let (distance_deg, rate_deg_s) = if near < self.ramp_s {
            let rate = self.cruise_deg_s * (near / self.ramp_s);
            (0.5 * rate * near, rate)
        } else {
            (
                self.cruise_deg_s * (near - 0.5 * self.ramp_s),
                self.cruise_deg_s,
            )
        };
        let angle_deg = match first_half {
            true => self.from_deg + distance_deg,
            false => self.to_deg - distance_deg,
        };
        AxisState {
            angle_deg,
            rate_deg_s,
        }
    }
}

fn finite(key: &'static str, what: &'static str, got: f64) -> Result<(), MotionError> {
    number(key, what, got, got.is_finite())
}

fn above_0(key: &'static str, what: &'static str, got: f64) -> Result<(), MotionError> {
    number(key, what, got, got > 0.0 && got.is_finite())
}

fn number(
    key: &'static str,
    what: &'static str,
    got: f64,
    is_valid: bool,
) -> Result<(), MotionError> {
    match is_valid {
        true => Ok(()),
        false => Err(MotionError {
            key,
            what: format!("{key}: expected {what}, got {}", ShortNumber(got)),
        }),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn sweeps() -> Sweeps {
        Sweeps {
            from_deg: 0.0,
            to_deg: -45.0,
            speed_deg_s: 56.25,
            accel_deg_s2: Some(5_000.0),
            count: 1,
            both_ways: false,
            rest_s: 0.1,
        }
    }

    #[test]
    fn the_default_sweep_takes_0_811_s() {
        let motion = AxisMotion::sweeps(&sweeps()).unwrap();
        let [next_move] = &motion.moves[..] else {
            panic!()
        };
        // 45 / 56.25 s and one ramp of 56.25 / 5000 s.
        assert!((next_move.end_s - next_move.begin_s - 0.811_25).abs() < 1e-12);
        assert!((motion.end_s - 1.011_25).abs() < 1e-12);
        assert_eq!(motion.at(0.05).angle_deg, 0.0);
        assert_eq!(motion.at(next_move.end_s).angle_deg, -45.0);
        let middle = motion.at(0.1 + 0.811_25 / 2.0);
        assert!((middle.angle_deg + 22.5).abs() < 1e-12 && middle.rate_deg_s == -56.25);
    }

    #[test]
    fn an_ideal_sweep_is_a_straight_line() {
        let motion = AxisMotion::sweeps(&Sweeps {
            to_deg: 180.0,
            speed_deg_s: 120.0,
            accel_deg_s2: None,
            rest_s: 0.0,
            ..sweeps()
        })
        .unwrap();
        assert_eq!(motion.end_s, 1.5);
        for at_s in [0.0, 0.3, 0.75, 1.0, 1.4999] {
            let state = motion.at(at_s);
            assert!((state.angle_deg - 120.0 * at_s).abs() < 1e-12);
            assert_eq!(state.rate_deg_s, 120.0);
        }
    }

    #[test]
    fn one_way_does_not_scan_the_return_and_both_ways_does() {
        let of = |both_ways| {
            let sweeps = Sweeps {
                count: 3,
                both_ways,
                ..sweeps()
            };
            let motion = AxisMotion::sweeps(&sweeps).unwrap();
            let ways = motion.moves.iter();
            ways.map(|next_move| (next_move.to_deg, next_move.sweep))
                .collect::<Vec<_>>()
        };
        assert_eq!(of(true), [(-45.0, true), (0.0, true), (-45.0, true)]);
        let one_way = [
            (-45.0, true),
            (0.0, false),
            (-45.0, true),
            (0.0, false),
            (-45.0, true),
        ];
        assert_eq!(of(false), one_way);
    }

    #[test]
    fn invalid_motions_are_reported() {
        let error = AxisMotion::sweeps(&Sweeps {
            speed_deg_s: 0.0,
            ..sweeps()
        });
        let message = error.unwrap_err().to_string();
        assert_eq!(
            message,
            "motion: speed_deg_s: expected a speed above 0 deg/s, got 0"
        );
        assert!(AxisMotion::fixed(f64::NAN, 1.0).is_err());
        assert!(AxisMotion::fixed(0.0, 0.0).is_err());
        let many = Sweeps {
            count: 10_001,
            ..sweeps()
        };
        assert!(AxisMotion::sweeps(&many).is_err());
        assert_eq!(
            AxisMotion::fixed(-20.0, 1.0).unwrap().at(0.5).angle_deg,
            -20.0
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        /// For every profile (trapezoid, triangle, no distance) the motion is continuous, its rate
        /// is its slope, and it reaches its target.
        #[test]
        fn the_rate_is_the_slope_of_the_angle(
            from in -180.0..180.0, to in -180.0..180.0, speed in 0.01..500.0, accel in 1.0..1e5, both: bool, count in 0_u32..4,
        ) {
            let sweeps = Sweeps {
                from_deg: from, to_deg: to, speed_deg_s: speed, accel_deg_s2: Some(accel), count, both_ways: both, rest_s: 0.05,
            };
            let motion = AxisMotion::sweeps(&sweeps).unwrap();
            let end_s = motion.end_s;
            for step in 0..=200 {
                let at_s = end_s * f64::from(step) / 200.0;
                let h = 1e-7 * (1.0 + end_s);
                let (before, now, after) = (motion.at(at_s - h), motion.at(at_s), motion.at(at_s + h));
                let slope = (after.angle_deg - before.angle_deg) / (2.0 * h);
                let bound = accel * h + 1e-12 * 360.0 / h;
                prop_assert!((slope - now.rate_deg_s).abs() <= bound, "{slope} {now:?} at {at_s}");
                prop_assert!(now.rate_deg_s.abs() <= speed * (1.0 + 1e-12));
            }
            let last = motion.moves.last().map_or(from, |next_move| next_move.to_deg);
            prop_assert_eq!(motion.at(end_s).angle_deg, last);
        }
    }
}
