//! The thread that makes clouds from logs: after each capture, at the start for scans without one,
//! and after a full disk as soon as it has room.

use std::fs;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use cloud::Fields;
use cloud::formats::Format;
use io::files::{NewFile, Overwrite};
use scanner::Accuracy;
use sim::Truth;

use engine::capture::{completeness, run};
use engine::document::Document;
use engine::failure::{Failure, Kind};
use engine::output::{BufferedFile, Target, file_failure};
use engine::reconstruct::report::ScanReport;
use engine::service::events::MessageLevel;
use engine::service::scan_record::ScanState;

use crate::disk_quota::{DiskQuota, QuotaFile};
use crate::plan;
use crate::scans::THUMBNAIL;
use crate::state::{Counters, DaemonState};
use crate::thumbnail::Thumbnail;

/// Between two checks whether the disk has room again.
const ROOM_POLL: Duration = Duration::from_secs(1);

/// A log whose cloud is to be made.
pub struct CloudJob {
    /// Id of the scan.
    pub id: String,
    /// Accuracy of the cloud.
    pub accuracy: Accuracy,
    /// The simulator's truth, where the devices were simulated.
    pub truth: Option<Truth>,
    /// Records lost on the way to the log.
    pub lost_records: u64,
}

/// Jobs of scans whose cloud was not finished.
#[must_use]
pub(crate) fn unfinished(state: &DaemonState) -> Vec<CloudJob> {
    let ids = state.scans.unfinished().into_iter();
    let jobs = ids.map(|id| {
        clean(&state.scans.place(&id));
        job_again(state, id)
    });
    jobs.collect()
}

/// The job of a scan, made from its record.
fn job_again(state: &DaemonState, id: String) -> CloudJob {
    let record = state.scans.record(&id);
    CloudJob {
        accuracy: record.as_ref().map_or(Accuracy::Best, |r| r.accuracy()),
        lost_records: record.map_or(0, |record| record.lost_records),
        id,
        truth: None,
    }
}

/// The job of the oldest scan that waits for room, if there is room now. Reserved bytes and those
/// promised to captures do not count.
fn job_with_room(state: &Arc<DaemonState>) -> Option<CloudJob> {
    if state.service.is_ending() {
        return None;
    }
    let id = state.scans.waiting().into_iter().next()?;
    let log_bytes = fs::metadata(state.log(&id)).map_or(0, |there| there.len());
    DiskQuota::take(state, plan::most_cloud_bytes(log_bytes)).ok()?;
    state.change_scan(&id, |record| {
        record.state = ScanState::Making;
        record.waits_for_room = false;
    });
    Some(job_again(state, id))
}

