//! The thread that owns the devices: it opens them, opens them again when they come back, and runs
//! one request after the other.
//!
//! Only this thread talks to the drive. After a panic in a request the session stops the axis as it
//! unwinds, and the thread goes on.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use drive::DriveCommand;
use tokio::sync::oneshot;
use units::Span;

use super::axis_report::AxisReport;
use super::drive_connection::{AxisKnowledge, DriveConnection};
use super::execute::{lost_port, panic_failure};
use super::lease::{AxisLease, StopSignal};
use super::status::AxisTask;
use super::{CaptureResult, DeviceService, Lifetime};
use crate::capture::jog;
use crate::capture::plan::CapturePlan;
use crate::devices::drive_port;
use crate::devices::drive_session::SessionError;
use crate::devices::simulated::SimulatedDevices;
use crate::failure::{Failure, Kind};
use crate::threads::spawn;

/// Between two reads of the drive's state while the axis is idle.
const POLL_INTERVAL: Duration = Duration::from_secs(2);
/// First and longest wait before a device is tried again.
const RETRY_WAIT: (Duration, Duration) = (Duration::from_millis(250), Duration::from_secs(5));
/// Truth of the simulated devices before a capture.
const TRUTH_MEMORY: Span = Span::from_secs(60);

/// A request to the device thread. Requests that move the axis carry its lease.
pub(super) enum ThreadRequest {
    /// Records a scan.
    Capture {
        lease: AxisLease,
        plan: Box<CapturePlan>,
        answer: oneshot::Sender<CaptureResult>,
    },
    /// Runs commands, then reads the drive's state.
    Jog {
        lease: AxisLease,
        commands: Vec<DriveCommand>,
        answer: oneshot::Sender<Result<AxisReport, Failure>>,
    },
    /// Opens the devices again after a suspension.
    Reopen,
    /// Checks whether the service is ending.
    Wake,
}

/// The running thread.
pub struct DeviceThread {
    handle: JoinHandle<()>,
    /// Warning about the drive's port, of a service for one command.
    pub port_warning: Option<String>,
}

impl DeviceThread {
    pub(super) fn start(
        service: &Arc<DeviceService>,
        requests: Receiver<ThreadRequest>,
    ) -> Result<Self, Failure> {
        let worker = Worker {
            service: Arc::clone(service),
            requests,
            simulated: None,
            lidar_retry: Backoff::new(),
        };
        let lifetime = service.lifetime.clone();
        // A port cannot leave the thread that has opened it.
        let (opened, port_warning) = mpsc::channel();
        let handle = spawn("devices", "the devices", move || match lifetime {
            Lifetime::Resident => worker.run_resident(),
            Lifetime::Command { lidar, .. } => worker.run_command(lidar, &opened),
        })?;
        let port_warning = match service.lifetime {
            Lifetime::Resident => None,
            Lifetime::Command { .. } => port_warning
                .recv()
                .unwrap_or_else(|_| Err(panic_failure()))?,
        };
        Ok(Self {
            handle,
            port_warning,
        })
    }

    /// Whether the thread has ended, which before a shutdown is a defect.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.handle.is_finished()
    }

    /// Waits for the end of the thread. Returns false if it panicked.
    #[must_use]
    pub fn join(self) -> bool {
        self.handle.join().is_ok()
    }
}

/// State of the thread.
pub(super) struct Worker {
    pub(super) service: Arc<DeviceService>,
    requests: Receiver<ThreadRequest>,
    pub(super) simulated: Option<SimulatedDevices>,
    pub(super) lidar_retry: Backoff,
}

/// Waits between attempts, doubled after each failure.
pub(super) struct Backoff {
    wait: Duration,
    due: Instant,
}

impl Backoff {
    pub(super) fn new() -> Self {
        Self {
            wait: RETRY_WAIT.0,
            due: Instant::now(),
        }
    }

