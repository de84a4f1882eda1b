//! Where one turn of the head ends and the next begins, firing by firing.
//!
//! The way of the rotor is counted from the last cut, so that jitter over the cut azimuth does not
//! cut twice, a gap over it cuts where firing goes on, and it does not matter which way round the
//! head turns. Left out: whether packets are missing within a frame (the decoder's statistics say
//! that), and the points themselves ([`crate::OrganisedFrame`]).

use thiserror::Error;
use units::{Lidar, Stamp};

use crate::firing::Firing;

const REVOLUTION_DEG: f64 = 360.0;
/// A way back by more is no jitter: the head turns the other way.
const REVERSED_DEG: f64 = 10.0;
/// Weight of a new rate in the running mean: azimuths are whole hundredths of a degree, rates of
/// single blocks are rough.
const RATE_WEIGHT: f64 = 1.0 / 32.0;

/// Cuts the firings of one sensor into frames.
#[derive(Clone, Debug)]
pub struct FrameCutter {
    cut_azimuth_deg: f64,
    state: Option<FrameInProgress>,
    frames: u64,
}

/// A frame that has ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevolutionFrame {
    /// Counted from 0.
    pub index: u64,
    /// Start of its first firing.
    pub first: Stamp<Lidar>,
    /// Start of its last firing.
    pub last: Stamp<Lidar>,
    /// Firings in it.
    pub firings: u64,
    /// Whether it reaches from cut to cut. The first and the last frame rarely do; nor do those
    /// beside an outage of a turn or more, or where the head changes its direction.
    pub whole: bool,
}

/// Why frames cannot be cut so.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LidarFrameError {
    /// The azimuth to cut at is no number.
    #[error("frames: expected an azimuth in degrees to cut at, got {got}")]
    CutAzimuth {
        /// What was given.
        got: f64,
    },
    /// A firing of another model than those before it in the frame.
    #[error("organised frame: expected firings of a {expected}, got one of a {got}")]
    Model {
        /// The frame's model.
        expected: &'static str,
        /// The firing's.
        got: &'static str,
    },
}

/// The frame being filled.
#[derive(Clone, Copy, Debug)]
struct FrameInProgress {
    frame: RevolutionFrame,
    /// Way since the cut azimuth in the direction of the turn, up to 360; a little less than 0
    /// where the rotor jitters.
    way_deg: f64,
    /// The furthest so far.
    peak_deg: f64,
    /// Signed, smoothed.
    rate_deg_s: f64,
    /// 1 clockwise seen from above, -1 the other way.
    direction: f64,
    /// Way of one firing.
    step_deg: f64,
    /// Where the first frame began, as long as jitter may have lent it its direction.
    began_deg: Option<f64>,
}

impl FrameCutter {
    /// Cuts where the azimuth passes `cut_azimuth_deg`, any number of degrees.
    ///
    /// # Errors
    /// [`LidarFrameError::CutAzimuth`] for infinity or what is no number.
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

    /// Takes the next firing. `Some` frame has ended before it, and it begins the next; otherwise
    /// it belongs to the frame being filled.
    ///
    /// A firing belongs to the frame in which its first laser fired; the others follow within some
    /// hundredths of a degree.
    pub fn firing(&mut self, firing: &Firing<'_>) -> Option<RevolutionFrame> {
        let Some(mut turning) = self.state else {
            self.state = Some(self.begin(firing));
            return None;
        };
        let phase_deg = self.phase_deg(firing.azimuth_deg, turning.direction);
        let mut way_deg = turning.way_to(firing, phase_deg);
        if way_deg < turning.peak_deg - REVERSED_DEG {
            match turning.began_deg.take() {
                Some(began_deg) => way_deg = turning.turn_round(began_deg, way_deg),
                None => return Some(self.reverse(turning, firing)),
            }
        }
        let unsure = |began_deg: &f64| way_deg < began_deg + REVERSED_DEG;
        turning.began_deg = turning.began_deg.filter(unsure);
        turning.step_deg = step_deg(firing, turning.rate_deg_s);
        let ended = if way_deg < REVOLUTION_DEG {
            turning.peak_deg = turning.peak_deg.max(way_deg);
            turning.frame.last = firing.start;
            turning.frame.firings += 1;
            None
        } else {
            // A view that leaves out a part of the turn is no outage; nothing for a turn or more
            // is.
            let outage = way_deg - turning.way_deg >= REVOLUTION_DEG;
            way_deg = way_deg.rem_euclid(REVOLUTION_DEG);
            turning.peak_deg = way_deg;
            self.frames += 1;
            let mut ended = turning.frame;
            ended.whole &= !outage;
            turning.frame = self.frame(firing, !outage);
            Some(ended)
        };
        turning.way_deg = way_deg;
        self.state = Some(turning);
        ended
    }

