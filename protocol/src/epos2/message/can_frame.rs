//! Send and request CAN frame, opcodes 20 and 21: raw CAN through the unit as gateway.

use super::{Answer, word_count};
use crate::epos2::{CommError, Frame, FrameError};

/// Puts a data frame on the bus. Over RS232 it has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SendCanFrame {
    /// 11-bit identifier.
    pub cob_id: u16,
    /// Bytes that count, 0 to 8.
    pub len: u16,
    /// The data.
    pub data: [u8; 8],
}

impl SendCanFrame {
    /// Its opcode.
    pub const OPCODE: u8 = 0x20;

    /// The request as a frame.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        let [a, b, c, d] = to_words(self.data);
        Frame::of(Self::OPCODE, [self.cob_id, self.len, a, b, c, d])
    }

    /// The request in `frame`.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`].
    pub fn parse(frame: &Frame) -> Result<Self, FrameError> {
        let [cob_id, len, a, b, c, d] = frame.exactly(Self::OPCODE)?;
        Ok(Self {
            cob_id,
            len,
            data: from_words([a, b, c, d]),
        })
    }
}

/// Puts a remote frame on the bus and returns what the owner answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RequestCanFrame {
    /// 11-bit identifier.
    pub cob_id: u16,
    /// Bytes asked for, 0 to 8.
    pub len: u16,
}

impl RequestCanFrame {
    /// Its opcode.
    pub const OPCODE: u8 = 0x21;

    /// The request as a frame.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        Frame::of(Self::OPCODE, [self.cob_id, self.len])
    }

    /// The request in `frame`.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`].
    pub fn parse(frame: &Frame) -> Result<Self, FrameError> {
        let [cob_id, len] = frame.exactly(Self::OPCODE)?;
        Ok(Self { cob_id, len })
    }

    /// The answer to it.
    #[must_use]
    pub fn answer(outcome: Result<[u8; 8], CommError>) -> Frame {
        let mut answer = Answer::bare(outcome.err().unwrap_or(CommError::NONE));
        answer.data.extend(outcome.into_iter().flat_map(to_words));
        answer.to_frame()
    }

    /// The data in its answer.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`] if `frame` is no such answer; inside, what the unit reports.
    pub fn parse_answer(frame: &Frame) -> Result<Result<[u8; 8], CommError>, FrameError> {
        let answer = Answer::parse(frame)?;
        if !answer.error.is_none() {
            return Ok(Err(answer.error));
        }
        match answer.data.as_slice() {
            [a, b, c, d, ..] => Ok(Ok(from_words([*a, *b, *c, *d]))),
            short => Err(word_count(6, 2 + short.len())),
        }
    }
}

fn to_words(data: [u8; 8]) -> [u16; 4] {
    let [a, b, c, d, e, f, g, h] = data;
    [[a, b], [c, d], [e, f], [g, h]].map(u16::from_le_bytes)
}

fn from_words(words: [u16; 4]) -> [u8; 8] {
    let [[a, b], [c, d], [e, f], [g, h]] = words.map(u16::to_le_bytes);
    [a, b, c, d, e, f, g, h]
}
