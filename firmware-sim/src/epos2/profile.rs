//! The position profile (Firmware Specification, "Profile Position Mode"): a trapezoid of speed
//! with linear or sin2 ramps ("Motion Profile Type" 0 and 1).
//!
//! Planned once, then evaluated in closed form at each millisecond: brake if the target is behind,
//! change to the cruise speed, cruise, and a landing counted backwards from the target, which is
//! therefore met exactly. A move too short for the cruise speed has none. A new plan begins at the
//! present speed without acceleration. Not here: the limits' sources (607F, 60C5).

use super::fixed::{BITS, Fine, MS, Speed, distance, div_ceil};
use super::leg::ProfileLeg;
use super::ramp::{RampShape, Sin2Progress};

/// Limits of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct MotionLimits {
    /// Cruise speed, above zero; signed where it is a speed to hold.
    pub speed: Speed,
    /// Peak, rpm/s, above zero.
    pub acceleration: u32,
    /// Peak, rpm/s, above zero.
    pub deceleration: u32,
    pub shape: RampShape,
}

/// The generator cannot use the parameters: a limit is zero or the move would last longer than 2^31
/// ms. The drive's error for it is 6320, "too high target position with too low profile velocity".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct UnusableParameters;

/// A move that ends at rest on its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TrapezoidalProfile {
    qc_per_turn: u32,
    /// Brake to zero, change to the cruise speed, cruise; those not needed last no time.
    legs: [ProfileLeg; 3],
    landing: FinalLeg,
}

/// The last stretch, counted back from the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct FinalLeg {
    target: Fine,
    forward: bool,
    /// Mean.
    deceleration: u32,
    shape: RampShape,
    duration: i128,
    /// State at its start: its speed and the remaining distance. The duration is rounded up, so its
    /// formula alone would begin a fraction above both.
    peak: Speed,
    length: Fine,
}

/// The longest move, ms.
const LONGEST: i128 = (1 << 31) * MS;

impl TrapezoidalProfile {
    /// The move from `from`, where the speed is `speed`, to `target`.
    pub fn plan(
        from: Fine,
        speed: Speed,
        target: Fine,
        limits: MotionLimits,
        qc_per_turn: u32,
    ) -> Result<Self, UnusableParameters> {
        if limits.speed <= Speed::ZERO || limits.acceleration == 0 || limits.deceleration == 0 {
            return Err(UnusableParameters);
        }
        // Ramps of one mean acceleration cover one distance, whatever their shape.
        let limits = MotionLimits {
            acceleration: limits.shape.mean_rate(limits.acceleration),
            deceleration: limits.shape.mean_rate(limits.deceleration),
            ..limits
        };
        let brake = ProfileLeg::change(from, speed, Speed::ZERO, limits.deceleration, limits.shape);
        let standstill = brake.finish(qc_per_turn);
        let (brake, from, entry) = if overshoots(from, speed, standstill, target) {
            (brake, standstill, Speed::ZERO)
        } else {
            (ProfileLeg::default(), from, Speed(speed.0.abs()))
        };
        let profile = Self::onward(brake, from, entry, target, limits, qc_per_turn);
        if profile.duration() > LONGEST {
            return Err(UnusableParameters);
        }
        Ok(profile)
    }

