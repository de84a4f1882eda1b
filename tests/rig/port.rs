//! A drive port with a [`Rig`] at its other end. Its time advances only while a caller waits.
//!
//! It carries bytes of a serial line, or 16 bytes per frame of a CAN bus.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use io::port::{Port, PortError};
use sim::{Attachment, Datagram, Rig};
use units::{Host, Span, Stamp};

use crate::link::{Link, LinkModel};

/// Attachment of the drive, and delays of the three links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Links {
    /// Attachment of the drive.
    pub attached: Attachment,
    /// Wire time of a byte to or from the drive.
    pub byte: Span,
    /// Requests to the drive.
    pub request: LinkModel,
    /// Answers of the drive.
    pub answer: LinkModel,
    /// Packets of the lidar.
    pub lidar: LinkModel,
    /// Seed of the delays.
    pub seed: u64,
}

impl Links {
    /// Usual delays of an attachment; the lidar's are Ethernet's.
    #[must_use]
    pub fn usual(attached: Attachment, seed: u64) -> Self {
        let (model, byte_ns) = match attached {
            // USB, or an adapter on USB.
            Attachment::Usb | Attachment::Slcan => (LinkModel::USB, 0),
            // An on-board UART at 115,200 baud: ten bits per byte.
            Attachment::Rs232 => (QUICK, 86_806),
            // An on-board controller at 1 Mbit/s: eight bits per byte, and the rest of the frame.
            Attachment::Can => (QUICK, 8_000),
        };
        Self {
            attached,
            byte: Span::from_nanos(byte_ns),
            request: model,
            answer: model,
            lidar: LinkModel::ETHERNET,
            seed,
        }
    }
}

/// Interrupt to program: 20 to 100 us, one in a hundred up to 2 ms more.
const QUICK: LinkModel = LinkModel {
    min: Span::from_micros(20),
    max: Span::from_micros(100),
    spike_probability: 0.01,
    spike: Span::from_millis(2),
};

/// A lidar packet with its kernel receive time.
#[derive(Clone, Debug)]
pub struct Arrived {
    /// Kernel receive time.
    pub host: Stamp<Host>,
    /// The packet.
    pub datagram: Datagram,
}

/// The devices and the time.
pub struct World {
    rig: Rig,
    now: Stamp<Host>,
    links: Links,
    request: Link,
    answer: Link,
    lidar: Link,
    /// Answers on their way, in order of arrival.
    incoming: VecDeque<(Stamp<Host>, Vec<u8>)>,
    packets: Vec<Arrived>,
    /// Time of Ctrl-C, and the flag that it sets.
    interrupt: Option<(Stamp<Host>, Arc<AtomicBool>)>,
}

/// The port; clones share one world.
#[derive(Clone)]
pub struct VirtualPort(Rc<RefCell<World>>);

impl VirtualPort {
    /// Makes a port to `rig` that starts at `start`.
    #[must_use]
    pub fn new(rig: Rig, start: Stamp<Host>, links: Links) -> Self {
        Self(Rc::new(RefCell::new(World {
            rig,
            now: start,
            links,
            request: Link::new(links.request, links.seed),
            answer: Link::new(links.answer, links.seed + 1),
            lidar: Link::new(links.lidar, links.seed + 2),
            incoming: VecDeque::new(),
            packets: Vec::new(),
            interrupt: None,
        })))
    }

    /// Sets `flag` at the time `at`.
    pub fn interrupt_at(&self, at: Stamp<Host>, flag: Arc<AtomicBool>) {
        self.0.borrow_mut().interrupt = Some((at, flag));
    }

    /// Changes the drive in a way that no client can.
    pub fn with_drive(&self, act: impl FnOnce(&mut firmware_sim::epos2::SimulatedDrive)) {
        act(self.0.borrow_mut().rig.drive_mut());
    }

    /// Lets time pass in which the program does not run.
    pub fn skip(&self, span: Span) {
        let mut world = self.0.borrow_mut();
        let until = world.now + span;
        world.advance(until);
        world.now = until;
    }

