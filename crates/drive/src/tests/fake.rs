//! A scripted drive: an object dictionary, the states that the client uses, an axis that follows
//! its profile exactly, and hooks that lose, delay, damage or repeat any reply. It shares only the
//! frame format with the client.

use std::collections::BTreeMap;

use protocol::epos2::message::{
    InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, ReadSegment, SegmentedRead,
    SegmentedWrite, SerialAnswer, SerialRequest, WriteObject, WriteSegment,
};
use protocol::epos2::objects::Address;
use protocol::epos2::{Bounded, CommError, SerialFrame};
use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use protocol::canopen::nmt::NmtState;

use super::wire::{FakeBus, Wire};

/// What happens to a reply.
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
}

/// Decides the fate of the reply to the n-th request (from 0).
pub type Hand = Box<dyn FnMut(usize, &SerialRequest) -> Fate>;
/// Transforms bytes that arrive at this time.
pub type Distortion = Box<dyn FnMut(Stamp<Host>, Vec<u8>) -> Vec<u8>>;

#[derive(Clone, Copy, Debug)]
struct Motion {
    from: f64,
    to: f64,
    began: Stamp<Host>,
    /// qc per second.
    speed: f64,
    /// qc per second squared.
    acceleration: f64,
}

pub struct Fake {
    wire: Wire,
    /// The CAN services other than SDO.
    pub bus: FakeBus,
    pub name: Vec<u8>,
    /// Bytes of the name read so far.
    name_at: usize,
    /// Bytes of the name written so far, and the total length.
    writing: Option<(Vec<u8>, usize)>,
    /// Transfers aborted by the client (CAN).
    pub aborts: Vec<CommError>,
    /// Segments have the wrong toggle bit.
    pub wrong_toggle: bool,
    pub objects: BTreeMap<(u16, u8), u32>,
    /// State bits of the statusword.
    pub state: u16,
    pub flags: u16,
    controlword: u16,
    place: f64,
    motion: Option<Motion>,
    homing_until: Option<Stamp<Host>>,
    pub homing_time: Span,
    /// The axis does not follow.
    pub blocked: bool,
    pub deaf_to_quick_stop: bool,
    /// Switching the power off does not stop the axis either.
    pub deaf_to_power_off: bool,
    /// A fault at this time.
    pub fault_at: Option<(Stamp<Host>, u16)>,
    pub faults_that_stay: bool,
    /// Objects that ignore writes.
    pub stubborn: Vec<(u16, u8)>,
    /// Objects that refuse writes.
    pub refuses: Vec<(u16, u8)>,
    pub hand: Hand,
    pub distort: Distortion,
    pub turnaround: Span,
    answers: Vec<(Stamp<Host>, Vec<u8>)>,
    pub requests: Vec<(Stamp<Host>, SerialRequest)>,
    junk: u32,
}

pub const DISABLED: u16 = 0x0140;
pub const READY: u16 = 0x0121;
pub const ENABLED: u16 = 0x0137;
pub const QUICK_STOP: u16 = 0x0117;
pub const FAULT: u16 = 0x0108;
const REMOTE: u16 = 1 << 9;
const REACHED: u16 = 1 << 10;
const ACKNOWLEDGED: u16 = 1 << 12;
const REFERENCED: u16 = 1 << 15;

impl Fake {
    pub fn new() -> Self {
        Self::on(DriveLink::Usb)
    }

