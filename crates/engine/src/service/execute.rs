//! Captures and jogs on an open port, and what they report.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use drive::{CommandProgress, DriveClient, DriveCommand, DriveEvent, DriveStatus};

use super::device_thread::{ConnectionLoss, Worker};
use super::drive_connection::{AxisKnowledge, DriveConnection};
use super::events::MessageLevel;
use super::lease::{AxisLease, StopSignal};
use super::motion_reporter::MotionReporter;
use super::status::DeviceHealth;
use super::{CaptureEnd, CaptureResult, Lifetime, suspension};
use crate::capture::jog::{self, Homing};
use crate::capture::plan::CapturePlan;
use crate::capture::run::{self, CaptureEvent, CaptureJob, Outcome};
use crate::capture::run_moves::MoveProgress;
use crate::devices::drive_port;
use crate::devices::drive_session::{CLEARING, Session, SessionError};
use crate::devices::simulated::SimulatedDevices;
use crate::failure::{Failure, Kind};
use crate::service::axis_report::{AxisReport, DriveFault};

impl Worker {
    /// Reads the drive's state.
    pub(super) fn read_state(
        &self,
        connection: &mut DriveConnection,
    ) -> Result<AxisReport, SessionError> {
        let reads_only = StopSignal::default();
        self.run_commands(connection, &[], &reads_only, &mut Vec::new())
    }

    /// Runs commands and reads the drive's state. Adds warnings about the motion to `warnings`,
    /// also where it fails.
    pub(super) fn run_commands(
        &self,
        connection: &mut DriveConnection,
        commands: &[DriveCommand],
        stop: &StopSignal,
        warnings: &mut Vec<String>,
    ) -> Result<AxisReport, SessionError> {
        let service = &self.service;
        connection.drain_stale()?;
        let opened = &mut connection.opened;
        let client = DriveClient::new(service.axis.clone(), opened.link);
        let interrupt = match (commands, &service.lifetime) {
            // Requests that move nothing run to their end.
            ([] | [DriveCommand::Connect], Lifetime::Resident) => Arc::default(),
            _ => Arc::clone(stop.flag()),
        };
        let mut session = Session::new(client, &mut *opened.port, interrupt)
            .guarded_by(opened.guardian.as_mut())
            .keeping_awake(!service.simulated());
        // A simulated drive starts with its service, and is not homed.
        let homing = match service.simulated() && !service.is_referenced() {
            true => Homing::First,
            false => Homing::AsAsked,
        };
        let mut motion = MotionReporter::new(service);
        let done = jog::run(&mut session, commands, homing, &mut |event| {
            if let DriveEvent::Progress(CommandProgress::Moving(plan)) = event {
                motion.begin(plan, 0, 0);
            }
            motion.event(event, 0);
        });
        motion.end();
        warnings.extend(motion.into_warnings());
        drop(session);
        let could_move = connection.axis == AxisKnowledge::MayMove;
        self.command_ended(
            connection,
            commands.contains(&DriveCommand::Connect),
            done.as_ref().err(),
        );
        match done {
            Ok(status) => Ok(self.report_status(&status, connection.axis)),
            Err(error) => {
                connection.failed = true;
                if let SessionError::Drive(_) | SessionError::NotStopped(_) = &error
                    // The problem of an axis that may move stays until the axis is at rest.
                    && (error.may_move() || !could_move)
                {
                    self.drive_fault(jog::failure(&error));
                }
                Err(error)
            }
        }
    }

    fn command_ended(
        &self,
        connection: &mut DriveConnection,
        connected: bool,
        error: Option<&SessionError>,
    ) {
        connection.command_ended(connected, error);
        let may_move = connection.axis == AxisKnowledge::MayMove;
        let state = &self.service.state;
        state.send_modify(|state| state.may_move = may_move);
    }

