//! Room on the disk for clouds that are made for downloads: they take nothing of what is left free, nor of what a capture was promised.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, OnceLock};

use cloud::formats::Format;

use super::plan;
use super::pulse::disk_full;
use super::shared::Shared;
use crate::failure::Failure;

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
    refused: OnceLock<Failure>,
}

impl Room {
    /// For a file of at most so many bytes.
    ///
    /// # Errors
    /// [`disk_full`] where it would not leave `reserve_bytes` and what scans that are under way may still need.
    pub fn take(shared: &Arc<Shared>, bytes: u64) -> Result<Arc<Self>, Failure> {
        let room = Self {
            shared: Arc::clone(shared),
            refused: OnceLock::new(),
        };
        room.look(bytes)?;
        Ok(Arc::new(room))
    }

    /// Whether so many bytes more may be written.
    fn look(&self, bytes: u64) -> Result<(), Failure> {
        let shared = &self.shared;
        let reserve = shared.settings().reserve_bytes;
        let Ok(free) = (shared.world.free_bytes)(shared.scans.folder()) else {
            return Ok(());
        };
        let promised = plan::still_needed(shared);
        if free.saturating_sub(reserve).saturating_sub(promised) >= bytes {
            return Ok(());
        }
        let failure = disk_full(free, reserve);
        let mega = |bytes: u64| bytes.div_ceil(1_000_000);
        let promised = match promised {
            0 => String::new(),
            bytes => format!(
                ", a scan that is under way may still need {} MB",
                mega(bytes)
            ),
        };
        let message = format!(
            "{}{promised}, and this cloud may need {} MB more",
            failure.message,
            mega(bytes)
        );
        Err(Failure { message, ..failure })
    }

    /// Why something was not written.
    #[must_use]
    pub fn refused(&self) -> Option<&Failure> {
        self.refused.get()
    }
}

/// A file that ends where the room does: a scan may have begun since, or another file have grown.
pub struct Roomy {
    file: File,
    room: Arc<Room>,
    /// Bytes until the next look.
    left: u64,
}

impl Roomy {
    /// That file.
    #[must_use]
    pub const fn new(file: File, room: Arc<Room>) -> Self {
        Self {
            file,
            room,
            left: 0,
        }
    }
}

impl Write for Roomy {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let wanted = bytes.len() as u64;
        if self.left < wanted {
            self.room.look(wanted).map_err(|failure| {
                let error = io::Error::new(io::ErrorKind::StorageFull, failure.message.clone());
                let _ = self.room.refused.set(failure);
                error
            })?;
            self.left = STEP.max(wanted);
        }
        let written = self.file.write(bytes)?;
        self.left = self.left.saturating_sub(written as u64);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Read for Roomy {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.file.read(into)
    }
}

impl Seek for Roomy {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}
