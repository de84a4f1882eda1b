//! `velomotion tilt`: the axis by hand.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use drive::{DriveClient, DriveCommand};
use serde::Serialize;

use super::{CommandOutput, through_daemon};
use crate::cli::{self, Common, TiltVerb};
use crate::signals;
use crate::tables::table;
use daemon::client;
use engine::capture::jog::{self as tilting, Homing, Report};
use engine::config::{self, Config, Device};
use engine::devices::drive_port as ports;
use engine::devices::drive_port::Looks;
use engine::devices::drive_session::{Session, SessionError};
use engine::devices::profile as devices;
use engine::devices::simulated;
use engine::devices::simulated::{Destinations, Simulated};
use engine::failure::{Failure, Kind};
use engine::stop_socket::{self as control, Asked};

/// Runs the command.
///
/// # Errors
/// [`Failure`] where the drive is not there, refuses, or does not do it.
pub fn run(arguments: &cli::Tilt, common: &Common) -> Result<CommandOutput, Failure> {
    let config = config::load(common.config.as_deref())?;
    let (name, device) = devices::choose(&config, common.device.as_deref())?;
    // Refused before a device is touched.
    let commands = tilting::commands(arguments.verb.into(), &config, &device)?;
    if let Some(client) = client::Client::find(&name, &device) {
        let interrupt = signals::interrupt_flag()?;
        let report = through_daemon::tilt(&client, arguments.verb, &interrupt)?;
        return Ok(say(
            &arguments.verb,
            &report,
            "a software drive, the daemon's",
        ));
    }
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
    let path = ports::place(&name, &device, Looks::Once, &io::discover::discover)?;
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

fn with_port(
    arguments: &cli::Tilt,
    config: &Config,
    (name, device): (&str, &Device),
    place: &Path,
    commands: &[DriveCommand],
    interrupt: Arc<AtomicBool>,
) -> Result<CommandOutput, Failure> {
    let simulated = devices::simulated(device);
    let opened = ports::open(device, place)?;
    let client = DriveClient::new(devices::axis(&config.axis)?, opened.link);
    let control = control::Control::listen(place, &interrupt);
    let mut session = Session::new(client, opened.port, interrupt);
    // A software drive was born a moment ago.
    let homing = match simulated {
        true => Homing::First,
        false => Homing::AsAsked,
    };
    let done = tilting::ask(&mut session, commands, homing, &mut |event| {
        tracing::debug!(?event);
    });
    if let Some(control) = control {
        control.ended(!done.as_ref().is_err_and(SessionError::may_move));
    }
    let status = done.map_err(|error| tilting::failure(&error))?;
    Ok(say(
        &arguments.verb,
        &Report::new(name, &status, simulated),
        "a software drive, switched on a moment ago",
    ))
}

/// The report as the verb shows it.
fn say(verb: &TiltVerb, report: &Report, simulated: &str) -> CommandOutput {
    let text = match verb {
        TiltVerb::Faults { .. } => faults_table(report),
        _ => status_table(report, simulated),
    };
    match verb {
        TiltVerb::Status | TiltVerb::Faults { .. } => CommandOutput::result(report, text),
        TiltVerb::Home | TiltVerb::Goto { .. } | TiltVerb::Stop => {
            CommandOutput::report(report, text)
        }
    }
}

fn status_table(report: &Report, simulated: &str) -> String {
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
        let name = fault.name.as_deref().unwrap_or("unknown error");
        ("last fault", format!("{} {name} (tilt faults)", fault.code))
    }));
    if report.simulated {
        rows.insert(0, ("SIMULATED", simulated.to_owned()));
    }
    table(rows)
}

fn faults_table(report: &Report) -> String {
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

fn stopped_elsewhere(device: &str) -> CommandOutput {
    #[derive(Serialize)]
    struct Stopped<'a> {
        device: &'a str,
        stopped: bool,
    }
    let report = Stopped {
        device,
        stopped: true,
    };
    CommandOutput::report(
        &report,
        "the program that has the drive has stopped the axis".to_owned(),
    )
}
