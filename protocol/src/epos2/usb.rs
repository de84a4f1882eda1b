//! EPOS2 frames on USB: `90 02 | OpCode | Len | words, low byte first | CRC low, high`
//! (Communication Guide, "USB Frame Structure").
//!
//! After the sync pair each 0x90 is doubled, in opcode, length, data and CRC alike. `90 02` begins
//! a new frame at any point. The CRC covers Len and OpCode (one word, Len in the high byte) and the
//! data, without stuffing. The caller times out unfinished frames ([`UsbDecoder::reset`]).

use super::error::{SerialFrameError, SerialLayer};
use super::frame::{MAX_WORDS, PartialFrame, SerialFrame};
use crate::BoundedVec;

/// Data link escape: begins a frame, doubled inside.
pub const DLE: u8 = 0x90;
/// Start of text: forms the sync pair with a preceding [`DLE`].
pub const STX: u8 = 0x02;
/// The longest frame on the wire: sync pair, then header, data and CRC with every byte doubled.
pub const MAX_BYTES: usize = 2 + 2 * (2 + 2 * MAX_WORDS + 2);

/// The bytes of one frame as on the wire.
pub type Bytes = BoundedVec<u8, MAX_BYTES>;

/// `frame` as on the wire, stuffed and with its CRC.
#[must_use]
pub fn to_bytes(frame: &SerialFrame) -> Bytes {
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
    state: DecoderState,
    /// The last byte was a [`DLE`]; the next decides its meaning.
    escaped: bool,
}

#[derive(Clone, Debug, Default)]
enum DecoderState {
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

    /// Whether a frame has started and is not complete.
    #[must_use]
    pub const fn is_within_frame(&self) -> bool {
        !matches!(self.state, DecoderState::Hunting)
    }

    /// Takes one byte; a frame or an error comes out with the byte that completes it.
    ///
    /// After an error the decoder waits for the next sync pair, except that
    /// [`SerialFrameError::BrokenOff`] comes out with the second byte of a sync pair and the new
    /// frame has then begun.
    pub fn push(&mut self, byte: u8) -> Option<Result<SerialFrame, SerialFrameError>> {
        let escaped = core::mem::take(&mut self.escaped);
        match (&self.state, escaped, byte) {
            // A false start after a doubled 90 ends at the next sync pair; a missed frame is lost.
            (DecoderState::Hunting, true, STX) => {
                self.state = DecoderState::Opcode;
                None
            }
            (DecoderState::Hunting, ..) | (_, false, DLE) => {
                self.escaped = byte == DLE;
                None
            }
            (_, false, _) | (_, true, DLE) => self.unstuffed(byte),
            (_, true, STX) => {
                let (expected, got) = self.progress();
                self.state = DecoderState::Opcode;
                Some(Err(SerialFrameError::BrokenOff {
                    layer: SerialLayer::Usb,
                    expected,
                    got,
                }))
            }
            (_, true, _) => {
                let (_, offset) = self.progress();
                self.reset();
                Some(Err(SerialFrameError::Stuffing {
                    layer: SerialLayer::Usb,
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
            DecoderState::Hunting | DecoderState::Opcode => (4, 0),
            DecoderState::Length { .. } => (4, 1),
            DecoderState::Content(frame) => (frame.expected(), frame.received()),
        }
    }

    fn unstuffed(&mut self, byte: u8) -> Option<Result<SerialFrame, SerialFrameError>> {
        let outcome = match &mut self.state {
            DecoderState::Hunting => None,
            DecoderState::Opcode => {
                self.state = DecoderState::Length { opcode: byte };
                None
            }
            DecoderState::Length { opcode } => {
                let header = [byte, *opcode];
                match PartialFrame::new(SerialLayer::Usb, 2, header, *opcode, byte.into()) {
                    Ok(frame) => {
                        self.state = DecoderState::Content(frame);
                        None
                    }
                    Err(error) => Some(Err(error)),
                }
            }
            DecoderState::Content(frame) => frame.push(byte),
        };
        if outcome.is_some() {
            self.reset();
        }
        outcome
    }
}
