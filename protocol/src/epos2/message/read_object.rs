//! ReadObject, opcode 10: an object of up to 32 bits.

use super::{Answer, parse_target, target, words};
use crate::epos2::{CommError, Frame, FrameError, objects::Address};

/// Asks for the value of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadObject {
    /// Node id; 0 and the unit's own are executed by the unit itself.
    pub node: u8,
    /// The object.
    pub address: Address,
}

impl ReadObject {
    /// Its opcode.
    pub const OPCODE: u8 = 0x10;

    /// The request as a frame.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        Frame::of(Self::OPCODE, target(self.node, self.address))
    }

    /// The request in `frame`.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`].
    pub fn parse(frame: &Frame) -> Result<Self, FrameError> {
        let [index, node_sub] = frame.exactly(Self::OPCODE)?;
        let (node, address) = parse_target(index, node_sub);
        Ok(Self { node, address })
    }

    /// The answer to it: the value in the low bytes, or an error in two words.
    #[must_use]
    pub fn answer(outcome: Result<u32, CommError>) -> Frame {
        let (error, value) = match outcome {
            Ok(value) => (CommError::NONE, Some(value)),
            Err(error) => (error, None),
        };
        let mut answer = Answer::bare(error);
        answer.data.extend(value.into_iter().flat_map(words));
        answer.to_frame()
    }

    /// The value in its answer; above the object's width it is garbage. An error comes in two words or in four.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`] if `frame` is no such answer; inside, what the unit reports.
    pub fn parse_answer(frame: &Frame) -> Result<Result<u32, CommError>, FrameError> {
        let answer = Answer::parse(frame)?;
        if answer.error.is_none() {
            answer.value().map(Ok)
        } else {
            Ok(Err(answer.error))
        }
    }
}
