//! Recordings read back: pcap and pcapng into [`Record`]s in file order, with bounded memory.
//!
//! Whatever can be read is yielded. A packet that makes no sense is counted and passed over; a file cut off in mid-record
//! yields everything before the cut and then says where it was cut ([`End`]). Only a file that is no recording at all,
//! or that the system cannot read, is an error. Fragments are counted and not put together: a lidar's packets fit one
//! frame. TCP, ARP, IPv6 and whatever else shared the wire is counted as other.

mod counts;
mod error;
mod link;
mod pcap;
mod pcapng;
mod window;

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Stamp};

pub use counts::{Counts, Malformed};
pub use error::{End, Fault, RecordingError};

use link::{Content, LinkType};
pub(crate) use link::{RS232_NAME, USB_NAME};
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

impl Recording<File> {
    /// Opens a recording and reads its header.
    ///
    /// # Errors
    /// [`RecordingError`]: the file is missing or unreadable, empty, too short for a header, of another kind, or of a
    /// link type that carries neither IP nor CAN.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, RecordingError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|source| RecordingError::Open {
            path: path.to_owned(),
            source,
        })?;
        Self::new(file, path)
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
        })
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
            } => Wire::Lidar {
                source,
                port,
                payload: bytes.get(payload).unwrap_or_default(),
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

    /// Looks inside a packet and counts it.
    fn classify(&mut self, packet: &Packet, offset: u64) -> Option<Found> {
        let data = self
            .window
            .bytes()
            .get(packet.data.clone())
            .unwrap_or_default();
        let within = |range: Range<usize>| {
            packet.data.start.saturating_add(range.start)
                ..packet.data.start.saturating_add(range.end)
        };
        let wire = match link::look_inside(packet.link, packet.direction, data) {
            Ok(Content::Datagram {
                source,
                port,
                payload,
            }) => {
                self.counts.datagram(port, payload.len());
                FoundWire::Datagram {
                    source,
                    port,
                    payload: within(payload),
                }
            }
            Ok(Content::Serial { link, direction }) => {
                self.counts.drive(direction);
                FoundWire::Serial {
                    link,
                    direction,
                    frame: packet.data.clone(),
                }
            }
            Ok(Content::Can { direction, frame }) => {
                self.counts.drive(direction);
                self.can_frame = frame;
                FoundWire::Can { direction }
            }
            Ok(Content::Fragment) => {
                self.counts.fragments += 1;
                return None;
            }
            Ok(Content::Other) => {
                self.counts.other += 1;
                return None;
            }
            Err(fault) => {
                self.counts.malformed(offset, fault);
                return None;
            }
        };
        Some(Found {
            host: packet.host,
            wire,
        })
    }
}

#[cfg(test)]
mod tests;
