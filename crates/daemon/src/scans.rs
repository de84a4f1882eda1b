//! The scans folder: one folder per scan. All state is on disk.

mod deletion;
mod found;
mod summary;

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use io::files::{NewFile, Overwrite};

use crate::limits::MESSAGES;
use deletion::DeletedScan;
use engine::capture_request::CaptureRequest;
use engine::failure::{Failure, Kind};
use engine::output::file_failure;
use engine::service::scan_record::{
    ScanDetails, ScanEdit, ScanHead, ScanRecord, ScanState, ScanView, check_name,
};
use found::found;

/// The log in a scan's folder.
pub const LOG: &str = "log.pcapng";
/// The cloud.
pub const CLOUD: &str = "cloud.ply";
/// The thumbnail.
pub const THUMBNAIL: &str = "thumbnail.png";
const RECORD: &str = "scan.json";

/// The scans of a folder.
#[derive(Debug)]
pub struct Scans {
    folder: PathBuf,
    scans: Mutex<BTreeMap<String, ScanRecord>>,
    /// Held while a record is written, so that an older one never replaces a newer.
    writing: Mutex<()>,
    /// Scans whose last change is not on disk.
    unwritten: Mutex<BTreeSet<String>>,
    /// Sizes of finished scans in bytes; the status needs them every second.
    sizes: Mutex<BTreeMap<String, u64>>,
    /// Deleted scans that can be restored.
    deleted: Mutex<BTreeMap<String, DeletedScan>>,
}

fn cannot(path: &Path, what: &str, error: &std::io::Error) -> Failure {
    Failure::new(
        Kind::BadInput,
        format!("{}: cannot {what}: {error}", path.display()),
    )
    .help("check the free space and the write permission of the folder; scans = \"...\" under [daemon] names another")
}

