//! `velomotion firmware-sim`: the software EPOS2 alone, for whoever develops a client against it.

use std::io::{IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use firmware_sim::epos2::{CanServer, Rs232Server, SlcanServer, UsbServer};
use io::can::SocketCan;
use io::port::Pty;

use super::CommandOutput;
use crate::cli::{self, Common};
use crate::signals;
use engine::config;
use engine::devices::profile as devices;
use engine::devices::simulated;
use engine::devices::simulated_drive::{self as software_drive, Interface};
use engine::failure::{Failure, Kind};

/// Runs the command: the first line on stdout is the port; it ends at SIGTERM, Ctrl-C, or when a stdin that is no terminal closes.
///
/// # Errors
/// Where the machine gives no pseudo-terminal or has no such CAN interface, or the link cannot be made.
pub fn run(arguments: &cli::FirmwareSim, common: &Common) -> Result<CommandOutput, Failure> {
    let config = config::load(common.config.as_deref())?;
    let axis = devices::axis(&config.axis)?;
    let stop = signals::interrupt_flag()?;
    until_stdin_closes(&stop)?;
    let (interface, link) = match &arguments.can {
        Some(name) => {
            let bus = SocketCan::open(name).map_err(|error| failed(&error))?;
            announce(Path::new(name))?;
            (Interface::Can(CanServer::new(), bus), None)
        }
        None => on_terminal(arguments)?,
    };
    let ended = software_drive::run(simulated::node(&axis), interface, &stop);
    drop(link);
    ended.map_err(|error| failed(&error))?;
    Ok(CommandOutput::nothing())
}

/// One of the interfaces that are a pseudo-terminal, with the link to it.
fn on_terminal(arguments: &cli::FirmwareSim) -> Result<(Interface, Option<Link>), Failure> {
    let pty = Pty::open().map_err(|error| failed(&error))?;
    let link = arguments
        .link
        .as_deref()
        .map(|link| Link::make(link, pty.path()))
        .transpose()?;
    announce(pty.path())?;
    let interface = if arguments.rs232 {
        Interface::Rs232(Rs232Server::new(1), pty)
    } else if arguments.slcan {
        Interface::Slcan(SlcanServer::new(), pty)
    } else {
        Interface::Usb(UsbServer::new(1), pty)
    };
    Ok((interface, link))
}

fn failed(error: &dyn std::fmt::Display) -> Failure {
    Failure::new(Kind::NoDevice, error.to_string())
        .help("velomotion doctor lists the CAN interfaces; pseudo-terminals come from /dev/ptmx")
}

fn announce(port: &Path) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    writeln!(stdout, "{}", port.display())
        .and_then(|()| stdout.flush())
        .map_err(|error| {
            Failure::new(
                Kind::Usage,
                format!("cannot say the port on stdout: {error}"),
            )
            .help("the first line on stdout is the port: read it")
        })
}

/// Sets `stop` when stdin comes to its end. A terminal is left alone: a shell stops what reads from it in the background.
fn until_stdin_closes(stop: &Arc<AtomicBool>) -> Result<(), Failure> {
    if std::io::stdin().is_terminal() {
        return Ok(());
    }
    let stop = Arc::clone(stop);
    std::thread::Builder::new()
        .name("stdin".to_owned())
        .spawn(move || {
            let mut buffer = [0; 256];
            while matches!(std::io::stdin().read(&mut buffer), Ok(count) if count > 0) {}
            stop.store(true, Ordering::Relaxed);
        })
        .map(drop)
        .map_err(|error| {
            Failure::new(Kind::NoDevice, format!("no thread for stdin: {error}"))
                .help("see how many processes and threads this user may have (ulimit -u)")
        })
}

/// A symbolic link to the port that goes when the drive does.
struct Link(PathBuf);

impl Link {
    fn make(link: &Path, port: &Path) -> Result<Self, Failure> {
        // A link that an earlier run left is replaced; anything else of that name is not ours.
        if link.is_symlink() {
            let _ = std::fs::remove_file(link);
        }
        std::os::unix::fs::symlink(port, link).map_err(|error| {
            Failure::new(
                Kind::Usage,
                format!("cannot make the link {}: {error}", link.display()),
            )
            .help("name a link in a folder that exists, where no file of that name is")
        })?;
        Ok(Self(link.to_owned()))
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}
