//! Errors of CAN frames and of the messages in them.

use thiserror::Error;

use super::frame::{CanFrame, CanId};

/// The kind of message in which an error was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CanopenLayer {
    /// Network management.
    Nmt,
    /// Synchronisation.
    Sync,
    /// Emergency.
    Emergency,
    /// Process data.
    Pdo,
    /// Service data, from client to server.
    SdoRequest,
    /// Service data, from server to client.
    SdoResponse,
    /// Boot-up and heartbeat.
    Heartbeat,
}

impl core::fmt::Display for CanopenLayer {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Nmt => "NMT message",
            Self::Sync => "SYNC message",
            Self::Emergency => "EMCY message",
            Self::Pdo => "PDO",
            Self::SdoRequest => "SDO request",
            Self::SdoResponse => "SDO answer",
            Self::Heartbeat => "heartbeat",
        })
    }
}

/// Reason why bytes are not a CAN frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum CanFrameError {
    /// More data than in a classic frame, or a data length code above 8.
    #[error("CAN frame: length at byte {offset} is {got}, expected at most {max}")]
    TooLong {
        /// Offset of the length in a `struct can_frame`.
        offset: usize,
        /// 8.
        max: usize,
        /// Bytes given or announced.
        got: usize,
    },
    /// Fewer bytes than the header or the announced data.
    #[error("CAN frame: {got} bytes, expected {expected}")]
    Short {
        /// Bytes of the whole frame.
        expected: usize,
        /// Bytes given.
        got: usize,
    },
    /// Bits above the 11 of a standard identifier are set.
    #[error(
        "CAN frame: identifier word at byte 0 is {got:08X}, expected 11 bits without the extended flag"
    )]
    Id {
        /// The identifier word, flags included.
        got: u32,
    },
    /// A CAN FD frame.
    #[error("CAN frame: flags at byte {offset} are {got:02X}: CAN FD, expected a classic frame")]
    Fd {
        /// Offset of the flags.
        offset: usize,
        /// The flags.
        got: u8,
    },
    /// An error report of the controller, not a frame of the bus.
    #[error(
        "CAN frame: identifier word at byte 0 is {got:08X}: an error report of the controller, expected a frame"
    )]
    Report {
        /// The identifier word, flags included: its low bits are the error class.
        got: u32,
    },
}

/// Reason why a CAN frame is not a message of the expected kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum MessageError {
    /// The identifier belongs to another service.
    #[error("{layer}: CAN id {got}, expected {expected}")]
    Id {
        /// The service.
        layer: CanopenLayer,
        /// Its identifiers.
        expected: &'static str,
        /// The identifier of the frame.
        got: CanId,
    },
    /// A remote frame; the service has data frames only.
    #[error("{layer}: a remote frame, expected data")]
    Remote {
        /// The service.
        layer: CanopenLayer,
    },
    /// The number of data bytes is wrong.
    #[error("{layer}: {got} data bytes, expected {expected}")]
    Length {
        /// The service.
        layer: CanopenLayer,
        /// The number of the message.
        expected: usize,
        /// The number in the frame.
        got: usize,
    },
    /// A byte has no meaning.
    #[error("{layer}: data byte {offset} is {got:02X}, expected {expected}")]
    Value {
        /// The service.
        layer: CanopenLayer,
        /// Offset of the data byte.
        offset: usize,
        /// Permitted values.
        expected: &'static str,
        /// The value.
        got: u8,
    },
}

/// The data of a frame that must have `N` bytes of it.
pub(super) fn data<const N: usize>(
    layer: CanopenLayer,
    frame: &CanFrame,
) -> Result<&[u8; N], MessageError> {
    if frame.is_remote() {
        return Err(MessageError::Remote { layer });
    }
    frame.data().try_into().map_err(|_| MessageError::Length {
        layer,
        expected: N,
        got: frame.data().len(),
    })
}

/// The error of a frame with the identifier of another service.
pub(super) fn wrong_id(
    layer: CanopenLayer,
    expected: &'static str,
    frame: &CanFrame,
) -> MessageError {
    MessageError::Id {
        layer,
        expected,
        got: frame.id(),
    }
}
