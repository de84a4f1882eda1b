//! The drive's client on a bad link. A script selects commands, time steps, and bytes that are
//! delivered, late, lost or forged.
//!
//! The other end of the link is the simulated unit. Each sample must be contained in the bytes that
//! completed it. Without forgery it must be the shaft's position at a time between its stamps, even
//! if requests and answers are lost or late. Each position read may return a unique value
//! ([`Marks`]), so that answers cannot be confused. A listener must agree with the client. Random
//! bit flips are excluded: a script finds the one flip in 65536 that a checksum misses.

use std::collections::VecDeque;

use drive::{
    AxisConfig, DriveClient, DriveCommand, DriveEvent, DriveListener, MoveCommand, Observation,
    ShaftSample,
};
use firmware_sim::epos2::{
    CanServer, Rs232Server, SimulatedDrive, SimulatedDriveConfig, UsbServer,
};
use protocol::canopen::{CanFrame, SOCKETCAN_LEN};
use protocol::epos2::message::{ReadObject, SerialAnswer};
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::epos2::{DeviceError, SerialFrame, objects};
use protocol::record::{Direction, DriveLink};
use units::{Degrees, Host, Rpm, RpmPerS, Span, Stamp};

use super::drive_marks::Marks;
use super::input::Input;

/// Start time of a script.
const START: Stamp<Host> = Stamp::from_nanos(1_795_000_000_000_000_000);
/// Maximum control cycles of a script.
const MAX_TICKS: u64 = 3_000;
/// Maximum iterations of the client's loop.
const MAX_ITERATIONS: u32 = 4_000;

/// Runs a script; returns the number of the client's samples.
pub fn holds(input: &mut Input<'_>) -> usize {
    let head = input.u8();
    let link = [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can][usize::from(head & 0x7F) % 3];
    let mut world = World::new(link, head & 0x80 != 0);
    while !input.is_empty() && world.ticks < MAX_TICKS && world.turns < MAX_ITERATIONS {
        world.act(input);
        world.compare();
    }
    world.samples
}

#[allow(clippy::large_enum_variant)] // there is one of it
enum Server {
    Usb(UsbServer),
    Rs232(Rs232Server),
    Can(Box<CanServer>),
}

/// Bytes in transit, with the time of sending.
type Transit = VecDeque<(Stamp<Host>, Vec<u8>)>;

struct World {
    link: DriveLink,
    client: DriveClient,
    listener: DriveListener,
    node: SimulatedDrive,
    server: Server,
    now: Stamp<Host>,
    ticks: u64,
    turns: u32,
    to_node: Transit,
    to_host: Transit,
    /// When the client sent bytes.
    handed_out: Vec<Stamp<Host>>,
    /// When the unit received bytes, with the shaft's position.
    truth: Vec<(Stamp<Host>, i32)>,
    /// Gives each position read a unique value.
    marks: Option<Marks>,
    /// Only bytes of the unit were delivered.
    unforged: bool,
    /// The last bytes delivered.
    received: Vec<u8>,
    decoder: UsbDecoder,
    /// Position values of the answers among them (USB).
    values: Vec<i32>,
    /// The listener's samples.
    observed: Vec<ShaftSample>,
    samples: usize,
}

impl World {
    fn new(link: DriveLink, marked: bool) -> Self {
        let mut axis = AxisConfig::default();
        // Method 35 homes at the current position, so that a script need not wait.
        axis.homing.method = 35;
        axis.homing.offset = Degrees(0.0);
        axis.homing.home_position = Degrees(0.0);
        Self {
            link,
            listener: DriveListener::new(axis.node),
            client: DriveClient::new(axis, link),
            node: SimulatedDrive::new(SimulatedDriveConfig::default()),
            server: match link {
                DriveLink::Usb => Server::Usb(UsbServer::new(7)),
                DriveLink::Rs232 => Server::Rs232(Rs232Server::new(7)),
                DriveLink::Can => Server::Can(Box::default()),
            },
            now: START,
            ticks: 0,
            turns: 0,
            to_node: Transit::new(),
            to_host: Transit::new(),
            handed_out: Vec::new(),
            truth: Vec::new(),
            marks: marked.then(|| Marks::new(link)),
            unforged: true,
            received: Vec::new(),
            decoder: UsbDecoder::new(),
            values: Vec::new(),
            observed: Vec::new(),
            samples: 0,
        }
    }

