//! Captures and moves through a daemon that has the device: what is said and written is the same as without one.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use io::files::NewFile;
use serde::Deserialize;
use units::{Degrees, Span, Stamp};

use super::CommandOutput;
use crate::cli::{self, TiltVerb};
use crate::terminal::Progress;
use daemon::client::Client;
use daemon::http::tilt::Goto;
use daemon::scans::{ScanState, ScanView, WholeView};
use engine::capture::jog::Report;
use engine::capture::request::{CapturePlan, CaptureRequest};
use engine::capture::run as job;
use engine::failure::{Failure, Kind};
use engine::output::{self, Aside, Target, file_failure, overwrite};
use engine::reconstruct::report;

/// How often the daemon is asked how far it is.
const LOOK: Duration = Duration::from_millis(50);
/// How often a wish to stop is looked at meanwhile.
const PAUSE: Duration = Duration::from_millis(5);

/// What of the status a bar shows.
#[derive(Deserialize)]
struct Status {
    activity: Activity,
    drive: Drive,
}

#[derive(Deserialize)]
struct Activity {
    step: usize,
    packets: u64,
}

#[derive(Deserialize)]
struct Drive {
    angle_deg: Option<f64>,
}

/// Has a capture made, fetches its log, and makes the cloud of it.
///
/// # Errors
/// As without a daemon.
pub fn capture(
    client: &Client,
    arguments: &cli::Capture,
    (setup, target): (&CapturePlan, Target),
    interrupt: &Arc<AtomicBool>,
    progress: &mut Progress,
) -> Result<CommandOutput, Failure> {
    let begun: ScanView = client.post("/api/v1/captures", &CaptureRequest::from(arguments))?;
    let older_log = Aside::put(&setup.log)?;
    let scan = wait(client, &begun.id, setup, interrupt, progress)?;
    if scan.scan.log_bytes.is_none() {
        return Err(scan.scan.head.why.unwrap_or_else(|| {
            Failure::new(Kind::Incomplete, "the daemon made no log").help("see its messages")
        }));
    }
    fetch(client, &begun.id, &setup.log)?;
    interrupt.store(false, Ordering::Relaxed);
    progress.say("making the cloud");
    let stdout = target.is_stdout();
    let made = job::cloud(setup, None, scan.lost_records, interrupt, target).map(|made| {
        report::ScanReport {
            truth: truth(&scan),
            ..made
        }
    });
    if !matches!(&made, Err(failure) if failure.kind == Kind::BadInput) {
        older_log.replaced();
    }
    let outcome = job::Outcome {
        failure: scan.recording,
        lost_records: scan.lost_records,
        reception: scan.reception,
    };
    let (scan, failure) = job::conclude(made, outcome, (&setup.cloud, &setup.log))?;
    Ok(CommandOutput::scan(&scan, failure, stdout))
}

/// What the daemon's simulator knows of the cloud.
fn truth(scan: &WholeView) -> Option<report::TruthErrors> {
    let truth = scan.report.as_ref()?.get("truth")?;
    serde_json::from_value(truth.clone()).ok()
}

/// Waits until nothing is to be expected of the scan any more. A wish to stop goes to the daemon, once.
fn wait(
    client: &Client,
    id: &str,
    setup: &CapturePlan,
    interrupt: &AtomicBool,
    progress: &mut Progress,
) -> Result<WholeView, Failure> {
    let (mut said, mut stopped, mut step) = (0, false, 0);
    let begin = Instant::now();
    loop {
        if interrupt.load(Ordering::Relaxed) && !stopped {
            stopped = true;
            let _: serde_json::Value = client.post("/api/v1/captures/stop", &())?;
        }
        let scan: WholeView = client.get(&format!("/api/v1/scans/{id}"))?;
        for message in scan.messages.iter().skip(said) {
            progress.say(message);
        }
        said = scan.messages.len();
        if scan.scan.state.is_final() {
            progress.end_move();
            return Ok(scan);
        }
        if scan.scan.state == ScanState::Recording {
            let status: Status = client.get("/api/v1/status")?;
            if status.activity.step != step {
                step = status.activity.step;
                let plan = step.checked_sub(1).and_then(|step| setup.steps.get(step));
                if let Some(step) = plan {
                    progress.begin_move(&step.plan);
                }
            }
            if let Some(angle) = status.drive.angle_deg {
                let since = i64::try_from(begin.elapsed().as_nanos()).unwrap_or(i64::MAX);
                let now = Stamp::from_nanos(0).saturating_add(Span::from_nanos(since));
                progress.moved(now, Degrees(angle), status.activity.packets);
            }
        } else {
            progress.end_move();
        }
        std::thread::sleep(LOOK);
    }
}

/// Copies the daemon's log to where the user wants it.
fn fetch(client: &Client, id: &str, log: &Path) -> Result<(), Failure> {
    let mut file = NewFile::create(log, overwrite(false)).map_err(|e| file_failure(&e))?;
    client.download(&format!("/api/v1/scans/{id}/log"), &mut file)?;
    file.flush()
        .map_err(|error| output::sink_failure(log, &cloud::SinkError::Other(error.into())))?;
    file.commit().map_err(|error| file_failure(&error))
}

/// Has the axis moved, or looked at. A wish to stop goes to the daemon; where that is what is asked already, it ends the waiting.
///
/// # Errors
/// As without a daemon.
pub fn tilt(client: &Client, verb: TiltVerb, interrupt: &AtomicBool) -> Result<Report, Failure> {
    let asking = client.clone();
    let asked = std::thread::spawn(move || ask(&asking, verb));
    let moves = matches!(verb, TiltVerb::Home | TiltVerb::Goto { .. });
    let mut stop: Option<JoinHandle<Result<Report, Failure>>> = None;
    while !asked.is_finished() {
        if interrupt.swap(false, Ordering::Relaxed) {
            if !moves || stop.is_some() {
                return Err(Failure::new(
                    Kind::Interrupted,
                    format!(
                        "the daemon at {} has not answered",
                        client.socket().display()
                    ),
                )
                .help("tilt status says how the axis is; switch the motor's supply off if it moves and must not"));
            }
            let stopping = client.clone();
            stop = Some(std::thread::spawn(move || {
                stopping.post("/api/v1/tilt/stop", &())
            }));
        }
        if let Some(stopped) = stop.take_if(|stop| stop.is_finished()) {
            joined(stopped)?;
        }
        std::thread::sleep(PAUSE);
    }
    joined(asked)
}

fn joined(asking: JoinHandle<Result<Report, Failure>>) -> Result<Report, Failure> {
    asking.join().unwrap_or_else(|_| {
        Err(
            Failure::new(Kind::Incomplete, "the thread that asks the daemon panicked")
                .help("this is a defect of the program; run with -vv and report what it says"),
        )
    })
}

fn ask(client: &Client, verb: TiltVerb) -> Result<Report, Failure> {
    match verb {
        TiltVerb::Status | TiltVerb::Faults { clear: false } => client.get("/api/v1/tilt"),
        TiltVerb::Faults { clear: true } => client.post("/api/v1/tilt/clear", &()),
        TiltVerb::Home => client.post("/api/v1/tilt/home", &()),
        TiltVerb::Stop => client.post("/api/v1/tilt/stop", &()),
        TiltVerb::Goto { to, speed, accel } => {
            let wanted = Goto {
                to_deg: to,
                speed_deg_s: speed,
                accel_deg_s2: accel,
            };
            client.post("/api/v1/tilt/goto", &wanted)
        }
    }
}
