//! `velomotion tilt`: the axis by hand.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use drive::{Client, Command, DeviceError, Outcome, Status};
use io::port::Port;
use serde::Serialize;
use units::{DegPerS, DegPerS2, Degrees};

use super::Said;
use crate::cli::{self, Common, TiltVerb};
use crate::config::{self, Config, Device};
use crate::control::{self, Asked};
use crate::failure::{Failure, Kind};
use crate::report::table;
use crate::session::{Session, SessionError};
use crate::simulated::{Destinations, Simulated};
use crate::{devices, ports, signals, simulated};

/// What the drive said about itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Report {
    device: String,
    state: String,
    statusword: u16,
    mode: i8,
    referenced: bool,
    /// Absent while the axis does not know where it is.
    angle_deg: Option<f64>,
    position_qc: i32,
    velocity_rpm: i32,
    negative_limit: bool,
    positive_limit: bool,
    home_switch: bool,
    faults: Vec<Fault>,
    simulated: bool,
}

/// An entry of the error history.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Fault {
    code: String,
    name: Option<&'static str>,
    meaning: Option<&'static str>,
    remedy: Option<&'static str>,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] where the drive is not there, refuses, or does not do it.
pub fn run(arguments: &cli::Tilt, common: &Common) -> Result<Said, Failure> {
    let config = config::load(common.config.as_deref())?;
    let (name, device) = devices::choose(&config, common.device.as_deref())?;
    // Refused before a device is touched.
    let commands = commands(&arguments.verb, &config, &device)?;
    let interrupt = signals::interrupt_flag()?;
    if devices::simulated(&device) {
        let axis = devices::axis(&config.axis)?;
        let scan = scanner::ScanConfig::default();
        let rig = simulated::rig(&axis, &scan, io::clock::now());
        // Nobody listens to this lidar.
        let scanner = Simulated::start(
            rig,
            Destinations {
                data: 9,
                position: 9,
            },
        )?;
        let path = scanner.port().to_owned();
        let said = with_port(
            arguments,
            &config,
            (&name, &device),
            &path,
            &commands,
            interrupt,
        );
        drop(scanner.stop());
        return said;
    }
    let path = ports::place(&name, &device)?;
    if matches!(arguments.verb, TiltVerb::Stop) {
        match control::ask_to_stop(&path) {
            Asked::Nobody => {}
            Asked::Stopped => return Ok(stopped_elsewhere(&name)),
            Asked::NotStopped => {
                return Err(Failure::new(
                    Kind::DeviceFault,
                    "the program that has the drive could not stop the axis, or did not say so in 10 s",
                )
                .help("switch the motor's supply off if the axis moves"));
            }
        }
    }
    with_port(
        arguments,
        &config,
        (&name, &device),
        &path,
        &commands,
        interrupt,
    )
}

/// What to ask of the drive, in order.
fn commands(verb: &TiltVerb, config: &Config, device: &Device) -> Result<Vec<Command>, Failure> {
    Ok(match verb {
        TiltVerb::Status => vec![],
        TiltVerb::Faults { clear: false } => vec![],
        TiltVerb::Faults { clear: true } => vec![Command::ClearFaults],
        TiltVerb::Stop => vec![Command::Stop],
        TiltVerb::Home => vec![Command::Connect, Command::Home, Command::Brake],
        TiltVerb::Goto { to, speed, accel } => {
            let axis = devices::axis(&config.axis)?;
            let accel = accel.unwrap_or(device.accel_deg_s2);
            let plan = axis
                .plan(
                    Degrees(config.axis.homing.to_deg),
                    Degrees(*to),
                    DegPerS(*speed),
                    DegPerS2(accel),
                )
                .map_err(|error| Failure::new(Kind::Usage, error.to_string()).help(error.help()))?;
            let to = drive::Move {
                to: plan.to,
                speed: plan.speed,
                acceleration: plan.acceleration,
            };
            vec![Command::Connect, Command::Goto(to), Command::Brake]
        }
    })
}

fn with_port(
    arguments: &cli::Tilt,
    config: &Config,
    (name, device): (&str, &Device),
    place: &Path,
    commands: &[Command],
    interrupt: Arc<AtomicBool>,
) -> Result<Said, Failure> {
    let simulated = devices::simulated(device);
    let opened = ports::open(device, place)?;
    let client = Client::with_link(devices::axis(&config.axis)?, opened.link);
    let control = control::Control::listen(place, &interrupt);
    let mut session = Session::new(client, opened.port, interrupt);
    let done = ask(&mut session, commands, simulated);
    if let Some(control) = control {
        control.ended(!matches!(
            done,
            Err(SessionError::NotStopped(_) | SessionError::Port(_))
        ));
    }
    let status = done.map_err(|error| session_failure(&error))?;
    let report = report(name, &status, simulated);
    let text = match arguments.verb {
        TiltVerb::Faults { .. } => faults_table(&report),
        _ => status_table(&report),
    };
    Ok(Said::report(&report, text))
}

