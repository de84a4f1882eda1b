//! Input and output: recordings and logs, the lidar's sockets, the drive's ports, files and clocks.
//!
//! Every packet and frame is a [`protocol::record::Record`]: bytes with the host time at which they
//! were sent or received. This crate does not interpret them.
//!
//! ```
//! use io::log::{LogConfig, LogWriter};
//! use io::recording::Recording;
//! use protocol::record::{Record, Wire};
//! use units::Stamp;
//!
//! // A log of one data packet, and the recording that it is.
//! let mut payload = [0; 1206];
//! for block in payload.chunks_exact_mut(100) {
//!     block[..2].copy_from_slice(&[0xFF, 0xEE]);
//! }
//! let record = Record {
//!     host: Stamp::from_nanos(1_700_000_000_000_000_000),
//!     wire: Wire::Lidar { source: [192, 168, 1, 201], port: 2368, payload: &payload },
//! };
//! let mut writer = LogWriter::new(Vec::new(), &LogConfig::default())?;
//! writer.write(&record)?;
//! let (_, log) = writer.finish()?;
//!
//! let mut recording = Recording::new(log.as_slice(), "example")?;
//! assert_eq!(recording.next_record()?, Some(record));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(devices)]
mod ancillary;
#[cfg(devices)]
pub mod can;
pub mod clock;
#[cfg(devices)]
pub mod discover;
pub mod files;
pub mod log;
#[cfg(devices)]
pub mod port;
#[cfg(devices)]
pub mod processes;
pub mod recording;
#[cfg(devices)]
pub mod udp;
