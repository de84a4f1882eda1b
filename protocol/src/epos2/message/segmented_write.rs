//! Segmented write, opcodes 13 and 15: objects of any length.

use super::segmented_read::{MAX_BYTES, TOGGLE, pack, unpack};
use super::{Answer, dword, parse_target, target, word_count, words};
use crate::epos2::{Bounded, CommError, Frame, FrameError, Words, objects::Address};

/// Begins to write an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InitiateSegmentedWrite {
    /// Node id; 0 and the unit's own are executed by the unit itself.
    pub node: u8,
    /// The object.
    pub address: Address,
    /// Bytes to come.
    pub len: u32,
}

impl InitiateSegmentedWrite {
    /// Its opcode.
    pub const OPCODE: u8 = 0x13;

    /// The request as a frame. Its answer is an error code alone.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        let [index, node_sub] = target(self.node, self.address);
        let [low, high] = words(self.len);
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
            len: dword(low, high),
        })
    }
}

/// A segment to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WriteSegment {
    /// Alternates from segment to segment, beginning with `false`.
    pub toggle: bool,
    /// Its bytes, at most 63.
    pub bytes: Bounded<u8, MAX_BYTES>,
}

/// Writes the next segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SegmentedWrite(pub WriteSegment);

impl SegmentedWrite {
    /// Its opcode.
    pub const OPCODE: u8 = 0x15;

    /// The request as a frame.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        let control = self.0.bytes.len() as u8 | if self.0.toggle { TOGGLE } else { 0 };
        let mut words = Words::new();
        pack(control, &self.0.bytes, &mut words);
        Frame {
            opcode: Self::OPCODE,
            words,
        }
    }

    /// The request in `frame`.
    ///
    /// # Errors
    /// [`FrameError::Opcode`]; [`FrameError::WordCount`] where it holds fewer bytes than it says.
    pub fn parse(frame: &Frame) -> Result<Self, FrameError> {
        frame.expect_opcode(Self::OPCODE)?;
        let (control, bytes) = unpack(&frame.words, 0)?;
        Ok(Self(WriteSegment {
            toggle: control & TOGGLE != 0,
            bytes,
        }))
    }

    /// The answer to it: the toggle bit as received.
    #[must_use]
    pub fn answer(outcome: Result<bool, CommError>) -> Frame {
        let mut answer = Answer::bare(outcome.err().unwrap_or(CommError::NONE));
        answer.data.extend(
            outcome
                .into_iter()
                .map(|toggle| if toggle { u16::from(TOGGLE) } else { 0 }),
        );
        answer.to_frame()
    }

    /// The toggle bit in its answer.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`] if `frame` is no such answer; inside, what the unit reports.
    pub fn parse_answer(frame: &Frame) -> Result<Result<bool, CommError>, FrameError> {
        let answer = Answer::parse(frame)?;
        if !answer.error.is_none() {
            return Ok(Err(answer.error));
        }
        match answer.data.as_slice() {
            [control, ..] => Ok(Ok(control & u16::from(TOGGLE) != 0)),
            [] => Err(word_count(3, 2)),
        }
    }
}
