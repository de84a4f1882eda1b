//! CANopen services other than SDO: heartbeats both ways, boot-up, EMCY, NMT, and the stream of
//! positions in a TPDO at each SYNC.
//!
//! A state machine without I/O. It reports events as an [`Alarm`]; the procedures react to them.

use std::collections::VecDeque;

use protocol::canopen::heartbeat::{Heartbeat, HeartbeatConsumer, HeartbeatEvent};
use protocol::canopen::nmt::{Nmt, NmtCommand, NmtState};
use protocol::canopen::pdo::{Configuration, MappedObject, Pdo, PdoLayout, TransmissionType};
use protocol::canopen::sdo::SdoRequest;
use protocol::canopen::sync::SyncMessage;
use protocol::canopen::{BusMessage, CanFrame, CommunicationObject, NodeId, PdoNumber};
use protocol::epos2::objects::{Address, POSITION_ACTUAL, TIMESTAMP};
use protocol::epos2::{AbortCode, DeviceError};
use units::{Host, Quadcounts, Span, Stamp};

use crate::config::CanHeartbeats;
use crate::event::{SampleTrigger, ShaftSample};
use crate::sync_matcher::SyncMatcher;

/// An event that ends a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alarm {
    /// An EMCY message.
    Emergency(DeviceError),
    /// A boot-up message.
    BootUp,
    /// No heartbeat for this span.
    HeartbeatLost(Span),
    /// The node left the state operational and sends no process data.
    NotOperational(NmtState),
}

/// The PDO that carries the stream.
pub(crate) const STREAM: Pdo = Pdo::Transmit(PdoNumber::One);
/// Shortest SYNC period: the drive's position loop runs at 1 kHz.
const MIN_SYNC_PERIOD: Span = Span::from_millis(1);

/// The CANopen services of one node.
#[derive(Debug)]
pub(crate) struct CanServices {
    pub node: NodeId,
    config: CanHeartbeats,
    out: VecDeque<CanFrame>,
    heartbeat: HeartbeatConsumer,
    operational: bool,
    /// Time at which the host's next heartbeat is due; `None` while it sends none.
    pub next_heartbeat: Option<Stamp<Host>>,
    /// Longest time between two heartbeats of the host since its monitoring began in this command,
    /// if the node does not tolerate it.
    pub host_silence: Option<Span>,
    syncs: SyncMatcher,
    next_sync: Option<Stamp<Host>>,
    /// The node is configured to send the stream.
    pub streaming: bool,
    /// The node has the object (1016) that monitors the host's heartbeat.
    pub monitors_host: bool,
    /// The node has the configured reaction to a missing heartbeat of the host (6007).
    pub obeys_abort_option: bool,
    /// The latest sample that has not been taken.
    pub latest: Option<ShaftSample>,
    /// The stream has stalled: a wait for it timed out.
    pub stalled: bool,
    pub alarm: Option<Alarm>,
    pub restarted: bool,
}

impl CanServices {
    pub fn new(node: NodeId, config: CanHeartbeats) -> Self {
        Self {
            node,
            config,
            out: VecDeque::new(),
            heartbeat: HeartbeatConsumer::new(node, config.node_limit),
            operational: false,
            next_heartbeat: None,
            host_silence: None,
            syncs: SyncMatcher::default(),
            next_sync: None,
            streaming: false,
            monitors_host: false,
            obeys_abort_option: false,
            latest: None,
            stalled: false,
            alarm: None,
            restarted: false,
        }
    }

    /// Starts a command. Events between commands are dropped, except for a restart of the node.
    pub fn begin(&mut self, now: Stamp<Host>) {
        self.syncs.observe(now);
        self.heartbeat = HeartbeatConsumer::new(self.node, self.config.node_limit);
        self.operational = false;
        self.latest = None;
        self.host_silence = None;
        self.alarm = self.restarted.then_some(Alarm::BootUp);
    }

    /// Ends a command. The host's heartbeat continues with the next one until it is stopped.
    pub fn end(&mut self) {
        self.next_sync = None;
    }

    /// Resets the state before the node is configured.
    pub fn reset(&mut self) {
        self.restarted = false;
        self.alarm = None;
        self.streaming = false;
        self.stalled = false;
        self.monitors_host = false;
        self.obeys_abort_option = false;
        self.next_heartbeat = None;
        self.syncs.restart();
    }

    pub fn send_nmt(&mut self, command: NmtCommand) {
        let node = Some(self.node);
        self.operational = false;
        self.out.push_back(Nmt { node, command }.to_frame());
    }

    /// Aborts an SDO transfer.
    pub fn abort_transfer(&mut self, address: Address, error: AbortCode) {
        let abort = SdoRequest::Abort { address, error };
        self.out.push_back(abort.to_frame(self.node));
    }

    /// Starts the host's heartbeat.
    pub fn start_heartbeat(&mut self, now: Stamp<Host>) {
        self.next_heartbeat.get_or_insert(now);
    }

    /// Starts SYNC messages if none are sent. Returns whether a sample of the stream can be
    /// expected.
    pub fn request_samples(&mut self, now: Stamp<Host>) -> bool {
        if self.next_sync.is_none() {
            self.next_sync = Some(self.syncs.earliest_sync(now).max(now));
            self.latest = None;
        }
        self.streaming && (!self.stalled || self.latest.is_some())
    }

