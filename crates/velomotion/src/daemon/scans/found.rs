//! What the scans folder holds when a daemon starts: also of scans that nobody ended.

use std::fs;
use std::path::Path;

use super::{LOG, RECORD, ScanHead, ScanRecord, ScanState};
use crate::failure::{Failure, Kind};

/// What a folder says about its scan. One that says nothing, but has a log, is a scan all the same.
pub(super) fn found(place: &Path, name: &str) -> Option<ScanRecord> {
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
            recording: Some(interrupted()),
            ..ScanRecord::new(ScanHead {
                id: name.to_owned(),
                name: None,
                state: ScanState::Making,
                why: None,
                waits_for_room: false,
                started_s: modified_s(&place.join(LOG)),
                simulated: name.contains("simulated"),
                asked: None,
                points: None,
                duration_s: None,
            })
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
