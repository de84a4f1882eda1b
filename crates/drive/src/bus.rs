//! What passes on a CAN bus beside SDO: the node's heartbeat, boot-up and emergencies, the host's own heartbeat, network
//! management, and the stream of positions at SYNC.
//!
//! A machine without I/O like the rest. It says what happened ([`Alarm`]); what follows from it is the procedures' business.

use std::collections::VecDeque;

use protocol::canopen::heartbeat::{Heartbeat, HeartbeatConsumer, HeartbeatEvent};
use protocol::canopen::nmt::{Nmt, NmtCommand, NmtState};
use protocol::canopen::pdo::{Configuration, Layout, Mapping, Pdo, TransmissionType};
use protocol::canopen::sdo::Request;
use protocol::canopen::sync::SyncMessage;
use protocol::canopen::{CanFrame, Channel, Message, NodeId, PdoNumber};
use protocol::epos2::objects::{Address, POSITION_ACTUAL, TIMESTAMP};
use protocol::epos2::{CommError, DeviceError};
use units::{Host, Quadcounts, Span, Stamp};

use crate::beat::Beats;
use crate::config::CanBus;
use crate::event::{ShaftSample, Taken};

/// Something that ends a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alarm {
    /// The node told of an error the moment it happened.
    Emergency(DeviceError),
    /// The node has just started.
    Restarted,
    /// No heartbeat for so long.
    Silent(Span),
    /// The node is no longer operational: it sends no process data.
    Left(NmtState),
}

/// The process data object that carries the stream.
pub(crate) const STREAM: Pdo = Pdo::Transmit(PdoNumber::One);
/// The position loop runs at 1 kHz: asking faster gives the same position twice.
const FASTEST: Span = Span::from_millis(1);
/// A host that was busy itself first looks at what came meanwhile.
const GRACE: Span = Span::from_millis(10);

/// The bus of one node.
#[derive(Debug)]
pub(crate) struct Bus {
    node: NodeId,
    config: CanBus,
    out: VecDeque<CanFrame>,
    life: HeartbeatConsumer,
    suspect: Option<Stamp<Host>>,
    operational: bool,
    /// The next of the host's own heartbeats.
    next_heartbeat: Option<Stamp<Host>>,
    beats: Beats,
    next_sync: Option<Stamp<Host>>,
    /// The node was told to send the stream.
    pub streaming: bool,
    /// The node has the object by which it watches the host.
    pub watches_host: bool,
    /// The latest position of the stream that nobody has taken.
    fresh: Option<ShaftSample>,
    /// The stream was waited for in vain, and nothing has come since.
    pub mute: bool,
    alarm: Option<Alarm>,
    restarted: bool,
}

impl Bus {
    pub fn new(node: NodeId, config: CanBus) -> Self {
        Self {
            node,
            config,
            out: VecDeque::new(),
            life: consumer(node, &config),
            suspect: None,
            operational: false,
            next_heartbeat: None,
            beats: Beats::default(),
            next_sync: None,
            streaming: false,
            watches_host: false,
            fresh: None,
            mute: false,
            alarm: None,
            restarted: false,
        }
    }

    pub fn node(&self) -> NodeId {
        self.node
    }

    /// A command begins: what was not listened to meanwhile does not count, but that the node has restarted does.
    pub fn begin(&mut self, now: Stamp<Host>) {
        self.beats.watch(now);
        self.life = consumer(self.node, &self.config);
        self.suspect = None;
        self.operational = false;
        self.fresh = None;
        self.alarm = self.restarted.then_some(Alarm::Restarted);
    }

    /// A command has ended. The host's heartbeat goes on with the next one until it is no longer watched.
    pub fn end(&mut self) {
        self.next_sync = None;
    }

    /// The node is about to be configured: what it was before does not count.
    pub fn forget(&mut self) {
        self.restarted = false;
        self.alarm = None;
        self.streaming = false;
        self.mute = false;
        self.watches_host = false;
        self.next_heartbeat = None;
        self.beats.forget();
    }

    pub fn command(&mut self, command: NmtCommand) {
        let node = Some(self.node);
        self.operational = false;
        self.out.push_back(Nmt { node, command }.to_frame());
    }

    /// Breaks a transfer off.
    pub fn abort(&mut self, address: Address, error: CommError) {
        let abort = Request::Abort { address, error };
        self.out.push_back(abort.to_frame(self.node));
    }

    /// The host's own heartbeat, which the node may watch.
    pub fn live(&mut self, now: Stamp<Host>) {
        self.next_heartbeat.get_or_insert(now);
    }

    pub fn is_living(&self) -> bool {
        self.next_heartbeat.is_some()
    }

    pub fn cease(&mut self) {
        self.next_heartbeat = None;
    }

    /// Sees to it that the node is asked for its position every `period`.
    pub fn sample(&mut self, now: Stamp<Host>) {
        if self.next_sync.is_none() {
            self.next_sync = Some(self.beats.earliest(now).max(now));
            self.fresh = None;
        }
    }

    pub fn has_fresh(&self) -> bool {
        self.fresh.is_some()
    }

    pub fn take_fresh(&mut self) -> Option<ShaftSample> {
        self.fresh.take()
    }

    pub fn take_alarm(&mut self) -> Option<Alarm> {
        self.alarm.take()
    }

    pub fn has_restarted(&self) -> bool {
        self.restarted
    }

