//! The traffic of both devices in order of time, through the links to the sink.
//!
//! The host polls the drive at even intervals, but not before the previous answer arrives or times
//! out. Before each move it writes the commands and repeats them until they are acknowledged; the
//! axis moves on time in any case. After a timeout it sends probe requests until one is answered,
//! as the drive client does.

use std::collections::{BTreeMap, VecDeque};
use std::ops::ControlFlow;

use firmware_sim::vlp16::{DATA_PORT, POSITION_PORT};
use units::{Degrees, Gearing, Span};

use super::course::AxisCourse;
use super::threads::Chunk;
use super::{DriveRequest, Polls, Simulation, SimulationEvent, SimulationSink, SimulationSummary};
use crate::effects::{EncoderEffect, LinkEffect, LinkMessage, MessageKind};
use crate::motion::AxisMove;
use crate::packet_maker::SimulatedPacket;

/// Periods after which a missing answer times out.
const TIMEOUT_PERIODS: i64 = 8;

/// Periods before a move at which its commands begin: six commands and two to spare.
const COMMAND_PERIODS: i64 = 8;

/// Events to come by time of arrival, nanoseconds since the start. Of two that arrive at the same
/// time, the one sent first comes first.
type Pending = BTreeMap<(i64, u64), SimulationEvent>;

pub(super) struct Merge<'a, E, L> {
    simulation: &'a Simulation,
    course: &'a AxisCourse,
    encoder: &'a mut E,
    link: &'a mut L,
    sink: &'a mut dyn SimulationSink,
    polls: Option<(Polls, Gearing)>,
    next_poll_ns: i64,
    /// Moves that are not commanded yet.
    moves: std::slice::Iter<'a, AxisMove>,
    /// Commands to write for the next move.
    commands: VecDeque<DriveRequest>,
    /// The probe request to send while an answer is missing.
    probe: Option<bool>,
    pending: Pending,
    order: u64,
    position_packets: u64,
    summary: SimulationSummary,
}

impl<'a, E: EncoderEffect, L: LinkEffect> Merge<'a, E, L> {
    pub fn new(
        simulation: &'a Simulation,
        course: &'a AxisCourse,
        encoder: &'a mut E,
        link: &'a mut L,
        sink: &'a mut dyn SimulationSink,
    ) -> Self {
        let gearing = encoder.gearing();
        Self {
            simulation,
            course,
            encoder,
            link,
            sink,
            polls: simulation
                .polls
                .map(|polls| (polls, gearing.unwrap_or(polls.gearing))),
            next_poll_ns: 0,
            moves: simulation.motion.moves.iter(),
            commands: VecDeque::new(),
            probe: None,
            pending: Pending::new(),
            order: 0,
            position_packets: 0,
            summary: SimulationSummary::default(),
        }
    }

    /// Takes the next packets.
    pub fn chunk(&mut self, chunk: &Chunk) -> ControlFlow<()> {
        let mut points = chunk.points.as_slice();
        for packet in &chunk.packets {
            let (own, rest) = points.split_at_checked(packet.points).unwrap_or_default();
            points = rest;
            let mut flow = self.packet(packet);
            if flow.is_continue() && !own.is_empty() {
                flow = self.sink.truth(own);
            }
            if flow.is_break() {
                self.summary.stopped = true;
                return flow;
            }
        }
        ControlFlow::Continue(())
    }

    fn packet(&mut self, packet: &SimulatedPacket) -> ControlFlow<()> {
        let leaves_ns = packet.leaves_ns;
        self.poll_until(leaves_ns)?;
        self.summary.shots += u64::from(packet.counts.shots);
        self.summary.returned += u64::from(packet.counts.returned);
        self.summary.returns += u64::from(packet.counts.returns);
        if self.simulation.sensor.packets.is_none() {
            self.sink.reached(self.simulation.host(leaves_ns))?;
            return self.release(leaves_ns);
        }
        let message = |kind, number| LinkMessage {
            kind,
            number,
            time_ns: leaves_ns,
        };
        let data = message(MessageKind::Data, self.summary.packets);
        self.summary.packets += 1;
        self.datagram(data, DATA_PORT, &packet.payload);
        if let Some(payload) = packet.position_packet(self.summary.packets) {
            let number = self.position_packets;
            self.position_packets += 1;
            let position = message(MessageKind::Position, number);
            self.datagram(position, POSITION_PORT, &payload);
        }
        self.release(leaves_ns)
    }

    fn datagram(&mut self, message: LinkMessage, port: u16, payload: &[u8]) {
        let (simulation, pending, order) = (self.simulation, &mut self.pending, &mut self.order);
        self.link.deliver(message, &mut |arrived| {
            let arrives_ns = arrived.time_ns.max(message.time_ns);
            let event = SimulationEvent::Datagram {
                at: simulation.host(arrives_ns),
                port,
                payload: payload.to_vec(),
            };
            push(pending, order, arrives_ns, event);
        });
    }

