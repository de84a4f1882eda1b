//! The scans folder: a folder a scan, and nothing remembered that is not in there.
//!
//! Left out: how scans are made.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use io::files::{NewFile, Overwrite};
use serde::{Deserialize, Serialize};

use super::limits::NAME_BYTES;
use crate::failure::{Failure, Kind};
use crate::job::Outcome;
use crate::output::file_failure;
use crate::report::Reception;
use crate::setup::Asked;

/// The log in a scan's folder.
pub const LOG: &str = "log.pcapng";
/// The cloud.
pub const CLOUD: &str = "cloud.ply";
/// The picture.
pub const THUMBNAIL: &str = "thumbnail.png";
const RECORD: &str = "scan.json";

/// How far a scan is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ScanState {
    /// The devices are being recorded.
    Recording,
    /// The log is complete, the cloud is being made.
    Making,
    /// All that was asked for is there.
    Whole,
    /// Less than what was asked for.
    Partial,
    /// There is no cloud.
    Failed,
}

impl ScanState {
    /// Whether nothing is to be expected any more.
    #[must_use]
    pub const fn is_final(self) -> bool {
        matches!(self, Self::Whole | Self::Partial | Self::Failed)
    }
}

/// What is kept of a scan beside its files: `scan.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScanRecord {
    /// The name of its folder.
    pub id: String,
    /// What the user called it.
    pub name: Option<String>,
    /// How far it is.
    pub state: ScanState,
    /// Why it is not whole.
    pub why: Option<Failure>,
    /// When it was begun, Unix seconds.
    pub started_s: f64,
    /// Whether the devices were software.
    pub simulated: bool,
    /// What was asked for; absent where nobody knows any more.
    pub asked: Option<Asked>,
    /// Points of the cloud.
    pub points: Option<u64>,
    /// Length of the recording, seconds.
    pub duration_s: Option<f64>,
    /// What was said on the way.
    #[serde(default)]
    pub messages: Vec<String>,
    /// What went wrong with the recording itself.
    #[serde(default)]
    pub recording: Option<Failure>,
    /// Records that were lost.
    #[serde(default)]
    pub lost_records: u64,
    /// What was heard.
    #[serde(default)]
    pub reception: Option<Reception>,
    /// What `capture --json` prints.
    #[serde(default)]
    pub report: Option<serde_json::Value>,
}

impl ScanRecord {
    /// What there is to say of its recording.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        Outcome {
            failure: self.recording.clone(),
            lost_records: self.lost_records,
            reception: self.reception,
        }
    }
}

/// A scan as a list shows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScanView {
    /// Which.
    pub id: String,
    /// What the user called it.
    pub name: Option<String>,
    /// How far it is.
    pub state: ScanState,
    /// Why it is not whole.
    pub why: Option<Failure>,
    /// When it was begun, Unix seconds.
    pub started_s: f64,
    /// Whether the devices were software.
    pub simulated: bool,
    /// What was asked for.
    pub asked: Option<Asked>,
    /// Points of the cloud.
    pub points: Option<u64>,
    /// Length of the recording, seconds.
    pub duration_s: Option<f64>,
    /// All its files.
    pub bytes: u64,
    /// Its log.
    pub log_bytes: Option<u64>,
    /// Its cloud.
    pub cloud_bytes: Option<u64>,
    /// Whether there is a picture.
    pub thumbnail: bool,
}

/// One with everything.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WholeView {
    /// As in the list.
    #[serde(flatten)]
    pub scan: ScanView,
    /// What was said on the way.
    pub messages: Vec<String>,
    /// What went wrong with the recording itself.
    pub recording: Option<Failure>,
    /// Records that were lost.
    pub lost_records: u64,
    /// What was heard.
    pub reception: Option<Reception>,
    /// What `capture --json` prints.
    pub report: Option<serde_json::Value>,
}

/// The scans of a folder.
#[derive(Debug)]
pub struct Scans {
    folder: PathBuf,
    scans: Mutex<BTreeMap<String, ScanRecord>>,
}

fn cannot(path: &Path, what: &str, error: &std::io::Error) -> Failure {
    Failure::new(
        Kind::BadInput,
        format!("{}: cannot {what}: {error}", path.display()),
    )
    .help("see whether the disk is full and the folder may be written to; scans = \"...\" under [daemon] names another")
}

/// Takes the scans folder for this process, making it where it is missing, until what is returned is dropped.
///
/// # Errors
/// [`Kind::BadInput`] where another daemon has it, or it cannot be written to.
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

