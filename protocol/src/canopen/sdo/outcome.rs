//! How an SDO transfer begins, goes and ends for its client: what was read, or why not.

use thiserror::Error;

use crate::canopen::error::MessageError;
use crate::epos2::objects::{Address, Scalar};
use crate::epos2::{Bounded, CommError};

/// Which way a transfer goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// The object is read ("upload").
    Read,
    /// The object is written ("download").
    Write,
}

/// Why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TransferError {
    /// The node refused or broke off.
    #[error("SDO: the node aborted: {0}")]
    Aborted(CommError),
    /// No answer in time.
    #[error("SDO: no answer in time, expected {expected}")]
    Timeout {
        /// Which answer.
        expected: &'static str,
    },
    /// An answer to a question about another object.
    #[error("SDO: an answer about {got}, expected {expected}")]
    OtherObject {
        /// The object of this transfer.
        expected: Address,
        /// The object of the answer.
        got: Address,
    },
    /// The toggle bit of a segment did not alternate: one was lost or came twice.
    #[error("SDO: toggle bit {}, expected {}", u8::from(*got), u8::from(*expected))]
    Toggle {
        /// As in the request.
        expected: bool,
        /// As in the answer.
        got: bool,
    },
    /// An answer of another kind.
    #[error("SDO: command byte {got:02X}, expected {expected}")]
    Unexpected {
        /// Which answer.
        expected: &'static str,
        /// First byte of the one that came.
        got: u8,
    },
    /// Another number of bytes than was announced, or than the object's type has.
    #[error("SDO: {got} bytes, expected {expected}")]
    Size {
        /// Bytes announced, or of the type.
        expected: usize,
        /// Bytes that came (so far, where they are already too many).
        got: usize,
    },
    /// The object is longer than there is room for.
    #[error("SDO: {got} bytes, expected at most {max}")]
    TooLong {
        /// Bytes of room.
        max: usize,
        /// Bytes announced, or that came so far.
        got: usize,
    },
    /// A segment without a byte that is not the last: such a transfer need not end.
    #[error("SDO: an empty segment, expected data or the end")]
    EmptySegment,
    /// The caller broke off.
    #[error("SDO: cancelled")]
    Cancelled,
    /// A frame on the answer's identifier that is no SDO message.
    #[error(transparent)]
    BusMessage(#[from] MessageError),
}

impl TransferError {
    /// What the node is told when the client breaks off; `None` where the node knows already.
    pub(super) const fn abort_code(&self) -> Option<CommError> {
        match self {
            Self::Aborted(_) => None,
            Self::Timeout { .. } => Some(CommError::TIMEOUT),
            Self::Toggle { .. } => Some(CommError::TOGGLE),
            Self::Size { .. } => Some(CommError::LENGTH),
            Self::TooLong { .. } => Some(CommError::MEMORY),
            Self::Cancelled => Some(CommError::GENERAL),
            Self::OtherObject { .. }
            | Self::Unexpected { .. }
            | Self::EmptySegment
            | Self::BusMessage(_) => Some(CommError::COMMAND),
        }
    }

    /// Whether the right answer may come after all.
    pub(super) const fn leaves_answer(&self) -> bool {
        matches!(
            self,
            Self::Timeout { .. }
                | Self::OtherObject { .. }
                | Self::Unexpected { .. }
                | Self::Cancelled
                | Self::BusMessage(_)
        )
    }
}

/// Why a transfer was not begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum StartError {
    /// Another is under way, or its outcome has not been fetched.
    #[error("SDO: a transfer of {address} is under way or not fetched")]
    Busy {
        /// Its object.
        address: Address,
    },
    /// More data than there is room for.
    #[error("SDO: {got} bytes to write, expected at most {max}")]
    TooLong {
        /// Bytes of room.
        max: usize,
        /// Bytes given.
        got: usize,
    },
}

/// What was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Value<const N: usize> {
    /// The bytes.
    pub bytes: Bounded<u8, N>,
    /// Their number is the object's. Otherwise the node sent four bytes without saying how many count.
    pub sized: bool,
}

impl<const N: usize> Value<N> {
    /// The value of an object of type `T`.
    ///
    /// # Errors
    /// [`TransferError::Size`] where it has another number of bytes.
    pub fn scalar<T: Scalar>(&self) -> Result<T, TransferError> {
        let expected = usize::from(T::BYTES);
        let got = self.bytes.len();
        if got < expected || (self.sized && got > expected) {
            return Err(TransferError::Size { expected, got });
        }
        let raw = self.bytes.iter().take(expected).rev();
        Ok(T::from_raw(
            raw.fold(0, |raw, byte| raw << 8 | u32::from(*byte)),
        ))
    }
}

/// How a transfer ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome<const N: usize> {
    /// The object.
    pub address: Address,
    /// Read or written.
    pub access: Access,
    /// What was read (nothing for a write), or why it failed.
    pub result: Result<Value<N>, TransferError>,
}

/// What a frame was to the client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handled {
    /// No SDO answer of this node.
    Foreign,
    /// It moved the transfer on, to its end perhaps.
    Taken,
    /// The answer to a transfer that had been given up. It was dropped.
    Late,
    /// An answer, but nothing was asked. It was dropped.
    Unasked,
}
