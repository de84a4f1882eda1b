//! maxon EPOS2: serial frames, the commands they carry, the objects a tilt axis needs, and what its
//! codes mean.
//!
//! Sources: maxon EPOS2 Communication Guide (framing, commands, communication errors) and EPOS2
//! Firmware Specification (objects, device control, device errors). The same objects over CANopen
//! are framed in `canopen`. Timeouts, retries and the order of accesses are left to the client.

pub mod cia402;
mod crc;
pub mod device_error;
mod error;
mod frame;
pub mod message;
pub mod objects;
pub mod rs232;
pub mod usb;

/// The error code of a serial answer, equal to an SDO abort code.
pub use crate::canopen::AbortCode;
pub use crate::{BoundedVec, CapacityError};
pub use device_error::DeviceError;
pub use error::{SerialFrameError, SerialLayer};
pub use frame::{MAX_WORDS, SerialFrame, Words};

#[cfg(test)]
mod tests;
