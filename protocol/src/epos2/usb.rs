//! EPOS2 frames on USB: `90 02 | OpCode | Len | words, low byte first | CRC low, high` (Communication
//! Guide, "USB Frame Structure").
//!
//! After the sync pair each 0x90 is doubled, in opcode, length, data and CRC alike. `90 02` begins a
//! new frame at any point. The CRC covers Len and OpCode (one word, Len in the high byte) and the
//! data, without stuffing. The caller times out unfinished frames ([`UsbDecoder::reset`]).

use super::error::{FrameError, Layer};
use super::frame::{Frame, MAX_WORDS, PartialFrame};
use crate::Bounded;

/// Data link escape: begins a frame, doubled inside.
pub const DLE: u8 = 0x90;
/// Start of text: forms the sync pair with a preceding [`DLE`].
pub const STX: u8 = 0x02;
/// The longest frame on the wire: sync pair, then header, data and CRC with every byte doubled.
pub const MAX_BYTES: usize = 2 + 2 * (2 + 2 * MAX_WORDS + 2);

/// The bytes of one frame as on the wire.
pub type Bytes = Bounded<u8, MAX_BYTES>;

/// `frame` as on the wire, stuffed and with its CRC.
#[must_use]
pub fn to_bytes(frame: &Frame) -> Bytes {
    let len = frame.words.len() as u8;
    let crc = frame.crc([len, frame.opcode]);
    let words = frame.words.iter().copied().chain([crc]);
    let content = words.flat_map(u16::to_le_bytes);
    let mut bytes = Bytes::new();
    bytes.extend([DLE, STX]);
    for byte in [frame.opcode, len].into_iter().chain(content) {
        bytes.extend([byte]);
        if byte == DLE {
            bytes.extend([DLE]);
        }
    }
    bytes
}

/// Decodes a stream of bytes into frames.
#[derive(Clone, Debug, Default)]
pub struct UsbDecoder {
    state: State,
    /// The last byte was a [`DLE`]; the next decides its meaning.
    escaped: bool,
}

#[derive(Clone, Debug, Default)]
enum State {
    /// Between frames.
    #[default]
    Hunting,
    Opcode,
    Length {
        opcode: u8,
    },
    Content(PartialFrame),
}

impl UsbDecoder {
    /// A decoder between frames.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Drops a frame under way.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Whether a frame has begun and is not complete.
    #[must_use]
    pub const fn is_within_frame(&self) -> bool {
        !matches!(self.state, State::Hunting)
    }

    /// Takes one byte; a frame or an error comes out with the byte that completes it.
    ///
    /// After an error the decoder waits for the next sync pair, except that
    /// [`FrameError::BrokenOff`] comes out with the second byte of a sync pair and the new frame
    /// has then begun.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame, FrameError>> {
        let escaped = core::mem::take(&mut self.escaped);
        match (&self.state, escaped, byte) {
            // A false start after a doubled 90 ends at the next sync pair; a missed frame is lost.
            (State::Hunting, true, STX) => {
                self.state = State::Opcode;
                None
            }
            (State::Hunting, ..) | (_, false, DLE) => {
                self.escaped = byte == DLE;
                None
            }
            (_, false, _) | (_, true, DLE) => self.unstuffed(byte),
            (_, true, STX) => {
                let (expected, got) = self.progress();
                self.state = State::Opcode;
                Some(Err(FrameError::BrokenOff {
                    layer: Layer::Usb,
                    expected,
                    got,
                }))
            }
            (_, true, _) => {
                let (_, offset) = self.progress();
                self.reset();
                Some(Err(FrameError::Stuffing {
                    layer: Layer::Usb,
                    offset,
                    got: byte,
                }))
            }
        }
    }

    /// Bytes expected (opcode, length and CRC where the length is unknown) and received, without
    /// stuffing.
    fn progress(&self) -> (usize, usize) {
        match &self.state {
            State::Hunting | State::Opcode => (4, 0),
            State::Length { .. } => (4, 1),
            State::Content(frame) => (frame.expected(), frame.received()),
        }
    }

    fn unstuffed(&mut self, byte: u8) -> Option<Result<Frame, FrameError>> {
        let outcome = match &mut self.state {
            State::Hunting => None,
            State::Opcode => {
                self.state = State::Length { opcode: byte };
                None
            }
            State::Length { opcode } => {
                let header = [byte, *opcode];
                match PartialFrame::new(Layer::Usb, 2, header, *opcode, byte.into()) {
                    Ok(frame) => {
                        self.state = State::Content(frame);
                        None
                    }
                    Err(error) => Some(Err(error)),
                }
            }
            State::Content(frame) => frame.push(byte),
        };
        if outcome.is_some() {
            self.reset();
        }
        outcome
    }
}
