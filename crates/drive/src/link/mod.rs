//! One request at a time over a link that may lose, delay or damage replies.
//!
//! After a loss the link is desynchronised until a probe request is answered (see
//! [`crate::request_matcher`]). Only then is a read repeated or the failure reported, so that a
//! late reply is never taken for another request's. Writes are not repeated, because a lost one may
//! have been executed. A request that the drive rejected for its checksum was not executed and is
//! sent again.

mod request;
mod resync;
mod resync_budget;

use std::collections::VecDeque;

use protocol::canopen::CanFrame;
use protocol::epos2::AbortCode;
use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use crate::codec::{Codec, DecodedFrame};
use crate::exchange::Reply;
use crate::request_matcher::{ReplyMatch, RequestMatcher, SentRequest};
use request::ActiveRequest;
use resync::{MAX_PROBES, SILENT_PROBE_TIMEOUT};
use resync_budget::ResyncBudget;

pub use request::LinkStats;
pub(crate) use request::{LinkRequest, RequestFailure, TimedReply};

/// State of the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LinkState {
    /// No request is outstanding.
    Idle,
    /// A request is outstanding until `deadline`, which is never after `limit`.
    AwaitReply {
        deadline: Stamp<Host>,
        limit: Stamp<Host>,
    },
    /// A reply was lost; the next probe is not sent yet.
    Desynchronised { probes: u8 },
    /// A probe is outstanding.
    Probing { probes: u8, deadline: Stamp<Host> },
}

/// The link to the drive.
#[derive(Debug)]
pub(crate) struct RequestLink {
    codec: Codec,
    matcher: RequestMatcher,
    state: LinkState,
    active: Option<ActiveRequest>,
    result: Option<Result<TimedReply, RequestFailure>>,
    /// Address of the last probe.
    probe: Address,
    /// A whole frame or a refusal arrived since the link was desynchronised.
    has_input: bool,
    budget: ResyncBudget,
    /// The outstanding request has been abandoned: shorten its time limit.
    is_abandoned: bool,
    last_id: u64,
    /// Frames of the bus that are not replies to this client.
    frames: VecDeque<CanFrame>,
    stats: LinkStats,
}

/// Time limit of an abandoned request: several times a reply's usual 2 to 20 ms.
const ABANDONED_TIMEOUT: Span = Span::from_millis(50);

impl RequestLink {
    pub fn new(codec: Codec) -> Self {
        Self {
            codec,
            matcher: RequestMatcher::default(),
            state: LinkState::Idle,
            active: None,
            result: None,
            probe: Address::default(),
            has_input: false,
            budget: ResyncBudget::default(),
            is_abandoned: false,
            last_id: 0,
            frames: VecDeque::new(),
            stats: LinkStats::default(),
        }
    }

    /// Starts a request in place of any earlier one.
    pub fn submit(&mut self, request: LinkRequest) {
        self.result = None;
        self.budget = ResyncBudget::default();
        self.active = Some(ActiveRequest::new(request));
    }

    /// Takes the result of the request.
    pub fn take_result(&mut self) -> Option<Result<TimedReply, RequestFailure>> {
        self.result.take()
    }

    /// Abandons the request. The reply to a copy on the wire is still awaited.
    pub fn abandon(&mut self) {
        self.active = None;
        self.result = None;
        self.is_abandoned = true;
    }

    /// Bytes of the longest segment.
    pub fn segment_len(&self) -> usize {
        self.codec.segment_len()
    }

    pub fn stats(&self) -> LinkStats {
        self.stats
    }

    /// Takes the oldest frame of the bus that is not a reply to this client.
    pub fn take_frame(&mut self) -> Option<CanFrame> {
        self.frames.pop_front()
    }

    /// Time at which [`RequestLink::expire`] is due without input.
    pub fn deadline(&self) -> Option<Stamp<Host>> {
        let state = match self.state {
            LinkState::AwaitReply { deadline, .. } | LinkState::Probing { deadline, .. } => {
                Some(deadline)
            }
            LinkState::Idle | LinkState::Desynchronised { .. } => None,
        };
        let last_attempt = self.active.and_then(|active| active.final_deadline());
        [state, last_attempt, self.codec.deadline()]
            .into_iter()
            .flatten()
            .min()
    }

    /// The next bytes to write.
    pub fn transmit(&mut self, now: Stamp<Host>) -> Option<Vec<u8>> {
        self.expire(now);
        if let Some(out) = self.codec.outgoing(now) {
            if out.is_body {
                self.matcher.restamp(self.last_id, now);
            }
            return Some(out.bytes);
        }
        let active = self.active.as_mut()?;
        active.started.get_or_insert(now);
        let request = active.request;
        let is_desynchronised = matches!(
            self.state,
            LinkState::Desynchronised { .. } | LinkState::Probing { .. }
        );
        let expedite = request.is_urgent && !active.is_sent_early && is_desynchronised;
        if is_desynchronised {
            self.budget.handle_request_waiting(now);
        }
        if expedite
            && let Some(bytes) = self
                .codec
                .encode_unsolicited(request.address, request.access, now)
        {
            return Some(self.send_unsolicited(bytes));
        }
        if !self.codec.is_ready() {
            return None;
        }
        match self.state {
            LinkState::Idle => {
                let limit = now.saturating_add(request.timeout);
                self.state = LinkState::AwaitReply {
                    deadline: limit,
                    limit,
                };
                self.is_abandoned = false;
                Some(self.send_active(now, true))
            }
            _ if expedite => Some(self.send_active(now, false)),
            LinkState::Desynchronised { probes } => {
                let timeout = match probes < MAX_PROBES {
                    true => request.probe_timeout,
                    false => request.probe_timeout.max(SILENT_PROBE_TIMEOUT),
                };
                self.state = LinkState::Probing {
                    probes: probes.saturating_add(1),
                    deadline: now.saturating_add(timeout),
                };
                Some(self.send_probe(now, timeout))
            }
            LinkState::AwaitReply { .. } | LinkState::Probing { .. } => None,
        }
    }

