//! CANopen (CiA 301), independent of any device: CAN frames, the services on them, an SDO client
//! without I/O, and SLCAN for serial adapters.
//!
//! Each service has one file with encoder and parser. Identifiers are those of the predefined
//! connection set. Not implemented: SDO block transfer, a master of layer setting services, and the
//! server side of an SDO transfer, which is part of a device.

mod abort_code;
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

pub use abort_code::AbortCode;
pub use cob_id::{CobId, CommunicationObject, NodeId, PdoNumber};
pub use error::{CanFrameError, CanopenLayer, MessageError};
pub use frame::{CanFrame, CanId, ExtendedId, SOCKETCAN_LEN};
pub use message::BusMessage;
pub use object::{Address, Scalar, TypedObject};

#[cfg(test)]
mod tests;
