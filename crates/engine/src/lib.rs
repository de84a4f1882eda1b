//! The engine shared by the command line, the daemon and the ROS 2 node.
//!
//! `service` owns the devices, which `devices` opens; `capture` plans and records a scan,
//! `reconstruct` makes a cloud of a log or recording. The engine parses no arguments and prints
//! nothing.
//!
//! ```no_run
//! use engine::reconstruct::source::Source;
//!
//! let log = Source::open("hall.pcapng".as_ref(), None)?;
//! println!("simulated: {}", log.config()?.simulated);
//! # Ok::<(), engine::Failure>(())
//! ```

pub mod accuracy;
#[cfg(devices)]
pub mod bring_up;
pub mod calibrate;
pub mod capture;
pub mod capture_request;
pub mod config;
pub mod default_paths;
pub mod devices;
pub mod document;
pub mod failure;
pub mod lidars;
pub mod output;
pub mod reconstruct;
#[cfg(devices)]
pub mod service;
pub mod simulate;
mod threads;
pub mod words;

pub use failure::{Failure, Kind};
pub use threads::{no_resource, spawn};
