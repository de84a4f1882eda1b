//! `velomotion firmware-sim`: the simulated EPOS2 alone, to develop a client against it.

use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::AsFd;
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use drive::AxisConfig;
use firmware_sim::epos2::{AxisLoad, HoldingBrake, SimulatedDriveConfig};
use io::can::SocketCan;
use io::port::Pty;
use sim::Attachment;
use units::DegPerS2;

use super::CommandOutput;
use crate::cli::{self, Common};
use crate::documents::SimulatedDriveReady;
use crate::signals;
use engine::config;
use engine::devices::profile as devices;
use engine::devices::simulated;
use engine::devices::simulated_drive::{self, SimulatedPort};
use engine::document::Document;
use engine::failure::{Failure, Kind};

/// Runs the command. The first line on stdout is the port. It ends at SIGTERM, Ctrl-C, or when
/// stdin closes if that is a pipe.
///
/// # Errors
/// No pseudo-terminal, no such CAN interface, or the link cannot be created.
pub fn run(arguments: &cli::FirmwareSim, common: &Common) -> Result<CommandOutput, Failure> {
    let config = config::load(common.config.as_deref())?;
    let axis = devices::axis(&config.axis)?;
    let stop = signals::interrupt_flag()?;
    until_stdin_closes(&stop)?;
    let (port, link) = match &arguments.can {
        Some(name) => {
            let bus = SocketCan::open(name).map_err(|error| failed(&error))?;
            announce(Path::new(name), common)?;
            (SimulatedPort::Can(bus), None)
        }
        None => on_terminal(arguments, common)?,
    };
    let attachment = match arguments {
        cli::FirmwareSim { can: Some(_), .. } => Attachment::Can,
        cli::FirmwareSim { rs232: true, .. } => Attachment::Rs232,
        cli::FirmwareSim { slcan: true, .. } => Attachment::Slcan,
        _ => Attachment::Usb,
    };
    let node = SimulatedDriveConfig {
        load: load(arguments, &axis),
        latches_position: arguments.latch,
        dither_qc: arguments.dither,
        ..simulated::node(&axis)
    };
    let ended = simulated_drive::run(node, attachment, port, &stop);
    drop(link);
    ended.map_err(|error| failed(&error))?;
    Ok(CommandOutput::default())
}

/// Gravity and friction on the unpowered axis.
fn load(arguments: &cli::FirmwareSim, axis: &AxisConfig) -> Option<AxisLoad> {
    let motor = |deg_s2: f64| axis.gearing.rpm_per_s(DegPerS2(deg_s2)).0;
    if arguments.gravity.is_none() && arguments.friction.is_none() && arguments.brake.is_none() {
        return None;
    }
    let gravity = arguments.gravity.unwrap_or_default();
    let magnitude = i32::try_from(motor(gravity)).unwrap_or(i32::MAX);
    Some(AxisLoad {
        gravity_rpm_s: if gravity < 0.0 { -magnitude } else { magnitude },
        friction_rpm_s: arguments.friction.map_or(0, motor),
        brake: arguments
            .brake
            .map(|(opening_ms, closing_ms)| HoldingBrake {
                opening_ms,
                closing_ms,
                holding_rpm_s: arguments.brake_holds.map_or(u32::MAX, motor),
            }),
    })
}

/// Opens a pseudo-terminal with its optional link.
fn on_terminal(
    arguments: &cli::FirmwareSim,
    common: &Common,
) -> Result<(SimulatedPort, Option<Link>), Failure> {
    let pty = Pty::open().map_err(|error| failed(&error))?;
    let link = arguments
        .link
        .as_deref()
        .map(|link| Link::make(link, pty.path()))
        .transpose()?;
    announce(pty.path(), common)?;
    Ok((SimulatedPort::Serial(pty), link))
}

fn failed(error: &dyn std::fmt::Display) -> Failure {
    Failure::new(Kind::NoDevice, error.to_string())
        .help("velomotion doctor lists the CAN interfaces; pseudo-terminals come from /dev/ptmx")
}

