//! Simulation of whole scenes: a scene, a sensor and a motion in; the devices' bytes and the true
//! points out.
//!
//! Threads make packets in chunks (`threads`) with `packet_maker`, which the
//! rig uses too. Packets are then merged with the drive's polls in order of time and go through the
//! links (`merge`). [`Simulation::run`] is generic over the effects, so that absent effects cost
//! nothing. One simulation and one seed give the same bytes on any number of threads.
//!
//! The drive's firmware is not simulated: the drive reports the position of its shaft.

mod course;
mod merge;
mod schedule;
mod threads;

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::Arc;

use thiserror::Error;
use units::{Gearing, Host, Span, Stamp};

use crate::effects::{
    Effects, EncoderEffect, FiringEffects, LinkEffect, MechanismEffect, SurfaceEffect,
};
use crate::lidar_clock::LidarClock;
use crate::motion::AxisMotion;
use crate::packet_maker::{HeadRotation, SimulatedLidar, TruePoint};
use crate::scene::Scene;
use crate::sensor::{LidarMount, LidarSensor, ReturnMode};
use course::AxisCourse;

/// A simulation.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// Objects that beams can hit.
    pub scene: Arc<Scene>,
    /// The lidar.
    pub sensor: LidarSensor,
    /// Its return mode.
    pub returns: ReturnMode,
    /// Its rotation.
    pub rotation: HeadRotation,
    /// Its mounting on the tilt axis.
    pub mount: LidarMount,
    /// Motion of the tilt axis, and its duration.
    pub motion: AxisMotion,
    /// Polling of the drive; `None` without a drive.
    pub polls: Option<Polls>,
    /// Host time of the start.
    pub start: Stamp<Host>,
    /// The lidar's clock at the start, microseconds past the hour.
    pub clock_at_start_us: u32,
}

/// Polling of the drive's position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Polls {
    /// Nanoseconds from one request to the next, above 0.
    pub period_ns: i64,
    /// Nanoseconds from a request to its answer, without the delays of the links.
    pub answer_ns: i64,
    /// Encoder and gear that positions are counts of.
    pub gearing: Gearing,
}

/// A message that reaches or leaves the host.
#[derive(Clone, Debug)]
pub enum SimulationEvent {
    /// A datagram of the lidar arrives.
    Datagram {
        /// Time of arrival.
        at: Stamp<Host>,
        /// Destination port.
        port: u16,
        /// The UDP payload.
        payload: Vec<u8>,
    },
    /// The host sends a request to the drive.
    Request {
        /// Time of sending.
        at: Stamp<Host>,
        /// The request.
        request: DriveRequest,
    },
    /// The drive's answer arrives.
    Answer {
        /// Time of arrival.
        at: Stamp<Host>,
        /// The request that it answers.
        request: DriveRequest,
        /// Position of the motor shaft, quadcounts (object 6064); 0 for requests other than
        /// [`DriveRequest::Position`].
        position_qc: i32,
    },
}

/// A request to the drive: the position all the time, six writes before each move, and a probe
/// after a missing answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveRequest {
    /// Read the position of the shaft.
    Position,
    /// Write the target of the next move, quadcounts.
    Target(i32),
    /// Write the profile velocity, degrees of tilt per second.
    Speed(f64),
    /// Write the profile acceleration, degrees per second squared; infinite for none.
    Acceleration(f64),
    /// Write the profile deceleration.
    Deceleration(f64),
    /// Prepare for a new target.
    Ready,
    /// Start the move.
    Go,
    /// Read an object that no drive has, the first (`false`) of two or the second. Its abort comes
    /// after all earlier answers, which resynchronises requests and answers.
    Probe(bool),
}

/// A consumer of what the simulation makes.
pub trait SimulationSink {
    /// Takes an event; events come in order of time. `Break` ends the run.
    fn event(&mut self, event: &SimulationEvent) -> ControlFlow<()>;

    /// A lidar without packets has reached a time. `Break` ends the run.
    fn reached(&mut self, at: Stamp<Host>) -> ControlFlow<()> {
        let _ = at;
        ControlFlow::Continue(())
    }

