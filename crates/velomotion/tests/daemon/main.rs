//! The daemon against the simulator, on loopback: as its page, other programs and the commands meet
//! it.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers outside #[test] functions

mod api;
mod commands;
mod deaf;
mod defects;
mod devices;
mod door;
mod events;
mod guard;
mod hasty;
mod limits;
mod rig;
mod scans;
mod service;
#[path = "../software_drive/mod.rs"]
mod software_drive;
mod stall;
