//! `velomotion guard-axis`: the guardian process of a command or daemon that drives the axis. It is
//! started by them only.

use std::path::PathBuf;
use std::sync::OnceLock;

use engine::devices::guardian::{self, GuardianReport};
use engine::failure::{Failure, Kind};
use engine::service::Environment;

use super::CommandOutput;
use crate::terminal::to_stderr;

/// The running program, also after an update has replaced its file.
const OWN_PROGRAM: &str = "/proc/self/exe";

/// The program that runs this command, if the process is one that can.
static PROGRAM: OnceLock<PathBuf> = OnceLock::new();

/// Declares that the running program has this command, so that it can be its own guardian.
pub fn offer() {
    let _ = PROGRAM.set(OWN_PROGRAM.into());
}

/// The machine, with this program as guardian.
#[must_use]
pub fn environment() -> Environment {
    Environment {
        guardian: PROGRAM.get().cloned(),
        ..Environment::default()
    }
}

/// Runs the command.
///
/// # Errors
/// The process was not started as a guardian.
pub fn run() -> Result<CommandOutput, Failure> {
    let report = guardian::run().map_err(|error| {
        Failure::new(
            Kind::Usage,
            format!("not started by a command that moves the axis: {error}"),
        )
        .help("this command is internal; velomotion help tilt describes it")
    })?;
    // stdout is the drive's port.
    if let Some(report) = report {
        to_stderr(&message(&report));
    }
    Ok(CommandOutput::default())
}

fn message(report: &GuardianReport) -> String {
    let why = match report.parent_died {
        true => "velomotion ended while the axis could move",
        false => "velomotion sent no sign of life for 0.5 s while the axis could move",
    };
    match &report.failure {
        None => format!("{why}: its guardian process has stopped the axis"),
        Some(failure) => format!(
            "{why}, and its guardian process could not stop the axis: {failure}; switch the motor's supply off if the axis moves"
        ),
    }
}