    /// Processes a frame other than an SDO response; returns the sample it carries, if any.
    pub fn handle_frame(&mut self, frame: &CanFrame, now: Stamp<Host>) -> Option<ShaftSample> {
        match BusMessage::parse(frame).ok()? {
            BusMessage::Emergency(emergency)
                if emergency.node == self.node && !emergency.is_reset() =>
            {
                let error = DeviceError(emergency.code);
                self.alarm.get_or_insert(Alarm::Emergency(error));
            }
            BusMessage::Heartbeat(_) => self.handle_heartbeat(frame, now),
            BusMessage::TransmitPdo(PdoNumber::One, node, data) if node == self.node => {
                return self.handle_pdo(&data, now);
            }
            _ => {}
        }
        None
    }

    /// The next frame to send.
    pub fn transmit(&mut self, now: Stamp<Host>, sync_period: Span) -> Option<CanFrame> {
        if let Some(due) = self.next_sync.filter(|due| *due <= now) {
            return Some(self.send_sync(due, now, sync_period));
        }
        if let Some(due) = self.next_heartbeat.filter(|due| *due <= now) {
            let silence = now.saturating_since(due) + self.config.host_heartbeat;
            if silence > self.config.host_limit {
                self.host_silence = self.host_silence.max(Some(silence));
            }
            self.next_heartbeat = Some(now.saturating_add(self.config.host_heartbeat));
            let state = NmtState::Operational;
            let node = NodeId::new(self.config.host_node)?;
            return Some(Heartbeat { node, state }.to_frame());
        }
        self.out.pop_front()
    }

    pub fn deadline(&self) -> Option<Stamp<Host>> {
        [
            self.next_sync,
            self.next_heartbeat,
            self.heartbeat.poll_timeout(),
        ]
        .into_iter()
        .flatten()
        .min()
    }

    /// Reports a lost heartbeat. No frame is waiting to be read.
    pub fn expire(&mut self, now: Stamp<Host>) {
        if let Some(HeartbeatEvent::Lost { silence }) = self.heartbeat.handle_timeout(now) {
            self.alarm.get_or_insert(Alarm::HeartbeatLost(silence));
        }
    }

    /// Moves the deadline of the heartbeat: the host did not run for `delay`.
    pub fn postpone(&mut self, delay: Span) {
        self.heartbeat.postpone(delay);
    }

    fn handle_heartbeat(&mut self, frame: &CanFrame, now: Stamp<Host>) {
        match self.heartbeat.handle_frame(frame, now) {
            Some(HeartbeatEvent::BootUp) => {
                self.restarted = true;
                self.streaming = false;
                self.syncs.restart();
                self.alarm = Some(Alarm::BootUp);
            }
            // A state unknown to CiA 301 is a damaged byte: SLCAN lines have no checksum.
            Some(HeartbeatEvent::State {
                to: NmtState::Unknown(_),
                ..
            }) => {}
            Some(HeartbeatEvent::State { to, .. }) => {
                let was_operational = self.operational;
                self.operational = to == NmtState::Operational;
                if was_operational && !self.operational {
                    self.alarm.get_or_insert(Alarm::NotOperational(to));
                }
            }
            Some(HeartbeatEvent::Lost { .. }) | None => {}
        }
    }

    fn send_sync(&mut self, due: Stamp<Host>, now: Stamp<Host>, period: Span) -> CanFrame {
        self.syncs.handle_sync(now);
        let period = period.max(MIN_SYNC_PERIOD);
        // Keeps to the grid unless that would cause a burst.
        let on_grid = due.saturating_add(period);
        let next = if on_grid > now {
            on_grid
        } else {
            now.saturating_add(period)
        };
        self.next_sync = Some(next.max(self.syncs.earliest_sync(now)));
        SyncMessage::default().to_frame()
    }

    fn handle_pdo(&mut self, data: &[u8], now: Stamp<Host>) -> Option<ShaftSample> {
        if !self.streaming {
            return None;
        }
        let layout = layout();
        let position = layout.get(POSITION_ACTUAL, data).ok()??;
        let drive_us = layout.get(TIMESTAMP, data).ok()??;
        let was_started = self.syncs.is_started();
        let request = self.syncs.handle_pdo(drive_us, now)?;
        if !was_started && self.next_sync.is_some() {
            // The single first SYNC is matched: the next may follow in sequence.
            self.next_sync = Some(now);
        }
        let sample = ShaftSample {
            request,
            answer: now,
            position: Quadcounts(position),
            trigger: SampleTrigger::Sync,
            drive_us: Some(drive_us),
        };
        self.stalled = false;
        self.latest = Some(sample);
        Some(sample)
    }
}

/// Content of the stream: the position and the drive's time.
pub(crate) fn layout() -> PdoLayout {
    // Cannot fail: two objects of four bytes fit a frame.
    PdoLayout::new(&[
        MappedObject::of(POSITION_ACTUAL),
        MappedObject::of(TIMESTAMP),
    ])
    .unwrap_or_default()
}

/// Configuration of the stream's PDO.
pub(crate) fn stream_configuration() -> Configuration {
    Configuration {
        transmission: TransmissionType::EACH_SYNC,
        inhibit_100us: Some(0),
        layout: layout(),
    }
}

/// Whether `channel` is that of the stream.
pub(crate) fn is_stream(channel: CommunicationObject, node: NodeId) -> bool {
    channel == STREAM.channel(node)
}