    /// Ends the last frame; `None` where there was no firing since the last call.
    pub fn finish(&mut self) -> Option<RevolutionFrame> {
        let turning = self.state.take()?;
        self.frames += 1;
        let mut ended = turning.frame;
        ended.whole &= turning.way_deg + turning.step_deg >= REVOLUTION_DEG;
        Some(ended)
    }

    /// Way from the cut to an azimuth, 0 to 360.
    fn phase_deg(&self, azimuth_deg: f64, direction: f64) -> f64 {
        (direction * (azimuth_deg - self.cut_azimuth_deg)).rem_euclid(REVOLUTION_DEG)
    }

    /// The very first frame: whole if the firing before its first would have been before the cut.
    fn begin(&self, firing: &Firing<'_>) -> FrameInProgress {
        let rate_deg_s = firing.azimuth_rate_deg_s;
        let direction = if rate_deg_s < 0.0 { -1.0 } else { 1.0 };
        let way_deg = self.phase_deg(firing.azimuth_deg, direction);
        let step_deg = step_deg(firing, rate_deg_s);
        FrameInProgress {
            frame: self.frame(firing, way_deg < step_deg),
            way_deg,
            peak_deg: way_deg,
            rate_deg_s,
            direction,
            step_deg,
            began_deg: Some(way_deg),
        }
    }

    /// Ends the frame where the head was found to turn the other way.
    fn reverse(&mut self, turning: FrameInProgress, firing: &Firing<'_>) -> RevolutionFrame {
        self.frames += 1;
        let direction = -turning.direction;
        let way_deg = self.phase_deg(firing.azimuth_deg, direction);
        self.state = Some(FrameInProgress {
            frame: self.frame(firing, false),
            way_deg,
            peak_deg: way_deg,
            rate_deg_s: firing.azimuth_rate_deg_s,
            direction,
            step_deg: turning.step_deg,
            began_deg: None,
        });
        RevolutionFrame {
            whole: false,
            ..turning.frame
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
    /// Way to a firing at `phase_deg` past the cut: as many turns on as time and rate make likely.
    fn way_to(&mut self, firing: &Firing<'_>, phase_deg: f64) -> f64 {
        self.rate_deg_s += (firing.azimuth_rate_deg_s - self.rate_deg_s) * RATE_WEIGHT;
        let since = firing.start.saturating_since(self.frame.last);
        // Device time that was set back says nothing of the way.
        let turned_deg = self.direction * self.rate_deg_s * since.as_secs_f64().max(0.0);
        let turns = (self.way_deg + turned_deg - phase_deg) / REVOLUTION_DEG;
        phase_deg + REVOLUTION_DEG * turns.round()
    }

    /// Takes the direction for the other one from the first firing on, and gives the way seen so.
    fn turn_round(&mut self, began_deg: f64, way_deg: f64) -> f64 {
        self.direction = -self.direction;
        let began_so_deg = (-began_deg).rem_euclid(REVOLUTION_DEG);
        let way_so_deg = began_so_deg + began_deg - way_deg;
        self.frame.whole = began_so_deg < self.step_deg;
        self.way_deg = way_so_deg;
        self.peak_deg = way_so_deg;
        way_so_deg
    }
}

/// Way from one firing to the next.
fn step_deg(firing: &Firing<'_>, rate_deg_s: f64) -> f64 {
    rate_deg_s.abs() * f64::from(firing.model.firing_period_ns) * 1e-9
}