    pub(super) fn failed(&mut self) {
        self.due = Instant::now() + self.wait;
        self.wait = (self.wait * 2).min(RETRY_WAIT.1);
    }

    pub(super) fn left(&self) -> Duration {
        self.due.saturating_duration_since(Instant::now())
    }
}

/// Reason for giving up a port.
pub(super) enum ConnectionLoss {
    /// The service is ending.
    Ending,
    /// The port failed.
    Port(Failure),
    /// The device may be another one by now.
    Stale,
}

impl Worker {
    /// Runs until the service ends; absent devices are tried again.
    fn run_resident(mut self) {
        let mut retry = Backoff::new();
        while !self.service.is_ending() {
            self.service.heartbeat();
            self.keep_lidar_open();
            match self.open_drive() {
                Ok(connection) => {
                    retry = Backoff::new();
                    match self.serve(connection) {
                        ConnectionLoss::Ending => break,
                        ConnectionLoss::Stale => {}
                        ConnectionLoss::Port(failure) => self.drive_absent(Some(failure)),
                    }
                }
                Err(failure) => self.drive_absent(Some(failure)),
            }
            retry.failed();
            self.refuse_for(retry.left());
        }
        self.close();
    }

    /// Opens the devices once and runs until the service ends.
    fn run_command(mut self, lidar: bool, opened: &Sender<Result<Option<String>, Failure>>) {
        match self.open_once(lidar) {
            Ok(connection) => {
                let _ = opened.send(Ok(connection.opened.warning.clone()));
                if let ConnectionLoss::Port(failure) = self.serve(connection) {
                    self.drive_absent(Some(failure));
                }
                while !self.service.is_ending() {
                    self.refuse_for(POLL_INTERVAL);
                }
                self.close();
            }
            Err(failure) => {
                // Closed before the command reports the failure.
                self.close();
                let _ = opened.send(Err(failure));
            }
        }
    }

    fn close(&mut self) {
        self.service.set_receiver(None);
        if let Some(devices) = self.simulated.take() {
            drop(devices.stop());
        }
    }

