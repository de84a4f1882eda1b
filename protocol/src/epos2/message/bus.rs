//! NMT service, send and request CAN frame, opcodes 0E, 20 and 21: the CAN bus through the drive as
//! gateway.

use super::{SerialAnswer, command, word_count};
use crate::epos2::{AbortCode, SerialFrame, SerialFrameError};

/// A network management command to one node or to all. Over RS232 it has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GatewayNmt {
    /// Node id; 0 is all nodes.
    pub node: u16,
    /// Command specifier, see [`NmtCommand`](crate::canopen::nmt::NmtCommand).
    pub specifier: u16,
}

command!(
    GatewayNmt = 0x0E,
    |it: &Self| [it.node, it.specifier],
    |[node, specifier]: [u16; 2]| Self { node, specifier }
);

/// Sends a data frame on the bus. Over RS232 it has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SendCanFrame {
    /// 11-bit identifier.
    pub cob_id: u16,
    /// Length of the data, 0 to 8.
    pub len: u16,
    /// The data.
    pub data: [u8; 8],
}

command!(
    SendCanFrame = 0x20,
    |it: &Self| {
        let [a, b, c, d] = to_words(it.data);
        [it.cob_id, it.len, a, b, c, d]
    },
    |[cob_id, len, a, b, c, d]: [u16; 6]| {
        let data = from_words([a, b, c, d]);
        Self { cob_id, len, data }
    }
);

/// Sends a remote frame on the bus and returns the data of the frame that answers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RequestCanFrame {
    /// 11-bit identifier.
    pub cob_id: u16,
    /// Length of the data, 0 to 8.
    pub len: u16,
}

command!(
    RequestCanFrame = 0x21,
    |it: &Self| [it.cob_id, it.len],
    |[cob_id, len]: [u16; 2]| Self { cob_id, len }
);

impl RequestCanFrame {
    /// The answer to it.
    #[must_use]
    pub fn answer(outcome: Result<[u8; 8], AbortCode>) -> SerialFrame {
        SerialAnswer::of(outcome.map(to_words))
    }

    /// The data in its answer.
    ///
    /// # Errors
    /// [`SerialFrameError::Opcode`], [`SerialFrameError::WordCount`] if `frame` is no such answer;
    /// the inner error is what the drive reports.
    pub fn parse_answer(
        frame: &SerialFrame,
    ) -> Result<Result<[u8; 8], AbortCode>, SerialFrameError> {
        SerialAnswer::read(frame, |answer| match answer.data.first_chunk() {
            Some(words) => Ok(from_words(*words)),
            None => Err(word_count(6, 2 + answer.data.len())),
        })
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
