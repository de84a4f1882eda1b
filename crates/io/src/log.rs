//! The raw log: every byte in or out of either device with its host time, in one pcapng file that
//! Wireshark reads.
//!
//! [`LogWriter`] turns records into blocks; [`Recorder`] takes records from any thread, puts them
//! in order and keeps the file fresh. Reading is [`crate::recording`]'s part. Nothing is decoded
//! here and nothing left out.

mod block;
mod datagram;
mod owned;
mod recorder;
mod writer;

pub use owned::OwnedRecord;
pub use recorder::{Recorder, RecorderCounts, RecorderHandle};
pub use writer::{LogConfig, LogCounts, LogError, LogWriter};
