//! Segmented read, opcodes 12 and 14: objects of any length, such as the device name.

use super::{Answer, parse_target, target, word_count};
use crate::epos2::{Bounded, CommError, Frame, FrameError, Layer, objects::Address};

/// Toggle bit of a control byte.
pub(super) const TOGGLE: u8 = 1 << 6;
/// Bit of a control byte: more segments follow.
const MORE: u8 = 1 << 7;
/// Length bits of a control byte.
pub(super) const LENGTH: u8 = 0x3F;
/// The most bytes in a segment.
pub(super) const MAX_BYTES: usize = LENGTH as usize;

/// Begins to read an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InitiateSegmentedRead {
    /// Node id; 0 and the unit's own are executed by the unit itself.
    pub node: u8,
    /// The object.
    pub address: Address,
}

impl InitiateSegmentedRead {
    /// Its opcode.
    pub const OPCODE: u8 = 0x12;

    /// The request as a frame. Its answer is an error code alone.
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
}

/// Asks for the next segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SegmentedRead {
    /// Alternates from segment to segment, beginning with `false`.
    pub toggle: bool,
}

/// A segment that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadSegment {
    /// As in the request.
    pub toggle: bool,
    /// More segments follow.
    pub more: bool,
    /// Its bytes, at most 63.
    pub bytes: Bounded<u8, MAX_BYTES>,
}

impl SegmentedRead {
    /// Its opcode.
    pub const OPCODE: u8 = 0x14;

    /// The request as a frame.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        Frame::of(
            Self::OPCODE,
            [if self.toggle { u16::from(TOGGLE) } else { 0 }],
        )
    }

    /// The request in `frame`.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`].
    pub fn parse(frame: &Frame) -> Result<Self, FrameError> {
        let [control] = frame.exactly(Self::OPCODE)?;
        Ok(Self {
            toggle: control & u16::from(TOGGLE) != 0,
        })
    }

    /// The answer to it.
    #[must_use]
    pub fn answer(outcome: &Result<ReadSegment, CommError>) -> Frame {
        let segment = match outcome {
            Ok(segment) => segment,
            Err(error) => return Answer::bare(*error).to_frame(),
        };
        let control = segment.bytes.len() as u8
            | if segment.toggle { TOGGLE } else { 0 }
            | if segment.more { MORE } else { 0 };
        let mut answer = Answer::bare(CommError::NONE);
        pack(control, &segment.bytes, &mut answer.data);
        answer.to_frame()
    }

    /// The segment in its answer.
    ///
    /// # Errors
    /// [`FrameError::Opcode`], [`FrameError::WordCount`] if `frame` is no such answer or holds fewer bytes than it says;
    /// inside, what the unit reports.
    pub fn parse_answer(frame: &Frame) -> Result<Result<ReadSegment, CommError>, FrameError> {
        let answer = Answer::parse(frame)?;
        if !answer.error.is_none() {
            return Ok(Err(answer.error));
        }
        let (control, bytes) = unpack(&answer.data, 2)?;
        Ok(Ok(ReadSegment {
            toggle: control & TOGGLE != 0,
            more: control & MORE != 0,
            bytes,
        }))
    }
}

/// Control byte and bytes as words, low byte first.
pub(super) fn pack(control: u8, bytes: &[u8], words: &mut impl Extend<u16>) {
    let (first, rest) = bytes.split_at_checked(1).unwrap_or((&[0], &[]));
    words.extend(
        first
            .iter()
            .map(|&byte| u16::from_le_bytes([control, byte])),
    );
    words.extend(rest.chunks(2).map(|pair| match pair {
        [low, high, ..] => u16::from_le_bytes([*low, *high]),
        [low] => u16::from(*low),
        [] => 0,
    }));
}

/// The control byte, and as many bytes behind it as it says; `before` words of the frame precede.
pub(super) fn unpack(
    words: &[u16],
    before: usize,
) -> Result<(u8, Bounded<u8, MAX_BYTES>), FrameError> {
    let mut all = words.iter().flat_map(|word| word.to_le_bytes());
    let control = all.next().ok_or_else(|| word_count(before + 1, before))?;
    let len = usize::from(control & LENGTH);
    let mut bytes = Bounded::new();
    bytes.extend(all.take(len));
    if bytes.len() < len {
        return Err(FrameError::WordCount {
            layer: Layer::Message,
            expected: before + 1 + len / 2,
            got: before + words.len(),
        });
    }
    Ok((control, bytes))
}
