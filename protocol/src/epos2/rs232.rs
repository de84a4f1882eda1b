//! EPOS2 frames on RS232: opcode, handshake, `Len-1 | words, low byte first | CRC low, high`,
//! handshake (Communication Guide, "RS232 Frame Structure").
//!
//! There is no sync and no stuffing. [`OKAY`] or [`FAILED`] answers an opcode, and each body. The
//! CRC covers OpCode and Len-1 (one word, **OpCode** in the high byte: the other order than on USB)
//! and the data. This module has the body; client and device conduct the handshake and its timeout.

use super::error::{SerialFrameError, SerialLayer};
use super::frame::{MAX_WORDS, PartialFrame, SerialFrame};
use crate::BoundedVec;

/// Handshake: go on.
pub const OKAY: u8 = b'O';
/// Handshake: refused.
pub const FAILED: u8 = b'F';
/// Default timeout of an unfinished frame in milliseconds (objects 2005 and 2006).
pub const FRAME_TIMEOUT_MS: u32 = 500;
/// The longest body on the wire: Len-1, data, CRC.
pub const MAX_BYTES: usize = 1 + 2 * MAX_WORDS + 2;

/// The bytes of one body as on the wire.
pub type Bytes = BoundedVec<u8, MAX_BYTES>;

/// Writes the body of `frame` (without the opcode, which precedes it) to `out`.
///
/// # Errors
/// [`SerialFrameError::WordCount`] for a frame without words, which Len-1 cannot express; nothing
/// is written.
pub fn encode_body(frame: &SerialFrame, out: &mut impl Extend<u8>) -> Result<(), SerialFrameError> {
    let Some(len_1) = frame.words.len().checked_sub(1) else {
        return Err(SerialFrameError::WordCount {
            layer: SerialLayer::Rs232,
            expected: 1,
            got: 0,
        });
    };
    let len_1 = len_1 as u8;
    let crc = frame.crc([frame.opcode, len_1]);
    let words = frame.words.iter().copied().chain([crc]);
    out.extend([len_1]);
    out.extend(words.flat_map(u16::to_le_bytes));
    Ok(())
}

/// Decodes the bytes of one body after its opcode.
#[derive(Clone, Debug)]
pub struct BodyDecoder {
    opcode: u8,
    /// After the length byte.
    frame: Option<PartialFrame>,
}

impl BodyDecoder {
    /// A decoder for the body that follows `opcode`.
    #[must_use]
    pub const fn new(opcode: u8) -> Self {
        let frame = None;
        Self { opcode, frame }
    }

    /// Takes one byte; the frame or an error comes out with the last. Afterwards the decoder awaits
    /// another body of the same opcode.
    pub fn push(&mut self, byte: u8) -> Option<Result<SerialFrame, SerialFrameError>> {
        let opcode = self.opcode;
        let Some(frame) = &mut self.frame else {
            let (header, len) = ([opcode, byte], usize::from(byte) + 1);
            return match PartialFrame::new(SerialLayer::Rs232, 1, header, opcode, len) {
                Ok(frame) => {
                    self.frame = Some(frame);
                    None
                }
                Err(error) => Some(Err(error)),
            };
        };
        let outcome = frame.push(byte)?;
        self.frame = None;
        Some(outcome)
    }
}
