//! State that clients follow: the status of the devices and of what they do.

use std::time::{Duration, Instant};

use units::{Degrees, Rpm};

use super::axis_report::AxisReport;
use super::events::{Event, MessageLevel};
use super::lease::StopSignal;
use super::status::{
    Activity, AxisStatus, AxisTask, ClientsStatus, DeviceHealth, DiskStatus, DriveSnapshot,
    LidarStatus, ServiceStatus,
};
use super::{DeviceService, locked, now_s};
use crate::capture::run;
use crate::devices::lidar_sockets;
use crate::failure::Failure;

/// A report of the drive younger than this is not requested again.
const REPORT_LIFETIME: Duration = Duration::from_millis(500);
/// A lidar that sends nothing for this long is absent: it sends 754 packets per second.
const LIDAR_SILENCE: Duration = Duration::from_secs(2);

/// State that clients follow. Locked for moments only, never while a device or disk is waited for.
#[derive(Clone, Default)]
pub(super) struct ServiceState {
    pub(super) activity: Activity,
    /// Stop signal of the current lease.
    pub(super) stop: Option<StopSignal>,
    pub(super) drive: DriveSnapshot,
    pub(super) lidar: LidarStatus,
    pub(super) disk: DiskStatus,
    pub(super) report: Option<AxisReport>,
    /// Time of the report.
    pub(super) reported_at: Option<Instant>,
    /// Whether nothing has happened since the report.
    pub(super) is_report_current: bool,
    /// Newest statusword (6041) of the running command.
    pub(super) statusword: Option<u16>,
    /// Time of the newest statusword or angle.
    pub(super) live_at: Option<Instant>,
    /// Whether the axis may move although no lease is held.
    pub(super) may_move: bool,
}

impl DeviceService {
    /// The status as it is known now, without waiting for a device.
    #[must_use]
    pub fn status(&self) -> ServiceStatus {
        let axis = &self.config.axis;
        let state = self.state.borrow();
        ServiceStatus {
            version: env!("CARGO_PKG_VERSION"),
            device: self.name.clone(),
            simulated: self.simulated(),
            started_s: self.started_s,
            stops: self.stops(),
            now_s: now_s(),
            activity: state.activity.clone(),
            drive: state.drive.clone(),
            lidar: state.lidar.clone(),
            axis: AxisStatus {
                min_deg: axis.min_deg,
                max_deg: axis.max_deg,
                max_speed_deg_s: axis.max_speed_deg_s,
                min_speed_deg_s: self.axis.gearing.rate(Rpm(1)).0.abs(),
                max_accel_deg_s2: axis.max_accel_deg_s2,
                accel_deg_s2: self.device.accel_deg_s2,
                home_deg: axis.homing.to_deg,
            },
            disk: state.disk,
            clients: ClientsStatus {
                events: self.events.clients(),
                dropped: self.events.disconnected(),
            },
        }
    }

    /// Sends the status to all subscribers.
    pub fn send_status(&self) {
        if self.events.has_subscribers() {
            let status = Box::new(self.status());
            self.events.send(Event::Status { status });
        }
    }

    /// The task of the axis.
    #[must_use]
    pub fn activity(&self) -> Activity {
        self.state.borrow().activity.clone()
    }

    /// The lidar's status.
    #[must_use]
    pub fn lidar(&self) -> LidarStatus {
        self.state.borrow().lidar.clone()
    }

    /// Angle of the axis, degrees; `None` while unknown.
    #[must_use]
    pub fn angle_deg(&self) -> Option<f64> {
        self.state.borrow().drive.angle_deg
    }

    /// Sets the status of the disk.
    pub fn set_disk(&self, disk: DiskStatus) {
        self.state.send_modify(|state| state.disk = disk);
    }

