//! The CAN interface of the drive: a CANopen slave without I/O (CiA 301; Communication Guide,
//! "CANopen Communication").
//!
//! [`CanServer`] joins the services, one file each: NMT and error control, SDO, transmit and
//! receive PDOs, LSS. Not simulated: bit timing and arbitration, SDO block transfer. A lost master
//! is error 8130 with the reaction of 6007.

mod guard;
mod lss;
mod receive;
mod sdo;
mod transmit;

use protocol::canopen::emcy::Emergency;
use protocol::canopen::heartbeat::Heartbeat;
use protocol::canopen::nmt::{Nmt, NmtState};
use protocol::canopen::sdo::SdoRequest;
use protocol::canopen::sync::SyncMessage;
use protocol::canopen::{CanFrame, CobId, CommunicationObject, NodeId, PdoNumber};
use protocol::epos2::objects::Address;

use self::guard::{HeartbeatMonitor, HeartbeatTimer, NodeGuarding};
use self::lss::LayerSetting;
use self::receive::ReceivePdo;
use self::sdo::SdoServer;
use self::transmit::TransmitPdo;
use super::node::SimulatedDrive;

/// Identifier of emergency messages; bit 31 disables them.
const EMCY_ID: Address = Address::new(0x1014, 0);

/// The CAN side of a drive.
#[derive(Clone, Debug, Default)]
pub struct CanServer {
    /// The start of the node that was last announced on the bus.
    started: Option<u32>,
    /// The NMT state at the last call.
    state: Option<NmtState>,
    heartbeat: HeartbeatTimer,
    guarding: NodeGuarding,
    monitors: [HeartbeatMonitor; 2],
    lss: LayerSetting,
    sdo: SdoServer,
    transmit: [TransmitPdo; 4],
    receive: [ReceivePdo; 4],
}

impl CanServer {
    /// An interface that has just been powered: its first frame is the boot-up message.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Sends what is due at the present instant of the node: boot-up, emergency messages,
    /// heartbeat, changed process data, the abort of a transfer whose client is silent. Call it
    /// after each [`SimulatedDrive::tick`].
    pub fn poll(&mut self, node: &mut SimulatedDrive, out: &mut impl FnMut(&CanFrame)) {
        let Some(id) = self.follow_restart(node, out) else {
            return;
        };
        let now_us = node.time_us();
        for (sub, monitor) in (1..).zip(&mut self.monitors) {
            monitor.watch(node, sub, now_us);
        }
        self.guarding.watch(node, now_us);
        // A lost master may have changed it.
        self.follow_state(node);
        if node.nmt_state() != NmtState::Stopped {
            send_emergencies(node, id, out);
        }
        if self.heartbeat.is_due(node, now_us) {
            out(&heartbeat(id, node.nmt_state()));
        }
        if let Some(abort) = self.sdo.expire(now_us) {
            out(&abort.to_frame(id));
        }
        if node.nmt_state() == NmtState::Operational {
            for (number, pdo) in PdoNumber::ALL.into_iter().zip(&mut self.transmit) {
                pdo.on_event(node, number, now_us, out);
            }
        }
    }

    /// Takes any frame of the bus at the present instant of the node; the frames of the drive go to
    /// `out`.
    pub fn input(
        &mut self,
        node: &mut SimulatedDrive,
        frame: &CanFrame,
        out: &mut impl FnMut(&CanFrame),
    ) {
        let Some(id) = self.follow_restart(node, out) else {
            return;
        };
        let Some(cob_id) = frame.cob_id() else {
            return;
        };
        if frame.is_remote() {
            self.on_remote_frame(node, id, cob_id, out);
        } else {
            self.on_data_frame(node, id, frame, out);
        }
        // Effects of the frame appear at once: boot-up, emergency, process data.
        self.poll(node, out);
    }

    /// Resets the interface after a start of the node. `None` for a node without an id.
    fn follow_restart(
        &mut self,
        node: &SimulatedDrive,
        out: &mut impl FnMut(&CanFrame),
    ) -> Option<NodeId> {
        let id = NodeId::new(node.node_id())?;
        let starts = node.network.starts;
        if self.started != Some(starts) {
            *self = Self {
                started: Some(starts),
                heartbeat: HeartbeatTimer::from_now(node),
                ..Self::default()
            };
            out(&heartbeat(id, NmtState::BootUp));
        }
        self.follow_state(node);
        Some(id)
    }

