//! `velomotion tilt`: jogs of the axis.

use daemon::client::Client;
use daemon::local::LocalService;
use engine::capture::jog::{self, AxisReport, StopAnswer};
use engine::config;
use engine::devices::profile;
use engine::failure::Failure;

use super::CommandOutput;
use super::device_backend::{jog_by_daemon, jog_locally};
use super::guard_axis::environment;
use crate::cli::{self, Common, TiltVerb};
use crate::signals;
use crate::tables::table;

/// Runs the command.
///
/// # Errors
/// [`Failure`] where the drive is absent, refuses, or fails.
pub fn run(arguments: &cli::TiltArguments, common: &Common) -> Result<CommandOutput, Failure> {
    let verb = arguments.verb;
    let config = config::load(common.config.as_deref())?;
    let (name, device) = profile::choose(&config, common.device.as_deref())?;
    // Refused before a device is opened.
    let request = verb.into();
    jog::commands(request, &config, &device)?;
    let interrupt = signals::motion_interrupt_flag()?;
    let (answer, simulated) = match Client::find(&name, &device) {
        Some(client) => (
            jog_by_daemon(&client, request, &interrupt)?,
            "a software drive, the daemon's",
        ),
        None => {
            let local =
                LocalService::start(config, (name, device), false, &interrupt, environment())?;
            let answer = jog_locally(&local, request);
            local.stop();
            (answer?, "a software drive, switched on a moment ago")
        }
    };
    Ok(match answer {
        StopAnswer::Report(report) => output(&verb, &report, simulated),
        StopAnswer::Command(stopped) => CommandOutput::report(
            &stopped,
            "the program that has the drive has stopped the axis".to_owned(),
        ),
    })
}

/// The report as the verb shows it.
fn output(verb: &TiltVerb, report: &AxisReport, simulated: &str) -> CommandOutput {
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

fn status_table(report: &AxisReport, simulated: &str) -> String {
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
    // Operation enabled, or quick stop active.
    if report.statusword & 0xF == 0x7 {
        rows.insert(2, ("power", "on: the drive holds the axis".to_owned()));
    }
    rows.extend(report.faults.iter().take(1).map(|fault| {
        let name = fault.name.as_deref().unwrap_or("unknown error");
        ("last fault", format!("{} {name} (tilt faults)", fault.code))
    }));
    if report.simulated {
        rows.insert(0, ("SIMULATED", simulated.to_owned()));
    }
    table(rows)
}

fn faults_table(report: &AxisReport) -> String {
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