    /// The drive's report where it need not be requested: while the axis is busy, and shortly after
    /// the last report.
    #[must_use]
    pub fn known_report(&self) -> Option<AxisReport> {
        let state = self.state.borrow();
        let busy = state.activity.doing != AxisTask::Idle;
        let age = state.reported_at.map(|at| at.elapsed());
        let mut report = match &state.report {
            Some(report) => report.clone(),
            // A command that has just connected.
            None => AxisReport {
                device: self.name.clone(),
                simulated: self.simulated(),
                ..AxisReport::default()
            },
        };
        report.switches_age_s = age.map(|age| age.as_secs_f64());
        if !busy {
            let is_fresh = age.is_some_and(|age| age < REPORT_LIFETIME);
            report.age_s = age?.as_secs_f64();
            return (state.is_report_current && is_fresh).then_some(report);
        }
        if let Some(statusword) = state.statusword {
            report.set_statusword(statusword);
        }
        report.age_s = match state.live_at {
            Some(at) => at.elapsed().as_secs_f64(),
            None => age?.as_secs_f64(),
        };
        report.activity = state.activity.doing;
        report.angle_deg = state.drive.angle_deg;
        if let Some(angle) = report.angle_deg {
            let gearing = self.axis.gearing;
            let rpm = state.drive.speed_deg_s / gearing.deg_s_per_rpm();
            report.velocity_rpm = rpm.round() as i32;
            report.position_qc = gearing.position(Degrees(angle)).map_or(0, |at| at.0);
        }
        Some(report)
    }

    pub(super) fn is_referenced(&self) -> bool {
        let state = self.state.borrow();
        state
            .report
            .as_ref()
            .is_some_and(|report| report.referenced)
    }

    pub(super) fn set_report(&self, report: Option<AxisReport>) {
        self.state.send_modify(|state| {
            state.reported_at = report.is_some().then(Instant::now);
            state.is_report_current = true;
            state.report = report;
        });
    }

    pub(super) fn update_activity(&self, change: impl FnOnce(&mut Activity)) {
        self.state.send_modify(|state| change(&mut state.activity));
    }

    /// Changes the drive's status and reports a change of its state.
    pub(super) fn update_drive(&self, change: impl FnOnce(&mut DriveSnapshot)) {
        let health = |state: &ServiceState| (state.drive.state, state.drive.problem.clone());
        self.update_device("drive", health, |state| change(&mut state.drive));
    }

    /// Changes the lidar's status and reports a change of its state.
    pub(super) fn update_lidar(&self, change: impl FnOnce(&mut LidarStatus)) {
        let health = |state: &ServiceState| (state.lidar.state, state.lidar.problem.clone());
        self.update_device("lidar", health, |state| change(&mut state.lidar));
    }

    /// Changes a device's part of the state; a change of its health is sent and logged.
    fn update_device(
        &self,
        device: &str,
        health: impl Fn(&ServiceState) -> (DeviceHealth, Option<Failure>),
        change: impl FnOnce(&mut ServiceState),
    ) {
        let mut changed = None;
        self.state.send_modify(|state| {
            let before = health(state);
            change(state);
            let after = health(state);
            if before != after {
                state.is_report_current = false;
                changed = Some(after);
            }
        });
        let Some((state, problem)) = changed else {
            return;
        };
        match (state, problem) {
            (_, Some(problem)) => {
                let text = format!("{device}: {}", problem.message);
                self.events.message(MessageLevel::Error, text, problem.help);
            }
            (DeviceHealth::Connected, None) => {
                let text = format!("{device}: connected");
                self.events.message(MessageLevel::Info, text, None);
            }
            (DeviceHealth::Absent | DeviceHealth::Fault, None) => {}
        }
        self.send_status();
    }

    /// Updates the lidar's status from the packets received; called every second.
    pub fn refresh_lidar(&self) {
        let Some(receiver) = self.receiver() else {
            return;
        };
        let counts = receiver.counts();
        drop(receiver);
        let (status, silence) = locked(&self.lidar_stats).summary();
        let (state, problem) = match &counts {
            Err(failure) => (DeviceHealth::Fault, Some(failure.clone())),
            Ok(_) if silence >= LIDAR_SILENCE => {
                let config = lidar_sockets::listen_config(&self.device);
                (
                    DeviceHealth::Absent,
                    Some(run::silence(&config, LIDAR_SILENCE)),
                )
            }
            Ok(_) if status.received > 0 => (DeviceHealth::Connected, None),
            Ok(_) => (DeviceHealth::Absent, None),
        };
        self.update_lidar(|lidar| {
            *lidar = LidarStatus {
                state,
                problem,
                dropped_by_kernel: counts.map_or(lidar.dropped_by_kernel, |counts| counts.dropped),
                ..status
            };
        });
    }
}
