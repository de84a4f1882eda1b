//! The daemon with the simulator on loopback, as used by its page, other programs and the commands.

mod access;
mod api;
mod commands;
mod connections;
mod devices;
mod edits;
mod events;
mod limits;
mod panics;
mod rapid_requests;
pub mod rig;
mod scans;
mod service;
mod silent_drive;
mod stalled_disk;
mod statistics;
mod tls;
