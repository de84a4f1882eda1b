//! Captures and jogs by a daemon that has the device, or by a device service of this process: both
//! report and write the same.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use cloud::Fields;
use cloud::formats::Format;
use daemon::client::Client;
use daemon::local::{LocalService, LocalTask};
use engine::capture::jog::JogRequest;
use engine::capture::plan::CapturePlan;
use engine::capture::run::{self, Outcome};
use engine::capture_request::CaptureRequest;
use engine::config::{Config, Device};
use engine::failure::{Failure, Kind};
use engine::output::{self, Target, file_failure, overwrite};
use engine::reconstruct::report::ScanReport;
use engine::service::axis_report::StopAnswer;
use engine::service::scan_record::{ScanDetails, ScanState, ScanView};
use engine::service::status::AxisTask;
use engine::service::{CaptureEnd, CaptureResult, LeaseError};
use io::files::NewFile;
use tokio::sync::oneshot;
use units::{Degrees, Span, Stamp};

use super::guard_axis::environment;
use crate::terminal::Progress;

/// Between two polls of a capture's progress.
const PROGRESS_POLL: Duration = Duration::from_millis(50);
/// Longest wait for a daemon to make a cloud, behind those of other scans; then the command makes
/// it itself. A cloud takes seconds per minute of scanning.
const CLOUD_WAIT: Duration = Duration::from_secs(300);
/// Between two polls of Ctrl-C.
const INTERRUPT_POLL: Duration = Duration::from_millis(5);
/// Polls of the progress between two updates of the lidar's status: 1 s.
const LIDAR_REFRESH: u32 = 20;

/// The owner of the devices.
pub enum DeviceBackend {
    /// A daemon that has them.
    Daemon(Client),
    /// A device service of this process.
    Local(Box<LocalService>),
}

impl DeviceBackend {
    /// Takes the daemon, or opens the devices that `task` needs.
    ///
    /// # Errors
    /// Returns the failure of a device that cannot be opened.
    pub fn open(
        daemon: Option<Client>,
        config: &Config,
        device: (&str, &Device),
        task: LocalTask,
        interrupt: &Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        if let Some(client) = daemon {
            return Ok(Self::Daemon(client));
        }
        let device = (device.0.to_owned(), device.1.clone());
        let config = config.clone();
        let local = LocalService::start(config, device, task, interrupt, environment())?;
        Ok(Self::Local(Box::new(local)))
    }

    /// Records a capture and shows its progress. Ctrl-C stops it. Devices of this process are
    /// closed when it returns.
    ///
    /// # Errors
    /// Where nothing was recorded.
    pub fn record(
        self,
        request: &CaptureRequest,
        plan: &CapturePlan,
        interrupt: &AtomicBool,
        progress: &mut Progress,
    ) -> Result<RecordedCapture, Failure> {
        match self {
            Self::Daemon(client) => {
                let mut capture = DaemonCapture::begin(client, request)?;
                let end = follow(&mut capture, plan, interrupt, progress)?;
                let scan = Some(capture);
                Ok(RecordedCapture { end, scan })
            }
            Self::Local(local) => {
                if let Some(warning) = &local.thread.port_warning {
                    progress.say(&format!("warning: {warning}"));
                }
                let end = LocalCapture::begin(&local, plan.clone())
                    .and_then(|mut capture| follow(&mut capture, plan, interrupt, progress));
                local.stop();
                Ok(RecordedCapture {
                    end: end?,
                    scan: None,
                })
            }
        }
    }

    /// Runs a jog.
    ///
    /// # Errors
    /// Where the axis cannot be moved, or the motion failed.
    pub fn jog(self, jog: JogRequest, interrupt: &AtomicBool) -> Result<StopAnswer, Failure> {
        match self {
            Self::Daemon(client) => jog_by_daemon(&client, jog, interrupt),
            Self::Local(local) => {
                let mut answer = jog_locally(&local, jog);
                if let Some(warning) = local.thread.port_warning.clone() {
                    answer = match answer {
                        Ok(StopAnswer::Report(mut report)) => {
                            report.warnings.insert(0, warning);
                            Ok(StopAnswer::Report(report))
                        }
                        Err(failure) => Err(failure.warned(vec![warning])),
                        other => other,
                    };
                }
                local.stop();
                answer
            }
        }
    }

    /// Description of a simulated drive of this owner.
    #[must_use]
    pub const fn simulated_drive(&self) -> &'static str {
        match self {
            Self::Daemon(_) => "a simulated drive, the daemon's",
            Self::Local(_) => "a simulated drive, switched on a moment ago",
        }
    }
}