    /// Longest transit time in one direction. The client relies on it: on USB it expects no answer
    /// after two seconds, on RS232 none after 20 ms of silence, on CAN none to a SYNC of 100 ms
    /// ago.
    fn max_transit(&self) -> Span {
        Span::from_millis(match self.link {
            DriveLink::Usb => 900,
            DriveLink::Rs232 => 8,
            DriveLink::Can => 40,
        })
    }

    fn act(&mut self, input: &mut Input<'_>) {
        match input.u8() % 16 {
            0 | 1 => (0..=input.u8()).for_each(|_| self.iterate()),
            2 => {
                (0..16 * u32::from(input.u8())).for_each(|_| self.iterate());
            }
            3 | 4 => self.start(input),
            5 => self.pass(Span::from_micros(input.u8().into())),
            6 => self.pass(Span::from_millis((input.u8() & 0x3F).into())),
            7 => self.transmit(),
            8 => self.reach_node(),
            9 => self.reach_host(usize::MAX),
            10 => self.reach_host(input.u8().into()),
            11 => drop(self.to_node.pop_front()),
            12 => drop(self.to_host.pop_front()),
            13 => self.client.handle_timeout(self.now),
            14 => self.disturb(input),
            _ => self.forge(input),
        }
    }

    fn start(&mut self, input: &mut Input<'_>) {
        let to = MoveCommand {
            to: Degrees(f64::from(input.u8().cast_signed()) / 2.0),
            speed: Rpm(1_125),
            acceleration: RpmPerS(10_000),
        };
        let command = match input.u8() % 9 {
            0 => DriveCommand::Connect,
            1 => DriveCommand::Home,
            2 => DriveCommand::Goto(to),
            3 => DriveCommand::Sweep(to),
            4 => DriveCommand::Hold {
                until: self.now + Span::from_millis(100),
            },
            5 => DriveCommand::Stop,
            6 => DriveCommand::Brake,
            7 => DriveCommand::ClearFaults,
            _ => DriveCommand::Status,
        };
        // A refused command does not matter here.
        let _ = self.client.start(command);
    }

    /// Disturbs the unit.
    fn disturb(&mut self, input: &mut Input<'_>) {
        match input.u8() % 4 {
            0 => self.node.inject(DeviceError::OVERCURRENT),
            1 => self.node.block(),
            2 => self.node.unblock(),
            _ => self.node.power_cycle(),
        }
    }

    /// Delivers bytes that the unit never sent.
    fn forge(&mut self, input: &mut Input<'_>) {
        self.unforged = false;
        let choice = input.u8();
        let bytes = match (choice & 3, self.link) {
            (0, DriveLink::Usb) => {
                let words = [0, 0, input.u16(), input.u16()];
                let words = &words[..usize::from(choice >> 2) % 5];
                let frame = SerialFrame::new(SerialFrame::ANSWER, words).expect("few words");
                usb::to_bytes(&frame).as_slice().to_vec()
            }
            (0, DriveLink::Can) => {
                let frame = super::can_frames::frame(input);
                frame.to_socketcan().to_vec()
            }
            (1, _) => {
                // Damage bytes in transit.
                let damaged = self.to_host.pop_front();
                let mut bytes = damaged.map_or_else(Vec::new, |(_, bytes)| bytes);
                let at = usize::from(input.u8()) % bytes.len().max(1);
                let flip = input.u8();
                bytes.iter_mut().skip(at).take(1).for_each(|b| *b ^= flip);
                bytes
            }
            _ => input.short().to_vec(),
        };
        self.receive(&bytes);
    }

