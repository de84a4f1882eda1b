//! Faults of a recording: of the file, of its end, of one packet.

use std::fmt;
use std::io;
use std::path::PathBuf;

/// A file that is no readable recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be opened.
    #[error("{}: cannot open: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A read failed.
    #[error("{}: cannot read at byte {offset}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Bytes from the start of the file.
        offset: u64,
        /// The system's error.
        source: io::Error,
    },
    /// The file is empty.
    #[error("{}: expected a pcap or pcapng recording, got an empty file", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The file ends within its header.
    #[error("{}: cut off in its header: expected {expected} bytes, got {got}", path.display())]
    Short {
        /// The file.
        path: PathBuf,
        /// Bytes of the header.
        expected: u64,
        /// Bytes in the file.
        got: u64,
    },
    /// The file is no recording.
    #[error("{}: expected pcap or pcapng, got {got}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// Description of its first bytes.
        got: String,
    },
    /// A recording of unsupported packets.
    #[error("{}: at byte {offset}: expected link type Ethernet (1), Linux cooked (113, 276), raw IP (101, 228, 229) or SocketCAN (227), got {got}", path.display())]
    Link {
        /// The file.
        path: PathBuf,
        /// Offset of the link type.
        offset: u64,
        /// The link type, as registered at tcpdump.org.
        got: u32,
    },
}

/// End of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// After a complete record.
    Complete,
    /// Within a record: the writer was stopped, or the file was copied incompletely.
    Truncated {
        /// Offset of the incomplete record in the file.
        offset: u64,
        /// Known length of the record in bytes.
        expected: u64,
        /// Bytes present.
        got: u64,
    },
    /// Before a record with an impossible length and no valid record after it.
    Unreadable {
        /// Offset of that record in the file.
        offset: u64,
        /// Its fault.
        fault: PacketFault,
    },
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Complete => write!(f, "complete"),
            Self::Truncated {
                offset,
                expected,
                got,
            } => write!(
                f,
                "cut off within a record at byte {offset}: expected {expected} bytes, got {got}"
            ),
            Self::Unreadable { offset, fault } => {
                write!(f, "unreadable from byte {offset} on: {fault}")
            }
        }
    }
}

/// Reason why a packet is unusable.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PacketFault {
    /// The capture truncated the packet (snap length).
    #[error("the capture kept {captured} bytes of {original}")]
    Snapped {
        /// Bytes in the file.
        captured: u32,
        /// Bytes on the wire.
        original: u32,
    },
    /// A layer is longer than the packet.
    #[error("{layer} at byte {offset} of the packet: expected {expected} bytes, got {got}")]
    Short {
        /// Name of the header or payload.
        layer: String,
        /// Bytes from the start of the packet.
        offset: usize,
        /// Expected bytes.
        expected: usize,
        /// Bytes present.
        got: usize,
    },
    /// An inconsistent header.
    #[error("{0}")]
    Header(String),
    /// An impossible record length.
    #[error("record length: expected {expected}, got {got}")]
    Length {
        /// Possible lengths.
        expected: &'static str,
        /// The value found.
        got: u64,
    },
    /// The two lengths of a pcapng block differ.
    #[error("block length: {front} at the start, {back} at the end")]
    Lengths {
        /// At the start of the block.
        front: u32,
        /// At its end.
        back: u32,
    },
    /// A pcapng block whose content exceeds its length.
    #[error("block of type {kind:#x}: its content exceeds its length")]
    Block {
        /// The block type.
        kind: u32,
    },
    /// A packet of an undescribed interface.
    #[error("interface {got} of {described} described ones")]
    Interface {
        /// The packet's interface number.
        got: u32,
        /// Interfaces described so far.
        described: usize,
    },
    /// A packet without a time.
    #[error("a pcapng simple packet block, which has no time")]
    Timeless,
    /// A record that exceeds the file although valid records follow.
    #[error("record length: {expected} bytes, but the file has {got} more")]
    Cut {
        /// Length of the record.
        expected: u64,
        /// Bytes up to the end of the file.
        got: u64,
    },
    /// A frame of the drive without a recorded direction.
    #[error("a frame of the drive without a direction")]
    Undirected,
}
