//! The shaft: it follows its demand exactly, or with the lag of a [`Servo`], unless something
//! blocks it.
//!
//! A hard stop or a jam holds the shaft while the servo continues; released, it catches up at a
//! limited speed. The current is proportional to the distance between shaft and servo, as in a
//! proportional position controller. Without power, gravity and friction move the shaft if the
//! configuration has a load. Ripple is not simulated.

use super::fixed::{FINE_PER_QC, Fine, Speed, WORLD_END, fine};
use super::servo::{Follower, Servo};

/// Current per quadcount of deviation, mA.
const MA_PER_QC: i64 = 5;
/// Largest catch-up speed, rpm: above the limit of any demand (607F), so that it only acts after a
/// blockage.
const FASTEST_RPM: i64 = 26_000;

/// Shaft, motor and encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct MotorShaft {
    pub position: Fine,
    /// The servo without obstacles; `None`: it equals the demand.
    servo: Option<Follower>,
    /// Something blocks it in place.
    pub jammed: bool,
    /// A closed brake holds it against the motor.
    pub braked: bool,
    /// Speed without power, millirpm; `None` under power.
    free_speed: Option<i64>,
    /// Hard stops, world qc: below, above.
    stops: [Option<i32>; 2],
    /// In the last millisecond.
    moved: Fine,
    /// The shaft is not at its demand, also by the lag of the servo.
    pub behind: bool,
    /// The shaft could not follow its servo in the last millisecond, or has not caught up.
    pub held: bool,
}

impl MotorShaft {
    pub const fn new(position: Fine, stops: [Option<i32>; 2], servo: Option<Servo>) -> Self {
        let servo = match servo {
            Some(servo) => Some(Follower::new(servo, position)),
            None => None,
        };
        Self {
            position,
            servo,
            jammed: false,
            braked: false,
            free_speed: None,
            stops,
            moved: 0,
            behind: false,
            held: false,
        }
    }

    /// State after a loss of power; the mechanics are unchanged.
    pub const fn at_power_on(self) -> Self {
        let mut shaft = Self {
            moved: 0,
            behind: false,
            held: false,
            free_speed: Some(0),
            ..self
        };
        shaft.rest();
        shaft
    }

    /// Makes the demand equal to the position.
    pub const fn rest(&mut self) {
        if let Some(servo) = &mut self.servo {
            servo.rest_at(self.position);
        }
    }

    /// Position without obstacles at this demand.
    fn free(&self, demand: Fine) -> Fine {
        self.servo.map_or(demand, |servo| servo.position())
    }

    /// Distance from the position without obstacles; the servo continues from the shaft.
    pub fn give_way(&mut self, demand: Fine) -> Fine {
        let behind = self.position - self.free(demand);
        if let Some(servo) = &mut self.servo {
            servo.shift(behind);
        }
        behind
    }

    /// Advances by one millisecond towards `demand`.
    pub fn follow(&mut self, demand: Fine, qc_per_turn: u32) {
        let [low, high] = self.ends();
        self.free_speed = None;
        if let Some(servo) = &mut self.servo {
            servo.follow(demand);
        }
        let free = self.free(demand);
        let wanted = free.max(low).min(high);
        // One millirpm is twice the quadcounts of a revolution, in position units per millisecond.
        let most = FASTEST_RPM * 1000 * 2 * i64::from(qc_per_turn);
        self.moved = if self.jammed || self.braked {
            0
        } else {
            wanted.saturating_sub(self.position).clamp(-most, most)
        };
        self.position = self.position.saturating_add(self.moved);
        self.behind = self.position != demand;
        self.held = self.position != free;
    }

    /// Advances by one millisecond without power: `gravity` accelerates, `friction` decelerates,
    /// rpm/s. The speed at power-off is that of the last millisecond.
    pub fn coast(&mut self, gravity: i32, friction: u32, qc_per_turn: u32) {
        let qc_per_turn = i64::from(qc_per_turn.max(1));
        let before = self.free_speed.unwrap_or(self.moved / (2 * qc_per_turn));
        // One rpm/s is one millirpm/ms.
        let driven = before + i64::from(gravity);
        let slowed = driven.abs().saturating_sub(friction.into()).max(0);
        let most = FASTEST_RPM * 1000;
        let after = (driven.signum() * slowed).clamp(-most, most);
        // The mean of both speeds, at two position units per millirpm.
        let wanted = self.position.saturating_add((before + after) * qc_per_turn);
        let [low, high] = self.ends();
        let end = wanted.max(low.max(-WORLD_END)).min(high.min(WORLD_END));
        let blocked = self.jammed || end != wanted;
        let end = if self.jammed { self.position } else { end };
        self.moved = end - self.position;
        self.position = end;
        self.free_speed = Some(if blocked { 0 } else { after });
        self.behind = self.moved != 0;
        self.held = false;
    }