    /// Refuses requests that were sent before the drive was known to be absent.
    fn refuse_for(&mut self, wait: Duration) {
        let until = Instant::now() + wait;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            match self.requests.recv_timeout(left) {
                Ok(request) => self.refuse(request),
                Err(_) => return,
            }
            if self.service.is_ending() {
                return;
            }
        }
    }

    fn refuse(&self, request: ThreadRequest) {
        let problem = self.service.state.borrow().drive.problem.clone();
        let failure = problem.unwrap_or_else(|| {
            Failure::new(Kind::NoDevice, "the drive is not connected").help("see the status")
        });
        match request {
            ThreadRequest::Capture { lease, answer, .. } => {
                drop(lease);
                drop(answer.send(Err(failure)));
            }
            ThreadRequest::Jog { lease, answer, .. } => {
                drop(lease);
                drop(answer.send(Err(failure)));
            }
            ThreadRequest::Reopen => self.forget_lidar(),
            ThreadRequest::Wake => {}
        }
    }

    /// Runs requests with an open port until it is lost.
    fn serve(&mut self, mut connection: DriveConnection) -> ConnectionLoss {
        let resident = matches!(self.service.lifetime, Lifetime::Resident);
        let mut poll = Instant::now();
        let mut connect = Backoff::new();
        loop {
            self.service.heartbeat();
            if self.service.is_ending() {
                return ConnectionLoss::Ending;
            }
            if resident {
                self.keep_lidar_open();
                if let Err(lost) = self.keep_connected(&mut connection, &mut connect, &mut poll) {
                    return lost;
                }
            }
            let next = match connection.axis {
                _ if !resident => POLL_INTERVAL,
                AxisKnowledge::AtRest => poll.saturating_duration_since(Instant::now()),
                AxisKnowledge::Unknown | AxisKnowledge::MayMove => connect.left(),
            };
            match self.requests.recv_timeout(next) {
                Ok(ThreadRequest::Reopen) => {
                    self.drive_absent(None);
                    self.forget_lidar();
                    return ConnectionLoss::Stale;
                }
                Ok(ThreadRequest::Wake) | Err(RecvTimeoutError::Timeout) => {}
                Ok(request) => {
                    if let Some(lost) = self.execute(&mut connection, request) {
                        return lost;
                    }
                    poll = Instant::now() + POLL_INTERVAL;
                }
                Err(RecvTimeoutError::Disconnected) => return ConnectionLoss::Ending,
            }
        }
    }

    /// Connects to a drive that is not known to be at rest, and polls one that is.
    fn keep_connected(
        &mut self,
        connection: &mut DriveConnection,
        connect: &mut Backoff,
        poll: &mut Instant,
    ) -> Result<(), ConnectionLoss> {
        // Requests go first: the lease fails while one is under way.
        if connection.axis != AxisKnowledge::AtRest
            && connect.left().is_zero()
            && let Ok(lease) =
                AxisLease::take(&self.service, AxisTask::Connecting, StopSignal::default())
        {
            let connect_only = [DriveCommand::Connect];
            let connected =
                self.run_commands(connection, &connect_only, lease.stop(), &mut Vec::new());
            drop(lease);
            match connected {
                Ok(_) => *connect = Backoff::new(),
                Err(SessionError::Port(error)) => {
                    return Err(ConnectionLoss::Port(drive_port::failure(&error)));
                }
                Err(_) => {
                    if connection.axis == AxisKnowledge::MayMove {
                        // An axis that may move is tried without growing waits.
                        *connect = Backoff::new();
                    }
                    connect.failed();
                }
            }
            *poll = Instant::now() + POLL_INTERVAL;
        }
        if poll.saturating_duration_since(Instant::now()).is_zero() {
            if connection.axis == AxisKnowledge::AtRest
                && let Err(SessionError::Port(error)) = self.read_state(connection)
            {
                return Err(ConnectionLoss::Port(drive_port::failure(&error)));
            }
            *poll = Instant::now() + POLL_INTERVAL;
            if let Some(devices) = &self.simulated {
                devices.forget_before(io::clock::now().saturating_add(-TRUTH_MEMORY));
            }
        }
        Ok(())
    }

    /// Runs one request and survives its panics.
    fn execute(
        &mut self,
        connection: &mut DriveConnection,
        request: ThreadRequest,
    ) -> Option<ConnectionLoss> {
        if self.service.is_ending() {
            self.refuse(request);
            return Some(ConnectionLoss::Ending);
        }
        match request {
            ThreadRequest::Capture {
                lease,
                plan,
                answer,
            } => {
                let (result, lost) = self.capture(connection, &plan, &lease);
                // First of all: a client that sees the result may begin the next motion.
                drop(lease);
                let _ = answer.send(result);
                lost
            }
            ThreadRequest::Jog {
                lease,
                commands,
                answer,
            } => {
                let stop = lease.stop().clone();
                let mut warnings = Vec::new();
                let done = catch_unwind(AssertUnwindSafe(|| {
                    self.run_commands(connection, &commands, &stop, &mut warnings)
                }));
                let (result, lost) = match done {
                    Ok(Ok(report)) => (Ok(AxisReport { warnings, ..report }), None),
                    Ok(Err(error)) => {
                        let failure = jog::failure(&error);
                        // A fault that ends a motion is not why another one stopped it.
                        let is_stopped = failure.kind == Kind::Interrupted;
                        let failure = stop.reason().filter(|_| is_stopped).unwrap_or(failure);
                        (Err(failure.warned(warnings)), lost_port(&error))
                    }
                    Err(_) => {
                        self.drive_fault(panic_failure());
                        (Err(panic_failure()), Some(ConnectionLoss::Stale))
                    }
                };
                drop(lease);
                let _ = answer.send(result);
                lost
            }
            ThreadRequest::Reopen | ThreadRequest::Wake => None,
        }
    }
}
