//! Loss of synchronisation and recovery by probe requests (see [`crate::request_matcher`]).
//!
//! [`ResyncBudget`](super::resync_budget::ResyncBudget) limits the time that recovery takes.

use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use crate::exchange::ObjectAccess;
use crate::request_matcher::PROBES;

use super::request::{ActiveRequest, LinkRequest, RequestFailure};
use super::{LinkState, RequestLink};

/// Unanswered probes before a request is given up.
pub(super) const MAX_PROBES: u8 = 2;
/// Time limit of probes after that: a machine that was busy has few replies to catch up with.
pub(super) const SILENT_PROBE_TIMEOUT: Span = Span::from_millis(100);
/// Time limit of the rest of a reply: longer than a serial adapter's latency timer of 16 ms.
const REST_TIMEOUT: Span = Span::from_millis(20);

impl RequestLink {
    /// Sends the probe that was not sent last, so that a late reply to the last is not taken for
    /// this one's. If that other probe is itself outstanding, repeats the last: its reply retires
    /// both.
    pub(super) fn send_probe(&mut self, now: Stamp<Host>, timeout: Span) -> Vec<u8> {
        let [(first, _), (second, _)] = PROBES;
        let next = if self.probe == first { second } else { first };
        if !self.matcher.awaits(next) {
            self.probe = next;
        }
        self.budget.handle_probe_sent();
        let probe = LinkRequest {
            address: self.probe,
            access: ObjectAccess::Read,
            timeout,
            probe_timeout: timeout,
            retries: 0,
            silence_limit: Span::ZERO,
            is_urgent: false,
            is_last_attempt: false,
        };
        self.send(&probe, now)
    }

    /// If an equal probe is still outstanding, the reply may have been that one's: the other kind
    /// of probe decides at once.
    pub(super) fn handle_probe_reply(&mut self, probe: Address, now: Stamp<Host>) {
        match self.state {
            LinkState::Probing { probes, .. }
                if probe == self.probe
                    && !self.matcher.is_synchronised()
                    && !self.is_budget_exhausted(now) =>
            {
                let probes = probes.saturating_sub(1);
                self.state = LinkState::Desynchronised { probes };
            }
            _ => self.extend_probe(now),
        }
    }

    fn is_budget_exhausted(&self, now: Stamp<Host>) -> bool {
        self.active
            .is_some_and(|active| self.budget.is_exhausted(active.request.probe_timeout, now))
    }

    /// Gives the outstanding probe its full time limit again after the reply to an older request.
    pub(super) fn extend_probe(&mut self, now: Stamp<Host>) {
        if let (LinkState::Probing { probes, .. }, Some(active)) = (self.state, self.active) {
            self.state = LinkState::Probing {
                probes,
                deadline: now.saturating_add(active.request.probe_timeout),
            };
        }
    }

    pub(super) fn handle_partial_reply(&mut self, now: Stamp<Host>) {
        self.budget.handle_input(now);
        if let LinkState::AwaitReply { deadline, limit } = &mut self.state {
            *deadline = now.saturating_add(REST_TIMEOUT).min(*limit);
        }
    }

    pub(super) fn handle_damage(&mut self, now: Stamp<Host>) {
        self.stats.damaged += 1;
        self.has_input = true;
        self.budget.handle_input(now);
        // The damaged frame may have been the reply: waiting for the timeout is useless.
        if matches!(self.state, LinkState::AwaitReply { .. }) {
            self.desynchronise(true, now);
            return;
        }
        self.codec.cancel(now);
        let LinkState::Probing { probes, deadline } = self.state else {
            return;
        };
        if !self.codec.is_ready() {
            // A cancelled dialogue has no reply.
            self.handle_probe_timeout(probes, now);
        } else if let Some(active) = self.active {
            let probe_timeout = active.request.probe_timeout;
            // After damage probes go out twice as fast.
            let next = now.saturating_add(probe_timeout.half());
            let end = self.budget.damage_deadline(probe_timeout).unwrap_or(next);
            let deadline = deadline.min(next).min(end);
            self.state = LinkState::Probing { probes, deadline };
        }
    }