/// A recorded capture, whose log is at its place.
pub struct RecordedCapture {
    end: CaptureEnd,
    /// The daemon's scan, whose cloud the daemon makes.
    scan: Option<DaemonCapture>,
}

impl RecordedCapture {
    /// Writes the cloud and returns the report on it, with the recording's own. A daemon's cloud is
    /// copied if it is the requested one.
    pub fn cloud(
        self,
        plan: &CapturePlan,
        fields: Fields,
        target: Target,
        interrupt: &AtomicBool,
    ) -> (Result<ScanReport, Failure>, Outcome) {
        let Self {
            end: CaptureEnd { mut outcome, truth },
            scan,
        } = self;
        let is_stored = !target.is_stdout()
            && fields == Fields::FILE
            && Format::from_path(&plan.cloud) == Ok(Format::Ply);
        let scan = scan.filter(|_| is_stored || plan.scan.simulated);
        let until = Instant::now() + CLOUD_WAIT;
        let details = || scan.as_ref()?.finished(interrupt, until);
        // A daemon of an earlier version does not say what is missing in a partial scan.
        let is_explained = |details: &ScanDetails| {
            details.scan.state == ScanState::Whole || details.recording.is_some()
        };
        let finished = is_stored.then(details).flatten().filter(is_explained);
        if let Some(scan) = &scan
            && let Some(details) = finished
            && let Some(report) = stored_report(&details, plan)
        {
            match scan.fetch("cloud", &plan.cloud, plan.force) {
                Ok(()) => {
                    tracing::debug!("the cloud is a copy of the daemon's");
                    outcome.failure = details.recording;
                    return (Ok(report), outcome);
                }
                Err(error) => tracing::debug!("the daemon's cloud could not be copied: {error}"),
            }
        }
        let log = (plan.log.as_path(), plan.accuracy);
        let lost = outcome.lost_records;
        let mut made = run::cloud(log, truth.as_ref(), false, lost, interrupt, target);
        // Only the daemon has the truth of its simulator.
        if let Ok(report) = &mut made
            && plan.scan.simulated
            && let Some(details) = details()
        {
            report.truth = stored_report(&details, plan).and_then(|stored| stored.truth);
        }
        (made, outcome)
    }
}

/// The report on a daemon's cloud as that on the same cloud at the user's place.
fn stored_report(details: &ScanDetails, plan: &CapturePlan) -> Option<ScanReport> {
    let report = details.report.clone()?;
    let mut report: ScanReport = serde_json::from_value(report).ok()?;
    report.output = plan.cloud.display().to_string();
    report.log = plan.log.display().to_string();
    // The command has no live view.
    report.live = None;
    Some(report)
}

/// Progress of a capture.
#[derive(Default)]
struct CaptureProgress {
    /// Messages so far.
    messages: Vec<String>,
    /// The axis, until the recording has ended.
    axis: Option<AxisProgress>,
    /// The end.
    end: Option<CaptureEnd>,
}

/// Progress of the axis during a capture.
struct AxisProgress {
    /// Number of the move, from 1.
    step: usize,
    packets: u64,
    angle_deg: Option<f64>,
}

/// A capture under way.
trait CaptureBackend {
    /// Looks how far the capture is.
    ///
    /// # Errors
    /// Where nothing was recorded, or the backend is gone.
    fn poll(&mut self, plan: &CapturePlan) -> Result<CaptureProgress, Failure>;

    /// Stops the capture.
    ///
    /// # Errors
    /// Where the backend is gone.
    fn stop(&mut self) -> Result<(), Failure>;
}

/// Waits for the end of a capture and shows its progress. Ctrl-C stops it.
fn follow(
    backend: &mut dyn CaptureBackend,
    plan: &CapturePlan,
    interrupt: &AtomicBool,
    progress: &mut Progress,
) -> Result<CaptureEnd, Failure> {
    let (mut printed, mut stopped, mut step) = (0, false, 0);
    let begin = Instant::now();
    loop {
        if interrupt.load(Ordering::Relaxed) && !stopped {
            stopped = true;
            backend.stop()?;
        }
        let now = backend.poll(plan)?;
        for message in now.messages.iter().skip(printed) {
            progress.say(message);
        }
        printed = now.messages.len();
        match now.axis {
            Some(axis) => {
                if axis.step != step {
                    step = axis.step;
                    let begun = step.checked_sub(1).and_then(|step| plan.steps.get(step));
                    if let Some(step) = begun {
                        progress.begin_move(&step.plan);
                    }
                }
                if let Some(angle) = axis.angle_deg {
                    let since = i64::try_from(begin.elapsed().as_nanos()).unwrap_or(i64::MAX);
                    let at = Stamp::from_nanos(0).saturating_add(Span::from_nanos(since));
                    progress.moved(at, Degrees(angle), axis.packets);
                }
            }
            None => progress.end_move(),
        }
        if let Some(end) = now.end {
            progress.end_move();
            return Ok(end);
        }
        let next = Instant::now() + PROGRESS_POLL;
        while Instant::now() < next && (stopped || !interrupt.load(Ordering::Relaxed)) {
            std::thread::sleep(INTERRUPT_POLL);
        }
    }
}

