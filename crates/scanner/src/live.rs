//! The cloud while it is measured, by the same steps as [`crate::scanner`], with streaming
//! estimates.
//!
//! Each packet waits until the angle is known for all of the packet before it; that one is then
//! placed. The clock is Olson's online estimate, and the trajectory is straight lines between
//! samples, as a fit needs the whole sweep. Steps of the lidar's clock (`stamp_grid`) and of the
//! host's from 10 ms on (`host_steps`) are undone. A replay of the same records places the same
//! points more accurately.

mod host_steps;
mod stamp_grid;

use std::collections::VecDeque;

use cloud::mount::Mount;
use cloud::{Points, Sink, SinkError};
use drive::record::{Record, Wire};
use drive::{Observation, ShaftSample};
use lidar::{Decoder, Options, Stats};
use units::{Gearing, Host, Lidar, Span, Stamp};

use crate::alignment::{Alignment, PlacementCounts};
use crate::angles::{AngleSample, OutlierFilter, SlowPollFilter, sample};
use crate::calibration::PointCalibration;
use crate::clock::{Arrival, DeviceClock, Moment, OnlineClock};
use crate::config::{ScanConfig, SweepPlan};
use crate::error::ScanError;
use crate::fast::{FiringBlockPlacer, MAX_PACKET_POINTS, returns};
use crate::survey::RecordReader;
use crate::sweeps::{MoveWatch, SweepWatch};
use crate::trajectory::{Method, StreamingFit, Trajectory};
use host_steps::{HostSteps, PacketDecision};
use stamp_grid::StampGrid;

/// Places points while records come in.
pub struct Live<'a> {
    gearing: Gearing,
    plan: Option<SweepPlan>,
    reader: RecordReader,
    clock: OnlineClock,
    grid: StampGrid,
    host_steps: HostSteps,
    slow_polls: SlowPollFilter,
    outliers: OutlierFilter,
    moves: MoveWatch,
    sweeps: SweepWatch,
    fit: StreamingFit,
    alignment: Option<Alignment>,
    mount: Mount,
    calibration: Option<PointCalibration>,
    range_sd_m: f64,
    waiting: VecDeque<WaitingPacket>,
    /// First firing of the packet that the decoder holds back.
    pending: Option<LiveFiring>,
    decoder: Decoder,
    batch: Points,
    counts: PlacementCounts,
    /// First firing of the packet last decoded; everything before it is placed.
    placed_until: Option<Stamp<Host>>,
    sink: &'a mut dyn Sink,
}

/// A packet whose angles are not known yet.
struct WaitingPacket {
    received: Stamp<Host>,
    /// First firing; `None` if it is not a data packet.
    fired: Option<LiveFiring>,
    payload: Vec<u8>,
}

/// Time of a firing.
#[derive(Clone, Copy)]
struct LiveFiring {
    /// By the lidar's clock, and by that clock before all steps.
    stamp: Stamp<Lidar>,
    device: Stamp<Lidar>,
}

/// Angles older than this are dropped.
const TRAJECTORY_MEMORY: Span = Span::from_millis(100);
/// Packets that wait for angles, at most: 5 s of a VLP-16, for a drive that does not answer.
const MAX_WAITING: usize = 4_096;

impl<'a> Live<'a> {
    /// A cloud into `sink`, which has begun, of devices configured by `config`.
    ///
    /// # Errors
    /// [`ScanError::Gearing`] if a number of the configured gearing is zero.
    pub fn new(
        config: &ScanConfig,
        options: Options,
        sink: &'a mut dyn Sink,
    ) -> Result<Self, ScanError> {
        let gearing = config.axis.gearing()?;
        Ok(Self {
            gearing,
            plan: config.sweep,
            reader: RecordReader::new(config, options.clone()),
            clock: OnlineClock::default(),
            grid: StampGrid::default(),
            host_steps: HostSteps::default(),
            slow_polls: SlowPollFilter::default(),
            outliers: OutlierFilter::default(),
            moves: MoveWatch::new(gearing),
            sweeps: SweepWatch::new(gearing),
            fit: StreamingFit::default(),
            alignment: None,
            mount: config.mount.mount(),
            calibration: config
                .calibration
                .as_ref()
                .map(|calibration| PointCalibration::new(calibration, gearing)),
            range_sd_m: config.lidar.range_sd_m,
            waiting: VecDeque::new(),
            pending: None,
            decoder: Decoder::new(options),
            batch: Points::with_capacity(sink.fields(), 2 * MAX_PACKET_POINTS),
            counts: PlacementCounts::default(),
            placed_until: None,
            sink,
        })
    }

