//! How another process stops a capture: a Unix socket named after the drive's port.
//!
//! A serial port belongs to one process. The one that has it listens here; `tilt stop` connects, the capture stops the axis as at
//! Ctrl-C, and the answer says whether it did.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How long whoever asks for a stop waits for the word that the axis stands.
const STOP_WAIT: Duration = Duration::from_secs(10);
const REQUEST: &str = "stop";

/// The side that has the drive.
pub struct Control {
    path: PathBuf,
    waiting: Arc<Mutex<Vec<Sender<bool>>>>,
}

/// What came of asking.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Nobody has this drive.
    Nobody,
    /// The axis was stopped.
    Stopped,
    /// The process that has the drive could not stop the axis, or did not say in time.
    NotStopped,
}

impl Control {
    /// Listens for requests to stop the drive on `port`; sets `interrupt` at one. A machine that gives no socket has no control: the
    /// capture goes on without.
    #[must_use]
    pub fn listen(port: &Path, interrupt: &Arc<AtomicBool>) -> Option<Self> {
        let path = socket_path(port);
        // Whoever left it there no longer has the port, which is opened for one process alone.
        let _ = std::fs::remove_file(&path);
        let listener = UnixListener::bind(&path).ok()?;
        let waiting: Arc<Mutex<Vec<Sender<bool>>>> = Arc::default();
        let (theirs, flag) = (Arc::clone(&waiting), Arc::clone(interrupt));
        std::thread::Builder::new()
            .name("control".to_owned())
            .spawn(move || {
                for client in listener.incoming().flatten() {
                    let (told, result) = channel();
                    theirs
                        .lock()
                        .unwrap_or_else(PoisonError::into_inner)
                        .push(told);
                    let flag = Arc::clone(&flag);
                    std::thread::spawn(move || serve(client, &flag, &result));
                }
            })
            .ok()?;
        Some(Self { path, waiting })
    }

    /// Tells everyone who asked whether the axis stands.
    pub fn ended(self, stands: bool) {
        let waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        for told in waiting.iter() {
            // Whoever went away needs no answer.
            let _ = told.send(stands);
        }
        // The answers are a line each, written by threads that this process may not outlive.
        std::thread::sleep(Duration::from_millis(if waiting.is_empty() {
            0
        } else {
            50
        }));
    }
}

impl Drop for Control {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

fn serve(client: UnixStream, interrupt: &AtomicBool, result: &Receiver<bool>) {
    let mut line = String::new();
    let mut reader = BufReader::new(&client);
    if client.set_read_timeout(Some(STOP_WAIT)).is_err() || reader.read_line(&mut line).is_err() {
        return;
    }
    if line.trim() != REQUEST {
        return;
    }
    interrupt.store(true, Ordering::Relaxed);
    let stands = result.recv_timeout(STOP_WAIT).unwrap_or(false);
    let _ = writeln!(
        &client,
        "{}",
        if stands { "stopped" } else { "not stopped" }
    );
}

/// Asks the process that has the drive on `port`, if there is one, to stop the axis.
#[must_use]
pub fn ask_to_stop(port: &Path) -> Asked {
    let Ok(mut socket) = UnixStream::connect(socket_path(port)) else {
        return Asked::Nobody;
    };
    let mut answer = String::new();
    let asked = socket
        .set_read_timeout(Some(STOP_WAIT))
        .and_then(|()| writeln!(socket, "{REQUEST}"))
        .and_then(|()| BufReader::new(&socket).read_line(&mut answer));
    if asked.is_ok() && answer.trim() == "stopped" {
        Asked::Stopped
    } else {
        Asked::NotStopped
    }
}

/// Where the socket of a port is: in the user's runtime folder, else among temporary files.
fn socket_path(port: &Path) -> PathBuf {
    let port = port.canonicalize().unwrap_or_else(|_| port.to_owned());
    let name: String = port
        .to_string_lossy()
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    let folder = std::env::var_os("XDG_RUNTIME_DIR").map_or_else(std::env::temp_dir, PathBuf::from);
    folder.join(format!("velomotion{name}.sock"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_reaches_the_holder_and_its_word_comes_back() {
        for stands in [true, false] {
            let port = PathBuf::from(format!("/dev/test-{}-{stands}", std::process::id()));
            assert_eq!(ask_to_stop(&port), Asked::Nobody);
            let interrupt = Arc::new(AtomicBool::new(false));
            let control = Control::listen(&port, &interrupt).unwrap();
            let asking = {
                let port = port.clone();
                std::thread::spawn(move || ask_to_stop(&port))
            };
            while !interrupt.load(Ordering::Relaxed) {
                std::thread::yield_now();
            }
            control.ended(stands);
            let wanted = if stands {
                Asked::Stopped
            } else {
                Asked::NotStopped
            };
            assert_eq!(asking.join().unwrap(), wanted);
            assert_eq!(ask_to_stop(&port), Asked::Nobody);
        }
    }
}
