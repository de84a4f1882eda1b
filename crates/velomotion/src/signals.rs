//! Termination signals as a flag.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};

use engine::failure::{Failure, Kind};

/// Returns a flag that SIGINT, SIGTERM, SIGQUIT and SIGHUP set. No signal ends the process
/// directly: the axis is stopped first, and every wait has a limit.
///
/// # Errors
/// The system refuses a signal handler.
pub fn interrupt_flag() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGQUIT, SIGHUP] {
        signal_hook::flag::register(signal, Arc::clone(&flag)).map_err(|error| {
            Failure::new(Kind::NoDevice, format!("cannot watch for Ctrl-C: {error}"))
                .help("the motor could not be stopped without it; run where signals can be handled")
        })?;
    }
    Ok(flag)
}
