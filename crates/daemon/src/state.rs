//! State shared by the daemon's threads and requests.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

use engine::config::daemon::DaemonConfig;
use engine::failure::Failure;
use engine::service::events::{Event, Events, MessageLevel};
use engine::service::scan_record::{ScanRecord, ScanState, ScanView};
use engine::service::status::DiskStatus;
use engine::service::{CaptureEnd, CaptureResult, DeviceService};
use scanner::Accuracy;

use crate::cloud_builder::CloudJob;
use crate::scans::{CLOUD, LOG, Scans};

/// Returns the free bytes on the disk of a path.
pub type FreeBytes = dyn Fn(&Path) -> std::io::Result<u64> + Send + Sync;

/// Counters since the start.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Counters {
    /// Captures begun.
    pub captures: AtomicU64,
    /// Complete scans.
    pub whole: AtomicU64,
    /// Incomplete scans.
    pub partial: AtomicU64,
    /// Scans without a cloud.
    pub failed: AtomicU64,
    /// Requests answered.
    pub requests: AtomicU64,
    /// Requests refused.
    pub refused: AtomicU64,
}

impl Counters {
    /// Increments a counter.
    pub fn count(counter: &AtomicU64) {
        counter.fetch_add(1, Ordering::Relaxed);
    }
}

/// The shared state.
pub struct DaemonState {
    /// The devices.
    pub service: Arc<DeviceService>,
    /// The scans.
    pub scans: Scans,
    /// Counters.
    pub counters: Counters,
    /// Commit of the program; empty if unknown.
    pub commit: &'static str,
    /// Counters of the ROS 2 bridge.
    #[cfg(feature = "ros2")]
    pub ros2: Arc<ros2::Counts>,
    /// Free bytes on a disk.
    pub free_bytes: Arc<FreeBytes>,
    /// Set where the daemon ends without waiting for clouds.
    pub abandon: AtomicBool,
    /// The cloud builder's queue, until the daemon ends.
    cloud_jobs: Mutex<Option<Sender<CloudJob>>>,
}

impl DaemonState {
    /// The state of a daemon that begins.
    #[must_use]
    pub fn new(
        service: Arc<DeviceService>,
        scans: Scans,
        free_bytes: Arc<FreeBytes>,
        cloud_jobs: Sender<CloudJob>,
    ) -> Self {
        Self {
            service,
            scans,
            counters: Counters::default(),
            commit: "",
            #[cfg(feature = "ros2")]
            ros2: Arc::default(),
            free_bytes,
            abandon: AtomicBool::new(false),
            cloud_jobs: Mutex::new(Some(cloud_jobs)),
        }
    }

    /// `[daemon]` of the configuration.
    #[must_use]
    pub fn settings(&self) -> &DaemonConfig {
        &self.service.config().daemon
    }

    /// The events.
    #[must_use]
    pub fn events(&self) -> &Arc<Events> {
        self.service.events()
    }

    /// The cloud builder's queue; `None` once the daemon ends.
    pub(crate) fn cloud_jobs(&self) -> Option<Sender<CloudJob>> {
        let jobs = self.cloud_jobs.lock();
        jobs.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Lets the cloud builder end after the captures under way.
    pub fn close_cloud_jobs(&self) {
        let jobs = self.cloud_jobs.lock();
        jobs.unwrap_or_else(PoisonError::into_inner).take();
    }

    /// Takes in the end of a capture and queues its cloud.
    pub(crate) fn capture_ended(
        &self,
        id: &str,
        accuracy: Accuracy,
        result: CaptureResult,
        jobs: &Sender<CloudJob>,
    ) {
        let CaptureEnd { outcome, truth } = match result {
            Ok(end) => end,
            Err(failure) => {
                self.capture_failed(id, failure);
                return;
            }
        };
        let lost_records = outcome.lost_records;
        self.change_scan(id, |record| {
            record.state = ScanState::Making;
            record.recording = outcome.failure;
            record.lost_records = lost_records;
            record.warnings = outcome.warnings;
            record.reception = outcome.reception;
        });
        let job = CloudJob {
            id: id.to_owned(),
            accuracy,
            truth,
            lost_records,
        };
        if jobs.send(job).is_err() {
            tracing::warn!("the cloud of {id} is made at the next start");
        }
    }

    fn capture_failed(&self, id: &str, failure: Failure) {
        Counters::count(&self.counters.failed);
        self.events().failure(MessageLevel::Error, failure.clone());
        self.change_scan(id, |record| {
            record.state = ScanState::Failed;
            record.why = Some(failure);
        });
    }

    /// Updates the status of the disk. Not called by threads that answer requests or guard motion:
    /// a disk may take seconds.
    pub fn refresh_disk(&self) {
        let (scans, scans_bytes) = self.scans.size();
        let settings = self.settings();
        self.service.set_disk(DiskStatus {
            free_bytes: (self.free_bytes)(self.scans.folder()).ok(),
            reserve_bytes: settings.reserve_bytes,
            scans,
            scans_bytes,
            keep_scans: settings.keep_scans,
            keep_bytes: settings.keep_bytes,
        });
    }

    /// Changes a scan and reports it. The list has a change that the disk does not take.
    pub fn change_scan(&self, id: &str, change: impl FnOnce(&mut ScanRecord)) {
        let changed = self.scans.change(id, change).unwrap_or_else(|failure| {
            self.events().failure(MessageLevel::Error, failure);
            self.scans.view(id)
        });
        if let Some(scan) = changed {
            self.send_scan(scan, false);
        }
    }

    /// Sends a scan that has changed or was deleted.
    pub(crate) fn send_scan(&self, scan: ScanView, deleted: bool) {
        let scan = Box::new(scan);
        self.events().send(Event::Scan { scan, deleted });
    }

    /// Deletes the oldest scans beyond the configured number and size.
    pub fn delete_excess_scans(&self) {
        let settings = self.settings();
        for scan in self.scans.retain(settings.keep_scans, settings.keep_bytes) {
            self.events().message(
                MessageLevel::Info,
                format!(
                    "the scan {} was deleted to keep no more than is configured",
                    scan.id
                ),
                None,
            );
            self.send_scan(scan, true);
        }
    }

    /// The cloud of a scan.
    #[must_use]
    pub fn cloud(&self, id: &str) -> PathBuf {
        self.scans.place(id).join(CLOUD)
    }

    /// The log of a scan.
    #[must_use]
    pub fn log(&self, id: &str) -> PathBuf {
        self.scans.place(id).join(LOG)
    }
}
