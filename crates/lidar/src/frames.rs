//! Splitting of firings into revolutions.
//!
//! The rotation is counted from the last cut. So jitter at the cut azimuth does not cut twice, a
//! gap there cuts at the first firing after it, and both directions of rotation work.
//! [`crate::OrganisedFrame`] holds the points of a frame.

use thiserror::Error;
use units::{Lidar, Stamp};

use crate::firing::Firing;

const REVOLUTION_DEG: f64 = 360.0;
/// Rotation back by more than this is a reversal, not jitter.
const REVERSED_DEG: f64 = 10.0;
/// Weight of a new rate in the exponential mean: the rate of a single block has the resolution of
/// its azimuths, 0.01 deg of 0.2 to 0.8.
const RATE_WEIGHT: f64 = 1.0 / 32.0;

/// Splits the firings of one sensor into frames, one per revolution.
#[derive(Clone, Debug)]
pub struct FrameCutter {
    cut_azimuth_deg: f64,
    state: Option<FrameInProgress>,
    frames: u64,
}

/// A complete frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RevolutionFrame {
    /// Index from 0.
    pub index: u64,
    /// Start of its first firing.
    pub first: Stamp<Lidar>,
    /// Start of its last firing.
    pub last: Stamp<Lidar>,
    /// Number of firings.
    pub firings: u64,
    /// Whether it extends from cut to cut. The first and the last frame rarely do, nor do frames
    /// next to an outage of a revolution or a reversal.
    pub whole: bool,
}

/// Failure to build frames.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LidarFrameError {
    /// The cut azimuth is not finite.
    #[error("frames: expected an azimuth in degrees to cut at, got {got}")]
    CutAzimuth {
        /// The given azimuth.
        got: f64,
    },
    /// The firing is of another model than those before it in the frame.
    #[error("organised frame: expected firings of a {expected}, got one of a {got}")]
    Model {
        /// The frame's model.
        expected: &'static str,
        /// The firing's model.
        got: &'static str,
    },
}

/// The current frame.
#[derive(Clone, Copy, Debug)]
struct FrameInProgress {
    frame: RevolutionFrame,
    /// Rotation since the cut in the current direction, up to 360; jitter may make it slightly
    /// negative.
    rotation_deg: f64,
    /// Its maximum so far.
    peak_deg: f64,
    /// Signed exponential mean.
    rate_deg_s: f64,
    /// 1 clockwise seen from above, -1 counterclockwise.
    direction: f64,
    /// Rotation per firing.
    step_deg: f64,
    /// Start of the first frame, while its direction may be due to jitter.
    start_deg: Option<f64>,
}

impl FrameCutter {
    /// Cuts at `cut_azimuth_deg`, any finite number of degrees.
    ///
    /// # Errors
    /// [`LidarFrameError::CutAzimuth`] for infinity or NaN.
    pub fn new(cut_azimuth_deg: f64) -> Result<Self, LidarFrameError> {
        if !cut_azimuth_deg.is_finite() {
            return Err(LidarFrameError::CutAzimuth {
                got: cut_azimuth_deg,
            });
        }
        Ok(Self {
            cut_azimuth_deg: cut_azimuth_deg.rem_euclid(REVOLUTION_DEG),
            state: None,
            frames: 0,
        })
    }

    /// Adds the next firing. Returns the frame that it completes by beginning the next one.
    ///
    /// A firing belongs to the frame of its first laser; the others fire within 0.2 deg.
    pub fn firing(&mut self, firing: &Firing<'_>) -> Option<RevolutionFrame> {
        let Some(mut current) = self.state else {
            self.state = Some(self.begin(firing));
            return None;
        };
        let phase_deg = self.phase_deg(firing.azimuth_deg, current.direction);
        let mut rotation_deg = current.rotation_to(firing, phase_deg);
        if rotation_deg < current.peak_deg - REVERSED_DEG {
            match current.start_deg.take() {
                Some(start_deg) => {
                    rotation_deg = current.reverse_from_start(start_deg, rotation_deg)
                }
                None => return Some(self.reverse(current, firing)),
            }
        }
        let is_uncertain = |start_deg: &f64| rotation_deg < start_deg + REVERSED_DEG;
        current.start_deg = current.start_deg.filter(is_uncertain);
        current.step_deg = step_deg(firing, current.rate_deg_s);
        let complete = if rotation_deg < REVOLUTION_DEG {
            current.peak_deg = current.peak_deg.max(rotation_deg);
            current.frame.last = firing.start;
            current.frame.firings += 1;
            None
        } else {
            // A limited field of view is no outage; silence for a revolution or more is.
            let outage = rotation_deg - current.rotation_deg >= REVOLUTION_DEG;
            rotation_deg = rotation_deg.rem_euclid(REVOLUTION_DEG);
            current.peak_deg = rotation_deg;
            self.frames += 1;
            let mut complete = current.frame;
            complete.whole &= !outage;
            current.frame = self.frame(firing, !outage);
            Some(complete)
        };
        current.rotation_deg = rotation_deg;
        self.state = Some(current);
        complete
    }

