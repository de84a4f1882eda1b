//! A question on its way: what is asked, what has become of it, what comes of it in the end.

use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use crate::codec::Reply;
use crate::pairing::Access;

/// A question to the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Request {
    pub address: Address,
    pub access: Access,
    /// Bytes of the object.
    pub width: u8,
    /// How long each attempt waits.
    pub timeout: Span,
    /// How long each marker waits after a loss.
    pub marker_timeout: Span,
    /// How often it is repeated after a lost answer.
    pub retries: u8,
    /// Goes out even while the link is out of step, and again once it is in step: for what must not wait.
    pub urgent: bool,
    /// Given up after one timeout, attempts and markers included: where a link that seems dead is tried for the last time.
    pub last: bool,
}

/// An answer, with the times at which the question was handed out and the answer read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Answered {
    pub reply: Reply,
    pub request: Stamp<Host>,
    pub answer: Stamp<Host>,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lost {
    /// The link works, but every attempt's answer was lost.
    Answer {
        attempts: u8,
        /// Whether the last one came back damaged rather than not at all.
        damaged: bool,
    },
    /// Nothing at all came back within this time, markers included.
    Link { silent: Span },
    /// The unit refused every attempt before it looked at it (RS232 handshake).
    Handshake { attempts: u8 },
}

/// What the link went through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkStats {
    /// Requests handed out, repeats and markers included.
    pub requests: u64,
    /// Answers given to the request they belong to.
    pub answers: u64,
    /// Attempts whose answer did not come in time or came damaged.
    pub lost: u64,
    /// Answers that belonged to no request, or to one that had been given up.
    pub strays: u64,
    /// Frames with a wrong checksum or an impossible length.
    pub damaged: u64,
    /// Frames that are no answers at all, such as an echo of our own.
    pub foreign: u64,
}

/// A question with what has become of it so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job {
    pub request: Request,
    /// The latest copy on the wire.
    pub id: Option<u64>,
    pub attempts: u8,
    pub rejected: u8,
    pub damaged: bool,
    /// When it was first looked at.
    pub first: Option<Stamp<Host>>,
    pub hastened: bool,
}

/// Repeats of a request that the drive refused for its checksum, and more of them while this span lasts: bursts of damage end.
const REJECTIONS: u8 = 2;
const REJECTED: Span = Span::from_millis(150);

impl Job {
    pub fn new(request: Request) -> Self {
        Self {
            request,
            id: None,
            attempts: 0,
            rejected: 0,
            damaged: false,
            first: None,
            hastened: false,
        }
    }

    /// Whether a request that the drive refused for its checksum goes out again.
    pub fn may_be_rejected(&self, now: Stamp<Host>) -> bool {
        let since = self.first.map(|first| now.saturating_since(first));
        self.rejected < REJECTIONS || since.is_some_and(|since| since < REJECTED)
    }

    /// When a last attempt is over.
    pub fn last_call(&self) -> Option<Stamp<Host>> {
        let first = self.first.filter(|_| self.request.last)?;
        Some(first.saturating_add(self.request.timeout))
    }
}
