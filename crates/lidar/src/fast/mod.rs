//! The fast path of decoding: all channels of a block at a time, in SIMD registers and from tables.
//!
//! Plain definitions are [`crate::Firing::points`] for positions, [`protocol::vlp16::DataPacket`]
//! for channels, and the functions of [`f64`] for sines. Tests hold both paths to agree.

mod azimuth;
mod firing_block;
mod unpack;

pub(crate) use azimuth::{AzimuthSines, PaceCache};
pub(crate) use firing_block::BlockReturns;
pub use firing_block::{FiringBlock, Heading, ReturnLayer};
pub(crate) use unpack::UnpackedPacket;
