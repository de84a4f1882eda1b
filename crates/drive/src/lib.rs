//! The EPOS2 tilt drive's client, without I/O: connect, home, move, sample the shaft, stop; and a listener that reads the same out of a log.
//!
//! [`Client`] is a machine: bytes and times in, frames and events out. [`Listener`] only looks on. Neither opens a port, reads a
//! clock, or knows about lidars; what the angles are good for is decided elsewhere.

mod beat;
mod bus;
mod client;
mod codec;
mod command;
pub mod config;
mod error;
mod event;
mod link;
pub mod listener;
mod ops;
mod pairing;
mod plan;
mod procedures;
#[cfg(test)]
mod tests;

pub use client::Client;
pub use command::{Command, CommandKind, Move, ObjectBytes};
pub use config::AxisConfig;
pub use error::{DriveError, Operation, Wrote};
pub use event::{
    AngleSource, Arrived, Connected, DeviceName, Event, Identity, Outcome, Place, Progress,
    ShaftSample, Status, Stopped, Taken,
};
pub use link::LinkStats;
pub use listener::{Listener, Observation};
pub use pairing::MARKERS;
pub use plan::Plan;
pub use protocol::canopen::nmt::NmtState;
pub use protocol::epos2::{CommError, DeviceError, cia402, objects};
pub use protocol::record::{self, DriveLink};
