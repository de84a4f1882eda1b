//! The cloud while it is measured: the same path as on [`crate::scanner`]'s page, with what is known so far.
//!
//! Records come in as they happen. A packet waits until the angle is known for the whole of the one before it, and that one is placed: by
//! the clock as it is then (Olson's) and on straight lines between samples, which are all that can be had before a sweep is over. Decoder,
//! cursor, mount and placing are those of a replay, which places the same points better.
//! Left out: what only a whole recording tells, such as steps of a clock being undone and the commanded motion.

use std::collections::VecDeque;

use cloud::mount::Mount;
use cloud::{Points, Sink, SinkError};
use drive::record::{Record, Wire};
use drive::{Listener, Observation, ShaftSample};
use lidar::{Decoder, Options, Stats, Timekeeper};
use units::{Gearing, Host, Lidar, Span, Stamp};

use crate::clock::{Arrival, DeviceClock, OnlineClock};
use crate::config::{ScanConfig, SweepPlan};
use crate::error::ScanError;
use crate::firing_blocks::{FiringBlockPlacer, MOST_POINTS};
use crate::polls::{QuickPolls, sample};
use crate::scanner::{Alignment, Placed};
use crate::sweeps::{MoveWatch, SweepWatch};
use crate::trajectory::{AngleSample, Growing, Method, Trajectory};

/// Places points while records come in.
pub struct Live<'a> {
    gearing: Gearing,
    plan: Option<SweepPlan>,
    question: Span,
    timekeeper: Timekeeper,
    listener: Listener,
    clock: OnlineClock,
    quick: QuickPolls,
    growing: Growing,
    moves: MoveWatch,
    sweeps: SweepWatch,
    waiting: VecDeque<Waiting>,
    alignment: Option<Alignment>,
    mount: Mount,
    range_sd_m: f64,
    /// First firing of the packet that the decoder holds back.
    held: Option<Stamp<Lidar>>,
    decoder: Decoder,
    batch: Points,
    placed: Placed,
    /// First firing of the last packet that was handed on: what came before it is placed.
    reached: Option<Stamp<Host>>,
    sink: &'a mut dyn Sink,
}

/// A packet whose time has not come.
struct Waiting {
    arrived: Stamp<Host>,
    /// When its first laser fired, by the lidar's clock and by the host's; `None` of what is no data packet.
    fired: Option<(Stamp<Lidar>, Stamp<Host>)>,
    payload: Vec<u8>,
}

/// Angles older than this are forgotten.
const MEMORY: Span = Span::from_millis(100);
/// More packets do not wait: without a drive that answers there are no angles for them.
const MOST_WAITING: usize = 4_096;

impl<'a> Live<'a> {
    /// A cloud into `sink`, which has begun, of devices that are configured so.
    ///
    /// # Errors
    /// [`ScanError::Gearing`] where the configuration's gearing cannot exist.
    pub fn new(
        config: &ScanConfig,
        options: Options,
        sink: &'a mut dyn Sink,
    ) -> Result<Self, ScanError> {
        let gearing = config.axis.gearing()?;
        Ok(Self {
            gearing,
            plan: config.sweep,
            question: config.question(),
            timekeeper: Timekeeper::new(options.clone()),
            listener: Listener::new(config.axis.node),
            clock: OnlineClock::new(),
            quick: QuickPolls::default(),
            growing: Growing::default(),
            moves: MoveWatch::new(gearing),
            sweeps: SweepWatch::new(gearing),
            waiting: VecDeque::new(),
            alignment: None,
            mount: config.mount.mount(),
            range_sd_m: config.lidar.range_sd_m,
            held: None,
            decoder: Decoder::new(options),
            batch: Points::with_capacity(sink.fields(), 2 * MOST_POINTS),
            placed: Placed::default(),
            reached: None,
            sink,
        })
    }