/// Removes half-written files.
fn clean(place: &Path) {
    let Ok(entries) = fs::read_dir(place) else {
        return;
    };
    for entry in entries.flatten() {
        if io::files::is_half_written(&entry.file_name()) {
            // A file that cannot be removed only takes room.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Makes clouds until the queue is closed.
pub fn run(state: &Arc<DaemonState>, queue: &Receiver<CloudJob>) {
    loop {
        let job = match queue.recv_timeout(ROOM_POLL) {
            Ok(job) => job,
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => match job_with_room(state) {
                Some(job) => job,
                None => continue,
            },
        };
        if state.abandon.load(Ordering::Acquire) {
            // The next start makes the cloud.
            continue;
        }
        build(state, &job);
        state.delete_excess_scans();
    }
}

fn build(state: &Arc<DaemonState>, job: &CloudJob) {
    let id = job.id.as_str();
    let quota = DiskQuota::of_scan(state);
    let thumbnail = Thumbnail::default();
    let made = catch_unwind(AssertUnwindSafe(|| cloud(state, job, &quota, &thumbnail)));
    let made = made.unwrap_or_else(|_| Err(defect()));
    if state.abandon.load(Ordering::Acquire) {
        return;
    }
    let Some(record) = state.scans.record(id) else {
        return;
    };
    let (cloud, log) = (state.cloud(id), state.log(id));
    if made.is_ok()
        && let Err(failure) = store_thumbnail(&thumbnail, &state.scans.place(id).join(THUMBNAIL))
    {
        state.events().failure(MessageLevel::Warning, failure);
    }
    let waits = made.is_err() && quota.refused().is_some();
    let missing = made.as_ref().ok().and_then(completeness::missing);
    let concluded = run::conclude(made, record.outcome(), (&cloud, &log));
    if let Ok((scan, _)) = &concluded
        && let Some((rms_m, worst_m)) = scan.live.and_then(|live| live.rms_m.zip(live.worst_m))
    {
        let (rms_mm, worst_mm) = (rms_m * 1e3, worst_m * 1e3);
        let text = format!(
            "scan {id}: the live points were RMS {rms_mm:.1} mm, at worst {worst_mm:.1} mm from the cloud's"
        );
        state.events().message(MessageLevel::Info, text, None);
    }
    let counters = &state.counters;
    match &concluded {
        Ok((scan, None)) => {
            tracing::info!("scan {id}: whole, {} points", scan.points);
            Counters::count(&counters.whole);
        }
        Ok((scan, Some(why))) => {
            tracing::warn!("scan {id}: partial, {} points: {}", scan.points, why.cause);
            Counters::count(&counters.partial);
        }
        Err(why) if waits => {
            tracing::error!("scan {id}: no cloud until there is room: {}", why.cause)
        }
        Err(why) => {
            tracing::error!("scan {id}: no cloud: {}", why.cause);
            Counters::count(&counters.failed);
        }
    }
    state.change_scan(id, |record| match concluded {
        Ok((scan, failure)) => {
            record.state = match &failure {
                None => ScanState::Whole,
                Some(_) => ScanState::Partial,
            };
            record.set_failure(failure);
            record.recording = record.recording.take().or(missing);
            record.points = Some(scan.points);
            record.duration_s = Some(scan.contents.duration_s);
            record.report = Some(scan.to_json());
        }
        Err(failure) => {
            record.state = ScanState::Failed;
            record.waits_for_room = waits;
            record.set_failure(Some(failure));
        }
    });
}

/// The failure of a cloud whose making panicked.
pub(crate) fn defect() -> Failure {
    Failure::new(
        Kind::Incomplete,
        "an internal error ended the cloud's reconstruction",
    )
    .help("run velomotion replay on the log with -vv and report the messages")
}

/// Draws and stores a thumbnail. A panic in it is a failure.
fn store_thumbnail(thumbnail: &Thumbnail, to: &Path) -> Result<(), Failure> {
    let cannot = |error: &dyn std::fmt::Display| {
        Failure::new(
            Kind::Incomplete,
            format!("{}: no thumbnail: {error}", to.display()),
        )
        .help("the scan is complete without it; see whether the disk is full, else report the daemon's messages with -vv")
    };
    let png = catch_unwind(AssertUnwindSafe(|| thumbnail.png()))
        .map_err(|_| cannot(&"a defect of the program"))?
        .map_err(|error| cannot(&error))?;
    let mut file = NewFile::create(to, Overwrite::Replace).map_err(|error| file_failure(&error))?;
    file.write_all(&png).map_err(|error| cannot(&error))?;
    file.commit().map_err(|error| file_failure(&error))
}

fn cloud(
    state: &DaemonState,
    job: &CloudJob,
    quota: &Arc<DiskQuota>,
    thumbnail: &Thumbnail,
) -> Result<ScanReport, Failure> {
    let target = Target::file(&state.cloud(&job.id), true, |file| {
        let file = BufferedFile::new(QuotaFile::new(file, Arc::clone(quota)));
        Box::new((Format::Ply.writer(file, Fields::FILE), thumbnail.clone()))
    })?;
    let log = state.log(&job.id);
    let log = (log.as_path(), job.accuracy);
    let made = run::cloud(
        log,
        job.truth.as_ref(),
        true,
        job.lost_records,
        &state.abandon,
        target,
    );
    made.map_err(|failure| match quota.refused() {
        Some(full) => full.clone(),
        None => failure,
    })
}
