//! `velomotion doctor --bring-up`: leads a person through the first hour with a real drive, and
//! appends what it finds to a report.

use std::fs::OpenOptions;
use std::io::{BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

use daemon::client::Client;
use engine::bring_up::{BringUp, BringUpResult, BringUpStepReport, Judgement, Operator, STEPS};
use engine::config::{Config, Device};
use engine::default_paths;
use engine::devices::drive_port::{self, GuardianOptions, OpenPort, Search};
use engine::devices::profile;
use engine::failure::{Failure, Kind};
use engine::service::axis_report::AxisReport;
use io::discover::discover;
use serde::Serialize;
use units::DegPerS2;
use utoipa::ToSchema;

use super::super::CommandOutput;
use super::super::guard_axis::environment;
use crate::cli::{Common, Doctor};
use crate::signals;
use crate::terminal::to_stderr;

/// Title of the last step.
const KILLED: &str = "a killed program";
/// Report if none is named.
const REPORT: &str = "bring-up.md";
/// Limit on the start of a move, homing included, and on the wait for the port after a kill.
const START_LIMIT: Duration = Duration::from_secs(90);
/// Time that the axis moves before its process is killed.
const MOVING: Duration = Duration::from_millis(500);
/// Between two polls of the process that moves the axis.
const MOVE_POLL: Duration = Duration::from_millis(50);

/// Report of `doctor --bring-up`.
#[derive(Serialize, ToSchema)]
pub struct BringUpReport {
    /// The file that the steps were appended to.
    #[schema(value_type = String)]
    report: PathBuf,
    /// The steps.
    steps: Vec<BringUpStepReport>,
    /// Values to be corrected.
    problems: usize,
    /// Checks that are open, skipped steps included.
    unchecked: usize,
}

/// Asks at the terminal; with `--yes` it asks nothing.
struct TerminalOperator {
    unattended: bool,
    has_ended: bool,
}

impl TerminalOperator {
    fn answer(&self) -> String {
        let mut line = String::new();
        // An end of the input ends the bring-up.
        if self.unattended || std::io::stdin().lock().read_line(&mut line).unwrap_or(0) == 0 {
            return "q".to_owned();
        }
        line.trim().to_lowercase()
    }

    /// Prints unless the person has ended the bring-up.
    fn tell(&self, text: &str) {
        if !self.has_ended {
            to_stderr(text);
        }
    }

    fn show(&self, step: &BringUpStepReport) {
        // The report has all objects.
        let (shown, left) = step.measurements.split_at(step.measurements.len().min(12));
        for measurement in shown {
            self.tell(&line(measurement));
            if let Some(advice) = &measurement.advice {
                self.tell(&format!("         {advice}"));
            }
        }
        if !left.is_empty() {
            self.tell(&format!("         and {} more in the report", left.len()));
        }
    }

    /// Whether a step is done. The end of the bring-up skips all that follow.
    fn choose(&mut self) -> bool {
        if self.unattended || self.has_ended {
            return self.unattended;
        }
        to_stderr("  Enter: do it, s: skip, q: end");
        let answer = self.answer();
        self.has_ended = !matches!(answer.as_str(), "" | "s");
        answer.is_empty()
    }
}

impl Operator for TerminalOperator {
    fn has_done(&mut self, request: &str) -> bool {
        if self.unattended {
            return false;
        }
        to_stderr(&format!("  {request}\n  y: yes, n: no"));
        self.answer() == "y"
    }
}

/// Runs the command.
///
/// # Errors
/// The port cannot be opened, the report cannot be written, the terminal is closed, or a step found
/// a problem.
pub(super) fn run(
    arguments: &Doctor,
    common: &Common,
    config: &Config,
    (name, device): (String, Device),
) -> Result<CommandOutput, Failure> {
    check_arguments(arguments, &device)?;
    let axis = profile::axis(&config.axis)?;
    let interrupt = signals::motion_interrupt_flag()?;
    let port = drive_port::port_path(&name, &device, Search::Once, &discover)?;
    let path = arguments.report.clone().unwrap_or_else(|| REPORT.into());
    let mut person = TerminalOperator {
        unattended: arguments.yes,
        has_ended: false,
    };
    to_stderr(
        "The motor is uncoupled from the head, and you have the supply switch in hand.\n\
         Every step says what it does before it does it. Ctrl-C stops the axis.",
    );
    let mut steps = Vec::new();
    let environment = environment();
    let guarding = environment
        .guardian
        .as_deref()
        .map(|program| GuardianOptions {
            program,
            axis: &config.axis,
        });
    let mut opened = drive_port::open(&device, &port, guarding.as_ref())?;
    let mut report = ReportFile::open(&path, &name, &port)?;
    let acceleration = DegPerS2(device.accel_deg_s2);
    let mut bring_up = BringUp::new(axis, acceleration, &mut opened, Arc::clone(&interrupt));
    for (number, step) in STEPS.iter().enumerate() {
        person.tell(&format!("\n{}. {}: {}", number + 1, step.title, step.plan));
        let done = match person.choose() {
            true => step.run(&mut bring_up, &mut person),
            false => BringUpStepReport::skipped(step.title),
        };
        person.show(&done);
        report.append(&done)?;
        let may_move = done.may_move;
        steps.push(done);
        if may_move {
            return Err(Failure::new(Kind::DeviceFault, "the axis may still move")
                .help("cut the motor's supply now; then see the report"));
        }
        if interrupt.load(Ordering::Relaxed) {
            return Err(
                Failure::new(Kind::Interrupted, "stopped by the user").help("the axis is at rest")
            );
        }
    }
    drop(bring_up);
    person.tell(&format!(
        "\n{}. {KILLED}: MOVES: begins a slow move in another process, kills that with SIGKILL, and watches the axis",
        STEPS.len() + 1
    ));
    let done = match person.choose() {
        true => {
            drop(opened);
            kill(common, &name, config, &device, &port, &interrupt)?
        }
        false => BringUpStepReport::skipped(KILLED),
    };
    person.show(&done);
    report.append(&done)?;
    steps.push(done);
    conclude(steps, report)
}

/// Refuses simulated devices, and questions without a terminal.
fn check_arguments(arguments: &Doctor, device: &Device) -> Result<(), Failure> {
    let (message, help) = if profile::simulated(device) {
        (
            "the bring-up needs a drive of its own, not the simulated devices of --device sim",
            "name the drive with --device; velomotion firmware-sim is one to practise with",
        )
    } else if !arguments.yes && !std::io::stdin().is_terminal() {
        (
            "the questions need a terminal: stdin is not one",
            "run it in a terminal, or with --yes, which runs every step unattended",
        )
    } else {
        return Ok(());
    };
    Err(Failure::new(Kind::Usage, message).help(help))
}

/// Ends the report with its result.
fn conclude(
    steps: Vec<BringUpStepReport>,
    mut report: ReportFile,
) -> Result<CommandOutput, Failure> {
    let count = |judgement| {
        let all = steps.iter().flat_map(|step| &step.measurements);
        all.filter(|found| found.judgement == judgement).count()
    };
    let problems = count(Judgement::Problem);
    let unchecked = count(Judgement::Unchecked);
    let result = match (problems, unchecked) {
        (0, 0) => "no problems, all checks made".to_owned(),
        (0, _) => format!("INCOMPLETE: no problems, but {unchecked} open checks"),
        _ => format!("{problems} problems, {unchecked} open checks"),
    };
    report.write(&format!("\n## Result\n\n{result}\n"))?;
    let failure = match (problems, unchecked) {
        (0, 0) => None,
        (0, _) => Some(
            Failure::new(Kind::Incomplete, format!("{unchecked} checks are open"))
                .help("run the steps again that the report marks OPEN"),
        ),
        _ => Some(
            Failure::new(Kind::DeviceFault, format!("{problems} problems found"))
                .help("correct them before the head is coupled; the report has the advice"),
        ),
    };
    let text = format!("{result}; report {}", report.path.display());
    let output = BringUpReport {
        report: report.path,
        steps,
        problems,
        unchecked,
    };
    Ok(CommandOutput {
        failure,
        ..CommandOutput::report(&output, text)
    })
}

fn line(measurement: &BringUpResult) -> String {
    let mark = match measurement.judgement {
        Judgement::Good => "good   ",
        Judgement::Problem => "PROBLEM",
        Judgement::Noted => "       ",
        Judgement::Unchecked => "OPEN   ",
    };
    format!("{mark}  {}: {}", measurement.name, measurement.value)
}

/// The report, to which every step is appended at once.
struct ReportFile {
    file: std::fs::File,
    path: PathBuf,
}

impl ReportFile {
    fn open(path: &Path, name: &str, port: &Path) -> Result<Self, Failure> {
        let file = OpenOptions::new().append(true).create(true).open(path);
        let file = file.map_err(|error| failed(path, &error))?;
        let mut report = Self {
            file,
            path: path.to_owned(),
        };
        let time = default_paths::time_text(SystemTime::now());
        report.write(&format!(
            "# Bring-up of {name} at {}, {time}, velomotion {}\n",
            port.display(),
            env!("CARGO_PKG_VERSION")
        ))?;
        Ok(report)
    }

    fn append(&mut self, step: &BringUpStepReport) -> Result<(), Failure> {
        let mut text = format!("\n## {}\n\n", step.step);
        for measurement in &step.measurements {
            text.push_str(&format!("- {}\n", line(measurement).trim_start()));
            if let Some(advice) = &measurement.advice {
                text.push_str(&format!("  - {advice}\n"));
            }
        }
        self.write(&text)
    }

    fn write(&mut self, text: &str) -> Result<(), Failure> {
        let written = self.file.write_all(text.as_bytes());
        written
            .and_then(|()| self.file.flush())
            .map_err(|error| failed(&self.path, &error))
    }
}

fn failed(path: &Path, error: &std::io::Error) -> Failure {
    Failure::new(
        Kind::BadInput,
        format!("the report {} cannot be written: {error}", path.display()),
    )
    .help("name another file with --report; the axis is at rest")
}

/// Kills a process that moves the axis, and watches what becomes of it.
fn kill(
    common: &Common,
    name: &str,
    config: &Config,
    device: &Device,
    port: &Path,
    interrupt: &Arc<AtomicBool>,
) -> Result<BringUpStepReport, Failure> {
    let own = |kind: Kind, error: std::io::Error| {
        Failure::new(
            kind,
            format!("the moving process cannot be watched: {error}"),
        )
        .help("run the step again")
    };
    let middle = (config.axis.min_deg + config.axis.max_deg) / 2.0;
    // Ten seconds from home.
    let speed = (config.axis.homing.to_deg - middle).abs().max(1.0) / 10.0;
    let mut command = Command::new(std::env::current_exe().map_err(|e| own(Kind::BadInput, e))?);
    command.args(["tilt", "goto", &format!("{middle}")]);
    command.args(["--speed", &format!("{speed}"), "--device", name]);
    if let Some(file) = &common.config {
        command.arg("--config").arg(file);
    }
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let mut child = command.spawn().map_err(|e| own(Kind::NoDevice, e))?;
    let moved = wait_for_move(&mut child, name, device);
    let killed = Instant::now();
    let _ = child.kill();
    let _ = child.wait();
    let mut step = BringUpStepReport {
        step: KILLED,
        measurements: Vec::new(),
        may_move: false,
    };
    if !moved {
        step.measurements.push(BringUpResult {
            name: "move".to_owned(),
            value: "the move did not begin".to_owned(),
            judgement: Judgement::Problem,
            advice: Some("repeat the step after the problems before it are solved".to_owned()),
        });
        return Ok(step);
    }
    // A guardian of the killed process closes the port once the axis is at rest.
    let mut opened = reopen(device, port)?;
    let axis = profile::axis(&config.axis)?;
    let acceleration = DegPerS2(device.accel_deg_s2);
    let mut bring_up = BringUp::new(axis, acceleration, &mut opened, Arc::clone(interrupt));
    step.measurements.push(bring_up.rest_after(killed));
    Ok(step)
}

/// Waits until the process reports that the axis moves.
fn wait_for_move(child: &mut Child, name: &str, device: &Device) -> bool {
    let until = Instant::now() + START_LIMIT;
    while Instant::now() < until && matches!(child.try_wait(), Ok(None)) {
        let report = Client::find(name, device)
            .and_then(|client| client.get::<AxisReport>("/api/v1/tilt").ok());
        if report.is_some_and(|report| report.velocity_rpm != 0) {
            std::thread::sleep(MOVING);
            return true;
        }
        std::thread::sleep(MOVE_POLL);
    }
    false
}

/// Opens the port as soon as the killed process's guardian has closed it.
fn reopen(device: &Device, port: &Path) -> Result<OpenPort, Failure> {
    let until = Instant::now() + START_LIMIT;
    loop {
        match drive_port::open(device, port, None) {
            Err(failure) if Instant::now() >= until => return Err(failure),
            Err(_) => std::thread::sleep(Duration::from_millis(20)),
            Ok(opened) => return Ok(opened),
        }
    }
}
