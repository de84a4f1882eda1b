//! Commands of the host to an adapter.

use super::error::SlcanError;
use super::frame::{parse_frame, write_frame};
use super::line::{CR, Line, LineAssembler, LineEvent, length};
use crate::canopen::frame::CanFrame;

/// The nine standard bit rates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Bitrate {
    /// S0.
    Kbit10,
    /// S1.
    Kbit20,
    /// S2.
    Kbit50,
    /// S3.
    Kbit100,
    /// S4.
    Kbit125,
    /// S5.
    Kbit250,
    /// S6.
    Kbit500,
    /// S7.
    Kbit800,
    /// S8: the factory setting of an EPOS2.
    Kbit1000,
}

impl Bitrate {
    /// All, in the order of their digits.
    pub const ALL: [Self; 9] = [
        Self::Kbit10,
        Self::Kbit20,
        Self::Kbit50,
        Self::Kbit100,
        Self::Kbit125,
        Self::Kbit250,
        Self::Kbit500,
        Self::Kbit800,
        Self::Kbit1000,
    ];

    /// The digit after `S`.
    const fn digit(self) -> u8 {
        b'0' + self as u8
    }

    fn from_digit(digit: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|rate| rate.digit() == digit)
    }
}

/// A line from host to adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlcanCommand {
    /// CR alone: ends a partial line in the adapter.
    Empty,
    /// `S`: sets the bit rate; the channel must be closed.
    Bitrate(Bitrate),
    /// `O`: opens the channel.
    Open,
    /// `L`: opens the channel, listening only.
    OpenListening,
    /// `C`: closes the channel.
    Close,
    /// `V`: queries the version.
    Version,
    /// `N`: queries the serial number.
    SerialNumber,
    /// `F`: queries the status flags.
    Status,
    /// `Z0`, `Z1`: time stamps of received frames.
    Stamps(bool),
    /// `t`, `T`, `r`, `R`: sends a frame.
    Transmit(CanFrame),
    /// Anything else.
    Unknown(Line),
}

impl SlcanCommand {
    /// Writes the line, its CR included.
    pub fn encode(&self, out: &mut impl Extend<u8>) {
        match self {
            Self::Empty => {}
            Self::Bitrate(rate) => out.extend([b'S', rate.digit()]),
            Self::Open => out.extend([b'O']),
            Self::OpenListening => out.extend([b'L']),
            Self::Close => out.extend([b'C']),
            Self::Version => out.extend([b'V']),
            Self::SerialNumber => out.extend([b'N']),
            Self::Status => out.extend([b'F']),
            Self::Stamps(on) => out.extend([b'Z', b'0' + u8::from(*on)]),
            Self::Transmit(frame) => write_frame(frame, out),
            Self::Unknown(line) => out.extend(line.iter().copied()),
        }
        out.extend([CR]);
    }

    /// The command of a line without its CR.
    ///
    /// # Errors
    /// [`SlcanError`] for an invalid frame or bit rate.
    pub fn parse(line: &Line) -> Result<Self, SlcanError> {
        Ok(match line.as_slice() {
            [] => Self::Empty,
            [b'S', digits @ ..] => {
                length(line, 2)?;
                let got = digits.first().copied().unwrap_or_default();
                Self::Bitrate(Bitrate::from_digit(got).ok_or(SlcanError::Character {
                    offset: 1,
                    expected: "0 to 8",
                    got,
                })?)
            }
            [b'O'] => Self::Open,
            [b'L'] => Self::OpenListening,
            [b'C'] => Self::Close,
            [b'V'] => Self::Version,
            [b'N'] => Self::SerialNumber,
            [b'F'] => Self::Status,
            [b'Z', b'0'] => Self::Stamps(false),
            [b'Z', b'1'] => Self::Stamps(true),
            [b't' | b'T' | b'r' | b'R', ..] => match parse_frame(line)? {
                (frame, None) => Self::Transmit(frame),
                // Frames of a host have no time stamps.
                (_, Some(_)) => {
                    return Err(SlcanError::Length {
                        expected: line.len() - 4,
                        got: line.len(),
                    });
                }
            },
            _ => Self::Unknown(*line),
        })
    }
}

/// Decodes a stream of bytes into commands, for an adapter.
#[derive(Clone, Debug, Default)]
pub struct CommandDecoder {
    lines: LineAssembler,
}

impl CommandDecoder {
    /// A decoder between lines.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes one byte; a command or an error comes out with the byte that completes the line.
    pub fn push(&mut self, byte: u8) -> Option<Result<SlcanCommand, SlcanError>> {
        match self.lines.push(byte)? {
            LineEvent::Line(line) => Some(SlcanCommand::parse(&line)),
            LineEvent::Dropped(error) => Some(Err(error)),
            // Hosts do not send BEL: noise.
            LineEvent::Bell => None,
        }
    }
}
