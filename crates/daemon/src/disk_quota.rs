//! Quotas of disk space for clouds. A cloud made for a download must not use the reserve, nor the
//! space that captures may still need; a scan's own cloud may use the reserve.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, OnceLock};

use cloud::formats::Format;

use engine::failure::{Failure, Kind};

use crate::plan;
use crate::state::DaemonState;

/// Bytes that a scan's own cloud leaves for records of scans.
const RECORDS_RESERVE: u64 = 1 << 20;
/// Bytes written between two checks of the disk.
const CHECK_INTERVAL: u64 = 1 << 20;
/// Most bytes of a point with all 11 columns as text: 20 characters of its four longest, 10 of the
/// others.
const TEXT_ROW_BYTES: u64 = 160;
/// The same in binary: at most 8 bytes a column, most of them shorter.
const ROW_BYTES: u64 = 64;
/// Most bytes of a file's header.
const HEAD_BYTES: u64 = 64 << 10;

/// Most bytes of a cloud with this many points.
#[must_use]
pub fn most_bytes(format: Format, points: u64) -> u64 {
    let row = match format {
        Format::Csv | Format::Xyz => TEXT_ROW_BYTES,
        Format::Ply
        | Format::Pcd
        | Format::Las
        | Format::Laz
        | Format::E57
        | Format::Mcap
        | Format::Kitti
        | Format::Npz => ROW_BYTES,
    };
    points.saturating_mul(row).saturating_add(HEAD_BYTES)
}

/// The disk space that a file may use.
pub struct DiskQuota {
    state: Arc<DaemonState>,
    purpose: Purpose,
    refused: OnceLock<Failure>,
}

/// Purpose of the file, which decides how much of the disk it may use.
#[derive(Clone, Copy)]
enum Purpose {
    Download,
    Scan,
}

impl DiskQuota {
    /// The quota of a download of at most this many bytes.
    ///
    /// # Errors
    /// Returns `disk_full` if it would not leave `reserve_bytes` and what captures may still need.
    pub fn take(state: &Arc<DaemonState>, bytes: u64) -> Result<Arc<Self>, Failure> {
        let quota = Self::new(state, Purpose::Download);
        quota.check(bytes)?;
        Ok(Arc::new(quota))
    }

    /// The quota of a scan's own cloud: the whole disk.
    #[must_use]
    pub fn of_scan(state: &Arc<DaemonState>) -> Arc<Self> {
        Arc::new(Self::new(state, Purpose::Scan))
    }

    fn new(state: &Arc<DaemonState>, purpose: Purpose) -> Self {
        Self {
            state: Arc::clone(state),
            purpose,
            refused: OnceLock::new(),
        }
    }

    /// Checks whether this many more bytes may be written.
    fn check(&self, bytes: u64) -> Result<(), Failure> {
        let state = &self.state;
        if let Purpose::Download = self.purpose {
            let megabytes = bytes.div_ceil(1_000_000);
            let need = format!("this cloud may need {megabytes} MB more");
            return plan::check_room(state, bytes, &need);
        }
        match (state.free_bytes)(state.scans.folder()) {
            Ok(free) if free.saturating_sub(RECORDS_RESERVE) < bytes => Err(full(free)),
            _ => Ok(()),
        }
    }

    /// Reason of a refused write.
    #[must_use]
    pub fn refused(&self) -> Option<&Failure> {
        self.refused.get()
    }
}

/// The failure of a scan's cloud without disk space.
fn full(free: u64) -> Failure {
    let message = format!("the disk is full: {} MB free", free / 1_000_000);
    Failure::new(Kind::Incomplete, message)
        .help("free some space on the disk of the scans, or delete scans: then the daemon makes the cloud")
}

/// A file with a quota, which is checked again as the file grows.
pub struct QuotaFile<F> {
    file: F,
    quota: Arc<DiskQuota>,
    /// Bytes until the next check.
    left: u64,
}

impl<F> QuotaFile<F> {
    /// A file with its quota.
    #[must_use]
    pub const fn new(file: F, quota: Arc<DiskQuota>) -> Self {
        Self {
            file,
            quota,
            left: 0,
        }
    }
}

impl<F: Write> QuotaFile<F> {
    fn refuse(&self, failure: Failure) -> io::Error {
        let error = io::Error::new(io::ErrorKind::StorageFull, failure.message.clone());
        // The first refusal counts.
        let _ = self.quota.refused.set(failure);
        error
    }
}

impl<F: Write> Write for QuotaFile<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let wanted = bytes.len() as u64;
        if self.left < wanted {
            let checked = self.quota.check(wanted);
            checked.map_err(|failure| self.refuse(failure))?;
            self.left = CHECK_INTERVAL.max(wanted);
        }
        let written = match self.file.write(bytes) {
            // Other programs wrote meanwhile.
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

impl<F: Read> Read for QuotaFile<F> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.file.read(into)
    }
}

impl<F: Seek> Seek for QuotaFile<F> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}
