//! Termination signals as a flag.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

#[cfg(devices)]
use signal_hook::consts::SIGTSTP;
#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGQUIT};
use signal_hook::consts::{SIGINT, SIGTERM};

use engine::failure::{Failure, Kind};

/// Exit code after a signal.
const INTERRUPTED: i32 = 130;

/// Set once every device is closed.
static DEVICES_CLOSED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Set by every signal of a flag.
static SIGNALLED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Whether a signal has come, if only when the command had finished its work.
#[must_use]
pub fn has_come() -> bool {
    SIGNALLED.load(Ordering::Relaxed)
}

/// From here on a signal ends the process at once: nothing moves, and a result that no program
/// reads must not keep the process alive.
pub fn end_process_on_signal() {
    DEVICES_CLOSED.store(true, Ordering::Relaxed);
}

/// Returns a flag that SIGINT, SIGTERM, SIGQUIT and SIGHUP set. No signal ends the process
/// directly before [`end_process_on_signal`]: the axis is stopped first, and every wait has a
/// limit.
///
/// # Errors
/// The system refuses a signal handler.
pub fn interrupt_flag() -> Result<Arc<AtomicBool>, Failure> {
    #[cfg(unix)]
    let signals = [SIGINT, SIGTERM, SIGQUIT, SIGHUP];
    #[cfg(windows)]
    let signals = [SIGINT, SIGTERM];
    flag_of(&signals)
}

/// Like [`interrupt_flag`] for commands that can move the axis. Ctrl-Z (SIGTSTP) sets the flag,
/// too: a suspended process could not stop the axis.
///
/// # Errors
/// The system refuses a signal handler.
#[cfg(devices)]
pub fn motion_interrupt_flag() -> Result<Arc<AtomicBool>, Failure> {
    flag_of(&[SIGINT, SIGTERM, SIGQUIT, SIGHUP, SIGTSTP])
}

fn flag_of(signals: &[i32]) -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    for &signal in signals {
        let registered = signal_hook::flag::register_conditional_shutdown(
            signal,
            INTERRUPTED,
            Arc::clone(&DEVICES_CLOSED),
        )
        .and_then(|_| signal_hook::flag::register(signal, Arc::clone(&SIGNALLED)))
        .and_then(|_| signal_hook::flag::register(signal, Arc::clone(&flag)));
        registered.map_err(|error| {
            Failure::new(Kind::NoDevice, format!("cannot watch for Ctrl-C: {error}"))
                .help("the motor could not be stopped without it; run where signals can be handled")
        })?;
    }
    Ok(flag)
}
