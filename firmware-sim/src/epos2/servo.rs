//! The response of the motor to a moving demand: a linear servo of first or second order, in
//! integers.
//!
//! The demand is linear within each millisecond, in sixteen steps (semi-implicit Euler, which
//! cannot gain energy). Not simulated: the current loop, saturation of the current, friction and
//! other nonlinear effects.

use super::fixed::{FINE_PER_QC, Fine};

/// The servo of the position controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Servo {
    /// `x' = w (d - x)`
    FirstOrder {
        /// Corner frequency, 1/1000 Hz, limited to 0.1 Hz to 200 Hz.
        corner_millihertz: u32,
    },
    /// `x'' = w^2 (d - x) - 2 z w x'`
    SecondOrder {
        /// Natural frequency, 1/1000 Hz, limited to 0.1 Hz to 200 Hz.
        natural_millihertz: u32,
        /// Damping ratio in thousandths, limited to 100 to 4000; 1000 is critical damping.
        damping_permille: u32,
    },
}

/// Fractional bits of frequencies, in radians per millisecond.
const RATE_BITS: u32 = 32;
/// Fractional bits of the state below a position unit.
const STATE_BITS: u32 = 16;
/// Steps per millisecond.
const STEPS: i128 = 16;
/// 2 pi with [`RATE_BITS`].
const TWO_PI: i128 = 26_986_075_409;
/// Largest distance from a resting demand, and speed per millisecond, at which the shaft comes to
/// rest: a thousandth of a quadcount. In a real drive friction holds the shaft.
const STANDSTILL: i128 = (FINE_PER_QC as i128 / 1_000) << STATE_BITS;

/// State of a servo: position units with [`STATE_BITS`], speed in the same per millisecond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Follower {
    servo: Servo,
    demand: Fine,
    at: i128,
    speed: i128,
}

impl Follower {
    pub const fn new(servo: Servo, position: Fine) -> Self {
        Self {
            servo,
            demand: position,
            at: (position as i128) << STATE_BITS,
            speed: 0,
        }
    }

    /// Rests at `position`, which is also the demand.
    pub const fn rest_at(&mut self, position: Fine) {
        *self = Self::new(self.servo, position);
    }

    /// Shifts demand and shaft.
    pub fn shift(&mut self, by: Fine) {
        self.demand = self.demand.saturating_add(by);
        self.at += i128::from(by) << STATE_BITS;
    }

    /// Position of the shaft without obstacles.
    pub const fn position(&self) -> Fine {
        // Between two positions, so it fits.
        (self.at >> STATE_BITS) as Fine
    }

    /// Advances by one millisecond, in which the demand moves to `demand`.
    pub fn follow(&mut self, demand: Fine) {
        let from = i128::from(self.demand) << STATE_BITS;
        let way = (i128::from(demand) << STATE_BITS) - from;
        for step in 1..=STEPS {
            self.step(from + way * step / STEPS);
        }
        let ahead = (i128::from(demand) << STATE_BITS) - self.at;
        if way == 0 && ahead.abs() < STANDSTILL && self.speed.abs() < STANDSTILL {
            self.rest_at(demand);
        }
        self.demand = demand;
    }

    fn step(&mut self, demand: i128) {
        let ahead = demand - self.at;
        match self.servo {
            Servo::FirstOrder { corner_millihertz } => {
                self.speed = (ahead * radians(corner_millihertz)) >> RATE_BITS;
            }
            Servo::SecondOrder {
                natural_millihertz,
                damping_permille,
            } => {
                let w = radians(natural_millihertz);
                let damping = i128::from(damping_permille.clamp(100, 4_000));
                let pull = (((ahead * w) >> RATE_BITS) * w) >> RATE_BITS;
                let brake = ((self.speed * w) >> RATE_BITS) * 2 * damping / 1_000;
                self.speed += (pull - brake) / STEPS;
            }
        }
        self.at += self.speed / STEPS;
    }
}

/// Radians per millisecond.
fn radians(millihertz: u32) -> i128 {
    TWO_PI * i128::from(millihertz.clamp(100, 200_000)) / 1_000_000
}

#[cfg(test)]
mod tests {
    use super::super::fixed::{WORLD_END, fine, floor_qc};
    use super::*;

    const REFERENCE: Servo = Servo::SecondOrder {
        natural_millihertz: 15_000,
        damping_permille: 800,
    };

    fn qc(follower: &Follower) -> f64 {
        follower.position() as f64 / FINE_PER_QC as f64
    }

    /// The closed forms of the settled lag behind a demand of 37.5 qc/ms: 2 z / w and 1 / w.
    #[test]
    fn the_lag_behind_a_ramp_matches_the_closed_form() {
        let (w, z, rate) = (15.0 * core::f64::consts::TAU, 0.8_f64, 37_500.0);
        let first = Servo::FirstOrder {
            corner_millihertz: 15_000,
        };
        let mut second = (Follower::new(REFERENCE, 0), 0.0_f64);
        let mut one = (Follower::new(first, 0), 0.0_f64);
        for ms in 1..=400 {
            let demand = fine(37 * ms) + FINE_PER_QC / 2 * ms;
            second.0.follow(demand);
            one.0.follow(demand);
            let t = ms as f64 * 1e-3;
            // Ramp response of w^2 / (s^2 + 2 z w s + w^2), z < 1.
            let wd = w * (1.0 - z * z).sqrt();
            let decay = (-z * w * t).exp();
            let swing =
                decay * (2.0 * z / w * (wd * t).cos() + (2.0 * z * z - 1.0) / wd * (wd * t).sin());
            let closed = rate * (t - 2.0 * z / w + swing);
            second.1 = second.1.max((qc(&second.0) - closed).abs());
            let closed = rate * (t - 1.0 / w + (-w * t).exp() / w);
            one.1 = one.1.max((qc(&one.0) - closed).abs());
        }
        // Steps of 62.5 us: a lag of 637 qc (398 qc) within half a percent, including half a step
        // of the demand.
        assert!(second.1 < 3.0 && one.1 < 3.0, "{} {}", second.1, one.1);
        assert!((qc(&second.0) - 37.5 * 400.0 + 636.6).abs() < 3.0);
    }

    #[test]
    fn the_servo_comes_to_rest_on_its_target_count() {
        for damping_permille in [0, 300, 800, 1_000, u32::MAX] {
            for natural_millihertz in [3_000, 15_000, 150_000, u32::MAX] {
                for target in [-3_000, -1, 1, 30_000] {
                    let mut follower = Follower::new(
                        Servo::SecondOrder {
                            natural_millihertz,
                            damping_permille,
                        },
                        fine(7),
                    );
                    for _ in 0..20_000 {
                        follower.follow(fine(target));
                    }
                    assert_eq!(follower.position(), fine(target));
                }
            }
        }
    }

    #[test]
    fn the_ends_of_the_position_range_do_not_overflow() {
        for servo in [
            REFERENCE,
            Servo::SecondOrder {
                natural_millihertz: u32::MAX,
                damping_permille: u32::MAX,
            },
            Servo::FirstOrder {
                corner_millihertz: u32::MAX,
            },
        ] {
            let mut follower = Follower::new(servo, -WORLD_END);
            for ms in 0..5_000 {
                follower.follow(if ms % 1_000 < 500 {
                    WORLD_END
                } else {
                    -WORLD_END
                });
            }
            assert!(floor_qc(follower.position()).abs() <= 2 * i64::from(i32::MAX));
        }
    }
}
