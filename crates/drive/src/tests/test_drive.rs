//! The simulated EPOS2 of firmware-sim in virtual time, on a link that loses, delays, damages,
//! repeats or replaces any reply. Drive and client share only the frames.

use std::collections::VecDeque;

use firmware_sim::epos2::{
    CanServer, Rs232Server, SimulatedDrive, SimulatedDriveConfig, UnitIdentity, UsbServer,
};
use protocol::canopen::CanFrame;
use protocol::epos2::cia402::DeviceState;
use protocol::epos2::message::SerialRequest;
use protocol::epos2::objects::Address;
use protocol::epos2::{AbortCode, DeviceError};
use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use super::long_object::LongObject;
use super::wire::{BusFaults, RequestTap};

/// Faults of a request and its reply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fate {
    Sent,
    Lost,
    Late(Span),
    Damaged,
    Twice,
    /// The drive receives the request damaged.
    Rejected,
    /// The reply is that of another request, of another kind.
    Another,
    /// The drive confirms the request without executing it.
    Ignored,
    /// The drive refuses the request.
    Refused(AbortCode),
    /// The object reads as this value.
    Value(u32),
}

/// Decides the fate of the n-th request (from 0).
pub type Hand = Box<dyn FnMut(usize, &SerialRequest) -> Fate>;
/// Transforms bytes that arrive at this time.
pub type Distortion = Box<dyn FnMut(Stamp<Host>, Vec<u8>) -> Vec<u8>>;

/// The drive's side of a link.
#[allow(clippy::large_enum_variant)] // one or two of them in a test
pub(super) enum Server {
    Usb(UsbServer),
    Rs232(Rs232Server),
    Can(Box<CanServer>),
}

impl Server {
    pub fn new(link: DriveLink) -> Self {
        match link {
            DriveLink::Usb => Self::Usb(UsbServer::new(7)),
            DriveLink::Rs232 => Self::Rs232(Rs232Server::new(7)),
            DriveLink::Can => Self::Can(Box::default()),
        }
    }

    /// Takes bytes from the host; returns the drive's.
    pub fn input(&mut self, node: &mut SimulatedDrive, bytes: &[u8]) -> Vec<Vec<u8>> {
        let mut answers = Vec::new();
        match self {
            Self::Usb(server) => server.input(node, bytes, &mut |b| answers.push(b.to_vec())),
            Self::Rs232(server) => server.input(node, bytes, &mut |b| answers.push(b.to_vec())),
            Self::Can(server) => {
                let frame = CanFrame::from_socketcan(bytes).unwrap();
                server.input(node, &frame, &mut |f| {
                    answers.push(f.to_socketcan().to_vec())
                });
            }
        }
        answers
    }

    /// The drive's unsolicited frames. Call it after each tick of the node.
    pub fn poll(&mut self, node: &mut SimulatedDrive) -> Vec<Vec<u8>> {
        let mut replies = Vec::new();
        if let Self::Can(server) = self {
            server.poll(node, &mut |f| replies.push(f.to_socketcan().to_vec()));
        }
        replies
    }
}

/// A control cycle.
const CYCLE: Span = Span::from_millis(1);
pub const SERIAL: u32 = 0x9090_9090;

pub struct TestDrive {
    pub node: SimulatedDrive,
    pub(super) server: Server,
    tap: RequestTap,
    pub link: DriveLink,
    /// CAN services other than SDO.
    pub bus: BusFaults,
    /// Replaces the name (1008).
    pub long_object: Option<LongObject>,
    /// Transfers aborted by the client (CAN).
    pub aborts: Vec<AbortCode>,
    /// A device error at this time.
    pub fault_at: Option<(Stamp<Host>, DeviceError)>,
    pub hand: Hand,
    pub distort: Distortion,
    /// Delay of the host's bytes, and of each byte either way.
    pub forth: Span,
    pub per_byte: Span,
    pub turnaround: Span,
    /// Bytes on their way to the drive.
    inbound: VecDeque<(Stamp<Host>, Vec<u8>)>,
    answers: Vec<(Stamp<Host>, Vec<u8>)>,
    is_cut: bool,
    pub requests: Vec<(Stamp<Host>, SerialRequest)>,
    /// The drive's last start, and its present control cycle.
    pub started: Stamp<Host>,
    cycle: Stamp<Host>,
    /// Start of each control cycle, and the shaft's motion through it, world qc.
    truth: Vec<(Stamp<Host>, f64, f64)>,
}

