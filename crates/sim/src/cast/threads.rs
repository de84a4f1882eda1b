//! The threads that share the work.
//!
//! They are started once and kept. Results do not depend on their number.

use std::num::NonZeroUsize;
use std::sync::Arc;

use rayon::ThreadPool;
use thiserror::Error;

/// Threads that rays are cast on.
#[derive(Clone, Debug, Default)]
pub struct Threads(Option<Arc<ThreadPool>>);

/// The system starts no more threads.
#[derive(Debug, Error)]
#[error("sim: expected {wanted} threads, the system says: {reason}")]
pub struct ThreadsError {
    /// The requested number.
    wanted: NonZeroUsize,
    /// The system's message.
    reason: String,
}

impl Threads {
    /// The caller's own thread and no other.
    pub const ONE: Self = Self(None);

    /// So many threads; one is the caller's own.
    ///
    /// # Errors
    /// [`ThreadsError`] if the system does not start them.
    pub fn new(count: NonZeroUsize) -> Result<Self, ThreadsError> {
        if count == NonZeroUsize::MIN {
            return Ok(Self::ONE);
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(count.get())
            .build();
        let pool = pool.map_err(|error| ThreadsError {
            wanted: count,
            reason: error.to_string(),
        })?;
        Ok(Self(Some(Arc::new(pool))))
    }

    /// A thread for every core that the process may use, or one if the system does not tell.
    ///
    /// # Errors
    /// [`ThreadsError`] if the system does not start them.
    pub fn all_cores() -> Result<Self, ThreadsError> {
        Self::new(std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN))
    }

    pub(super) fn pool(&self) -> Option<&ThreadPool> {
        self.0.as_deref()
    }
}