    /// The drive refused a request. As the refusal may be that of an older one, the link is
    /// desynchronised.
    pub(super) fn handle_refusal(&mut self, now: Stamp<Host>) {
        self.has_input = true;
        self.budget.handle_input(now);
        if let LinkState::Probing { probes, .. } = self.state {
            self.handle_probe_timeout(probes, now);
            return;
        }
        self.desynchronise(true, now);
        let Some(active) = self.active.as_mut() else {
            return;
        };
        if !active.retry_rejected(now) {
            let attempts = active.attempts.saturating_add(active.rejections);
            self.fail(RequestFailure::HandshakeRefused { attempts });
        }
    }

    pub(super) fn desynchronise(&mut self, damaged: bool, now: Stamp<Host>) {
        self.stats.lost += 1;
        self.has_input = false;
        self.budget.handle_desynchronised(now);
        self.codec.cancel(now);
        if let Some(active) = self.active.as_mut() {
            active.damaged = damaged;
            active.is_sent_early = false;
        }
        self.state = LinkState::Desynchronised { probes: 0 };
    }

    pub(super) fn handle_probe_timeout(&mut self, probes: u8, now: Stamp<Host>) {
        self.stats.lost += 1;
        self.codec.cancel(now);
        let damage_deadline = self
            .active
            .and_then(|active| self.budget.damage_deadline(active.request.probe_timeout));
        let (may_retry, counted) = match damage_deadline {
            // An RS232 drive that needs a longer pause does not answer before its end.
            Some(end) => (
                now.max(self.codec.deadline().unwrap_or(now)) < end,
                probes.saturating_sub(1),
            ),
            None => (probes < MAX_PROBES, probes),
        };
        // Such a drive is probed only after its pause.
        let next_probe = now.max(self.codec.deadline().unwrap_or(now));
        let may_be_silent = !self.has_input
            && !self.budget.has_damage()
            && self
                .active
                .is_some_and(|active| active.tolerates_silence(next_probe));
        if may_be_silent {
            self.budget.handle_silence(now);
        }
        if may_be_silent || may_retry && !self.is_budget_exhausted(now) {
            self.state = LinkState::Desynchronised { probes: counted };
            return;
        }
        self.state = LinkState::Desynchronised { probes: 0 };
        let Some(active) = self.active else {
            return;
        };
        if self.has_input || damage_deadline.is_some() {
            self.fail(RequestFailure::NoReply {
                attempts: active.attempts.max(1),
                damaged: active.damaged || damage_deadline.is_some(),
            });
        } else {
            self.fail(link_lost(&active, now));
        }
    }

    pub(super) fn end_last_attempt(&mut self, active: &ActiveRequest, now: Stamp<Host>) {
        let damaged = self.budget.has_damage();
        let failure = if damaged {
            RequestFailure::NoReply {
                attempts: active.attempts.max(1),
                damaged,
            }
        } else {
            link_lost(active, now)
        };
        self.fail(failure);
        if let LinkState::AwaitReply { .. } = self.state {
            self.desynchronise(false, now);
        }
    }

    pub(super) fn synchronise(&mut self) {
        self.state = LinkState::Idle;
        let Some(active) = self.active.as_mut() else {
            return;
        };
        // The reply to the last copy is lost.
        active.id = None;
        if active.attempts > active.request.retries {
            let failure = RequestFailure::NoReply {
                attempts: active.attempts,
                damaged: active.damaged,
            };
            self.fail(failure);
        }
    }

    fn fail(&mut self, failure: RequestFailure) {
        self.active = None;
        self.result = Some(Err(failure));
    }
}

fn link_lost(active: &ActiveRequest, now: Stamp<Host>) -> RequestFailure {
    RequestFailure::LinkLost {
        silent: now.saturating_since(active.started.unwrap_or(now)),
    }
}
