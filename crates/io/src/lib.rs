//! Everything that touches the machine: recordings and logs, the lidar's socket, the drive's port,
//! files, the clock.
//!
//! What passes here is bytes with the host time at which they passed
//! ([`protocol::record::Record`]); what they mean is decided elsewhere. Nothing here decodes a
//! lidar packet, speaks to a drive or knows a scan. Signals, arguments and printing belong to the
//! binary.

mod ancillary;
pub mod can;
pub mod clock;
pub mod discover;
pub mod files;
pub mod log;
pub mod port;
pub mod recording;
pub mod udp;