    /// Takes one record, and places what it makes possible.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn observe(&mut self, record: &Record<'_>) -> Result<(), SinkError> {
        match record.wire {
            Wire::Lidar { payload, .. } => self.packet(record.host, payload),
            Wire::Drive {
                link,
                direction,
                frame,
            } => {
                let mut samples = Vec::new();
                let moves = &mut self.moves;
                let question = self.question;
                self.listener.observe(
                    link,
                    direction,
                    frame,
                    record.host,
                    &mut |seen| match seen {
                        Observation::Sample(poll) => samples.push(ShaftSample {
                            request: poll.answer.min(poll.request + question),
                            ..poll
                        }),
                        Observation::Wrote {
                            address,
                            value,
                            request,
                            ..
                        } => moves.wrote(address, value, request),
                        _ => {}
                    },
                );
                for poll in samples {
                    self.sample(&poll);
                }
            }
        }
        self.release()
    }

    /// How far the cloud is behind the newest angle: from the first firing that is not placed yet. `None` before there is both.
    #[must_use]
    pub fn lag(&self) -> Option<Span> {
        Some(self.growing.newest()?.host.saturating_since(self.reached?))
    }

    /// Places what the decoder still holds, and says what came of it all. The sink is not finished: its owner does that.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn finish(mut self) -> Result<(Placed, Stats), SinkError> {
        if let Some(alignment) = &self.alignment {
            let mut placer = FiringBlockPlacer::new(alignment);
            let (batch, placed) = (&mut self.batch, &mut self.placed);
            self.decoder
                .finish_firing_blocks(&mut |block| placer.place(block, batch, placed));
            self.sink.points(&self.batch)?;
        }
        Ok((self.placed, self.decoder.stats().clone()))
    }

    fn packet(&mut self, arrived: Stamp<Host>, payload: &[u8]) {
        let timing = self.timekeeper.packet(arrived, payload);
        let fired = timing.and_then(|timing| {
            self.clock.observe(Arrival {
                device: timing.first_firing,
                host: arrived.saturating_add(-timing.fill),
            });
            let host = self.clock.moment(timing.first_firing)?.host;
            Some((timing.first_firing, host))
        });
        if self.waiting.len() >= MOST_WAITING {
            self.waiting.pop_front();
        }
        self.waiting.push_back(Waiting {
            arrived,
            fired,
            payload: payload.to_vec(),
        });
    }

    fn sample(&mut self, poll: &ShaftSample) {
        let sample: AngleSample = sample(poll, self.gearing);
        if !self.quick.is_quick(&sample, self.growing.newest()) {
            return;
        }
        let Some(piece) = self.growing.add(sample) else {
            return;
        };
        self.sweeps.sample(&sample, &self.moves, self.plan.as_ref());
        match &mut self.alignment {
            Some(alignment) => alignment.trajectory.go_on(piece, sample.host),
            None => {
                let trajectory = Trajectory::of(piece, sample.host, Method::Linear);
                self.alignment =
                    trajectory.map(|t| Alignment::live(t, self.mount, self.range_sd_m));
            }
        }
    }

    /// Hands on every packet before whose first firing all angles are known.
    fn release(&mut self) -> Result<(), SinkError> {
        let Some(newest) = self.growing.newest().copied() else {
            return Ok(());
        };
        while let Some(waiting) = self.waiting.front() {
            if waiting.fired.is_some_and(|(_, host)| host > newest.host) {
                break;
            }
            let Some(waiting) = self.waiting.pop_front() else {
                break;
            };
            self.hand_on(&waiting);
        }
        if self.batch.is_empty() {
            return Ok(());
        }
        self.sink.points(&self.batch)?;
        self.batch.clear();
        Ok(())
    }

    /// Gives a packet to the decoder, and places what that emits: the packet before it.
    fn hand_on(&mut self, waiting: &Waiting) {
        let (batch, placed) = (&mut self.batch, &mut self.placed);
        let held = match waiting.fired {
            Some((device, host)) => {
                self.reached = Some(host);
                self.held.replace(device)
            }
            None => self.held,
        };
        let moment = held.and_then(|held| Some((held, self.clock.moment(held)?)));
        let (Some(alignment), Some((device, moment))) = (&mut self.alignment, moment) else {
            self.decoder
                .firing_blocks(waiting.arrived, &waiting.payload, &mut |_| {});
            return;
        };
        // Through the held packet's first firing: the clock moves by nanoseconds within a packet.
        alignment.clock = DeviceClock::through(device, moment);
        alignment.set_spans(self.sweeps.spans());
        alignment
            .trajectory
            .forget_before(moment.host.saturating_add(-MEMORY));
        let mut placer = FiringBlockPlacer::new(alignment);
        self.decoder
            .firing_blocks(waiting.arrived, &waiting.payload, &mut |block| {
                placer.place(block, batch, placed);
            });
    }
}
