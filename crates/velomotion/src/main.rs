//! Entry point: parses the command line, runs the command, prints its result or failure.

use std::io::Write;
use std::process::ExitCode;
use std::time::Duration;

use engine::document::{Document, ErrorReport};
use engine::failure::{Failure, Kind};
use serde_json::Value;
use velomotion::cli::Common;
#[cfg(devices)]
use velomotion::commands::guard_axis;
use velomotion::commands::{CommandOutput, help};
use velomotion::logging;
use velomotion::signals;
use velomotion::terminal::{flush, to_stderr};

/// Longest wait for a reader of the result after a signal.
const LAST_WORDS: Duration = Duration::from_secs(1);

fn main() -> ExitCode {
    let cli = match help::parse() {
        Ok(cli) => cli,
        Err(failure) => return refuse(&failure),
    };
    #[cfg(devices)]
    guard_axis::offer();
    // The default hook would block the device thread on a stderr that no program reads.
    std::panic::set_hook(Box::new(|panic| {
        let backtrace = std::backtrace::Backtrace::capture();
        to_stderr(&format!("{panic}\n{backtrace}"));
        // The process ends with the main thread, which would take unwritten lines with it.
        if std::thread::current().name() == Some("main") {
            flush();
        }
    }));
    start_log(&cli.common);
    let (output, failure) = match velomotion::run(&cli) {
        Ok(mut output) => {
            let failure = output.failure.take();
            (Some(output), failure)
        }
        Err(failure) => (None, Some(failure)),
    };
    signals::end_process_on_signal();
    // Messages come before the result.
    flush();
    let printed = print(&cli.common, output, failure.as_ref());
    let failure = failure.or_else(|| match printed {
        // A closed pipe is not a failure.
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Some(
            Failure::new(
                Kind::Incomplete,
                format!("cannot print the result: {error}"),
            )
            .help(
                "check the destination of stdout; what the command has written to files is saved",
            ),
        ),
        _ => None,
    });
    let code = match failure {
        None => ExitCode::SUCCESS,
        Some(failure) => {
            let code = failure.kind.exit_code();
            logging::failed(&failure);
            ExitCode::from(code)
        }
    };
    flush();
    code
}

/// Reports an invalid command line, as one JSON object too if it requests that.
fn refuse(failure: &Failure) -> ExitCode {
    let mut words = std::env::args_os().take_while(|word| word != "--");
    if words.any(|word| word == "--json") {
        // A closed pipe is not a failure.
        let object = error_report(failure).to_json();
        let _ = writeln!(std::io::stdout(), "{object}");
    }
    logging::failed(failure);
    flush();
    ExitCode::from(failure.kind.exit_code())
}

/// Prints one object with `--json`, also for a failure; else the text. `--quiet` keeps results
/// only. A cloud on stdout moves the text to stderr.
fn print(
    common: &Common,
    output: Option<CommandOutput>,
    failure: Option<&Failure>,
) -> std::io::Result<()> {
    let stdout_taken = output.as_ref().is_some_and(|output| output.stdout_taken);
    let line = match (common.json, output) {
        (_, Some(output)) if output.json.is_null() => return Ok(()),
        (true, output) => {
            let object = match (output, failure) {
                (Some(output), None) => output.json,
                (Some(CommandOutput { mut json, .. }), Some(failure)) => {
                    if let Some(object) = json.as_object_mut() {
                        object.insert("error".to_owned(), serde_json::json!(failure));
                    }
                    json
                }
                (None, Some(failure)) => error_report(failure).to_json(),
                (None, None) => return Ok(()),
            };
            match object {
                Value::Array(objects) => {
                    let lines: Vec<String> = objects.iter().map(Value::to_string).collect();
                    lines.join("\n")
                }
                object => object.to_string(),
            }
        }
        (false, Some(output)) if output.text.is_empty() => return Ok(()),
        (false, Some(output)) if output.is_result || !common.quiet => output.text,
        (false, _) => return Ok(()),
    };
    if stdout_taken {
        to_stderr(&line);
        return Ok(());
    }
    let (done, printed) = std::sync::mpsc::sync_channel(1);
    std::thread::spawn(move || {
        let mut stdout = std::io::stdout().lock();
        let result = writeln!(stdout, "{line}").and_then(|()| stdout.flush());
        // The program may have stopped waiting.
        let _ = done.send(result);
    });
    let gone = || std::io::ErrorKind::BrokenPipe.into();
    // After a signal the process ends even if no program reads its result.
    let is_stopped = failure.is_some_and(|failure| failure.kind == Kind::Interrupted);
    match is_stopped || signals::has_come() {
        true => printed.recv_timeout(LAST_WORDS).unwrap_or(Ok(())),
        false => printed.recv().unwrap_or_else(|_| Err(gone())),
    }
}

fn error_report(failure: &Failure) -> ErrorReport {
    ErrorReport {
        error: failure.clone(),
    }
}

fn start_log(common: &Common) {
    logging::start(match (common.quiet, common.verbose) {
        (true, _) => "error",
        // The daemon reports an absent router itself.
        (false, 0) => "warn,zenoh=error",
        (false, 1) => "info,zenoh=error",
        (false, _) => "debug,zenoh=info",
    });
}
