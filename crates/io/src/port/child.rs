//! A child process that shares an open port: it can use the port after the death of its parent.
//!
//! The lock on the port belongs to the open port, not to a process. Other programs find the port in
//! use until the child has ended, too.

use std::ffi::{CString, OsStr};
use std::io;
use std::os::fd::{AsFd, AsRawFd, OwnedFd};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::spawn::{PosixSpawnAttr, PosixSpawnFileActions, PosixSpawnFlags, posix_spawn};
use nix::sys::signal::{SigSet, Signal, kill};
use nix::sys::wait::{WaitPidFlag, WaitStatus, waitpid};
use nix::unistd::Pid;

use super::descriptor::DescriptorPort;
use super::serial::SerialPort;

/// Signals of a terminal and of service managers that the child ignores.
const BLOCKED: [Signal; 9] = [
    // systemd's watchdog sends it to every process of a service.
    Signal::SIGABRT,
    Signal::SIGINT,
    Signal::SIGTERM,
    Signal::SIGHUP,
    Signal::SIGQUIT,
    Signal::SIGTSTP,
    Signal::SIGTTIN,
    Signal::SIGTTOU,
    Signal::SIGPIPE,
];
/// Time that the child has to end after its socket was closed.
const END_TIMEOUT: Duration = Duration::from_secs(2);
const END_POLL: Duration = Duration::from_millis(1);

/// A child process, by its parent.
#[derive(Debug)]
pub struct PortChild {
    /// Socket to the child; the child sees its end if this process ends.
    pub socket: UnixStream,
    pid: Pid,
}

impl SerialPort {
    /// Starts `program` with one argument. Its standard input is a socket to this process, its
    /// standard output is the port. It runs in a process group of its own and ignores the signals
    /// of a terminal.
    ///
    /// # Errors
    /// The system's error.
    pub fn spawn_child(&self, program: &Path, argument: &str) -> io::Result<PortChild> {
        let (socket, theirs) = UnixStream::pair()?;
        let mut files = PosixSpawnFileActions::init()?;
        files.add_dup2(theirs.as_raw_fd(), 0)?;
        files.add_dup2(self.raw_fd(), 1)?;
        let mut attributes = PosixSpawnAttr::init()?;
        attributes.set_flags(
            PosixSpawnFlags::POSIX_SPAWN_SETPGROUP | PosixSpawnFlags::POSIX_SPAWN_SETSIGMASK,
        )?;
        attributes.set_pgroup(Pid::from_raw(0))?;
        attributes.set_sigmask(&SigSet::from_iter(BLOCKED))?;
        let text = |text: &OsStr| CString::new(text.as_bytes());
        let arguments = [text(program.as_os_str())?, text(OsStr::new(argument))?];
        let mut environment = Vec::new();
        for (key, value) in std::env::vars_os() {
            let mut entry = key;
            entry.push("=");
            entry.push(value);
            environment.push(text(&entry)?);
        }
        let pid = posix_spawn(program, &files, &attributes, &arguments, &environment)?;
        Ok(PortChild { socket, pid })
    }
}

impl PortChild {
    /// Process id.
    #[must_use]
    pub fn id(&self) -> i32 {
        self.pid.as_raw()
    }

    /// Ends the child whatever it does. Its id stays its own until this is dropped.
    pub fn kill(&self) {
        // One that has ended cannot be killed, and need not be.
        let _ = kill(self.pid, Signal::SIGKILL);
    }
}

impl Drop for PortChild {
    /// Waits for the end of the child: until then the port is in use.
    fn drop(&mut self) {
        let _ = self.socket.shutdown(std::net::Shutdown::Both);
        let deadline = Instant::now() + END_TIMEOUT;
        while matches!(
            waitpid(self.pid, Some(WaitPidFlag::WNOHANG)),
            Ok(WaitStatus::StillAlive) | Err(Errno::EINTR)
        ) && Instant::now() < deadline
        {
            std::thread::sleep(END_POLL);
        }
    }
}

/// Socket and port of a process that [`SerialPort::spawn_child`] has started.
///
/// # Errors
/// The standard input is no socket, or the standard output is no terminal.
pub fn shared_port() -> io::Result<(UnixStream, DescriptorPort)> {
    let own = |fd: std::os::fd::BorrowedFd<'_>| -> io::Result<OwnedFd> { fd.try_clone_to_owned() };
    let socket = UnixStream::from(own(io::stdin().as_fd())?);
    socket.peer_addr()?;
    let terminal = own(io::stdout().as_fd())?;
    let name = nix::unistd::ttyname(&terminal)?.display().to_string();
    Ok((socket, DescriptorPort::new(terminal, name)?))
}
