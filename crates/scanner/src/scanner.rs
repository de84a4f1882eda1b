//! The whole path, from recorded bytes to points, on one page.
//!
//! Two passes over the same records. The [`Survey`] reads times alone: packet arrivals for the lidar's clock, polls for the
//! trajectory. The [`Placer`] then decodes every firing, asks the clock when it happened and the trajectory how the
//! platform stood, and places its points. Both are pure functions of the records in their order. What placing a point means is
//! [`Alignment::place`]; how it is done for millions of them is `firing_blocks`.

use cloud::mount::{Mount, Tilt};
use cloud::{Fields, Point, Points, Sink, SinkError};
use drive::objects::Address;
use drive::record::{DriveLink, Record, Wire};
use drive::{Listener, Observation, ShaftSample};
use lidar::{Decoder, Options, SensorPoint, Stats, Timekeeper};
use units::{Degrees, Gearing, Host, Metres, Span, Stamp};

use crate::clock::{Arrival, LidarClock, Moment};
use crate::config::ScanConfig;
use crate::error::ScanError;
use crate::firing_blocks::{FiringBlockPlacer, MOST_POINTS};
use crate::plausible;
use crate::polls::with_clock;
use crate::steps::{ClockStep, HostLine, Seams, Timeline};
use crate::sweeps::{MoveWatch, Sweep};
use crate::tilt::TiltSource;
use crate::tolerance::{Accuracy, Choice};
use crate::trajectory::{Method, Trajectory};

/// First pass: what the records say about time and tilt.
pub struct Survey {
    gearing: Gearing,
    timekeeper: Timekeeper,
    listener: Listener,
    arrivals: Vec<Arrival>,
    polls: Vec<ShaftSample>,
    /// Acknowledged writes: object, value, and when it was asked for.
    writes: Vec<(Address, u32, Stamp<Host>)>,
    seams: Seams,
    moves: MoveWatch,
    question: Span,
    link: Option<DriveLink>,
}

/// What the first pass found: enough to place any firing.
#[derive(Clone, Debug)]
pub struct Alignment {
    /// Lidar time to host time.
    pub clock: LidarClock,
    /// The clocks that were set in mid-recording, in order. Host times are by the host's clock as it was before the first.
    pub steps: Vec<ClockStep>,
    /// Host time to tilt angle.
    pub trajectory: Trajectory,
    /// Why the angles are known as they are, where an accuracy was asked for.
    pub choice: Option<Choice>,
    /// The sweeps; empty where the platform does not tilt by the log.
    pub sweeps: Vec<Sweep>,
    /// How the lidar sits on the axis.
    pub mount: Mount,
    /// Shaft samples that no platform can have given and that were left out.
    pub implausible: u64,
    /// Standard deviation of a range, metres.
    pub range_sd_m: f64,
    /// Only firings within one of these spans become points.
    spans: Vec<(Stamp<Host>, Stamp<Host>)>,
}

impl Survey {
    /// A survey of a log written with `config`.
    ///
    /// # Errors
    /// [`ScanError::Gearing`] where the configuration's gearing cannot exist.
    pub fn new(config: &ScanConfig, options: Options) -> Result<Self, ScanError> {
        let gearing = config.axis.gearing()?;
        Ok(Self {
            gearing,
            timekeeper: Timekeeper::new(options),
            listener: Listener::new(config.axis.node),
            arrivals: Vec::new(),
            polls: Vec::new(),
            writes: Vec::new(),
            seams: Seams::default(),
            moves: MoveWatch::new(gearing),
            question: config.question(),
            link: None,
        })
    }

    /// Takes one record.
    pub fn observe(&mut self, record: &Record<'_>) {
        match record.wire {
            Wire::Lidar { payload, .. } => {
                if let Some(timing) = self.timekeeper.packet(record.host, payload) {
                    let device_ns = timing.first_firing.as_nanos();
                    self.seams.packet(device_ns, record.host);
                    self.arrivals.push(Arrival {
                        device: timing.first_firing,
                        host: record.host.saturating_add(-timing.fill),
                    });
                }
            }
            Wire::Drive {
                link,
                direction,
                frame,
            } => {
                self.link = Some(link);
                let host = self.seams.sew(record.host);
                let (polls, seams, writes) = (&mut self.polls, &mut self.seams, &mut self.writes);
                let question = self.question;
                self.listener
                    .observe(link, direction, frame, host, &mut |seen| match seen {
                        Observation::Sample(mut poll) => {
                            poll.request = poll.answer.min(poll.request + question);
                            polls.push(poll);
                            seams.sample();
                        }
                        Observation::Wrote {
                            address,
                            value,
                            request,
                            ..
                        } => writes.push((address, value, request)),
                        _ => {}
                    });
            }
        }
    }

    /// The clocks that were set, as far as the records tell; needs packets of one lidar.
    #[must_use]
    pub fn steps(&self) -> Vec<ClockStep> {
        Timeline::new(&self.arrivals, &self.seams).map_or(Vec::new(), |timeline| timeline.steps)
    }

