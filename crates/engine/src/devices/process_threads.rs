//! Tells a process that the machine delays from one that is stopped or stuck, by its threads.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Id of the calling thread; 0 if the system does not tell.
pub(super) fn own_id() -> u32 {
    let thread = std::fs::read_link("/proc/thread-self").unwrap_or_default();
    let id = thread.file_name().and_then(|id| id.to_str()?.parse().ok());
    id.unwrap_or(0)
}

/// The threads of a process (proc(5)).
pub(super) struct ProcessThreads {
    folder: PathBuf,
    /// The thread that drives the axis.
    pub drive_loop: Option<u32>,
    /// Time that each thread had run at the latest look.
    run_times: HashMap<u32, Duration>,
}

impl ProcessThreads {
    pub fn of(process: u32) -> Self {
        Self {
            folder: format!("/proc/{process}/task").into(),
            drive_loop: None,
            run_times: HashMap::new(),
        }
    }

    /// Whether the machine delayed the process since the latest look, `elapsed` ago: its drive loop
    /// waits for the system (D), or a thread, the loop or one that it may wait for, waits for a
    /// processor. A thread that runs in an endless loop does not wait. The threads of a stopped
    /// program are in the state T, those of a stuck one sleep (S).
    pub fn is_delayed(&mut self, elapsed: Duration) -> bool {
        let Ok(threads) = std::fs::read_dir(&self.folder) else {
            return false;
        };
        let mut is_delayed = false;
        for thread in threads.flatten() {
            let Some(id) = thread.file_name().to_str().and_then(|id| id.parse().ok()) else {
                continue;
            };
            is_delayed |= match state(&thread.path()) {
                Some(b'D') => self.drive_loop == Some(id),
                Some(b'R') => !self.ran(id, &thread.path(), elapsed),
                _ => false,
            };
        }
        is_delayed
    }

    /// Whether a thread ran for half of this time since the latest look. A system without
    /// `schedstat` does not tell.
    fn ran(&mut self, id: u32, thread: &Path, elapsed: Duration) -> bool {
        let Some(run_time) = run_time(thread) else {
            return false;
        };
        let previous = self.run_times.insert(id, run_time);
        previous.is_some_and(|previous| run_time.saturating_sub(previous) * 2 > elapsed)
    }
}

/// The state follows the name in parentheses, which may contain any character.
fn state(thread: &Path) -> Option<u8> {
    let stat = std::fs::read(thread.join("stat")).ok()?;
    let name_end = stat.iter().rposition(|&byte| byte == b')')?;
    stat.get(name_end + 2).copied()
}

/// Time on a processor: the first field of `schedstat`, nanoseconds.
fn run_time(thread: &Path) -> Option<Duration> {
    let schedstat = std::fs::read_to_string(thread.join("schedstat")).ok()?;
    let nanoseconds = schedstat.split_whitespace().next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}

#[cfg(test)]
mod tests {
    use std::process::{Command, Stdio};

    use super::*;

    #[test]
    fn the_name_of_a_thread_does_not_hide_its_state() {
        let thread = std::thread::Builder::new().name(") S (".to_owned());
        let own_state = || state(Path::new("/proc/thread-self"));
        assert_eq!(thread.spawn(own_state).unwrap().join().unwrap(), Some(b'R'));
    }

    #[test]
    fn a_sleeping_program_is_not_delayed() {
        let mut stuck = Command::new("cat");
        let mut stuck = stuck.stdin(Stdio::piped()).spawn().unwrap();
        let mut threads = ProcessThreads::of(stuck.id());
        // It starts first.
        while threads.is_delayed(Duration::MAX / 4) {
            std::thread::yield_now();
        }
        drop(stuck.stdin.take());
        stuck.wait().unwrap();
        // A process that has ended.
        assert!(!threads.is_delayed(Duration::from_millis(20)));
    }

    /// This thread's own state is R whenever it looks; only its run time differs.
    #[test]
    fn a_thread_that_runs_is_not_delayed_and_one_that_waits_is() {
        let mut threads = ProcessThreads::of(std::process::id());
        let own = own_id();
        let folder = threads.folder.join(own.to_string());
        threads.ran(own, &folder, Duration::ZERO);
        let began = run_time(&folder).unwrap();
        // A slice of this thread's own time, however long the machine takes for it.
        while run_time(&folder).unwrap() - began < Duration::from_millis(20) {
            std::hint::spin_loop();
        }
        assert!(threads.ran(own, &folder, Duration::from_millis(20)));
        assert!(!threads.ran(own, &folder, Duration::from_secs(20)));
    }
}