    /// Whether true points are wanted. Called once before the run.
    fn wants_truth(&self) -> bool {
        false
    }

    /// Takes the true points of a data packet in firing order, whether the packet is lost or not.
    /// Those of a lidar without packets include returns from no surface.
    /// `Break` ends the run.
    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        let _ = points;
        ControlFlow::Continue(())
    }
}

/// Counts of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SimulationSummary {
    /// Data packets that left the lidar; 0 of one whose packets are not simulated.
    pub packets: u64,
    /// Shots (lasers that fired) in them.
    pub shots: u64,
    /// Shots with a return.
    pub returned: u64,
    /// Returns; two returns of one shot count twice.
    pub returns: u64,
    /// Requests to the drive.
    pub polls: u64,
    /// Duration in the simulated world.
    pub duration: Span,
    /// Whether the sink ended the run.
    pub stopped: bool,
}

/// A simulation that cannot run.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SimulateError {
    /// A motion that is too long.
    #[error("expected a motion of at most {MAX_DURATION_S} s, got {got_s} s")]
    TooLong {
        /// Its duration, seconds.
        got_s: f64,
    },
    /// Polls that do not advance.
    #[error(
        "polls: expected a period above 0 ns and an answer 0 ns later or more, got {period_ns} ns and {answer_ns} ns"
    )]
    Polls {
        /// From one request to the next.
        period_ns: i64,
        /// From request to answer.
        answer_ns: i64,
    },
}

/// The longest run: a day.
const MAX_DURATION_S: f64 = 86_400.0;

impl Simulation {
    /// Runs the simulation, on `threads` threads besides the caller's if there are more than one.
    ///
    /// # Errors
    /// [`SimulateError`] before anything is made.
    pub fn run<F, M, E, L>(
        &self,
        effects: &mut Effects<F, M, E, L>,
        threads: NonZeroUsize,
        sink: &mut dyn SimulationSink,
    ) -> Result<SimulationSummary, SimulateError>
    where
        F: FiringEffects,
        M: MechanismEffect,
        E: EncoderEffect,
        L: LinkEffect,
    {
        self.check()?;
        let course = AxisCourse::new(&self.motion, &mut effects.mechanism);
        let truth = sink.wants_truth();
        let run = threads::SharedRun::new(self, &course, &effects.firings, truth);
        let mut merge =
            merge::Merge::new(self, &course, &mut effects.encoder, &mut effects.link, sink);
        let used = threads::run(&run, &effects.firings, threads, &mut |chunk| {
            merge.chunk(chunk)
        });
        let summary = merge.finish();
        for copy in &used {
            effects.firings.absorb(copy);
        }
        Ok(summary)
    }

    /// Whether it can be run: files need not be opened for one that cannot.
    ///
    /// # Errors
    /// [`SimulateError`] for a motion that is too long and for impossible times of polls.
    pub fn check(&self) -> Result<(), SimulateError> {
        let got_s = self.motion.end_s;
        if got_s > MAX_DURATION_S {
            return Err(SimulateError::TooLong { got_s });
        }
        if let Some(polls) = self.polls
            && (polls.period_ns <= 0 || polls.answer_ns < 0)
        {
            return Err(SimulateError::Polls {
                period_ns: polls.period_ns,
                answer_ns: polls.answer_ns,
            });
        }
        Ok(())
    }

    fn lidar(&self, surface: &impl SurfaceEffect) -> SimulatedLidar {
        let mut sensor = self.sensor.clone();
        surface.misalign(&mut sensor.beams);
        SimulatedLidar::new(
            sensor,
            self.returns,
            self.rotation,
            self.mount,
            self.start,
            // Its drift is an effect.
            LidarClock::new(self.start, self.clock_at_start_us, 0.0),
        )
        .known_as(&self.sensor)
    }

    /// Duration of the motion, nanoseconds.
    fn end_ns(&self) -> i64 {
        (self.motion.end_s * 1e9).ceil() as i64
    }

    /// Host time at nanoseconds since the start.
    fn host(&self, since_ns: i64) -> Stamp<Host> {
        self.start.saturating_add(Span::from_nanos(since_ns))
    }
}

#[cfg(test)]
mod tests;
