//! The clock that measures the cost of effects.

use std::sync::OnceLock;
use std::time::Instant;

/// Nanoseconds since the first call.
#[must_use]
pub fn nanoseconds() -> u64 {
    static BEGINNING: OnceLock<Instant> = OnceLock::new();
    let since = BEGINNING.get_or_init(Instant::now).elapsed();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}
