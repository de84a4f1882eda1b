//! A maxon EPOS2 positioning controller with its motor, encoder, limit switches and brake, as a
//! state machine without I/O.
//!
//! [`SimulatedDrive`] is the drive: an object dictionary, the CiA 402 state machine and a profile
//! generator at 1 kHz in integer arithmetic, one [`SimulatedDrive::tick`] per millisecond.
//! [`UsbServer`] and [`Rs232Server`] answer the frames of its serial interfaces, [`CanServer`]
//! those of a CAN bus, [`SlcanServer`] the same through a serial CAN adapter. Sources are the EPOS2
//! Firmware Specification and Communication Guide; comments mark behaviour that they leave open.
//!
//! Not simulated: the modes of current, interpolation and encoder following, and the electrical
//! side. The shaft follows its demand exactly unless the configuration has a servo with a lag
//! ([`Servo`]) or something blocks it; an unpowered shaft stays in place unless the configuration
//! has a load ([`AxisLoad`]).

mod brake;
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
mod leg;
mod load;
mod mapping;
mod network;
mod node;
mod objects;
mod position_mode;
mod profile;
mod ramp;
mod rs232;
mod service;
mod servo;
mod setting_modes;
mod shaft;
mod slcan;
mod storage;
mod table;
mod usb;
mod value;
mod velocity_mode;

pub use brake::BrakeState;
pub use can::CanServer;
pub use config::{
    AxisLoad, HoldingBrake, MAX_SWITCHES, Region, Servo, SimulatedDriveConfig, Switch, UnitIdentity,
};
pub use node::{ShaftSegment, SimulatedDrive};
pub use protocol::canopen::{CanFrame, SOCKETCAN_LEN};
pub use rs232::Rs232Server;
pub use slcan::SlcanServer;
pub use usb::UsbServer;
pub use value::ObjectValue;

/// Code of a rejected access, in a serial answer or an SDO abort.
pub use protocol::epos2::AbortCode;

#[cfg(test)]
mod tests;