    /// Processes bytes from the port; on CAN whole frames.
    pub fn handle_input(&mut self, bytes: &[u8], now: Stamp<Host>) {
        for chunk in bytes.chunks(self.codec.chunk_len()) {
            match self.codec.push(chunk, now) {
                None => self.handle_partial_reply(now),
                Some(DecodedFrame::Handshake) => {}
                Some(DecodedFrame::Reply(reply)) => self.handle_reply(&reply, now),
                Some(DecodedFrame::Refused) => self.handle_refusal(now),
                Some(DecodedFrame::Bus(frame)) => self.frames.push_back(frame),
                Some(DecodedFrame::Foreign) => self.stats.foreign += 1,
                Some(DecodedFrame::Noise) => {
                    self.stats.damaged += 1;
                    self.budget.handle_input(now);
                }
                Some(DecodedFrame::Damaged) => self.handle_damage(now),
            }
        }
    }

    /// Moves the deadlines by a time in which the host read no input.
    pub fn postpone(&mut self, delay: Span) {
        self.codec.postpone(delay);
        self.budget.postpone(delay);
        match &mut self.state {
            LinkState::AwaitReply { deadline, limit } => {
                *deadline = deadline.saturating_add(delay);
                *limit = limit.saturating_add(delay);
            }
            LinkState::Probing { deadline, .. } => *deadline = deadline.saturating_add(delay),
            LinkState::Idle | LinkState::Desynchronised { .. } => {}
        }
        if let Some(started) = self
            .active
            .as_mut()
            .and_then(|active| active.started.as_mut())
        {
            *started = started.saturating_add(delay);
        }
    }

    /// Acts on deadlines that have passed.
    pub fn expire(&mut self, now: Stamp<Host>) {
        self.codec.expire(now);
        if self.is_abandoned {
            let soon = now.saturating_add(ABANDONED_TIMEOUT);
            if let LinkState::AwaitReply { deadline, .. } | LinkState::Probing { deadline, .. } =
                &mut self.state
            {
                *deadline = soon.min(*deadline);
            }
            self.is_abandoned = false;
        }
        if let Some(active) = self.active
            && active.final_deadline().is_some_and(|end| end <= now)
        {
            self.end_last_attempt(&active, now);
        }
        match self.state {
            LinkState::AwaitReply { deadline, .. } if deadline <= now => {
                self.desynchronise(false, now);
            }
            LinkState::Probing { probes, deadline } if deadline <= now => {
                self.handle_probe_timeout(probes, now);
            }
            _ => {}
        }
    }

    fn send_active(&mut self, now: Stamp<Host>, counts: bool) -> Vec<u8> {
        let Some(mut active) = self.active else {
            return Vec::new();
        };
        active.is_sent_early = true;
        active.attempts = active.attempts.saturating_add(u8::from(counts));
        let bytes = self.send(&active.request, now);
        active.id = Some(self.last_id);
        self.active = Some(active);
        bytes
    }

    /// Records an unsolicited request. It is sent again once the link is synchronised.
    fn send_unsolicited(&mut self, bytes: Vec<u8>) -> Vec<u8> {
        self.stats.requests += 1;
        if let Some(active) = self.active.as_mut() {
            active.is_sent_early = true;
        }
        if let LinkState::Probing { .. } = self.state {
            self.state = LinkState::Desynchronised { probes: 0 };
        }
        bytes
    }

    fn send(&mut self, request: &LinkRequest, now: Stamp<Host>) -> Vec<u8> {
        self.last_id += 1;
        self.stats.requests += 1;
        self.matcher.handle_sent(SentRequest {
            address: request.address,
            access: request.access,
            sent: now,
            id: self.last_id,
        });
        let deadline = now.saturating_add(request.timeout);
        self.codec.encode(request.address, request.access, deadline)
    }

    fn handle_reply(&mut self, reply: &Reply, now: Stamp<Host>) {
        self.has_input = true;
        match self.matcher.handle_reply(reply) {
            ReplyMatch::Unmatched => {
                self.stats.unmatched += 1;
                self.budget.handle_input(now);
            }
            ReplyMatch::Probe(address) => {
                self.budget.handle_reply();
                self.handle_probe_reply(address, now);
            }
            ReplyMatch::Request(sent) => {
                self.budget.handle_reply();
                if self.active.and_then(|active| active.id) == Some(sent.id) {
                    self.complete(&sent, reply, now);
                } else {
                    self.stats.unmatched += 1;
                    self.extend_probe(now);
                }
            }
        }
        if self.state != LinkState::Idle && self.matcher.is_synchronised() {
            self.synchronise();
        }
    }

    fn complete(&mut self, sent: &SentRequest, reply: &Reply, now: Stamp<Host>) {
        self.stats.answers += 1;
        if let Some(active) = self.active.as_mut()
            && reply.error() == AbortCode::CRC
            && active.retry_rejected(now)
        {
            active.id = None;
            return;
        }
        self.active = None;
        self.result = Some(Ok(TimedReply {
            reply: *reply,
            sent: sent.sent,
            received: now,
        }));
    }
}
