//! SDO, service data objects (CiA 301, "SDO services"): one entry of a node's object dictionary read or written.
//!
//! A client asks ([`Request`]), the node answers ([`Answer`]); up to four bytes travel in the first exchange (expedited),
//! more in segments of seven. [`SdoClient`] is the client's side as a machine without I/O. Block transfer is not looked
//! into: its messages are `Unknown`, and a node answers them with [`crate::epos2::CommError::COMMAND`].

mod answer;
mod client;
mod outcome;
mod request;
mod step;
mod transfer;

pub use answer::Answer;
pub use client::SdoClient;
pub use outcome::{Access, Handled, Outcome, StartError, TransferError, Value};
pub use request::Request;
pub use transfer::{Expedited, Initiate, Segment};

use crate::epos2::objects::Address;

/// Data bytes of every SDO message.
const LEN: usize = 8;
/// Command specifier of an abort, in both directions.
const ABORT: u8 = 4;

/// A command specifier in its place.
const fn command(specifier: u8) -> u8 {
    specifier << 5
}

/// The object that the bytes after the command name.
const fn address(index_low: u8, index_high: u8, sub: u8) -> Address {
    Address::new(u16::from_le_bytes([index_low, index_high]), sub)
}

/// A message of a command byte, an object and four bytes.
const fn message(command: u8, address: Address, data: [u8; 4]) -> [u8; LEN] {
    let [low, high] = address.index.to_le_bytes();
    let [a, b, c, d] = data;
    [command, low, high, address.sub, a, b, c, d]
}

#[cfg(test)]
mod tests;