    /// Runs one undisturbed iteration of the client's loop.
    fn iterate(&mut self) {
        if self.ticks >= MAX_TICKS || self.turns >= MAX_ITERATIONS {
            return;
        }
        self.turns += 1;
        self.transmit();
        while !self.to_node.is_empty() {
            self.reach_node();
        }
        let soon = self.now + Span::from_micros(100);
        let later = self.now + Span::from_millis(1);
        let due = self.client.poll_timeout().unwrap_or(later);
        let until = if self.to_host.is_empty() {
            due.max(soon).min(later)
        } else {
            soon
        };
        self.pass(until.saturating_since(self.now));
        self.reach_host(usize::MAX);
        self.client.handle_timeout(self.now);
        self.compare();
    }

    fn pass(&mut self, span: Span) {
        self.now = self.now.saturating_add(span);
        let since_us = self.now.saturating_since(START).as_nanos() / 1_000;
        let due = u64::try_from(since_us / 1_000).unwrap_or_default();
        while self.ticks < due.min(MAX_TICKS) {
            self.ticks += 1;
            self.node.tick();
            if let Server::Can(server) = &mut self.server {
                let (now, to_host) = (self.now, &mut self.to_host);
                server.poll(&mut self.node, &mut |frame| {
                    to_host.push_back((now, frame.to_socketcan().to_vec()));
                });
            }
        }
        self.node.set_phase_us((since_us % 1_000) as u32);
        let born = self.now.saturating_add(-self.max_transit());
        for way in [&mut self.to_node, &mut self.to_host] {
            while way.front().is_some_and(|(since, _)| *since < born) {
                way.pop_front();
            }
        }
    }

    fn transmit(&mut self) {
        while let Some(bytes) = self.client.poll_transmit(self.now) {
            self.handed_out.push(self.now);
            self.observe(Direction::ToDrive, &bytes);
            self.to_node.push_back((self.now, bytes));
        }
    }

    fn reach_node(&mut self) {
        let Some((_, bytes)) = self.to_node.pop_front() else {
            return;
        };
        let mut answers = Vec::new();
        let mut send = |bytes: &[u8]| answers.push(bytes.to_vec());
        let qc = position(&mut self.node);
        match &mut self.server {
            Server::Usb(server) => server.input(&mut self.node, &bytes, &mut send),
            Server::Rs232(server) => server.input(&mut self.node, &bytes, &mut send),
            Server::Can(server) => {
                let frame = CanFrame::from_socketcan(&bytes).expect("a frame of the client's");
                server.input(&mut self.node, &frame, &mut |frame| {
                    send(&frame.to_socketcan());
                });
            }
        }
        let qc = self.marks.as_mut().map_or(qc, |marks| {
            answers
                .iter_mut()
                .for_each(|answer| marks.put(&bytes, answer));
            marks.next()
        });
        self.truth.push((self.now, qc));
        self.to_host
            .extend(answers.into_iter().map(|bytes| (self.now, bytes)));
    }

    /// Delivers up to `len` bytes to the host; on CAN, one frame.
    fn reach_host(&mut self, len: usize) {
        let all = len == usize::MAX;
        while let Some((since, mut bytes)) = self.to_host.pop_front() {
            if !all && self.link != DriveLink::Can && len < bytes.len() {
                let rest = bytes.split_off(len);
                self.to_host.push_front((since, rest));
            }
            self.receive(&bytes);
            if !all {
                return;
            }
        }
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.received.extend(bytes);
        let pushed = bytes.iter().filter_map(|&byte| self.decoder.push(byte));
        self.values.extend(
            pushed
                .flatten()
                .filter_map(|frame| SerialAnswer::parse(&frame).ok()?.value().ok())
                .map(u32::cast_signed),
        );
        // One record per frame on a CAN bus, as a recorder writes them.
        let piece = match self.link {
            DriveLink::Can => SOCKETCAN_LEN,
            DriveLink::Usb | DriveLink::Rs232 => bytes.len().max(1),
        };
        for record in bytes.chunks(piece) {
            self.observe(Direction::FromDrive, record);
        }
        self.client.handle_input(bytes, self.now);
        self.compare();
    }

