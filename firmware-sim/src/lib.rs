//! The devices' side as machines without I/O: the EPOS2 tilt drive and the VLP-16, byte for byte
//! what a host sees of them.
//!
//! Embedded style: no heap, no clock, no randomness but from seeds, integer arithmetic where
//! firmware has it. What surrounds the devices (scenes, mechanics, links, virtual time) is built
//! around these machines elsewhere.
#![no_std]

pub mod epos2;
pub mod vlp16;
