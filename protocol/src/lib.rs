//! Bytes and their meaning, both ways: VLP-16 packets, EPOS2 frames and objects, CANopen.
//!
//! Pure functions and small machines over byte slices: no I/O, no clock, no heap, no unsafe. Ids that are not known
//! stay representable. What a value means for a scan is decided elsewhere.
#![no_std]

pub mod canopen;
pub mod epos2;
pub mod record;
pub mod vlp16;
