//! Angles of shaft and platform at any time: the commanded motion itself, or what the mechanism
//! makes of it step by step.

use crate::effects::{AxisAngles, MechanismEffect, STEP_S};
use crate::motion::{AxisMotion, AxisState};
use crate::packet_maker::Platform;

/// The motion as it is carried out.
#[derive(Clone, Debug)]
pub(super) struct AxisCourse {
    motion: AxisMotion,
    /// Shaft and platform angle at each step; empty without a mechanism.
    steps: Vec<[f64; 2]>,
}

/// Indices of a step's angles.
const SHAFT: usize = 0;
const PLATFORM: usize = 1;

/// Steps beyond the end of the motion, so that the last firings lie between two steps.
const STEPS_BEYOND_END: usize = 64;

impl AxisCourse {
    /// The course of a motion. The mechanism is stepped only if it is present.
    pub fn new<M: MechanismEffect>(motion: &AxisMotion, mechanism: &mut M) -> Self {
        let mut steps = Vec::new();
        if mechanism.is_present() {
            let count = (motion.end_s / STEP_S).ceil() as usize + STEPS_BEYOND_END;
            steps.reserve_exact(count);
            steps.extend((0..count).map(|step| {
                let time_s = step as f64 * STEP_S;
                let commanded_deg = motion.at(time_s).angle_deg;
                let mut axis = AxisAngles {
                    commanded_deg,
                    shaft_deg: commanded_deg,
                    platform_deg: commanded_deg,
                };
                mechanism.step(time_s, &mut axis);
                [axis.shaft_deg, axis.platform_deg]
            }));
        }
        Self {
            motion: motion.clone(),
            steps,
        }
    }

    /// Angle of the motor shaft in degrees of tilt.
    pub fn shaft_deg(&self, time_s: f64) -> f64 {
        self.interpolated(time_s, SHAFT).angle_deg
    }

    #[inline]
    fn interpolated(&self, time_s: f64, part: usize) -> AxisState {
        if self.steps.is_empty() {
            return self.motion.at(time_s);
        }
        let steps = (time_s / STEP_S).clamp(0.0, (self.steps.len() - 1) as f64);
        let step = steps as usize;
        let angle = |step: usize| {
            let angles = self.steps.get(step).or(self.steps.last());
            angles.map_or(0.0, |angles| angles[part])
        };
        let (from, to) = (angle(step), angle(step + 1));
        AxisState {
            angle_deg: from + (to - from) * (steps - step as f64),
            rate_deg_s: (to - from) / STEP_S,
        }
    }
}

impl Platform for AxisCourse {
    #[inline]
    fn state(&self, host_ns: i64) -> Option<AxisState> {
        Some(self.interpolated(host_ns as f64 * 1e-9, PLATFORM))
    }
}
