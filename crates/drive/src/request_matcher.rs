//! Matches replies to requests.
//!
//! A serial reply of the EPOS2 names neither object nor request. Order and format must do: replies
//! come in the order of the requests, and some are lost. The reply to a read is the error code and
//! the value, two words each; that to a write is the error code. An SDO response names its object
//! (segments do not), but not which of two reads of one object it belongs to. A reply that fits
//! more than one outstanding request is matched to none and retires the oldest of them: the replies
//! to the others, and to probes between them, may still arrive.
//!
//! After a loss the client sends a probe request, a read of an object that does not exist. Its
//! error arrives after everything still under way and so resynchronises both sides. Two probes with
//! different errors alternate, so that a late reply to one is not taken for the other's.
//!
//! The client and the listener share this code, so a log is matched as its capture was.

use std::collections::VecDeque;

use protocol::canopen::sdo::GenericSdoRequest;
use protocol::epos2::AbortCode;
use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use crate::exchange::{ObjectAccess, Reply};

/// Objects that no EPOS2 has, with the errors of reading them: an index at the end of the
/// manufacturer-specific range (CiA 301), and a subindex of the mandatory identity object.
pub const PROBES: [(Address, AbortCode); 2] = [
    (Address::new(0x5FFF, 0), AbortCode::NO_OBJECT),
    (Address::new(0x1018, 0xFF), AbortCode::NO_SUB),
];

/// A request on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SentRequest {
    pub address: Address,
    pub access: ObjectAccess,
    pub sent: Stamp<Host>,
    /// Distinguishes copies of one request; 0 is a request to another node.
    pub id: u64,
}

/// Result of matching a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ReplyMatch {
    /// The reply to this request; replies to earlier requests are lost.
    Request(SentRequest),
    /// The reply to the oldest probe of this address; replies to earlier requests are lost.
    Probe(Address),
    /// A reply that fits no request, or several.
    Unmatched,
}

/// Requests that may still be answered.
#[derive(Clone, Debug, Default)]
pub(crate) struct RequestMatcher {
    /// Oldest first.
    outstanding: VecDeque<SentRequest>,
    /// Writes whose replies are lost, oldest first.
    lost_writes: VecDeque<SentRequest>,
}

/// Requests kept; the probes need two, anything above only bounds memory.
const MAX_OUTSTANDING: usize = 32;
/// Age at which a request is dropped: four times the drive's own frame timeout of 500 ms.
const EXPIRY: Span = Span::from_secs(2);

/// No master gives a request up sooner: three quarters of the shortest timeout of this client.
const SHORTEST_TIMEOUT: Span = Span::from_millis(30);

impl RequestMatcher {
    pub fn handle_sent(&mut self, request: SentRequest) {
        self.outstanding
            .retain(|old| request.sent.saturating_since(old.sent) < EXPIRY);
        if self.outstanding.len() >= MAX_OUTSTANDING {
            self.outstanding.pop_front();
        }
        self.outstanding.push_back(request);
    }

    /// Corrects the time at which a request was sent.
    pub fn restamp(&mut self, id: u64, sent: Stamp<Host>) {
        if let Some(request) = self.outstanding.iter_mut().find(|old| old.id == id) {
            request.sent = sent;
        }
    }

    pub fn handle_reply(&mut self, reply: &Reply) -> ReplyMatch {
        if let Some((index, address)) = self.find_probe(reply) {
            self.retire(index + 1);
            return ReplyMatch::Probe(address);
        }
        let mut fitting = (0..).zip(&self.outstanding).filter(|(_, request)| {
            probe_error(request).is_none() && reply.fits(request.address, request.access)
        });
        let Some((index, request)) = fitting.next().map(|(index, request)| (index, *request))
        else {
            return ReplyMatch::Unmatched;
        };
        if fitting.next().is_some() {
            self.retire(index + 1);
            return ReplyMatch::Unmatched;
        }
        self.retire(index);
        self.outstanding.pop_front();
        ReplyMatch::Request(request)
    }