    /// Brings the drive's stamps to the host's clock as it was at the begin.
    fn unsew(&mut self, line: &HostLine) {
        for poll in &mut self.polls {
            poll.request = line.host(poll.request);
            poll.answer = line.host(poll.answer);
        }
        for (address, value, request) in self.writes.drain(..) {
            self.moves.wrote(address, value, line.host(request));
        }
    }

    /// How the drive is attached and how many shaft samples there are; `None` without traffic of a drive.
    #[must_use]
    pub fn drive(&self) -> Option<(DriveLink, u64)> {
        self.link.map(|link| (link, self.polls.len() as u64))
    }

    /// Solves for clock, trajectory and sweeps.
    ///
    /// # Errors
    /// [`ScanError`] where the records hold no lidar packet, or tilt was asked of them and they hold none, or no sweep.
    pub fn solve(self, config: &ScanConfig, tilt: &TiltSource) -> Result<Alignment, ScanError> {
        self.solve_to(config, tilt, Accuracy::Best)
    }

    /// The same with the angles of a log as accurate as is asked for.
    ///
    /// # Errors
    /// As [`Survey::solve`]; [`ScanError::OutOfReach`] where no method is that accurate.
    pub fn solve_to(
        mut self,
        config: &ScanConfig,
        tilt: &TiltSource,
        accuracy: Accuracy,
    ) -> Result<Alignment, ScanError> {
        let Timeline {
            clock,
            steps,
            drive,
            arrivals,
        } = Timeline::new(&self.arrivals, &self.seams).ok_or(ScanError::NoLidarPackets)?;
        self.unsew(&drive);
        let (mut implausible, mut shared_ns) = (0, 0.0);
        let samples = match tilt {
            TiltSource::Log => {
                let (mut samples, sd_ns) = with_clock(&self.polls, self.gearing);
                shared_ns = sd_ns;
                implausible = plausible::leave_out(&mut samples);
                samples
            }
            TiltSource::None => Vec::new(),
            TiltSource::Table(table) => table.samples(&arrivals)?,
        };
        let sweeps = match tilt {
            TiltSource::Log => self.moves.sweeps(&samples, config.sweep.as_ref()),
            TiltSource::None | TiltSource::Table(_) => Vec::new(),
        };
        let quantum = match tilt {
            TiltSource::Log => Degrees(self.gearing.degrees_per_qc()),
            TiltSource::None | TiltSource::Table(_) => Degrees(0.0),
        };
        let spans = match tilt {
            TiltSource::None | TiltSource::Table(_) => vec![ALWAYS],
            TiltSource::Log => sweeps.iter().map(|s| (s.start, s.end)).collect(),
        };
        let through = |sweeps: &[Sweep], method| {
            let samples = samples.clone();
            let through = Trajectory::through(samples, quantum, sweeps, method);
            through.map(|trajectory| trajectory.with_shared(shared_ns))
        };
        let mut choice = None;
        let trajectory = match (tilt, accuracy) {
            (TiltSource::None | TiltSource::Table(_), Accuracy::Within(_)) => {
                return Err(ScanError::NoBound);
            }
            (TiltSource::None, _) => Some(Trajectory::fixed(Degrees(0.0))),
            (TiltSource::Table(_), _) => through(&[], Some(Method::Linear)),
            (TiltSource::Log, _) if !samples.is_empty() && sweeps.is_empty() => {
                return Err(ScanError::NoSweep);
            }
            (TiltSource::Log, Accuracy::Best) => through(&sweeps, None),
            (TiltSource::Log, Accuracy::By(method)) => through(&sweeps, Some(method)),
            (TiltSource::Log, Accuracy::Within(tolerance)) => {
                let by = |method| through(&sweeps, Some(method));
                let chosen = tolerance.choose(clock.bound(), &spans, by);
                let (trajectory, why) =
                    chosen.map_err(|best| best.map_or(ScanError::NoTilt, ScanError::OutOfReach))?;
                choice = Some(why);
                Some(trajectory)
            }
        }
        .ok_or(ScanError::NoTilt)?;
        Ok(Alignment {
            clock,
            steps,
            trajectory,
            choice,
            sweeps,
            mount: match tilt {
                // The sensor's own frame: nothing of the platform in it.
                TiltSource::None => Mount::new(Metres(0.0)),
                TiltSource::Log | TiltSource::Table(_) => config.mount.mount(),
            },
            implausible,
            range_sd_m: config.lidar.range_sd_m,
            spans,
        })
    }
}

const ALWAYS: (Stamp<Host>, Stamp<Host>) =
    (Stamp::from_nanos(i64::MIN), Stamp::from_nanos(i64::MAX));

impl Alignment {
    /// How well the angle samples of the sweeps agree, root mean square, degrees ([`Trajectory::rms_deg`]); `None` without tilt.
    #[must_use]
    pub fn angle_rms_deg(&self) -> Option<f64> {
        self.trajectory.rms_deg(&self.spans)
    }

    /// How far off the tilt angle may be at worst during the sweeps ([`Trajectory::bound_deg`]); `None` without tilt.
    #[must_use]
    pub fn angle_bound_deg(&self) -> Option<f64> {
        (self.trajectory.method() != Method::None).then(|| self.trajectory.bound_deg(&self.spans))
    }