    pub fn has_alarm(&self) -> bool {
        self.alarm.is_some()
    }

    /// Takes a frame that is no SDO answer; a position of the stream, if it is one.
    pub fn handle(&mut self, frame: &CanFrame, now: Stamp<Host>) -> Option<ShaftSample> {
        match Message::parse(frame).ok()? {
            Message::Emergency(emergency)
                if emergency.node == self.node && !emergency.is_reset() =>
            {
                self.alarm
                    .get_or_insert(Alarm::Emergency(DeviceError(emergency.code)));
            }
            Message::Heartbeat(_) => self.heartbeat(frame, now),
            Message::TransmitPdo(PdoNumber::One, node, data) if node == self.node => {
                return self.position(&data, now);
            }
            _ => {}
        }
        None
    }

    /// The next frame to send, if one is due.
    pub fn transmit(&mut self, now: Stamp<Host>, period: Span) -> Option<CanFrame> {
        if self.next_sync.is_some_and(|at| at <= now) {
            return Some(self.beat(now, period));
        }
        if self.next_heartbeat.is_some_and(|at| at <= now) {
            self.next_heartbeat = Some(now.saturating_add(self.config.host_heartbeat));
            let state = NmtState::Operational;
            let node = NodeId::new(self.config.host_node)?;
            return Some(Heartbeat { node, state }.to_frame());
        }
        self.out.pop_front()
    }

    pub fn deadline(&self) -> Option<Stamp<Host>> {
        let lost = self.suspect.map(|at| at.saturating_add(GRACE));
        [
            self.next_sync,
            self.next_heartbeat,
            lost.or(self.life.poll_timeout()),
        ]
        .into_iter()
        .flatten()
        .min()
    }

    /// Lets time pass.
    pub fn expire(&mut self, now: Stamp<Host>) {
        let Some(due) = self.life.poll_timeout().filter(|due| *due <= now) else {
            return;
        };
        let suspect = *self.suspect.get_or_insert(now);
        if now < suspect.saturating_add(GRACE) {
            return;
        }
        self.suspect = None;
        if let Some(HeartbeatEvent::Lost { silence }) = self.life.handle_timeout(now.max(due)) {
            self.alarm.get_or_insert(Alarm::Silent(silence));
        }
    }

    fn heartbeat(&mut self, frame: &CanFrame, now: Stamp<Host>) {
        match self.life.handle_frame(frame, now) {
            Some(HeartbeatEvent::BootUp) => {
                self.restarted = true;
                self.streaming = false;
                self.beats.forget();
                self.alarm = Some(Alarm::Restarted);
            }
            // A byte that CiA 301 does not know says that it was damaged on the way: SLCAN lines have no checksum.
            Some(HeartbeatEvent::State {
                to: NmtState::Unknown(_),
                ..
            }) => {}
            Some(HeartbeatEvent::State { to, .. }) => {
                let was = self.operational;
                self.operational = to == NmtState::Operational;
                if was && !self.operational {
                    self.alarm.get_or_insert(Alarm::Left(to));
                }
            }
            Some(HeartbeatEvent::Lost { .. }) | None => {}
        }
        if self.life.poll_timeout().is_some_and(|due| due > now) {
            self.suspect = None;
        }
    }

    fn beat(&mut self, now: Stamp<Host>, period: Span) -> CanFrame {
        let due = self.next_sync.unwrap_or(now);
        self.beats.sent(now);
        // On the grid, unless that would be a burst.
        let next = due.saturating_add(period.max(FASTEST));
        let next = if next > now {
            next
        } else {
            now.saturating_add(period.max(FASTEST))
        };
        self.next_sync = Some(next.max(self.beats.earliest(now)));
        SyncMessage::default().to_frame()
    }

    fn position(&mut self, data: &[u8], now: Stamp<Host>) -> Option<ShaftSample> {
        if !self.streaming {
            return None;
        }
        let layout = layout();
        let position = layout.get(POSITION_ACTUAL, data).ok()??;
        let device_us = layout.get(TIMESTAMP, data).ok()??;
        let was_paired = self.beats.is_paired();
        let request = self.beats.answered(device_us, now)?;
        if !was_paired && self.next_sync.is_some() {
            // The lone beat has its answer: now they may follow one another.
            self.next_sync = Some(now);
        }
        let sample = ShaftSample {
            request,
            answer: now,
            position: Quadcounts(position),
            taken: Taken::AtSync,
            device_us: Some(device_us),
        };
        self.mute = false;
        self.fresh = Some(sample);
        Some(sample)
    }
}

fn consumer(node: NodeId, config: &CanBus) -> HeartbeatConsumer {
    HeartbeatConsumer::new(node, config.node_limit)
}

/// What the stream carries: the position and the drive's own time.
pub(crate) fn layout() -> Layout {
    // Two objects of four bytes fit a frame.
    Layout::new(&[Mapping::of(POSITION_ACTUAL), Mapping::of(TIMESTAMP)]).unwrap_or_default()
}

/// What the process data object is to become.
pub(crate) fn configuration() -> Configuration {
    Configuration {
        transmission: TransmissionType::EACH_SYNC,
        inhibit_100us: Some(0),
        layout: layout(),
    }
}

/// Whether a channel is the stream's.
pub(crate) fn is_stream(channel: Channel, node: NodeId) -> bool {
    channel == STREAM.channel(node)
}
