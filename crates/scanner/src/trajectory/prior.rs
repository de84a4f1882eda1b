//! What holds the parameters of a motion that the samples do not tell: near what was commanded, as
//! far as that may be off.
//!
//! A ramp that no sample sees is held alone. Where samples begin or end in the midst of the motion,
//! or of its cruise alone, there are whole directions in which nothing changes (a later start and a
//! farther beginning are one straight line), and every parameter is held; those that samples tell
//! do not feel it.

use std::ops::Range;

use super::profile::Profile;

/// What the samples do not tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RegularisedParameters {
    /// When the motion began.
    pub start: bool,
    /// The acceleration's duration.
    pub ramp_up: bool,
    /// The deceleration's duration.
    pub ramp_down: bool,
    /// Where the motion would have ended.
    pub way: bool,
    /// The servo's lag and its swing.
    pub servo: bool,
}

/// Of which part of the motion a parameter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MotionParameter {
    Start,
    RampUp,
    RampDown,
    Way,
    Servo,
}

/// A parameter that is held: of what it is, its place among the parameters, how far it is off what
/// was commanded, and how far it may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prior {
    part: MotionParameter,
    pub place: usize,
    pub off: f64,
    pub sd: f64,
}

/// What a ramp or the way may be off what was commanded, as a part of it.
const SHARE: f64 = 0.2;
/// Likewise the start, seconds.
const START_SD_S: f64 = 0.1;
/// Likewise the servo's times: 10 ms, the time constant of a servo of 15 Hz.
const SERVO_SD_S: f64 = 0.01;
/// No ramp is shorter: below it acceleration has no meaning for a motor.
pub(super) const SHORTEST_RAMP_S: f64 = 1e-6;
/// The samples tell a parameter if they leave it less than this of how far it may be anyway.
const TOLD: f64 = 0.5;

impl RegularisedParameters {
    /// Everything.
    pub(super) const ALL: Self = Self {
        start: true,
        ramp_up: true,
        ramp_down: true,
        way: true,
        servo: true,
    };

    /// Whether anything was held.
    #[must_use]
    pub const fn any(self) -> bool {
        self.start || self.ramp_up || self.ramp_down || self.way || self.servo
    }

    /// Of all that was held what decided, the samples having less to say of it; `variances` are
    /// what they and it leave to the parameters. At least one thing, as without any the fit had no
    /// solution.
    pub(super) fn that_decided(priors: &[Prior], variances: &[f64]) -> Self {
        let left = |prior: &Prior| {
            let variance = variances.get(prior.place).copied().unwrap_or_default();
            variance.max(0.0).sqrt() / prior.sd
        };
        let most = priors.iter().map(left).fold(0.0, f64::max);
        let mut held = Self::default();
        for prior in priors {
            let left = left(prior);
            if left > TOLD || left >= most {
                held.set(prior.part);
            }
        }
        held
    }

    const fn set(&mut self, part: MotionParameter) {
        match part {
            MotionParameter::Start => self.start = true,
            MotionParameter::RampUp => self.ramp_up = true,
            MotionParameter::RampDown => self.ramp_down = true,
            MotionParameter::Way => self.way = true,
            MotionParameter::Servo => self.servo = true,
        }
    }

    const fn has(self, part: MotionParameter) -> bool {
        match part {
            MotionParameter::Start => self.start,
            MotionParameter::RampUp => self.ramp_up,
            MotionParameter::RampDown => self.ramp_down,
            MotionParameter::Way => self.way,
            MotionParameter::Servo => self.servo,
        }
    }
}

/// What holds the parameters of `now` near those of `then`: start, ramps, beginning, way in this
/// order, and those of the servo, which are at `servo`.
pub(super) fn priors(
    now: &Profile,
    then: &Profile,
    held: RegularisedParameters,
    servo: Range<usize>,
) -> Vec<Prior> {
    let ramp_sd = |s: f64| (SHARE * s).max(SHORTEST_RAMP_S);
    let inertia_s = |profile: &Profile| profile.inertia_s2.sqrt();
    let all = [
        (
            MotionParameter::Start,
            0,
            now.start_s - then.start_s,
            START_SD_S,
        ),
        (
            MotionParameter::RampUp,
            1,
            now.ramp_up_s - then.ramp_up_s,
            ramp_sd(then.ramp_up_s),
        ),
        (
            MotionParameter::RampDown,
            2,
            now.ramp_down_s - then.ramp_down_s,
            ramp_sd(then.ramp_down_s),
        ),
        (
            MotionParameter::Way,
            4,
            now.way_deg - then.way_deg,
            SHARE * then.way_deg.abs(),
        ),
    ];
    let times = [now.lag_s - then.lag_s, inertia_s(now) - inertia_s(then)];
    let times = times.into_iter().zip(servo);
    all.into_iter()
        .chain(times.map(|(off, place)| (MotionParameter::Servo, place, off, SERVO_SD_S)))
        .filter(|(part, ..)| held.has(*part))
        .map(|(part, place, off, sd)| Prior {
            part,
            place,
            off,
            sd,
        })
        .collect()
}