    /// The two newest requests that a reply fits, the newer one second, if it fits several.
    pub fn newest_fitting(&self, reply: &Reply) -> Option<[SentRequest; 2]> {
        if self.find_probe(reply).is_some() {
            return None;
        }
        let mut fitting = self.outstanding.iter().rev().filter(|request| {
            probe_error(request).is_none() && reply.fits(request.address, request.access)
        });
        let newer = fitting.next()?;
        fitting.next().map(|older| [*older, *newer])
    }

    /// Drops the request with this id and those before it, whose replies are lost.
    pub fn retire_through(&mut self, id: u64) {
        if let Some(index) = self.outstanding.iter().rposition(|old| old.id == id) {
            self.retire(index + 1);
        }
    }

    /// Drops the oldest `count` requests, whose replies are lost.
    fn retire(&mut self, count: usize) {
        for request in self.outstanding.drain(..count) {
            if let ObjectAccess::Write { .. } = request.access {
                self.lost_writes.push_back(request);
            }
        }
        let excess = self.lost_writes.len().saturating_sub(MAX_OUTSTANDING);
        self.lost_writes.drain(..excess);
    }

    /// The oldest write whose reply is lost.
    pub fn take_lost_write(&mut self) -> Option<SentRequest> {
        self.lost_writes.pop_front()
    }

    /// Retires requests that were answered, though no reply was recorded: a master that sends its
    /// next request after the shortest reply time and before any timeout has received the reply.
    /// A probe follows a reply that is missing.
    pub fn retire_answered(&mut self, next: &SentRequest, shortest: Span) {
        if probe_error(next).is_some() {
            return;
        }
        let answered = |old: &SentRequest| {
            let gap = next.sent.saturating_since(old.sent);
            probe_error(old).is_none() && (shortest..=SHORTEST_TIMEOUT).contains(&gap)
        };
        if let Some(newest) = self.outstanding.iter().rposition(answered) {
            self.retire(newest + 1);
        }
    }

    /// The oldest probe that an error answers. If only probes are outstanding, an unexpected error
    /// answers the first of them.
    fn find_probe(&self, reply: &Reply) -> Option<(usize, Address)> {
        if reply.error().is_none() {
            return None;
        }
        let fits = |request: &SentRequest| reply.fits(request.address, request.access);
        let is_expected =
            |request: &SentRequest| probe_error(request) == Some(reply.error()) && fits(request);
        let only_probes = || self.outstanding.iter().all(|r| probe_error(r).is_some());
        let index = self.outstanding.iter().position(is_expected).or_else(|| {
            only_probes()
                .then(|| self.outstanding.iter().position(fits))
                .flatten()
        })?;
        Some((index, self.outstanding.get(index)?.address))
    }

    /// Whether a read of this object is outstanding.
    pub fn awaits(&self, address: Address) -> bool {
        self.outstanding
            .iter()
            .any(|request| request.access == ObjectAccess::Read && request.address == address)
    }

    /// Whether no request is outstanding.
    pub fn is_synchronised(&self) -> bool {
        self.outstanding.is_empty()
    }
}

/// The expected error of a probe; `None` for any other request.
fn probe_error(request: &SentRequest) -> Option<AbortCode> {
    let is_read = matches!(
        request.access,
        ObjectAccess::Read | ObjectAccess::Transfer(GenericSdoRequest::InitiateUpload { .. })
    );
    PROBES
        .iter()
        .find(|(address, _)| is_read && request.address == *address)
        .map(|(_, error)| *error)
}

#[cfg(test)]
mod tests {
    use protocol::canopen::sdo::{Expedited, Initiate};

    use super::*;
    use crate::exchange::{SerialReply, TransferResponse};

    const READ_OK: Reply = serial(AbortCode::NONE, 2, Some(7));
    const WRITE_OK: Reply = serial(AbortCode::NONE, 0, None);
    const NO_OBJECT: Reply = serial(AbortCode::NO_OBJECT, 0, None);
    const NO_SUB: Reply = serial(AbortCode::NO_SUB, 0, None);
    const WRITE: ObjectAccess = ObjectAccess::Write { value: 0, width: 4 };