    /// Lowest and highest position between the hard stops.
    fn ends(&self) -> [Fine; 2] {
        let [low, high] = self.stops;
        [
            low.map_or(Fine::MIN, |qc| fine(qc.into())),
            high.map_or(Fine::MAX, |qc| fine(qc.into())),
        ]
    }

    /// Speed in the last millisecond.
    pub fn speed(&self, qc_per_turn: u32) -> Speed {
        let per_rpm = 2000 * i64::from(qc_per_turn.max(1));
        // Below the largest speed, so within an i32.
        Speed::from_rpm((self.moved / per_rpm) as i32)
    }

    /// Distance of the demand, qc, with its direction as sign.
    pub const fn following_error(&self, demand: Fine) -> i64 {
        demand.saturating_sub(self.position) / FINE_PER_QC
    }

    /// Current against the obstacle, mA, at most `most_ma`.
    pub fn current_ma(&self, demand: Fine, most_ma: u16) -> i16 {
        let most = i64::from(most_ma).min(i16::MAX.into());
        let wanted = self
            .following_error(self.free(demand))
            .saturating_mul(MA_PER_QC);
        wanted.clamp(-most, most) as i16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shaft_follows_until_a_hard_stop_and_leaves_it_again() {
        let mut shaft = MotorShaft::new(0, [Some(-10), Some(10)], None);
        shaft.follow(fine(7), 2000);
        assert_eq!((shaft.position, shaft.behind), (fine(7), false));
        shaft.follow(fine(15), 2000);
        assert_eq!((shaft.position, shaft.behind), (fine(10), true));
        assert_eq!(shaft.following_error(fine(15)), 5);
        assert_eq!(shaft.current_ma(fine(15), 1000), 25);
        assert_eq!(shaft.current_ma(fine(1500), 1000), 1000);
        shaft.follow(fine(-15), 2000);
        assert_eq!(shaft.position, fine(-10));
        assert_eq!(shaft.current_ma(fine(-15), 1000), -25);
    }

    #[test]
    fn a_released_jam_is_caught_up_no_faster_than_the_motor_can() {
        let mut shaft = MotorShaft::new(0, [None; 2], None);
        shaft.jammed = true;
        shaft.follow(fine(100_000), 2000);
        assert_eq!(shaft.position, 0);
        shaft.jammed = false;
        shaft.follow(fine(100_000), 2000);
        // 26,000 rpm are 866 qc/ms.
        assert_eq!(shaft.position / FINE_PER_QC, 866);
        assert_eq!(shaft.speed(2000), Speed::from_rpm(26_000));
    }

    #[test]
    fn a_lagging_servo_does_not_count_as_blocked() {
        let servo = Servo::SecondOrder {
            natural_millihertz: 15_000,
            damping_permille: 800,
        };
        let mut shaft = MotorShaft::new(0, [None, Some(7_000)], Some(servo));
        for ms in 1..=200 {
            shaft.follow(fine(37 * ms), 2000);
        }
        assert!(shaft.behind && !shaft.held);
        let demand = fine(7_400);
        // 2 x 0.8 / (2 pi 15 Hz) at 37 qc/ms.
        assert!((620..636).contains(&shaft.following_error(demand)));
        assert_eq!(shaft.current_ma(demand, 9_000), 0);
        // The stop blocks the shaft, which draws current.
        for _ in 0..300 {
            shaft.follow(demand, 2000);
        }
        assert!(shaft.held && shaft.position == fine(7_000));
        assert_eq!(shaft.current_ma(demand, 9_000), 2_000);
        assert_eq!(shaft.speed(2000), Speed::ZERO);
        assert_eq!(shaft.give_way(demand), fine(-400));
        assert_eq!(shaft.current_ma(demand, 9_000), 0);
        shaft.rest();
        shaft.follow(shaft.position, 2000);
        assert!(!shaft.behind && !shaft.held);
    }
}
