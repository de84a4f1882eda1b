//! SDO, service data objects (CiA 301, "SDO services"): access to one entry of a node's object
//! dictionary.
//!
//! The client sends an [`SdoRequest`], the node's server returns an [`SdoResponse`]. Up to four
//! bytes travel in the first exchange (expedited transfer), more in segments of seven (segmented
//! transfer). [`SdoTransfer`] holds the rules of one transfer as a state machine without I/O; the
//! caller sends, receives and keeps time. Block transfer is not supported: its messages are
//! `Unknown`, and a node aborts them with
//! [`AbortCode::COMMAND`](crate::canopen::AbortCode::COMMAND).
//!
//! [`SdoTransfer`] is generic over the capacity of a segment: the EPOS2 carries the same transfers
//! over its serial links, in segments of up to 63 bytes.

/// Conversion of an SDO message to and from a CAN frame.
macro_rules! sdo_frame {
    ($message:ident, $channel:ident, $ids:literal) => {
        impl<const L: usize> $message<L> {
            /// The message as a frame; `node` is the server.
            #[must_use]
            pub fn to_frame(&self, node: NodeId) -> CanFrame {
                CanFrame::of(
                    CommunicationObject::$channel(node).cob_id(),
                    self.to_bytes(),
                )
            }

            /// The server's node and the message in `frame`.
            ///
            /// # Errors
            /// [`MessageError`]; an SDO message always has eight bytes.
            pub fn parse(frame: &CanFrame) -> Result<(NodeId, Self), MessageError> {
                let layer = CanopenLayer::$channel;
                let Some(CommunicationObject::$channel(node)) =
                    frame.cob_id().map(CommunicationObject::of)
                else {
                    return Err(wrong_id(layer, $ids, frame));
                };
                Ok((node, Self::from_bytes(*bytes(layer, frame)?)))
            }
        }
    };
}

mod data;
mod error;
mod request;
mod response;
mod transfer;

pub use data::{Expedited, GenericSdoSegment, Initiate, SEGMENT_LEN, SdoSegment};
pub use error::TransferError;
pub use request::{GenericSdoRequest, SdoRequest};
pub use response::{GenericSdoResponse, SdoResponse};
pub use transfer::{SdoTransfer, TransferStep};

use crate::canopen::Address;
use crate::canopen::cob_id::{CommunicationObject, NodeId};
use crate::canopen::error::{CanopenLayer, MessageError};
use crate::canopen::frame::CanFrame;
use crate::canopen::message::{bytes, wrong_id};

sdo_frame!(GenericSdoRequest, SdoRequest, "601 to 67F");
sdo_frame!(GenericSdoResponse, SdoResponse, "581 to 5FF");

/// Data bytes of every SDO message.
const LEN: usize = 8;
/// Command specifier of an abort, in both directions.
const ABORT: u8 = 4;

/// A command specifier in bits 5 to 7.
const fn command(specifier: u8) -> u8 {
    specifier << 5
}

/// The multiplexer (index and subindex) after the command byte.
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