    /// A drive with factory settings, and error 8120 from having been used without a CAN bus.
    pub fn on(link: DriveLink) -> Self {
        let objects = [
            (0x1000, 0, 0x0002_0192),
            (0x1003, 0, 1),
            (0x1003, 1, 0x8120),
            (0x1018, 1, 0xFB),
            (0x1018, 2, 0x6420_0000),
            (0x1018, 3, 0x2126_0000),
            (0x1018, 4, 0x9090_9090),
            (0x1016, 1, 0),
            (0x1017, 0, 0),
            (0x1800, 1, 0x4000_0181),
            (0x1800, 2, 0xFF),
            (0x1800, 3, 10),
            (0x1A00, 0, 1),
            (0x1A00, 1, 0x6041_0010),
            (0x1A00, 2, 0),
            (0x2003, 1, 0x2126),
            (0x2003, 2, 0x6420),
            (0x2070, 4, 2),
            (0x2070, 5, 1),
            (0x2070, 6, 0),
            (0x2071, 1, 0),
            (0x2071, 2, 0xE387),
            (0x2071, 3, 0),
            (0x2071, 4, 8),
            (0x2078, 2, 0),
            (0x2078, 3, 0),
            (0x2079, 1, 15),
            (0x2081, 0, 0),
            (0x2100, 1, 0),
            (0x2100, 2, 0),
            (0x2210, 1, 500),
            (0x2210, 2, 1),
            (0x2210, 4, 0),
            (0x6007, 0, 3),
            (0x605E, 0, 2),
            (0x608B, 0, 0),
            (0x6410, 4, 25_000),
            (0x6060, 0, 1),
            (0x6065, 0, 2000),
            (0x6067, 0, u32::MAX),
            (0x606C, 0, 0),
            (0x607A, 0, 0),
            (0x607C, 0, 0),
            (0x607D, 1, i32::MIN as u32),
            (0x607D, 2, i32::MAX as u32),
            (0x607F, 0, 25_000),
            (0x6081, 0, 1000),
            (0x6083, 0, 10_000),
            (0x6084, 0, 10_000),
            (0x6085, 0, 10_000),
            (0x6086, 0, 0),
            (0x6098, 0, 7),
            (0x6099, 1, 100),
            (0x6099, 2, 10),
            (0x609A, 0, 1000),
            (0x60C5, 0, u32::MAX),
        ];
        Self {
            wire: Wire::new(link),
            bus: FakeBus::default(),
            name: b"EPOS2".to_vec(),
            name_at: 0,
            writing: None,
            aborts: Vec::new(),
            wrong_toggle: false,
            objects: objects.map(|(index, sub, v)| ((index, sub), v)).into(),
            state: FAULT,
            flags: 0x0200,
            controlword: 0,
            place: 1234.0,
            motion: None,
            homing_until: None,
            homing_time: Span::from_millis(700),
            blocked: false,
            deaf_to_quick_stop: false,
            deaf_to_power_off: false,
            fault_at: None,
            faults_that_stay: false,
            stubborn: Vec::new(),
            refuses: Vec::new(),
            hand: Box::new(|_, _| Fate::Sent),
            distort: Box::new(|_, bytes| bytes),
            turnaround: Span::from_micros(800),
            answers: Vec::new(),
            requests: Vec::new(),
            junk: 0x9002_1357,
        }
    }

    /// Processes bytes from the host.
    pub fn input(&mut self, bytes: &[u8], now: Stamp<Host>) {
        self.live(now);
        let mut wire = std::mem::replace(&mut self.wire, Wire::Gone);
        wire.input(self, bytes, now);
        self.wire = wire;
    }

    /// Executes a request unless it is rejected; returns the answer and its fate.
    pub fn execute(&mut self, request: SerialRequest, now: Stamp<Host>) -> (SerialFrame, Fate) {
        let fate = (self.hand)(self.requests.len(), &request);
        self.requests.push((now, request));
        let answer = if fate == Fate::Rejected {
            SerialAnswer::bare(CommError::CRC).to_frame()
        } else {
            self.serve(&request, now)
        };
        (answer, fate)
    }

    /// Sends bytes after the turnaround and `by`, after those already queued.
    pub fn send(&mut self, bytes: Vec<u8>, by: Span, now: Stamp<Host>) {
        let earliest = now + self.turnaround;
        let at = self.answers.last().map_or(earliest, |a| a.0.max(earliest));
        self.answers.push((at + by, bytes));
    }

    /// Sends a frame without a request.
    pub fn send_at(&mut self, bytes: Vec<u8>, at: Stamp<Host>) {
        self.answers.push((at, bytes));
        self.answers.sort_by_key(|a| a.0);
    }

    pub fn next_answer(&self) -> Option<Stamp<Host>> {
        let answer = self.answers.first().map(|a| a.0);
        [answer, self.next_of_bus()].into_iter().flatten().min()
    }

    pub fn take_answer(&mut self, now: Stamp<Host>) -> Option<Vec<u8>> {
        self.live(now);
        let due = self.answers.first().is_some_and(|(at, _)| *at <= now);
        due.then(|| (self.distort)(now, self.answers.remove(0).1))
    }

    /// Drops everything in flight.
    pub fn unplug(&mut self) {
        self.answers.clear();
    }

    /// Restarts the drive: settings, reference and NMT state are lost.
    pub fn restart(&mut self, now: Stamp<Host>) {
        let link = self.wire.link();
        let fresh = Self::on(link);
        self.place = 0.0;
        self.motion = None;
        self.homing_until = None;
        self.objects = fresh.objects;
        self.state = fresh.state;
        self.flags = fresh.flags;
        self.controlword = 0;
        self.wire = Wire::new(link);
        self.unplug();
        self.start_bus(now);
    }

