//! A record that owns its bytes, for passing between threads.

use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Stamp};

/// A [`Record`] with its own copy of the bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OwnedRecord {
    host: Stamp<Host>,
    kind: Kind,
    bytes: Box<[u8]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
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
            Kind::Lidar { source, port } => Wire::Lidar {
                source,
                port,
                payload: &self.bytes,
            },
            Kind::Drive { link, direction } => Wire::Drive {
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
            } => (Kind::Lidar { source, port }, payload),
            Wire::Drive {
                link,
                direction,
                frame,
            } => (Kind::Drive { link, direction }, frame),
        };
        Self {
            host: record.host,
            kind,
            bytes: bytes.into(),
        }
    }
}
