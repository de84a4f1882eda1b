//! Where shaft and platform are at any time: the commanded motion itself, or what the mechanism makes of it step by step.

use crate::effects::{Axis, Mechanism, STEP_S};
use crate::motion::{Motion, Stand};

/// The motion as it is carried out.
#[derive(Clone, Debug)]
pub(super) struct Course {
    motion: Motion,
    /// Shaft and platform at each step, where a mechanism is asked for.
    steps: Vec<[f64; 2]>,
}

/// Which of the two.
#[derive(Clone, Copy, Debug)]
enum Part {
    Shaft,
    Platform,
}

/// Steps beyond the end, so that the last instants lie between two.
const BEYOND: usize = 64;

impl Course {
    /// The course of a motion. A mechanism is asked only if it says that it needs to be.
    pub fn new<M: Mechanism>(motion: &Motion, mechanism: &mut M) -> Self {
        let mut steps = Vec::new();
        if mechanism.is_there() {
            let count = (motion.end_s() / STEP_S).ceil() as usize + BEYOND;
            steps.reserve_exact(count);
            steps.extend((0..count).map(|step| {
                let at_s = step as f64 * STEP_S;
                let commanded_deg = motion.at(at_s).angle_deg;
                let mut axis = Axis {
                    commanded_deg,
                    shaft_deg: commanded_deg,
                    platform_deg: commanded_deg,
                };
                mechanism.step(at_s, &mut axis);
                [axis.shaft_deg, axis.platform_deg]
            }));
        }
        Self {
            motion: motion.clone(),
            steps,
        }
    }

    /// How the platform is tilted, and how fast that changes.
    #[inline]
    pub fn platform(&self, at_s: f64) -> Stand {
        self.between(at_s, Part::Platform)
    }

    /// Where the motor's shaft is, in degrees of tilt.
    pub fn shaft_deg(&self, at_s: f64) -> f64 {
        self.between(at_s, Part::Shaft).angle_deg
    }

    #[inline]
    fn between(&self, at_s: f64, part: Part) -> Stand {
        if self.steps.is_empty() {
            return self.motion.at(at_s);
        }
        let steps = (at_s / STEP_S).clamp(0.0, (self.steps.len() - 1) as f64);
        let step = steps as usize;
        let of = |step: usize| {
            let pair = self.steps.get(step).or(self.steps.last());
            pair.map_or(0.0, |[shaft, platform]| match part {
                Part::Shaft => *shaft,
                Part::Platform => *platform,
            })
        };
        let (from, to) = (of(step), of(step + 1));
        Stand {
            angle_deg: from + (to - from) * (steps - step as f64),
            rate_deg_s: (to - from) / STEP_S,
        }
    }
}
