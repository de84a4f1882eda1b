//! Both devices' traffic in order of time, through the links and out.
//!
//! The host asks the drive at even intervals, but never before the last answer has come or has been given up. Before each way of the motion it
//! writes what commands it, again and again until it is acknowledged; the axis goes its way on time whatever becomes of that. After an answer that was
//! given up it asks for markers until one is answered, as velomotion's client does. Left out: what a request looks like on its link.

use std::cmp::{Ordering, Reverse};
use std::collections::{BinaryHeap, VecDeque};
use std::ops::ControlFlow;

use firmware_sim::vlp16::{DATA_PORT, POSITION_PORT, Pps, position_packet};
use units::{Degrees, Gearing, Span};

use super::course::Course;
use super::worker::{Chunk, Packet};
use super::{Ask, Event, Out, Polls, Simulation, Summary};
use crate::effects::{Encoder, Parcel, ParcelKind, Wire};
use crate::motion::Leg;

/// Data packets from one position packet to the next, about as often as real sensors send one.
const DATA_PER_POSITION: u64 = 5;
/// An answer that has not come after so many periods is given up.
const PATIENCE_PERIODS: i64 = 8;

/// So many periods before a way begins its commands are written: six, and two to spare.
const COMMAND_PERIODS: i64 = 8;

/// What is on its way, in the order of arrival.
type Pending = BinaryHeap<Reverse<Waiting>>;

/// Something that will arrive. Of two that arrive at once, the one that was sent first comes first.
#[derive(Debug)]
struct Waiting {
    arrives_ns: i64,
    order: u64,
    what: What,
}

#[derive(Debug)]
enum What {
    Datagram { port: u16, payload: Vec<u8> },
    Request(Ask),
    Answer { ask: Ask, position_qc: i32 },
}

impl Waiting {
    const fn key(&self) -> (i64, u64) {
        (self.arrives_ns, self.order)
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Waiting {}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

pub(super) struct Merge<'a, E, W> {
    simulation: &'a Simulation,
    course: &'a Course,
    encoder: &'a mut E,
    wire: &'a mut W,
    out: &'a mut dyn Out,
    polls: Option<(Polls, Gearing)>,
    next_poll_ns: i64,
    /// Ways that were not commanded yet.
    legs: std::slice::Iter<'a, Leg>,
    /// What is to be written for the next one.
    commands: VecDeque<Ask>,
    /// The marker that is due while an answer is missing.
    marker: Option<bool>,
    pending: Pending,
    order: u64,
    summary: Summary,
}

impl<'a, E: Encoder, W: Wire> Merge<'a, E, W> {
    pub fn new(
        simulation: &'a Simulation,
        course: &'a Course,
        encoder: &'a mut E,
        wire: &'a mut W,
        out: &'a mut dyn Out,
    ) -> Self {
        let gearing = encoder.gearing();
        Self {
            simulation,
            course,
            encoder,
            wire,
            out,
            polls: simulation
                .polls
                .map(|polls| (polls, gearing.unwrap_or(polls.gearing))),
            next_poll_ns: 0,
            legs: simulation.motion.legs().iter(),
            commands: VecDeque::new(),
            marker: None,
            pending: Pending::new(),
            order: 0,
            summary: Summary::default(),
        }
    }

    /// Takes the next packets.
    pub fn chunk(&mut self, chunk: &Chunk) -> ControlFlow<()> {
        let mut points = chunk.points.as_slice();
        for packet in &chunk.packets {
            let (own, rest) = points.split_at_checked(packet.points).unwrap_or_default();
            points = rest;
            let taken = self.packet(packet);
            let told = match taken.is_continue() && !own.is_empty() {
                true => self.out.truth(own),
                false => taken,
            };
            if told.is_break() {
                self.summary.broken_off = true;
                return told;
            }
        }
        ControlFlow::Continue(())
    }

    fn packet(&mut self, packet: &Packet) -> ControlFlow<()> {
        self.poll_until(packet.leaves_ns)?;
        let number = self.summary.packets;
        self.summary.packets += 1;
        self.summary.shots += u64::from(packet.shots);
        self.summary.returned += u64::from(packet.returned);
        self.summary.returns += u64::from(packet.returns);
        let leaves_ns = packet.leaves_ns;
        self.datagram(
            ParcelKind::Data,
            number,
            leaves_ns,
            DATA_PORT,
            &packet.payload,
        );
        if self.summary.packets.is_multiple_of(DATA_PER_POSITION) {
            let payload = position_packet(packet.stamp_us, Pps::Absent, &[]);
            let number = self.summary.packets / DATA_PER_POSITION - 1;
            self.datagram(
                ParcelKind::Position,
                number,
                leaves_ns,
                POSITION_PORT,
                &payload,
            );
        }
        self.release(leaves_ns)
    }

    fn datagram(
        &mut self,
        kind: ParcelKind,
        number: u64,
        leaves_ns: i64,
        port: u16,
        payload: &[u8],
    ) {
        let (pending, order) = (&mut self.pending, &mut self.order);
        let parcel = Parcel {
            kind,
            number,
            leaves_ns,
        };
        self.wire.deliver(parcel, &mut |arrived| {
            let payload = payload.to_vec();
            let what = What::Datagram { port, payload };
            push(pending, order, arrived.leaves_ns.max(leaves_ns), what);
        });
    }