fn announce(port: &Path, common: &Common) -> Result<(), Failure> {
    let line = match common.json {
        true => {
            let port = port.to_owned();
            SimulatedDriveReady { port }.to_json().to_string()
        }
        false => port.display().to_string(),
    };
    let mut stdout = std::io::stdout().lock();
    writeln!(stdout, "{line}")
        .and_then(|()| stdout.flush())
        .map_err(|error| {
            Failure::new(
                Kind::Usage,
                format!("cannot write the port to stdout: {error}"),
            )
            .help("keep stdout open: its first line is the port")
        })
}

/// Sets `stop` when stdin ends, if another program holds its other end. A terminal is not read, as
/// a shell would stop the process in the background, and /dev/null has no other end.
fn until_stdin_closes(stop: &Arc<AtomicBool>) -> Result<(), Failure> {
    let stdin = std::io::stdin()
        .as_fd()
        .try_clone_to_owned()
        .map(File::from);
    let kind = stdin.and_then(|file| file.metadata());
    if !kind.is_ok_and(|kind| kind.file_type().is_fifo() || kind.file_type().is_socket()) {
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
                .help("check the limit on processes and threads (ulimit -u)")
        })
}

/// A symbolic link to the port, removed on drop.
struct Link(PathBuf);

impl Link {
    fn make(link: &Path, port: &Path) -> Result<Self, Failure> {
        // A link that an earlier run left is replaced; any other file is not ours. The system may
        // have given this port the number of that run's.
        if let Ok(used) = link.canonicalize()
            && used != port
        {
            let (link, used) = (link.display(), used.display());
            return Err(
                Failure::new(Kind::Usage, format!("{link} exists already: {used}"))
                    .help("end the simulated drive that has it, or choose another name"),
            );
        }
        if link.is_symlink() {
            let _ = std::fs::remove_file(link);
        }
        std::os::unix::fs::symlink(port, link).map_err(|error| {
            Failure::new(
                Kind::Usage,
                format!("cannot create the link {}: {error}", link.display()),
            )
            .help("choose an unused name in an existing folder")
        })?;
        Ok(Self(link.to_owned()))
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    fn load_of(options: &str) -> Option<AxisLoad> {
        let line = format!("velomotion firmware-sim --usb {options}");
        let parsed = cli::Cli::parse_from(line.split_whitespace());
        let cli::Command::FirmwareSim(arguments) = parsed.command else {
            panic!("{line}")
        };
        load(&arguments, &AxisConfig::default())
    }

    /// A killed run leaves its link, and the system gives its port's number to the next run.
    #[test]
    fn a_link_to_the_own_port_is_an_earlier_runs() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().canonicalize().unwrap().join(name);
        let (port, other, link) = (path("port"), path("other"), path("link"));
        for file in [&port, &other] {
            std::fs::write(file, "").unwrap();
        }
        std::os::unix::fs::symlink(&port, &link).unwrap();
        assert!(Link::make(&link, &other).is_err());
        let made = Link::make(&link, &port).unwrap();
        assert_eq!(link.canonicalize().unwrap(), port);
        drop(made);
        assert!(!link.is_symlink());
    }

    /// The default gear has 0.05 deg/s per rpm.
    #[test]
    fn each_option_alone_loads_the_axis() {
        assert_eq!(load_of(""), None);
        let unloaded = AxisLoad::default();
        let gravity_rpm_s = -5_000;
        assert_eq!(
            load_of("--gravity -250"),
            Some(AxisLoad {
                gravity_rpm_s,
                ..unloaded
            })
        );
        let friction_rpm_s = 600;
        assert_eq!(
            load_of("--friction 30"),
            Some(AxisLoad {
                friction_rpm_s,
                ..unloaded
            })
        );
        let brake = Some(HoldingBrake {
            opening_ms: 20,
            closing_ms: 40,
            holding_rpm_s: u32::MAX,
        });
        assert_eq!(
            load_of("--brake 20,40"),
            Some(AxisLoad { brake, ..unloaded })
        );
    }
}