    /// Whether the axis moves.
    #[must_use]
    pub fn moves(&self) -> bool {
        crate::drive::moves(self.0.borrow_mut().rig.drive_mut())
    }

    /// Whether the power stage is on.
    #[must_use]
    pub fn is_powered(&self) -> bool {
        crate::drive::is_powered(self.0.borrow_mut().rig.drive_mut())
    }

    /// Ends the world. Returns its packets in order of arrival, and the truth.
    #[must_use]
    pub fn end(&self) -> (Vec<Arrived>, sim::Truth) {
        let mut world = self.0.borrow_mut();
        let packets = std::mem::take(&mut world.packets);
        (packets, world.rig.truth())
    }
}

impl World {
    /// Advances the devices to `at` and collects their output.
    fn advance(&mut self, at: Stamp<Host>) {
        if let Some((_, flag)) = self.interrupt.take_if(|(when, _)| *when <= at) {
            flag.store(true, Ordering::Relaxed);
        }
        self.rig.advance(at);
        while let Some(datagram) = self.rig.poll_datagram() {
            let host = self.lidar.deliver(datagram.at);
            self.packets.push(Arrived { host, datagram });
        }
        self.collect();
    }

    /// Puts the drive's output on its way to the host.
    fn collect(&mut self) {
        while let Some(sent) = self.rig.drive_output() {
            let at = self
                .answer
                .deliver(sent.at + self.links.wire_time(&sent.bytes));
            self.incoming.push_back((at, sent.bytes));
        }
    }

    /// Arrival time of the next bytes, if it is not after `until`. The devices advance at least to
    /// it.
    fn await_incoming(&mut self, until: Stamp<Host>) -> Option<Stamp<Host>> {
        let mut to = self.now;
        loop {
            let next = self.incoming.front().map(|(at, _)| *at);
            if let Some(at) = next.filter(|at| *at <= to) {
                return Some(at);
            }
            if to >= until {
                return None;
            }
            // Never far past the next arrival, because the client may answer it. Later output
            // arrives later.
            to = (to + STEP).min(until).min(next.unwrap_or(until));
            self.advance(to);
        }
    }
}

/// Time step of the check for unsolicited output of the drive.
const STEP: Span = Span::from_micros(100);

/// Wire time of a data frame with a standard identifier and no data, without stuff bits, at 1
/// Mbit/s.
const EMPTY_CAN_FRAME: Span = Span::from_micros(47);
/// Offset of the data length in `struct can_frame`.
const CAN_LENGTH_AT: usize = 4;

impl Links {
    fn wire_time(&self, bytes: &[u8]) -> Span {
        let times =
            |count: usize| Span::from_nanos(self.byte.as_nanos() * i64::try_from(count).unwrap());
        match self.attached {
            Attachment::Can => EMPTY_CAN_FRAME + times(bytes[CAN_LENGTH_AT].into()),
            _ => times(bytes.len()),
        }
    }
}

impl VirtualPort {
    /// Writes a frame that reaches the drive `late` after its usual time.
    pub fn write_late(&self, frame: &[u8], late: Span) -> Stamp<Host> {
        let mut world = self.0.borrow_mut();
        let sent = world.now;
        let wire = world.links.wire_time(frame);
        let received = world.request.deliver(sent + wire + late);
        world.advance(received);
        world.rig.drive_input(frame);
        world.collect();
        sent
    }
}

impl Port for VirtualPort {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        Ok(self.write_late(frame, Span::ZERO))
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        let mut world = self.0.borrow_mut();
        let until = world.now + timeout;
        let due = world.await_incoming(until);
        let Some((at, bytes)) = due.and_then(|_| world.incoming.pop_front()) else {
            world.now = until;
            return Ok(None);
        };
        world.now = world.now.max(at);
        let count = bytes.len().min(buffer.len());
        buffer[..count].copy_from_slice(&bytes[..count]);
        if count < bytes.len() {
            world.incoming.push_front((at, bytes[count..].to_vec()));
        }
        Ok(Some((count, world.now)))
    }

    fn now(&self) -> Stamp<Host> {
        self.0.borrow().now
    }
}