/// A drive with factory settings that is used without a CAN bus, close to its negative switch so
/// that homing takes half a second.
pub fn near_its_switch() -> SimulatedDriveConfig {
    SimulatedDriveConfig {
        initial_position: -43_300,
        identity: UnitIdentity {
            serial_number: 0x5349_4D55_0000_0000 | u64::from(SERIAL),
            ..UnitIdentity::default()
        },
        ..SimulatedDriveConfig::default()
    }
}

impl TestDrive {
    pub fn new(link: DriveLink, config: SimulatedDriveConfig, now: Stamp<Host>) -> Self {
        Self {
            node: SimulatedDrive::new(config),
            server: Server::new(link),
            tap: RequestTap::new(link),
            link,
            bus: BusFaults::default(),
            long_object: None,
            aborts: Vec::new(),
            fault_at: None,
            hand: Box::new(|_, _| Fate::Sent),
            distort: Box::new(|_, bytes| bytes),
            forth: match link {
                DriveLink::Can => Span::from_micros(120),
                DriveLink::Usb | DriveLink::Rs232 => Span::ZERO,
            },
            per_byte: Span::ZERO,
            turnaround: Span::from_micros(800),
            inbound: VecDeque::new(),
            answers: Vec::new(),
            is_cut: false,
            requests: Vec::new(),
            started: now,
            cycle: now,
            truth: Vec::new(),
        }
    }

    /// Loses every reply until this time.
    pub fn lose_replies_until(&mut self, until: Stamp<Host>) {
        self.distort = Box::new(move |at, bytes| match at < until {
            true => Vec::new(),
            false => bytes,
        });
    }

    /// Sends bytes to the drive.
    pub fn input(&mut self, bytes: &[u8], now: Stamp<Host>) {
        if self.is_cut {
            return;
        }
        let before = self.inbound.back().map_or(now, |inbound| inbound.0);
        let at = (now + self.forth + self.wire_time(bytes)).max(before);
        self.inbound.push_back((at, bytes.to_vec()));
        self.live(now);
    }

    fn wire_time(&self, bytes: &[u8]) -> Span {
        Span::from_nanos(self.per_byte.as_nanos() * bytes.len() as i64)
    }

    /// Cuts the cable.
    pub fn cut(&mut self) {
        self.is_cut = true;
        self.inbound.clear();
        self.answers.clear();
    }

    /// Gives writes of an object this fate, and other requests none.
    pub fn on_write(&mut self, index: u16, sub: u8, fate: Fate) {
        let address = Address::new(index, sub);
        self.hand = Box::new(move |_, request| match request {
            SerialRequest::WriteObject(write) if write.address == address => fate,
            _ => Fate::Sent,
        });
    }

    /// Records a request and decides its fate.
    pub(super) fn meet(&mut self, request: SerialRequest, now: Stamp<Host>) -> Fate {
        let fate = (self.hand)(self.requests.len(), &request);
        self.requests.push((now, request));
        fate
    }

