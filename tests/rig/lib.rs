//! The virtual-time rig: the program's own drive client and session against the software devices,
//! with the clock turned by hand.
//!
//! What takes the program real seconds takes a test milliseconds, and comes out the same every
//! time.

pub mod bench;
pub mod capture;
pub mod drive;
pub mod inject;
pub mod port;
pub mod random;
