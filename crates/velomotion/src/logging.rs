//! Logging to stderr: coloured on a terminal, plain lines in a file or pipe, and lines with a
//! priority prefix (`<4>`, sd-daemon(3)) in systemd's journal.

use std::io::{self, IsTerminal, Write};

use tracing::{Level, Metadata};
use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::MakeWriter;

use crate::terminal::{self, to_stderr, width_of, wrapped};
use engine::failure::Failure;

/// Priority of an error (syslog(3)).
const ERROR: u8 = 3;

/// Whether stderr is connected to the journal: `$JOURNAL_STREAM` holds its device and inode
/// (systemd.exec(5)). A child of a service inherits the variable even if its own stderr is
/// redirected.
#[cfg(target_os = "linux")]
#[must_use]
pub fn has_stderr() -> bool {
    use std::os::unix::fs::MetadataExt;
    let Ok(stream) = std::env::var("JOURNAL_STREAM") else {
        return false;
    };
    let own = std::fs::metadata("/proc/self/fd/2");
    own.is_ok_and(|own| stream == format!("{}:{}", own.dev(), own.ino()))
}

/// There is no journal.
#[cfg(not(target_os = "linux"))]
#[must_use]
pub const fn has_stderr() -> bool {
    false
}

/// Starts logging events of at least `level`, or those selected by `$RUST_LOG`.
pub fn start(level: &str) {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(level));
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        // A closed stderr must not cause a panic during a sweep.
        .log_internal_errors(false)
        .without_time()
        .with_target(false);
    if has_stderr() {
        // The priority replaces the level.
        log.with_ansi(false)
            .with_level(false)
            .with_writer(Journal)
            .init();
    } else {
        log.with_ansi(io::stderr().is_terminal())
            .with_writer(|| LogLine)
            .init();
    }
}

/// Prints a failure. In the journal, message and help are separate lines.
pub fn failed(failure: &Failure) {
    if has_stderr() {
        let help = failure.help.as_deref().unwrap_or_default();
        let text = with_priority(ERROR, &format!("{}\n{help}", failure.message));
        to_stderr(text.trim_end());
    } else {
        to_stderr(&text(failure, width_of(io::stderr())));
    }
}

/// A failure's message and help, wrapped at the width of a terminal if there is one.
fn text(failure: &Failure, width: Option<usize>) -> String {
    let help = failure.help.as_deref().unwrap_or_default();
    let first = [("error: ", failure.message.as_str())].into_iter();
    let helps = help.lines().enumerate();
    let helps = helps.map(|(n, line)| (if n == 0 { " help: " } else { "       " }, line));
    let lines = first
        .chain(helps)
        .map(|(label, line)| wrapped(line, width, label, "       "));
    lines.collect::<Vec<_>>().join("\n")
}

/// Every non-empty line with its priority prefix.
fn with_priority(priority: u8, text: &str) -> String {
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    lines.map(|line| format!("<{priority}>{line}\n")).collect()
}

/// Creates writers with an event's priority.
struct Journal;

/// Writer of one event.
struct JournalLine {
    priority: u8,
}

impl<'a> MakeWriter<'a> for Journal {
    type Writer = JournalLine;

    fn make_writer(&'a self) -> JournalLine {
        JournalLine { priority: ERROR }
    }

    fn make_writer_for(&'a self, about: &Metadata<'_>) -> JournalLine {
        let priority = match *about.level() {
            Level::ERROR => ERROR,
            Level::WARN => 4,
            Level::INFO => 6,
            _ => 7,
        };
        JournalLine { priority }
    }
}

impl Write for JournalLine {
    /// Receives an event in a single call.
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        let lines = with_priority(self.priority, &String::from_utf8_lossy(text));
        terminal::queue(lines.into_bytes());
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Writer of one event without a priority.
struct LogLine;

impl Write for LogLine {
    /// Receives an event in a single call.
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        terminal::queue(text.to_vec());
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_wrap_at_the_width_of_the_terminal_and_not_in_pipes() {
        let message = "the log hall.pcapng cannot be written: there is no room on the disk";
        let failure = Failure::new(engine::failure::Kind::Usage, message).help("free some\nspace");
        let plain = format!("error: {message}\n help: free some\n       space");
        assert_eq!(text(&failure, None), plain);
        assert_eq!(
            text(&failure, Some(30)),
            "error: the log hall.pcapng\n       cannot be written:\n       there is no room on the\n       disk\n help: free some\n       space"
        );
    }

    #[test]
    fn every_line_has_its_priority() {
        assert_eq!(with_priority(4, "one\n\ntwo\n"), "<4>one\n<4>two\n");
        assert_eq!(with_priority(3, "\n"), "");
    }
}
