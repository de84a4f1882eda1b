//! Work outside Python's lock.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use pyo3::prelude::*;

use crate::binding_error::BindingError;

/// Interval of checks for Python's signals.
pub(crate) const LOOK_AGAIN: Duration = Duration::from_millis(20);

/// Time for `work` to end after a signal.
const END_LIMIT: Duration = Duration::from_secs(2);

/// Does `work` in a thread of its own, without Python's lock, until it ends or Python has a signal
/// such as Ctrl-C. Then its flag stops `work`, which is abandoned after [`END_LIMIT`]: some
/// measurements do not look at it. A panic is an exception of Python.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> Result<T, BindingError> + Send + 'static,
) -> PyResult<T> {
    let interrupt = Arc::new(AtomicBool::new(false));
    let (done, mut result) = mpsc::sync_channel(1);
    let flag = Arc::clone(&interrupt);
    let thread = engine::spawn("velomotion", "a call from Python", move || {
        drop(done.send(work(&flag)));
    });
    thread.map_err(|failure| BindingError::from(failure).into_py(py))?;
    loop {
        let waited = py.detach(move || {
            let waited = result.recv_timeout(LOOK_AGAIN);
            (waited, result)
        });
        result = waited.1;
        match waited.0 {
            Ok(result) => return result.map_err(|error| error.into_py(py)),
            Err(RecvTimeoutError::Disconnected) => return Err(BindingError::internal().into_py(py)),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(signal) = py.check_signals() {
                    interrupt.store(true, Ordering::Relaxed);
                    // The thread may be writing its output.
                    drop(py.detach(move || result.recv_timeout(END_LIMIT)));
                    return Err(signal);
                }
            }
        }
    }
}
