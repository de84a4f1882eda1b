//! Tells a process that the machine delays from one that is stopped or stuck, by the states of its
//! threads.

use std::path::{Path, PathBuf};

/// The threads of a process (proc(5)).
pub(super) struct ProcessThreads {
    folder: PathBuf,
}

impl ProcessThreads {
    pub fn of(process: u32) -> Self {
        Self {
            folder: format!("/proc/{process}/task").into(),
        }
    }

    /// Whether a thread, the drive loop or one that it waits for, runs or waits for a processor
    /// (R), or for the system (D): on a loaded machine poll(2) of a terminal waits for the
    /// kernel's own threads, for 0.7 s as measured. All threads of a stopped program are in the
    /// state T, those of a stuck one sleep (S).
    pub fn is_any_delayed(&self) -> bool {
        std::fs::read_dir(&self.folder).is_ok_and(|mut threads| {
            threads.any(|thread| thread.is_ok_and(|thread| is_delayed(&thread.path())))
        })
    }
}

/// The state follows the name in parentheses, which may contain any character.
fn is_delayed(thread: &Path) -> bool {
    std::fs::read(thread.join("stat")).is_ok_and(|stat| {
        let name_end = stat.iter().rposition(|&byte| byte == b')');
        name_end.is_some_and(|end| matches!(stat.get(end + 2), Some(b'R' | b'D')))
    })
}

#[cfg(test)]
mod tests {
    use std::process::{Command, Stdio};

    use super::*;

    #[test]
    fn an_overloaded_machine_differs_from_a_stuck_program() {
        // A running thread is in the state of one that waits for a processor.
        let this = ProcessThreads::of(std::process::id());
        assert!(this.is_any_delayed());

        let mut stuck = Command::new("cat");
        let mut stuck = stuck.stdin(Stdio::piped()).spawn().unwrap();
        let threads = ProcessThreads::of(stuck.id());
        while threads.is_any_delayed() {
            std::thread::yield_now();
        }
        drop(stuck.stdin.take());
        stuck.wait().unwrap();
        // A process that has ended.
        assert!(!threads.is_any_delayed());
    }

    #[test]
    fn the_name_of_a_thread_does_not_hide_its_state() {
        let thread = std::thread::Builder::new().name(") S (".to_owned());
        let is_found = || is_delayed(Path::new("/proc/thread-self"));
        assert!(thread.spawn(is_found).unwrap().join().unwrap());
    }
}
