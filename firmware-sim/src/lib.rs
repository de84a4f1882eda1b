#![doc = include_str!("../README.md")]
#![no_std]

pub mod epos2;
pub mod vlp16;
