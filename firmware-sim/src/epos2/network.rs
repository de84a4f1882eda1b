//! Network management of the node: its NMT state and its restarts.

use protocol::canopen::nmt::NmtCommand;
use protocol::canopen::nmt::NmtState;

use super::node::SimulatedDrive;

/// NMT state and restarts of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NetworkState {
    pub state: NmtState,
    /// Number of starts of the communication, power-on included.
    pub starts: u32,
}

impl NetworkState {
    /// The state after this number of starts.
    pub const fn started(starts: u32) -> Self {
        Self {
            state: NmtState::PreOperational,
            starts,
        }
    }
}

impl SimulatedDrive {
    /// NMT state: pre-operational after a start.
    #[must_use]
    pub const fn nmt_state(&self) -> NmtState {
        self.network.state
    }

    /// Executes a network management command: bit 9 of the statusword shows the state; a reset of
    /// the node is a power cycle, a reset of the communication restores the saved objects 1000 to
    /// 1FFF.
    pub fn nmt(&mut self, command: NmtCommand) {
        match command {
            NmtCommand::Start => self.network.state = NmtState::Operational,
            NmtCommand::Stop => self.network.state = NmtState::Stopped,
            NmtCommand::EnterPreOperational => self.network.state = NmtState::PreOperational,
            NmtCommand::ResetNode => self.power_cycle(),
            NmtCommand::ResetCommunication => {
                self.dictionary.copy_range(&self.saved, 0x1000, 0x1FFF);
                self.network = NetworkState::started(self.network.starts.wrapping_add(1));
            }
            NmtCommand::Unknown(_) => {}
        }
    }

    /// A monitored master is lost: process data stops (CiA 301, "Error behaviour", without object
    /// 1029).
    pub(super) fn leave_operational(&mut self) {
        if self.network.state == NmtState::Operational {
            self.network.state = NmtState::PreOperational;
        }
    }
}
