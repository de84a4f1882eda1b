//! `velomotion tilt`: jogs of the axis.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver};
use std::time::Duration;

use daemon::client::Client;
use daemon::local::LocalTask;
use engine::capture::jog::{self, JogRequest};
use engine::config::{self, Config, Device, DeviceKind, WithoutBrake};
use engine::devices::profile;
use engine::failure::{Failure, Kind};
use engine::service::axis_report::{AxisReport, StopAnswer};
use engine::service::status::AxisTask;

use super::CommandOutput;
use super::device_backend::DeviceBackend;
use crate::cli::{self, Common, TiltVerb};
use crate::signals;
use crate::tables::table;

/// Longest wait for the answer of the program that uses the bus, after that of the drive. Without
/// it, where the bus fails at once, the command ended before the request was sent.
const USER_WAIT: Duration = Duration::from_secs(1);

/// Largest distance beyond a limit at which an axis moved there may rest, degrees: a count of a
/// coarse encoder, as in the page.
const AT_LIMIT_DEG: f64 = 0.02;

/// Runs the command.
///
/// # Errors
/// [`Failure`] where the drive is absent, refuses, or fails.
pub fn run(arguments: &cli::TiltArguments, common: &Common) -> Result<CommandOutput, Failure> {
    let verb = arguments.verb;
    let config = config::load(common.config.as_deref())?;
    let device = profile::choose(&config, arguments.device.name.as_deref())?;
    let interrupt = signals::motion_interrupt_flag()?;
    let axis = Axis {
        config: &config,
        device: &device,
        interrupt: &interrupt,
    };
    let request = verb.request(|by_deg| axis.end_of_jog(by_deg))?;
    // Refused before a device is opened.
    jog::commands(request, &config, &device.1)?;
    let (answer, simulated) = axis.run(request)?;
    Ok(match answer {
        StopAnswer::Report(report) => {
            let holds = config.axis.without_brake == WithoutBrake::Hold;
            output(&verb, &report, simulated, holds)
        }
        StopAnswer::Command(stopped) if stopped.stopped => {
            let power = if stopped.power { "on" } else { "off" };
            let text = format!(
                "the program that has the drive has stopped the axis: {}, power {power}",
                stopped.state
            );
            CommandOutput::report(&stopped, text)
        }
        StopAnswer::Command(_) => {
            return Err(Failure::new(
                Kind::DeviceFault,
                "the program that has the drive did not stop the axis",
            )
            .help("switch the motor's supply off if the axis moves"));
        }
    })
}

/// The axis of a device.
struct Axis<'a> {
    config: &'a Config,
    device: &'a (String, Device),
    interrupt: &'a Arc<AtomicBool>,
}

impl Axis<'_> {
    /// Runs a request, and names the simulator if it is software.
    fn run(&self, request: JogRequest) -> Result<(StopAnswer, &'static str), Failure> {
        // A program may take or release the drive in the meantime.
        let changed = |failure: &Failure| match failure.kind {
            Kind::Busy => client_of(request, self.device).is_some(),
            Kind::Interrupted | Kind::Incomplete => {
                request == JogRequest::Status && !self.interrupt.load(Ordering::Relaxed)
            }
            _ => false,
        };
        match self.run_once(request) {
            Err(failure) if changed(&failure) => self.run_once(request),
            answer => answer,
        }
    }

    fn run_once(&self, request: JogRequest) -> Result<(StopAnswer, &'static str), Failure> {
        let mut daemon = client_of(request, self.device);
        let device = (self.device.0.as_str(), &self.device.1);
        // Any program may use a bus, so its answer proves nothing: the stop goes to the drive, too.
        let is_bus = device.1.kind == DeviceKind::Can && request == JogRequest::Stop;
        let user = daemon.take_if(|_| is_bus).map(|client| {
            let interrupt = Arc::clone(self.interrupt);
            let (sender, answer) = mpsc::channel();
            std::thread::spawn(move || {
                let _ = sender.send(DeviceBackend::Daemon(client).jog(request, &interrupt));
            });
            answer
        });
        let task = match request {
            JogRequest::Status => LocalTask::Read,
            _ => LocalTask::Jog,
        };
        let backend = DeviceBackend::open(daemon, self.config, device, task, self.interrupt);
        let answer = backend.and_then(|backend| {
            let simulated = backend.simulated_drive();
            Ok((backend.jog(request, self.interrupt)?, simulated))
        });
        if let Some(user) = user {
            warn_of_user(user);
        }
        answer
    }

    /// The angle of the axis after a jog. One at rest may be a little beyond its limit.
    fn end_of_jog(&self, by_deg: f64) -> Result<f64, Failure> {
        let limits = &self.config.axis;
        let angle_deg = match self.run(JogRequest::Status)?.0 {
            // From an angle on the way of another motion the end would be elsewhere.
            StopAnswer::Report(report) if report.activity != AxisTask::Idle => {
                let message = format!("the axis is in use: {}", report.activity.description());
                return Err(Failure::new(Kind::Busy, message)
                    .help("wait for its end, or stop it (tilt stop)"));
            }
            StopAnswer::Report(report) => report.angle_deg,
            StopAnswer::Command(_) => None,
        };
        // A simulated drive that is not homed is homed by its first move.
        let homed = || profile::simulated(&self.device.1).then_some(limits.homing.to_deg);
        let Some(from_deg) = angle_deg.or_else(homed) else {
            let message = "the angle is not known: the axis has not been homed since power-on";
            return Err(Failure::new(Kind::DeviceFault, message)
                .help("home it first: velomotion tilt home"));
        };
        let end_deg = from_deg + by_deg;
        let limit_deg = end_deg.clamp(limits.min_deg, limits.max_deg);
        Ok(match (end_deg - limit_deg).abs() < AT_LIMIT_DEG {
            true => limit_deg,
            false => end_deg,
        })
    }
}

