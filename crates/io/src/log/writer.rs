//! Records into a pcapng file, in the order they come. Buffering is here so that a flush is one
//! write.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Stamp};

use super::{block, datagram};
use crate::files::{Overwrite, sync_folder};
use crate::recording::{RS232_NAME, USB_NAME};

/// Bytes gathered before a write.
const BUFFER_LEN: usize = 64 * 1024;
/// Bytes a drive frame may have; a USB frame has at most 1028.
const MAX_FRAME_LEN: usize = 65_535;

/// What stands at the head of a log.
#[derive(Clone, Debug, Default)]
pub struct LogConfig {
    /// The configuration as TOML, for the section's comment; at most 65,535 bytes.
    pub metadata: String,
    /// How the drive is attached. `None`: said when its first frame comes.
    pub drive: Option<DriveLink>,
}

/// Why a log could not be written.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The name is taken and may not be replaced.
    #[error("log {}: the file exists already", path.display())]
    Exists {
        /// The file in the way.
        path: PathBuf,
    },
    /// The system does not make the file.
    #[error("log {}: cannot create: {source}", path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The system does not take more bytes (disk full, device gone).
    #[error("log: cannot write after byte {offset}: {source}")]
    Write {
        /// Bytes that were surely written.
        offset: u64,
        /// The system's reason.
        source: io::Error,
    },
    /// An earlier write failed; what follows would not be readable.
    #[error("log: nothing was written after byte {offset}, since writing there failed: {source}")]
    Failed {
        /// Bytes that were surely written.
        offset: u64,
        /// The system's reason then.
        source: io::Error,
    },
    /// The configuration does not fit the comment.
    #[error("log: configuration: expected at most {expected} bytes, got {got}")]
    Metadata {
        /// Bytes that fit.
        expected: usize,
        /// Bytes it has.
        got: usize,
    },
    /// A payload or frame that cannot have been on the wire.
    #[error("log: {layer}: expected at most {expected} bytes, got {got}")]
    TooLong {
        /// `UDP payload` or `drive frame`.
        layer: &'static str,
        /// Bytes that fit.
        expected: usize,
        /// Bytes it has.
        got: usize,
    },
    /// A host time before 1970, which the format cannot say.
    #[error("log: host time: expected 1970 or later, got {} ns", got.as_nanos())]
    Time {
        /// The record's time.
        got: Stamp<Host>,
    },
    /// The recorder's thread could not be started or died.
    #[error("log: the recording thread {0}")]
    Thread(String),
}

/// What was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
/// Bytes wait in memory until [`LogWriter::flush`], [`LogWriter::finish`] or 64 KiB of them. After
/// a failed write nothing more is written: the file then ends in a record that may be cut, which a
/// reader knows how to take.
#[derive(Debug)]
pub struct LogWriter<W> {
    out: W,
    form: Form,
    buffer: Vec<u8>,
    drives: Vec<DriveLink>,
    counts: LogCounts,
    /// Why a write failed.
    failed: Option<io::Error>,
}

/// How records are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// pcapng with everything in it.
    Log,
    /// Plain pcap, the lidar's datagrams alone: what programs of libpcap read, which take one type
    /// of link a file.
    Pcap,
}

impl LogWriter<File> {
    /// Makes a plain pcap file, for programs that read nothing else. It holds the lidar's
    /// datagrams; frames of the drive are left out.
    ///
    /// # Errors
    /// [`LogError::Exists`], [`LogError::Create`], [`LogError::Write`].
    pub fn create_pcap(path: impl AsRef<Path>, overwrite: Overwrite) -> Result<Self, LogError> {
        let mut writer = Self::empty(new_file(path.as_ref(), overwrite)?, Form::Pcap);
        block::pcap_header(&mut writer.buffer);
        writer.flush()?;
        Ok(writer)
    }

    /// Makes a log file and writes its head.
    ///
    /// # Errors
    /// [`LogError::Exists`], [`LogError::Create`], [`LogError::Metadata`], [`LogError::Write`].
    pub fn create(
        path: impl AsRef<Path>,
        config: &LogConfig,
        overwrite: Overwrite,
    ) -> Result<Self, LogError> {
        let path = path.as_ref();
        // Before an older log is emptied for it.
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
    /// Writes a log to any sink of bytes; the head is written at once.
    ///
    /// # Errors
    /// [`LogError::Metadata`], [`LogError::Write`].
    pub fn new(out: W, config: &LogConfig) -> Result<Self, LogError> {
        check_metadata(config)?;
        let mut writer = Self::empty(out, Form::Log);
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

    fn empty(out: W, form: Form) -> Self {
        Self {
            out,
            form,
            buffer: Vec::with_capacity(BUFFER_LEN + 4096),
            drives: Vec::new(),
            counts: LogCounts::default(),
            failed: None,
        }
    }

    /// Appends a record.
    ///
    /// # Errors
    /// [`LogError::TooLong`] and [`LogError::Time`] leave the log as it was, fit for further
    /// records; [`LogError::Write`] ends it.
    pub fn write(&mut self, record: &Record<'_>) -> Result<(), LogError> {
        self.check_sound()?;
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
                match self.form {
                    Form::Log => {
                        block::packet(&mut self.buffer, 0, time_ns, Direction::FromDevice, parts);
                    }
                    Form::Pcap => block::pcap_record(&mut self.buffer, time_ns, parts),
                }
                self.counts.lidar += 1;
            }
            Wire::Drive { .. } if self.form == Form::Pcap => {}
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

    /// Whether all writes so far went well.
    fn check_sound(&self) -> Result<(), LogError> {
        self.failed.as_ref().map_or(Ok(()), |source| {
            Err(LogError::Failed {
                offset: self.counts.bytes,
                source: same(source),
            })
        })
    }

    /// Hands all bytes to the system, so that they survive this process.
    ///
    /// # Errors
    /// [`LogError::Write`]; [`LogError::Failed`] with the same reason ever after.
    pub fn flush(&mut self) -> Result<(), LogError> {
        self.check_sound()?;
        let written = self
            .out
            .write_all(&self.buffer)
            .and_then(|()| self.out.flush());
        if let Err(source) = written {
            self.failed = Some(same(&source));
            return Err(LogError::Write {
                offset: self.counts.bytes,
                source,
            });
        }
        self.counts.bytes += self.buffer.len() as u64;
        self.buffer.clear();
        Ok(())
    }

    /// Flushes; what was written, and the sink.
    ///
    /// # Errors
    /// As [`LogWriter::flush`].
    pub fn finish(mut self) -> Result<(LogCounts, W), LogError> {
        self.flush()?;
        Ok((self.counts, self.out))
    }

    /// The number of the interface of the drive's link, described first if it is new.
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
        // Three links at most, behind the lidar's interface 0.
        at as u32 + 1
    }
}

/// The same error once more.
fn same(error: &io::Error) -> io::Error {
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
