//! The command line: arguments, one file per command, and what appears on the terminal.

pub mod cli;
pub mod commands;
mod documents;
pub mod logging;
pub mod signals;
pub mod sweep_ranges;
pub mod tables;
pub mod terminal;

use cli::{Cli, Command};
use commands::CommandOutput;
use engine::failure::Failure;

/// Runs the command.
///
/// # Errors
/// [`Failure`] without a result.
pub fn run(cli: &Cli) -> Result<CommandOutput, Failure> {
    if let Some(file) = cli.common.config.as_deref() {
        // Also for commands that need no configuration: a mistyped name is an error.
        engine::config::load(Some(file))?;
    }
    match &cli.command {
        #[cfg(devices)]
        Command::Capture(arguments) => commands::capture::run(arguments, &cli.common),
        Command::Replay(arguments) => commands::replay::run(arguments, &cli.common),
        Command::Simulate(arguments) => commands::simulate::run(arguments, &cli.common),
        Command::View(arguments) => commands::view::run(arguments, &cli.common),
        Command::Info(arguments) => commands::info::run(arguments),
        Command::Calibrate(arguments) => commands::calibrate::run(arguments, &cli.common),
        Command::Accuracy(arguments) => commands::accuracy::run(arguments, &cli.common),
        Command::Plan(arguments) => commands::plan::run(arguments, &cli.common),
        Command::Analyze(arguments) => commands::analyze::run(arguments, &cli.common),
        Command::Tradeoff(arguments) => commands::tradeoff::run(arguments, &cli.common),
        #[cfg(devices)]
        Command::Tilt(arguments) => commands::tilt::run(arguments, &cli.common),
        #[cfg(devices)]
        Command::Daemon(arguments) => commands::daemon::run(arguments, &cli.common),
        #[cfg(devices)]
        Command::Doctor(arguments) => commands::doctor::run(arguments, &cli.common),
        Command::Help(arguments) => commands::help::run(arguments),
        #[cfg(devices)]
        Command::GuardAxis => commands::guard_axis::run(),
        #[cfg(not(devices))]
        _ => Err(no_devices()),
        #[cfg(devices)]
        Command::FirmwareSim(arguments) => commands::firmware_sim::run(arguments, &cli.common),
    }
}

/// The refusal of commands for devices by a build without them.
#[cfg(not(devices))]
fn no_devices() -> Failure {
    use engine::failure::Kind;
    Failure::new(Kind::Usage, "this velomotion was built without devices").help(
        "capture, tilt, daemon, doctor and firmware-sim need Linux, and a build with the feature devices (the default); \
         simulate makes a log without devices",
    )
}
