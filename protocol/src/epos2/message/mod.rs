//! The commands of the serial interfaces, one file a command, encode and parse together (Communication Guide, "Command Reference").
//!
//! An answer says neither which command nor which object it belongs to: pairing is the client's business. Words that a command
//! does not use are ignored, as a real unit fills them with garbage.

mod can_frame;
mod nmt;
mod read_object;
mod segmented_read;
mod segmented_write;
mod write_object;

pub use can_frame::{RequestCanFrame, SendCanFrame};
pub use nmt::Nmt;
pub use read_object::ReadObject;
pub use segmented_read::{InitiateSegmentedRead, ReadSegment, SegmentedRead};
pub use segmented_write::{InitiateSegmentedWrite, SegmentedWrite, WriteSegment};
pub use write_object::WriteObject;

use super::comm_error::CommError;
use super::error::{FrameError, Layer};
use super::frame::{Frame, Words};
use super::objects::Address;

/// Any request that a unit knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Opcode 10.
    ReadObject(ReadObject),
    /// Opcode 11.
    WriteObject(WriteObject),
    /// Opcode 12.
    InitiateSegmentedRead(InitiateSegmentedRead),
    /// Opcode 13.
    InitiateSegmentedWrite(InitiateSegmentedWrite),
    /// Opcode 14.
    SegmentedRead(SegmentedRead),
    /// Opcode 15.
    SegmentedWrite(SegmentedWrite),
    /// Opcode 0E.
    Nmt(Nmt),
    /// Opcode 20.
    SendCanFrame(SendCanFrame),
    /// Opcode 21.
    RequestCanFrame(RequestCanFrame),
}

impl Request {
    /// The request in `frame`; `None` for an opcode that the guide does not know.
    ///
    /// # Errors
    /// [`FrameError::WordCount`] where the command has another number of words.
    pub fn parse(frame: &Frame) -> Result<Option<Self>, FrameError> {
        Ok(Some(match frame.opcode {
            ReadObject::OPCODE => Self::ReadObject(ReadObject::parse(frame)?),
            WriteObject::OPCODE => Self::WriteObject(WriteObject::parse(frame)?),
            InitiateSegmentedRead::OPCODE => {
                Self::InitiateSegmentedRead(InitiateSegmentedRead::parse(frame)?)
            }
            InitiateSegmentedWrite::OPCODE => {
                Self::InitiateSegmentedWrite(InitiateSegmentedWrite::parse(frame)?)
            }
            SegmentedRead::OPCODE => Self::SegmentedRead(SegmentedRead::parse(frame)?),
            SegmentedWrite::OPCODE => Self::SegmentedWrite(SegmentedWrite::parse(frame)?),
            Nmt::OPCODE => Self::Nmt(Nmt::parse(frame)?),
            SendCanFrame::OPCODE => Self::SendCanFrame(SendCanFrame::parse(frame)?),
            RequestCanFrame::OPCODE => Self::RequestCanFrame(RequestCanFrame::parse(frame)?),
            _ => return Ok(None),
        }))
    }
}

/// An answer before it is known what it answers: an error code, then the command's data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Whether the command was carried out.
    pub error: CommError,
    /// What follows the error code, garbage included.
    pub data: Words,
}

impl Answer {
    /// An answer that says only that the command failed, or that it was carried out.
    #[must_use]
    pub fn bare(error: CommError) -> Self {
        Self {
            error,
            data: Words::new(),
        }
    }

    /// The answer in `frame`.
    ///
    /// # Errors
    /// [`FrameError::Opcode`] for a request (an echo, for instance), [`FrameError::WordCount`] below two words.
    pub fn parse(frame: &Frame) -> Result<Self, FrameError> {
        frame.expect_opcode(Frame::ANSWER)?;
        let [low, high, data @ ..] = frame.words.as_slice() else {
            return Err(word_count(2, frame.words.len()));
        };
        let mut answer = Self::bare(CommError::from_words(*low, *high));
        answer.data.extend(data.iter().copied());
        Ok(answer)
    }

    /// The answer as a frame; data beyond a frame's room is cut off.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        let mut frame = Frame::of(Frame::ANSWER, self.error.to_words());
        frame.words.extend(self.data.iter().copied());
        frame
    }

    /// The data as one number, low word first: what a read object command returns. Above an object's width it is garbage.
    ///
    /// # Errors
    /// [`FrameError::WordCount`] below two data words.
    pub fn value(&self) -> Result<u32, FrameError> {
        match self.data.as_slice() {
            [low, high, ..] => Ok(CommError::from_words(*low, *high).0),
            short => Err(word_count(4, 2 + short.len())),
        }
    }
}

fn word_count(expected: usize, got: usize) -> FrameError {
    FrameError::WordCount {
        layer: Layer::Message,
        expected,
        got,
    }
}

/// The two words that name an object of a node.
fn target(node: u8, address: Address) -> [u16; 2] {
    [address.index, u16::from_be_bytes([node, address.sub])]
}

/// Node and address of the two words that name an object.
fn parse_target(index: u16, node_sub: u16) -> (u8, Address) {
    let [node, sub] = node_sub.to_be_bytes();
    (node, Address { index, sub })
}

/// The low and the high word.
fn words(value: u32) -> [u16; 2] {
    CommError(value).to_words()
}

/// The number of a low and a high word.
fn dword(low: u16, high: u16) -> u32 {
    CommError::from_words(low, high).0
}
