//! The daemon with the simulator on loopback, seen from its page, other programs and the commands.

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
mod stall;