impl Scans {
    /// The scans in `folder`, which is made where it is missing. Those that were under way when nobody could end them are
    /// [`ScanState::Making`]: [`Scans::unfinished`] lists them.
    ///
    /// # Errors
    /// Where the folder cannot be made or read.
    pub fn open(folder: &Path) -> Result<Self, Failure> {
        fs::create_dir_all(folder).map_err(|error| cannot(folder, "make the folder", &error))?;
        let mut scans = BTreeMap::new();
        let entries = fs::read_dir(folder).map_err(|error| cannot(folder, "read", &error))?;
        for entry in entries.flatten() {
            let (path, name) = (entry.path(), entry.file_name());
            if let Some(name) = name.to_str()
                && path.is_dir()
                && let Some(record) = found(&path, name)
            {
                scans.insert(name.to_owned(), record);
            }
        }
        Ok(Self {
            folder: folder.to_owned(),
            scans: Mutex::new(scans),
        })
    }

    fn scans(&self) -> MutexGuard<'_, BTreeMap<String, ScanRecord>> {
        self.scans.lock().unwrap_or_else(PoisonError::into_inner)
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

    /// A scan begins: its folder is made.
    ///
    /// # Errors
    /// [`Kind::Usage`] for a name that cannot be one, and where the folder cannot be written to.
    pub fn begin(&self, asked: &Asked, simulated: bool) -> Result<ScanRecord, Failure> {
        if let Some(name) = &asked.name {
            check_name(name)?;
        }
        let now = std::time::SystemTime::now();
        let (id, place) = self.new_place(asked.name.as_deref(), now, simulated)?;
        let started = now.duration_since(std::time::UNIX_EPOCH);
        let record = ScanRecord {
            id: id.clone(),
            name: asked.name.clone(),
            state: ScanState::Recording,
            why: None,
            started_s: started.map_or(0.0, |since| since.as_secs_f64()),
            simulated,
            asked: Some(asked.clone()),
            points: None,
            duration_s: None,
            messages: Vec::new(),
            recording: None,
            lost_records: 0,
            reception: None,
            report: None,
        };
        if let Err(failure) = store(&place, &record) {
            // What was made a moment ago; whatever stays of it is found at the next start.
            let _ = fs::remove_dir_all(&place);
            return Err(failure);
        }
        self.scans().insert(id, record.clone());
        Ok(record)
    }

