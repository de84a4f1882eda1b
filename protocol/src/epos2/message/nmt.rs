//! Send NMT service, opcode 0E: CANopen network management through the unit as gateway. Over RS232 it has no answer.

use crate::epos2::{Frame, FrameError};

/// What the nodes are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NmtCommand {
    /// To operational.
    Start,
    /// To stopped.
    Stop,
    /// To pre-operational.
    EnterPreOperational,
    /// Restart of the node.
    ResetNode,
    /// Restart of its communication.
    ResetCommunication,
    /// A command specifier that CiA 301 does not know.
    Unknown(u16),
}

impl NmtCommand {
    /// The command specifier.
    #[must_use]
    pub const fn to_u16(self) -> u16 {
        match self {
            Self::Start => 0x01,
            Self::Stop => 0x02,
            Self::EnterPreOperational => 0x80,
            Self::ResetNode => 0x81,
            Self::ResetCommunication => 0x82,
            Self::Unknown(specifier) => specifier,
        }
    }

    /// The command of a specifier.
    #[must_use]
    pub const fn from_u16(specifier: u16) -> Self {
        match specifier {
            0x01 => Self::Start,
            0x02 => Self::Stop,
            0x80 => Self::EnterPreOperational,
            0x81 => Self::ResetNode,
            0x82 => Self::ResetCommunication,
            specifier => Self::Unknown(specifier),
        }
    }
}

/// Tells a node, or all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nmt {
    /// Node id; 0 is all nodes.
    pub node: u16,
    /// What to do.
    pub command: NmtCommand,
}

impl Nmt {
    /// Its opcode.
    pub const OPCODE: u8 = 0x0E;

    /// The request as a frame.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        Frame::of(Self::OPCODE, [self.node, self.command.to_u16()])
    }

    /// The request in `frame`.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`].
    pub fn parse(frame: &Frame) -> Result<Self, FrameError> {
        let [node, specifier] = frame.exactly(Self::OPCODE)?;
        Ok(Self {
            node,
            command: NmtCommand::from_u16(specifier),
        })
    }
}
