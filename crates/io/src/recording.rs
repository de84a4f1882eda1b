//! Reading of recordings: pcap and pcapng into [`Record`]s in file order, with bounded memory.
//!
//! Reading recovers what it can. Malformed packets are counted and skipped. Damage within a pcapng
//! file is counted, and reading continues at the next valid block. A truncated file yields all
//! records before its end and reports the position ([`End`]). The only errors are files that are no
//! recordings and failed system calls.
//!
//! Datagrams of a lidar are recognised by content ([`DatagramKind`]), on any port and from any
//! address; other packets are counted. Checksums are not verified.

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
mod window;

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Stamp};

pub use counts::{MalformedPacket, RecordingCounts};
pub use error::{End, PacketFault, RecordingError};
pub use input::{RecordingInput, SPOOL_LIMIT};
pub use lidar::DatagramKind;
pub use pace::{Gap, PaceError, Pacer, Wait};

use link::LinkType;
pub(crate) use link::{RS232_NAME, USB_NAME};
use reassembly::Reassembler;
use window::Window;

/// A recording, read from front to back. Open it again for another pass.
#[derive(Debug)]
pub struct Recording<R = File> {
    window: Window<R>,
    path: PathBuf,
    format_state: FormatState,
    metadata: Option<String>,
    counts: RecordingCounts,
    /// Length of the record returned last, which is still at the front of the window.
    consumed: usize,
    end: Option<End>,
    /// A CAN frame, padded to `struct can_frame` with zeros.
    can_frame: [u8; link::CAN_FRAME_LEN],
    reassembler: Reassembler,
    keep_foreign: bool,
}

#[derive(Debug)]
enum FormatState {
    Pcap(pcap::PcapFile),
    PcapNg(pcapng::PcapngSection),
}

/// Content of the next bytes by the file format.
#[derive(Debug)]
enum FileItem {
    /// A packet; `data` counts from the front of the window.
    Packet(CapturedPacket),
    /// The header of a section after the first.
    Section { length: usize },
    /// An unusable packet with a valid frame.
    Malformed { length: usize, fault: PacketFault },
    /// Damaged bytes, which the window has passed.
    Damaged {
        offset: u64,
        bytes: u64,
        fault: PacketFault,
    },
    /// A block without a packet.
    Skip { length: usize },
    /// End of the recording.
    End(End),
}

#[derive(Debug)]
struct CapturedPacket {
    host: Stamp<Host>,
    /// Length of the record in the file.
    length: usize,
    data: Range<usize>,
    link: LinkType,
    direction: Option<Direction>,
    /// Length on the wire.
    original: u32,
}

/// A record by the positions of its bytes.
struct FoundRecord {
    host: Stamp<Host>,
    wire: FoundWire,
}

enum FoundWire {
    Datagram {
        source: [u8; 4],
        port: u16,
        payload: Range<usize>,
        location: PayloadLocation,
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

/// Location of a datagram's bytes.
#[derive(Clone, Copy)]
enum PayloadLocation {
    Window,
    /// Reassembled from fragments.
    Reassembler,
}

impl Recording<File> {
    /// Opens a recording and reads its header. `-` is standard input. Standard input and pipes can
    /// be read once; [`RecordingInput`] allows more passes.
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
    /// Reads a recording from any reader; errors call it `name`.
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
        let format_state = if pcapng::is_section_header(start) {
            let mut section = pcapng::PcapngSection::default();
            metadata = section.open(&mut window, &path)?;
            FormatState::PcapNg(section)
        } else {
            let header = pcap::PcapFile::parse(start, &path)?;
            window.consume(pcap::HEADER_LEN);
            FormatState::Pcap(header)
        };
        Ok(Self {
            window,
            path,
            format_state,
            metadata,
            counts: RecordingCounts::default(),
            consumed: 0,
            end: None,
            can_frame: [0; link::CAN_FRAME_LEN],
            reassembler: Reassembler::default(),
            keep_foreign: false,
        })
    }

    /// Yields foreign UDP datagrams as well. Counts do not change.
    #[must_use]
    pub fn keep_foreign(mut self) -> Self {
        self.keep_foreign = true;
        self
    }

    /// The comment of the first section, which holds the configuration of our logs as TOML.
    #[must_use]
    pub fn metadata(&self) -> Option<&str> {
        self.metadata.as_deref()
    }

    /// Numbers of packets so far.
    #[must_use]
    pub fn counts(&self) -> &RecordingCounts {
        &self.counts
    }

    /// The end of the file, once [`Recording::next_record`] returned `None`.
    #[must_use]
    pub fn end(&self) -> Option<&End> {
        self.end.as_ref()
    }

    /// The next record of the lidar's or the drive's traffic, or `None` after the last.
    ///
    /// # Errors
    /// [`RecordingError::Read`] if a system call fails. No content of the file is an error.
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
                location,
            } => Wire::Lidar {
                source,
                port,
                payload: match location {
                    PayloadLocation::Window => bytes.get(payload),
                    PayloadLocation::Reassembler => self.reassembler.datagram().get(payload),
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

    /// Advances to the next usable packet.
    fn advance(&mut self) -> Result<Option<FoundRecord>, RecordingError> {
        loop {
            if self.end.is_some() {
                return Ok(None);
            }
            self.window.consume(std::mem::take(&mut self.consumed));
            let item = match &mut self.format_state {
                FormatState::Pcap(header) => header.step(&mut self.window),
                FormatState::PcapNg(section) => section.step(&mut self.window),
            };
            let offset = self.window.offset();
            let item = item.map_err(|source| RecordingError::Read {
                path: self.path.clone(),
                offset,
                source,
            })?;
            match item {
                FileItem::End(end) => self.end = Some(end),
                FileItem::Skip { length } => self.consumed = length,
                FileItem::Section { length } => {
                    self.consumed = length;
                    self.counts.second_section.get_or_insert(offset);
                }
                FileItem::Malformed { length, fault } => {
                    self.consumed = length;
                    self.counts.records += 1;
                    self.counts.malformed(offset, fault);
                }
                FileItem::Damaged {
                    offset,
                    bytes,
                    fault,
                } => {
                    self.counts.records += 1;
                    self.counts.malformed(offset, fault);
                    self.counts.damaged += 1;
                    self.counts.damaged_bytes += bytes;
                }
                FileItem::Packet(packet) => {
                    self.consumed = packet.length;
                    self.counts.records += 1;
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