    fn observe(&mut self, direction: Direction, bytes: &[u8]) {
        let observed = &mut self.observed;
        self.listener
            .observe(self.link, direction, bytes, self.now, &mut |seen| {
                if let Observation::Sample(sample) = seen {
                    observed.push(sample);
                }
            });
    }

    /// Takes the samples of client and listener and compares them with the bytes.
    fn compare(&mut self) {
        while let Some(event) = self.client.poll_event() {
            if let DriveEvent::Sample(sample) = event {
                self.check(&sample, "client");
                self.samples += 1;
                let seen = self.observed.iter().any(|seen| is_same(&sample, seen));
                assert!(seen || !self.unforged, "the listener missed {sample:?}");
            }
        }
        for sample in std::mem::take(&mut self.observed) {
            self.check(&sample, "listener");
        }
        if self.link == DriveLink::Rs232 {
            // The longest body may arrive in pieces.
            let old = self.received.len().saturating_sub(rs232_memory());
            self.received.drain(..old);
        } else {
            self.received.clear();
        }
        self.values.clear();
    }

    fn check(&self, sample: &ShaftSample, who: &str) {
        let (request, answer, position) = (sample.request, sample.answer, sample.position);
        // On RS232 a listener knows when the answer was announced.
        let is_past = self.link == DriveLink::Rs232 && answer < self.now;
        assert!(answer == self.now || is_past, "{who}: {sample:?}");
        // Both are in order of time.
        let is_sent = self.handed_out.binary_search(&request).is_ok();
        assert!(is_sent, "{who}: {sample:?}");
        let bytes = position.0.to_le_bytes();
        let carried = match self.link {
            DriveLink::Usb => self.values.contains(&position.0),
            DriveLink::Rs232 | DriveLink::Can => self.received.windows(4).any(|w| w == bytes),
        };
        assert!(carried, "{who}: {sample:?} in none of {:X?}", self.received);
        if self.unforged {
            let begin = self.truth.partition_point(|&(at, _)| at < request);
            let held = self.truth.get(begin..).unwrap_or_default();
            let held = held
                .iter()
                .any(|&(at, qc)| at <= answer && qc == position.0);
            assert!(held, "{who}: {sample:?}, but {:?}", self.truth.last());
        }
    }
}

/// Whether a listener's sample equals the client's.
fn is_same(client: &ShaftSample, listener: &ShaftSample) -> bool {
    let mut at_latest = *listener;
    at_latest.answer = at_latest.answer.max(client.answer);
    at_latest == *client
}

const fn rs232_memory() -> usize {
    2 * protocol::epos2::rs232::MAX_BYTES
}

/// The current shaft position, read over a separate interface.
fn position(node: &mut SimulatedDrive) -> i32 {
    let read = ReadObject {
        node: node.node_id(),
        address: objects::POSITION_ACTUAL.address,
    };
    let mut value = None;
    let mut decoder = UsbDecoder::new();
    let request = usb::to_bytes(&read.to_frame());
    UsbServer::new(0).input(node, &request, &mut |bytes| {
        let frame = bytes.iter().find_map(|&byte| decoder.push(byte));
        let answer = frame
            .and_then(Result::ok)
            .map(|frame| SerialAnswer::parse(&frame));
        value = answer.and_then(Result::ok).and_then(|a| a.value().ok());
    });
    value.expect("the unit knows its position").cast_signed()
}
