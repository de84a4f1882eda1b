//! EPOS2 frames on RS232: opcode, handshake, `Len-1 | words, low byte first | CRC low, high`, handshake (Communication Guide,
//! "RS232 Frame Structure").
//!
//! There is no sync and no stuffing: an opcode is answered by [`OKAY`] or [`FAILED`], and so is each body. The CRC goes over
//! OpCode and Len-1 (as one word, **OpCode** in the high byte: the other order than on USB) and the data. Here are the body and
//! its checksum; the turns of the handshake, with their timeout of 500 ms, belong to the client and to the device.

use super::crc::Crc;
use super::error::{FrameError, Layer};
use super::frame::{Frame, MAX_WORDS, Words};
use crate::Bounded;

/// Handshake: go on.
pub const OKAY: u8 = b'O';
/// Handshake: refused.
pub const FAILED: u8 = b'F';
/// Milliseconds after which an unfinished frame is forgotten, by default (objects 2005 and 2006).
pub const FRAME_TIMEOUT_MS: u32 = 500;
/// The longest body on the wire: Len-1, data, CRC.
pub const MAX_BYTES: usize = 1 + 2 * MAX_WORDS + 2;

/// The bytes of one body as on the wire.
pub type Bytes = Bounded<u8, MAX_BYTES>;

/// Writes the body of `frame` (all but the opcode, which goes ahead alone) to `out`.
///
/// # Errors
/// [`FrameError::WordCount`] for a frame without words: Len-1 cannot say so. Nothing is written then.
pub fn encode_body(frame: &Frame, out: &mut impl Extend<u8>) -> Result<(), FrameError> {
    let Some(len_1) = frame.words.len().checked_sub(1) else {
        return Err(FrameError::WordCount {
            layer: Layer::Rs232,
            expected: 1,
            got: 0,
        });
    };
    let header = header(frame.opcode, len_1 as u8);
    let crc = frame.words.iter().copied().fold(header, Crc::word);
    out.extend([len_1 as u8]);
    for word in frame.words.iter() {
        out.extend(word.to_le_bytes());
    }
    out.extend(crc.value().to_le_bytes());
    Ok(())
}

/// The CRC after the header word: OpCode in the high byte.
const fn header(opcode: u8, len_1: u8) -> Crc {
    Crc(0).word(u16::from_be_bytes([opcode, len_1]))
}

/// Takes the bytes of one body after its opcode.
#[derive(Clone, Debug)]
pub struct BodyDecoder {
    opcode: u8,
    /// Words announced; 0 until the length byte.
    len: usize,
    low: Option<u8>,
    words: Words,
    crc: Crc,
}

impl BodyDecoder {
    /// A decoder for the body that follows `opcode`.
    #[must_use]
    pub fn new(opcode: u8) -> Self {
        Self {
            opcode,
            len: 0,
            low: None,
            words: Words::new(),
            crc: Crc::default(),
        }
    }

    /// Takes one byte; the frame or an error comes out with the last. Afterwards the decoder awaits another body of the same opcode.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame, FrameError>> {
        if self.len == 0 {
            return self.length(byte);
        }
        let Some(low) = self.low.take() else {
            self.low = Some(byte);
            return None;
        };
        let word = u16::from_le_bytes([low, byte]);
        if self.words.len() < self.len {
            self.words.extend([word]);
            self.crc = self.crc.word(word);
            return None;
        }
        Some(self.complete(word))
    }

    fn length(&mut self, len_1: u8) -> Option<Result<Frame, FrameError>> {
        let len = usize::from(len_1) + 1;
        if len > MAX_WORDS {
            return Some(Err(FrameError::TooLong {
                layer: Layer::Rs232,
                offset: 0,
                max: MAX_WORDS,
                got: len,
            }));
        }
        self.len = len;
        self.crc = header(self.opcode, len_1);
        None
    }

    fn complete(&mut self, got: u16) -> Result<Frame, FrameError> {
        let expected = self.crc.value();
        let frame = Frame {
            opcode: self.opcode,
            words: self.words,
        };
        *self = Self::new(self.opcode);
        if got == expected {
            Ok(frame)
        } else {
            Err(FrameError::Crc {
                layer: Layer::Rs232,
                offset: 1 + 2 * frame.words.len(),
                expected,
                got,
            })
        }
    }
}