    const fn serial(error: AbortCode, words: usize, value: Option<u32>) -> Reply {
        Reply::Serial(SerialReply {
            error,
            words,
            value,
            segment: None,
        })
    }

    fn request(id: u64, access: ObjectAccess) -> SentRequest {
        SentRequest {
            address: Address::new(0x6064, 0),
            access,
            sent: Stamp::from_nanos(1_000_000 * id as i64),
            id,
        }
    }

    fn read(id: u64) -> SentRequest {
        request(id, ObjectAccess::Read)
    }

    fn probe(id: u64, kind: usize) -> SentRequest {
        SentRequest {
            address: PROBES[kind].0,
            ..read(id)
        }
    }

    fn matcher(sent: &[SentRequest]) -> RequestMatcher {
        let mut matcher = RequestMatcher::default();
        sent.iter().for_each(|one| matcher.handle_sent(*one));
        matcher
    }

    #[test]
    fn a_single_request_gets_its_reply_once() {
        let mut matcher = matcher(&[read(1)]);
        assert_eq!(matcher.handle_reply(&READ_OK), ReplyMatch::Request(read(1)));
        assert_eq!(matcher.handle_reply(&READ_OK), ReplyMatch::Unmatched);
    }

    #[test]
    fn a_write_does_not_take_the_reply_to_a_read() {
        let write = request(1, WRITE);
        let mut matcher = matcher(&[write]);
        assert_eq!(matcher.handle_reply(&READ_OK), ReplyMatch::Unmatched);
        assert_eq!(matcher.handle_reply(&WRITE_OK), ReplyMatch::Request(write));
    }

    #[test]
    fn an_ambiguous_reply_is_unmatched() {
        let mut matcher = matcher(&[read(1), read(2)]);
        assert_eq!(matcher.handle_reply(&READ_OK), ReplyMatch::Unmatched);
        assert!(!matcher.is_synchronised());
    }

    /// A quick stop sent after a late write and its probe was taken as refused with the probe's
    /// error: the reply to the late write had retired the probe.
    #[test]
    fn an_ambiguous_reply_leaves_the_probe_between_two_writes_outstanding() {
        let [late, quick_stop] = [request(1, WRITE), request(3, WRITE)];
        let mut matcher = matcher(&[late, probe(2, 1), quick_stop]);
        assert_eq!(matcher.handle_reply(&WRITE_OK), ReplyMatch::Unmatched);
        let answered = matcher.handle_reply(&NO_SUB);
        assert_eq!(answered, ReplyMatch::Probe(PROBES[1].0));
        let answered = matcher.handle_reply(&WRITE_OK);
        assert_eq!(answered, ReplyMatch::Request(quick_stop));
    }

    /// The second of three replies was taken for that of the third write.
    #[test]
    fn late_replies_to_two_writes_do_not_answer_the_third() {
        let sent = [1, 2, 3].map(|id| request(id, WRITE));
        let mut matcher = matcher(&sent);
        assert_eq!(matcher.handle_reply(&WRITE_OK), ReplyMatch::Unmatched);
        assert_eq!(matcher.handle_reply(&WRITE_OK), ReplyMatch::Unmatched);
        assert_eq!(
            matcher.handle_reply(&WRITE_OK),
            ReplyMatch::Request(sent[2])
        );
    }

    #[test]
    fn a_reply_retires_earlier_requests() {
        let write = request(2, WRITE);
        let mut matcher = matcher(&[read(1), write]);
        assert_eq!(matcher.handle_reply(&WRITE_OK), ReplyMatch::Request(write));
        assert!(matcher.is_synchronised());
    }

    #[test]
    fn a_late_reply_before_the_probes_is_still_matched() {
        let mut matcher = matcher(&[read(1), probe(2, 0)]);
        assert_eq!(matcher.handle_reply(&READ_OK), ReplyMatch::Request(read(1)));
        assert!(!matcher.is_synchronised());
        let answered = matcher.handle_reply(&NO_OBJECT);
        assert_eq!(answered, ReplyMatch::Probe(PROBES[0].0));
        assert!(matcher.is_synchronised());
    }