    /// Ends the last frame; `None` without firings since the last call.
    pub fn finish(&mut self) -> Option<RevolutionFrame> {
        let current = self.state.take()?;
        self.frames += 1;
        let mut complete = current.frame;
        complete.whole &= current.rotation_deg + current.step_deg >= REVOLUTION_DEG;
        Some(complete)
    }

    /// Rotation from the cut to an azimuth, 0 to 360.
    fn phase_deg(&self, azimuth_deg: f64, direction: f64) -> f64 {
        (direction * (azimuth_deg - self.cut_azimuth_deg)).rem_euclid(REVOLUTION_DEG)
    }

    /// Begins the first frame, which is whole if the previous firing would have been before the
    /// cut.
    fn begin(&self, firing: &Firing<'_>) -> FrameInProgress {
        let rate_deg_s = firing.azimuth_rate_deg_s;
        let direction = if rate_deg_s < 0.0 { -1.0 } else { 1.0 };
        let rotation_deg = self.phase_deg(firing.azimuth_deg, direction);
        let step_deg = step_deg(firing, rate_deg_s);
        FrameInProgress {
            frame: self.frame(firing, rotation_deg < step_deg),
            rotation_deg,
            peak_deg: rotation_deg,
            rate_deg_s,
            direction,
            step_deg,
            start_deg: Some(rotation_deg),
        }
    }

    /// Ends the frame at a reversal of the rotor.
    fn reverse(&mut self, current: FrameInProgress, firing: &Firing<'_>) -> RevolutionFrame {
        self.frames += 1;
        let direction = -current.direction;
        let rotation_deg = self.phase_deg(firing.azimuth_deg, direction);
        self.state = Some(FrameInProgress {
            frame: self.frame(firing, false),
            rotation_deg,
            peak_deg: rotation_deg,
            rate_deg_s: firing.azimuth_rate_deg_s,
            direction,
            step_deg: current.step_deg,
            start_deg: None,
        });
        RevolutionFrame {
            whole: false,
            ..current.frame
        }
    }

    const fn frame(&self, firing: &Firing<'_>, whole: bool) -> RevolutionFrame {
        RevolutionFrame {
            index: self.frames,
            first: firing.start,
            last: firing.start,
            firings: 1,
            whole,
        }
    }
}

impl FrameInProgress {
    /// Rotation to a firing at `phase_deg` past the cut, by the number of revolutions that time and
    /// rate make most likely.
    fn rotation_to(&mut self, firing: &Firing<'_>, phase_deg: f64) -> f64 {
        self.rate_deg_s += (firing.azimuth_rate_deg_s - self.rate_deg_s) * RATE_WEIGHT;
        let since = firing.start.saturating_since(self.frame.last);
        // Device time that was set back gives no rotation.
        let expected_deg = self.direction * self.rate_deg_s * since.as_secs_f64().max(0.0);
        let revolutions = (self.rotation_deg + expected_deg - phase_deg) / REVOLUTION_DEG;
        phase_deg + REVOLUTION_DEG * revolutions.round()
    }

    /// Reverses the direction from the first firing on and returns the rotation in the new
    /// direction.
    fn reverse_from_start(&mut self, start_deg: f64, rotation_deg: f64) -> f64 {
        self.direction = -self.direction;
        let reversed_start_deg = (-start_deg).rem_euclid(REVOLUTION_DEG);
        let reversed_rotation_deg = reversed_start_deg + start_deg - rotation_deg;
        self.frame.whole = reversed_start_deg < self.step_deg;
        self.rotation_deg = reversed_rotation_deg;
        self.peak_deg = reversed_rotation_deg;
        reversed_rotation_deg
    }
}

/// Rotation from one firing to the next.
fn step_deg(firing: &Firing<'_>, rate_deg_s: f64) -> f64 {
    rate_deg_s.abs() * f64::from(firing.model.firing_period_ns) * 1e-9
}
