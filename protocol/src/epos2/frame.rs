//! A frame without its framing: an opcode and some words, the same on USB and RS232.

use super::error::{FrameError, Layer};
use crate::Bounded;

/// The most words a frame is allowed here. The longest the Communication Guide knows, the answer to a segmented read, has 34; the
/// limit lets a damaged length byte show at once instead of after half a kilobyte.
pub const MAX_WORDS: usize = 64;

/// The data of a frame.
pub type Words = Bounded<u16, MAX_WORDS>;

/// A request (opcode of a command) or an answer (opcode 00).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Command, or [`Frame::ANSWER`].
    pub opcode: u8,
    /// The data words.
    pub words: Words,
}

impl Frame {
    /// Opcode of every answer.
    pub const ANSWER: u8 = 0x00;

    /// A frame of `words`.
    ///
    /// # Errors
    /// [`FrameError::TooLong`] beyond [`MAX_WORDS`].
    pub fn new(opcode: u8, words: &[u16]) -> Result<Self, FrameError> {
        let words = Words::from_slice(words).map_err(|full| FrameError::TooLong {
            layer: Layer::Message,
            offset: 1,
            max: full.capacity,
            got: words.len(),
        })?;
        Ok(Self { opcode, words })
    }

    /// A frame of few words: what does not fit is a compile-time error.
    pub(crate) fn of<const N: usize>(opcode: u8, words: [u16; N]) -> Self {
        const { assert!(N <= MAX_WORDS) };
        let mut list = Words::new();
        list.extend(words);
        Self {
            opcode,
            words: list,
        }
    }

    /// The words, if this is `opcode` with exactly `N` of them.
    pub(crate) fn exactly<const N: usize>(&self, opcode: u8) -> Result<[u16; N], FrameError> {
        self.expect_opcode(opcode)?;
        <[u16; N]>::try_from(self.words.as_slice()).map_err(|_| FrameError::WordCount {
            layer: Layer::Message,
            expected: N,
            got: self.words.len(),
        })
    }

    pub(crate) fn expect_opcode(&self, opcode: u8) -> Result<(), FrameError> {
        if self.opcode == opcode {
            Ok(())
        } else {
            Err(FrameError::Opcode {
                layer: Layer::Message,
                expected: opcode,
                got: self.opcode,
            })
        }
    }
}
