//! Reason why bytes are not a packet of this family.

use thiserror::Error;

/// Bytes that are not the packet they were taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum PacketError {
    /// The payload's length is not the packet's.
    #[error("{layer}: expected {expected} bytes, got {got}")]
    Length {
        /// Kind of packet it was taken for.
        layer: &'static str,
        /// Length of such a packet in bytes.
        expected: usize,
        /// Length found in bytes.
        got: usize,
    },
    /// A block does not open with `FF EE`.
    #[error("{layer} offset {offset}: expected block flag FF EE, got {:02X} {:02X}", got[0], got[1])]
    BlockFlag {
        /// Kind of packet it was taken for.
        layer: &'static str,
        /// Offset of the flag in the payload in bytes.
        offset: usize,
        /// The two bytes found.
        got: [u8; 2],
    },
    /// A block's azimuth exceeds a full revolution.
    #[error(
        "{layer} offset {offset}: expected an azimuth of 0 to 36000 hundredths of a degree, got {got}"
    )]
    Azimuth {
        /// Kind of packet it was taken for.
        layer: &'static str,
        /// Offset of the azimuth in the payload in bytes.
        offset: usize,
        /// The azimuth found, in hundredths of a degree.
        got: u16,
    },
}
