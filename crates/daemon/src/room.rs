//! Room on the disk for clouds. Those made for downloads take nothing of what is left free, nor of what a capture was promised; a scan's own may
//! have what is left free, which is what it is for.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, OnceLock};

use cloud::formats::Format;

use super::plan;
use super::pulse::disk_full;
use super::shared::Shared;
use engine::failure::{Failure, Kind};

/// Bytes that a scan's own cloud leaves for its record and others'.
const RECORDS: u64 = 1 << 20;
/// Bytes that are written between two looks at the disk.
const STEP: u64 = 1 << 20;
/// Most bytes of a point with all columns: as text some 20 a number.
const TEXT_ROW_BYTES: u64 = 160;
const ROW_BYTES: u64 = 64;
/// Most bytes beside the points.
const HEAD_BYTES: u64 = 64 << 10;

/// Most bytes of a cloud of so many points.
#[must_use]
pub fn most_bytes(format: Format, points: u64) -> u64 {
    let row = match format {
        Format::Csv => TEXT_ROW_BYTES,
        _ => ROW_BYTES,
    };
    points.saturating_mul(row).saturating_add(HEAD_BYTES)
}

/// The room that a file may take.
pub struct Room {
    shared: Arc<Shared>,
    of: Of,
    refused: OnceLock<Failure>,
}

/// Whose the file is.
#[derive(Clone, Copy)]
enum Of {
    Download,
    Scan,
}

impl Room {
    /// For a file of at most so many bytes.
    ///
    /// # Errors
    /// [`disk_full`] where it would not leave `reserve_bytes` and what scans that are under way may still need.
    pub fn take(shared: &Arc<Shared>, bytes: u64) -> Result<Arc<Self>, Failure> {
        let room = Self::new(shared, Of::Download);
        room.look(bytes)?;
        Ok(Arc::new(room))
    }

    /// For the cloud of a scan: as far as the disk goes.
    #[must_use]
    pub fn of_scan(shared: &Arc<Shared>) -> Arc<Self> {
        Arc::new(Self::new(shared, Of::Scan))
    }

    fn new(shared: &Arc<Shared>, of: Of) -> Self {
        Self {
            shared: Arc::clone(shared),
            of,
            refused: OnceLock::new(),
        }
    }

    /// Whether so many bytes more may be written.
    fn look(&self, bytes: u64) -> Result<(), Failure> {
        let shared = &self.shared;
        let reserve = shared.settings().reserve_bytes;
        let Ok(free) = (shared.world.free_bytes)(shared.scans.folder()) else {
            return Ok(());
        };
        if let Of::Scan = self.of {
            return match free.saturating_sub(RECORDS) >= bytes {
                true => Ok(()),
                false => Err(full(free)),
            };
        }
        let promised = plan::still_needed(shared);
        if free.saturating_sub(reserve).saturating_sub(promised) >= bytes {
            return Ok(());
        }
        let failure = disk_full(free, reserve);
        let message = format!(
            "{}{}, and this cloud may need {} MB more",
            failure.message,
            plan::promise(promised),
            bytes.div_ceil(1_000_000)
        );
        Err(Failure { message, ..failure })
    }

    /// Why something was not written.
    #[must_use]
    pub fn refused(&self) -> Option<&Failure> {
        self.refused.get()
    }
}

/// No room for the cloud of a scan.
fn full(free: u64) -> Failure {
    let message = format!("the disk is full: {} MB free", free / 1_000_000);
    Failure::new(Kind::Incomplete, message)
        .help("free some space on the disk of the scans, or delete scans: the cloud is made then")
}

/// A file that ends where the room does: a scan may have begun since, or another file have grown.
pub struct Roomy<F> {
    file: F,
    room: Arc<Room>,
    /// Bytes until the next look.
    left: u64,
}

impl<F> Roomy<F> {
    /// That file.
    #[must_use]
    pub const fn new(file: F, room: Arc<Room>) -> Self {
        Self {
            file,
            room,
            left: 0,
        }
    }
}

impl<F: Write> Roomy<F> {
    fn refuse(&self, failure: Failure) -> io::Error {
        let error = io::Error::new(io::ErrorKind::StorageFull, failure.message.clone());
        // The first word counts.
        let _ = self.room.refused.set(failure);
        error
    }
}

impl<F: Write> Write for Roomy<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let wanted = bytes.len() as u64;
        if self.left < wanted {
            let room = self.room.look(wanted);
            room.map_err(|failure| self.refuse(failure))?;
            self.left = STEP.max(wanted);
        }
        let written = match self.file.write(bytes) {
            // Others were quicker.
            Err(error) if error.kind() == io::ErrorKind::StorageFull => {
                return Err(self.refuse(full(0)));
            }
            written => written?,
        };
        self.left = self.left.saturating_sub(written as u64);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl<F: Read> Read for Roomy<F> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.file.read(into)
    }
}

impl<F: Seek> Seek for Roomy<F> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}