    #[test]
    fn a_request_before_any_timeout_shows_that_the_last_was_answered() {
        let shortest = Span::from_millis(1);
        let mut polled = matcher(&[read(1)]);
        polled.retire_answered(&read(26), shortest);
        polled.handle_sent(read(26));
        assert_eq!(polled.handle_reply(&READ_OK), ReplyMatch::Request(read(26)));
        // A probe shows the opposite.
        let mut probed = matcher(&[read(1)]);
        probed.retire_answered(&probe(26, 0), shortest);
        probed.handle_sent(probe(26, 0));
        assert_eq!(probed.handle_reply(&READ_OK), ReplyMatch::Request(read(1)));
    }

    #[test]
    fn each_probe_has_its_own_reply() {
        let sent = [read(1), probe(2, 0), probe(3, 1)];
        let [first, second] = PROBES.map(|(address, _)| ReplyMatch::Probe(address));
        let mut both = matcher(&sent);
        assert_eq!(both.handle_reply(&NO_OBJECT), first);
        assert!(!both.is_synchronised());
        assert_eq!(both.handle_reply(&NO_SUB), second);
        assert!(both.is_synchronised());
        let mut second_only = matcher(&sent);
        assert_eq!(second_only.handle_reply(&NO_SUB), second);
        assert!(second_only.is_synchronised());
    }

    #[test]
    fn an_unexpected_error_answers_a_probe_only_if_no_other_request_is_outstanding() {
        let other = serial(AbortCode::GENERAL, 0, None);
        assert_eq!(
            matcher(&[probe(1, 1)]).handle_reply(&other),
            ReplyMatch::Probe(PROBES[1].0)
        );
        let mut with_read = matcher(&[read(1), probe(2, 1)]);
        assert_eq!(with_read.handle_reply(&other), ReplyMatch::Request(read(1)));
    }

    #[test]
    fn old_requests_expire() {
        let mut matcher = matcher(&[read(1), read(3_000)]);
        let answered = matcher.handle_reply(&READ_OK);
        assert_eq!(answered, ReplyMatch::Request(read(3_000)));
    }

    fn uploaded(sub: u8) -> Reply {
        Reply::Sdo(TransferResponse::InitiateUpload {
            address: Address::new(0x6064, sub),
            transfer: Initiate::Expedited(Expedited::of(7_u32)),
        })
    }

    fn aborted(address: Address) -> Reply {
        let error = AbortCode::NO_OBJECT;
        Reply::Sdo(TransferResponse::Abort { address, error })
    }

    #[test]
    fn an_sdo_response_belongs_to_its_object_and_direction() {
        let address = read(1).address;
        let downloaded = Reply::Sdo(TransferResponse::InitiateDownload { address });
        let other_sub = aborted(Address::new(0x6064, 1));
        for other in [uploaded(1), downloaded, other_sub] {
            let matched = matcher(&[read(1)]).handle_reply(&other);
            assert_eq!(matched, ReplyMatch::Unmatched);
        }
        for own in [uploaded(0), aborted(address)] {
            let matched = matcher(&[read(1)]).handle_reply(&own);
            assert_eq!(matched, ReplyMatch::Request(read(1)));
        }
    }

    #[test]
    fn an_sdo_abort_of_another_object_does_not_answer_a_probe() {
        let mut matcher = matcher(&[probe(1, 0)]);
        let other = aborted(Address::new(0x6064, 0));
        assert_eq!(matcher.handle_reply(&other), ReplyMatch::Unmatched);
        let own = aborted(PROBES[0].0);
        assert_eq!(matcher.handle_reply(&own), ReplyMatch::Probe(PROBES[0].0));
    }

    #[test]
    fn two_reads_of_one_object_are_ambiguous_on_can_too() {
        let mut matcher = matcher(&[read(1), read(2)]);
        assert_eq!(matcher.handle_reply(&uploaded(0)), ReplyMatch::Unmatched);
    }
}