    /// Takes in the drive's report on its state.
    fn report_status(&self, status: &DriveStatus, axis: AxisKnowledge) -> AxisReport {
        let service = &self.service;
        let report = AxisReport::new(&service.name, status, service.simulated());
        let gearing = service.axis.gearing;
        let fault = status.state == Some(protocol::epos2::cia402::DeviceState::Fault);
        let problem = fault.then(|| drive_in_fault(report.faults.first()));
        service.update_drive(|drive| {
            // The state of a drive that was not connected to is left as it was.
            if axis == AxisKnowledge::AtRest || (fault && axis == AxisKnowledge::Unknown) {
                drive.state = match fault {
                    true => DeviceHealth::Fault,
                    false => DeviceHealth::Connected,
                };
                drive.problem = problem;
            }
            drive.cia402 = Some(report.state.clone());
            drive.referenced = report.referenced;
            drive.angle_deg = report.angle_deg;
            drive.speed_deg_s = gearing.degrees_per_qc()
                * f64::from(gearing.qc_per_motor_turn())
                * f64::from(report.velocity_rpm)
                / 60.0;
            drive.faults = report.faults.clone();
        });
        service.set_report(Some(report.clone()));
        report
    }

    pub(super) fn drive_fault(&self, failure: Failure) {
        self.service.update_drive(|drive| {
            drive.state = DeviceHealth::Fault;
            drive.problem = Some(failure);
        });
    }

    /// Records a scan.
    pub(super) fn capture(
        &mut self,
        connection: &mut DriveConnection,
        plan: &CapturePlan,
        lease: &AxisLease,
    ) -> (CaptureResult, Option<ConnectionLoss>) {
        let service = Arc::clone(&self.service);
        let suspended = service.suspended();
        let Some(receiver) = service.receiver() else {
            let problem = service.lidar().problem;
            let failure = problem.unwrap_or_else(|| {
                Failure::new(Kind::NoDevice, "the lidar's sockets are not open")
                    .help("see the status")
            });
            return (Err(failure), None);
        };
        if let Err(error) = connection.drain_stale() {
            let failure = drive_port::failure(&error);
            return (Err(failure.clone()), Some(ConnectionLoss::Port(failure)));
        }
        let opened = &mut connection.opened;
        let preview = match service.lifetime {
            Lifetime::Resident => {
                let scan = service.activity().scan.unwrap_or_default();
                service.start_preview(&scan, &plan.scan)
            }
            Lifetime::Command { .. } => None,
        };
        let steps = plan.steps.len();
        let mut motion = MotionReporter::new(&service);
        service.update_activity(|activity| activity.steps = steps);
        let recorded = catch_unwind(AssertUnwindSafe(|| {
            let job = CaptureJob {
                plan,
                interrupt: lease.stop().flag(),
                lidar: &receiver,
                port: &mut *opened.port,
                guardian: opened.guardian.as_mut(),
                keeps_awake: !self.service.simulated(),
                link: opened.link,
                rs232_baud: opened.rs232_baud,
                tap: &|record| service.preview.record(record),
            };
            run::record(job, &mut |event| match event {
                CaptureEvent::Started => service.send_status(),
                CaptureEvent::Motion(MoveProgress::Step(number, step), _) => {
                    motion.begin(&step.plan, number, steps);
                }
                CaptureEvent::Motion(MoveProgress::Event(event), packets) => {
                    motion.event(event, packets);
                }
                CaptureEvent::MotionEnded => motion.end(),
                CaptureEvent::Saving => service.heartbeat(),
            })
        }));
        drop(preview);
        let truth = self.simulated.as_ref().and_then(SimulatedDevices::truth);
        let recorded = match recorded {
            Ok(Ok(recorded)) => recorded,
            Ok(Err(failure)) => {
                return (Err(lease.stop().reason().unwrap_or(failure)), None);
            }
            Err(_) => {
                // The session has stopped the axis as it unwound; the log is valid up to then.
                let outcome = Outcome {
                    failure: Some(panic_failure()),
                    ..Outcome::default()
                };
                self.drive_fault(panic_failure());
                let end = CaptureEnd { outcome, truth };
                return (Ok(end), Some(ConnectionLoss::Stale));
            }
        };
        let lost = recorded.motion_error().and_then(lost_port);
        connection.failed = true;
        self.command_ended(connection, true, recorded.motion_error());
        let at_rest = recorded.at_rest();
        let is_empty = recorded.is_empty;
        let mut outcome = recorded.outcome();
        for warning in &outcome.warnings {
            let events = service.events();
            events.message(MessageLevel::Warning, warning.clone(), None);
        }
        outcome.warnings.extend(motion.into_warnings());
        // A suspension is looked for here, too: the port may fail before anything else shows it.
        if let Some(suspended) = suspension(suspended, service.suspended()) {
            outcome.failure = Some(with_suspension(outcome.failure.take(), suspended));
        }
        if let Some(failure) = &mut outcome.failure
            && failure.kind == Kind::Interrupted
            && let Some(reason) = lease.stop().reason()
        {
            *failure = reason;
        }
        let lost = match lost {
            Some(lost) => Some(lost),
            // The device thread brings it to rest as soon as the drive answers again.
            None if !at_rest => {
                if let Some(failure) = &outcome.failure {
                    self.drive_fault(failure.clone());
                }
                None
            }
            None => match self.read_state(connection) {
                Err(SessionError::Port(error)) => {
                    Some(ConnectionLoss::Port(drive_port::failure(&error)))
                }
                _ => None,
            },
        };
        let result = match outcome.failure {
            Some(failure) if is_empty => Err(failure),
            _ => Ok(CaptureEnd { outcome, truth }),
        };
        (result, lost)
    }
}

