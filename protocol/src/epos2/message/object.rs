//! ReadObject and WriteObject, opcodes 10 and 11: objects of up to 32 bits.

use super::{SerialAnswer, command, dword, parse_target, target, target_and_number};
use crate::canopen::Address;
use crate::epos2::{AbortCode, SerialFrame, SerialFrameError};

/// Reads the value of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadObject {
    /// Node id; the drive itself executes 0 and its own.
    pub node: u8,
    /// The object.
    pub address: Address,
}

command!(
    ReadObject = 0x10,
    |it: &Self| target(it.node, it.address),
    |[index, node_sub]: [u16; 2]| {
        let (node, address) = parse_target(index, node_sub);
        Self { node, address }
    }
);

impl ReadObject {
    /// The answer to it: the value in the low bytes, or an error in two words.
    #[must_use]
    pub fn answer(outcome: Result<u32, AbortCode>) -> SerialFrame {
        SerialAnswer::of(outcome.map(|value| AbortCode(value).to_words()))
    }

    /// The value in its answer; the bits above the width of the object are garbage. An error comes
    /// in two words or in four.
    ///
    /// # Errors
    /// [`SerialFrameError::Opcode`], [`SerialFrameError::WordCount`] if `frame` is no such answer;
    /// the inner error is what the drive reports.
    pub fn parse_answer(frame: &SerialFrame) -> Result<Result<u32, AbortCode>, SerialFrameError> {
        SerialAnswer::read(frame, SerialAnswer::value)
    }
}

/// Writes the value of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WriteObject {
    /// Node id; the drive itself executes 0 and its own.
    pub node: u8,
    /// The object.
    pub address: Address,
    /// The value in the low bytes.
    pub value: u32,
}

command!(
    WriteObject = 0x11,
    |it: &Self| target_and_number(it.node, it.address, it.value),
    |[index, node_sub, low, high]: [u16; 4]| {
        let (node, address) = parse_target(index, node_sub);
        let value = dword(low, high);
        Self {
            node,
            address,
            value,
        }
    }
);

impl WriteObject {
    /// The answer to it.
    #[must_use]
    pub fn answer(outcome: Result<(), AbortCode>) -> SerialFrame {
        SerialAnswer::of(outcome.map(|()| []))
    }

    /// Whether it was carried out.
    ///
    /// # Errors
    /// [`SerialFrameError::Opcode`], [`SerialFrameError::WordCount`] if `frame` is no answer; the
    /// inner error is what the drive reports.
    pub fn parse_answer(frame: &SerialFrame) -> Result<Result<(), AbortCode>, SerialFrameError> {
        SerialAnswer::read(frame, |_| Ok(()))
    }
}