    /// Position of the shaft.
    pub fn position(&self, now: Stamp<Host>) -> f64 {
        let Some(m) = self.motion else {
            return self.place;
        };
        let (seconds, distance) = ((now - m.began).as_secs_f64(), (m.to - m.from).abs());
        // The speed is limited by what was gained since the start and must be lost before the end.
        let ramp = (m.speed / m.acceleration).min((distance / m.acceleration).sqrt());
        let peak = ramp * m.acceleration;
        let gained = |t: f64| match t.max(0.0) {
            t if t < ramp => peak * t * t / (2.0 * ramp),
            t => peak * (t - ramp / 2.0),
        };
        let left = if peak > 0.0 {
            distance / peak + ramp - seconds
        } else {
            f64::INFINITY
        };
        let way = if left < ramp {
            distance - gained(left.max(0.0))
        } else {
            gained(seconds)
        };
        m.from + (m.to - m.from).signum() * way.clamp(0.0, distance)
    }

    fn serve(&mut self, request: &SerialRequest, now: Stamp<Host>) -> SerialFrame {
        match request {
            SerialRequest::ReadObject(read) => ReadObject::answer(self.get(read.address, now)),
            SerialRequest::WriteObject(write) => {
                WriteObject::answer(self.put(write.address, write.value, now))
            }
            SerialRequest::InitiateSegmentedRead(InitiateSegmentedRead { address, .. }) => {
                let known = (address.index, address.sub) == (0x1008, 0);
                self.name_at = 0;
                SerialAnswer::bare(if known {
                    CommError::NONE
                } else {
                    CommError::NO_OBJECT
                })
                .to_frame()
            }
            SerialRequest::SegmentedRead(SegmentedRead { toggle }) => {
                let segment = self.segment(*toggle, 3);
                SegmentedRead::answer(&Ok(segment))
            }
            SerialRequest::InitiateSegmentedWrite(open) => {
                SerialAnswer::bare(self.open_write(open)).to_frame()
            }
            SerialRequest::SegmentedWrite(SegmentedWrite(segment)) => {
                SegmentedWrite::answer(self.write_segment(segment))
            }
            _ => SerialAnswer::bare(CommError::COMMAND).to_frame(),
        }
    }

    /// Starts writing the name, of up to 20 bytes.
    fn open_write(&mut self, open: &InitiateSegmentedWrite) -> CommError {
        self.writing = None;
        let len = open.len as usize;
        match open.address.index {
            0x1008 if len > 20 => CommError::TOO_LONG,
            0x1008 => {
                self.writing = Some((Vec::new(), len));
                CommError::NONE
            }
            _ => CommError::NO_OBJECT,
        }
    }

    fn write_segment(&mut self, segment: &WriteSegment) -> Result<bool, CommError> {
        let (mut bytes, len) = self.writing.take().ok_or(CommError::COMMAND)?;
        let longest = if self.wire.link() == DriveLink::Can {
            7
        } else {
            63
        };
        // Earlier segments are complete, which determines the toggle bit.
        if segment.toggle != ((bytes.len() / longest) % 2 == 1) {
            return Err(CommError::TOGGLE);
        }
        bytes.extend_from_slice(&segment.bytes);
        if bytes.len() < len {
            self.writing = Some((bytes, len));
        } else if self.refuses.contains(&(0x1008, 0)) {
            return Err(CommError::STATE);
        } else {
            self.name = bytes;
        }
        Ok(segment.toggle != self.wrong_toggle)
    }

    /// The next bytes of the name.
    pub fn segment(&mut self, toggle: bool, max: usize) -> ReadSegment {
        let rest = &self.name[self.name_at..];
        let mut bytes = Bounded::new();
        bytes.extend(rest.iter().copied().take(max));
        self.name_at += bytes.len();
        ReadSegment {
            toggle: toggle != self.wrong_toggle,
            more: self.name_at < self.name.len(),
            bytes,
        }
    }

    pub fn get(&mut self, address: Address, now: Stamp<Host>) -> Result<u32, CommError> {
        self.junk = self
            .junk
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        let junk = self.junk;
        let entry = (address.index, address.sub);
        Ok(match entry {
            (0x6041, 0) => junk << 16 | u32::from(self.statusword(now)),
            (0x6061, 0) => junk << 8 | self.objects[&(0x6060, 0)] & 0xFF,
            (0x6064, 0) => self.position(now).floor() as i32 as u32,
            (0x1013, 0) => device_us(now),
            _ => {
                let absent = if address.sub == 0xFF {
                    CommError::NO_SUB
                } else {
                    CommError::NO_OBJECT
                };
                let value = *self.objects.get(&entry).ok_or(absent)?;
                match width(address) {
                    1 => junk << 8 | value & 0xFF,
                    2 => junk << 16 | value & 0xFFFF,
                    _ => value,
                }
            }
        })
    }