    /// Takes one record, and places the points whose angles it completes.
    ///
    /// # Errors
    /// Returns the errors of the sink.
    pub fn observe(&mut self, record: &Record<'_>) -> Result<(), SinkError> {
        match record.wire {
            Wire::Lidar { payload, .. } => {
                self.packet(record.host, payload);
                self.frames(Some(record.host));
            }
            Wire::Drive {
                link,
                direction,
                frame,
            } => self.host_steps.hold(record.host, link, (direction, frame)),
        }
        self.release()
    }

    /// Takes the frames of the drive that need not wait after a packet received at `recorded`, or
    /// all.
    fn frames(&mut self, recorded: Option<Stamp<Host>>) {
        while let Some(frame) = self.host_steps.next_frame(recorded) {
            let (reader, moves) = (&mut self.reader, &mut self.moves);
            let mut samples = Vec::new();
            let record = frame.record();
            reader.frame(record.host, &record.wire, &mut |seen| match seen {
                Observation::Sample(sample) => samples.push(sample),
                Observation::Wrote {
                    address,
                    value,
                    request,
                    ..
                } => moves.wrote(address, value, request),
                Observation::Read {
                    address,
                    value,
                    request,
                    ..
                } => moves.read(address, value, request),
                _ => {}
            });
            for sample in samples {
                self.sample(&sample);
            }
        }
    }

    /// Delay of the cloud: from the first firing not placed yet to the newest angle. `None` before
    /// both exist.
    #[must_use]
    pub fn lag(&self) -> Option<Span> {
        Some(self.fit.newest()?.host.saturating_since(self.placed_until?))
    }

    /// Places what the decoder still holds. The caller finishes the sink.
    ///
    /// # Errors
    /// Returns the errors of the sink.
    pub fn finish(mut self) -> Result<(PlacementCounts, Stats), SinkError> {
        self.frames(None);
        self.release()?;
        if let Some(alignment) = &self.alignment {
            let mut placer = FiringBlockPlacer::new(alignment);
            let (batch, counts) = (&mut self.batch, &mut self.counts);
            self.decoder
                .finish_blocks(&mut |block| placer.place(block, batch, counts));
            self.sink.points(&self.batch)?;
        }
        while let Some(packet) = self.waiting.pop_front() {
            self.omit(&packet);
        }
        let counts = &mut self.counts;
        self.decoder
            .finish_blocks(&mut |block| counts.outside += returns(block));
        Ok((self.counts, self.decoder.stats().clone()))
    }

    /// Clock: an arrival, and a packet that waits for its angles.
    fn packet(&mut self, received: Stamp<Host>, payload: &[u8]) {
        let fired = self.reader.packet(received, payload).map(|recorded| {
            let arrival = self.host_steps.converted(recorded);
            let mut arrival = self.grid.converted(arrival, &self.clock);
            let due = self.clock.moment(arrival.device);
            let late = due.map(|due| arrival.host.saturating_since(due.host));
            match self.host_steps.packet(arrival, late) {
                PacketDecision::Packets(arrivals) => {
                    for arrival in arrivals {
                        self.clock.observe(arrival);
                    }
                }
                PacketDecision::LidarStep(by, arrivals) => {
                    self.grid.set(by);
                    arrival.device = arrival.device.saturating_add(by);
                    let fired = self.waiting.iter_mut().rev();
                    let fired = fired.filter_map(|packet| packet.fired.as_mut());
                    for firing in fired.take(arrivals.len() - 1) {
                        firing.device = firing.device.saturating_add(by);
                    }
                    for waited in arrivals {
                        self.clock.observe(Arrival {
                            device: waited.device.saturating_add(by),
                            ..waited
                        });
                    }
                }
                PacketDecision::Undecided => {}
            }
            LiveFiring {
                stamp: recorded.device,
                device: arrival.device,
            }
        });
        if self.waiting.len() >= MAX_WAITING
            && let Some(packet) = self.waiting.pop_front()
        {
            self.omit(&packet);
        }
        self.waiting.push_back(WaitingPacket {
            received,
            fired,
            payload: payload.to_vec(),
        });
    }

