//! Messages and progress bars on stderr.

use std::io::{IsTerminal, Write};
use std::time::Duration;

use drive::MovePlan;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use units::{Degrees, Host, Stamp};

use crate::cli::Common;

/// Output to the terminal.
pub struct Progress {
    quiet: bool,
    terminal: bool,
    sweep: Option<MoveBar>,
    run: Option<ProgressBar>,
}

/// A move in progress.
struct MoveBar {
    bar: ProgressBar,
    plan: MovePlan,
    started: Option<Stamp<Host>>,
}

const MILLISECONDS: i64 = 1_000_000;

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
            match &self.sweep {
                Some(sweep) if self.terminal => sweep.bar.suspend(|| to_stderr(line)),
                _ => to_stderr(line),
            }
        }
    }

    /// Starts the bar of a move.
    pub fn begin_move(&mut self, plan: &MovePlan) {
        self.end_move();
        let length = plan.duration.as_nanos() / MILLISECONDS;
        self.sweep = self
            .bar(length.unsigned_abs(), "{bar:40} {msg}")
            .map(|bar| MoveBar {
                bar,
                plan: *plan,
                started: None,
            });
    }

    /// A bar, if there is a terminal to draw it on.
    fn bar(&self, length: u64, template: &str) -> Option<ProgressBar> {
        if self.quiet || !self.terminal {
            return None;
        }
        let target = ProgressDrawTarget::stderr_with_hz(20);
        let bar = ProgressBar::with_draw_target(Some(length.max(1)), target);
        match ProgressStyle::with_template(template) {
            Ok(style) => Some(bar.with_style(style)),
            Err(_) => Some(bar),
        }
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
        sweep
            .bar
            .set_position((passed.as_nanos() / MILLISECONDS).unsigned_abs());
        sweep.bar.set_message(format!(
            "{:8.3} deg, {packets} packets, {:.1} s left",
            angle.0,
            left.as_secs_f64()
        ));
    }

    /// Starts the bar of a simulation of `seconds`.
    pub fn begin_run(&mut self, seconds: f64) {
        self.end_run();
        self.run = self.bar((seconds * 1e3) as u64, "{bar:40} {msg}, {eta} left");
    }

    /// Updates the bar of a simulation.
    pub fn ran(&mut self, seconds: f64) {
        if let Some(bar) = &self.run {
            let milliseconds = (seconds * 1e3) as u64;
            if milliseconds > bar.position() {
                bar.set_position(milliseconds);
                bar.set_message(format!("{seconds:.1} s simulated"));
            }
        }
    }

    /// Starts the bar of `count` items.
    pub fn begin_count(&mut self, count: u64) {
        self.end_run();
        self.run = self.bar(count, "{bar:40} {pos} of {len}, {eta} left");
    }

    /// Updates the bar of items.
    pub fn counted(&mut self, done: u64) {
        match &self.run {
            Some(bar) => bar.set_position(done),
            // Without a bar, prints a line now and then.
            None if done.is_multiple_of(16) => self.say(&format!("{done} done")),
            None => {}
        }
    }

    /// Removes the bar of a simulation or of items.
    pub fn end_run(&mut self) {
        if let Some(bar) = self.run.take() {
            bar.finish_and_clear();
        }
    }

    /// Removes the bar of a move.
    pub fn end_move(&mut self) {
        if let Some(sweep) = self.sweep.take() {
            sweep.bar.finish_and_clear();
        }
    }
}

/// Prints a line to stderr. A closed stderr must not lose a scan; `eprintln!` would panic.
pub fn to_stderr(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.end_run();
        self.end_move();
    }
}
