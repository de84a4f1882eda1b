//! Recordings read back: pcap and pcapng into [`Record`]s in file order, with bounded memory.
//!
//! Whatever can be read is yielded. A packet that makes no sense is counted and passed over; damage
//! in the middle of a pcapng file is counted and reading goes on at the next sound block; a file
//! cut off in mid-record yields everything before the cut and then says where it was cut ([`End`]).
//! Only a file that is no recording at all, or that the system cannot read, is an error.
//!
//! The lidar's datagrams are known by their content ([`DatagramKind`]), on any port and from any
//! address; what else shared the wire is counted. Not here: what the packets say, checksums, and
//! more than one sensor's worth of meaning ([`Sensors`] tells them apart).

mod classify;
mod counts;
mod error;
mod input;
mod lidar;
mod link;
mod pace;
mod pcap;
mod pcapng;
mod reassembly;
mod resync;
mod sensors;
mod window;

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Stamp};

pub use counts::{Counts, Malformed};
pub use error::{End, Fault, RecordingError};
pub use input::{Input, SPOOL_LIMIT};
pub use lidar::DatagramKind;
pub use pace::{Gap, PaceError, Paced, Pacer, SteadyTimer, Timer, Turn};
pub use sensors::{Sensor, Sensors, sensors, source_of};

use link::LinkType;
pub(crate) use link::{RS232_NAME, USB_NAME};
use reassembly::Reassembler;
use window::Window;

/// The file format of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Classic pcap.
    Pcap {
        /// Stamps count nanoseconds, not microseconds.
        nanoseconds: bool,
        /// Headers are big-endian.
        big_endian: bool,
    },
    /// pcapng.
    PcapNg,
}

/// A recording being read, front to back. For a second pass open it again.
#[derive(Debug)]
pub struct Recording<R = File> {
    window: Window<R>,
    path: PathBuf,
    dialect: Dialect,
    metadata: Option<String>,
    counts: Counts,
    /// Bytes of the record last handed out, still at the front of the window.
    held: usize,
    end: Option<End>,
    /// A CAN frame shorter than `struct can_frame`, filled up with zeros.
    can_frame: [u8; link::CAN_FRAME_LEN],
    reassembler: Reassembler,
    keep_foreign: bool,
}

#[derive(Debug)]
enum Dialect {
    Pcap(pcap::Header),
    PcapNg(pcapng::Section),
}

/// What the next bytes of the file are, as far as the file format tells.
#[derive(Debug)]
enum Step {
    /// A packet; `data` counts from the front of the window.
    Packet(Packet),
    /// A packet whose frame in the file is sound but which cannot be used.
    Malformed { length: usize, fault: Fault },
    /// Bytes that are no record; the window is behind them already.
    Damaged {
        offset: u64,
        bytes: u64,
        fault: Fault,
    },
    /// Not a packet.
    Skip { length: usize },
    /// Nothing more.
    End(End),
}

#[derive(Debug)]
struct Packet {
    host: Stamp<Host>,
    /// Bytes of the whole record in the file.
    length: usize,
    data: Range<usize>,
    link: LinkType,
    direction: Option<Direction>,
    /// Bytes it had on the wire.
    original: u32,
}

/// What `next_record` found, in positions rather than borrows.
struct Found {
    host: Stamp<Host>,
    wire: FoundWire,
}

enum FoundWire {
    Datagram {
        source: [u8; 4],
        port: u16,
        payload: Range<usize>,
        place: Place,
    },
    Serial {
        link: DriveLink,
        direction: Direction,
        frame: Range<usize>,
    },
    Can {
        direction: Direction,
    },
}

/// Where the bytes of a datagram are.
#[derive(Clone, Copy)]
enum Place {
    Window,
    /// Reassembled from fragments.
    Reassembler,
}

impl Recording<File> {
    /// Opens a recording and reads its header. `-` is the standard input; that, and a pipe by its
    /// name, can be read once only: see [`Input`] for more passes.
    ///
    /// # Errors
    /// [`RecordingError`]: the file is missing or unreadable, empty, too short for a header, of
    /// another kind, or of a link type that carries neither IP nor CAN.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, RecordingError> {
        let path = path.as_ref();
        Self::new(input::open(path)?, path)
    }
}

