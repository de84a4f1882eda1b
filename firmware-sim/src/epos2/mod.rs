//! A maxon EPOS2 positioning controller with its motor, encoder, limit switches and brake, as a machine without I/O.
//!
//! [`Node`] is the unit: an object dictionary, the CiA 402 state machine and a profile generator that run at 1 kHz in integer
//! arithmetic, one [`Node::tick`] a millisecond. [`UsbServer`] and [`Rs232Server`] answer the frames of its serial interfaces.
//! Facts are from the EPOS2 Firmware Specification and Communication Guide; where they are silent the choice is said in a comment.
//!
//! Left out: CANopen, the modes a tilt axis has no use for, and everything electrical. The shaft follows its demand exactly, so there
//! is no following error; an unpowered shaft stays where it is, brake or not.

mod brake;
mod config;
mod control;
mod dictionary;
mod errors;
mod fixed;
mod generator;
mod homing;
mod inputs;
mod junk;
mod leg;
mod node;
mod objects;
mod position_mode;
mod profile;
mod rs232;
mod service;
mod table;
mod usb;
mod value;

pub use brake::Brake;
pub use config::{Identity, MAX_SWITCHES, NodeConfig, Region, Switch};
pub use node::{Node, Segment};
pub use rs232::Rs232Server;
pub use usb::UsbServer;
pub use value::Value;

/// Why the dictionary refuses an access: the code that a serial answer or an SDO abort carries.
pub type Abort = protocol::epos2::CommError;

#[cfg(test)]
mod tests;
