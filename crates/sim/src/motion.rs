//! How the tilt axis is commanded to move: angle over time, exact, in closed form.
//!
//! Time counts in seconds from the start of the simulation. Left out: what servo and gear make of it ([`crate::effects::Mechanism`]), and the
//! drive that would carry it out (`firmware_sim::epos2`).

use thiserror::Error;

/// Where the axis is commanded to be and how fast it is to turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stand {
    /// Degrees of tilt.
    pub angle_deg: f64,
    /// Degrees per second.
    pub rate_deg_s: f64,
}

/// One way from an angle to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// When it begins, seconds.
    pub begin_s: f64,
    /// When it ends.
    pub end_s: f64,
    /// Where it begins, degrees.
    pub from_deg: f64,
    /// Where it ends.
    pub to_deg: f64,
    /// How fast it is in between, degrees per second with its sign; what is reached where it is too short for the speed asked for.
    pub cruise_deg_s: f64,
    /// Seconds of the ramps at either end; 0 for none.
    pub ramp_s: f64,
    /// Whether it is a sweep to be scanned, not a way back.
    pub sweep: bool,
}

/// Sweeps that are to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweeps {
    /// Where they begin, degrees.
    pub from_deg: f64,
    /// Where they end.
    pub to_deg: f64,
    /// How fast, degrees per second, above 0.
    pub speed_deg_s: f64,
    /// How quickly that speed is reached, degrees per second squared, above 0; `None`: at once.
    pub accel_deg_s2: Option<f64>,
    /// How many.
    pub count: u32,
    /// Whether the way back is a sweep too, and counts.
    pub both_ways: bool,
    /// How long the axis rests before, between and after, seconds.
    pub rest_s: f64,
}

/// The commanded motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    start_deg: f64,
    legs: Vec<Leg>,
    end_s: f64,
}

/// What is no motion.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum MotionError {
    /// A number that is not finite, or not above what it has to be.
    #[error("sim: motion: {key}: expected {what}, got {got}")]
    Number {
        /// Which: as [`Sweeps`] and [`Motion::fixed`] call it.
        key: &'static str,
        /// What it was to be.
        what: &'static str,
        /// What it is.
        got: f64,
    },
    /// More ways than anyone waits for.
    #[error("sim: motion: expected at most {most} sweeps, got {got}")]
    TooMany {
        /// How many there may be.
        most: u32,
        /// How many were asked for.
        got: u32,
    },
}

/// The most sweeps of a motion.
const MOST_SWEEPS: u32 = 10_000;

impl Motion {
    /// A sensor that stands still at an angle for so long.
    ///
    /// # Errors
    /// [`MotionError::Number`] for an angle that is not finite or a time that is not above 0.
    pub fn fixed(angle_deg: f64, duration_s: f64) -> Result<Self, MotionError> {
        finite("angle_deg", "an angle in degrees", angle_deg)?;
        above_0("duration_s", "a duration above 0 s", duration_s)?;
        Ok(Self {
            start_deg: angle_deg,
            legs: Vec::new(),
            end_s: duration_s,
        })
    }

    /// Sweeps one after the other. With `accel_deg_s2` each is a trapezoid, or a triangle where the way is too short; without, its speed is there
    /// at once, as ideal scan patterns have it.
    ///
    /// # Errors
    /// [`MotionError`] for numbers that are not what [`Sweeps`] says.
    pub fn sweeps(wish: &Sweeps) -> Result<Self, MotionError> {
        finite("from_deg", "an angle in degrees", wish.from_deg)?;
        finite("to_deg", "an angle in degrees", wish.to_deg)?;
        above_0("speed_deg_s", "a speed above 0 deg/s", wish.speed_deg_s)?;
        if let Some(accel) = wish.accel_deg_s2 {
            above_0("accel_deg_s2", "an acceleration above 0 deg/s2", accel)?;
        }
        if !(wish.rest_s >= 0.0 && wish.rest_s.is_finite()) {
            return Err(MotionError::Number {
                key: "rest_s",
                what: "a rest of 0 s or more",
                got: wish.rest_s,
            });
        }
        if wish.count > MOST_SWEEPS {
            return Err(MotionError::TooMany {
                most: MOST_SWEEPS,
                got: wish.count,
            });
        }
        let mut motion = Self {
            start_deg: wish.from_deg,
            legs: Vec::new(),
            end_s: wish.rest_s,
        };
        for number in 0..wish.count {
            let back = wish.both_ways && number % 2 == 1;
            let (from, to) = match back {
                false => (wish.from_deg, wish.to_deg),
                true => (wish.to_deg, wish.from_deg),
            };
            if number > 0 && !wish.both_ways {
                motion.leg(to, from, wish, false);
            }
            motion.leg(from, to, wish, true);
        }
        Ok(motion)
    }