    /// Resets process data when the NMT state changes.
    fn follow_state(&mut self, node: &SimulatedDrive) {
        let state = node.nmt_state();
        if self.state.replace(state) != Some(state) {
            self.transmit = Default::default();
            self.receive = Default::default();
        }
    }

    /// A remote frame.
    fn on_remote_frame(
        &mut self,
        node: &SimulatedDrive,
        id: NodeId,
        cob_id: CobId,
        out: &mut impl FnMut(&CanFrame),
    ) {
        if cob_id == CommunicationObject::Heartbeat(id).cob_id() {
            if let Some(answer) = self.guarding.answer(node, id) {
                out(&answer);
            }
        } else if node.nmt_state() == NmtState::Operational {
            for (number, pdo) in PdoNumber::ALL.into_iter().zip(&mut self.transmit) {
                pdo.on_request(node, number, cob_id, out);
            }
        }
    }

    /// A data frame; malformed messages are ignored.
    fn on_data_frame(
        &mut self,
        node: &mut SimulatedDrive,
        id: NodeId,
        frame: &CanFrame,
        out: &mut impl FnMut(&CanFrame),
    ) {
        let now_us = node.time_us();
        match frame.cob_id().map(CommunicationObject::of) {
            Some(CommunicationObject::Nmt) => {
                if let Ok(command) = Nmt::parse(frame)
                    && command.is_for(id)
                {
                    node.nmt(command.command);
                }
            }
            Some(CommunicationObject::Sync) if SyncMessage::parse(frame).is_ok() => {
                self.sync(node, out)
            }
            Some(CommunicationObject::Heartbeat(other)) => {
                for (sub, monitor) in (1..).zip(&mut self.monitors) {
                    monitor.on_heartbeat(node, sub, other, now_us);
                }
            }
            Some(CommunicationObject::SdoRequest(to)) if to == id => {
                if node.nmt_state() != NmtState::Stopped
                    && let Ok((_, request)) = SdoRequest::parse(frame)
                    && let Some(answer) = self.sdo.execute(node, &request, now_us)
                {
                    out(&answer.to_frame(id));
                }
            }
            _ if node.nmt_state() == NmtState::Operational => {
                for (number, pdo) in PdoNumber::ALL.into_iter().zip(&mut self.receive) {
                    pdo.on_frame(node, number, frame);
                }
            }
            _ => {
                if let Some(answer) = self.lss.execute(node, frame) {
                    out(&answer);
                }
            }
        }
    }

    /// SYNC: transmit PDOs are sampled and sent first, then pending receive PDOs take effect.
    fn sync(&mut self, node: &mut SimulatedDrive, out: &mut impl FnMut(&CanFrame)) {
        if node.nmt_state() != NmtState::Operational {
            return;
        }
        for (number, pdo) in PdoNumber::ALL.into_iter().zip(&mut self.transmit) {
            pdo.on_sync(node, number, out);
        }
        for (number, pdo) in PdoNumber::ALL.into_iter().zip(&mut self.receive) {
            pdo.on_sync(node, number);
        }
    }
}

fn heartbeat(node: NodeId, state: NmtState) -> CanFrame {
    Heartbeat { node, state }.to_frame()
}

/// Sends the emergency messages that are pending.
fn send_emergencies(node: &mut SimulatedDrive, id: NodeId, out: &mut impl FnMut(&CanFrame)) {
    const OUT_OF_USE: u32 = 1 << 31;
    let cob_id = node.dictionary.raw(EMCY_ID);
    while let Some(pending) = node.errors.next_pending() {
        let frame = Emergency::new(id, pending.error.0, pending.register).to_frame();
        let moved = u16::try_from(cob_id & 0x7FF).ok().and_then(CobId::new);
        if cob_id & OUT_OF_USE == 0
            && let Some(moved) = moved
            && let Ok(frame) = CanFrame::new(moved, frame.data())
        {
            out(&frame);
        }
    }
}

/// Index of the parameters of a PDO.
const fn parameters(first: u16, number: PdoNumber) -> u16 {
    first + number.offset()
}

#[cfg(test)]
mod tests;
