//! firmware-sim
#![no_std]