    fn new_place(
        &self,
        name: Option<&str>,
        now: std::time::SystemTime,
        simulated: bool,
    ) -> Result<(String, PathBuf), Failure> {
        let dated = crate::names::cloud(now, simulated).with_extension("");
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
            match fs::create_dir(&place) {
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

    /// Changes a scan, in the list and on the disk. `None` where there is no such scan.
    ///
    /// # Errors
    /// Where it cannot be written; the list has it then.
    pub fn change(
        &self,
        id: &str,
        change: impl FnOnce(&mut ScanRecord),
    ) -> Result<Option<ScanView>, Failure> {
        let record = {
            let mut scans = self.scans();
            let Some(record) = scans.get_mut(id) else {
                return Ok(None);
            };
            change(record);
            record.clone()
        };
        store(&self.place(id), &record)?;
        Ok(Some(self.view_of(&record)))
    }

    /// Adds a sentence to what was said of a scan. It reaches the disk with the next change.
    pub fn say(&self, id: &str, message: &str) {
        if let Some(record) = self.scans().get_mut(id) {
            record.messages.push(message.to_owned());
        }
    }

    /// What is kept of a scan.
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

    /// A scan with everything.
    #[must_use]
    pub fn whole(&self, id: &str) -> Option<WholeView> {
        let record = self.record(id)?;
        Some(WholeView {
            scan: self.view_of(&record),
            messages: record.messages,
            recording: record.recording,
            lost_records: record.lost_records,
            reception: record.reception,
            report: record.report,
        })
    }

    /// Every scan, the newest first.
    #[must_use]
    pub fn list(&self) -> Vec<ScanView> {
        let mut records: Vec<ScanRecord> = self.scans().values().cloned().collect();
        records.sort_by(|a, b| {
            b.started_s
                .total_cmp(&a.started_s)
                .then_with(|| b.id.cmp(&a.id))
        });
        records.iter().map(|record| self.view_of(record)).collect()
    }

    /// Those whose log waits for a cloud.
    #[must_use]
    pub fn unfinished(&self) -> Vec<String> {
        let scans = self.scans();
        let making = scans.values().filter(|r| r.state == ScanState::Making);
        making.map(|record| record.id.clone()).collect()
    }

    fn view_of(&self, record: &ScanRecord) -> ScanView {
        let place = self.place(&record.id);
        let size = |name: &str| fs::metadata(place.join(name)).ok().map(|there| there.len());
        ScanView {
            id: record.id.clone(),
            name: record.name.clone(),
            state: record.state,
            why: record.why.clone(),
            started_s: record.started_s,
            simulated: record.simulated,
            asked: record.asked.clone(),
            points: record.points,
            duration_s: record.duration_s,
            bytes: bytes_in(&place),
            log_bytes: size(LOG),
            cloud_bytes: size(CLOUD),
            thumbnail: size(THUMBNAIL).is_some(),
        }
    }

    /// Deletes a scan for good; what it was.
    ///
    /// # Errors
    /// [`Kind::Usage`] while it is being made, and where the disk refuses.
    pub fn delete(&self, id: &str) -> Result<Option<ScanView>, Failure> {
        let Some(view) = self.view(id) else {
            return Ok(None);
        };
        if !view.state.is_final() {
            return Err(
                Failure::new(Kind::Usage, format!("the scan {id} is being made"))
                    .help("wait for it, or stop it first"),
            );
        }
        // Under another name first, which no start takes for a scan: half a scan is none.
        let (place, gone) = (self.place(id), self.folder.join(format!(".{id}.deleted")));
        fs::rename(&place, &gone).map_err(|error| cannot(&place, "delete", &error))?;
        self.scans().remove(id);
        fs::remove_dir_all(&gone).map_err(|error| cannot(&gone, "delete", &error))?;
        Ok(Some(view))
    }

    /// Scans and their bytes.
    #[must_use]
    pub fn size(&self) -> (u64, u64) {
        let ids: Vec<String> = self.scans().keys().cloned().collect();
        let bytes = ids.iter().map(|id| bytes_in(&self.place(id))).sum();
        (ids.len() as u64, bytes)
    }

    /// Deletes the oldest scans until there are no more than `scans` of no more than `bytes`; which. The newest stays.
    pub fn retain(&self, scans: u64, bytes: u64) -> Vec<ScanView> {
        let (mut count, mut size) = self.size();
        let list = self.list();
        let mut gone = Vec::new();
        for view in list.iter().skip(1).rev() {
            if count <= scans && size <= bytes {
                break;
            }
            if view.state.is_final() && matches!(self.delete(&view.id), Ok(Some(_))) {
                count -= 1;
                size = size.saturating_sub(view.bytes);
                gone.push(view.clone());
            }
        }
        gone
    }
}

/// Refuses a name that cannot be part of an id.
///
/// # Errors
/// [`Kind::Usage`].
pub fn check_name(name: &str) -> Result<(), Failure> {
    let allowed = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    if !name.is_empty() && name.len() <= NAME_BYTES && name.bytes().all(allowed) {
        return Ok(());
    }
    Err(Failure::new(
        Kind::Usage,
        format!("name: expected 1 to {NAME_BYTES} letters, digits, - or _"),
    )
    .help("choose another name, or leave it out: scans are named after their time"))
}

/// What a folder says about its scan. One that says nothing, but has a log, is a scan all the same.
fn found(place: &Path, name: &str) -> Option<ScanRecord> {
    // What was being deleted when the power went.
    if name.starts_with('.') {
        if name.ends_with(".deleted") {
            let _ = fs::remove_dir_all(place);
        }
        return None;
    }
    let told = fs::read(place.join(RECORD)).ok();
    let record = told.and_then(|text| serde_json::from_slice::<ScanRecord>(&text).ok());
    let has_log = place.join(LOG).is_file();
    let Some(mut record) = record else {
        return has_log.then(|| ScanRecord {
            id: name.to_owned(),
            name: None,
            state: ScanState::Making,
            why: None,
            started_s: modified_s(&place.join(LOG)),
            simulated: name.contains("simulated"),
            asked: None,
            points: None,
            duration_s: None,
            messages: Vec::new(),
            recording: Some(interrupted()),
            lost_records: 0,
            reception: None,
            report: None,
        });
    };
    // Folders may be renamed by hand.
    record.id = name.to_owned();
    match record.state {
        ScanState::Recording => {
            record.recording = Some(interrupted());
            record.state = ScanState::Making;
        }
        ScanState::Making | ScanState::Whole | ScanState::Partial | ScanState::Failed => {}
    }
    if record.state == ScanState::Making && !has_log {
        record.state = ScanState::Failed;
        record.why = Some(interrupted());
    }
    Some(record)
}

/// What is said of a scan that nobody ended.
fn interrupted() -> Failure {
    Failure::new(
        Kind::Incomplete,
        "the daemon or the machine was stopped in the middle of this scan",
    )
    .help("what the log held by then is here; scan again for the rest")
}

fn modified_s(path: &Path) -> f64 {
    let modified = fs::metadata(path).and_then(|there| there.modified()).ok();
    let since = modified.and_then(|at| at.duration_since(std::time::UNIX_EPOCH).ok());
    since.map_or(0.0, |since| since.as_secs_f64())
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

/// All files right in a folder.
fn bytes_in(place: &Path) -> u64 {
    let Ok(entries) = fs::read_dir(place) else {
        return 0;
    };
    let sizes = entries.flatten().filter_map(|entry| entry.metadata().ok());
    sizes.map(|there| there.len()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(name: Option<&str>) -> Asked {
        Asked {
            speed_deg_s: 10.0,
            name: name.map(str::to_owned),
            ..Asked::default()
        }
    }

    fn finished(scans: &Scans, name: Option<&str>) -> String {
        let id = scans.begin(&asked(name), true).unwrap().id;
        fs::write(scans.place(&id).join(CLOUD), [0; 100]).unwrap();
        let done = scans.change(&id, |record| record.state = ScanState::Whole);
        assert_eq!(done.unwrap().unwrap().cloud_bytes, Some(100));
        id
    }

    #[test]
    fn the_folder_is_the_truth() {
        let folder = tempfile::tempdir().unwrap();
        let scans = Scans::open(folder.path()).unwrap();
        let (first, second) = (finished(&scans, Some("hall")), finished(&scans, None));
        assert!(first.starts_with("hall-simulated-"), "{first}");
        let again = Scans::open(folder.path()).unwrap();
        assert_eq!(again.list(), scans.list());
        assert_eq!(again.delete(&first).unwrap().unwrap().id, first);
        assert_eq!(again.delete(&first).unwrap(), None);
        let left = Scans::open(folder.path()).unwrap().list();
        assert_eq!(left.len(), 1);
        assert_eq!(left[0].id, second);
    }

    #[test]
    fn what_nobody_ended_waits_for_its_cloud() {
        let folder = tempfile::tempdir().unwrap();
        let scans = Scans::open(folder.path()).unwrap();
        let with_log = scans.begin(&asked(Some("a")), false).unwrap().id;
        fs::write(scans.place(&with_log).join(LOG), b"log").unwrap();
        let without = scans.begin(&asked(Some("b")), false).unwrap().id;
        // Nobody can delete what is being made.
        assert!(scans.delete(&without).is_err());
        // A folder with nothing but a log, and one that is no scan.
        fs::create_dir(folder.path().join("copied")).unwrap();
        fs::write(folder.path().join("copied").join(LOG), b"log").unwrap();
        fs::create_dir(folder.path().join("other")).unwrap();
        let again = Scans::open(folder.path()).unwrap();
        let mut unfinished = again.unfinished();
        unfinished.sort();
        assert_eq!(unfinished, [with_log.as_str(), "copied"]);
        assert_eq!(again.view(&without).unwrap().state, ScanState::Failed);
        assert!(again.record(&with_log).unwrap().recording.is_some());
        assert_eq!(again.list().len(), 3);
    }

    #[test]
    fn the_oldest_go_when_there_are_too_many_and_the_newest_stays() {
        let folder = tempfile::tempdir().unwrap();
        let scans = Scans::open(folder.path()).unwrap();
        let ids: Vec<String> = (0..4).map(|_| finished(&scans, None)).collect();
        let gone = scans.retain(3, u64::MAX);
        assert_eq!(gone.len(), 1);
        assert_eq!(gone[0].id, ids[0]);
        // One scan has some hundred bytes.
        assert_eq!(scans.retain(3, 1).len(), 2);
        assert_eq!(scans.list()[0].id, ids[3]);
    }

    #[test]
    fn names_cannot_leave_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let scans = Scans::open(folder.path()).unwrap();
        for name in ["", "../x", "a/b", "a b", ".", &"x".repeat(61)] {
            let failure = scans.begin(&asked(Some(name)), true).unwrap_err();
            assert_eq!(failure.kind, Kind::Usage, "{name}");
        }
        assert_eq!(scans.view("../x"), None);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