    /// Angle, sweep and trajectory of a shaft sample, and of one before it that waited.
    fn sample(&mut self, shaft: &ShaftSample) {
        let sample = sample(shaft, self.gearing);
        if self.slow_polls.accepts(&sample, self.fit.newest()) {
            for certain in self.outliers.push(sample) {
                self.angle(certain);
            }
        }
    }

    fn angle(&mut self, sample: AngleSample) {
        let Some(piece) = self.fit.add(sample) else {
            return;
        };
        self.sweeps.sample(&sample, &self.moves, self.plan.as_ref());
        match &mut self.alignment {
            Some(alignment) => alignment.trajectory.append(piece, sample.host),
            None => {
                let trajectory = Trajectory::of_piece(piece, sample.host, Method::Linear);
                // The clock of each packet replaces this one.
                let clock =
                    DeviceClock::through(Stamp::from_nanos(0), Moment::at(Stamp::from_nanos(0)));
                self.alignment = trajectory.map(|trajectory| Alignment {
                    calibration: self.calibration.take(),
                    ..Alignment::new(clock, trajectory, self.mount, self.range_sd_m, Vec::new())
                });
            }
        }
    }

    /// Decodes every packet before whose first firing all angles are known.
    fn release(&mut self) -> Result<(), SinkError> {
        let Some(newest) = self.fit.newest().copied() else {
            return Ok(());
        };
        if self.host_steps.is_in_doubt() {
            return Ok(());
        }
        let clock = &self.clock;
        let host = |firing: LiveFiring| Some(clock.moment(firing.device)?.host);
        let is_ready = |packet: &WaitingPacket| {
            let fired = packet.fired.and_then(host);
            fired.is_none_or(|host| host <= newest.host)
        };
        let ready = self.waiting.iter().take_while(|packet| is_ready(packet));
        for _ in 0..ready.count() {
            if let Some(packet) = self.waiting.pop_front() {
                self.decode(&packet);
            }
        }
        if self.batch.is_empty() {
            return Ok(());
        }
        self.sink.points(&self.batch)?;
        self.batch.clear();
        Ok(())
    }

    /// Decodes a packet, and counts its returns as left out.
    fn omit(&mut self, packet: &WaitingPacket) {
        let counts = &mut self.counts;
        self.decoder
            .decode_blocks(packet.received, &packet.payload, &mut |block| {
                counts.outside += returns(block);
            });
    }

    /// Decodes a packet, and places what the decoder emits: the packet before it.
    fn decode(&mut self, packet: &WaitingPacket) {
        let (batch, counts) = (&mut self.batch, &mut self.counts);
        let pending = match packet.fired {
            Some(firing) => {
                let moment = self.clock.moment(firing.device);
                self.placed_until = moment.map(|moment| moment.host);
                self.pending.replace(firing)
            }
            None => self.pending,
        };
        let moment = pending.and_then(|at| Some((at.stamp, self.clock.moment(at.device)?)));
        let (Some(alignment), Some((device, moment))) = (&mut self.alignment, moment) else {
            return self.omit(packet);
        };
        // Through the first firing of the pending packet: within a packet the clock drifts by ns.
        alignment.clock = DeviceClock::through(device, moment);
        alignment.spans.clear();
        alignment.spans.extend_from_slice(self.sweeps.spans());
        alignment
            .trajectory
            .drop_before(moment.host.saturating_add(-TRAJECTORY_MEMORY));
        let mut placer = FiringBlockPlacer::new(alignment);
        self.decoder
            .decode_blocks(packet.received, &packet.payload, &mut |block| {
                placer.place(block, batch, counts);
            });
    }
}
