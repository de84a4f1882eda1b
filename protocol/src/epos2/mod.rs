//! maxon EPOS2: serial frames, the commands they carry, the objects a tilt axis needs, and what its
//! codes mean.
//!
//! Sources: maxon EPOS2 Communication Guide (framing, commands, communication errors) and EPOS2
//! Firmware Specification (objects, device control, device errors). The same objects over CANopen
//! are framed elsewhere; here is neither a timeout nor a retry nor an opinion about what to ask the
//! drive.

pub mod cia402;
pub mod comm_error;
mod crc;
pub mod device_error;
mod error;
mod frame;
pub mod message;
pub mod objects;
pub mod rs232;
pub mod usb;

pub use crate::{Bounded, Full};
pub use comm_error::CommError;
pub use device_error::DeviceError;
pub use error::{SerialFrameError, SerialFrameError as FrameError, SerialLayer};
pub use frame::{MAX_WORDS, SerialFrame, SerialFrame as Frame, Words};

#[cfg(test)]
mod tests;