    /// The part after braking: `target` is ahead, far enough to stop from `entry`, a speed towards
    /// it.
    fn onward(
        brake: ProfileLeg,
        from: Fine,
        entry: Speed,
        target: Fine,
        limits: MotionLimits,
        qc_per_turn: u32,
    ) -> Self {
        let forward = target >= from;
        let signed = |speed: Speed| Speed(if forward { speed.0 } else { -speed.0 });
        let length = i128::from(target) - i128::from(from);
        let peak = peak(length.abs(), entry, limits, qc_per_turn);
        let acceleration = if peak < entry {
            limits.deceleration
        } else {
            limits.acceleration
        };
        let change = ProfileLeg::change(
            from,
            signed(entry),
            signed(peak),
            acceleration,
            limits.shape,
        );
        let cruise_from = change.finish(qc_per_turn);
        let work = peak.squared() / i128::from(limits.deceleration);
        let landing_length = distance(work, qc_per_turn);
        let cruised =
            (i128::from(target) - i128::from(cruise_from)).abs() - i128::from(landing_length);
        let per_ms = i128::from(peak.0) * 2 * i128::from(qc_per_turn);
        let duration = if per_ms == 0 {
            0
        } else {
            div_ceil(cruised.max(0) << (2 * BITS), per_ms)
        };
        Self {
            qc_per_turn,
            legs: [
                brake,
                change,
                ProfileLeg::cruise(cruise_from, signed(peak), duration),
            ],
            landing: FinalLeg {
                target,
                forward,
                deceleration: limits.deceleration,
                shape: limits.shape,
                duration: div_ceil(i128::from(peak.0), i128::from(limits.deceleration)),
                peak,
                length: landing_length,
            },
        }
    }

    /// ms with 32 fractional bits.
    pub fn duration(&self) -> i128 {
        self.legs.iter().map(|leg| leg.duration).sum::<i128>() + self.landing.duration
    }

    /// Position and speed at `time`, in ms with 32 fractional bits; `None` once it is over.
    pub fn at(&self, mut time: i128) -> Option<(Fine, Speed)> {
        for leg in &self.legs {
            if time < leg.duration {
                return Some(leg.at(time, self.qc_per_turn));
            }
            time -= leg.duration;
        }
        self.landing.at(time, self.qc_per_turn)
    }

    pub const fn target(&self) -> Fine {
        self.landing.target
    }
}

impl FinalLeg {
    fn at(&self, time: i128, qc_per_turn: u32) -> Option<(Fine, Speed)> {
        let left = self.duration - time;
        if left <= 0 {
            return None;
        }
        let peak = i128::from(self.peak.0);
        let (work, speed) = match self.shape {
            RampShape::Linear => {
                let speed = i128::from(self.deceleration) * left;
                (speed.saturating_mul(left), speed.min(peak))
            }
            RampShape::Sin2 => {
                let progress = Sin2Progress::at(left, self.duration);
                (peak * progress.integral, progress.of(peak))
            }
        };
        let to_go = distance(work, qc_per_turn).min(self.length);
        let speed = speed as i64;
        Some(if self.forward {
            (self.target.saturating_sub(to_go), Speed(speed))
        } else {
            (self.target.saturating_add(to_go), Speed(-speed))
        })
    }
}

/// Whether braking at once ends beyond the target, or the target is behind.
fn overshoots(from: Fine, speed: Speed, standstill: Fine, target: Fine) -> bool {
    match speed.0.signum() {
        0 => false,
        1 => standstill > target || target < from,
        _ => standstill < target || target > from,
    }
}

/// The highest speed of a move of `length` position units entered at `entry`.
///
/// With `w = length / qc_per_turn`, the move's work: `(peak^2 - entry^2) / a + peak^2 / d <= w`.
fn peak(length: i128, entry: Speed, limits: MotionLimits, qc_per_turn: u32) -> Speed {
    let (a, d) = (
        i128::from(limits.acceleration),
        i128::from(limits.deceleration),
    );
    if entry >= limits.speed {
        return limits.speed;
    }
    let work = (length << (2 * BITS)) / i128::from(qc_per_turn.max(1));
    let top = limits.speed.squared();
    if (top - entry.squared()) / a + top / d <= work {
        return limits.speed;
    }
    // Each product is at most peak^2 (1/a + 1/d) or peak^2, so below 2^116.
    let share = (work + entry.squared() / a) / (a + d);
    let peak = (share * d * a).unsigned_abs().isqrt() as i64;
    Speed(peak.clamp(entry.0, limits.speed.0))
}

#[cfg(test)]
#[path = "profile_tests.rs"]
mod tests;
