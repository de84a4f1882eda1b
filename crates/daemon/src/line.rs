//! The drive's port from one order to the next.

use std::time::{Duration, Instant};

use io::port::PortError;
use protocol::record::DriveLink;
use units::Span;

use engine::devices::drive_port::Opened;
use engine::devices::drive_session::SessionError;

/// A serial drive that has not sent anything for so long has nothing more to say: between orders, and after one that failed.
const QUIET: (Span, Span) = (Span::from_millis(10), Span::from_millis(500));
/// A port that is never quiet is not waited for longer than this.
const NEVER_QUIET: Duration = Duration::from_secs(2);
/// What is known of the axis behind a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Nobody has connected to its drive yet.
    Unknown,
    /// Nobody has seen it come to rest: it may move. Only connecting, which brings it to rest, ends that.
    MayMove,
    /// It is at rest between orders, its drive connected to.
    Known,
}

/// A drive's port that is kept open from one order to the next.
pub struct Line {
    /// The port.
    pub opened: Opened,
    /// Whether the last order failed: an answer to it may still be on its way.
    pub failed: bool,
    /// The axis behind it.
    pub axis: Axis,
}

impl Line {
    /// Of a port that was opened a moment ago.
    #[must_use]
    pub const fn new(opened: Opened) -> Self {
        Self {
            opened,
            // Whoever had it before may have left questions.
            failed: true,
            axis: Axis::Unknown,
        }
    }

    /// An order has ended, in which the drive was connected to or not: without an error, or with this one.
    pub const fn ended(&mut self, connected: bool, error: Option<&SessionError>) {
        match error {
            Some(error) if error.may_move() => self.axis = Axis::MayMove,
            None if connected => self.axis = Axis::Known,
            // A drive that nobody was connected to is so still, and what may move goes on.
            _ => {}
        }
    }

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
