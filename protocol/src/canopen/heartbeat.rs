//! Heartbeat and boot-up (CiA 301, "Error control services"): the message, a consumer without I/O
//! that detects its absence, and the consumer's object 1016. CiA 301 advises against the older node
//! guarding by remote frames.

use units::{Host, Span, Stamp};

use super::cob_id::{CommunicationObject, NodeId};
use super::error::{CanopenLayer, MessageError};
use super::frame::CanFrame;
use super::message::{bytes, wrong_id};
use super::nmt::NmtState;

/// A heartbeat. The first after a start has [`NmtState::BootUp`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heartbeat {
    /// The sending node.
    pub node: NodeId,
    /// Its state.
    pub state: NmtState,
}

impl Heartbeat {
    /// The heartbeat as a frame.
    #[must_use]
    pub fn to_frame(&self) -> CanFrame {
        CanFrame::of(
            CommunicationObject::Heartbeat(self.node).cob_id(),
            [self.state.to_u8()],
        )
    }

    /// The heartbeat in `frame`.
    ///
    /// # Errors
    /// [`MessageError`].
    pub fn parse(frame: &CanFrame) -> Result<Self, MessageError> {
        let layer = CanopenLayer::Heartbeat;
        let Some(CommunicationObject::Heartbeat(node)) =
            frame.cob_id().map(CommunicationObject::of)
        else {
            return Err(wrong_id(layer, "701 to 77F", frame));
        };
        let [state] = *bytes::<1>(layer, frame)?;
        Ok(Self {
            node,
            state: NmtState::from_u8(state),
        })
    }
}

/// The value of an entry of 1016: the expected heartbeat of a node, whose absence is error 8130.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConsumerEntry {
    /// The monitored node.
    pub node: NodeId,
    /// Longest interval in milliseconds; 0 disables the entry.
    pub time_ms: u16,
}

impl ConsumerEntry {
    /// The value: node in bits 16 to 23, time in bits 0 to 15.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        (self.node.get() as u32) << 16 | self.time_ms as u32
    }

    /// The entry of a value; `None` where it is disabled or names no node.
    #[must_use]
    pub const fn from_u32(value: u32) -> Option<Self> {
        let time_ms = value as u16;
        match NodeId::new((value >> 16) as u8) {
            Some(node) if time_ms != 0 => Some(Self { node, time_ms }),
            _ => None,
        }
    }
}

/// An event of a monitored heartbeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeartbeatEvent {
    /// The node has restarted and lost its state.
    BootUp,
    /// The state of the node has changed; `from` is `None` at the first heartbeat, and at the first
    /// after a loss.
    State {
        /// The state before.
        from: Option<NmtState>,
        /// The state now.
        to: NmtState,
    },
    /// No heartbeat for longer than the limit.
    Lost {
        /// Time since the last heartbeat.
        silence: Span,
    },
}

/// Monitor of a node's heartbeat.
///
/// As in CiA 301 monitoring begins with the first heartbeat; the presence of a node is checked
/// otherwise.
#[derive(Clone, Copy, Debug)]
pub struct HeartbeatConsumer {
    node: NodeId,
    limit: Span,
    state: Option<NmtState>,
    last: Option<Stamp<Host>>,
}

impl HeartbeatConsumer {
    /// Monitors `node`, which is lost after a silence of `limit` (more than its producer time,
    /// 1017).
    #[must_use]
    pub const fn new(node: NodeId, limit: Span) -> Self {
        Self {
            node,
            limit,
            state: None,
            last: None,
        }
    }

    /// The last state; `None` before the first heartbeat and while the node is lost.
    #[must_use]
    pub const fn state(&self) -> Option<NmtState> {
        self.state
    }

    /// Takes any frame of the bus; frames of other nodes have no effect.
    pub fn handle_frame(&mut self, frame: &CanFrame, now: Stamp<Host>) -> Option<HeartbeatEvent> {
        let heartbeat = Heartbeat::parse(frame).ok()?;
        if heartbeat.node != self.node {
            return None;
        }
        self.last = Some(now);
        let to = heartbeat.state;
        let from = self.state.replace(to);
        match to {
            NmtState::BootUp => Some(HeartbeatEvent::BootUp),
            _ if from == Some(to) => None,
            _ => Some(HeartbeatEvent::State { from, to }),
        }
    }

