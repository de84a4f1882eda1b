//! What can be wrong with a recording: with the file, with its end, with one packet.

use std::fmt;
use std::io;
use std::path::PathBuf;

/// A file that cannot be read as a recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The system does not open it.
    #[error("{}: cannot open: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The system does not read it further.
    #[error("{}: cannot read at byte {offset}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Bytes from the start of the file.
        offset: u64,
        /// The system's reason.
        source: io::Error,
    },
    /// No bytes at all.
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
    /// Something else than a recording.
    #[error("{}: expected pcap or pcapng, got {got}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What its first bytes look like.
        got: String,
    },
    /// A recording of something else than Ethernet, IP or CAN.
    #[error("{}: at byte {offset}: expected link type Ethernet (1), Linux cooked (113, 276), raw IP (101, 228, 229) or SocketCAN (227), got {got}", path.display())]
    Link {
        /// The file.
        path: PathBuf,
        /// Where the link type stands.
        offset: u64,
        /// The link type, as registered at tcpdump.org.
        got: u32,
    },
}

/// How a recording ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// After a whole record.
    Complete,
    /// In mid-record: the program or the machine that wrote it was stopped, or the file was not
    /// copied whole.
    Truncated {
        /// Where the incomplete record starts, in bytes from the start of the file.
        offset: u64,
        /// Bytes the record has, as far as can be told.
        expected: u64,
        /// Bytes of it that are there.
        got: u64,
    },
    /// Before a record whose length cannot be true; nothing sound was found behind it.
    Unreadable {
        /// Where that record starts, in bytes from the start of the file.
        offset: u64,
        /// What is wrong with it.
        fault: Fault,
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
                "cut off in mid-record at byte {offset}: expected {expected} bytes, got {got}"
            ),
            Self::Unreadable { offset, fault } => {
                write!(f, "unreadable from byte {offset} on: {fault}")
            }
        }
    }
}

/// Why a packet cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// The capture kept only the start of the packet (snap length).
    #[error("the capture kept {captured} bytes of {original}")]
    Snapped {
        /// Bytes in the file.
        captured: u32,
        /// Bytes on the wire.
        original: u32,
    },
    /// A layer says it is longer than the packet.
    #[error("{layer} at byte {offset} of the packet: expected {expected} bytes, got {got}")]
    Short {
        /// Which header or payload.
        layer: String,
        /// Bytes from the start of the packet.
        offset: usize,
        /// Bytes it should have.
        expected: usize,
        /// Bytes there are.
        got: usize,
    },
    /// A header contradicts itself.
    #[error("{0}")]
    Header(String),
    /// A length that no record can have.
    #[error("record length: expected {expected}, got {got}")]
    Length {
        /// What would be possible.
        expected: &'static str,
        /// What is written there.
        got: u64,
    },
    /// The two lengths around a pcapng block differ.
    #[error("block length: {front} in front, {back} behind")]
    Lengths {
        /// In front of the block.
        front: u32,
        /// Behind it.
        back: u32,
    },
    /// A pcapng block whose parts do not fit in it.
    #[error("a block of type {kind:#x} whose content does not fit its length")]
    Block {
        /// The block type.
        kind: u32,
    },
    /// A packet of an interface that was not described.
    #[error("interface {got}, where {described} are described")]
    Interface {
        /// The packet's interface number.
        got: u32,
        /// Interfaces described so far.
        described: usize,
    },
    /// A packet without a time.
    #[error("a pcapng simple packet block, which has no time")]
    Timeless,
    /// A record that would reach beyond the end of the file, though sound ones follow within it.
    #[error("record length: {expected} bytes, where the file has {got} more")]
    Cut {
        /// Bytes the record claims to have.
        expected: u64,
        /// Bytes to the end of the file.
        got: u64,
    },
    /// A frame of the drive of which the direction is not recorded.
    #[error("a frame of the drive without a direction")]
    Undirected,
}
