//! Network management as the node sees it: its NMT state, and when it starts anew.

use protocol::canopen::nmt::NmtCommand;
use protocol::canopen::nmt::NmtState;

use super::node::Node;

/// Where in its life on the network a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NetworkState {
    state: NmtState,
    /// How often the communication has started, power-on included.
    starts: u32,
}

impl NetworkState {
    /// Just switched on: nobody has started the node.
    pub const fn at_power_on() -> Self {
        Self {
            state: NmtState::PreOperational,
            starts: 1,
        }
    }

    /// Started once more.
    pub const fn restarted(self) -> Self {
        Self {
            state: NmtState::PreOperational,
            starts: self.starts.wrapping_add(1),
        }
    }

    pub const fn starts(&self) -> u32 {
        self.starts
    }
}

impl Node {
    /// NMT state: pre-operational after a start.
    #[must_use]
    pub const fn nmt_state(&self) -> NmtState {
        self.network.state
    }

    /// Network management: the state shows in bit 9 of the statusword; a reset of the node is a power cycle, one of the communication
    /// brings the saved objects 1000 to 1FFF back.
    pub fn nmt(&mut self, command: NmtCommand) {
        match command {
            NmtCommand::Start => self.network.state = NmtState::Operational,
            NmtCommand::Stop => self.network.state = NmtState::Stopped,
            NmtCommand::EnterPreOperational => self.network.state = NmtState::PreOperational,
            NmtCommand::ResetNode => self.power_cycle(),
            NmtCommand::ResetCommunication => {
                self.dictionary.copy_range(&self.saved, 0x1000, 0x1FFF);
                self.network = self.network.restarted();
            }
            NmtCommand::Unknown(_) => {}
        }
    }

    /// A master that was listened for has gone: no process data any more (CiA 301, "Error behaviour", without object 1029).
    pub(super) fn leave_operational(&mut self) {
        if self.network.state == NmtState::Operational {
            self.network.state = NmtState::PreOperational;
        }
    }
}