    fn leg(&mut self, from_deg: f64, to_deg: f64, wish: &Sweeps, sweep: bool) {
        let way = (to_deg - from_deg).abs();
        let (speed, ramp_s) = match wish.accel_deg_s2 {
            None => (wish.speed_deg_s, 0.0),
            Some(accel) => {
                // A way shorter than both ramps is a triangle.
                let speed = wish.speed_deg_s.min((accel * way).sqrt());
                (speed, speed / accel)
            }
        };
        let duration_s = if speed > 0.0 {
            way / speed + ramp_s
        } else {
            0.0
        };
        let begin_s = self.end_s;
        self.legs.push(Leg {
            begin_s,
            end_s: begin_s + duration_s,
            from_deg,
            to_deg,
            cruise_deg_s: speed.copysign(to_deg - from_deg),
            ramp_s,
            sweep,
        });
        self.end_s = begin_s + duration_s + wish.rest_s;
    }

    /// The ways, in order of time.
    #[must_use]
    pub fn legs(&self) -> &[Leg] {
        &self.legs
    }

    /// When all of it is over, rests included, seconds.
    #[must_use]
    pub const fn end_s(&self) -> f64 {
        self.end_s
    }

    /// Whether it never moves.
    #[must_use]
    pub fn is_fixed(&self) -> bool {
        self.legs.is_empty()
    }

    /// The angle and its rate at a time; before the beginning and after the end it stands.
    #[inline]
    #[must_use]
    pub fn at(&self, at_s: f64) -> Stand {
        let begun = self.legs.partition_point(|leg| leg.begin_s <= at_s);
        match begun.checked_sub(1).and_then(|last| self.legs.get(last)) {
            None => Stand {
                angle_deg: self.start_deg,
                rate_deg_s: 0.0,
            },
            Some(leg) => leg.at(at_s),
        }
    }
}

impl Leg {
    /// Counted from whichever end is nearer, so that both are met exactly.
    fn at(&self, at_s: f64) -> Stand {
        if at_s >= self.end_s {
            return Stand {
                angle_deg: self.to_deg,
                rate_deg_s: 0.0,
            };
        }
        let (since, left) = (at_s - self.begin_s, self.end_s - at_s);
        let first_half = since <= left;
        let near = if first_half { since } else { left };
        let (way, rate_deg_s) = if near < self.ramp_s {
            let rate = self.cruise_deg_s * (near / self.ramp_s);
            (0.5 * rate * near, rate)
        } else {
            (
                self.cruise_deg_s * (near - 0.5 * self.ramp_s),
                self.cruise_deg_s,
            )
        };
        let angle_deg = match first_half {
            true => self.from_deg + way,
            false => self.to_deg - way,
        };
        Stand {
            angle_deg,
            rate_deg_s,
        }
    }
}

fn finite(key: &'static str, what: &'static str, got: f64) -> Result<(), MotionError> {
    match got.is_finite() {
        true => Ok(()),
        false => Err(MotionError::Number { key, what, got }),
    }
}

