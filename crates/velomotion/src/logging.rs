//! What is said on stderr, for whoever keeps it: on a terminal with colours, in a file or a pipe as plain lines, and where systemd's
//! journal has it, each line with its priority in front (`<4>`, sd-daemon(3)), so that `journalctl -p warning` finds it.
//!
//! Left out: times and rotation, which are the journal's.

use std::io::{self, IsTerminal, Write};
use std::os::unix::fs::MetadataExt;

use tracing::{Level, Metadata};
use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::MakeWriter;

use crate::terminal::to_stderr;
use engine::failure::Failure;

/// Priority of an error, as syslog(3) numbers it.
const ERROR: u8 = 3;

/// Whether stderr is the journal's: `$JOURNAL_STREAM` says which device and inode that is (systemd.exec(5)). A program that was started by
/// a service and has its stderr elsewhere inherits the variable all the same.
#[must_use]
pub fn has_stderr() -> bool {
    let Ok(stream) = std::env::var("JOURNAL_STREAM") else {
        return false;
    };
    let own = std::fs::metadata("/proc/self/fd/2");
    own.is_ok_and(|own| stream == format!("{}:{}", own.dev(), own.ino()))
}

/// Starts the log, on stderr: what is at least as grave as `level`, or what `$RUST_LOG` asks for.
pub fn start(level: &str) {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(level));
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        // A closed stderr must not panic in mid-sweep.
        .log_internal_errors(false)
        .without_time()
        .with_target(false);
    if has_stderr() {
        // The priority is the level.
        log.with_ansi(false)
            .with_level(false)
            .with_writer(Journal)
            .init();
    } else {
        log.with_ansi(io::stderr().is_terminal())
            .with_writer(io::stderr)
            .init();
    }
}

/// Says how a command failed. In the journal the message and what to do are lines of their own.
pub fn failed(failure: Failure) {
    if has_stderr() {
        let help = failure.help.as_deref().unwrap_or_default();
        let text = with_priority(ERROR, &format!("{}\n{help}", failure.message));
        to_stderr(text.trim_end());
    } else {
        to_stderr(&format!("{:?}", miette::Report::new(Printed(failure))));
    }
}

/// A failure as miette prints it.
#[derive(Debug)]
struct Printed(Failure);

impl std::fmt::Display for Printed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

impl std::error::Error for Printed {}

impl miette::Diagnostic for Printed {
    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        let help = self.0.help.as_ref()?;
        Some(Box::new(help))
    }
}

/// Every line that is not empty, with the priority in front.
fn with_priority(priority: u8, text: &str) -> String {
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    lines.map(|line| format!("<{priority}>{line}\n")).collect()
}

/// Makes writers that put an event's priority in front.
struct Journal;

/// A writer of one event.
struct Event {
    priority: u8,
}

impl<'a> MakeWriter<'a> for Journal {
    type Writer = Event;

    fn make_writer(&'a self) -> Event {
        Event { priority: ERROR }
    }

    fn make_writer_for(&'a self, about: &Metadata<'_>) -> Event {
        let priority = match *about.level() {
            Level::ERROR => ERROR,
            Level::WARN => 4,
            Level::INFO => 6,
            _ => 7,
        };
        Event { priority }
    }
}

impl Write for Event {
    /// Takes an event at once, as the log gives it.
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        let lines = with_priority(self.priority, &String::from_utf8_lossy(text));
        io::stderr().write_all(lines.as_bytes())?;
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_has_its_priority() {
        assert_eq!(with_priority(4, "one\n\ntwo\n"), "<4>one\n<4>two\n");
        assert_eq!(with_priority(3, "\n"), "");
    }
}
