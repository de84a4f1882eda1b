//! Replies of an adapter to its host: answers to commands, and frames of the bus at any time.

use super::error::SlcanError;
use super::frame::{parse_frame, write_frame};
use super::line::{BEL, CR, Line, LineAssembler, LineEvent, length, number, text, write_number};
use crate::canopen::frame::CanFrame;

/// A line from adapter to host, or BEL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlcanReply {
    /// CR alone: confirmed.
    Done,
    /// BEL: rejected.
    Refused,
    /// `z`: a frame with an 11-bit identifier was sent.
    Sent,
    /// `Z`: a frame with a 29-bit identifier was sent.
    SentExtended,
    /// A frame of the bus.
    Received {
        /// The frame.
        frame: CanFrame,
        /// Time stamp of the adapter in milliseconds within a minute, if enabled.
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
    /// [`SlcanError`] for an invalid frame or invalid flags.
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

/// Decodes a stream of bytes into replies, for a host.
#[derive(Clone, Debug, Default)]
pub struct ReplyDecoder {
    lines: LineAssembler,
}

impl ReplyDecoder {
    /// A decoder between lines.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes one byte; a reply or an error comes out with the byte that completes the line. BEL
    /// drops a partial line.
    pub fn push(&mut self, byte: u8) -> Option<Result<SlcanReply, SlcanError>> {
        Some(match self.lines.push(byte)? {
            LineEvent::Line(line) => SlcanReply::parse(&line),
            LineEvent::Bell => Ok(SlcanReply::Refused),
            LineEvent::Dropped(error) => Err(error),
        })
    }
}