    /// Polls the drive as often as due before `until_ns`.
    fn poll_until(&mut self, until_ns: i64) -> ControlFlow<()> {
        while let Some((polls, gearing)) = self.polls
            && self.next_poll_ns <= until_ns.min(self.simulation.end_ns())
        {
            self.poll(polls, gearing);
            self.release(self.next_poll_ns.min(until_ns))?;
        }
        ControlFlow::Continue(())
    }

    fn poll(&mut self, polls: Polls, gearing: Gearing) {
        let (number, sent_ns) = (self.summary.polls, self.next_poll_ns);
        self.summary.polls += 1;
        self.queue_commands(sent_ns, polls, gearing);
        let request = match self.probe {
            Some(second) => DriveRequest::Probe(second),
            None => (self.commands.front().copied()).unwrap_or(DriveRequest::Position),
        };
        let simulation = self.simulation;
        let at = simulation.host(sent_ns);
        let event = SimulationEvent::Request { at, request };
        push(&mut self.pending, &mut self.order, sent_ns, event);
        let message = |kind, time_ns| LinkMessage {
            kind,
            number,
            time_ns,
        };
        let mut received = Vec::new();
        let sent = message(MessageKind::Request, sent_ns);
        self.link.deliver(sent, &mut |arrived| {
            received.push(arrived.time_ns.max(sent_ns));
        });
        let mut answered_ns: Option<i64> = None;
        for received_ns in received {
            // The drive reads the shaft halfway between request and answer.
            let read_ns = received_ns.saturating_add(polls.answer_ns / 2);
            let shaft = Degrees(self.course.shaft_deg(read_ns as f64 * 1e-9));
            let position_qc = match request {
                DriveRequest::Position => quadcounts(self.encoder.read(number, shaft), gearing),
                _ => 0,
            };
            let time_ns = received_ns.saturating_add(polls.answer_ns);
            let (pending, order) = (&mut self.pending, &mut self.order);
            let answer = message(MessageKind::Answer, time_ns);
            self.link.deliver(answer, &mut |arrived| {
                let arrives_ns = arrived.time_ns.max(time_ns);
                answered_ns = Some(answered_ns.map_or(arrives_ns, |first| first.min(arrives_ns)));
                let event = SimulationEvent::Answer {
                    at: simulation.host(arrives_ns),
                    request,
                    position_qc,
                };
                push(pending, order, arrives_ns, event);
            });
        }
        let timeout_ns = sent_ns.saturating_add(TIMEOUT_PERIODS.saturating_mul(polls.period_ns));
        self.probe = match answered_ns.filter(|answered_ns| *answered_ns <= timeout_ns) {
            // A later answer cannot be assigned to its request.
            None => Some(!self.probe.unwrap_or(true)),
            Some(_) => {
                if self.probe.is_none() {
                    self.commands.pop_front();
                }
                None
            }
        };
        // The next even interval.
        let free_ns = answered_ns.unwrap_or(timeout_ns).min(timeout_ns);
        let periods = (free_ns.saturating_sub(sent_ns) / polls.period_ns).max(0);
        self.next_poll_ns = sent_ns.saturating_add((periods + 1).saturating_mul(polls.period_ns));
    }

    /// Queues the commands of the next move when it is due.
    fn queue_commands(&mut self, now_ns: i64, polls: Polls, gearing: Gearing) {
        let ahead_s = COMMAND_PERIODS.saturating_mul(polls.period_ns) as f64 * 1e-9;
        let due = |next: &&AxisMove| now_ns as f64 * 1e-9 >= next.begin_s - ahead_s;
        if !self.commands.is_empty() {
            return;
        }
        if let Some(next) = self.moves.as_slice().first().filter(due) {
            self.moves.next();
            let speed = next.cruise_deg_s.abs();
            let accel = match next.ramp_s > 0.0 {
                true => speed / next.ramp_s,
                false => f64::INFINITY,
            };
            self.commands.extend([
                DriveRequest::Target(quadcounts(Degrees(next.to_deg), gearing)),
                DriveRequest::Speed(speed),
                DriveRequest::Acceleration(accel),
                DriveRequest::Deceleration(accel),
                DriveRequest::Ready,
                DriveRequest::Go,
            ]);
        }
    }

    /// Passes on what arrives until then; nothing that is sent later arrives earlier.
    fn release(&mut self, until_ns: i64) -> ControlFlow<()> {
        while let Some(next) = self.pending.first_entry()
            && next.key().0 <= until_ns
        {
            self.sink.event(&next.remove())?;
        }
        ControlFlow::Continue(())
    }

    /// Passes on everything that is still under way and returns the counts.
    pub fn finish(mut self) -> SimulationSummary {
        if !self.summary.stopped {
            self.summary.stopped = self.poll_until(self.simulation.end_ns()).is_break()
                || self.release(i64::MAX).is_break();
        }
        self.summary.duration = Span::from_nanos(self.simulation.end_ns());
        self.summary
    }
}

/// The nearest count; saturates for angles beyond the counter's range.
fn quadcounts(angle: Degrees, gearing: Gearing) -> i32 {
    (angle.0 / gearing.degrees_per_qc()).round() as i32
}

fn push(pending: &mut Pending, order: &mut u64, arrives_ns: i64, event: SimulationEvent) {
    pending.insert((arrives_ns, *order), event);
    *order += 1;
}
