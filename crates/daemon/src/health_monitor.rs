//! Checks once per second: the lidar's rate, the disk, suspensions, and the device thread.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use engine::failure::{Failure, Kind};
use engine::service::events::MessageLevel;
use engine::service::status::AxisTask;
use engine::service::suspension;
use sd_notify::NotifyState;
use units::Span;

use crate::state::DaemonState;

const INTERVAL: Duration = Duration::from_secs(1);
/// Time without a heartbeat after which the device thread hangs. Its longest wait is a homing
/// without an answer, 60 s.
const HEARTBEAT_LIMIT: Duration = Duration::from_secs(90);

/// Runs until `end` is dropped.
pub(crate) fn run(state: &Arc<DaemonState>, end: &Receiver<()>) {
    let mut suspended = state.service.suspended();
    let watchdog = sd_notify::watchdog_enabled();
    // Three checks within the service manager's limit.
    let interval = watchdog.map_or(INTERVAL, |limit| INTERVAL.min(limit / 3));
    while end.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
        state.service.refresh_lidar();
        check_disk(state);
        state.scans.settle();
        if let Err(failure) = state.scans.remove_deleted(Instant::now()) {
            state.events().failure(MessageLevel::Warning, failure);
        }
        state.refresh_disk();
        check_suspension(state, &mut suspended);
        if watchdog.is_some() && state.service.time_since_heartbeat() < HEARTBEAT_LIMIT {
            // Without a service manager there is no watchdog.
            let _ = sd_notify::notify(&[NotifyState::Watchdog]);
        }
        state.service.send_status();
    }
}

/// Ends a scan that would fill the disk while all of it can still be saved.
fn check_disk(state: &DaemonState) {
    if state.service.activity().doing != AxisTask::Capturing {
        return;
    }
    let reserve = state.settings().reserve_bytes;
    let Ok(free) = (state.free_bytes)(state.scans.folder()) else {
        return;
    };
    if free < reserve {
        let failure = disk_full(free, reserve);
        if state.service.stop(Some(failure.clone())) {
            state.events().failure(MessageLevel::Error, failure);
        }
    }
}

fn check_suspension(state: &DaemonState, before: &mut Span) {
    let now = state.service.suspended();
    let Some(failure) = suspension(*before, now) else {
        return;
    };
    *before = now;
    state.events().message(
        MessageLevel::Warning,
        failure.message.clone(),
        Some("the devices are connected again".to_owned()),
    );
    state.service.reopen(failure);
}

/// The failure of a disk with too little room.
#[must_use]
pub(crate) fn disk_full(free: u64, reserve: u64) -> Failure {
    Failure::new(
        Kind::Incomplete,
        format!(
            "the disk is nearly full: {} MB free, {} MB are left free",
            free / 1_000_000,
            reserve / 1_000_000
        ),
    )
    .help("delete scans, or give another folder or a smaller reserve_bytes under [daemon] of the configuration")
}
