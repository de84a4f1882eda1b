//! Messages and progress bars on stderr.
//!
//! A thread of its own writes to stderr. A terminal or pipe that no program reads blocks that
//! thread alone: the axis, the recording and signals do not wait for it. Its queue is bounded; what
//! does not fit is dropped.

use std::io::{IsTerminal, Write};
#[cfg(unix)]
use std::os::fd::AsFd as AsHandle;
#[cfg(windows)]
use std::os::windows::io::AsHandle;
use std::sync::LazyLock;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Duration;

use drive::MovePlan;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use units::{Degrees, Host, Stamp};

use crate::cli::Common;

/// Messages that may wait for stderr.
const QUEUE: usize = 1024;
/// Longest wait for stderr at the end of the program.
const FLUSH_TIMEOUT: Duration = Duration::from_secs(1);
const MILLISECONDS: i64 = 1_000_000;
/// Between two pictures of a bar without a length.
const TICK: Duration = Duration::from_millis(200);

/// The queue of the thread that writes to stderr.
static STDERR: LazyLock<SyncSender<StderrMessage>> = LazyLock::new(|| {
    let (sender, receiver) = sync_channel(QUEUE);
    // Without the thread the receiver is dropped and messages are lost, but no scan.
    let _ = std::thread::Builder::new()
        .name("stderr".to_owned())
        .spawn(move || write_messages(&receiver));
    sender
});

/// The thread's next action.
enum StderrMessage {
    /// Writes these bytes, above the bar if there is one.
    Text(Vec<u8>),
    /// Draws a new bar of a length with a template; one without a length ticks by itself.
    Begin(u64, &'static str),
    /// Moves the bar to a position; changes its message if there is a new one.
    Update(u64, Option<String>),
    /// Removes the bar.
    End,
    /// Answers once everything before is written.
    Flush(SyncSender<()>),
}

fn write_messages(messages: &Receiver<StderrMessage>) {
    let mut bar: Option<ProgressBar> = None;
    for message in messages {
        match (message, &bar) {
            (StderrMessage::Text(text), Some(bar)) => bar.suspend(|| write(&text)),
            (StderrMessage::Text(text), None) => write(&text),
            (StderrMessage::Begin(length, template), _) => {
                let target = ProgressDrawTarget::stderr_with_hz(20);
                let new = ProgressBar::with_draw_target(Some(length.max(1)), target);
                if length == 0 {
                    new.enable_steady_tick(TICK);
                }
                bar = Some(match ProgressStyle::with_template(template) {
                    Ok(style) => new.with_style(style),
                    Err(_) => new,
                });
            }
            (StderrMessage::Update(position, text), Some(bar)) => {
                bar.set_position(position);
                if let Some(text) = text {
                    bar.set_message(text);
                }
            }
            (StderrMessage::End, Some(old)) => {
                old.finish_and_clear();
                bar = None;
            }
            (StderrMessage::Update(..) | StderrMessage::End, None) => {}
            // The program may have stopped waiting.
            (StderrMessage::Flush(done), _) => drop(done.try_send(())),
        }
    }
}

/// A closed stderr must not lose a scan; `eprint!` would panic.
fn write(text: &[u8]) {
    let _ = std::io::stderr().write_all(text);
}

/// Queues bytes for stderr.
pub fn queue(text: Vec<u8>) {
    let _ = STDERR.try_send(StderrMessage::Text(text));
}

/// Queues a line for stderr.
pub fn to_stderr(line: &str) {
    queue(format!("{line}\n").into_bytes());
}

/// Waits until stderr has everything, or does not take it within a second.
pub fn flush() {
    let (done, is_done) = sync_channel(1);
    if STDERR.try_send(StderrMessage::Flush(done)).is_ok() {
        let _ = is_done.recv_timeout(FLUSH_TIMEOUT);
    }
}

/// Columns of a terminal; `None` for a pipe or a file.
#[must_use]
pub fn width_of(output: impl AsHandle) -> Option<usize> {
    terminal_size::terminal_size_of(output).map(|(width, _)| width.0.into())
}

/// A line after `label`, wrapped at a width if there is one, with an indentation from the second
/// line. A line that begins with a space is a command for the user and stays whole.
#[must_use]
pub fn wrapped(line: &str, width: Option<usize>, label: &str, indentation: &str) -> String {
    let Some(width) = width.filter(|_| !line.starts_with(' ')) else {
        return format!("{label}{line}");
    };
    // Breaks at spaces only, since messages contain paths and units.
    let options = textwrap::Options::new(width)
        .word_separator(textwrap::WordSeparator::AsciiSpace)
        .word_splitter(textwrap::WordSplitter::NoHyphenation)
        .break_words(false)
        .initial_indent(label)
        .subsequent_indent(indentation);
    textwrap::fill(line, options)
}

/// Progress on the terminal.
pub struct Progress {
    quiet: bool,
    terminal: bool,
    sweep: Option<MoveBar>,
    /// Position of the bar of a simulation or of items.
    run: Option<u64>,
}

/// A move in progress.
struct MoveBar {
    plan: MovePlan,
    started: Option<Stamp<Host>>,
}

impl Progress {
    /// Creates an output that is quiet with `--quiet` and draws bars only on a terminal.
    #[must_use]
    pub fn new(common: &Common) -> Self {
        Self {
            quiet: common.quiet,
            terminal: std::io::stderr().is_terminal(),
            sweep: None,
            run: None,
        }
    }

