//! EPOS2 frames on USB: `90 02 | OpCode | Len | words, low byte first | CRC low, high` (Communication Guide, "USB Frame Structure").
//!
//! After the sync pair each 0x90 is doubled, wherever it stands: opcode, length, data and CRC alike. `90 02` begins a new
//! frame at any point. The CRC is taken before stuffing over Len, OpCode (as one word, Len in the high byte) and the data.
//! When to give up waiting for the rest of a frame is the caller's business ([`UsbDecoder::reset`]).

use super::crc::Crc;
use super::error::{FrameError, Layer};
use super::frame::{Frame, MAX_WORDS, Words};
use crate::Bounded;

/// Data link escape: begins a frame, doubled inside.
pub const DLE: u8 = 0x90;
/// Start of text: with [`DLE`] before it, the sync pair.
pub const STX: u8 = 0x02;
/// The longest frame on the wire: sync pair, then header, data and CRC with every byte doubled.
pub const MAX_BYTES: usize = 2 + 2 * (2 + 2 * MAX_WORDS + 2);

/// The bytes of one frame as on the wire.
pub type Bytes = Bounded<u8, MAX_BYTES>;

/// Writes the frame of `opcode` and `words` to `out`, stuffed and with its CRC.
///
/// # Errors
/// [`FrameError::TooLong`] beyond [`MAX_WORDS`]; nothing is written then.
pub fn encode(opcode: u8, words: &[u16], out: &mut impl Extend<u8>) -> Result<(), FrameError> {
    encode_frame(&Frame::new(opcode, words)?, out);
    Ok(())
}

/// Writes `frame` to `out`, stuffed and with its CRC.
pub fn encode_frame(frame: &Frame, out: &mut impl Extend<u8>) {
    out.extend([DLE, STX]);
    let header = header(frame.opcode, frame.words.len());
    let crc = frame.words.iter().copied().fold(header, Crc::word);
    stuff([frame.opcode, frame.words.len() as u8], out);
    for word in frame.words.iter() {
        stuff(word.to_le_bytes(), out);
    }
    stuff(crc.value().to_le_bytes(), out);
}

/// `frame` as on the wire.
#[must_use]
pub fn to_bytes(frame: &Frame) -> Bytes {
    let mut bytes = Bytes::new();
    encode_frame(frame, &mut bytes);
    bytes
}

/// The CRC after the header word: Len in the high byte.
const fn header(opcode: u8, len: usize) -> Crc {
    Crc(0).word(u16::from_be_bytes([len as u8, opcode]))
}

fn stuff(bytes: [u8; 2], out: &mut impl Extend<u8>) {
    for byte in bytes {
        out.extend([byte]);
        if byte == DLE {
            out.extend([DLE]);
        }
    }
}

/// Takes the bytes of a stream one by one and gives frames back.
#[derive(Clone, Debug, Default)]
pub struct UsbDecoder {
    state: State,
    /// The last byte was an escape whose meaning the next one decides.
    escaped: bool,
    opcode: u8,
    len: usize,
    low: u8,
    words: Words,
    crc: Crc,
    /// Bytes of this frame after the sync pair, without stuffing.
    got: usize,
}

/// What the next byte is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    #[default]
    Hunting,
    Opcode,
    Len,
    Low,
    High,
    CrcLow,
    CrcHigh,
}

impl UsbDecoder {
    /// A decoder that looks for the beginning of a frame.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets a frame under way.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Whether a frame has begun and is not complete.
    #[must_use]
    pub fn is_within_frame(&self) -> bool {
        self.state != State::Hunting
    }

