//! Waiting for a file descriptor with a timeout in nanoseconds (`poll` has milliseconds).

use std::os::fd::BorrowedFd;
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, ppoll};
use nix::sys::time::TimeSpec;
use units::Span;

/// The duration of a span; zero for a negative one.
pub(crate) fn duration(span: Span) -> Duration {
    Duration::from_nanos(u64::try_from(span.as_nanos()).unwrap_or(0))
}

/// Waits for one of `events` or a hang-up, up to `timeout`; returns what happened.
pub(crate) fn wait(
    fd: BorrowedFd<'_>,
    events: PollFlags,
    timeout: Duration,
) -> nix::Result<PollFlags> {
    let deadline = Instant::now().checked_add(timeout);
    loop {
        let left = deadline.map(|deadline| {
            TimeSpec::from_duration(deadline.saturating_duration_since(Instant::now()))
        });
        let mut fds = [PollFd::new(fd, events)];
        match ppoll(&mut fds, left, None) {
            Err(Errno::EINTR) => {}
            Err(e) => return Err(e),
            Ok(0) => return Ok(PollFlags::empty()),
            Ok(_) => {
                let [fd] = fds;
                return Ok(fd.revents().unwrap_or(PollFlags::POLLERR));
            }
        }
    }
}