    /// The heart: a point of the sensor's frame, at its own time and tilt, in the frame of the platform (Eq. 4-6). `None` outside
    /// every sweep, or outside the time for which an angle is known.
    ///
    /// This is what placing means. [`Placer`] does it for all points of a block together.
    #[must_use]
    pub fn place(&self, point: &SensorPoint) -> Option<Point> {
        self.place_near(point, None)
    }

    /// The same for a packet that arrived at `near` by the host's clock of that time: where the lidar's clock was set back, times come twice.
    #[must_use]
    pub fn place_near(&self, point: &SensorPoint, near: Option<Stamp<Host>>) -> Option<Point> {
        let moment = self.clock.moment_near(point.time, near);
        let tilt = self
            .trajectory
            .angle(moment)
            .filter(|_| self.wants(moment.host))?;
        Some(Point {
            position_m: self.mount.place(point.position_m, Tilt::new(tilt)),
            intensity: point.reflectivity,
            ring: point.ring,
            laser: point.laser,
            time: moment.host,
            device_time: point.time,
            tilt,
            sd_m: self.sd_m(point, moment, near),
            echo: point.echo.code(),
        })
    }

    fn wants(&self, host: Stamp<Host>) -> bool {
        self.spans
            .iter()
            .any(|(from, to)| *from <= host && host <= *to)
    }

    /// One that changes while records come in: a clock for each packet, an angle that grows, sweeps as they begin.
    pub(crate) fn live(trajectory: Trajectory, mount: Mount, range_sd_m: f64) -> Self {
        let epoch = Moment {
            host: Stamp::from_nanos(0),
            rest_ns: 0.0,
        };
        Self {
            clock: LidarClock::through(Stamp::from_nanos(0), epoch),
            steps: Vec::new(),
            trajectory,
            choice: None,
            sweeps: Vec::new(),
            mount,
            implausible: 0,
            range_sd_m,
            spans: Vec::new(),
        }
    }

    pub(crate) fn set_spans(&mut self, spans: &[(Stamp<Host>, Stamp<Host>)]) {
        self.spans.clear();
        self.spans.extend_from_slice(spans);
    }

    /// An alignment of given parts.
    #[cfg(test)]
    pub(crate) const fn with_spans(
        clock: LidarClock,
        trajectory: Trajectory,
        mount: Mount,
        spans: Vec<(Stamp<Host>, Stamp<Host>)>,
    ) -> Self {
        Self {
            clock,
            steps: Vec::new(),
            trajectory,
            choice: None,
            sweeps: Vec::new(),
            mount,
            implausible: 0,
            range_sd_m: 0.004,
            spans,
        }
    }

    /// Only firings within one of these become points.
    pub(crate) fn spans(&self) -> &[(Stamp<Host>, Stamp<Host>)] {
        &self.spans
    }
}

/// Second pass: places every firing and hands the points to a sink in batches.
pub struct Placer<'a> {
    block_placer: FiringBlockPlacer<'a>,
    decoder: Decoder,
    batch: Points,
    placed: Placed,
    sink: &'a mut dyn Sink,
}

/// What became of the returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Placed {
    /// Points handed to the sink.
    pub points: u64,
    /// Returns outside every sweep, or outside the time for which an angle is known.
    pub outside: u64,
}

/// Points that a sink gets at a time: few enough to stay in the processor's cache on their way.
const BATCH_POINTS: usize = 1 << 12;

impl<'a> Placer<'a> {
    /// A placer into `sink`, which has begun.
    pub fn new(alignment: &'a Alignment, options: Options, sink: &'a mut dyn Sink) -> Self {
        let fields: Fields = sink.fields();
        Self {
            block_placer: FiringBlockPlacer::new(alignment),
            decoder: Decoder::new(options),
            batch: Points::with_capacity(fields, BATCH_POINTS + MOST_POINTS),
            placed: Placed::default(),
            sink,
        }
    }

    /// Takes one record.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn observe(&mut self, record: &Record<'_>) -> Result<(), SinkError> {
        let Wire::Lidar { payload, .. } = record.wire else {
            return Ok(());
        };
        let (block_placer, batch, placed) =
            (&mut self.block_placer, &mut self.batch, &mut self.placed);
        block_placer.near(record.host);
        self.decoder
            .firing_blocks(record.host, payload, &mut |block| {
                block_placer.place(block, batch, placed);
            });
        if self.batch.len() >= BATCH_POINTS {
            self.flush()?;
        }
        Ok(())
    }

    /// Places what the decoder still holds and says what came of it all. The sink is not finished: its owner does that.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn finish(mut self) -> Result<(Placed, Stats), SinkError> {
        let (block_placer, batch, placed) =
            (&mut self.block_placer, &mut self.batch, &mut self.placed);
        self.decoder
            .finish_firing_blocks(&mut |block| block_placer.place(block, batch, placed));
        self.flush()?;
        Ok((self.placed, self.decoder.stats().clone()))
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        self.sink.points(&self.batch)?;
        self.batch.clear();
        Ok(())
    }
}
