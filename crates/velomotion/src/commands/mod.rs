//! The verbs, one file each.

pub mod analyze;
pub mod capture;
pub mod daemon;
pub mod doctor;
pub mod firmware_sim;
pub mod info;
pub mod replay;
pub mod simulate;
pub mod through_daemon;
pub mod tilt;
pub mod tradeoff;

use crate::cli::{Cli, Command};
use engine::failure::Failure;

/// What a command has to say on stdout: one JSON object, or text for people.
pub struct CommandOutput {
    /// For programs.
    pub json: serde_json::Value,
    /// For people.
    pub text: String,
    /// A failure that left something worth saying: it decides the exit code and is printed after the text.
    pub failure: Option<Failure>,
    /// Whether a cloud went to stdout: the text goes to stderr then.
    pub stdout_taken: bool,
    /// Whether the text is what was asked for, and not about what was done: `--quiet` leaves it then.
    pub is_result: bool,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] where nothing came of it.
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
    /// Everything was said while the command ran.
    const fn nothing() -> Self {
        Self {
            json: serde_json::Value::Null,
            text: String::new(),
            failure: None,
            stdout_taken: false,
            is_result: false,
        }
    }

    /// A report that is no scan.
    fn report(report: &impl serde::Serialize, text: String) -> Self {
        Self {
            json: json(report),
            text,
            failure: None,
            stdout_taken: false,
            is_result: false,
        }
    }

    /// A report that is all that comes of the command.
    fn result(report: &impl serde::Serialize, text: String) -> Self {
        Self {
            is_result: true,
            ..Self::report(report, text)
        }
    }

    /// A scan's report. Where the cloud itself went to stdout, nothing else may.
    #[must_use]
    pub fn scan(
        scan: &engine::reconstruct::report::Scan,
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

/// The report as JSON. Reports are structs of numbers and strings: there is nothing in them that JSON cannot say.
fn json(report: &impl serde::Serialize) -> serde_json::Value {
    serde_json::to_value(report)
        .unwrap_or_else(|error| serde_json::json!({ "error": error.to_string() }))
}