/// Locks the scans folder for this process until the returned file is dropped. Makes the folder if
/// it is missing.
///
/// # Errors
/// Returns [`Kind::BadInput`] if another daemon has it or it is not writable.
pub fn lock(folder: &Path) -> Result<fs::File, Failure> {
    fs::create_dir_all(folder).map_err(|error| cannot(folder, "make the folder", &error))?;
    let path = folder.join(".lock");
    let file = fs::File::create(&path).map_err(|error| cannot(&path, "make", &error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(fs::TryLockError::WouldBlock) => Err(Failure::new(
            Kind::BadInput,
            format!("{}: another daemon keeps its scans here", folder.display()),
        )
        .help("end that one, or give this one another folder (scans = \"...\" under [daemon])")),
        Err(fs::TryLockError::Error(error)) => Err(cannot(&path, "lock", &error)),
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Scans {
    /// Opens the scans in `folder` and makes the folder if it is missing. Scans whose recording was
    /// interrupted are [`ScanState::Making`]: [`Scans::unfinished`] lists them.
    ///
    /// # Errors
    /// Returns the failure of making or reading the folder.
    pub fn open(folder: &Path) -> Result<Self, Failure> {
        fs::create_dir_all(folder).map_err(|error| cannot(folder, "make the folder", &error))?;
        let mut scans = BTreeMap::new();
        let entries = fs::read_dir(folder).map_err(|error| cannot(folder, "read", &error))?;
        for entry in entries.flatten() {
            let (path, name) = (entry.path(), entry.file_name());
            if let Some(name) = name.to_str()
                // Symbolic links are not followed.
                && entry.file_type().is_ok_and(|kind| kind.is_dir())
                && let Some(record) = found(&path, name)
            {
                scans.insert(name.to_owned(), record);
            }
        }
        number_those_without(&mut scans);
        Ok(Self {
            folder: folder.to_owned(),
            scans: Mutex::new(scans),
            writing: Mutex::default(),
            unwritten: Mutex::default(),
            sizes: Mutex::default(),
            deleted: Mutex::default(),
        })
    }

    fn scans(&self) -> MutexGuard<'_, BTreeMap<String, ScanRecord>> {
        locked(&self.scans)
    }

    /// The folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The folder of a scan.
    #[must_use]
    pub fn place(&self, id: &str) -> PathBuf {
        self.folder.join(id)
    }

    /// Begins a scan and makes its folder.
    ///
    /// # Errors
    /// Returns [`Kind::Usage`] for an invalid name, and the failure of a folder that is not
    /// writable.
    pub fn begin(&self, request: &CaptureRequest, simulated: bool) -> Result<ScanRecord, Failure> {
        if let Some(name) = &request.name {
            check_name(name)?;
        }
        let now = std::time::SystemTime::now();
        let (id, place) = self.new_place(request.name.as_deref(), now, simulated)?;
        let started = now.duration_since(std::time::UNIX_EPOCH);
        let record = ScanRecord {
            head: ScanHead {
                id: id.clone(),
                name: request.name.clone(),
                // Whole milliseconds survive JSON exactly.
                started_s: started.map_or(0.0, |since| since.as_millis() as f64 / 1e3),
                simulated,
                request: Some(request.clone()),
                ..ScanHead::default()
            },
            number: next_number(&self.scans()),
            ..ScanRecord::default()
        };
        let stored = store(&place, &record);
        io::files::sync_folder(&place);
        if let Err(failure) = stored {
            // The folder was made a moment ago; the next start handles what remains.
            let _ = fs::remove_dir_all(&place);
            return Err(failure);
        }
        self.scans().insert(id, record.clone());
        Ok(record)
    }

    /// Removes a scan that has just begun and has no data.
    pub fn forget(&self, id: &str) {
        self.scans().remove(id);
        // The rest is a failed scan at the next start.
        let _ = fs::remove_dir_all(self.place(id));
    }

    fn new_place(
        &self,
        name: Option<&str>,
        now: std::time::SystemTime,
        simulated: bool,
    ) -> Result<(String, PathBuf), Failure> {
        let dated = engine::default_paths::cloud(now, simulated).with_extension("");
        let dated = dated.to_string_lossy();
        let dated = dated.trim_start_matches("velomotion-");
        let base = match name {
            Some(name) => format!("{name}-{dated}"),
            None => dated.to_owned(),
        };
        let mut number = 1;
        loop {
            let id = match number {
                1 => base.clone(),
                _ => format!("{base}-{number}"),
            };
            let place = self.place(&id);
            let made = match self.can_restore(&id) {
                false => fs::create_dir(&place),
                true => Err(std::io::ErrorKind::AlreadyExists.into()),
            };
            match made {
                Ok(()) => return Ok((id, place)),
                Err(error)
                    if error.kind() == std::io::ErrorKind::AlreadyExists && number < 1_000 =>
                {
                    number += 1;
                }
                Err(error) => return Err(cannot(&place, "make the folder", &error)),
            }
        }
    }

    /// Changes a scan in the list and on disk. Returns `None` for an unknown scan.
    ///
    /// # Errors
    /// Returns the failure of writing. The list then has the change, and [`Scans::settle`] writes
    /// it once there is space.
    pub fn change(
        &self,
        id: &str,
        change: impl FnOnce(&mut ScanRecord),
    ) -> Result<Option<ScanView>, Failure> {
        match self.scans().get_mut(id) {
            Some(record) => change(record),
            None => return Ok(None),
        }
        let stored = self.write(id);
        locked(&self.sizes).remove(id);
        if let Err(failure) = stored {
            locked(&self.unwritten).insert(id.to_owned());
            return Err(failure);
        }
        Ok(self.view(id))
    }

    /// Sets name and notes of a scan. Returns `None` for an unknown scan.
    ///
    /// # Errors
    /// Returns [`Kind::Incomplete`] for a scan whose record is not overwritten, and the failure of
    /// writing. Nothing is changed then.
    pub fn edit(&self, id: &str, edit: &ScanEdit) -> Result<Option<ScanView>, Failure> {
        let Some(before) = self.record(id) else {
            return Ok(None);
        };
        if before.unreadable {
            let message =
                format!("the record of the scan {id} cannot be read, and is left as it is");
            return Err(Failure::new(Kind::Incomplete, message)
                .help("the reason of the scan's state says what is wrong with it"));
        }
        let changed = self.change(id, |record| edit.apply(record));
        if changed.is_err()
            && let Some(record) = self.scans().get_mut(id)
        {
            (record.head.name, record.head.notes) = (before.head.name, before.head.notes);
        }
        changed
    }

    /// Writes the present record of a scan.
    fn write(&self, id: &str) -> Result<(), Failure> {
        let _writing = locked(&self.writing);
        match self.record(id) {
            Some(record) if !record.unreadable => store(&self.place(id), &record),
            _ => Ok(()),
        }
    }

    /// Writes records that could not be written before.
    pub fn settle(&self) {
        let waiting = std::mem::take(&mut *locked(&self.unwritten));
        for id in waiting {
            if self.write(&id).is_err() {
                locked(&self.unwritten).insert(id);
            }
        }
    }

    /// Adds a message to a scan, up to a limit. It reaches the disk with the next change.
    pub fn say(&self, id: &str, message: &str) {
        if let Some(record) = self.scans().get_mut(id)
            && record.messages.len() < MESSAGES
        {
            record.messages.push(message.to_owned());
        }
    }

    /// The record of a scan.
    #[must_use]
    pub fn record(&self, id: &str) -> Option<ScanRecord> {
        self.scans().get(id).cloned()
    }

    /// A scan as lists show it.
    #[must_use]
    pub fn view(&self, id: &str) -> Option<ScanView> {
        let record = self.record(id)?;
        Some(self.view_of(&record))
    }

    /// A scan with all details.
    #[must_use]
    pub fn whole(&self, id: &str) -> Option<ScanDetails> {
        let record = self.record(id)?;
        Some(ScanDetails {
            scan: self.view_of(&record),
            messages: record.messages,
            recording: record.recording,
            lost_records: record.lost_records,
            warnings: record.warnings,
            reception: record.reception,
            report: record.report,
        })
    }

    /// Every scan, the newest first.
    #[must_use]
    pub fn list(&self) -> Vec<ScanView> {
        self.part(None, usize::MAX)
    }

    /// At most `limit` scans older than `before`, the newest first.
    #[must_use]
    pub fn part(&self, before: Option<&str>, limit: usize) -> Vec<ScanView> {
        let scans = self.scans();
        let mut records: Vec<&ScanRecord> = scans.values().collect();
        records.sort_by(|a, b| order(b, a));
        let newer = before.and_then(|id| records.iter().position(|record| record.id == id));
        let older = records.iter().skip(newer.map_or(0, |at| at + 1));
        let part: Vec<ScanRecord> = older.take(limit).copied().cloned().collect();
        // The disk is not waited for under the lock.
        drop(scans);
        part.iter().map(|record| self.view_of(record)).collect()
    }

    /// Scans being recorded or made.
    #[must_use]
    pub fn under_way(&self) -> Vec<ScanView> {
        let records = self.select(|record| !record.state.is_final());
        records.iter().map(|record| self.view_of(record)).collect()
    }

    fn select(&self, wanted: impl Fn(&ScanRecord) -> bool) -> Vec<ScanRecord> {
        let scans = self.scans();
        scans.values().filter(|r| wanted(r)).cloned().collect()
    }

    /// Scans whose log waits for its cloud.
    #[must_use]
    pub fn unfinished(&self) -> Vec<String> {
        let making = self.select(|record| record.state == ScanState::Making);
        making.into_iter().map(|record| record.head.id).collect()
    }

    /// Scans whose cloud waits for disk space, oldest first.
    #[must_use]
    pub fn waiting(&self) -> Vec<String> {
        let mut waiting = self.select(|record| record.waits_for_room);
        waiting.sort_by(|a, b| a.started_s.total_cmp(&b.started_s));
        waiting.into_iter().map(|record| record.head.id).collect()
    }

    fn view_of(&self, record: &ScanRecord) -> ScanView {
        let place = self.place(&record.id);
        let size = |name: &str| {
            let there = fs::symlink_metadata(place.join(name)).ok()?;
            there.is_file().then_some(there.len())
        };
        ScanView {
            head: record.head.clone(),
            bytes: bytes_in(&place),
            log_bytes: size(LOG),
            cloud_bytes: size(CLOUD),
            thumbnail: size(THUMBNAIL).is_some(),
            summary: summary::of(record, &place, size(LOG).is_some()),
        }
    }

    /// Number of scans and their bytes.
    #[must_use]
    pub fn size(&self) -> (u64, u64) {
        let heads = self.scans();
        let scans: Vec<(String, bool)> = heads
            .values()
            .map(|record| (record.id.clone(), record.state.is_final()))
            .collect();
        drop(heads);
        let mut known = locked(&self.sizes);
        let kept = scans.iter().map(|(id, is_final)| match known.get(id) {
            Some(&bytes) if *is_final => bytes,
            _ => {
                let bytes = bytes_in(&self.place(id));
                known.insert(id.clone(), bytes);
                bytes
            }
        });
        let bytes = kept.sum();
        if known.len() > scans.len() {
            // Drops sizes of deleted scans.
            known.retain(|id, _| scans.iter().any(|(own, _)| own == id));
        }
        (scans.len() as u64, bytes)
    }
}

/// Order of two scans by time of creation.
fn order(a: &ScanRecord, b: &ScanRecord) -> Ordering {
    let by_number = a.number.cmp(&b.number);
    let by_time = || a.started_s.total_cmp(&b.started_s);
    by_number.then_with(by_time).then_with(|| a.id.cmp(&b.id))
}

fn next_number(scans: &BTreeMap<String, ScanRecord>) -> u64 {
    let newest = scans.values().map(|record| record.number).max();
    newest.unwrap_or(0).saturating_add(1)
}

/// Numbers logs without a record as the newest: they are not deleted first.
fn number_those_without(scans: &mut BTreeMap<String, ScanRecord>) {
    let next = next_number(scans);
    for record in scans.values_mut() {
        if record.number == 0 && record.state == ScanState::Making && record.request.is_none() {
            record.number = next;
        }
    }
}

fn store(place: &Path, record: &ScanRecord) -> Result<(), Failure> {
    let path = place.join(RECORD);
    let text = serde_json::to_vec_pretty(record).map_err(|error| {
        Failure::new(Kind::BadInput, format!("{}: {error}", path.display()))
            .help("this is a defect of the program")
    })?;
    let mut file =
        NewFile::create(&path, Overwrite::Replace).map_err(|error| file_failure(&error))?;
    file.write_all(&text)
        .map_err(|error| cannot(&path, "write", &error))?;
    file.commit().map_err(|error| file_failure(&error))
}

/// Bytes of all files directly in a folder.
fn bytes_in(place: &Path) -> u64 {
    let Ok(entries) = fs::read_dir(place) else {
        return 0;
    };
    let sizes = entries.flatten().filter_map(|entry| entry.metadata().ok());
    sizes.map(|there| there.len()).sum()
}

#[cfg(test)]
mod tests;
