//! Errors of SDO transfers.

use thiserror::Error;

use crate::canopen::AbortCode;
use crate::canopen::Address;

/// Reason why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TransferError {
    /// The node aborted the transfer.
    #[error("SDO: aborted by the node: {0}")]
    Aborted(AbortCode),
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
        /// Toggle bit of the request.
        expected: bool,
        /// Toggle bit of the response.
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
    /// The number of bytes differs from the indicated size.
    #[error("SDO: {got} bytes, expected {expected}")]
    Size {
        /// Bytes indicated.
        expected: usize,
        /// Bytes received, so far if already too many.
        got: usize,
    },
    /// The object exceeds the buffer of the transfer.
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
}

impl TransferError {
    /// The abort code to send to the node; `None` if the node itself aborted.
    #[must_use]
    pub const fn abort_code(&self) -> Option<AbortCode> {
        match self {
            Self::Aborted(_) => None,
            Self::Toggle { .. } => Some(AbortCode::TOGGLE),
            Self::Size { .. } => Some(AbortCode::LENGTH),
            Self::TooLong { .. } => Some(AbortCode::MEMORY),
            Self::OtherObject { .. } | Self::Unexpected { .. } | Self::EmptySegment => {
                Some(AbortCode::COMMAND)
            }
        }
    }
}
