//! Errors of a frame and of the message in it.

use thiserror::Error;

/// The layer in which an error was found.
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

/// Reason why bytes are not a frame, or a frame is not the expected message.
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
        /// Bytes of the whole frame, without stuffing; 4 before its length is known.
        expected: usize,
        /// Bytes received, without stuffing.
        got: usize,
    },
    /// 0x90 is followed by neither 0x90 (stuffing) nor 0x02 (a new frame).
    #[error("{layer}: 90 at byte {offset} is followed by {got:02X} instead of 90 or 02")]
    Stuffing {
        /// USB.
        layer: SerialLayer,
        /// Bytes before it, without stuffing.
        offset: usize,
        /// The byte that follows.
        got: u8,
    },
    /// More words than in any EPOS2 frame.
    #[error("{layer}: length at byte {offset} says {got} words, frames have at most {max}")]
    TooLong {
        /// USB, RS232 or message.
        layer: SerialLayer,
        /// Offset of the length, without stuffing.
        offset: usize,
        /// The largest number of words.
        max: usize,
        /// Words announced or given.
        got: usize,
    },
    /// The number of words is wrong for this command.
    #[error("{layer}: {got} words, expected {expected}")]
    WordCount {
        /// Message.
        layer: SerialLayer,
        /// The correct number (the smallest, if it varies).
        expected: usize,
        /// The number in the frame.
        got: usize,
    },
    /// The opcode is not the expected one.
    #[error("{layer}: opcode {got:02X}, expected {expected:02X}")]
    Opcode {
        /// Message.
        layer: SerialLayer,
        /// The expected opcode.
        expected: u8,
        /// Opcode in the frame.
        got: u8,
    },
}
