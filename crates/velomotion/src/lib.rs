//! The program: command line, configuration, devices, printing. One file a verb in [`commands`].
//!
//! What a scan is and how it becomes a cloud lives in the library crates; here threads are started, files opened and
//! sentences printed.

pub mod checks;
pub mod cli;
pub mod commands;
pub mod config;
pub mod control;
pub mod daemon;
pub mod devices;
pub mod failure;
pub mod hearing;
pub mod job;
pub mod journal;
pub mod motion;
pub mod names;
pub mod output;
pub mod ports;
pub mod progress;
pub mod recording;
pub mod recordings;
pub mod report;
pub mod sensing;
pub mod session;
pub mod setup;
pub mod signals;
pub mod simulated;
pub mod software_axis;
pub mod software_drive;
pub mod thumbnail;
pub mod tilting;
pub mod utc;
pub mod wholeness;

pub use failure::{Failure, Kind};
