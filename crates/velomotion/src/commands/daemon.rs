//! `velomotion daemon`: runs until a signal.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use sd_notify::NotifyState;

use super::CommandOutput;
use super::device_backend::thread_gone;
use super::guard_axis::environment;
use crate::cli::{self, Common};
use crate::documents::DaemonReport;
use crate::signals;
use crate::terminal::to_stderr;
use daemon::{Daemon, Options};
use engine::config;
use engine::document::Document;
use engine::failure::Failure;

/// Between two polls of signals.
const SIGNAL_POLL: Duration = Duration::from_millis(100);

/// Runs the command.
///
/// # Errors
/// [`Failure`] where it cannot start, or its devices' thread is gone.
pub fn run(arguments: &cli::DaemonArguments, common: &Common) -> Result<CommandOutput, Failure> {
    let interrupt = signals::motion_interrupt_flag()?;
    let daemon = Daemon::start(Options {
        config: load(common)?,
        device: arguments.device.name.clone(),
        listen: arguments.listen,
        commit: cli::commit(),
        environment: environment(),
        ..Options::default()
    })?;
    greet(&daemon, common);
    // Without a service manager this does nothing.
    let _ = sd_notify::notify(&[NotifyState::Ready, NotifyState::Status(&url(&daemon))]);
    while !interrupt.load(Ordering::Acquire) && !daemon.is_broken() {
        std::thread::sleep(SIGNAL_POLL);
    }
    let broken = daemon.is_broken();
    let _ = sd_notify::notify(&[
        NotifyState::Stopping,
        NotifyState::Status("stops the axis and saves the scan"),
    ]);
    end(daemon, &interrupt)?;
    if broken {
        return Err(thread_gone());
    }
    Ok(CommandOutput::default())
}

/// Ends the daemon. A second signal ends the wait for clouds.
fn end(daemon: Daemon, interrupt: &Arc<AtomicBool>) -> Result<(), Failure> {
    interrupt.store(false, Ordering::Release);
    daemon.stop(|| interrupt.load(Ordering::Acquire))
}

/// Address of the page.
fn url(daemon: &Daemon) -> String {
    let scheme = match daemon.state().settings().certificate {
        Some(_) => "https",
        None => "http",
    };
    format!("{scheme}://{}/", daemon.address())
}

fn greet(daemon: &Daemon, common: &Common) {
    let state = daemon.state();
    let address = daemon.address();
    let folder = state.scans.folder().display();
    if common.json {
        let report = DaemonReport {
            address: address.to_string(),
            url: url(daemon),
            scans: folder.to_string(),
            simulated: state.service.simulated(),
        };
        let object = report.to_json();
        // Programs that start a daemon wait for this line.
        let mut out = std::io::stdout().lock();
        let _ = std::io::Write::write_all(&mut out, format!("{object}\n").as_bytes());
        let _ = std::io::Write::flush(&mut out);
        return;
    }
    if common.quiet {
        return;
    }
    if state.service.simulated() {
        to_stderr("SIMULATED: simulated devices in a generated hall, not a real scan");
    }
    let who = match (address.ip().is_loopback(), &state.settings().token) {
        (true, None) => "only from this machine",
        (true, Some(_)) => "only from this machine, with the token",
        (false, _) => "with the token",
    };
    to_stderr(&format!("{} ({who}); scans in {folder}", url(daemon)));
}

/// The configuration; warns if others can read a token in it.
fn load(common: &Common) -> Result<config::Config, Failure> {
    let config = config::load(common.config.as_deref())?;
    let path = common.config.clone().or_else(config::usual_place);
    if let Some(path) = path.filter(|_| config.daemon.token.is_some()) {
        config::daemon::warn_if_exposed("token", &path);
    }
    Ok(config)
}