    /// Time at which the node is lost without a further heartbeat.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Stamp<Host>> {
        self.last.map(|last| last.saturating_add(self.limit))
    }

    /// Counts the silence from `delay` later: the consumer could not receive for that long.
    pub fn postpone(&mut self, delay: Span) {
        self.last = self.last.map(|last| last.saturating_add(delay));
    }

    /// Reports the loss of the node at `now`, once.
    pub fn handle_timeout(&mut self, now: Stamp<Host>) -> Option<HeartbeatEvent> {
        let last = self.last?;
        if now < last.saturating_add(self.limit) {
            return None;
        }
        self.last = None;
        self.state = None;
        Some(HeartbeatEvent::Lost {
            silence: now.saturating_since(last),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: i64) -> Stamp<Host> {
        Stamp::from_nanos(ms * 1_000_000)
    }

    fn node(id: u8) -> NodeId {
        NodeId::new(id).unwrap()
    }

    fn beat(id: u8, state: NmtState) -> CanFrame {
        Heartbeat {
            node: node(id),
            state,
        }
        .to_frame()
    }

    #[test]
    fn a_delay_of_the_consumer_is_no_silence() {
        let mut consumer = HeartbeatConsumer::new(node(1), Span::from_millis(100));
        consumer.postpone(Span::from_secs(1));
        assert_eq!(consumer.poll_timeout(), None, "monitoring has not begun");
        consumer.handle_frame(&beat(1, NmtState::Operational), at(0));
        consumer.postpone(Span::from_secs(1));
        assert_eq!(consumer.handle_timeout(at(1_099)), None);
        assert!(consumer.handle_timeout(at(1_100)).is_some());
    }

    #[test]
    fn node_state_changes_loss_and_return_are_reported() {
        use NmtState::{Operational, PreOperational};
        let mut consumer = HeartbeatConsumer::new(node(1), Span::from_millis(100));
        assert_eq!(consumer.poll_timeout(), None);
        assert_eq!(consumer.handle_timeout(at(1_000_000)), None);
        let mut receive = |state, ms| consumer.handle_frame(&beat(1, state), at(ms));
        assert_eq!(receive(NmtState::BootUp, 0), Some(HeartbeatEvent::BootUp));
        assert_eq!(
            receive(PreOperational, 10),
            Some(HeartbeatEvent::State {
                from: Some(NmtState::BootUp),
                to: PreOperational
            })
        );
        assert_eq!(receive(PreOperational, 60), None);
        assert!(matches!(
            receive(Operational, 110),
            Some(HeartbeatEvent::State { .. })
        ));
        // Heartbeats of other nodes do not count.
        assert_eq!(consumer.handle_frame(&beat(2, Operational), at(150)), None);
        assert_eq!(consumer.poll_timeout(), Some(at(210)));
        assert_eq!(consumer.handle_timeout(at(209)), None);
        assert_eq!(
            consumer.handle_timeout(at(210)),
            Some(HeartbeatEvent::Lost {
                silence: Span::from_millis(100)
            })
        );
        assert_eq!(
            (consumer.handle_timeout(at(300)), consumer.state()),
            (None, None)
        );
        assert_eq!(
            consumer.handle_frame(&beat(1, Operational), at(400)),
            Some(HeartbeatEvent::State {
                from: None,
                to: Operational
            })
        );
    }

    #[test]
    fn a_second_boot_up_without_a_heartbeat_is_a_restart() {
        let mut consumer = HeartbeatConsumer::new(node(1), Span::from_millis(100));
        for ms in [0, 5] {
            assert_eq!(
                consumer.handle_frame(&beat(1, NmtState::BootUp), at(ms)),
                Some(HeartbeatEvent::BootUp)
            );
        }
    }

    #[test]
    fn entries_of_1016_round_trip() {
        let entry = ConsumerEntry {
            node: node(127),
            time_ms: 500,
        };
        assert_eq!(entry.to_u32(), 0x007F_01F4);
        assert_eq!(ConsumerEntry::from_u32(0x007F_01F4), Some(entry));
        assert_eq!(ConsumerEntry::from_u32(0x007F_0000), None);
        assert_eq!(ConsumerEntry::from_u32(0x0000_01F4), None);
        assert_eq!(ConsumerEntry::from_u32(0), None);
    }
}
