//! Bytes and their meaning, both ways: VLP-16 packets, EPOS2 frames and objects, CANopen.
//!
//! Pure functions and small machines over byte slices: no I/O, no clock, no heap, no unsafe. Ids
//! that are not known stay representable. What a value means for a scan is decided elsewhere.
#![no_std]

mod bounded;
pub mod canopen;
mod codes;
pub mod epos2;
pub mod record;
pub mod vlp16;

pub use bounded::{Bounded, Full};
