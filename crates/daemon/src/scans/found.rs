//! Scans that a daemon finds at its start, interrupted ones included.

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;

use super::{CLOUD, LOG, RECORD};
use engine::failure::{Failure, Kind};
use engine::reconstruct::source::Source;
use engine::service::scan_record::{ScanHead, ScanRecord, ScanState};

/// Bytes of the largest record; those of captures have some kB.
const MAX_RECORD: u64 = 16 << 20;
/// Bytes at the beginning of a cloud that hold its mark: the first comment of a PLY file.
const PLY_HEADER: u64 = 4096;

/// The record of a scan's folder. A folder with a log and no record is a scan, too.
pub(super) fn found(place: &Path, name: &str) -> Option<ScanRecord> {
    // A deletion that a power failure interrupted.
    if name.starts_with('.') {
        if name.ends_with(".deleted") {
            let _ = fs::remove_dir_all(place);
        }
        return None;
    }
    let has_log = is_file(&place.join(LOG));
    let mut record = match read(&place.join(RECORD)) {
        Ok(text) => match serde_json::from_slice::<ScanRecord>(&text) {
            Ok(record) => record,
            Err(error) => return Some(unreadable(place, name, &error)),
        },
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return has_log.then(|| without_record(place, name));
        }
        Err(error) => return Some(unreadable(place, name, &error)),
    };
    // Folders may have been renamed by hand.
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

/// Whether this is a regular file, not a link to one.
fn is_file(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|there| there.is_file())
}

fn read(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let file = io::files::open_regular(path)?;
    file.take(MAX_RECORD).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Record of a log that a user put there. A cloud next to it is kept as well.
fn without_record(place: &Path, name: &str) -> ScanRecord {
    let mut record = of_folder(place, name);
    match is_file(&place.join(CLOUD)) {
        false => {
            record.state = ScanState::Making;
            record.recording = Some(interrupted());
        }
        true => {
            record.state = ScanState::Partial;
            let failure = Failure::new(
                Kind::Incomplete,
                format!("it is unknown how this cloud was made: its folder has no {RECORD}"),
            );
            record.why = Some(failure.help("replay its log to see what it holds"));
        }
    }
    record
}

/// Record of a scan whose own is damaged or of a later version.
fn unreadable(place: &Path, name: &str, error: &dyn std::fmt::Display) -> ScanRecord {
    let mut record = of_folder(place, name);
    record.unreadable = true;
    record.state = match is_file(&place.join(CLOUD)) {
        true => ScanState::Partial,
        false => ScanState::Failed,
    };
    let failure = Failure::new(
        Kind::Incomplete,
        format!("{RECORD} cannot be read: {error}"),
    );
    record.why = Some(failure.help(
        "the files are as they were; if a later velomotion made the scan, use that one, else replay the log",
    ));
    record
}

/// Record made from the folder alone.
fn of_folder(place: &Path, name: &str) -> ScanRecord {
    let head = ScanHead {
        id: name.to_owned(),
        state: ScanState::Failed,
        started_s: modified_s(&place.join(LOG)),
        simulated: is_simulated(place),
        ..ScanHead::default()
    };
    ScanRecord {
        head,
        ..ScanRecord::default()
    }
}

/// Whether the log, or the cloud of a scan without a readable log, says that its devices were
/// software.
fn is_simulated(place: &Path) -> bool {
    let log = place.join(LOG);
    let config = || Source::open(&log, None)?.config();
    if is_file(&log)
        && let Ok(config) = config()
    {
        return config.simulated;
    }
    let cloud = place.join(CLOUD);
    let mut header = Vec::new();
    is_file(&cloud)
        && File::open(&cloud)
            .and_then(|file| file.take(PLY_HEADER).read_to_end(&mut header))
            .is_ok()
        && header.windows(9).any(|letters| letters == b"SIMULATED")
}

/// The failure of an interrupted scan.
fn interrupted() -> Failure {
    Failure::new(
        Kind::Incomplete,
        "the daemon or the machine was stopped in the middle of this scan",
    )
    .help("the scan has what was recorded until then; scan again for the rest")
}

fn modified_s(path: &Path) -> f64 {
    let modified = fs::metadata(path).and_then(|there| there.modified()).ok();
    let since = modified.and_then(|at| at.duration_since(std::time::UNIX_EPOCH).ok());
    since.map_or(0.0, |since| since.as_secs_f64())
}
