//! The client of the tilt axis' EPOS2 drive, without I/O, and a listener that decodes logs.
//!
//! [`DriveClient`] is a state machine: the caller passes bytes and times in and takes bytes and
//! events out. [`DriveListener`] only observes. Neither opens a port, reads a clock or knows about
//! lidars.
//!
//! # Example
//! A client sends nothing before a command starts. `Connect` begins with reading the device type:
//! ```
//! use drive::{AxisConfig, DriveClient, DriveCommand, DriveLink};
//! use units::Stamp;
//!
//! let mut client = DriveClient::new(AxisConfig::default(), DriveLink::Usb);
//! let mut now = Stamp::from_nanos(0);
//! assert_eq!(client.poll_transmit(now), None);
//!
//! client.start(DriveCommand::Connect)?;
//! let request = client.poll_transmit(now).expect("bytes to write to the port");
//! assert_eq!(request[..6], [0x90, 0x02, 0x10, 0x02, 0x00, 0x10]);
//!
//! // The port's owner now passes the reply to `handle_input`. Without one:
//! now = client.poll_timeout().expect("the reply has a time limit");
//! client.handle_timeout(now);
//! # Ok::<(), drive::DriveError>(())
//! ```

mod can_services;
mod client;
mod codec;
mod command;
pub mod config;
mod error;
mod event;
mod exchange;
mod link;
mod listener;
mod ops;
mod plan;
mod procedures;
mod request_matcher;
mod sync_matcher;
#[cfg(test)]
mod tests;

pub use client::DriveClient;
pub use command::{CommandKind, DriveCommand, MoveCommand, ObjectBytes};
pub use config::AxisConfig;
pub use error::{DriveError, Operation, WrittenData};
pub use event::{
    AngleSource, CommandOutcome, CommandProgress, ConnectionReport, DeviceName, DriveEvent,
    DriveIdentity, DriveStatus, MoveReport, PositionValidity, SampleTrigger, ShaftSample,
    StopReport,
};
pub use link::LinkStats;
pub use listener::{DriveListener, Observation};
pub use plan::MovePlan;
pub use protocol::canopen::nmt::NmtState;
pub use protocol::epos2::{AbortCode, DeviceError, cia402, objects};
pub use protocol::record::{self, DriveLink};
pub use request_matcher::PROBES;
