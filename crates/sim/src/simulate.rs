//! The whole way of the data on one page: a scene, a sensor and a motion in, the devices' bytes and the truth out.
//!
//! For every packet of the lidar (`worker`): when its blocks fire; where the scanner stands then (`course`); which way each ray goes
//! (`firing`); what it meets (`surroundings`); what comes back, as a packet and as truth. Packets are made by threads in chunks; in order
//! of time they are then merged with the drive's polls and go through the links (`merge`). Effects act where their trait says
//! ([`crate::effects`]); [`Simulation::run`] is generic over them, so that where there are none nothing is left of them.
//! One simulation, one seed: the same bytes on any number of threads.
//!
//! Left out: files and frames (whoever takes the [`Event`]s makes those), and the firmware of the drive: it answers where its shaft is.

mod course;
mod firing;
mod merge;
mod surroundings;
mod worker;

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DMat3, DVec3};
use thiserror::Error;
use units::{Gearing, Host, Span, Stamp};

use crate::effects::{Effects, Encoder, FiringEffects, Mechanism, Wire};
use crate::motion::Motion;
use crate::scene::Scene;
use crate::sensor::{ReturnMode, Sensor};
use course::Course;
pub use firing::{Echo, Echoes, Firing};
pub use surroundings::{Body, Met, Surroundings};

/// What is to be simulated.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// What beams meet.
    pub scene: Arc<Scene>,
    /// The lidar.
    pub sensor: Sensor,
    /// Which of its returns it reports.
    pub returns: ReturnMode,
    /// How it turns.
    pub spin: Spin,
    /// How it sits on the tilt axis.
    pub mount: Mount,
    /// How the tilt axis moves, and for how long.
    pub motion: Motion,
    /// How the drive is asked for its angle; `None`: there is no drive.
    pub polls: Option<Polls>,
    /// Host time of the start.
    pub start: Stamp<Host>,
    /// What the lidar's clock shows then, microseconds past the hour.
    pub clock_at_start_us: u32,
}

/// How the head turns, in the lidar's own time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// Turns a minute.
    pub rpm: u32,
    /// Azimuth of the first firing, degrees.
    pub start_deg: f64,
}

/// How the lidar sits on the tilt axis: from its own frame (x right, y forward, z up) to the platform's, whose y is the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    /// How it is turned.
    pub turn: DMat3,
    /// Where its origin is, metres.
    pub at_m: DVec3,
}

/// How the drive is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Polls {
    /// Nanoseconds from one request to the next, above 0.
    pub period_ns: i64,
    /// Nanoseconds from a request to its answer, without what the links add.
    pub answer_ns: i64,
    /// Encoder and gear that positions are counts of.
    pub gearing: Gearing,
}

/// Something that reaches the host, or leaves it.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// A datagram of the lidar's arrives.
    Datagram {
        /// When.
        at: Stamp<Host>,
        /// The port it is sent to.
        port: u16,
        /// The UDP payload.
        payload: &'a [u8],
    },
    /// The host asks something of the drive.
    Request {
        /// When it hands the request on.
        at: Stamp<Host>,
        /// What.
        ask: Ask,
    },
    /// The drive's answer arrives.
    Answer {
        /// When.
        at: Stamp<Host>,
        /// To what.
        ask: Ask,
        /// Where the motor's shaft is, quadcounts (6064); for other requests than [`Ask::Position`] nobody says so.
        position_qc: i32,
    },
}

/// What the host asks of the drive: where its shaft is, all the time, before each way the six writes that command it, and
/// after an answer that did not come a marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ask {
    /// Say where the shaft is.
    Position,
    /// Here the next way ends, quadcounts.
    Target(i32),
    /// So fast it is to be, degrees of tilt per second.
    Speed(f64),
    /// So quickly that is to be reached, degrees per second squared; infinite where at once.
    Acceleration(f64),
    /// So quickly it is to end.
    Deceleration(f64),
    /// Be ready for a new target.
    Ready,
    /// Go there.
    Go,
    /// Read an object that no drive has: the first of two, or the second. Its error comes after whatever was still under way, so
    /// that from there on answers can be told apart again.
    Marker(bool),
}