    /// Asks the drive as often as it is due before `until_ns`.
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
        let (number, asked_ns) = (self.summary.polls, self.next_poll_ns);
        self.summary.polls += 1;
        self.command(asked_ns, polls, gearing);
        let ask = match self.marker {
            Some(which) => Ask::Marker(which),
            None => self.commands.front().copied().unwrap_or(Ask::Position),
        };
        push(
            &mut self.pending,
            &mut self.order,
            asked_ns,
            What::Request(ask),
        );
        let parcel = |kind, leaves_ns| Parcel {
            kind,
            number,
            leaves_ns,
        };
        let mut heard = Vec::new();
        self.wire
            .deliver(parcel(ParcelKind::Request, asked_ns), &mut |arrived| {
                heard.push(arrived.leaves_ns.max(asked_ns));
            });
        let mut answered_ns = None;
        for heard_ns in heard {
            // The shaft is read in the middle of what the drive takes to answer.
            let read_ns = heard_ns.saturating_add(polls.answer_ns / 2);
            let shaft = Degrees(self.course.shaft_deg(read_ns as f64 * 1e-9));
            let position_qc = match ask {
                Ask::Position => quadcounts(self.encoder.read(number, shaft), gearing),
                _ => 0,
            };
            let leaves_ns = heard_ns.saturating_add(polls.answer_ns);
            let (pending, order) = (&mut self.pending, &mut self.order);
            self.wire
                .deliver(parcel(ParcelKind::Answer, leaves_ns), &mut |arrived| {
                    let arrives_ns = arrived.leaves_ns.max(leaves_ns);
                    let first = *answered_ns.get_or_insert(arrives_ns);
                    answered_ns = Some(first.min(arrives_ns));
                    push(
                        pending,
                        order,
                        arrives_ns,
                        What::Answer { ask, position_qc },
                    );
                });
        }
        let given_up_ns = asked_ns.saturating_add(PATIENCE_PERIODS.saturating_mul(polls.period_ns));
        self.marker = match answered_ns {
            // Of what comes later nobody can say to which request.
            None => Some(!self.marker.unwrap_or(true)),
            Some(answered_ns) if answered_ns > given_up_ns => Some(!self.marker.unwrap_or(true)),
            Some(_) => {
                if self.marker.is_none() {
                    self.commands.pop_front();
                }
                None
            }
        };
        // The next even interval after that.
        let free_ns = answered_ns.unwrap_or(given_up_ns).min(given_up_ns);
        let taken = (free_ns.saturating_sub(asked_ns) / polls.period_ns).max(0);
        self.next_poll_ns = asked_ns.saturating_add((taken + 1).saturating_mul(polls.period_ns));
    }

    /// Sees whether it is time to command the next way.
    fn command(&mut self, now_ns: i64, polls: Polls, gearing: Gearing) {
        let ahead_s = COMMAND_PERIODS.saturating_mul(polls.period_ns) as f64 * 1e-9;
        let due = |leg: &&Leg| now_ns as f64 * 1e-9 >= leg.begin_s - ahead_s;
        if !self.commands.is_empty() {
            return;
        }
        if let Some(leg) = self.legs.as_slice().first().filter(due) {
            self.legs.next();
            let speed = leg.cruise_deg_s.abs();
            let accel = match leg.ramp_s > 0.0 {
                true => speed / leg.ramp_s,
                false => f64::INFINITY,
            };
            self.commands.extend([
                Ask::Target(quadcounts(Degrees(leg.to_deg), gearing)),
                Ask::Speed(speed),
                Ask::Acceleration(accel),
                Ask::Deceleration(accel),
                Ask::Ready,
                Ask::Go,
            ]);
        }
    }

    /// Hands on what arrives until then: nothing that is sent later can be earlier.
    fn release(&mut self, until_ns: i64) -> ControlFlow<()> {
        while self
            .pending
            .peek()
            .is_some_and(|Reverse(next)| next.arrives_ns <= until_ns)
        {
            let Some(Reverse(next)) = self.pending.pop() else {
                break;
            };
            let at = self.simulation.host(next.arrives_ns);
            let event = match &next.what {
                What::Datagram { port, payload } => Event::Datagram {
                    at,
                    port: *port,
                    payload,
                },
                What::Request(ask) => Event::Request { at, ask: *ask },
                What::Answer { ask, position_qc } => Event::Answer {
                    at,
                    ask: *ask,
                    position_qc: *position_qc,
                },
            };
            self.out.event(&event)?;
        }
        ControlFlow::Continue(())
    }

    /// Everything that is still on its way, and what there is to say.
    pub fn finish(mut self) -> Summary {
        if !self.summary.broken_off {
            let ended = self.poll_until(self.simulation.end_ns()).is_break()
                || self.release(i64::MAX).is_break();
            self.summary.broken_off = ended;
        }
        self.summary.lasted = Span::from_nanos(self.simulation.end_ns());
        self.summary
    }
}

/// The nearest count; saturates for angles that no counter holds.
fn quadcounts(angle: Degrees, gearing: Gearing) -> i32 {
    (angle.0 / gearing.degrees_per_qc()).round() as i32
}

fn push(pending: &mut Pending, order: &mut u64, arrives_ns: i64, what: What) {
    pending.push(Reverse(Waiting {
        arrives_ns,
        order: *order,
        what,
    }));
    *order += 1;
}
