//! A frame without its framing: an opcode and words, the same on USB and RS232.

use super::crc::crc16;
use super::error::{SerialFrameError, SerialLayer};
use crate::BoundedVec;

/// Largest number of words accepted in a frame. The longest frame of the Communication Guide, the
/// answer to a segmented read, has 34; the limit reveals a damaged length byte early.
pub const MAX_WORDS: usize = 64;

/// The data of a frame.
pub type Words = BoundedVec<u16, MAX_WORDS>;

/// A request (opcode of a command) or an answer (opcode 00).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SerialFrame {
    /// Command, or [`SerialFrame::ANSWER`].
    pub opcode: u8,
    /// The data words.
    pub words: Words,
}

impl SerialFrame {
    /// Opcode of every answer.
    pub const ANSWER: u8 = 0x00;

    /// A frame of `words`.
    ///
    /// # Errors
    /// [`SerialFrameError::TooLong`] above [`MAX_WORDS`].
    pub fn new(opcode: u8, words: &[u16]) -> Result<Self, SerialFrameError> {
        let words = Words::from_slice(words).map_err(|full| SerialFrameError::TooLong {
            layer: SerialLayer::Message,
            offset: 1,
            max: full.capacity,
            got: words.len(),
        })?;
        Ok(Self { opcode, words })
    }

    /// A frame of a fixed number of words.
    pub(super) fn of<const N: usize>(opcode: u8, data: [u16; N]) -> Self {
        const { assert!(N <= MAX_WORDS) };
        let words = data.into_iter().collect();
        Self { opcode, words }
    }

    /// The words, if this is `opcode` with exactly `N` of them.
    pub(super) fn exactly<const N: usize>(&self, opcode: u8) -> Result<[u16; N], SerialFrameError> {
        self.expect_opcode(opcode)?;
        <[u16; N]>::try_from(self.words.as_slice()).map_err(|_| SerialFrameError::WordCount {
            layer: SerialLayer::Message,
            expected: N,
            got: self.words.len(),
        })
    }

    pub(super) fn expect_opcode(&self, opcode: u8) -> Result<(), SerialFrameError> {
        if self.opcode == opcode {
            return Ok(());
        }
        Err(SerialFrameError::Opcode {
            layer: SerialLayer::Message,
            expected: opcode,
            got: self.opcode,
        })
    }

    /// The checksum: opcode and length form the first word, in the order of the layer.
    pub(super) fn crc(&self, header: [u8; 2]) -> u16 {
        let header = u16::from_be_bytes(header);
        crc16([header].into_iter().chain(self.words.iter().copied()))
    }
}

/// A frame being received: words and CRC, byte by byte, after a header of opcode and length.
#[derive(Clone, Debug)]
pub(super) struct PartialFrame {
    layer: SerialLayer,
    /// Bytes of the layer before the first word.
    offset: usize,
    /// The header as the checksum takes it.
    header: [u8; 2],
    frame: SerialFrame,
    /// Words announced.
    len: usize,
    /// First byte of the word being received.
    low: Option<u8>,
}

impl PartialFrame {
    /// A frame of which `offset` bytes have arrived, the last of them its length.
    pub fn new(
        layer: SerialLayer,
        offset: usize,
        header: [u8; 2],
        opcode: u8,
        len: usize,
    ) -> Result<Self, SerialFrameError> {
        if len > MAX_WORDS {
            return Err(SerialFrameError::TooLong {
                layer,
                offset: offset - 1,
                max: MAX_WORDS,
                got: len,
            });
        }
        Ok(Self {
            layer,
            offset,
            header,
            frame: SerialFrame::of(opcode, []),
            len,
            low: None,
        })
    }

    /// Bytes of the whole frame.
    pub const fn expected(&self) -> usize {
        self.offset + 2 * self.len + 2
    }

    /// Bytes received so far.
    pub fn received(&self) -> usize {
        self.offset + 2 * self.frame.words.len() + usize::from(self.low.is_some())
    }

    /// Takes one byte; the last completes the frame.
    pub fn push(&mut self, byte: u8) -> Option<Result<SerialFrame, SerialFrameError>> {
        let Some(low) = self.low.take() else {
            self.low = Some(byte);
            return None;
        };
        let got = u16::from_le_bytes([low, byte]);
        if self.frame.words.len() < self.len {
            self.frame.words.extend([got]);
            return None;
        }
        let expected = self.frame.crc(self.header);
        Some(if got == expected {
            Ok(self.frame)
        } else {
            Err(SerialFrameError::Crc {
                layer: self.layer,
                offset: self.received(),
                expected,
                got,
            })
        })
    }
}