    /// Advances the drive.
    pub fn live(&mut self, now: Stamp<Host>) {
        loop {
            let input = self.inbound.front().map(|inbound| inbound.0);
            let fault = self.fault_at.map(|(at, _)| at);
            let due = [input, fault].into_iter().flatten();
            let next = due.fold(self.cycle + CYCLE, Stamp::min);
            if next > now {
                break;
            }
            self.enter(next);
            if next == self.cycle + CYCLE {
                self.node.tick();
                self.cycle = next;
                let way = self.node.segment();
                let [start, end] = [way.start, way.end].map(|q32| q32 as f64 / 2f64.powi(32));
                self.truth.push((next, start, end));
            } else if let Some((_, error)) = self.fault_at.take_if(|fault| fault.0 <= next) {
                self.node.inject(error);
            } else if let Some((at, bytes)) = self.inbound.pop_front() {
                let mut tap = std::mem::replace(&mut self.tap, RequestTap::Gone);
                tap.input(self, &bytes, at);
                self.tap = tap;
            }
            let sent = self.server.poll(&mut self.node);
            self.on_bus(sent, next);
        }
        self.enter(now);
    }

    /// Sets the node's time within its control cycle.
    fn enter(&mut self, now: Stamp<Host>) {
        let us = (now - self.cycle).as_nanos() / 1_000;
        self.node.set_phase_us(us as u32);
    }

    /// The drive's clock (1013).
    pub fn drive_us(&self, at: Stamp<Host>) -> u32 {
        ((at - self.started).as_nanos() / 1_000) as u32
    }

    /// Sends bytes after the turnaround and `by`, after those already queued.
    pub fn send(&mut self, bytes: Vec<u8>, by: Span, now: Stamp<Host>) {
        let earliest = now + self.turnaround + self.wire_time(&bytes);
        let at = self.answers.last().map_or(earliest, |a| a.0.max(earliest));
        if !self.is_cut {
            self.answers.push((at + by, bytes));
        }
    }

    /// Sends a frame without a request.
    pub fn send_at(&mut self, bytes: Vec<u8>, at: Stamp<Host>) {
        if !self.is_cut {
            self.answers.push((at, bytes));
            self.answers.sort_by_key(|a| a.0);
        }
    }

    /// The next instant at which the drive may send something.
    pub fn next_answer(&self) -> Stamp<Host> {
        let answer = self.answers.first().map(|a| a.0);
        let input = self.inbound.front().map(|inbound| inbound.0);
        let due = [answer, input].into_iter().flatten();
        due.fold(self.cycle + CYCLE, Stamp::min)
    }

    pub fn take_answer(&mut self, now: Stamp<Host>) -> Option<Vec<u8>> {
        self.live(now);
        let due = self.answers.first().is_some_and(|(at, _)| *at <= now);
        due.then(|| (self.distort)(now, self.answers.remove(0).1))
    }

    /// Restarts the drive: settings, reference and NMT state are lost.
    pub fn restart(&mut self, now: Stamp<Host>) {
        self.live(now);
        self.inbound.clear();
        self.answers.clear();
        self.node.power_cycle();
        (self.started, self.cycle) = (now, now);
        if self.link != DriveLink::Can {
            self.server = Server::new(self.link);
        }
        self.tap = RequestTap::new(self.link);
        let sent = self.server.poll(&mut self.node);
        self.on_bus(sent, now);
    }

    /// World position of the shaft at an instant.
    pub fn world_qc(&self, at: Stamp<Host>) -> f64 {
        let after = self.truth.partition_point(|t| t.0 <= at);
        let (t0, p0, p1) = self.truth[after - 1];
        p0 + (p1 - p0) * (at - t0).as_secs_f64() / 1e-3
    }

    pub fn is_at_rest(&self) -> bool {
        let way = self.node.segment();
        way.start == way.end
    }

    pub fn state(&self) -> DeviceState {
        self.node.state()
    }

    /// Position of the shaft (6064).
    pub fn position(&mut self, now: Stamp<Host>) -> i32 {
        self.live(now);
        self.get(0x6064, 0) as i32
    }

    pub fn get(&self, index: u16, sub: u8) -> u32 {
        let value = self.node.read(Address::new(index, sub)).unwrap();
        value.raw().unwrap()
    }

    pub fn set(&mut self, index: u16, sub: u8, value: u32) {
        self.node.write(Address::new(index, sub), value).unwrap();
    }
}
