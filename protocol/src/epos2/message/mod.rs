//! The commands of the serial interfaces, encode and parse together (Communication Guide, "Command
//! Reference").
//!
//! An answer names neither its command nor its object: the client pairs it with a request. Words
//! that a command does not use are ignored, since a real drive fills them with garbage.

mod bus;
mod object;
mod segmented;

pub use bus::{GatewayNmt, RequestCanFrame, SendCanFrame};
pub use object::{ReadObject, WriteObject};
pub use segmented::{
    InitiateSegmentedRead, InitiateSegmentedWrite, ReadSegment, SegmentedRead, SegmentedWrite,
    WriteSegment,
};

use super::AbortCode;
use super::error::{SerialFrameError, SerialLayer};
use super::frame::{SerialFrame, Words};
use crate::canopen::Address;

/// Implements a command of fixed length: its opcode, its words, and the command of these words.
macro_rules! command {
    ($name:ident = $opcode:literal, $words:expr, $parse:expr) => {
        impl $name {
            /// Opcode of the command.
            pub const OPCODE: u8 = $opcode;

            /// The request as a frame.
            #[must_use]
            pub fn to_frame(&self) -> crate::epos2::SerialFrame {
                crate::epos2::SerialFrame::of(Self::OPCODE, $words(self))
            }

            /// The request in `frame`.
            ///
            /// # Errors
            /// [`SerialFrameError::Opcode`](crate::epos2::SerialFrameError::Opcode),
            /// [`SerialFrameError::WordCount`](crate::epos2::SerialFrameError::WordCount).
            pub fn parse(
                frame: &crate::epos2::SerialFrame,
            ) -> Result<Self, crate::epos2::SerialFrameError> {
                frame.exactly(Self::OPCODE).map($parse)
            }
        }
    };
}
use command;

/// Defines the enum of all requests and its parser.
macro_rules! requests {
    ($($name:ident),*) => {
        /// Any request that a drive knows.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum SerialRequest {
            $(#[doc = concat!("[`", stringify!($name), "`].")] $name($name),)*
        }

        impl SerialRequest {
            /// The opcodes of all requests.
            pub const OPCODES: [u8; 9] = [$($name::OPCODE),*];

            /// The request in `frame`; `None` for an opcode that the guide does not list.
            ///
            /// # Errors
            /// [`SerialFrameError::WordCount`] where the command has another number of words.
            pub fn parse(frame: &SerialFrame) -> Result<Option<Self>, SerialFrameError> {
                Ok(Some(match frame.opcode {
                    $($name::OPCODE => Self::$name($name::parse(frame)?),)*
                    _ => return Ok(None),
                }))
            }

            /// The request as a frame.
            #[must_use]
            pub fn to_frame(&self) -> SerialFrame {
                match self {
                    $(Self::$name(request) => request.to_frame(),)*
                }
            }
        }
    };
}
requests!(
    ReadObject,
    WriteObject,
    InitiateSegmentedRead,
    InitiateSegmentedWrite,
    SegmentedRead,
    SegmentedWrite,
    GatewayNmt,
    SendCanFrame,
    RequestCanFrame
);

/// An answer to any command: an error code, then the command's data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SerialAnswer {
    /// Whether the command was carried out.
    pub error: AbortCode,
    /// The words after the error code, garbage included.
    pub data: Words,
}

impl SerialAnswer {
    /// An answer without data.
    #[must_use]
    pub fn bare(error: AbortCode) -> Self {
        let data = Words::new();
        Self { error, data }
    }

    /// The answer in `frame`.
    ///
    /// # Errors
    /// [`SerialFrameError::Opcode`] for a request (an echo, for instance),
    /// [`SerialFrameError::WordCount`] below two words.
    pub fn parse(frame: &SerialFrame) -> Result<Self, SerialFrameError> {
        frame.expect_opcode(SerialFrame::ANSWER)?;
        let [low, high, data @ ..] = frame.words.as_slice() else {
            return Err(word_count(2, frame.words.len()));
        };
        Ok(Self {
            error: AbortCode::from_words(*low, *high),
            data: data.iter().copied().collect(),
        })
    }

    /// The answer as a frame; data that does not fit is cut off.
    #[must_use]
    pub fn to_frame(&self) -> SerialFrame {
        let mut frame = SerialFrame::of(SerialFrame::ANSWER, self.error.to_words());
        frame.words.extend(self.data);
        frame
    }

    /// The data as one number, low word first: the value of a read object command. The bits above
    /// the width of the object are garbage.
    ///
    /// # Errors
    /// [`SerialFrameError::WordCount`] below two data words.
    pub fn value(&self) -> Result<u32, SerialFrameError> {
        match self.data.as_slice() {
            [low, high, ..] => Ok(dword(*low, *high)),
            short => Err(word_count(4, 2 + short.len())),
        }
    }

    /// The frame that answers with the data of a success, or with the error of a failure.
    fn of<D: IntoIterator<Item = u16>>(outcome: Result<D, AbortCode>) -> SerialFrame {
        let mut answer = Self::bare(AbortCode::NONE);
        match outcome {
            Ok(data) => answer.data.extend(data),
            Err(error) => answer.error = error,
        }
        answer.to_frame()
    }

    /// The result of `read` on an answer of success; the inner error is that of the drive.
    fn read<T>(
        frame: &SerialFrame,
        read: impl FnOnce(&Self) -> Result<T, SerialFrameError>,
    ) -> Result<Result<T, AbortCode>, SerialFrameError> {
        let answer = Self::parse(frame)?;
        if answer.error.is_none() {
            read(&answer).map(Ok)
        } else {
            Ok(Err(answer.error))
        }
    }
}

fn word_count(expected: usize, got: usize) -> SerialFrameError {
    SerialFrameError::WordCount {
        layer: SerialLayer::Message,
        expected,
        got,
    }
}

/// The two words that name an object of a node.
fn target(node: u8, address: Address) -> [u16; 2] {
    [address.index, u16::from_be_bytes([node, address.sub])]
}

/// Node and address of the two words that name an object.
fn parse_target(index: u16, node_sub: u16) -> (u8, Address) {
    let [node, sub] = node_sub.to_be_bytes();
    (node, Address { index, sub })
}

/// The words of an object of a node and a number, low word first.
fn target_and_number(node: u8, address: Address, number: u32) -> [u16; 4] {
    let [index, node_sub] = target(node, address);
    [index, node_sub, number as u16, (number >> 16) as u16]
}

/// The number of a low and a high word.
fn dword(low: u16, high: u16) -> u32 {
    AbortCode::from_words(low, high).0
}
