//! How the motor follows a demand that moves: a linear servo of first or second order, in integers.
//!
//! The demand is a line over each millisecond, taken in sixteen steps (semi-implicit Euler, so that it cannot gain energy). Left out:
//! the current loop, saturation of the current, friction, and all that is not linear.

use super::fixed::{FINE_PER_QC, Fine};

/// The servo of a unit's position controller, as its shaft shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Servo {
    /// `x' = w (d - x)`
    FirstOrder {
        /// Corner frequency, 1/1000 Hz. Below 0.1 Hz and above 200 Hz it is taken for these.
        corner_millihertz: u32,
    },
    /// `x'' = w^2 (d - x) - 2 z w x'`
    SecondOrder {
        /// Natural frequency, 1/1000 Hz. Below 0.1 Hz and above 200 Hz it is taken for these.
        natural_millihertz: u32,
        /// Damping ratio in thousandths; 1000 does not swing over. Below 100 and above 4000 it is taken for these.
        damping_permille: u32,
    },
}

/// Fractional bits of frequencies, in radians a millisecond.
const RATE_BITS: u32 = 32;
/// Fractional bits of the state below a position unit.
const STATE_BITS: u32 = 16;
/// Steps in a millisecond.
const STEPS: i128 = 16;
/// 2 pi with [`RATE_BITS`].
const TURN: i128 = 26_986_075_409;
/// Closer to a demand that rests, and slower in a millisecond, the shaft stands: a thousandth of a quadcount. Friction holds a real one.
const STANDS: i128 = (FINE_PER_QC as i128 / 1_000) << STATE_BITS;

/// A servo on its way. State in position units with [`STATE_BITS`], speed in the same a millisecond.
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

    /// Stands at `position`, which is its demand as well.
    pub const fn rest_at(&mut self, position: Fine) {
        *self = Self::new(self.servo, position);
    }

    /// Moves demand and shaft alike.
    pub fn shift(&mut self, by: Fine) {
        self.demand = self.demand.saturating_add(by);
        self.at += i128::from(by) << STATE_BITS;
    }

    /// Where the shaft is if nothing holds it.
    pub const fn position(&self) -> Fine {
        // Between positions that are one, so it fits.
        (self.at >> STATE_BITS) as Fine
    }

    /// One millisecond in which the demand goes to `demand`.
    pub fn follow(&mut self, demand: Fine) {
        let from = i128::from(self.demand) << STATE_BITS;
        let way = (i128::from(demand) << STATE_BITS) - from;
        for step in 1..=STEPS {
            self.step(from + way * step / STEPS);
        }
        let ahead = (i128::from(demand) << STATE_BITS) - self.at;
        if way == 0 && ahead.abs() < STANDS && self.speed.abs() < STANDS {
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

/// Radians a millisecond.
fn radians(millihertz: u32) -> i128 {
    TURN * i128::from(millihertz.clamp(100, 200_000)) / 1_000_000
}

#[cfg(test)]
mod tests {
    use super::super::fixed::{WORLD_END, fine, floor_qc};
    use super::*;

    const CARD: Servo = Servo::SecondOrder {
        natural_millihertz: 15_000,
        damping_permille: 800,
    };

    fn qc(follower: &Follower) -> f64 {
        follower.position() as f64 / FINE_PER_QC as f64
    }

    /// The closed forms behind a demand that runs at 37.5 qc a ms: lag 2 z / w and 1 / w, swung in.
    #[test]
    fn behind_a_ramp_it_lags_as_the_closed_form_says() {
        let (w, z, rate) = (15.0 * core::f64::consts::TAU, 0.8_f64, 37_500.0);
        let first = Servo::FirstOrder {
            corner_millihertz: 15_000,
        };
        let mut second = (Follower::new(CARD, 0), 0.0_f64);
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
        // Steps of 62.5 us: a lag of 637 qc (398 qc) to half a hundredth, half a step of the demand among it.
        assert!(second.1 < 3.0 && one.1 < 3.0, "{} {}", second.1, one.1);
        assert!((qc(&second.0) - 37.5 * 400.0 + 636.6).abs() < 3.0);
    }

    #[test]
    fn it_comes_to_rest_on_the_count_it_was_sent_to() {
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
    fn the_ends_of_the_world_are_no_overflow() {
        for servo in [
            CARD,
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