impl<R: Read> Recording<R> {
    /// Reads a recording from any source of bytes; `name` is what errors call it.
    ///
    /// # Errors
    /// As [`Recording::open`].
    pub fn new(reader: R, name: impl Into<PathBuf>) -> Result<Self, RecordingError> {
        let path = name.into();
        let mut window = Window::new(reader);
        let read_error = |source| RecordingError::Read {
            path: path.clone(),
            offset: 0,
            source,
        };
        let start = window.fill(pcap::HEADER_LEN).map_err(read_error)?;
        if start.is_empty() {
            return Err(RecordingError::Empty { path });
        }
        let mut metadata = None;
        let dialect = if pcapng::is_section_header(start) {
            let mut section = pcapng::Section::default();
            metadata = section.open(&mut window, &path)?;
            Dialect::PcapNg(section)
        } else {
            let header = pcap::Header::parse(start, &path)?;
            window.consume(pcap::HEADER_LEN);
            Dialect::Pcap(header)
        };
        Ok(Self {
            window,
            path,
            dialect,
            metadata,
            counts: Counts::default(),
            held: 0,
            end: None,
            can_frame: [0; link::CAN_FRAME_LEN],
            reassembler: Reassembler::default(),
            keep_foreign: false,
        })
    }

    /// Yields every UDP datagram, a lidar's or not. They are counted as before.
    #[must_use]
    pub fn keep_foreign(mut self) -> Self {
        self.keep_foreign = true;
        self
    }

    /// What kind of file this is.
    #[must_use]
    pub fn format(&self) -> Format {
        match &self.dialect {
            Dialect::Pcap(header) => header.format(),
            Dialect::PcapNg(_) => Format::PcapNg,
        }
    }

    /// The comment of the first section: our own logs carry the configuration there, as TOML.
    #[must_use]
    pub fn metadata(&self) -> Option<&str> {
        self.metadata.as_deref()
    }

    /// What has been read so far.
    #[must_use]
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// How the file ended, once [`Recording::next_record`] has said that there is no more.
    #[must_use]
    pub fn end(&self) -> Option<&End> {
        self.end.as_ref()
    }

    /// The next record of the lidar's or the drive's traffic, or `None` after the last.
    ///
    /// # Errors
    /// [`RecordingError::Read`] where the system cannot read the file; no content is an error.
    pub fn next_record(&mut self) -> Result<Option<Record<'_>>, RecordingError> {
        let Some(found) = self.advance()? else {
            return Ok(None);
        };
        let bytes = self.window.bytes();
        let wire = match found.wire {
            FoundWire::Datagram {
                source,
                port,
                payload,
                place,
            } => Wire::Lidar {
                source,
                port,
                payload: match place {
                    Place::Window => bytes.get(payload),
                    Place::Reassembler => self.reassembler.datagram().get(payload),
                }
                .unwrap_or_default(),
            },
            FoundWire::Serial {
                link,
                direction,
                frame,
            } => Wire::Drive {
                link,
                direction,
                frame: bytes.get(frame).unwrap_or_default(),
            },
            FoundWire::Can { direction } => Wire::Drive {
                link: DriveLink::Can,
                direction,
                frame: &self.can_frame,
            },
        };
        Ok(Some(Record {
            host: found.host,
            wire,
        }))
    }

    /// Goes to the next usable packet.
    fn advance(&mut self) -> Result<Option<Found>, RecordingError> {
        loop {
            if self.end.is_some() {
                return Ok(None);
            }
            self.window.consume(std::mem::take(&mut self.held));
            let step = match &mut self.dialect {
                Dialect::Pcap(header) => header.step(&mut self.window),
                Dialect::PcapNg(section) => section.step(&mut self.window),
            };
            let offset = self.window.offset();
            let step = step.map_err(|source| RecordingError::Read {
                path: self.path.clone(),
                offset,
                source,
            })?;
            match step {
                Step::End(end) => self.end = Some(end),
                Step::Skip { length } => self.held = length,
                Step::Malformed { length, fault } => {
                    self.held = length;
                    self.counts.packet();
                    self.counts.malformed(offset, fault);
                }
                Step::Damaged {
                    offset,
                    bytes,
                    fault,
                } => {
                    self.counts.packet();
                    self.counts.malformed(offset, fault);
                    self.counts.damaged += 1;
                    self.counts.damaged_bytes += bytes;
                }
                Step::Packet(packet) => {
                    self.held = packet.length;
                    self.counts.packet();
                    if let Some(found) = self.classify(&packet, offset) {
                        return Ok(Some(found));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
