//! Segmented read and write, opcodes 12 to 15: objects of any length, such as the device name.

use super::{SerialAnswer, command, dword, parse_target, target, target_and_number, word_count};
use crate::BoundedVec;
use crate::canopen::Address;
use crate::epos2::{AbortCode, SerialFrame, SerialFrameError, Words};

/// Toggle bit of a control byte.
const TOGGLE: u8 = 1 << 6;
/// Bit of a control byte: more segments follow.
const MORE: u8 = 1 << 7;
/// Length bits of a control byte.
const LENGTH: u8 = 0x3F;
/// The most bytes in a segment.
const MAX_BYTES: usize = LENGTH as usize;

/// Begins to read an object; the answer has no data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InitiateSegmentedRead {
    /// Node id; the drive itself executes 0 and its own.
    pub node: u8,
    /// The object.
    pub address: Address,
}

command!(
    InitiateSegmentedRead = 0x12,
    |it: &Self| target(it.node, it.address),
    |[index, node_sub]: [u16; 2]| {
        let (node, address) = parse_target(index, node_sub);
        Self { node, address }
    }
);

/// Begins to write an object; the answer has no data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InitiateSegmentedWrite {
    /// Node id; the drive itself executes 0 and its own.
    pub node: u8,
    /// The object.
    pub address: Address,
    /// Bytes to come.
    pub len: u32,
}

command!(
    InitiateSegmentedWrite = 0x13,
    |it: &Self| target_and_number(it.node, it.address, it.len),
    |[index, node_sub, low, high]: [u16; 4]| {
        let (node, address) = parse_target(index, node_sub);
        let len = dword(low, high);
        Self { node, address, len }
    }
);

/// Reads the next segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SegmentedRead {
    /// Alternates from segment to segment, beginning with `false`.
    pub toggle: bool,
}

command!(
    SegmentedRead = 0x14,
    |it: &Self| [u16::from(toggle_bit(it.toggle))],
    |[control]: [u16; 1]| Self {
        toggle: has_toggle(control),
    }
);

/// A segment that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadSegment {
    /// Toggle bit of the request.
    pub toggle: bool,
    /// More segments follow.
    pub more: bool,
    /// Its bytes, at most 63.
    pub bytes: BoundedVec<u8, MAX_BYTES>,
}

impl SegmentedRead {
    /// The answer to it.
    #[must_use]
    pub fn answer(outcome: &Result<ReadSegment, AbortCode>) -> SerialFrame {
        SerialAnswer::of(outcome.as_ref().map_err(|error| *error).map(|segment| {
            let more = if segment.more { MORE } else { 0 };
            pack(toggle_bit(segment.toggle) | more, &segment.bytes)
        }))
    }

    /// The segment in its answer.
    ///
    /// # Errors
    /// [`SerialFrameError::Opcode`], [`SerialFrameError::WordCount`] if `frame` is no such answer
    /// or holds fewer bytes than it announces; the inner error is what the drive reports.
    pub fn parse_answer(
        frame: &SerialFrame,
    ) -> Result<Result<ReadSegment, AbortCode>, SerialFrameError> {
        SerialAnswer::read(frame, |answer| {
            let (control, bytes) = unpack(&answer.data, 2)?;
            Ok(ReadSegment {
                toggle: control & TOGGLE != 0,
                more: control & MORE != 0,
                bytes,
            })
        })
    }
}

/// A segment to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WriteSegment {
    /// Alternates from segment to segment, beginning with `false`.
    pub toggle: bool,
    /// Its bytes, at most 63.
    pub bytes: BoundedVec<u8, MAX_BYTES>,
}

/// Writes the next segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SegmentedWrite(pub WriteSegment);

impl SegmentedWrite {
    /// Opcode of the command.
    pub const OPCODE: u8 = 0x15;

    /// The request as a frame.
    #[must_use]
    pub fn to_frame(&self) -> SerialFrame {
        let mut frame = SerialFrame::of(Self::OPCODE, []);
        frame.words = pack(toggle_bit(self.0.toggle), &self.0.bytes);
        frame
    }

    /// The request in `frame`.
    ///
    /// # Errors
    /// [`SerialFrameError::Opcode`]; [`SerialFrameError::WordCount`] where it holds fewer bytes
    /// than it announces.
    pub fn parse(frame: &SerialFrame) -> Result<Self, SerialFrameError> {
        frame.expect_opcode(Self::OPCODE)?;
        let (control, bytes) = unpack(&frame.words, 0)?;
        let toggle = control & TOGGLE != 0;
        Ok(Self(WriteSegment { toggle, bytes }))
    }

    /// The answer to it: the toggle bit as received.
    #[must_use]
    pub fn answer(outcome: Result<bool, AbortCode>) -> SerialFrame {
        SerialAnswer::of(outcome.map(|toggle| [u16::from(toggle_bit(toggle))]))
    }

    /// The toggle bit in its answer.
    ///
    /// # Errors
    /// [`SerialFrameError::Opcode`], [`SerialFrameError::WordCount`] if `frame` is no such answer;
    /// the inner error is what the drive reports.
    pub fn parse_answer(frame: &SerialFrame) -> Result<Result<bool, AbortCode>, SerialFrameError> {
        SerialAnswer::read(frame, |answer| {
            let control = answer.data.first().ok_or(word_count(3, 2))?;
            Ok(has_toggle(*control))
        })
    }
}

const fn toggle_bit(toggle: bool) -> u8 {
    if toggle { TOGGLE } else { 0 }
}

const fn has_toggle(control: u16) -> bool {
    control & TOGGLE as u16 != 0
}

/// Control byte (with the length added) and bytes as words, low byte first.
fn pack(flags: u8, bytes: &[u8]) -> Words {
    let mut rest = bytes.iter().copied();
    let mut words = Words::new();
    let first = rest.next().unwrap_or_default();
    words.extend([u16::from_le_bytes([flags | bytes.len() as u8, first])]);
    while let Some(low) = rest.next() {
        let high = rest.next().unwrap_or_default();
        words.extend([u16::from_le_bytes([low, high])]);
    }
    words
}

/// The control byte and the bytes it announces; `before` words of the frame precede.
fn unpack(
    words: &[u16],
    before: usize,
) -> Result<(u8, BoundedVec<u8, MAX_BYTES>), SerialFrameError> {
    let mut all = words.iter().flat_map(|word| word.to_le_bytes());
    let control = all.next().ok_or(word_count(before + 1, before))?;
    let len = usize::from(control & LENGTH);
    let bytes: BoundedVec<_, MAX_BYTES> = all.take(len).collect();
    if bytes.len() < len {
        return Err(word_count(before + 1 + len / 2, before + words.len()));
    }
    Ok((control, bytes))
}
