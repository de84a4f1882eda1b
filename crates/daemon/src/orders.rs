//! What the keeper does with an open port: commands by hand, captures, and what is told of them.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use drive::{DriveClient, DriveCommand, DriveEvent, DriveStatus};

use super::hub::Level;
use super::keeper::{Keeper, Lost};
use super::line::{Axis, Line};
use super::maker::Making;
use super::motions::Motions;
use super::points::Watching;
use super::pulse;
use super::scans::ScanState;
use super::shared::Counters;
use super::view::DeviceState;
use engine::capture::jog::{self as tilting, Homing, Report};
use engine::capture::request::CapturePlan;
use engine::capture::run::{self as job, CaptureEvent, Job};
use engine::devices::drive_port as ports;
use engine::devices::drive_session::{Session, SessionError};
use engine::devices::simulated::Simulated;
use engine::failure::{Failure, Kind};

impl Keeper {
    /// Runs commands and asks how the axis then stands.
    pub(super) fn ask(
        &self,
        line: &mut Line,
        commands: &[DriveCommand],
    ) -> Result<Report, SessionError> {
        let shared = &self.shared;
        line.hush()?;
        let opened = &mut line.opened;
        let client = DriveClient::new(self.axis.clone(), opened.link);
        // What moves nothing is not stopped by what was meant for the order behind it.
        let interrupt = match commands {
            [] | [DriveCommand::Connect] => Arc::default(),
            _ => Arc::clone(&shared.interrupt),
        };
        let mut session = Session::new(client, &mut *opened.port, interrupt);
        let homed = shared.report().is_some_and(|report| report.referenced);
        let homing = match shared.simulated() && !homed {
            true => Homing::First,
            false => Homing::AsAsked,
        };
        let mut motions = Motions::new(shared);
        let done = tilting::ask(&mut session, commands, homing, &mut |event| match event {
            DriveEvent::Sample(sample) => {
                motions.moved(sample.answer, self.axis.gearing.angle(sample.position), 0)
            }
            DriveEvent::Progress(drive::CommandProgress::Moving(plan)) => motions.begin(plan, 0, 0),
            DriveEvent::Progress(step) => motions.progress(step, &self.axis.gearing),
            event => tracing::debug!(?event),
        });
        motions.end();
        drop(session);
        let doubtful = line.axis == Axis::MayMove;
        line.ended(
            commands.contains(&DriveCommand::Connect),
            done.as_ref().err(),
        );
        match done {
            Ok(status) => Ok(self.said(&status, line.axis)),
            Err(error) => {
                line.failed = true;
                if let SessionError::Drive(_) | SessionError::NotStopped(_) = &error
                    // What an axis that may move is said to do is said until it stands.
                    && (error.may_move() || !doubtful)
                {
                    self.fault(tilting::failure(&error));
                }
                Err(error)
            }
        }
    }

