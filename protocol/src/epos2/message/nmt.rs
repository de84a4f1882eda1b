//! Send NMT service, opcode 0E: CANopen network management through the unit as gateway. Over RS232
//! it has no answer.

use crate::epos2::{Frame, FrameError};

/// A network management command to one node or to all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nmt {
    /// Node id; 0 is all nodes.
    pub node: u16,
    /// Command specifier, see [`NmtCommand`](crate::canopen::nmt::NmtCommand).
    pub specifier: u16,
}

impl Nmt {
    /// Its opcode.
    pub const OPCODE: u8 = 0x0E;

    /// The request as a frame.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        Frame::of(Self::OPCODE, [self.node, self.specifier])
    }

    /// The request in `frame`.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`].
    pub fn parse(frame: &Frame) -> Result<Self, FrameError> {
        let [node, specifier] = frame.exactly(Self::OPCODE)?;
        Ok(Self { node, specifier })
    }
}
