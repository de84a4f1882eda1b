//! The commands, one file each.

pub mod analyze;
pub mod capture;
pub mod daemon;
pub mod device_backend;
pub mod doctor;
pub mod firmware_sim;
pub mod info;
pub mod replay;
pub mod simulate;
pub mod tilt;
pub mod tradeoff;

use crate::cli::{Cli, Command};
use engine::failure::Failure;

/// Output of a command: one JSON object or text.
pub struct CommandOutput {
    /// Output with `--json`.
    pub json: serde_json::Value,
    /// Output without `--json`.
    pub text: String,
    /// A failure that left a usable result. It sets the exit code and is printed after the text.
    pub failure: Option<Failure>,
    /// Whether stdout holds a cloud, which moves the text to stderr.
    pub stdout_taken: bool,
    /// Whether the text is the requested result, which `--quiet` keeps.
    pub is_result: bool,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] without a result.
pub fn run(cli: &Cli) -> Result<CommandOutput, Failure> {
    match &cli.command {
        Command::Capture(arguments) => capture::run(arguments, &cli.common),
        Command::Replay(arguments) => replay::run(arguments, &cli.common),
        Command::Simulate(arguments) => simulate::run(arguments, &cli.common),
        Command::Info(arguments) => info::run(arguments),
        Command::Analyze(arguments) => analyze::run(arguments, &cli.common),
        Command::Tradeoff(arguments) => tradeoff::run(arguments, &cli.common),
        Command::Tilt(arguments) => tilt::run(arguments, &cli.common),
        Command::Daemon(arguments) => daemon::run(arguments, &cli.common),
        Command::Doctor => doctor::run(&cli.common),
        Command::FirmwareSim(arguments) => firmware_sim::run(arguments, &cli.common),
    }
}

impl CommandOutput {
    /// No output.
    const fn nothing() -> Self {
        Self {
            json: serde_json::Value::Null,
            text: String::new(),
            failure: None,
            stdout_taken: false,
            is_result: false,
        }
    }

    /// Report of an action.
    fn report(report: &impl serde::Serialize, text: String) -> Self {
        Self {
            json: json(report),
            text,
            failure: None,
            stdout_taken: false,
            is_result: false,
        }
    }

    /// Report that is the result of the command.
    fn result(report: &impl serde::Serialize, text: String) -> Self {
        Self {
            is_result: true,
            ..Self::report(report, text)
        }
    }

    /// Report on a scan.
    #[must_use]
    pub fn scan(
        scan: &engine::reconstruct::report::ScanReport,
        failure: Option<Failure>,
        stdout_taken: bool,
    ) -> Self {
        Self {
            json: json(scan),
            text: crate::tables::scan_table(scan),
            failure,
            stdout_taken,
            is_result: false,
        }
    }
}

/// The report as JSON. Reports hold numbers and strings only, so that serialisation cannot fail.
fn json(report: &impl serde::Serialize) -> serde_json::Value {
    serde_json::to_value(report)
        .unwrap_or_else(|error| serde_json::json!({ "error": error.to_string() }))
}