    /// Takes one byte; a frame or an error comes out with the byte that completes it.
    ///
    /// After an error the decoder waits for the next sync pair, except that [`FrameError::BrokenOff`] comes out with the
    /// second byte of a sync pair and the new frame has then begun.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame, FrameError>> {
        if self.state == State::Hunting {
            // Every `90 02` counts here, even behind another 90: better a false start, which the next sync pair ends, than
            // a missed frame.
            if self.escaped && byte == STX {
                self.begin();
            } else {
                self.escaped = byte == DLE;
            }
            return None;
        }
        if self.escaped {
            self.escaped = false;
            return match byte {
                DLE => self.unstuffed(DLE),
                STX => {
                    let error = self.broken_off();
                    self.begin();
                    Some(Err(error))
                }
                _ => {
                    let offset = self.got;
                    self.fail(FrameError::Stuffing {
                        layer: Layer::Usb,
                        offset,
                        got: byte,
                    })
                }
            };
        }
        if byte == DLE {
            self.escaped = true;
            return None;
        }
        self.unstuffed(byte)
    }

    fn begin(&mut self) {
        self.reset();
        self.state = State::Opcode;
    }

    fn fail(&mut self, error: FrameError) -> Option<Result<Frame, FrameError>> {
        self.reset();
        Some(Err(error))
    }

    fn broken_off(&self) -> FrameError {
        FrameError::BrokenOff {
            layer: Layer::Usb,
            expected: 4 + 2 * self.len,
            got: self.got,
        }
    }

    fn unstuffed(&mut self, byte: u8) -> Option<Result<Frame, FrameError>> {
        self.got += 1;
        match self.state {
            State::Hunting => {}
            State::Opcode => {
                self.opcode = byte;
                self.state = State::Len;
            }
            State::Len => return self.length(byte),
            State::Low => {
                self.low = byte;
                self.state = State::High;
            }
            State::High => self.word(u16::from_le_bytes([self.low, byte])),
            State::CrcLow => {
                self.low = byte;
                self.state = State::CrcHigh;
            }
            State::CrcHigh => return Some(self.complete(u16::from_le_bytes([self.low, byte]))),
        }
        None
    }

    fn length(&mut self, byte: u8) -> Option<Result<Frame, FrameError>> {
        self.len = usize::from(byte);
        self.crc = header(self.opcode, self.len);
        if self.len > MAX_WORDS {
            let got = self.len;
            return self.fail(FrameError::TooLong {
                layer: Layer::Usb,
                offset: 1,
                max: MAX_WORDS,
                got,
            });
        }
        self.state = if self.len == 0 {
            State::CrcLow
        } else {
            State::Low
        };
        None
    }

    fn word(&mut self, word: u16) {
        self.words.extend([word]);
        self.crc = self.crc.word(word);
        self.state = if self.words.len() < self.len {
            State::Low
        } else {
            State::CrcLow
        };
    }

    fn complete(&mut self, got: u16) -> Result<Frame, FrameError> {
        let expected = self.crc.value();
        let frame = Frame {
            opcode: self.opcode,
            words: self.words,
        };
        self.reset();
        if got == expected {
            Ok(frame)
        } else {
            Err(FrameError::Crc {
                layer: Layer::Usb,
                offset: 2 + 2 * frame.words.len(),
                expected,
                got,
            })
        }
    }
}

/// Cuts a stream into the raw bytes of its frames, for logs that keep one frame a record; stuffing stays in.
///
/// Bytes that belong to no frame are dropped, and a frame that breaks off ends with the bytes that came.
#[derive(Clone, Debug, Default)]
pub struct UsbDelimiter {
    decoder: UsbDecoder,
    raw: Bytes,
}

impl UsbDelimiter {
    /// A delimiter that looks for the beginning of a frame.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes one byte; the raw bytes and what they decode to come out with the byte that completes a frame.
    ///
    /// A frame that a new one breaks off comes out without the new one's sync pair.
    pub fn push(&mut self, byte: u8) -> Option<(Bytes, Result<Frame, FrameError>)> {
        let was_within = self.decoder.is_within_frame();
        let outcome = self.decoder.push(byte);
        let begun = self.decoder.is_within_frame() && (!was_within || outcome.is_some());
        if begun {
            // The pending escape of the new sync pair is the last byte kept so far.
            let old = self.raw;
            self.raw.clear();
            self.raw.extend([DLE, STX]);
            return outcome.map(|outcome| {
                let kept = old.len().saturating_sub(1);
                let mut raw = Bytes::new();
                raw.extend(old.iter().copied().take(kept));
                (raw, outcome)
            });
        }
        if was_within {
            self.raw.extend([byte]);
        }
        outcome.map(|outcome| (self.raw, outcome))
    }

    /// Gives up on a frame under way and returns its bytes so far, if any.
    pub fn abandon(&mut self) -> Option<Bytes> {
        let raw = self.decoder.is_within_frame().then_some(self.raw);
        *self = Self::default();
        raw
    }
}
