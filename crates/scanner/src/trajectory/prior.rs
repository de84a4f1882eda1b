//! Priors: parameters of a motion that the samples do not determine are regularised towards the
//! command.
//!
//! A ramp without samples is regularised alone. If the samples begin or end during the motion or
//! cover its cruise alone, whole directions are undetermined (a later start and a farther beginning
//! are one straight line), and every parameter is regularised. Priors do not affect parameters that
//! the samples determine.

use std::ops::Range;

use super::profile::Profile;

/// Parameters regularised towards the command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RegularisedParameters {
    /// Start of the motion.
    pub start: bool,
    /// Duration of the acceleration.
    pub ramp_up: bool,
    /// Duration of the deceleration.
    pub ramp_down: bool,
    /// End of the motion.
    pub way: bool,
    /// Lag and inertia of the servo.
    pub servo: bool,
}

/// The part of the motion that a parameter belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MotionParameter {
    Start,
    RampUp,
    RampDown,
    Way,
    Servo,
}

/// A regularised parameter: its index, its deviation from the command, and the standard deviation
/// expected of that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prior {
    part: MotionParameter,
    pub index: usize,
    pub deviation: f64,
    pub sd: f64,
}

/// Expected deviation of a ramp or the way from the command, relative.
const RELATIVE_SD: f64 = 0.2;
/// Expected deviation of the start, seconds.
const START_SD_S: f64 = 0.1;
/// Expected deviation of the servo's times, seconds: the time constant of a servo of 15 Hz.
const SERVO_SD_S: f64 = 0.01;
/// Shortest ramp: below it acceleration has no meaning for a motor.
pub(super) const MIN_RAMP_S: f64 = 1e-6;
/// A prior decides if the parameter keeps more than this share of the prior's standard deviation.
const DECISIVE_SHARE: f64 = 0.5;

impl RegularisedParameters {
    /// Every parameter.
    pub(super) const ALL: Self = Self {
        start: true,
        ramp_up: true,
        ramp_down: true,
        way: true,
        servo: true,
    };

    /// Whether any parameter is regularised.
    #[must_use]
    pub const fn any(self) -> bool {
        self.start || self.ramp_up || self.ramp_down || self.way || self.servo
    }

    /// The parameters that priors rather than samples determine, by the `variances` of the fit. At
    /// least one, as without priors the fit has no solution.
    pub(super) fn that_decided(priors: &[Prior], variances: &[f64]) -> Self {
        let remaining = |prior: &Prior| {
            let variance = variances.get(prior.index).copied().unwrap_or_default();
            variance.max(0.0).sqrt() / prior.sd
        };
        let most = priors.iter().map(remaining).fold(0.0, f64::max);
        let mut regularised = Self::default();
        for prior in priors {
            let remaining = remaining(prior);
            if remaining > DECISIVE_SHARE || remaining >= most {
                *regularised.flag(prior.part) = true;
            }
        }
        regularised
    }

    const fn flag(&mut self, part: MotionParameter) -> &mut bool {
        match part {
            MotionParameter::Start => &mut self.start,
            MotionParameter::RampUp => &mut self.ramp_up,
            MotionParameter::RampDown => &mut self.ramp_down,
            MotionParameter::Way => &mut self.way,
            MotionParameter::Servo => &mut self.servo,
        }
    }
}

/// Priors of `now` towards the command `command`. The servo's parameters are at the indexes
/// `servo`.
pub(super) fn priors(
    now: &Profile,
    command: &Profile,
    mut regularised: RegularisedParameters,
    servo: Range<usize>,
) -> Vec<Prior> {
    let ramp_sd = |s: f64| (RELATIVE_SD * s).max(MIN_RAMP_S);
    let inertia_s = |profile: &Profile| profile.inertia_s2.sqrt();
    let all = [
        (
            MotionParameter::Start,
            0,
            now.start_s - command.start_s,
            START_SD_S,
        ),
        (
            MotionParameter::RampUp,
            1,
            now.ramp_up_s - command.ramp_up_s,
            ramp_sd(command.ramp_up_s),
        ),
        (
            MotionParameter::RampDown,
            2,
            now.ramp_down_s - command.ramp_down_s,
            ramp_sd(command.ramp_down_s),
        ),
        (
            MotionParameter::Way,
            4,
            now.way_deg - command.way_deg,
            RELATIVE_SD * command.way_deg.abs(),
        ),
    ];
    let times = [
        now.lag_s - command.lag_s,
        inertia_s(now) - inertia_s(command),
    ];
    let times = times.into_iter().zip(servo);
    all.into_iter()
        .chain(
            times.map(|(deviation, index)| (MotionParameter::Servo, index, deviation, SERVO_SD_S)),
        )
        .filter(|(part, ..)| *regularised.flag(*part))
        .map(|(part, index, deviation, sd)| Prior {
            part,
            index,
            deviation,
            sd,
        })
        .collect()
}