/// Warns where the program that uses the bus has not stopped its own motion.
fn warn_of_user(answer: Receiver<Result<StopAnswer, Failure>>) {
    let problem = match answer.recv_timeout(USER_WAIT) {
        Err(_) => "has not answered".to_owned(),
        Ok(Err(failure)) => failure.message,
        Ok(Ok(_)) => return,
    };
    tracing::warn!("the program that uses the bus: {problem}");
}

/// The program that has the drive. A stop is confirmed only by one that has its port; else it goes
/// to the drive itself.
fn client_of(request: JogRequest, (name, device): &(String, Device)) -> Option<Client> {
    Client::find(name, device)
        .filter(|client| request != JogRequest::Stop || client.holds_port(device) != Some(false))
}

/// The report as the verb shows it.
fn output(verb: &TiltVerb, report: &AxisReport, simulated: &str, holds: bool) -> CommandOutput {
    let text = match verb {
        TiltVerb::Faults { clear: true } => {
            let state = &report.state;
            let kept = match report.faults.first() {
                None => "its error history is empty".to_owned(),
                Some(last) => format!("its error history begins with {} (tilt faults)", last.code),
            };
            format!("the drive is not in fault: its state is {state}; {kept}")
        }
        TiltVerb::Faults { clear: false } => faults_table(report),
        _ => status_table(report, simulated, holds),
    };
    match verb {
        TiltVerb::Status | TiltVerb::Faults { .. } => CommandOutput::result(report, text),
        TiltVerb::Home | TiltVerb::Goto { .. } | TiltVerb::Jog { .. } | TiltVerb::Stop => {
            CommandOutput::report(report, text)
        }
    }
}

/// `holds`: the drive is configured to hold the axis at rest.
fn status_table(report: &AxisReport, simulated: &str, holds: bool) -> String {
    let yes = |on: bool| if on { "pressed" } else { "free" };
    let angle = match report.angle_deg {
        Some(angle) => format!("{angle:.4} deg"),
        None => "not known: not homed since power-on (tilt home)".to_owned(),
    };
    let power = match report.power {
        true if holds && report.activity == AxisTask::Idle => "on: the drive holds the axis",
        true => "on",
        false => "off",
    };
    let mut rows = vec![
        ("drive", report.device.clone()),
        ("unit", report.unit.clone()),
        (
            "state",
            format!("{} (statusword {:04X})", report.state, report.statusword),
        ),
        ("power", power.to_owned()),
        ("angle", angle),
        ("position", format!("{} qc", report.position_qc)),
        ("speed", format!("{} rpm of the motor", report.velocity_rpm)),
    ];
    if report.activity != AxisTask::Idle {
        let task = report.activity.description();
        rows.insert(
            1,
            (
                "in use",
                format!("{task} (values {:.1} s old)", report.age_s),
            ),
        );
    }
    if let Some(age) = report.switches_age_s {
        let age = match age {
            0.0 => String::new(),
            age => format!(" ({age:.1} s ago)"),
        };
        let (negative, positive) = (yes(report.negative_limit), yes(report.positive_limit));
        let switches = format!("negative {negative}, positive {positive}{age}");
        rows.push(("limit switches", switches));
    }
    rows.extend(report.faults.iter().take(1).map(|fault| {
        let name = fault.name.as_deref().unwrap_or("unknown error");
        ("last fault", format!("{} {name} (tilt faults)", fault.code))
    }));
    rows.extend(report.warnings.iter().map(|text| ("warning", text.clone())));
    if report.simulated {
        rows.insert(0, ("SIMULATED", simulated.to_owned()));
    }
    table(rows)
}

fn faults_table(report: &AxisReport) -> String {
    if report.switches_age_s.is_none() {
        return "the drive's error history has not been read: another command uses the device"
            .to_owned();
    }
    if report.faults.is_empty() {
        return "no faults in the drive's history".to_owned();
    }
    let mut text = String::new();
    for fault in &report.faults {
        let name = fault
            .name
            .as_deref()
            .unwrap_or("unknown to the public guides");
        text.push_str(&format!("{}  {name}\n", fault.code));
        for line in [&fault.meaning, &fault.remedy].into_iter().flatten() {
            text.push_str(&format!("      {line}\n"));
        }
    }
    text.push_str("newest first; tilt faults --clear takes the drive out of its fault");
    text
}
