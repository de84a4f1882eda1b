//! A change of speed, or motion at constant speed, in closed form, without accumulation over
//! milliseconds.

use super::fixed::{BITS, Fine, Speed, distance, div_ceil};
use super::ramp::{RampShape, Sin2Progress};

/// Motion from `from` and `start` to the speed `end`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ProfileLeg {
    pub from: Fine,
    pub start: Speed,
    pub end: Speed,
    /// Mean, rpm/s, equal to millirpm/ms; unsigned.
    pub acceleration: u32,
    pub shape: RampShape,
    /// ms with 32 fractional bits.
    pub duration: i128,
}

impl ProfileLeg {
    /// A change of speed with a mean acceleration, of which 0 counts as 1.
    pub fn change(
        from: Fine,
        start: Speed,
        end: Speed,
        acceleration: u32,
        shape: RampShape,
    ) -> Self {
        let acceleration = acceleration.max(1);
        let change = i128::from(end.0) - i128::from(start.0);
        Self {
            from,
            start,
            end,
            acceleration,
            shape,
            duration: div_ceil(change.abs(), i128::from(acceleration)),
        }
    }

    /// Constant speed for `duration`.
    pub const fn cruise(from: Fine, speed: Speed, duration: i128) -> Self {
        Self {
            from,
            start: speed,
            end: speed,
            acceleration: 0,
            shape: RampShape::Linear,
            duration,
        }
    }

    /// Position and speed at `time` into the leg.
    pub fn at(&self, time: i128, qc_per_turn: u32) -> (Fine, Speed) {
        let (work, speed) = match self.shape {
            RampShape::Linear => self.linear(time),
            RampShape::Sin2 => self.sin2(time),
        };
        let moved = distance(work, qc_per_turn);
        (self.from.saturating_add(moved), Speed(speed as i64))
    }

    fn linear(&self, time: i128) -> (i128, i128) {
        let gained = i128::from(self.acceleration).saturating_mul(time);
        let (start, end) = (i128::from(self.start.0), i128::from(self.end.0));
        let speed = if end >= start {
            (start + gained).min(end)
        } else {
            (start - gained).max(end)
        };
        ((start + speed).saturating_mul(time), speed)
    }

    fn sin2(&self, time: i128) -> (i128, i128) {
        let progress = Sin2Progress::at(time, self.duration);
        let (start, end) = (i128::from(self.start.0), i128::from(self.end.0));
        let work = 2 * start * time + (end - start) * progress.integral;
        (work, start + progress.of(end - start))
    }

    /// Position at the end of a change of speed, from the squares of the speeds and so without the
    /// rounding of its duration.
    pub fn finish(&self, qc_per_turn: u32) -> Fine {
        if self.acceleration == 0 {
            return self.at(self.duration, qc_per_turn).0;
        }
        let (high, low) = (self.start.squared(), self.end.squared());
        // (end^2 - start^2) / a with the sign of the motion; a change of direction has two legs.
        let work = (high.max(low) - high.min(low)) / i128::from(self.acceleration);
        let forward = self.start.0 >= 0 && self.end.0 >= 0;
        let moved = distance(work, qc_per_turn);
        self.from
            .saturating_add(if forward { moved } else { -moved })
    }
}

const _: () = assert!(BITS == 32, "the doc comments say 32");
