//! Keeps the machine awake while the axis moves.
//!
//! logind's inhibitor is held by a child process, `systemd-inhibit`, until its standard input
//! closes, which happens also when this process dies. Without systemd or the right to inhibit, a
//! closed lid suspends the machine.

use std::process::{Child, Command, Stdio};

use crate::threads::spawn;

/// An inhibitor of sleep, held until dropped.
pub(super) struct SleepInhibitor(Option<Child>);

impl SleepInhibitor {
    /// Starts to inhibit sleep and the lid switch; `None` if the machine has no `systemd-inhibit`.
    pub fn take() -> Option<Self> {
        Command::new("systemd-inhibit")
            .args([
                "--what=sleep:handle-lid-switch",
                "--who=velomotion",
                "--why=the tilt axis moves",
                "--mode=block",
                "cat",
            ])
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .ok()
            .map(|child| Self(Some(child)))
    }
}

impl Drop for SleepInhibitor {
    /// Closes the standard input. A thread waits for the end, which a busy bus may delay.
    fn drop(&mut self) {
        if let Some(mut child) = self.0.take() {
            drop(child.stdin.take());
            let _ = spawn("sleep inhibitor", "the sleep inhibitor", move || {
                child.wait()
            });
        }
    }
}
