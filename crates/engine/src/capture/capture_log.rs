//! Records the traffic of both devices to one log.

use std::path::Path;
use std::sync::Arc;

use io::files::Overwrite;
use io::log::{LogConfig, LogError, LogRecorder, LogWriter, RecorderCounts, RecorderHandle};
use io::udp::ListenCounts;
use protocol::record::DriveLink;
use scanner::ScanConfig;

use crate::devices::lidar_receiver::LidarReceiver;
use crate::failure::{Failure, Kind};

/// A recording in progress.
pub struct CaptureLog {
    log: LogRecorder,
    lidar: Arc<LidarReceiver>,
    /// Counts before it began.
    before: ListenCounts,
    packets_before: u64,
}

/// Counts of a recording.
#[derive(Clone, Copy, Debug)]
pub struct CaptureCounts {
    /// Packets received, and dropped by the kernel.
    pub lidar: ListenCounts,
    /// Records in the log.
    pub log: RecorderCounts,
}

impl CaptureLog {
    /// Creates the log and records what `lidar` receives from now on.
    ///
    /// # Errors
    /// [`Kind::Usage`] where the log exists, [`Kind::BadInput`] where it cannot be created, and
    /// where the lidar's sockets have failed.
    pub fn start(
        lidar: &Arc<LidarReceiver>,
        path: &Path,
        config: &ScanConfig,
        link: DriveLink,
    ) -> Result<Self, Failure> {
        let head = LogConfig {
            metadata: toml::to_string(config).map_err(|error| {
                Failure::new(
                    Kind::BadInput,
                    format!("the configuration has no TOML: {error}"),
                )
                .help("see whether every number in the configuration is finite")
            })?,
            drive: Some(link),
        };
        let writer =
            LogWriter::create(path, &head, Overwrite::Refuse).map_err(|e| log_failure(&e))?;
        let log = LogRecorder::to_disk(writer).map_err(|e| log_failure(&e))?;
        let packets_before = lidar.packets();
        let before = lidar.record_to(Some(log.handle()))?;
        Ok(Self {
            log,
            lidar: Arc::clone(lidar),
            before,
            packets_before,
        })
    }

    /// The log, for the drive's records.
    #[must_use]
    pub fn handle(&self) -> RecorderHandle {
        self.log.handle()
    }

    /// Lidar packets so far.
    #[must_use]
    pub fn packets(&self) -> u64 {
        self.lidar.packets().saturating_sub(self.packets_before)
    }

    /// Whether writing the log has failed.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.log.failed()
    }

    /// Writes everything received until now and closes the log. Calls `waiting` every few
    /// milliseconds until the disk has it.
    ///
    /// # Errors
    /// [`Kind::Incomplete`] where the log could not be written completely or the lidar's socket
    /// failed; what was written stays.
    pub fn finish(self, waiting: &mut dyn FnMut()) -> Result<CaptureCounts, Failure> {
        let counts = self.lidar.record_to(None);
        let log = self
            .log
            .finish_while(waiting)
            .map_err(|e| log_failure(&e))?;
        Ok(CaptureCounts {
            lidar: since(counts?, self.before),
            log,
        })
    }
}

/// The difference of two counts.
fn since(now: ListenCounts, before: ListenCounts) -> ListenCounts {
    ListenCounts {
        data: now.data.saturating_sub(before.data),
        position: now.position.saturating_sub(before.position),
        dropped: now.dropped.saturating_sub(before.dropped),
        without_kernel_time: now
            .without_kernel_time
            .saturating_sub(before.without_kernel_time),
        unwanted: now.unwanted.saturating_sub(before.unwanted),
    }
}

fn log_failure(error: &LogError) -> Failure {
    let (kind, help) = match error {
        LogError::Exists { .. } => (
            Kind::Usage,
            "choose another name with --log or -o, or overwrite it with --force",
        ),
        LogError::Create { .. } => (
            Kind::BadInput,
            "see whether the folder exists and may be written to",
        ),
        _ => (
            Kind::Incomplete,
            "see whether the disk is full; what was written is in the log",
        ),
    };
    Failure::new(kind, error.to_string()).help(help)
}
