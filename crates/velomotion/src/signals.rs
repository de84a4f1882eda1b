//! Ctrl-C and its kin, as a flag that the work looks at.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};

use engine::failure::{Failure, Kind};

/// A flag that becomes true at Ctrl-C, SIGTERM, SIGQUIT, or when the terminal goes away. There is no shorter way out: the axis is
/// stopped first, and every wait has its limit.
///
/// # Errors
/// Where the system does not let signals be watched.
pub fn interrupt_flag() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGQUIT, SIGHUP] {
        signal_hook::flag::register(signal, Arc::clone(&flag)).map_err(|error| {
            Failure::new(Kind::NoDevice, format!("cannot watch for Ctrl-C: {error}"))
                .help("without it the motor could not be stopped; run where signals can be handled")
        })?;
    }
    Ok(flag)
}