    /// Prints a line unless quiet.
    pub fn say(&self, line: &str) {
        if !self.quiet {
            to_stderr(line);
        }
    }

    /// Starts the bar of a move.
    pub fn begin_move(&mut self, plan: &MovePlan) {
        self.end_move();
        let length = plan.duration.as_nanos() / MILLISECONDS;
        if self.begin_bar(length.unsigned_abs(), "{bar:30} {msg}") {
            self.sweep = Some(MoveBar {
                plan: *plan,
                started: None,
            });
        }
    }

    /// Starts a bar if there is a terminal to draw it on; returns whether there is.
    fn begin_bar(&self, length: u64, template: &'static str) -> bool {
        let draws = !self.quiet && self.terminal;
        if draws {
            let _ = STDERR.try_send(StderrMessage::Begin(length, template));
        }
        draws
    }

    /// Updates the bar: the axis is at `angle` at `now`, and `packets` lidar packets were received.
    pub fn moved(&mut self, now: Stamp<Host>, angle: Degrees, packets: u64) {
        let Some(sweep) = &mut self.sweep else {
            return;
        };
        let started = *sweep.started.get_or_insert(now);
        let passed = now.saturating_since(started);
        let left = Duration::from_nanos(
            u64::try_from((sweep.plan.duration - passed).as_nanos()).unwrap_or(0),
        );
        let position = (passed.as_nanos() / MILLISECONDS).unsigned_abs();
        let text = format!(
            "{:8.3} deg, {packets} packets, {:.1} s left",
            angle.0,
            left.as_secs_f64()
        );
        let _ = STDERR.try_send(StderrMessage::Update(position, Some(text)));
    }

    /// Starts the bar of a simulation of `seconds`.
    pub fn begin_run(&mut self, seconds: f64) {
        self.end_run();
        let begun = self.begin_bar((seconds * 1e3) as u64, "{bar:40} {msg}, {eta} left");
        self.run = begun.then_some(0);
    }

    /// Shows that a comparison of effects runs, whose end is not known.
    pub fn begin_comparison(&mut self) {
        self.end_run();
        let begun = self.begin_bar(0, "{spinner} comparing effects, {elapsed}");
        self.run = begun.then_some(0);
    }

    /// Updates the bar of a simulation.
    pub fn ran(&mut self, seconds: f64) {
        let milliseconds = (seconds * 1e3) as u64;
        if let Some(position) = self.run.as_mut().filter(|at| **at < milliseconds) {
            *position = milliseconds;
            let text = format!("{seconds:.1} s simulated");
            let _ = STDERR.try_send(StderrMessage::Update(milliseconds, Some(text)));
        }
    }

    /// Starts the bar of `count` items.
    pub fn begin_count(&mut self, count: u64) {
        self.end_run();
        let begun = self.begin_bar(count, "{bar:40} {pos} of {len}, {eta} left");
        self.run = begun.then_some(0);
    }

    /// Updates the bar of items.
    pub fn counted(&mut self, done: u64) {
        match self.run {
            Some(_) => drop(STDERR.try_send(StderrMessage::Update(done, None))),
            // Without a bar, prints a line now and then.
            None if done.is_multiple_of(16) => self.say(&format!("{done} done")),
            None => {}
        }
    }

    /// Removes the bar of a simulation or of items.
    pub fn end_run(&mut self) {
        if self.run.take().is_some() {
            let _ = STDERR.try_send(StderrMessage::End);
        }
    }

    /// Removes the bar of a move.
    pub fn end_move(&mut self) {
        if self.sweep.take().is_some() {
            let _ = STDERR.try_send(StderrMessage::End);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.end_run();
        self.end_move();
    }
}
