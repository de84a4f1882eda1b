//! WriteObject, opcode 11: an object of up to 32 bits.

use super::{Answer, dword, parse_target, target, words};
use crate::epos2::{CommError, Frame, FrameError, objects::Address};

/// Sets the value of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WriteObject {
    /// Node id; 0 and the unit's own are executed by the unit itself.
    pub node: u8,
    /// The object.
    pub address: Address,
    /// The value in the low bytes.
    pub value: u32,
}

impl WriteObject {
    /// Its opcode.
    pub const OPCODE: u8 = 0x11;

    /// The request as a frame.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        let [index, node_sub] = target(self.node, self.address);
        let [low, high] = words(self.value);
        Frame::of(Self::OPCODE, [index, node_sub, low, high])
    }

    /// The request in `frame`.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`].
    pub fn parse(frame: &Frame) -> Result<Self, FrameError> {
        let [index, node_sub, low, high] = frame.exactly(Self::OPCODE)?;
        let (node, address) = parse_target(index, node_sub);
        Ok(Self {
            node,
            address,
            value: dword(low, high),
        })
    }

    /// The answer to it.
    #[must_use]
    pub fn answer(outcome: Result<(), CommError>) -> Frame {
        Answer::bare(outcome.err().unwrap_or(CommError::NONE)).to_frame()
    }

    /// Whether it was carried out.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`] if `frame` is no answer; inside, what the unit reports.
    pub fn parse_answer(frame: &Frame) -> Result<Result<(), CommError>, FrameError> {
        let answer = Answer::parse(frame)?;
        Ok(if answer.error.is_none() {
            Ok(())
        } else {
            Err(answer.error)
        })
    }
}
