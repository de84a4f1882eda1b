//! What an adapter tells its host: answers to commands, and frames from the bus at any time between them.

use super::error::SlcanError;
use super::frame::{parse_frame, write_frame};
use super::line::{BEL, CR, Line, LineAssembler, LineEvent, length, number, text, write_number};
use crate::canopen::frame::CanFrame;

/// A line from adapter to host, or BEL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlcanReply {
    /// CR alone: done.
    Done,
    /// BEL: not done.
    Refused,
    /// `z`: a frame with 11-bit identifier was taken.
    Sent,
    /// `Z`: a frame with 29-bit identifier was taken.
    SentExtended,
    /// A frame came from the bus.
    Received {
        /// The frame.
        frame: CanFrame,
        /// When, in milliseconds of a minute of the adapter's clock, if it was told to say so.
        stamp_ms: Option<u16>,
    },
    /// `V` and a text, four digits on a CANUSB.
    Version(Line),
    /// `N` and a text.
    SerialNumber(Line),
    /// `F`: status flags.
    Status(u8),
    /// Anything else.
    Unknown(Line),
}

impl SlcanReply {
    /// Writes the line with its CR, or BEL.
    pub fn encode(&self, out: &mut impl Extend<u8>) {
        match self {
            Self::Done => {}
            Self::Refused => return out.extend([BEL]),
            Self::Sent => out.extend([b'z']),
            Self::SentExtended => out.extend([b'Z']),
            Self::Received { frame, stamp_ms } => {
                write_frame(frame, out);
                if let Some(stamp) = stamp_ms {
                    write_number(u32::from(*stamp), 4, out);
                }
            }
            Self::Version(text) => prefixed(b'V', text, out),
            Self::SerialNumber(text) => prefixed(b'N', text, out),
            Self::Status(flags) => {
                out.extend([b'F']);
                write_number(u32::from(*flags), 2, out);
            }
            Self::Unknown(line) => out.extend(line.iter().copied()),
        }
        out.extend([CR]);
    }

    /// The reply of a line without its CR.
    ///
    /// # Errors
    /// [`SlcanError`] for a frame that is none and flags that are none.
    pub fn parse(line: &Line) -> Result<Self, SlcanError> {
        Ok(match line.as_slice() {
            [] => Self::Done,
            [b'z'] => Self::Sent,
            [b'Z'] => Self::SentExtended,
            [b't' | b'T' | b'r' | b'R', ..] => {
                let (frame, stamp_ms) = parse_frame(line)?;
                Self::Received { frame, stamp_ms }
            }
            [b'V', ..] => Self::Version(text(line)),
            [b'N', ..] => Self::SerialNumber(text(line)),
            [b'F', ..] => {
                length(line, 3)?;
                Self::Status(number(line, 1, 2)? as u8)
            }
            _ => Self::Unknown(*line),
        })
    }
}

fn prefixed(letter: u8, text: &Line, out: &mut impl Extend<u8>) {
    out.extend([letter]);
    out.extend(text.iter().copied());
}

/// The host's side: takes the bytes of a stream one by one and gives replies back.
#[derive(Clone, Debug, Default)]
pub struct ReplyDecoder {
    lines: LineAssembler,
}

impl ReplyDecoder {
    /// A decoder at the beginning of a line.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes one byte; a reply, or why there is none, comes out with the byte that completes the line.
    ///
    /// BEL in the middle of a line ends it: what stood there is dropped.
    pub fn push(&mut self, byte: u8) -> Option<Result<SlcanReply, SlcanError>> {
        Some(match self.lines.push(byte)? {
            LineEvent::Line(line) => SlcanReply::parse(&line),
            LineEvent::Bell => Ok(SlcanReply::Refused),
            LineEvent::Dropped(error) => Err(error),
        })
    }
}
