//! Fast paths: all channels of a firing block together, in SIMD registers.
//!
//! Each has a plain definition, against which it is tested: [`crate::Alignment::place`] for a
//! block, [`crate::clock::DeviceClock::moment`] for its time,
//! [`crate::trajectory::Trajectory::angle`] for its tilt.

mod clock_cursor;
mod compress;
mod firing_blocks;
mod lanes;
mod spans;
mod trajectory_cursor;

pub(crate) use firing_blocks::{FiringBlockPlacer, MAX_PACKET_POINTS, returns};
