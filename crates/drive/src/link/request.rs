//! A request on the link, its progress and its result.

use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use crate::exchange::{ObjectAccess, Reply};

/// A request to the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LinkRequest {
    pub address: Address,
    pub access: ObjectAccess,
    /// Time limit of each attempt.
    pub timeout: Span,
    /// Time limit of each probe after a loss.
    pub probe_timeout: Span,
    /// Repeats after a lost reply.
    pub retries: u8,
    /// Time without any input for which probes go on; at least two probes.
    pub silence_limit: Span,
    /// Sent even while the link is desynchronised, and again after that.
    pub is_urgent: bool,
    /// Given up after one timeout in all, attempts and probes included.
    pub is_last_attempt: bool,
}

/// A reply with the times at which its request was sent and the reply was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimedReply {
    pub reply: Reply,
    pub sent: Stamp<Host>,
    pub received: Stamp<Host>,
}

impl TimedReply {
    /// From request to reply.
    pub fn took(&self) -> Span {
        self.received.saturating_since(self.sent)
    }
}

/// Reason why a request has no reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RequestFailure {
    /// The link works, but the reply to every attempt was lost.
    NoReply {
        attempts: u8,
        /// The last reply was damaged rather than missing.
        damaged: bool,
    },
    /// Nothing arrived for this span, probes included.
    LinkLost { silent: Span },
    /// The drive refused every attempt (RS232 handshake).
    HandshakeRefused { attempts: u8 },
}

/// Counters of the link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LinkStats {
    /// Requests sent, repeats and probes included.
    pub requests: u64,
    /// Replies matched to the active request.
    pub answers: u64,
    /// Attempts whose reply was late or damaged.
    pub lost: u64,
    /// Replies to no request, or to one given up.
    pub unmatched: u64,
    /// Frames with a wrong checksum or length.
    pub damaged: u64,
    /// Valid frames that are not replies, such as an echo.
    pub foreign: u64,
}

/// A request in progress.
#[derive(Clone, Copy, Debug)]
pub(super) struct ActiveRequest {
    pub request: LinkRequest,
    /// The latest copy on the wire.
    pub id: Option<u64>,
    pub attempts: u8,
    pub rejections: u8,
    pub damaged: bool,
    /// Time at which the link first processed it.
    pub started: Option<Stamp<Host>>,
    /// A copy was sent since the link was last synchronised.
    pub is_sent_early: bool,
}

/// Repeats of a request that the drive rejected for its checksum.
const MAX_REJECTIONS: u8 = 2;
/// Time during which the number of such repeats is not limited: bursts of damage end.
const REJECTION_SPAN: Span = Span::from_millis(150);

impl ActiveRequest {
    pub fn new(request: LinkRequest) -> Self {
        Self {
            request,
            id: None,
            attempts: 0,
            rejections: 0,
            damaged: false,
            started: None,
            is_sent_early: false,
        }
    }

    /// Records a rejection for a wrong checksum: the drive did not execute the request, so the
    /// attempt does not count. Returns whether the request may be repeated.
    pub fn retry_rejected(&mut self, now: Stamp<Host>) -> bool {
        let elapsed = self.started.map(|started| now.saturating_since(started));
        let may_retry = self.rejections < MAX_REJECTIONS
            || elapsed.is_some_and(|elapsed| elapsed < REJECTION_SPAN);
        if may_retry {
            self.rejections = self.rejections.saturating_add(1);
            self.attempts = self.attempts.saturating_sub(1);
        }
        may_retry
    }

    /// Whether silence is tolerated now.
    pub fn tolerates_silence(&self, now: Stamp<Host>) -> bool {
        let silent = self.started.map(|started| now.saturating_since(started));
        silent.is_some_and(|silent| silent < self.request.silence_limit)
    }

    /// Time at which a last attempt is given up.
    pub fn final_deadline(&self) -> Option<Stamp<Host>> {
        let started = self.started.filter(|_| self.request.is_last_attempt)?;
        Some(started.saturating_add(self.request.timeout))
    }
}
