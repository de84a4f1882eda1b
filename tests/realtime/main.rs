//! The program in real time: commands, the daemon on loopback, simulated devices in processes of
//! their own.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic)] // helpers outside #[test] functions

mod command_line;
mod daemon;
mod doctor;
mod generator;
mod network;
mod simulated_drive;
mod tilt;
