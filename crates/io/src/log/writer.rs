//! Writes records to a pcapng file in the given order, buffered so that a flush is one write.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Stamp};

use super::{block, datagram};
use crate::files::{Overwrite, sync_folder};
use crate::recording::{RS232_NAME, USB_NAME};

/// Bytes buffered before a write.
const BUFFER_LEN: usize = 64 * 1024;
/// Longest frame of the drive in bytes; a USB frame has at most 1028.
const MAX_FRAME_LEN: usize = 65_535;

/// Header of a log.
#[derive(Clone, Debug, Default)]
pub struct LogConfig {
    /// The configuration as TOML, in the section's comment; at most 65,535 bytes.
    pub metadata: String,
    /// Link of the drive. `None`: described with its first frame.
    pub drive: Option<DriveLink>,
}

/// Failure to write a log.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file exists and must not be replaced.
    #[error("log {}: the file exists already", path.display())]
    Exists {
        /// The existing file.
        path: PathBuf,
    },
    /// The file cannot be created.
    #[error("log {}: cannot create: {source}", path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A write failed (disk full, device disconnected).
    #[error("log: cannot write after byte {offset}: {source}")]
    Write {
        /// Bytes written before.
        offset: u64,
        /// The system's error.
        source: io::Error,
    },
    /// An earlier write failed; later records would be unreadable.
    #[error("log: stopped at byte {offset}, where a write failed: {source}")]
    Failed {
        /// Bytes written before.
        offset: u64,
        /// The system's error of that write.
        source: io::Error,
    },
    /// The configuration exceeds the comment.
    #[error("log: configuration: expected at most {expected} bytes, got {got}")]
    Metadata {
        /// Bytes that fit.
        expected: usize,
        /// Bytes it has.
        got: usize,
    },
    /// A payload or frame exceeds what the wire can carry.
    #[error("log: {layer}: expected at most {expected} bytes, got {got}")]
    TooLong {
        /// `UDP payload` or `drive frame`.
        layer: &'static str,
        /// Bytes that fit.
        expected: usize,
        /// Bytes it has.
        got: usize,
    },
    /// A host time before 1970, which the format cannot represent.
    #[error("log: host time: expected 1970 or later, got {} ns", got.as_nanos())]
    Time {
        /// The record's time.
        got: Stamp<Host>,
    },
    /// The recording thread cannot start, or panicked.
    #[error("log: the recording thread {0}")]
    Thread(String),
}

/// Numbers of written records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LogCounts {
    /// Datagrams of the lidar.
    pub lidar: u64,
    /// Frames to and from the drive.
    pub drive: u64,
    /// Bytes of the file.
    pub bytes: u64,
}

/// A log being written.
///
/// Bytes are buffered until [`LogWriter::flush`], [`LogWriter::finish`] or 64 KiB. After a failed
/// write nothing more is written: the file then ends in a partial record, which readers accept.
#[derive(Debug)]
pub struct LogWriter<W> {
    out: W,
    format: LogFormat,
    buffer: Vec<u8>,
    drives: Vec<DriveLink>,
    counts: LogCounts,
    /// Error of a failed write.
    failed: Option<io::Error>,
}

/// File format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LogFormat {
    /// pcapng with all records.
    Log,
    /// Classic pcap with the lidar's datagrams only, since it has one link type per file.
    Pcap,
}

impl LogWriter<File> {
    /// Creates a file for [`LogWriter::pcap`].
    ///
    /// # Errors
    /// [`LogError::Exists`], [`LogError::Create`], [`LogError::Write`].
    pub fn create_pcap(path: impl AsRef<Path>, overwrite: Overwrite) -> Result<Self, LogError> {
        Self::pcap(new_file(path.as_ref(), overwrite)?)
    }

    /// Creates a log file and writes its header.
    ///
    /// # Errors
    /// [`LogError::Exists`], [`LogError::Create`], [`LogError::Metadata`], [`LogError::Write`].
    pub fn create(
        path: impl AsRef<Path>,
        config: &LogConfig,
        overwrite: Overwrite,
    ) -> Result<Self, LogError> {
        let path = path.as_ref();
        // Checked before an existing log is truncated.
        check_metadata(config)?;
        let writer = Self::new(new_file(path, overwrite)?, config)?;
        sync_folder(path);
        Ok(writer)
    }
}

fn new_file(path: &Path, overwrite: Overwrite) -> Result<File, LogError> {
    let mut options = OpenOptions::new();
    options.write(true);
    match overwrite {
        Overwrite::Refuse => options.create_new(true),
        Overwrite::Replace => options.create(true).truncate(true),
    };
    options.open(path).map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists => LogError::Exists {
            path: path.to_owned(),
        },
        _ => LogError::Create {
            path: path.to_owned(),
            source,
        },
    })
}

impl<W: Write> LogWriter<W> {
    /// Starts a log on any writer and writes the header.
    ///
    /// # Errors
    /// [`LogError::Metadata`], [`LogError::Write`].
    pub fn new(out: W, config: &LogConfig) -> Result<Self, LogError> {
        check_metadata(config)?;
        let mut writer = Self::empty(out, LogFormat::Log);
        block::section_header(&mut writer.buffer, &config.metadata);
        block::interface(
            &mut writer.buffer,
            block::LINKTYPE_ETHERNET,
            "lidar",
            "VLP-16 over UDP; Ethernet, IPv4 and UDP headers rebuilt",
        );
        if let Some(link) = config.drive {
            writer.drive_interface(link);
        }
        writer.flush()?;
        Ok(writer)
    }