/// The failure of a capture during which the machine was suspended.
fn with_suspension(failure: Option<Failure>, suspended: Failure) -> Failure {
    match failure {
        Some(other) if other.kind != Kind::Interrupted => Failure {
            message: format!("{}; and {}", suspended.message, other.message),
            help: other.help.or(suspended.help),
            kind: other.kind,
        },
        _ => suspended,
    }
}

/// The problem of a drive in fault, by the newest entry of its error history.
fn drive_in_fault(newest: Option<&DriveFault>) -> Failure {
    let name = newest.and_then(|fault| fault.name.as_deref());
    let code = newest.map_or("", |fault| fault.code.as_str());
    Failure::new(
        Kind::DeviceFault,
        format!(
            "the drive is in fault: {code} {}",
            name.unwrap_or("unknown error")
        ),
    )
    .help(fault_help(newest.and_then(|fault| fault.remedy.as_deref())))
}

/// The remedy of a fault and how it is cleared.
fn fault_help(remedy: Option<&str>) -> String {
    remedy.map_or(CLEARING.to_owned(), |remedy| {
        format!("{remedy}\n{CLEARING}")
    })
}

/// The loss of the port that an error means, if it does.
pub(super) fn lost_port(error: &SessionError) -> Option<ConnectionLoss> {
    match error {
        SessionError::Port(error) => Some(ConnectionLoss::Port(drive_port::failure(error))),
        // The port opened again has a new guardian.
        SessionError::Guardian(_) => Some(ConnectionLoss::Stale),
        _ => None,
    }
}

/// The failure of a motion that a defect has ended.
pub(super) fn panic_failure() -> Failure {
    Failure::new(
        Kind::DeviceFault,
        "an internal error ended the motion; a stop was sent to the axis",
    )
    .help("check that the axis is at rest; run with -vv and report the messages")
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::epos2::DeviceError;

    #[test]
    fn help_on_a_fault_mentions_clearing_once() {
        for error in [
            DeviceError::FOLLOWING,
            DeviceError::POSITION_SENSOR,
            DeviceError::INTERNAL_SOFTWARE,
        ] {
            let remedy = error.meaning().map(|meaning| meaning.remedy);
            let help = fault_help(remedy);
            assert!(help.matches("then clear").count() <= 1, "{help}");
            assert!(help.contains("--clear"), "{help}");
        }
        assert!(fault_help(None).starts_with("tilt faults --clear"));
    }
}
