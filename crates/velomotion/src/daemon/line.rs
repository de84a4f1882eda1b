//! The drive's port from one order to the next.

use std::time::{Duration, Instant};

use io::port::PortError;
use protocol::record::DriveLink;
use units::Span;

use crate::ports::Opened;

/// A serial drive that has not sent anything for so long has nothing more to say: between orders, and after one that failed.
const QUIET: (Span, Span) = (Span::from_millis(10), Span::from_millis(500));
/// A port that is never quiet is not waited for longer than this.
const NEVER_QUIET: Duration = Duration::from_secs(2);
/// A drive's port that is kept open from one order to the next.
pub struct Line {
    /// The port.
    pub opened: Opened,
    /// Whether the last order failed: an answer to it may still be on its way.
    pub failed: bool,
}

impl Line {
    /// Takes what was answered to questions that nobody waits for any more. Answers on a serial line do not say what they answer, so one that is
    /// late would be taken for the answer to the next question. On a bus they do.
    ///
    /// # Errors
    /// Where the port fails.
    pub fn hush(&mut self) -> Result<(), PortError> {
        if self.opened.link == DriveLink::Can {
            return Ok(());
        }
        let quiet = match self.failed {
            true => QUIET.1,
            false => QUIET.0,
        };
        let begin = Instant::now();
        let mut late = [0; 512];
        while self.opened.port.read(&mut late, quiet)?.is_some() {
            if begin.elapsed() > NEVER_QUIET {
                break;
            }
        }
        self.failed = false;
        Ok(())
    }
}
