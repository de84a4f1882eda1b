//! Named threads.

use std::thread::{Builder, JoinHandle};

use crate::failure::{Failure, Kind};

/// Starts the thread `name`; `owner` is what it is for.
///
/// # Errors
/// [`Kind::NoDevice`] if the system has no more threads.
pub fn spawn<T: Send + 'static>(
    name: &str,
    owner: &str,
    run: impl FnOnce() -> T + Send + 'static,
) -> Result<JoinHandle<T>, Failure> {
    let thread = Builder::new().name(name.to_owned()).spawn(run);
    thread.map_err(|error| no_resource("thread", owner, &error))
}

/// The failure of a system that has no more threads or runtimes (`what`) for `owner`.
#[must_use]
pub fn no_resource(what: &str, owner: &str, error: &std::io::Error) -> Failure {
    Failure::new(Kind::NoDevice, format!("no {what} for {owner}: {error}"))
        .help("end other programs; see ulimit -u")
}