/// A capture by the devices of this process.
struct LocalCapture<'a> {
    local: &'a LocalService,
    result: oneshot::Receiver<CaptureResult>,
    polls: u32,
}

impl<'a> LocalCapture<'a> {
    /// Begins a capture, whose log goes to its place at once.
    fn begin(local: &'a LocalService, plan: CapturePlan) -> Result<Self, Failure> {
        let service = &local.service;
        let lease = service.lease(AxisTask::Capturing).map_err(lease_failure)?;
        let result = service.capture(lease, plan).map_err(lease_failure)?;
        Ok(Self {
            local,
            result,
            polls: 0,
        })
    }
}

impl CaptureBackend for LocalCapture<'_> {
    fn poll(&mut self, _: &CapturePlan) -> Result<CaptureProgress, Failure> {
        let service = &self.local.service;
        match self.result.try_recv() {
            Ok(result) => {
                return Ok(CaptureProgress {
                    end: Some(result?),
                    ..CaptureProgress::default()
                });
            }
            Err(oneshot::error::TryRecvError::Empty) => {}
            Err(oneshot::error::TryRecvError::Closed) => return Err(thread_gone()),
        }
        self.polls += 1;
        if self.polls.is_multiple_of(LIDAR_REFRESH) {
            service.refresh_lidar();
        }
        let activity = service.activity();
        Ok(CaptureProgress {
            axis: Some(AxisProgress {
                step: activity.step,
                packets: activity.received,
                angle_deg: service.angle_deg(),
            }),
            ..CaptureProgress::default()
        })
    }

    fn stop(&mut self) -> Result<(), Failure> {
        // Ctrl-C has stopped it already: the device thread polls the same flag.
        Ok(())
    }
}

/// A capture by a daemon.
struct DaemonCapture {
    client: Client,
    id: String,
}

impl DaemonCapture {
    /// Begins a capture.
    fn begin(client: Client, request: &CaptureRequest) -> Result<Self, Failure> {
        let scan: ScanView = client.post("/api/v1/captures", request)?;
        let id = scan.head.id;
        Ok(Self { client, id })
    }

    fn details(&self) -> Result<ScanDetails, Failure> {
        self.client.get(&format!("/api/v1/scans/{}", self.id))
    }

    /// The scan once the daemon has made its cloud, or has failed to; `None` if the daemon is gone
    /// or has not done so by `until`, or Ctrl-C was pressed.
    fn finished(&self, interrupt: &AtomicBool, until: Instant) -> Option<ScanDetails> {
        while !interrupt.load(Ordering::Relaxed) && Instant::now() < until {
            let details = self.details().ok()?;
            if details.scan.state.is_final() {
                return Some(details);
            }
            std::thread::sleep(PROGRESS_POLL);
        }
        None
    }

    /// Copies a file of the daemon's scan to the user's place.
    fn fetch(&self, what: &str, to: &Path, force: bool) -> Result<(), Failure> {
        let mut file = NewFile::create(to, overwrite(force)).map_err(|e| file_failure(&e))?;
        let path = format!("/api/v1/scans/{}/{what}", self.id);
        self.client.download(&path, &mut file)?;
        file.flush()
            .map_err(|error| output::sink_failure(to, &cloud::SinkError::Other(error.into())))?;
        file.commit().map_err(|error| file_failure(&error))
    }
}

