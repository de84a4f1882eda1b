//! `velomotion info`: what a log or recording holds.

use std::path::Path;

use engine::failure::{Failure, Kind};
use engine::reconstruct::contents::read_contents;
use engine::reconstruct::source::Source;
use lidar::Options;

use super::CommandOutput;
use crate::{cli, tables};

/// Runs the command.
///
/// # Errors
/// [`Kind::BadInput`] for a file that is not a recording.
pub fn run(arguments: &cli::Info) -> Result<CommandOutput, Failure> {
    CommandOutput::of_each(&arguments.files, |file| info(arguments, file))
}

fn info(arguments: &cli::Info, file: &Path) -> Result<CommandOutput, Failure> {
    let source = Source::open(file, None)?;
    let options = Options {
        model: arguments.model,
        ..Options::default()
    };
    let report = read_contents(&source, options)?;
    let failure = report.contents.truncated.as_ref().map(|truncated| {
        Failure::new(
            Kind::Incomplete,
            format!("{} is incomplete: {truncated}", source.path().display()),
        )
        .help(match report.sweeps.is_empty() {
            true => "the report covers the existing part; velomotion replay --tilt none makes a cloud of it",
            false => "the report covers the existing part; velomotion replay makes a cloud of it",
        })
    });
    Ok(CommandOutput {
        failure,
        ..CommandOutput::result(&report, tables::info_table(&report))
    })
}