/// A return as it truly was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruePoint {
    /// Where the middle of the beam met the scene, metres in the frame of the base: origin on the tilt axis, x right, y forward, z up.
    pub position_m: DVec3,
    /// When its laser fired, host's time.
    pub host: Stamp<Host>,
    /// When, in the lidar's own time since the start, nanoseconds.
    pub device_ns: i64,
    /// Which laser, in the order of firing.
    pub laser: u8,
    /// Which return of the pulse: 0 the one of a single-return mode.
    pub echo: u8,
    /// Calibrated reflectivity as reported.
    pub reflectivity: u8,
    /// How far off it was, metres.
    pub range_m: f64,
    /// Azimuth of the beam in the sensor's frame, degrees, 0..360.
    pub azimuth_deg: f64,
    /// How the platform was tilted, degrees.
    pub tilt_deg: f64,
}

/// Who takes what the simulation makes.
pub trait Out {
    /// Takes an event; they come in the order of their times. `Break` ends the run.
    fn event(&mut self, event: &Event<'_>) -> ControlFlow<()>;

    /// Whether points are wanted too. Asked once, before the run.
    fn wants_truth(&self) -> bool {
        false
    }

    /// Takes the true points of a data packet, in the order of firing, lost or not. `Break` ends the run.
    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        let _ = points;
        ControlFlow::Continue(())
    }
}

/// What was simulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Data packets that left the lidar.
    pub packets: u64,
    /// Shots: lasers that fired, in them.
    pub shots: u64,
    /// Shots that returned.
    pub returned: u64,
    /// Returns, two of one shot counted twice.
    pub returns: u64,
    /// Requests to the drive.
    pub polls: u64,
    /// How long it took in the simulated world.
    pub lasted: Span,
    /// Whether whoever took it broke it off.
    pub broken_off: bool,
}

/// Why nothing was simulated.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum SimulateError {
    /// A run that is too long to be counted.
    #[error("sim: expected a motion of at most {most_s} s, got {got_s} s")]
    TooLong {
        /// The longest, seconds.
        most_s: f64,
        /// What was asked for.
        got_s: f64,
    },
    /// Polls that never go on.
    #[error(
        "sim: polls: expected a period above 0 ns and an answer 0 ns later or more, got {period_ns} ns and {answer_ns} ns"
    )]
    Polls {
        /// From one to the next.
        period_ns: i64,
        /// Till its answer.
        answer_ns: i64,
    },
}

/// The longest run: a day.
const MOST_S: f64 = 86_400.0;

impl Mount {
    /// Upright, its origin `d_m` metres above the axis (d of Eq. 4-6).
    #[must_use]
    pub const fn above(d_m: f64) -> Self {
        Self {
            turn: DMat3::IDENTITY,
            at_m: DVec3::new(0.0, 0.0, d_m),
        }
    }
}

impl Simulation {
    /// Makes all of it, on so many threads beside the caller's where there are more than one.
    ///
    /// # Errors
    /// [`SimulateError`] before anything is made.
    pub fn run<F, M, E, W>(
        &self,
        effects: &mut Effects<F, M, E, W>,
        threads: NonZeroUsize,
        out: &mut dyn Out,
    ) -> Result<Summary, SimulateError>
    where
        F: FiringEffects,
        M: Mechanism,
        E: Encoder,
        W: Wire,
    {
        self.check()?;
        let course = Course::new(&self.motion, &mut effects.mechanism);
        let job = worker::Job::new(self, &course, &effects.firings, out.wants_truth());
        let mut merge =
            merge::Merge::new(self, &course, &mut effects.encoder, &mut effects.wire, out);
        let used = worker::run(&job, &effects.firings, threads, &mut |chunk| {
            merge.chunk(chunk)
        });
        let summary = merge.finish();
        for copy in &used {
            effects.firings.absorb(copy);
        }
        Ok(summary)
    }

    fn check(&self) -> Result<(), SimulateError> {
        let got_s = self.motion.end_s();
        if got_s > MOST_S {
            return Err(SimulateError::TooLong {
                most_s: MOST_S,
                got_s,
            });
        }
        match self.polls {
            Some(polls) if polls.period_ns <= 0 || polls.answer_ns < 0 => {
                Err(SimulateError::Polls {
                    period_ns: polls.period_ns,
                    answer_ns: polls.answer_ns,
                })
            }
            _ => Ok(()),
        }
    }

    /// How long the motion takes, nanoseconds.
    fn end_ns(&self) -> i64 {
        (self.motion.end_s() * 1e9).ceil() as i64
    }

    /// A host time by nanoseconds since the start.
    fn host(&self, since_ns: i64) -> Stamp<Host> {
        self.start.saturating_add(Span::from_nanos(since_ns))
    }
}

impl Spin {
    /// Degrees per second.
    pub(crate) fn deg_per_s(self) -> f64 {
        6.0 * f64::from(self.rpm)
    }
}

#[cfg(test)]
mod tests;
