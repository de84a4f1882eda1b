//! Error control: the heartbeat of the node (1017), the heartbeats it monitors (1016), node
//! guarding and life guarding (100C, 100D).

use protocol::canopen::heartbeat::ConsumerEntry;
use protocol::canopen::{CanFrame, CommunicationObject, NodeId};
use protocol::epos2::DeviceError;
use protocol::epos2::objects::{self, Address, TypedObject};

use crate::epos2::node::SimulatedDrive;

/// The node's heartbeat.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HeartbeatTimer {
    period_ms: u16,
    last_us: u64,
}

impl HeartbeatTimer {
    /// The first heartbeat follows one period after the boot-up message.
    pub fn from_now(node: &SimulatedDrive) -> Self {
        Self {
            period_ms: node.dictionary.get(objects::PRODUCER_HEARTBEAT),
            last_us: node.time_us(),
        }
    }

    /// Whether a heartbeat is due: one period after the last, and at once when the period changes
    /// (CiA 301).
    pub fn is_due(&mut self, node: &SimulatedDrive, now_us: u64) -> bool {
        let period_ms = node.dictionary.get(objects::PRODUCER_HEARTBEAT);
        let changed = core::mem::replace(&mut self.period_ms, period_ms) != period_ms;
        let next_us = self.last_us + 1000 * u64::from(period_ms);
        if period_ms == 0 || !changed && now_us < next_us {
            return false;
        }
        // Counted from the due time, so that delays do not add up, unless whole periods were
        // missed.
        let restart = changed || now_us >= next_us + 1000 * u64::from(period_ms);
        self.last_us = if restart { now_us } else { next_us };
        true
    }
}

/// Guard time, ms.
const GUARD_TIME: TypedObject<u16> = TypedObject::new(0x100C, 0, "Guard Time");
/// The life time is the guard time times this factor.
const LIFE_TIME_FACTOR: TypedObject<u8> = TypedObject::new(0x100D, 0, "Lifetime Factor");

/// Node guarding by a master, and life guarding of that master. The heartbeat excludes both.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NodeGuarding {
    /// The toggle bit of the next answer.
    toggle: bool,
    /// Time of the last request; the first starts life guarding.
    last_us: Option<u64>,
}

impl NodeGuarding {
    /// The answer to a request; `None` while the heartbeat is on.
    pub fn answer(&mut self, node: &SimulatedDrive, id: NodeId) -> Option<CanFrame> {
        if node.dictionary.get(objects::PRODUCER_HEARTBEAT) != 0 {
            return None;
        }
        self.last_us = Some(node.time_us());
        let toggle = if self.toggle { 0x80 } else { 0 };
        self.toggle = !self.toggle;
        let state = node.nmt_state().to_u8();
        Some(CanFrame::of(
            CommunicationObject::Heartbeat(id).cob_id(),
            [state | toggle],
        ))
    }

    /// Raises error 8130 when requests have been missing for the life time (100C times 100D; 0:
    /// not monitored). The drive reacts by 6007.
    pub fn watch(&mut self, node: &mut SimulatedDrive, now_us: u64) {
        let life_ms = u64::from(node.dictionary.get(GUARD_TIME))
            * u64::from(node.dictionary.get(LIFE_TIME_FACTOR));
        if life_ms == 0 || node.dictionary.get(objects::PRODUCER_HEARTBEAT) != 0 {
            self.last_us = None;
        }
        if let Some(last_us) = self.last_us
            && now_us.saturating_sub(last_us) > 1000 * life_ms
        {
            self.last_us = None;
            lose_master(node);
        }
    }
}

/// Reacts to a monitored master that is silent.
fn lose_master(node: &mut SimulatedDrive) {
    node.lose_connection(DeviceError::CAN_LIFE_GUARD);
    node.leave_operational();
}

/// Monitor of one entry of 1016.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HeartbeatMonitor {
    entry: Option<ConsumerEntry>,
    /// Time of the last heartbeat; the first starts the monitoring.
    last_us: Option<u64>,
}

impl HeartbeatMonitor {
    pub fn on_heartbeat(&mut self, node: &SimulatedDrive, sub: u8, from: NodeId, now_us: u64) {
        self.reload(node, sub);
        if self.entry.is_some_and(|entry| entry.node == from) {
            self.last_us = Some(now_us);
        }
    }

    /// Raises error 8130 when the heartbeat has stopped. The drive reacts by 6007.
    pub fn watch(&mut self, node: &mut SimulatedDrive, sub: u8, now_us: u64) {
        self.reload(node, sub);
        let (Some(entry), Some(last_us)) = (self.entry, self.last_us) else {
            return;
        };
        if now_us.saturating_sub(last_us) > 1000 * u64::from(entry.time_ms) {
            self.last_us = None;
            lose_master(node);
        }
    }

    /// A changed entry restarts the monitoring.
    fn reload(&mut self, node: &SimulatedDrive, sub: u8) {
        let index = objects::CONSUMER_HEARTBEAT.address.index;
        let entry = ConsumerEntry::from_u32(node.dictionary.raw(Address::new(index, sub)));
        if entry != self.entry {
            *self = Self {
                entry,
                last_us: None,
            };
        }
    }
}