fn above_0(key: &'static str, what: &'static str, got: f64) -> Result<(), MotionError> {
    match got > 0.0 && got.is_finite() {
        true => Ok(()),
        false => Err(MotionError::Number { key, what, got }),
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
    fn the_cards_sweep_takes_0_811_s() {
        let motion = Motion::sweeps(&sweeps()).unwrap();
        let [leg] = motion.legs() else { panic!() };
        // 45 / 56.25 s and one ramp of 56.25 / 5000 s.
        assert!((leg.end_s - leg.begin_s - 0.811_25).abs() < 1e-12);
        assert!((motion.end_s() - 1.011_25).abs() < 1e-12);
        assert_eq!(motion.at(0.05).angle_deg, 0.0);
        assert_eq!(motion.at(leg.end_s).angle_deg, -45.0);
        let middle = motion.at(0.1 + 0.811_25 / 2.0);
        assert!((middle.angle_deg + 22.5).abs() < 1e-12 && middle.rate_deg_s == -56.25);
    }

    #[test]
    fn an_ideal_sweep_is_a_straight_line() {
        let motion = Motion::sweeps(&Sweeps {
            to_deg: 180.0,
            speed_deg_s: 120.0,
            accel_deg_s2: None,
            rest_s: 0.0,
            ..sweeps()
        })
        .unwrap();
        assert_eq!(motion.end_s(), 1.5);
        for at_s in [0.0, 0.3, 0.75, 1.0, 1.4999] {
            let stand = motion.at(at_s);
            assert!((stand.angle_deg - 120.0 * at_s).abs() < 1e-12);
            assert_eq!(stand.rate_deg_s, 120.0);
        }
    }

    #[test]
    fn one_way_goes_back_unscanned_and_both_ways_scans_it() {
        let of = |both_ways| {
            let wish = Sweeps {
                count: 3,
                both_ways,
                ..sweeps()
            };
            let motion = Motion::sweeps(&wish).unwrap();
            let ways = motion.legs().iter();
            ways.map(|leg| (leg.to_deg, leg.sweep)).collect::<Vec<_>>()
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
    fn what_is_no_motion_is_said() {
        let error = Motion::sweeps(&Sweeps {
            speed_deg_s: 0.0,
            ..sweeps()
        });
        let said = error.unwrap_err().to_string();
        assert_eq!(
            said,
            "sim: motion: speed_deg_s: expected a speed above 0 deg/s, got 0"
        );
        assert!(Motion::fixed(f64::NAN, 1.0).is_err());
        assert!(Motion::fixed(0.0, 0.0).is_err());
        let many = Sweeps {
            count: 10_001,
            ..sweeps()
        };
        assert!(Motion::sweeps(&many).is_err());
        assert_eq!(Motion::fixed(-20.0, 1.0).unwrap().at(0.5).angle_deg, -20.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        /// Whatever the profile (trapezoid, triangle, no way at all): it is continuous, its rate is its slope, and it gets there.
        #[test]
        fn the_rate_is_the_slope_of_the_angle(
            from in -180.0..180.0, to in -180.0..180.0, speed in 0.01..500.0, accel in 1.0..1e5, both: bool, count in 0_u32..4,
        ) {
            let wish = Sweeps {
                from_deg: from, to_deg: to, speed_deg_s: speed, accel_deg_s2: Some(accel), count, both_ways: both, rest_s: 0.05,
            };
            let motion = Motion::sweeps(&wish).unwrap();
            let end_s = motion.end_s();
            for step in 0..=200 {
                let at_s = end_s * f64::from(step) / 200.0;
                let h = 1e-7 * (1.0 + end_s);
                let (before, now, after) = (motion.at(at_s - h), motion.at(at_s), motion.at(at_s + h));
                let slope = (after.angle_deg - before.angle_deg) / (2.0 * h);
                let bound = accel * h + 1e-12 * 360.0 / h;
                prop_assert!((slope - now.rate_deg_s).abs() <= bound, "{slope} {now:?} at {at_s}");
                prop_assert!(now.rate_deg_s.abs() <= speed * (1.0 + 1e-12));
            }
            let last = motion.legs().last().map_or(from, |leg| leg.to_deg);
            prop_assert_eq!(motion.at(end_s).angle_deg, last);
        }
    }
}
