//! A maxon EPOS2 positioning controller with its motor, encoder, limit switches and brake, as a machine without I/O.
//!
//! [`Node`] is the unit: an object dictionary, the CiA 402 state machine and a profile generator that run at 1 kHz in integer
//! arithmetic, one [`Node::tick`] a millisecond. [`UsbServer`] and [`Rs232Server`] answer the frames of its serial interfaces,
//! [`CanServer`] those of a CAN bus, [`SlcanServer`] the same through a serial CAN adapter. A [`CanBus`] is what its gateway reaches.
//! Facts are from the EPOS2 Firmware Specification and Communication Guide; where they are silent the choice is said in a comment.
//!
//! Left out: the modes a tilt axis has no use for, and everything electrical. The shaft follows its demand exactly unless the
//! configuration gives its servo a lag ([`Servo`]) or something holds it; an unpowered shaft stays where it is, brake or not.

mod brake;
mod bus;
mod can;
mod conditions;
mod config;
mod control;
mod dictionary;
mod entry;
mod errors;
mod fixed;
mod following;
mod gateway;
mod generator;
mod homing;
mod homing_method;
mod inputs;
mod junk;
mod leg;
mod mapping;
mod network;
mod node;
mod objects;
mod position_mode;
mod profile;
mod rs232;
mod service;
mod servo;
mod shaft;
mod slcan;
mod storage;
mod table;
mod usb;
mod value;
mod velocity_mode;

pub use brake::BrakeState;
pub use bus::{CanBus, Neighbour};
pub use can::CanServer;
pub use config::{MAX_SWITCHES, NodeConfig, Region, Servo, Switch, UnitIdentity};
pub use node::{Node, ShaftSegment};
pub use protocol::canopen::{CanFrame, SOCKETCAN_LEN};
pub use rs232::Rs232Server;
pub use slcan::SlcanServer;
pub use usb::UsbServer;
pub use value::ObjectValue;

/// Why the dictionary refuses an access: the code that a serial answer or an SDO abort carries.
pub type Abort = protocol::epos2::CommError;

#[cfg(test)]
mod tests;
