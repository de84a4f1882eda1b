//! A record that owns its bytes, for passing between threads.

use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Stamp};

/// A [`Record`] with its own copy of the bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OwnedRecord {
    host: Stamp<Host>,
    kind: OwnedWire,
    bytes: Box<[u8]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OwnedWire {
    Lidar {
        source: [u8; 4],
        port: u16,
    },
    Drive {
        link: DriveLink,
        direction: Direction,
    },
}

impl OwnedRecord {
    /// Borrows the record.
    #[must_use]
    pub fn as_record(&self) -> Record<'_> {
        let wire = match self.kind {
            OwnedWire::Lidar { source, port } => Wire::Lidar {
                source,
                port,
                payload: &self.bytes,
            },
            OwnedWire::Drive { link, direction } => Wire::Drive {
                link,
                direction,
                frame: &self.bytes,
            },
        };
        Record {
            host: self.host,
            wire,
        }
    }

    /// The record's host time.
    #[must_use]
    pub fn host(&self) -> Stamp<Host> {
        self.host
    }
}

impl From<&Record<'_>> for OwnedRecord {
    fn from(record: &Record<'_>) -> Self {
        let (kind, bytes) = match record.wire {
            Wire::Lidar {
                source,
                port,
                payload,
            } => (OwnedWire::Lidar { source, port }, payload),
            Wire::Drive {
                link,
                direction,
                frame,
            } => (OwnedWire::Drive { link, direction }, frame),
        };
        Self {
            host: record.host,
            kind,
            bytes: bytes.into(),
        }
    }
}