    /// The drive has said how it is.
    pub(super) fn said(&self, status: &DriveStatus, axis: Axis) -> Report {
        let shared = &self.shared;
        let report = Report::new(&shared.name, status, shared.simulated());
        let gearing = self.axis.gearing;
        let fault = status.state == Some(protocol::epos2::cia402::State::Fault);
        let problem = fault.then(|| {
            let newest = report.faults.first();
            let text = |pick: fn(&tilting::Fault) -> &Option<String>| {
                newest.and_then(|fault| pick(fault).clone())
            };
            let name = text(|fault| &fault.name).unwrap_or_else(|| "unknown error".to_owned());
            let code = newest.map_or("", |fault| fault.code.as_str());
            Failure::new(
                Kind::DeviceFault,
                format!("the drive is in fault: {code} {name}"),
            )
            .help(fault_help(text(|fault| &fault.remedy).as_deref()))
        });
        shared.set_drive(|drive| {
            // One that answers, but was not connected to, is what it was said to be.
            if axis == Axis::Known || (fault && axis == Axis::Unknown) {
                drive.state = match fault {
                    true => DeviceState::Fault,
                    false => DeviceState::Connected,
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
        shared.set_report(Some(report.clone()));
        report
    }

    pub(super) fn fault(&self, failure: Failure) {
        self.shared.set_drive(|drive| {
            drive.state = DeviceState::Fault;
            drive.problem = Some(failure);
        });
    }

    /// Makes a scan.
    pub(super) fn capture(
        &mut self,
        line: &mut Line,
        setup: CapturePlan,
        id: &str,
    ) -> Option<Lost> {
        let shared = Arc::clone(&self.shared);
        Counters::count(&shared.counters.captures);
        let slept = (shared.world.suspended)();
        let Some(hearing) = shared.hearing() else {
            let problem = shared.lidar().problem;
            let failure = problem.unwrap_or_else(|| {
                Failure::new(Kind::NoDevice, "the lidar is not listened to").help("see the status")
            });
            self.failed(id, failure);
            return None;
        };
        if let Err(error) = line.hush() {
            let failure = ports::failure(&error);
            self.failed(id, failure.clone());
            return Some(Lost::Port(failure));
        }
        let opened = &mut line.opened;
        let watching = Watching::start(id, &setup.scan, &shared.feed, &shared.hub);
        let steps = setup.steps.len();
        let mut motions = Motions::new(&shared);
        shared.note(|activity| activity.steps = steps);
        let ended = catch_unwind(AssertUnwindSafe(|| {
            let job = Job {
                setup: &setup,
                interrupt: &shared.interrupt,
                hearing: &hearing,
                port: &mut *opened.port,
                link: opened.link,
                rs232_baud: opened.rs232_baud,
                onlooker: &|record| shared.feed.record(record),
            };
            job::record(job, &mut |happening| match happening {
                CaptureEvent::Begins => shared.tell_status(),
                CaptureEvent::Move { number, step } => motions.begin(&step.plan, number + 1, steps),
                CaptureEvent::Moved { at, angle, packets } => motions.moved(at, angle, packets),
                CaptureEvent::Progress(step) => motions.progress(step, &self.axis.gearing),
                CaptureEvent::Over => motions.end(),
                CaptureEvent::Saving => shared.beat(),
                CaptureEvent::Warning(text) => {
                    shared.scans.say(id, &format!("warning: {text}"));
                    shared.hub.say(Level::Warning, text, None);
                }
            })
        }));
        drop(watching);
        let truth = self.devices.as_ref().and_then(Simulated::truth);
        let ended = match ended {
            Ok(Ok(ended)) => ended,
            Ok(Err(failure)) => {
                let failure = shared.stop_reason().unwrap_or(failure);
                self.failed(id, failure);
                return None;
            }
            Err(_) => {
                // The session has stopped the axis as it unwound; the log is whole up to then.
                let outcome = job::Outcome {
                    failure: Some(panic_failure()),
                    ..job::Outcome::default()
                };
                self.make(id, setup, truth, outcome);
                self.fault(panic_failure());
                return Some(Lost::Stale);
            }
        };
        let lost = ended.port_failed();
        line.failed = true;
        line.ended(true, ended.motion_error());
        let stands = ended.stands();
        let mut outcome = ended.outcome();
        // A port that did not outlive the sleep fails sooner than anybody looks at the clocks, and a sleep that no packet shows is one.
        if let Some(slept) = pulse::suspended(slept, (shared.world.suspended)()) {
            outcome.failure = Some(match outcome.failure.take() {
                // What else failed may need somebody's hand.
                Some(other) if other.kind != Kind::Interrupted => Failure {
                    message: format!("{}; and {}", slept.message, other.message),
                    help: other.help.or(slept.help),
                    kind: other.kind,
                },
                _ => slept,
            });
        }
        if let Some(failure) = &mut outcome.failure
            && failure.kind == Kind::Interrupted
            && let Some(reason) = shared.stop_reason()
        {
            *failure = reason;
        }
        let lost = match outcome.failure.clone().filter(|_| lost) {
            Some(failure) => Some(Lost::Port(failure)),
            // The keeper brings it to rest as soon as it is heard again.
            None if !stands => {
                if let Some(failure) = &outcome.failure {
                    self.fault(failure.clone());
                }
                None
            }
            // How the axis stands after it.
            None => match self.ask(line, &[]) {
                Err(SessionError::Port(error)) => Some(Lost::Port(ports::failure(&error))),
                _ => None,
            },
        };
        self.make(id, setup, truth, outcome);
        lost
    }

    /// Hands a log to whoever makes its cloud.
    pub(super) fn make(
        &self,
        id: &str,
        setup: CapturePlan,
        truth: Option<sim::Truth>,
        outcome: job::Outcome,
    ) {
        let lost_records = outcome.lost_records;
        // First this: whoever sees that the scan is over may begin the next.
        self.shared.set_idle();
        self.shared.change_scan(id, |record| {
            record.state = ScanState::Making;
            record.recording = outcome.failure;
            record.lost_records = lost_records;
            record.reception = outcome.reception;
        });
        let making = Making {
            id: id.to_owned(),
            accuracy: setup.accuracy,
            truth,
            lost_records,
        };
        if self.maker.send(making).is_err() {
            tracing::warn!("the cloud of {id} is made at the next start");
        }
    }

    /// Nothing came of a scan.
    pub(super) fn failed(&self, id: &str, failure: Failure) {
        self.shared.set_idle();
        Counters::count(&self.shared.counters.failed);
        self.shared
            .hub
            .say(Level::Error, failure.message.clone(), failure.help.clone());
        self.shared.change_scan(id, |record| {
            record.state = ScanState::Failed;
            record.why = Some(failure);
        });
    }
}

/// What to do about a fault: its remedy, most of which end with clearing it, and how that is done.
fn fault_help(remedy: Option<&str>) -> String {
    let how = "tilt faults --clear clears it, and so does homing the axis";
    remedy.map_or(how.to_owned(), |remedy| format!("{remedy}\n{how}"))
}

/// What becomes of the port after such an end.
pub(super) fn port_lost(error: &SessionError) -> Option<Lost> {
    match error {
        SessionError::Port(error) => Some(Lost::Port(ports::failure(error))),
        _ => None,
    }
}

/// A defect that ended a motion.
pub(super) fn panic_failure() -> Failure {
    Failure::new(
        Kind::DeviceFault,
        "a defect of the program ended the motion; the axis was told to stop",
    )
    .help("see whether the axis stands; run with -vv and report what it says")
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::epos2::DeviceError;

    #[test]
    fn help_on_a_fault_says_once_that_it_is_to_be_cleared() {
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
