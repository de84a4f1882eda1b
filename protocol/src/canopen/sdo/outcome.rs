//! Results and errors of SDO transfers.

use thiserror::Error;

use super::TransferDirection;
use crate::Bounded;
use crate::canopen::AbortCode;
use crate::canopen::error::MessageError;
use crate::canopen::{Address, Scalar};

/// Reason why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TransferError {
    /// The node aborted the transfer.
    #[error("SDO: aborted by the node: {0}")]
    Aborted(AbortCode),
    /// No response within the time limit.
    #[error("SDO: no response in time, expected {expected}")]
    Timeout {
        /// The expected response.
        expected: &'static str,
    },
    /// A response about another object.
    #[error("SDO: response about object {got}, expected {expected}")]
    OtherObject {
        /// The object of this transfer.
        expected: Address,
        /// The object of the response.
        got: Address,
    },
    /// The toggle bit of a segment did not alternate: a segment was lost or duplicated.
    #[error("SDO: toggle bit {}, expected {}", u8::from(*got), u8::from(*expected))]
    Toggle {
        /// As in the request.
        expected: bool,
        /// As in the response.
        got: bool,
    },
    /// A response of another service.
    #[error("SDO: command byte {got:02X}, expected {expected}")]
    Unexpected {
        /// The expected response.
        expected: &'static str,
        /// First byte of the response.
        got: u8,
    },
    /// The number of bytes differs from the indicated size or from the object's type.
    #[error("SDO: {got} bytes, expected {expected}")]
    Size {
        /// Bytes indicated, or of the type.
        expected: usize,
        /// Bytes received, so far if already too many.
        got: usize,
    },
    /// The object exceeds the client's buffer.
    #[error("SDO: {got} bytes, expected at most {max}")]
    TooLong {
        /// Capacity of the buffer in bytes.
        max: usize,
        /// Bytes indicated, or received so far.
        got: usize,
    },
    /// An empty segment that is not the last, so that the transfer might never end, or whose
    /// transfer has no size, so that missing bytes would not be noticed.
    #[error("SDO: empty segment, expected data")]
    EmptySegment,
    /// The caller cancelled the transfer.
    #[error("SDO: cancelled")]
    Cancelled,
    /// A frame with the response's identifier that is not an SDO message.
    #[error(transparent)]
    Message(#[from] MessageError),
}

impl TransferError {
    /// The abort code to send to the node; `None` if the node itself aborted.
    #[must_use]
    pub const fn abort_code(&self) -> Option<AbortCode> {
        match self {
            Self::Aborted(_) => None,
            Self::Timeout { .. } => Some(AbortCode::TIMEOUT),
            Self::Toggle { .. } => Some(AbortCode::TOGGLE),
            Self::Size { .. } => Some(AbortCode::LENGTH),
            Self::TooLong { .. } => Some(AbortCode::MEMORY),
            Self::Cancelled => Some(AbortCode::GENERAL),
            Self::OtherObject { .. }
            | Self::Unexpected { .. }
            | Self::EmptySegment
            | Self::Message(_) => Some(AbortCode::COMMAND),
        }
    }

    /// Whether the matching response may still arrive.
    pub(super) const fn leaves_response(&self) -> bool {
        matches!(
            self,
            Self::Timeout { .. }
                | Self::OtherObject { .. }
                | Self::Unexpected { .. }
                | Self::Cancelled
                | Self::Message(_)
        )
    }
}

/// Reason why a transfer could not be started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum StartError {
    /// Another transfer is active, or its outcome has not been taken.
    #[error("SDO: transfer of object {address} is active or its outcome not yet taken")]
    Busy {
        /// Its object.
        address: Address,
    },
    /// The data exceeds the client's buffer.
    #[error("SDO: {got} bytes to write, expected at most {max}")]
    TooLong {
        /// Capacity of the buffer in bytes.
        max: usize,
        /// Bytes to write.
        got: usize,
    },
}

/// Data read from an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SdoValue<const N: usize> {
    /// The bytes.
    pub bytes: Bounded<u8, N>,
    /// Whether `bytes` has the object's length. Otherwise the node sent four bytes without a size.
    pub sized: bool,
}

impl<const N: usize> SdoValue<N> {
    /// The value of an object of type `T`.
    ///
    /// # Errors
    /// [`TransferError::Size`] if the number of bytes does not match.
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

/// Result of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SdoOutcome<const N: usize> {
    /// The object.
    pub address: Address,
    /// Read or written.
    pub direction: TransferDirection,
    /// The data read (empty for a write), or the error.
    pub result: Result<SdoValue<N>, TransferError>,
}

/// The client's handling of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameDisposition {
    /// Not an SDO response of this node.
    Foreign,
    /// Used by the transfer, which may have ended.
    Accepted,
    /// Dropped: the response to a transfer given up earlier.
    Stale,
    /// Dropped: no request is outstanding.
    Unsolicited,
}