    /// Starts a classic pcap, for programs that do not read pcapng. It holds the lidar's datagrams
    /// and skips frames of the drive.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn pcap(out: W) -> Result<Self, LogError> {
        let mut writer = Self::empty(out, LogFormat::Pcap);
        block::pcap_header(&mut writer.buffer);
        writer.flush()?;
        Ok(writer)
    }

    fn empty(out: W, format: LogFormat) -> Self {
        Self {
            out,
            format,
            buffer: Vec::with_capacity(BUFFER_LEN + 4096),
            drives: Vec::new(),
            counts: LogCounts::default(),
            failed: None,
        }
    }

    /// Appends a record.
    ///
    /// # Errors
    /// [`LogError::TooLong`] and [`LogError::Time`] leave the log intact and usable;
    /// [`LogError::Write`] ends it.
    pub fn write(&mut self, record: &Record<'_>) -> Result<(), LogError> {
        self.check_earlier_writes()?;
        let time_ns = u64::try_from(record.host.as_nanos())
            .map_err(|_| LogError::Time { got: record.host })?;
        match record.wire {
            Wire::Lidar {
                source,
                port,
                payload,
            } => {
                let headers =
                    datagram::headers(source, port, payload).ok_or(LogError::TooLong {
                        layer: "UDP payload",
                        expected: datagram::MAX_PAYLOAD_LEN,
                        got: payload.len(),
                    })?;
                let parts = [&headers[..], payload];
                match self.format {
                    LogFormat::Log => {
                        block::packet(&mut self.buffer, 0, time_ns, Direction::FromDrive, parts);
                    }
                    LogFormat::Pcap => block::pcap_record(&mut self.buffer, time_ns, parts),
                }
                self.counts.lidar += 1;
            }
            Wire::Drive { .. } if self.format == LogFormat::Pcap => {}
            Wire::Drive {
                link,
                direction,
                frame,
            } => {
                if frame.len() > MAX_FRAME_LEN {
                    return Err(LogError::TooLong {
                        layer: "drive frame",
                        expected: MAX_FRAME_LEN,
                        got: frame.len(),
                    });
                }
                let interface = self.drive_interface(link);
                block::packet(
                    &mut self.buffer,
                    interface,
                    time_ns,
                    direction,
                    [frame, &[]],
                );
                self.counts.drive += 1;
            }
        }
        if self.buffer.len() >= BUFFER_LEN {
            self.flush()?;
        }
        Ok(())
    }

    /// Fails if an earlier write failed.
    fn check_earlier_writes(&self) -> Result<(), LogError> {
        self.failed.as_ref().map_or(Ok(()), |source| {
            Err(LogError::Failed {
                offset: self.counts.bytes,
                source: copy_of(source),
            })
        })
    }

    /// Passes all bytes to the system, so that they survive this process.
    ///
    /// # Errors
    /// [`LogError::Write`]; [`LogError::Failed`] with the same error from then on.
    pub fn flush(&mut self) -> Result<(), LogError> {
        self.check_earlier_writes()?;
        let written = self
            .out
            .write_all(&self.buffer)
            .and_then(|()| self.out.flush());
        if let Err(source) = written {
            self.failed = Some(copy_of(&source));
            return Err(LogError::Write {
                offset: self.counts.bytes,
                source,
            });
        }
        self.counts.bytes += self.buffer.len() as u64;
        self.buffer.clear();
        Ok(())
    }

    /// Flushes and returns the numbers of records and the writer.
    ///
    /// # Errors
    /// As [`LogWriter::flush`].
    pub fn finish(mut self) -> Result<(LogCounts, W), LogError> {
        self.flush()?;
        Ok((self.counts, self.out))
    }

    /// Interface number of the drive's link; writes its description at first use.
    fn drive_interface(&mut self, link: DriveLink) -> u32 {
        let at = self.drives.iter().position(|&known| known == link);
        let at = at.unwrap_or_else(|| {
            let (kind, name, description) = match link {
                DriveLink::Usb => (block::LINKTYPE_USER0, USB_NAME, "EPOS2 USB frames"),
                DriveLink::Rs232 => (block::LINKTYPE_USER0, RS232_NAME, "EPOS2 RS232 bytes"),
                DriveLink::Can => (block::LINKTYPE_CAN_SOCKETCAN, "epos2-can", "EPOS2 CANopen"),
            };
            block::interface(&mut self.buffer, kind, name, description);
            self.drives.push(link);
            self.drives.len() - 1
        });
        // At most three links, after the lidar's interface 0.
        at as u32 + 1
    }
}

/// A copy of an error.
fn copy_of(error: &io::Error) -> io::Error {
    match error.raw_os_error() {
        Some(code) => io::Error::from_raw_os_error(code),
        None => io::Error::new(error.kind(), error.to_string()),
    }
}

fn check_metadata(config: &LogConfig) -> Result<(), LogError> {
    if config.metadata.len() > block::MAX_OPTION_LEN {
        return Err(LogError::Metadata {
            expected: block::MAX_OPTION_LEN,
            got: config.metadata.len(),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
