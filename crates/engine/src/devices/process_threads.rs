//! Distinguishes a process that the machine delays from one that is stopped or stuck, by its
//! threads.

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
    /// Time that each thread had run at the latest call.
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

    /// Whether the machine delayed the process since the latest call, `elapsed` ago: its drive loop
    /// waits for the system (D), or a thread, the loop or one that it may wait for, waits for a
    /// processor. A thread that runs in an endless loop does not wait. The threads of a stopped
    /// program are in the state T, those of a stuck one sleep (S).
    pub fn is_delayed(&mut self, elapsed: Duration) -> bool {
        let Ok(threads) = std::fs::read_dir(&self.folder) else {
            return false;
        };
        let mut is_delayed = false;
        let mut run_times = HashMap::new();
        for thread in threads.flatten() {
            let Some(id) = thread.file_name().to_str().and_then(|id| id.parse().ok()) else {
                continue;
            };
            // A system without `schedstat` does not tell.
            let run_time = run_time(&thread.path());
            let ran = match (run_time, self.run_times.get(&id)) {
                (Some(now), Some(before)) => now.saturating_sub(*before) * 2 > elapsed,
                _ => false,
            };
            run_times.extend(run_time.map(|run_time| (id, run_time)));
            is_delayed |= match state(&thread.path()) {
                Some(b'D') => self.drive_loop == Some(id),
                Some(b'R') => !ran,
                _ => false,
            };
        }
        self.run_times = run_times;
        is_delayed
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
    use super::*;

    #[test]
    fn the_name_of_a_thread_does_not_hide_its_state() {
        let thread = std::thread::Builder::new().name(") S (".to_owned());
        let own_state = || state(Path::new("/proc/thread-self"));
        assert_eq!(thread.spawn(own_state).unwrap().join().unwrap(), Some(b'R'));
    }

    /// A process with these threads: id, state, nanoseconds on a processor.
    fn process(threads: &[(u32, char, u64)]) -> (tempfile::TempDir, ProcessThreads) {
        let folder = tempfile::tempdir().unwrap();
        let process = ProcessThreads {
            folder: folder.path().to_owned(),
            drive_loop: Some(1),
            run_times: HashMap::new(),
        };
        update(folder.path(), threads);
        (folder, process)
    }

    fn update(folder: &Path, threads: &[(u32, char, u64)]) {
        for (id, state, ran) in threads {
            let thread = folder.join(id.to_string());
            std::fs::create_dir_all(&thread).unwrap();
            std::fs::write(thread.join("stat"), format!("{id} (a name) {state} 1 1")).unwrap();
            std::fs::write(thread.join("schedstat"), format!("{ran} 0 0")).unwrap();
        }
    }

    const ELAPSED: Duration = Duration::from_millis(20);

    #[test]
    fn only_the_drive_loop_may_wait_for_the_system() {
        let (_folder, mut loop_waits) = process(&[(1, 'D', 0), (2, 'S', 0)]);
        assert!(loop_waits.is_delayed(ELAPSED));
        let (_folder, mut other_waits) = process(&[(1, 'S', 0), (2, 'D', 0)]);
        assert!(!other_waits.is_delayed(ELAPSED));
    }

    /// Stopped (T) and sleeping (S) threads, and one in an endless loop.
    #[test]
    fn a_stuck_program_is_not_delayed() {
        for state in ['T', 'S'] {
            let (_folder, mut stuck) = process(&[(1, state, 0), (2, 'S', 0)]);
            assert!(!stuck.is_delayed(ELAPSED), "{state}");
        }
        let (folder, mut stuck) = process(&[(1, 'S', 0), (2, 'R', 1_000_000)]);
        stuck.is_delayed(ELAPSED);
        update(folder.path(), &[(2, 'R', 19_000_000)]);
        assert!(!stuck.is_delayed(ELAPSED));
    }

    #[test]
    fn a_program_that_waits_for_a_processor_is_delayed() {
        let (folder, mut starved) = process(&[(1, 'S', 5_000_000)]);
        starved.is_delayed(ELAPSED);
        // It ran earlier, but hardly since.
        update(folder.path(), &[(1, 'R', 5_100_000)]);
        assert!(starved.is_delayed(ELAPSED));
    }

    #[test]
    fn the_threads_of_this_process_are_found() {
        let mut threads = ProcessThreads::of(std::process::id());
        threads.is_delayed(ELAPSED);
        assert!(threads.run_times.contains_key(&own_id()));
    }
}
