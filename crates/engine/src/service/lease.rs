//! The exclusive right to move the axis.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use super::DeviceService;
use super::status::{Activity, AxisTask};
use crate::failure::{Failure, Kind};

/// Stops the motion of one lease, and of no other. A motion does not begin with a signal that has
/// been requested before.
#[derive(Clone, Debug, Default)]
pub struct StopSignal {
    requested: Arc<AtomicBool>,
    reason: Arc<OnceLock<Failure>>,
    /// Stops before the motion was asked for. Any later one prevents it.
    before: Option<StopCount>,
}

/// Stops that clients have requested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct StopCount {
    /// Of the axis: of any motion.
    pub axis: u64,
    /// Of captures alone.
    pub captures: u64,
}

impl StopSignal {
    pub(super) fn after(stops: StopCount) -> Self {
        Self {
            before: Some(stops),
            ..Self::default()
        }
    }

    /// Whether a stop was requested since the motion was asked for.
    fn is_overtaken(&self, now: StopCount, task: AxisTask) -> bool {
        self.before.is_some_and(|before| match task {
            AxisTask::Capturing => before != now,
            _ => before.axis != now.axis,
        })
    }

    /// Requests the stop. The first reason counts; a user's stop has none.
    pub fn request(&self, reason: Option<Failure>) {
        if let Some(reason) = reason {
            let _ = self.reason.set(reason);
        }
        self.requested.store(true, Ordering::Release);
    }

    /// Whether the stop has been requested.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        self.requested.load(Ordering::Acquire)
    }

    /// The signal with the flag of a command, for its task. Any stop prevents a motion.
    pub(super) fn of_command(requested: &Arc<AtomicBool>, task: AxisTask) -> Self {
        Self {
            requested: Arc::clone(requested),
            before: (task != AxisTask::Stopping).then(StopCount::default),
            ..Self::default()
        }
    }

    /// Whether both stop the same lease.
    pub(super) fn is_of(&self, lease: &Self) -> bool {
        Arc::ptr_eq(&self.requested, &lease.requested)
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
    /// Takes the axis, if it is idle. `stop` must be of no other lease: what stopped the last one
    /// does not stop this one.
    pub(super) fn take(
        service: &Arc<DeviceService>,
        task: AxisTask,
        stop: StopSignal,
    ) -> Result<Self, LeaseError> {
        let mut refused = None;
        service.state.send_if_modified(|state| {
            // A stop counts itself before it looks for a motion under this lock: no motion that was
            // asked for earlier begins after it.
            if service.is_ending() {
                refused = Some(LeaseError::ending());
            } else if stop.is_overtaken(service.stop_count(), task) {
                let what = "the axis was stopped before this motion began";
                let failure = Failure::new(Kind::Interrupted, what).help("nothing has moved");
                refused = Some(failure.into());
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

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::config::Config;
    use crate::devices::profile;
    use crate::service::{Environment, Lifetime, ServiceOptions};

    /// A signal is one lease's: the question whose motion it is and the stop are one decision.
    #[test]
    fn a_signal_stops_its_own_lease_and_no_other() {
        let config: Config = toml::from_str("device = 'sim'").unwrap();
        let (name, device) = profile::choose(&config, None).unwrap();
        let (service, thread) = DeviceService::start(ServiceOptions {
            config,
            name,
            device,
            lifetime: Lifetime::Resident,
            environment: Environment::default(),
        })
        .unwrap();
        let [first, second, third] = [(); 3].map(|()| service.stop_signal(None));
        let begin = Instant::now();
        let lease = loop {
            match service.lease_until(AxisTask::Moving, &first) {
                Ok(lease) => break lease,
                Err(error) => {
                    assert!(begin.elapsed() < Duration::from_secs(60), "{error:?}");
                    std::thread::sleep(Duration::from_millis(10));
                }
            }
        };
        assert!(service.is_moved_until(&first) && !service.is_moved_until(&second));
        second.request(None);
        assert!(!lease.stop().is_requested());
        first.request(None);
        assert!(lease.stop().is_requested());
        drop(lease);
        assert!(!service.is_moved_until(&first));

        // What is stopped before does not begin.
        match service.lease_until(AxisTask::Moving, &second).err() {
            Some(LeaseError::Failure(failure)) => assert_eq!(failure.kind, Kind::Interrupted),
            other => panic!("{other:?}"),
        }
        assert_eq!(service.activity().doing, AxisTask::Idle);

        // The signals of ended leases do not stop the next one; a stop of the axis does.
        let lease = service.lease_until(AxisTask::Moving, &third).unwrap();
        first.request(None);
        assert!(!lease.stop().is_requested());
        assert!(service.stop(None) && third.is_requested());
        drop(lease);

        // A stop prevents what was asked for before it, and nothing later; a stop of captures
        // prevents no other motion.
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_time()
            .build()
            .unwrap();
        let before = service.stop_signal(None);
        assert_eq!(runtime.block_on(service.stop_capture()), (false, None));
        let prevented = |task, signal: &StopSignal| match service.lease_until(task, signal) {
            Err(LeaseError::Failure(failure)) => {
                assert_eq!(failure.kind, Kind::Interrupted);
                assert!(failure.message.contains("stopped before"), "{failure}");
                assert_eq!(service.activity().doing, AxisTask::Idle);
                true
            }
            Err(other) => panic!("{other:?}"),
            Ok(_) => false,
        };
        assert!(prevented(AxisTask::Capturing, &before));
        assert!(!prevented(AxisTask::Moving, &before));
        let known = service.stops();
        let before = service.stop_signal(None);
        runtime.block_on(service.stop_axis()).unwrap();
        for signal in [before, service.stop_signal(Some(known))] {
            assert!(prevented(AxisTask::Moving, &signal));
            assert!(prevented(AxisTask::Capturing, &signal));
        }
        assert!(!prevented(
            AxisTask::Moving,
            &service.stop_signal(Some(known + 1))
        ));
        service.shut_down(Failure::new(Kind::Interrupted, "the test ends"));
        assert!(thread.join());
    }
}
