//! The exclusive right to move the axis.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use super::DeviceService;
use super::status::{Activity, AxisTask};
use crate::failure::{Failure, Kind};

/// A request to stop the motion of one lease.
#[derive(Clone, Debug, Default)]
pub(super) struct StopSignal {
    requested: Arc<AtomicBool>,
    reason: Arc<OnceLock<Failure>>,
}

impl StopSignal {
    /// Requests the stop. The first reason counts; a user's stop has none.
    pub(super) fn request(&self, reason: Option<Failure>) {
        if let Some(reason) = reason {
            let _ = self.reason.set(reason);
        }
        self.requested.store(true, Ordering::Release);
    }

    /// The flag that a drive session polls.
    pub(super) fn flag(&self) -> &Arc<AtomicBool> {
        &self.requested
    }

    /// The reason, if it was not the user.
    pub(super) fn reason(&self) -> Option<Failure> {
        self.reason.get().cloned()
    }
}

/// The exclusive right to move the axis. Dropping it makes the axis idle.
pub struct AxisLease {
    service: Arc<DeviceService>,
    stop: StopSignal,
}

/// Reason for which the axis cannot be moved now.
#[derive(Clone, Debug)]
pub enum LeaseError {
    /// The axis is in use.
    Busy(AxisTask),
    /// Any other reason.
    Failure(Failure),
}

impl LeaseError {
    pub(super) fn ending() -> Self {
        Self::Failure(
            Failure::new(Kind::Interrupted, "the daemon is ending").help("start it again"),
        )
    }
}

impl From<Failure> for LeaseError {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

impl AxisLease {
    /// Takes the axis, if it is idle. A stop raises `interrupt`, if there is one.
    pub(super) fn take(
        service: &Arc<DeviceService>,
        task: AxisTask,
        interrupt: Option<Arc<AtomicBool>>,
    ) -> Result<Self, LeaseError> {
        // A stop signal of its own: what stopped the last lease does not stop this one.
        let stop = StopSignal {
            requested: interrupt.unwrap_or_default(),
            reason: Arc::default(),
        };
        let mut refused = None;
        service.state.send_if_modified(|state| {
            if service.is_ending() {
                refused = Some(LeaseError::ending());
            } else if state.activity.doing != AxisTask::Idle {
                refused = Some(LeaseError::Busy(state.activity.doing));
            } else {
                state.activity = Activity {
                    doing: task,
                    ..Activity::default()
                };
                state.stop = Some(stop.clone());
                if task != AxisTask::Connecting {
                    state.is_report_current = false;
                }
                (state.statusword, state.live_at) = (None, None);
            }
            refused.is_none()
        });
        match refused {
            Some(error) => Err(error),
            None => Ok(Self {
                service: Arc::clone(service),
                stop,
            }),
        }
    }

    /// Names the scan of a capture.
    pub fn set_scan(&self, id: &str) {
        let id = id.to_owned();
        self.service
            .update_activity(|activity| activity.scan = Some(id));
    }

    pub(super) fn stop(&self) -> &StopSignal {
        &self.stop
    }
}

impl Drop for AxisLease {
    fn drop(&mut self) {
        self.service.state.send_modify(|state| {
            state.activity = Activity::default();
            state.stop = None;
        });
        self.service.send_status();
    }
}
