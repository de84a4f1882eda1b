//! What can be wrong with a CAN frame or with the message in it.

use thiserror::Error;

use super::frame::{CanFrame, CanId};

/// Which service's message an error was found in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageKind {
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
    SdoAnswer,
    /// Boot-up and heartbeat.
    Heartbeat,
}

impl core::fmt::Display for MessageKind {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Nmt => "NMT message",
            Self::Sync => "SYNC message",
            Self::Emergency => "EMCY message",
            Self::Pdo => "PDO",
            Self::SdoRequest => "SDO request",
            Self::SdoAnswer => "SDO answer",
            Self::Heartbeat => "heartbeat",
        })
    }
}

/// Why bytes are no CAN frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum CanFrameError {
    /// More data than a classic frame has, or a data length code above 8.
    #[error("CAN frame: length at byte {offset} is {got}, expected at most {max}")]
    TooLong {
        /// Where the length stands in a `struct can_frame`.
        offset: usize,
        /// 8.
        max: usize,
        /// Bytes given or announced.
        got: usize,
    },
    /// Fewer bytes than the frame announces or its head has.
    #[error("CAN frame: {got} bytes, expected {expected}")]
    Short {
        /// Bytes it should have.
        expected: usize,
        /// Bytes there are.
        got: usize,
    },
    /// A frame with an 11-bit identifier has bits above these.
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
        /// Where the flags stand.
        offset: usize,
        /// The flags.
        got: u8,
    },
    /// The controller's report of an error on the bus, no frame from it.
    #[error(
        "CAN frame: identifier word at byte 0 is {got:08X}: an error report of the controller, expected a frame"
    )]
    Report {
        /// The identifier word, flags included: its low bits are the class of the error.
        got: u32,
    },
}

/// Why a CAN frame is not the message it was taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum MessageError {
    /// Another identifier than this service's.
    #[error("{layer}: CAN id {got}, expected {expected}")]
    Id {
        /// The service.
        layer: MessageKind,
        /// Its identifiers.
        expected: &'static str,
        /// The frame's.
        got: CanId,
    },
    /// A remote frame: it asks, where this service's message tells.
    #[error("{layer}: a remote frame, expected data")]
    Remote {
        /// The service.
        layer: MessageKind,
    },
    /// Another number of data bytes than the message has.
    #[error("{layer}: {got} data bytes, expected {expected}")]
    Length {
        /// The service.
        layer: MessageKind,
        /// The number it has.
        expected: usize,
        /// The number in the frame.
        got: usize,
    },
    /// A byte that has no meaning there.
    #[error("{layer}: data byte {offset} is {got:02X}, expected {expected}")]
    Value {
        /// The service.
        layer: MessageKind,
        /// Which data byte.
        offset: usize,
        /// What may stand there.
        expected: &'static str,
        /// What does.
        got: u8,
    },
}

/// The data of a frame that must have `N` bytes of it.
pub(super) fn data<const N: usize>(
    layer: MessageKind,
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
    layer: MessageKind,
    expected: &'static str,
    frame: &CanFrame,
) -> MessageError {
    MessageError::Id {
        layer,
        expected,
        got: frame.id(),
    }
}
