#![doc = include_str!("../README.md")]
#![no_std]

mod bounded;
pub mod canopen;
mod codes;
pub mod epos2;
pub mod record;
pub mod vlp16;

pub use bounded::{BoundedVec, CapacityError};
