//! A drive port whose other end is a [`Rig`] and whose time stands still until somebody waits.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use io::port::{Port, PortError};
use sim::link::{Link, LinkModel};
use sim::{Datagram, Rig};
use units::{Host, Span, Stamp};

/// Delays of the three links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Links {
    /// Requests to the drive.
    pub request: LinkModel,
    /// Answers of the drive.
    pub answer: LinkModel,
    /// Packets of the lidar.
    pub lidar: LinkModel,
    /// What their delays are drawn from.
    pub seed: u64,
}

/// A lidar packet with the time at which the host's kernel would have stamped it.
#[derive(Clone, Debug)]
pub struct Arrived {
    /// Kernel receive time.
    pub host: Stamp<Host>,
    /// The packet.
    pub datagram: Datagram,
}

/// The far end, and the time.
pub struct World {
    rig: Rig,
    now: Stamp<Host>,
    request: Link,
    answer: Link,
    lidar: Link,
    /// Answers on their way, in order of arrival.
    incoming: VecDeque<(Stamp<Host>, Vec<u8>)>,
    packets: Vec<Arrived>,
    /// When the user presses Ctrl-C, and the flag that it sets.
    interrupt: Option<(Stamp<Host>, Arc<AtomicBool>)>,
}

/// The port; clones share one world.
#[derive(Clone)]
pub struct VirtualPort(Rc<RefCell<World>>);

impl VirtualPort {
    /// A port to `rig`, which stands at `start`.
    #[must_use]
    pub fn new(rig: Rig, start: Stamp<Host>, links: Links) -> Self {
        Self(Rc::new(RefCell::new(World {
            rig,
            now: start,
            request: Link::new(links.request, links.seed),
            answer: Link::new(links.answer, links.seed + 1),
            lidar: Link::new(links.lidar, links.seed + 2),
            incoming: VecDeque::new(),
            packets: Vec::new(),
            interrupt: None,
        })))
    }

    /// The time.
    #[must_use]
    pub fn now(&self) -> Stamp<Host> {
        self.0.borrow().now
    }

    /// Sets `flag` when the time comes to `at`.
    pub fn interrupt_at(&self, at: Stamp<Host>, flag: Arc<AtomicBool>) {
        self.0.borrow_mut().interrupt = Some((at, flag));
    }

    /// Does something to the drive that no client can.
    pub fn with_drive(&self, act: impl FnOnce(&mut firmware_sim::epos2::Node)) {
        act(self.0.borrow_mut().rig.drive_mut());
    }

    /// The world's end: its packets in order of arrival and what truly happened.
    #[must_use]
    pub fn end(&self) -> (Vec<Arrived>, sim::Truth) {
        let mut world = self.0.borrow_mut();
        let packets = std::mem::take(&mut world.packets);
        (packets, world.rig.truth())
    }
}

impl World {
    /// Brings the devices to `at` and collects what they sent.
    fn advance(&mut self, at: Stamp<Host>) {
        if let Some((_, flag)) = self.interrupt.take_if(|(when, _)| *when <= at) {
            flag.store(true, Ordering::Relaxed);
        }
        self.rig.advance(at);
        while let Some(datagram) = self.rig.poll_datagram() {
            let host = self.lidar.deliver(datagram.at);
            self.packets.push(Arrived { host, datagram });
        }
    }
}

impl Port for VirtualPort {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        let mut world = self.0.borrow_mut();
        let sent = world.now;
        let received = world.request.deliver(sent);
        world.advance(received);
        world.rig.drive_input(frame);
        while let Some(bytes) = world.rig.drive_output() {
            let at = world.answer.deliver(received);
            world.incoming.push_back((at, bytes));
        }
        Ok(sent)
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        let mut world = self.0.borrow_mut();
        let until = world.now + timeout;
        let due = matches!(world.incoming.front(), Some((at, _)) if *at <= until);
        let Some((at, bytes)) = due.then(|| world.incoming.pop_front()).flatten() else {
            world.now = until;
            world.advance(until);
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
}
