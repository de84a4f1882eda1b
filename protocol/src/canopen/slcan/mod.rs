//! SLCAN, the Lawicel ASCII protocol (LAWICEL CAN232 and CANUSB manuals): CAN frames as lines of
//! text on a serial port.
//!
//! A line is a letter with its arguments and ends with CR; an adapter rejects a command with BEL. A
//! host writes [`SlcanCommand`]s and reads [`SlcanReply`]s, an adapter does the reverse. Adapters
//! differ: CANUSB answers each command with CR, a frame with `z` CR or `Z` CR; CANable answers
//! nothing. The caller handles missing answers. Register settings, filters and CAN FD extensions
//! are `Unknown` lines.

mod command;
mod error;
mod frame;
mod line;
mod reply;

pub use command::{Bitrate, CommandDecoder, SlcanCommand};
pub use error::SlcanError;
pub use line::{BEL, CR, Line, MAX_LINE};
pub use reply::{ReplyDecoder, SlcanReply};

#[cfg(test)]
mod tests;
