//! The engine: what the command line, the daemon and the ROS 2 node have in common.
//!
//! `devices` opens drive and lidar, `capture` plans and records a scan, `reconstruct` makes a cloud of a log or recording.
//! The engine parses no arguments and prints nothing: its clients do.

pub mod capture;
pub mod config;
pub mod default_paths;
pub mod devices;
pub mod failure;
pub mod output;
pub mod reconstruct;
pub mod stop_socket;

pub use failure::{Failure, Kind};
