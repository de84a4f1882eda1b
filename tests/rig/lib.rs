//! The virtual-time rig: the program's drive client and session with simulated devices, and a clock
//! that the test advances.
//!
//! Seconds of the program take a test milliseconds, and every run gives the same result.

pub mod bench;
pub mod capture;
pub mod drive;
pub mod inject;
pub mod link;
pub mod port;
pub mod random;
