//! Network management (CiA 301, "NMT services"): commands to nodes and the states of nodes.
//!
//! Commands are not confirmed; the heartbeat shows their effect.

use core::fmt;

use super::cob_id::{CobId, NodeId};
use super::error::{CanopenLayer, MessageError};
use super::frame::CanFrame;
use super::message::{bytes, wrong_id};
use crate::codes::byte_codes;

byte_codes! {
    /// A command to nodes.
    pub enum NmtCommand {
        /// Go to operational.
        Start = 0x01,
        /// Go to stopped.
        Stop = 0x02,
        /// Go to pre-operational.
        EnterPreOperational = 0x80,
        /// Restart the node.
        ResetNode = 0x81,
        /// Restart the node's communication.
        ResetCommunication = 0x82,
    }
}

/// A command to a node or to all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nmt {
    /// `None` is all nodes.
    pub node: Option<NodeId>,
    /// The command.
    pub command: NmtCommand,
}

impl Nmt {
    /// The command as a frame.
    #[must_use]
    pub fn to_frame(&self) -> CanFrame {
        let node = self.node.map_or(0, NodeId::get);
        CanFrame::of(CobId::NMT, [self.command.to_u8(), node])
    }

    /// The command in `frame`.
    ///
    /// # Errors
    /// [`MessageError`]; a node above 127 is [`MessageError::Value`].
    pub fn parse(frame: &CanFrame) -> Result<Self, MessageError> {
        let layer = CanopenLayer::Nmt;
        if frame.cob_id() != Some(CobId::NMT) {
            return Err(wrong_id(layer, "000", frame));
        }
        let [specifier, node] = *bytes::<2>(layer, frame)?;
        if node > NodeId::MAX.get() {
            return Err(MessageError::Value {
                layer,
                offset: 1,
                expected: "0 to 127",
                got: node,
            });
        }
        Ok(Self {
            node: NodeId::new(node),
            command: NmtCommand::from_u8(specifier),
        })
    }

    /// Whether the command addresses `node`.
    #[must_use]
    pub fn is_for(&self, node: NodeId) -> bool {
        self.node.is_none_or(|meant| meant == node)
    }
}

byte_codes! {
    /// The state of a node as its heartbeat reports it.
    pub enum NmtState {
        /// Just started, about to become pre-operational.
        BootUp = 0x00,
        /// Only NMT and heartbeat.
        Stopped = 0x04,
        /// All services.
        Operational = 0x05,
        /// All services but PDOs.
        PreOperational = 0x7F,
    }
}

impl fmt::Display for NmtState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BootUp => f.write_str("boot-up"),
            Self::Stopped => f.write_str("stopped"),
            Self::Operational => f.write_str("operational"),
            Self::PreOperational => f.write_str("pre-operational"),
            Self::Unknown(state) => write!(f, "unknown state {state:02X}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn specifiers_and_states_round_trip() {
        for byte in 0..=255 {
            assert_eq!(NmtCommand::from_u8(byte).to_u8(), byte);
            assert_eq!(NmtState::from_u8(byte).to_u8(), byte);
        }
    }

    #[test]
    fn a_command_is_for_its_node_or_for_all() {
        let [one, two] = [1, 2].map(|id| NodeId::new(id).unwrap());
        let command = NmtCommand::Start;
        let to = |node| Nmt { node, command };
        assert!(to(None).is_for(one) && to(Some(one)).is_for(one));
        assert!(!to(Some(two)).is_for(one));
    }

    #[test]
    fn a_node_above_127_and_a_wrong_length_are_refused() {
        let frame = CanFrame::of(CobId::NMT, [1, 128]);
        assert_eq!(
            Nmt::parse(&frame),
            Err(MessageError::Value {
                layer: CanopenLayer::Nmt,
                offset: 1,
                expected: "0 to 127",
                got: 128
            })
        );
        assert_eq!(
            Nmt::parse(&CanFrame::of(CobId::NMT, [1])),
            Err(MessageError::Length {
                layer: CanopenLayer::Nmt,
                expected: 2,
                got: 1
            })
        );
    }
}
