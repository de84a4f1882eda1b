//! CANopen as the tilt drive speaks it (CiA 301): CAN frames, the services carried by them, an SDO client without I/O,
//! and SLCAN, by which a serial adapter carries the frames.
//!
//! One file a service, encode and parse together. Identifiers are those of the predefined connection set. Objects and
//! abort codes are the EPOS2's ([`crate::epos2::objects`], [`crate::epos2::CommError`]). Left out on purpose: SDO block
//! transfer, which the EPOS2 does not have; LSS, which it is not configured by; the server's side of a transfer as a
//! machine, which is a device's business.

pub mod cob_id;
pub mod emcy;
mod error;
mod frame;
pub mod heartbeat;
mod message;
pub mod nmt;
mod object;
pub mod pdo;
pub mod sdo;
pub mod slcan;
pub mod sync;

pub use cob_id::{CobId, CommunicationObject, CommunicationObject as Channel, NodeId, PdoNumber};
pub use error::{CanFrameError, MessageError, MessageKind};
pub use frame::{CanFrame, CanId, ExtendedId, SOCKETCAN_LEN};
pub use message::{BusMessage, BusMessage as Message};
pub use object::{Address, Scalar, TypedObject, TypedObject as Object};

#[cfg(test)]
mod tests;
