//! The thread that makes clouds of logs: after each capture, at the start of those that were never made, and where the disk was full once there
//! is room.

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
use scanner::{Accuracy, TiltSource};
use sim::Truth;

use super::hub::Level;
use super::plan;
use super::room::{Room, Roomy};
use super::scans::{ScanState, THUMBNAIL};
use super::shared::{Counters, Shared};
use crate::thumbnail;
use engine::capture::run as job;
use engine::failure::{Failure, Kind};
use engine::output::{Buffered, Target, file_failure};
use engine::reconstruct::replay::TimeReference;
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::report::ScanReport;
use engine::reconstruct::source::Source;

/// How often it is looked whether there is room again.
const LOOK: Duration = Duration::from_secs(1);

/// A log that waits for its cloud.
pub struct Making {
    /// The scan.
    pub id: String,
    /// How accurate the cloud is to be.
    pub accuracy: Accuracy,
    /// What truly happened, where a simulator knows.
    pub truth: Option<Truth>,
    /// Records that were lost on the way to the log.
    pub lost_records: u64,
}

/// Those that were never made.
#[must_use]
pub fn left_over(shared: &Shared) -> Vec<Making> {
    let ids = shared.scans.unfinished().into_iter();
    let making = ids.map(|id| {
        clean(&shared.scans.place(&id));
        once_more(shared, id)
    });
    making.collect()
}

/// The log of a scan whose making has ended before there was a cloud.
fn once_more(shared: &Shared, id: String) -> Making {
    let record = shared.scans.record(&id);
    let lost_records = record.as_ref().map_or(0, |record| record.lost_records);
    let asked = record.and_then(|record| record.head.asked);
    Making {
        accuracy: asked
            .and_then(|asked| asked.accuracy().ok())
            .unwrap_or(Accuracy::Best),
        id,
        truth: None,
        lost_records,
    }
}

/// The oldest of those for which there was no room, if there is room now: of nothing that is left free or a scan was promised.
fn with_room_now(shared: &Arc<Shared>) -> Option<Making> {
    if shared.is_ending() {
        return None;
    }
    let id = shared.scans.waiting().into_iter().next()?;
    let log_bytes = fs::metadata(shared.log(&id)).map_or(0, |there| there.len());
    Room::take(shared, plan::most_cloud_bytes(log_bytes)).ok()?;
    shared.change_scan(&id, |record| {
        record.state = ScanState::Making;
        record.waits_for_room = false;
    });
    Some(once_more(shared, id))
}

/// Removes what was half written. Whatever else lies there is somebody's.
fn clean(place: &Path) {
    let Ok(entries) = fs::read_dir(place) else {
        return;
    };
    for entry in entries.flatten() {
        if io::files::is_half_written(&entry.file_name()) {
            // What cannot be removed only takes room.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Makes clouds until nobody sends logs any more.
pub fn run(shared: &Arc<Shared>, logs: &Receiver<Making>) {
    loop {
        let making = match logs.recv_timeout(LOOK) {
            Ok(making) => making,
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => match with_room_now(shared) {
                Some(making) => making,
                None => continue,
            },
        };
        if shared.abandon.load(Ordering::Acquire) {
            // Its state says that the cloud is to be made: the next start does it.
            continue;
        }
        make(shared, &making);
        shared.retain();
    }
}

fn make(shared: &Arc<Shared>, making: &Making) {
    let id = making.id.as_str();
    let room = Room::of_scan(shared);
    let made = catch_unwind(AssertUnwindSafe(|| cloud(shared, making, &room)));
    let made = made.unwrap_or_else(|_| {
        Err(Failure::new(
            Kind::Incomplete,
            "a defect of the program ended the making of the cloud",
        )
        .help("run velomotion replay on the log with -vv and report what it says"))
    });
    if shared.abandon.load(Ordering::Acquire) {
        return;
    }
    let Some(record) = shared.scans.record(id) else {
        return;
    };
    let (cloud, log) = (shared.cloud(id), shared.log(id));
    if made.is_ok()
        && let Err(failure) = picture(&cloud, &shared.scans.place(id).join(THUMBNAIL))
    {
        // The cloud is what counts.
        shared
            .hub
            .say(Level::Warning, failure.message, failure.help);
    }
    let waits = made.is_err() && room.refused().is_some();
    let concluded = job::conclude(made, record.outcome(), (&cloud, &log));
    let counters = &shared.counters;
    match &concluded {
        Ok((scan, None)) => {
            tracing::info!("scan {id}: whole, {} points", scan.points);
            Counters::count(&counters.whole);
        }
        Ok((scan, Some(why))) => {
            tracing::warn!("scan {id}: partial, {} points: {why}", scan.points);
            Counters::count(&counters.partial);
        }
        // What is to come of it is not known yet.
        Err(why) if waits => tracing::error!("scan {id}: no cloud until there is room: {why}"),
        Err(why) => {
            tracing::error!("scan {id}: no cloud: {why}");
            Counters::count(&counters.failed);
        }
    }
    shared.change_scan(id, |record| match concluded {
        Ok((scan, why)) => {
            record.state = match &why {
                None => ScanState::Whole,
                Some(_) => ScanState::Partial,
            };
            record.why = why;
            record.points = Some(scan.points);
            record.duration_s = Some(scan.contents.duration_s);
            record.report = serde_json::to_value(&scan).ok();
        }
        Err(why) => {
            record.state = ScanState::Failed;
            record.waits_for_room = waits;
            record.why = Some(why);
        }
    });
}

/// Draws the cloud for lists, whatever happens in that.
fn picture(cloud: &Path, to: &Path) -> Result<(), Failure> {
    catch_unwind(|| draw(cloud, to)).unwrap_or_else(|_| {
        Err(Failure::new(
            Kind::Incomplete,
            format!("{}: a defect of the program: no picture", to.display()),
        )
        .help("the scan is complete without it; run the daemon with -vv and report what it says"))
    })
}

fn draw(cloud: &Path, to: &Path) -> Result<(), Failure> {
    let cannot = |error: &dyn std::fmt::Display| {
        Failure::new(
            Kind::Incomplete,
            format!("{}: no picture: {error}", to.display()),
        )
        .help("the scan is complete without it; see whether the disk is full")
    };
    let mut cloud = fs::File::open(cloud).map_err(|error| cannot(&error))?;
    let png = thumbnail::of_ply(&mut cloud).map_err(|error| cannot(&error))?;
    let mut file = NewFile::create(to, Overwrite::Replace).map_err(|error| file_failure(&error))?;
    file.write_all(&png).map_err(|error| cannot(&error))?;
    file.commit().map_err(|error| file_failure(&error))
}

fn cloud(shared: &Shared, making: &Making, room: &Arc<Room>) -> Result<ScanReport, Failure> {
    let target = Target::file(&shared.cloud(&making.id), true, |file| {
        let file = Buffered::new(Roomy::new(file, Arc::clone(room)));
        Format::Ply.writer(file, Fields::FILE)
    })?;
    let source = Source::open(&shared.log(&making.id), None)?;
    let request = Reconstruction {
        recording: &source,
        tilt: TiltSource::Log,
        options: lidar::Options::default(),
        time: TimeReference::Host,
        accuracy: making.accuracy,
        pace: None,
        truth: making.truth.as_ref(),
        lost_records: making.lost_records,
        interrupt: &shared.abandon,
    };
    replay::make(&request, target).map_err(|failure| match room.refused() {
        Some(full) => full.clone(),
        None => failure,
    })
}