    fn put(&mut self, address: Address, value: u32, now: Stamp<Host>) -> Result<(), CommError> {
        let entry = (address.index, address.sub);
        if entry == (0x6040, 0) {
            self.control(value as u16, now);
            return Ok(());
        }
        if self.refuses.contains(&entry) {
            return Err(CommError::PDO_MAPPING);
        }
        let stubborn = self.stubborn.contains(&entry);
        let old = self.objects.get_mut(&entry).ok_or(CommError::NO_OBJECT)?;
        if !stubborn {
            *old = value;
        }
        Ok(())
    }

    fn statusword(&self, now: Stamp<Host>) -> u16 {
        let target = f64::from(self.objects[&(0x607A, 0)] as i32);
        let there = self.homing_until.is_none() && self.position(now) == target && !self.blocked;
        let flags = match self.wire.link() {
            DriveLink::Can if self.bus.state != NmtState::Operational => self.flags & !REMOTE,
            _ => self.flags,
        };
        self.state | flags | if there { REACHED } else { 0 }
    }

    pub fn live(&mut self, now: Stamp<Host>) {
        self.live_on_bus(now);
        if let Some((at, code)) = self.fault_at
            && at <= now
        {
            self.fault_at = None;
            self.fault(code, now);
        }
        if self.homing_until.is_some_and(|until| until <= now) {
            self.homing_until = None;
            self.place = f64::from(self.objects[&(0x2081, 0)] as i32);
            // The target is the home position, too.
            self.objects.insert((0x607A, 0), self.objects[&(0x2081, 0)]);
            self.flags |= ACKNOWLEDGED | REFERENCED;
        }
    }

    pub fn fault(&mut self, code: u16, now: Stamp<Host>) {
        self.emergency(code, now);
        self.freeze(now);
        self.state = FAULT;
        self.objects.insert((0x1003, 0), 1);
        self.objects.insert((0x1003, 1), u32::from(code));
    }

    fn freeze(&mut self, now: Stamp<Host>) {
        self.place = self.position(now);
        self.motion = None;
        self.homing_until = None;
    }

    fn control(&mut self, word: u16, now: Stamp<Host>) {
        let rising = word & !self.controlword;
        self.controlword = word;
        if self.state == FAULT {
            if rising & 0x80 != 0 && !self.faults_that_stay {
                self.state = DISABLED;
            }
            return;
        }
        if word & 2 == 0 {
            if !self.deaf_to_power_off {
                self.freeze(now);
            }
            self.state = DISABLED;
        } else if word & 4 == 0 {
            if self.state == ENABLED && !self.deaf_to_quick_stop {
                self.freeze(now);
                self.state = QUICK_STOP;
            }
        } else if word & 0xF == 6 {
            self.freeze(now);
            self.state = READY;
        } else if word & 0xF == 0xF && matches!(self.state, READY | ENABLED) {
            self.state = ENABLED;
            self.setpoint(rising, word, now);
        }
    }

    fn setpoint(&mut self, rising: u16, word: u16, now: Stamp<Host>) {
        if word & 0x10 == 0 {
            self.flags &= !ACKNOWLEDGED;
        }
        if rising & 0x10 == 0 {
            return;
        }
        if self.objects[&(0x6060, 0)] == 6 {
            self.homing_until = Some(now + self.homing_time);
            return;
        }
        self.flags |= ACKNOWLEDGED;
        let from = self.position(now);
        self.motion = Some(Motion {
            from,
            to: f64::from(self.objects[&(0x607A, 0)] as i32),
            began: now,
            speed: if self.blocked {
                0.0
            } else {
                f64::from(self.objects[&(0x6081, 0)]) * 2000.0 / 60.0
            },
            acceleration: f64::from(self.objects[&(0x6083, 0)].max(1)) * 2000.0 / 60.0,
        });
    }
}

/// The drive's clock, with an arbitrary zero and 40 ppm fast.
pub fn device_us(now: Stamp<Host>) -> u32 {
    let us = now.as_nanos() / 1_000;
    (us + us / 25_000) as u32
}

/// Width of an object in bytes.
pub fn width(address: Address) -> u8 {
    match (address.index, address.sub) {
        (0x1003 | 0x1A00, 0) | (0x1800, 2) | (0x6060 | 0x6061 | 0x608B | 0x6098, _) => 1,
        (0x1017 | 0x6040 | 0x6041, _) | (0x1800, 3) => 2,
        (0x2210, 2 | 4) | (0x6007 | 0x605E, _) => 2,
        (0x2003 | 0x2070 | 0x2071 | 0x2078 | 0x2079 | 0x2080 | 0x2100 | 0x6086, _) => 2,
        _ => 4,
    }
}
