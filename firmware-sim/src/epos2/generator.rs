//! The demand, per millisecond: at rest, on a position profile, or at a speed reached by a ramp.

use super::fixed::{Fine, MS, Speed, WORLD_END};
use super::leg::ProfileLeg;
use super::profile::{MotionLimits, TrapezoidalProfile, UnusableParameters};
use super::ramp::RampShape;

/// The demand and its motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Generator {
    /// Resolution of the encoder; changes only at rest.
    pub qc_per_turn: u32,
    /// The demand at the end of the present millisecond.
    pub position: Fine,
    pub speed: Speed,
    motion: DemandMotion,
    /// Since the motion began: ms with 32 fractional bits.
    time: i128,
}

#[derive(Clone, Copy, Debug)]
enum DemandMotion {
    Rest,
    TrapezoidalProfile(TrapezoidalProfile),
    /// To zero if the direction changes, to the speed, then constant.
    Ramp([ProfileLeg; 2]),
}

impl Generator {
    pub fn new(position: Fine, qc_per_turn: u32) -> Self {
        Self {
            qc_per_turn,
            position,
            speed: Speed::ZERO,
            motion: DemandMotion::Rest,
            time: 0,
        }
    }

    pub const fn is_moving(&self) -> bool {
        !matches!(self.motion, DemandMotion::Rest)
    }

    /// Stops at once at the present position.
    pub fn freeze(&mut self) {
        self.speed = Speed::ZERO;
        self.motion = DemandMotion::Rest;
        self.time = 0;
    }

    /// Rests at `position`: without power the demand equals the position of the shaft.
    pub fn rest_at(&mut self, position: Fine) {
        self.freeze();
        self.position = position;
    }

    /// Shifts the motion as a whole, speeds unchanged. A profile, which has a fixed target, is not
    /// shifted.
    pub fn shift(&mut self, by: Fine) {
        match &mut self.motion {
            DemandMotion::TrapezoidalProfile(_) => return,
            DemandMotion::Rest => {}
            DemandMotion::Ramp(legs) => {
                for leg in legs {
                    leg.from = leg.from.saturating_add(by);
                }
            }
        }
        self.position = self.position.saturating_add(by);
    }

    /// Moves to `target` from the present motion.
    pub fn go_to(&mut self, target: Fine, limits: MotionLimits) -> Result<(), UnusableParameters> {
        let target = target.clamp(-WORLD_END, WORLD_END);
        let profile =
            TrapezoidalProfile::plan(self.position, self.speed, target, limits, self.qc_per_turn)?;
        self.begin(DemandMotion::TrapezoidalProfile(profile));
        Ok(())
    }

    /// Ramps to rest.
    pub fn stop(&mut self, deceleration: u32, shape: RampShape) {
        self.run_at(MotionLimits {
            speed: Speed::ZERO,
            acceleration: deceleration,
            deceleration,
            shape,
        });
    }

    /// Ramps to a speed of either direction and holds it; speed zero is a stop.
    pub fn run_at(&mut self, limits: MotionLimits) {
        let MotionLimits { speed, shape, .. } = limits;
        let [acceleration, deceleration] =
            [limits.acceleration, limits.deceleration].map(|peak| shape.mean_rate(peak));
        if speed == Speed::ZERO && self.speed == Speed::ZERO {
            self.freeze();
            return;
        }
        let reverses = self.speed.0.signum() * speed.0.signum() < 0;
        let turn = if reverses { Speed::ZERO } else { self.speed };
        let stop = ProfileLeg::change(self.position, self.speed, turn, deceleration, shape);
        let from = if reverses {
            stop.finish(self.qc_per_turn)
        } else {
            self.position
        };
        let slows = speed.0.unsigned_abs() < turn.0.unsigned_abs();
        let rate = if slows { deceleration } else { acceleration };
        let change = ProfileLeg::change(from, turn, speed, rate, shape);
        self.begin(DemandMotion::Ramp([stop, change]));
    }

    fn begin(&mut self, motion: DemandMotion) {
        self.motion = motion;
        self.time = 0;
    }

    /// Advances by one millisecond.
    pub fn step(&mut self) {
        self.time += MS;
        let (position, speed) = match &self.motion {
            DemandMotion::Rest => return,
            DemandMotion::TrapezoidalProfile(profile) => match profile.at(self.time) {
                Some(now) => now,
                None => {
                    self.position = profile.target();
                    self.freeze();
                    return;
                }
            },
            DemandMotion::Ramp(legs) => {
                let now = self.on_ramp(legs);
                if now.1 == Speed::ZERO && self.time >= legs[0].duration + legs[1].duration {
                    self.position = now.0.clamp(-WORLD_END, WORLD_END);
                    self.freeze();
                    return;
                }
                now
            }
        };
        self.position = position.clamp(-WORLD_END, WORLD_END);
        self.speed = speed;
        if self.position != position {
            self.freeze();
        }
    }

    fn on_ramp(&self, [stop, change]: &[ProfileLeg; 2]) -> (Fine, Speed) {
        if self.time < stop.duration {
            return stop.at(self.time, self.qc_per_turn);
        }
        let time = self.time - stop.duration;
        if time < change.duration {
            return change.at(time, self.qc_per_turn);
        }
        let from = change.finish(self.qc_per_turn);
        ProfileLeg::cruise(from, change.end, 0).at(time - change.duration, self.qc_per_turn)
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixed::{FINE_PER_QC, fine, floor_qc};
    use super::*;

    fn linear(rpm: i32, acceleration: u32, deceleration: u32) -> MotionLimits {
        MotionLimits {
            speed: Speed::from_rpm(rpm),
            acceleration,
            deceleration,
            shape: RampShape::Linear,
        }
    }

    #[test]
    fn a_ramp_reverses_through_zero_and_keeps_its_speed() {
        let mut generator = Generator::new(0, 2000);
        generator.run_at(linear(60, 600, 600)); // 2 qc/ms after 100 ms
        for _ in 0..200 {
            generator.step();
        }
        assert_eq!(generator.speed, Speed::from_rpm(60));
        assert_eq!(floor_qc(generator.position), 100 + 200);
        generator.run_at(linear(-60, 600, 600));
        for _ in 0..300 {
            generator.step();
        }
        assert_eq!(generator.position, fine(300 - 200));
        assert_eq!(generator.speed, Speed::from_rpm(-60));
        generator.stop(600, RampShape::Linear);
        for _ in 0..100 {
            generator.step();
        }
        assert!(!generator.is_moving());
        assert_eq!(generator.position, fine(0));
    }

    #[test]
    fn a_slow_ramp_does_not_drift_in_a_quarter_of_an_hour() {
        // 1 rpm is 1/30 qc/ms, which has no finite binary representation.
        let mut generator = Generator::new(0, 2000);
        generator.run_at(linear(1, 1000, 1)); // at speed after 1 ms
        for _ in 0..900_001 {
            generator.step();
        }
        assert_eq!(generator.position, fine(30_000) + FINE_PER_QC / 60);
    }

    #[test]
    fn the_generator_stops_at_the_end_of_the_position_range() {
        let mut generator = Generator::new(WORLD_END - 5, 10_000_000);
        generator.run_at(linear(25_000, u32::MAX, 1));
        for _ in 0..3 {
            generator.step();
        }
        assert_eq!(generator.position, WORLD_END);
        assert!(!generator.is_moving());
    }
}

#[cfg(test)]
#[path = "generator_tests.rs"]
mod closed_form;
