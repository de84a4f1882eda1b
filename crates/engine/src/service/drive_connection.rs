//! The drive's port from one request to the next.

use std::time::{Duration, Instant};

use io::port::PortError;
use protocol::record::DriveLink;
use units::Span;

use crate::devices::drive_port::OpenPort;
use crate::devices::drive_session::SessionError;

/// Silence after which no more answers are expected: between requests, and after a failed one.
const QUIET: (Span, Span) = (Span::from_millis(10), Span::from_millis(500));
/// Longest wait for silence.
const QUIET_LIMIT: Duration = Duration::from_secs(2);

/// Knowledge of the axis behind a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AxisKnowledge {
    /// Nothing: the drive was not connected to yet.
    Unknown,
    /// It may move: it was not seen at rest. Connecting brings it to rest.
    MayMove,
    /// It is at rest between requests.
    AtRest,
}

/// A port that stays open from one request to the next.
pub(super) struct DriveConnection {
    /// The port.
    pub(super) opened: OpenPort,
    /// Whether the last request failed: an answer to it may still arrive.
    pub(super) failed: bool,
    /// The axis.
    pub(super) axis: AxisKnowledge,
}

impl DriveConnection {
    /// A connection over a port just opened. `stale` where answers to another program's requests
    /// may still arrive.
    pub(super) const fn new(opened: OpenPort, stale: bool) -> Self {
        Self {
            opened,
            failed: stale,
            axis: AxisKnowledge::Unknown,
        }
    }

    /// Records the end of a command that `connected` to the drive or did not.
    pub(super) const fn command_ended(&mut self, connected: bool, error: Option<&SessionError>) {
        match error {
            Some(error) if error.may_move() => self.axis = AxisKnowledge::MayMove,
            None if connected => self.axis = AxisKnowledge::AtRest,
            _ => {}
        }
    }

    /// Reads and drops late answers. Answers on a serial line do not say what they answer: a late
    /// one would be taken for the answer to the next request. CAN frames do say it.
    ///
    /// # Errors
    /// Where the port fails.
    pub(super) fn drain_stale(&mut self) -> Result<(), PortError> {
        if self.opened.link == DriveLink::Can {
            return Ok(());
        }
        let quiet = match self.failed {
            true => QUIET.1,
            false => QUIET.0,
        };
        let begin = Instant::now();
        let mut buffer = [0; 512];
        while self.opened.port.read(&mut buffer, quiet)?.is_some() {
            if begin.elapsed() > QUIET_LIMIT {
                break;
            }
        }
        self.failed = false;
        Ok(())
    }
}
