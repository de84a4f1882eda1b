//! Deletion of scans, which can be undone for a time.
//!
//! A deleted scan's folder is renamed at once, to a name that no start takes for a scan. Its files
//! are removed when the time is over, or by the next start.

use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use super::{Scans, cannot, locked};
use crate::limits::UNDO;
use engine::failure::{Failure, Kind};
use engine::service::scan_record::{ScanRecord, ScanView};

/// A deleted scan whose files are kept until the time for undo is over.
#[derive(Debug)]
pub(super) struct DeletedScan {
    record: ScanRecord,
    kept_until: Instant,
}

impl Scans {
    /// The folder of a deleted scan.
    fn deleted_place(&self, id: &str) -> PathBuf {
        self.folder.join(format!(".{id}.deleted"))
    }

    /// Whether this scan is deleted and can be restored.
    pub(super) fn can_restore(&self, id: &str) -> bool {
        locked(&self.deleted).contains_key(id)
    }

    /// Deletes a scan permanently and returns it; `None` for an unknown one.
    ///
    /// # Errors
    /// Returns [`Kind::Usage`] while the scan is being made, and the failure of the disk.
    pub fn delete(&self, id: &str) -> Result<Option<ScanView>, Failure> {
        let Some((view, _)) = self.take_out(id)? else {
            return Ok(None);
        };
        self.remove_files(id)?;
        Ok(Some(view))
    }

    /// Deletes a scan that can be restored for [`UNDO`] from `now`, with those deleted before it.
    ///
    /// # Errors
    /// As [`Scans::delete`].
    pub fn delete_with_undo(&self, id: &str, now: Instant) -> Result<Option<ScanView>, Failure> {
        // Locked until the scan is in the list of deleted ones: it is always in one of both.
        let mut deleted = locked(&self.deleted);
        let Some((view, record)) = self.take_out(id)? else {
            return Ok(None);
        };
        let kept_until = now + UNDO;
        // A deletion of many is undone whole.
        for other in deleted.values_mut() {
            other.kept_until = other.kept_until.max(kept_until);
        }
        deleted.insert(id.to_owned(), DeletedScan { record, kept_until });
        Ok(Some(view))
    }

    /// Restores a deleted scan and returns it; `None` if there is none of this id any more.
    ///
    /// # Errors
    /// Returns the failure of the disk. The scan is still deleted then.
    pub fn restore(&self, id: &str) -> Result<Option<ScanView>, Failure> {
        let mut deleted = locked(&self.deleted);
        let Some(scan) = deleted.get(id) else {
            return Ok(None);
        };
        let (place, gone) = (self.place(id), self.deleted_place(id));
        fs::rename(&gone, &place).map_err(|error| cannot(&gone, "restore", &error))?;
        self.scans().insert(id.to_owned(), scan.record.clone());
        deleted.remove(id);
        Ok(self.view(id))
    }

    /// Removes the files of deleted scans that cannot be restored any more.
    ///
    /// # Errors
    /// Returns the failure of the disk; the next start removes what remains.
    pub fn remove_deleted(&self, now: Instant) -> Result<(), Failure> {
        let mut expired = Vec::new();
        locked(&self.deleted).retain(|id, scan| {
            let kept = now < scan.kept_until;
            if !kept {
                expired.push(id.clone());
            }
            kept
        });
        let removed: Vec<_> = expired.iter().map(|id| self.remove_files(id)).collect();
        removed.into_iter().collect()
    }

    /// Takes a scan out of the list and renames its folder: a half-deleted scan is none.
    fn take_out(&self, id: &str) -> Result<Option<(ScanView, ScanRecord)>, Failure> {
        let Some(view) = self.view(id) else {
            return Ok(None);
        };
        if !view.state.is_final() {
            return Err(
                Failure::new(Kind::Usage, format!("the scan {id} is being made"))
                    .help("wait for it, or stop it first"),
            );
        }
        let (place, gone) = (self.place(id), self.deleted_place(id));
        fs::rename(&place, &gone).map_err(|error| cannot(&place, "delete", &error))?;
        let record = self.scans().remove(id);
        locked(&self.sizes).remove(id);
        Ok(record.map(|record| (view, record)))
    }

    fn remove_files(&self, id: &str) -> Result<(), Failure> {
        let gone = self.deleted_place(id);
        fs::remove_dir_all(&gone).map_err(|error| cannot(&gone, "delete", &error))
    }

    /// Deletes the oldest scans until at most `scans` remain with at most `bytes`, and returns
    /// them. It keeps the newest, and those with an unreadable record.
    pub fn retain(&self, scans: u64, bytes: u64) -> Vec<ScanView> {
        let (mut count, mut size) = self.size();
        let list = self.list();
        let mut gone = Vec::new();
        for view in list.iter().skip(1).rev() {
            if count <= scans && size <= bytes {
                break;
            }
            let kept = self.record(&view.id).is_none_or(|record| record.unreadable);
            if view.state.is_final() && !kept && matches!(self.delete(&view.id), Ok(Some(_))) {
                count -= 1;
                size = size.saturating_sub(view.bytes);
                gone.push(view.clone());
            }
        }
        gone
    }
}
