//! The raw log: every byte to and from both devices with its host time, in one pcapng file that
//! Wireshark reads.
//!
//! [`LogWriter`] encodes records; [`LogRecorder`] takes them from any thread, sorts them by time
//! and flushes the file. [`crate::recording`] reads logs.

mod block;
mod datagram;
mod owned;
mod recorder;
mod writer;

pub use owned::OwnedRecord;
pub use recorder::{LogRecorder, RecorderCounts, RecorderHandle};
pub use writer::{LogConfig, LogCounts, LogError, LogWriter};
