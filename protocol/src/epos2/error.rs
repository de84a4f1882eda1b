//! What can be wrong with a frame or with the message in it.

use thiserror::Error;

/// Where in the stack of formats an error was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SerialLayer {
    /// `90 02` framing with byte stuffing.
    Usb,
    /// RS232 body after its handshake.
    Rs232,
    /// The words of a frame.
    Message,
}

impl core::fmt::Display for SerialLayer {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Usb => "EPOS2 USB frame",
            Self::Rs232 => "EPOS2 RS232 frame",
            Self::Message => "EPOS2 message",
        })
    }
}

/// Why bytes are no frame, or a frame is not the message it was taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum SerialFrameError {
    /// The checksum does not match.
    #[error("{layer}: CRC at byte {offset} is {got:04X}, the content gives {expected:04X}")]
    Crc {
        /// USB or RS232.
        layer: SerialLayer,
        /// Bytes of the frame before the CRC, without stuffing.
        offset: usize,
        /// The checksum of the content.
        expected: u16,
        /// The checksum in the frame.
        got: u16,
    },
    /// A new frame began before this one was complete.
    #[error("{layer}: broken off after {got} bytes of {expected}")]
    BrokenOff {
        /// USB.
        layer: SerialLayer,
        /// Bytes it should have had, without stuffing; 4 where its length had not come yet.
        expected: usize,
        /// Bytes that came, without stuffing.
        got: usize,
    },
    /// A 0x90 followed by something that is neither 0x90 (stuffing) nor 0x02 (a new frame).
    #[error("{layer}: 90 at byte {offset} is followed by {got:02X} instead of 90 or 02")]
    Stuffing {
        /// USB.
        layer: SerialLayer,
        /// Bytes before it, without stuffing.
        offset: usize,
        /// What followed.
        got: u8,
    },
    /// More words than any EPOS2 frame has.
    #[error("{layer}: length at byte {offset} says {got} words, frames have at most {max}")]
    TooLong {
        /// USB, RS232 or message.
        layer: SerialLayer,
        /// Where the length stands, without stuffing.
        offset: usize,
        /// The longest there is.
        max: usize,
        /// Words announced or given.
        got: usize,
    },
    /// Another number of words than this command has.
    #[error("{layer}: {got} words, expected {expected}")]
    WordCount {
        /// Message.
        layer: SerialLayer,
        /// The number this command has (the smallest, if it varies).
        expected: usize,
        /// The number in the frame.
        got: usize,
    },
    /// Another command than the one expected.
    #[error("{layer}: opcode {got:02X}, expected {expected:02X}")]
    Opcode {
        /// Message.
        layer: SerialLayer,
        /// Opcode of the message asked for.
        expected: u8,
        /// Opcode in the frame.
        got: u8,
    },
}