/// Runs the commands and asks how the axis then stands. A software drive is homed first where a move is asked: it was born a moment ago.
fn ask(
    session: &mut Session<Box<dyn Port>>,
    commands: &[Command],
    simulated: bool,
) -> Result<Status, SessionError> {
    for command in commands {
        if simulated && matches!(command, Command::Goto(_)) {
            session.run(Command::Home, &mut |_| {})?;
        }
        session.run(*command, &mut |event| tracing::debug!(?event))?;
    }
    match session.run(Command::Status, &mut |_| {})? {
        Outcome::Status(status) => Ok(status),
        _ => Err(SessionError::Interrupted),
    }
}

fn report(device: &str, status: &Status, simulated: bool) -> Report {
    Report {
        device: device.to_owned(),
        state: status
            .state
            .map_or("unknown".to_owned(), |state| state.to_string()),
        statusword: status.statusword,
        mode: status.mode,
        referenced: status.referenced,
        angle_deg: status.angle.map(|angle| angle.0),
        position_qc: status.position.0,
        velocity_rpm: status.velocity_rpm,
        negative_limit: status.inputs & 1 != 0,
        positive_limit: status.inputs & 2 != 0,
        home_switch: status.inputs & 4 != 0,
        faults: status.history.iter().map(|error| fault(*error)).collect(),
        simulated,
    }
}

fn fault(error: DeviceError) -> Fault {
    let meaning = error.meaning();
    Fault {
        code: format!("{:04X}", error.0),
        name: meaning.map(|m| m.name),
        meaning: meaning.map(|m| m.meaning),
        remedy: meaning.map(|m| m.remedy),
    }
}

fn status_table(report: &Report) -> String {
    let yes = |on: bool| if on { "pressed" } else { "free" };
    let angle = match report.angle_deg {
        Some(angle) => format!("{angle:.4} deg"),
        None => "not known: not homed since power-on (tilt home)".to_owned(),
    };
    let mut rows = vec![
        ("drive", report.device.clone()),
        (
            "state",
            format!("{} (statusword {:04X})", report.state, report.statusword),
        ),
        ("angle", angle),
        ("position", format!("{} qc", report.position_qc)),
        ("speed", format!("{} rpm of the motor", report.velocity_rpm)),
        (
            "limit switches",
            format!(
                "negative {}, positive {}",
                yes(report.negative_limit),
                yes(report.positive_limit)
            ),
        ),
    ];
    rows.extend(report.faults.iter().take(1).map(|fault| {
        let name = fault.name.unwrap_or("unknown error");
        ("last fault", format!("{} {name} (tilt faults)", fault.code))
    }));
    if report.simulated {
        rows.insert(
            0,
            (
                "SIMULATED",
                "a software drive, switched on a moment ago".to_owned(),
            ),
        );
    }
    table(rows)
}

fn faults_table(report: &Report) -> String {
    if report.faults.is_empty() {
        return "no faults in the drive's history".to_owned();
    }
    let mut text = String::new();
    for fault in &report.faults {
        let name = fault.name.unwrap_or("unknown to the public guides");
        text.push_str(&format!("{}  {name}\n", fault.code));
        for line in [fault.meaning, fault.remedy].into_iter().flatten() {
            text.push_str(&format!("      {line}\n"));
        }
    }
    text.push_str("newest first; tilt faults --clear takes the drive out of its fault");
    text
}

fn stopped_elsewhere(device: &str) -> Said {
    #[derive(Serialize)]
    struct Stopped<'a> {
        device: &'a str,
        stopped: bool,
    }
    let report = Stopped {
        device,
        stopped: true,
    };
    Said::report(
        &report,
        "the program that has the drive has stopped the axis".to_owned(),
    )
}

fn session_failure(error: &SessionError) -> Failure {
    let kind = match error {
        SessionError::Interrupted => Kind::Interrupted,
        _ => Kind::DeviceFault,
    };
    let help = error.help().unwrap_or_else(|| {
        "the axis stands, its power stage off, its brake set if it has one".to_owned()
    });
    Failure::new(kind, error.to_string()).help(help)
}