impl CaptureBackend for DaemonCapture {
    fn poll(&mut self, plan: &CapturePlan) -> Result<CaptureProgress, Failure> {
        let details = self.details()?;
        if details.scan.state == ScanState::Recording {
            let status = self.client.status()?;
            return Ok(CaptureProgress {
                messages: details.messages,
                axis: Some(AxisProgress {
                    step: status.activity.step,
                    packets: status.activity.received,
                    angle_deg: status.drive.angle_deg,
                }),
                end: None,
            });
        }
        // The log is complete. The daemon makes the cloud next.
        if details.scan.log_bytes.is_none() {
            return Err(details.scan.head.why.unwrap_or_else(|| {
                Failure::new(Kind::Incomplete, "the daemon made no log").help("see its messages")
            }));
        }
        self.fetch("log", &plan.log, false)?;
        Ok(CaptureProgress {
            messages: details.messages,
            axis: None,
            end: Some(CaptureEnd {
                outcome: Outcome {
                    failure: details.recording,
                    lost_records: details.lost_records,
                    reception: details.reception,
                    warnings: details.warnings,
                },
                truth: None,
            }),
        })
    }

    fn stop(&mut self) -> Result<(), Failure> {
        let _: serde_json::Value = self.client.post("/api/v1/captures/stop", &())?;
        Ok(())
    }
}

/// Runs a jog by the devices of this process.
pub(super) fn jog_locally(local: &LocalService, jog: JogRequest) -> Result<StopAnswer, Failure> {
    let answer = local.service.jog(jog, None).map_err(lease_failure)?;
    let report = answer
        .blocking_recv()
        .unwrap_or_else(|_| Err(thread_gone()))?;
    Ok(StopAnswer::Report(Box::new(report)))
}

fn lease_failure(error: LeaseError) -> Failure {
    match error {
        LeaseError::Failure(failure) => failure,
        LeaseError::Busy(_) => Failure::new(Kind::Busy, "another command moves the axis")
            .help("wait for its end, or stop it (tilt stop)"),
    }
}

pub(super) fn thread_gone() -> Failure {
    Failure::new(Kind::DeviceFault, "the device thread is gone")
        .help("check that the axis is at rest; run with -vv and report the messages")
}

/// A healthy axis is confirmed to be stopped sooner.
const STOP_CONFIRMED: Duration = Duration::from_secs(2);

/// Runs a jog by a daemon. Ctrl-C stops the axis; during a request that moves nothing it ends the
/// wait.
fn jog_by_daemon(
    client: &Client,
    jog: JogRequest,
    interrupt: &AtomicBool,
) -> Result<StopAnswer, Failure> {
    let own = client.clone();
    let request = std::thread::spawn(move || send(&own, jog));
    let moves = matches!(jog, JogRequest::Home | JogRequest::Goto(_));
    let mut unconfirmed = match jog {
        JogRequest::Stop => Some(Instant::now() + STOP_CONFIRMED),
        _ => None,
    };
    let mut stop: Option<JoinHandle<Result<StopAnswer, Failure>>> = None;
    while !request.is_finished() {
        if unconfirmed.take_if(|due| Instant::now() >= *due).is_some() {
            tracing::warn!(
                "the stop is not confirmed yet: switch the motor's supply off if the axis moves"
            );
        }
        if interrupt.swap(false, Ordering::Relaxed) {
            if !moves || stop.is_some() {
                interrupt.store(true, Ordering::Relaxed);
                return Err(Failure::new(
                    Kind::Interrupted,
                    format!(
                        "the daemon at {} has not answered",
                        client.socket.display()
                    ),
                )
                .help("tilt status reports the axis; switch the motor's supply off if it moves and must not"));
            }
            let own = client.clone();
            stop = Some(std::thread::spawn(move || send(&own, JogRequest::Stop)));
        }
        if let Some(stop) = stop.take_if(|stop| stop.is_finished()) {
            joined(stop)?;
        }
        std::thread::sleep(INTERRUPT_POLL);
    }
    joined(request)
}

fn joined(request: JoinHandle<Result<StopAnswer, Failure>>) -> Result<StopAnswer, Failure> {
    request.join().unwrap_or_else(|_| {
        Err(
            Failure::new(Kind::Incomplete, "the thread of the request panicked")
                .help("this is a defect of the program; run with -vv and report the messages"),
        )
    })
}

fn send(client: &Client, request: JogRequest) -> Result<StopAnswer, Failure> {
    match request {
        JogRequest::Status => client.get("/api/v1/tilt"),
        JogRequest::ClearFaults => client.post("/api/v1/tilt/clear", &()),
        JogRequest::Home => client.post("/api/v1/tilt/home", &()),
        JogRequest::Stop => client.post("/api/v1/tilt/stop", &()),
        JogRequest::Goto(goto) => client.post("/api/v1/tilt/goto", &goto),
    }
}
