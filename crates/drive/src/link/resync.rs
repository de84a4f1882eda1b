//! Losing step and finding it again: what a line that is out of step is asked, and when it is given up.
//!
//! After a loss nobody knows which answers are still to come; markers tell (see [`crate::pairing`]). How long a line is tried is
//! [`Patience`]'s to say. What is asked in step is the parent's business.

use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use crate::pairing::{Access, MARKERS};

use super::patience::Patience;
use super::request::{Job, Lost, Request};
use super::{Line, Link};

/// Markers tried before a request is given up.
const TRIES: u8 = 2;
/// How long the rest of an answer may take: longer than through an adapter with a latency timer of 16 ms.
const REST: Span = Span::from_millis(20);

impl Link {
    /// The marker that was not sent last, so that its answer is not taken for that one's; but where it is still owed an answer
    /// itself, the last one again: the answer to that retires the other.
    pub(super) fn send_marker(&mut self, now: Stamp<Host>, timeout: Span) -> Vec<u8> {
        let [(this, _), (other, _)] = MARKERS;
        let next = if self.marker == this { other } else { this };
        if !self.pairing.awaits(next) {
            self.marker = next;
        }
        self.patience.ask();
        let marker = Request {
            address: self.marker,
            access: Access::Read,
            width: 4,
            timeout,
            marker_timeout: timeout,
            retries: 0,
            urgent: false,
            last: false,
        };
        self.send(&marker, now)
    }

    /// A marker was answered. Where one like it is still out, the answer may have been that one's, and the other kind tells at once.
    pub(super) fn passed(&mut self, marker: Address, now: Stamp<Host>) {
        match self.line {
            Line::Marker { markers, .. }
                if marker == self.marker && !self.pairing.in_step() && !self.is_worn_out(now) =>
            {
                let markers = markers.saturating_sub(1);
                self.line = Line::OutOfStep { markers };
            }
            _ => self.still_coming(now),
        }
    }

    fn is_worn_out(&self, now: Stamp<Host>) -> bool {
        let timeout = self.job.map(|job| job.request.marker_timeout);
        timeout.is_some_and(|timeout| self.patience.is_worn_out(timeout, now))
    }

    /// An older answer came while a marker is awaited: the marker's is still to come, and gets its full time from here.
    pub(super) fn still_coming(&mut self, now: Stamp<Host>) {
        if let (Line::Marker { markers, .. }, Some(job)) = (self.line, self.job) {
            self.line = Line::Marker {
                markers,
                deadline: now.saturating_add(job.request.marker_timeout),
            };
        }
    }

    /// Part of an answer came: the rest of it soon, or never.
    pub(super) fn began(&mut self, now: Stamp<Host>) {
        self.patience.hear(now);
        if let Line::Asked { deadline, limit } = &mut self.line {
            *deadline = now.saturating_add(REST).min(*limit);
        }
    }

    pub(super) fn damaged(&mut self, now: Stamp<Host>) {
        self.stats.damaged += 1;
        self.heard = true;
        self.patience.hear(now);
        // The frame may have been our answer: no use in waiting for the timeout.
        if matches!(self.line, Line::Asked { .. }) {
            self.fall_out_of_step(true, now);
            return;
        }
        self.codec.give_up(now);
        let Line::Marker { markers, deadline } = self.line else {
            return;
        };
        if !self.codec.is_ready() {
            // A dialogue that broke off has no answer any more.
            self.silence(markers, now);
        } else if let Some(job) = self.job {
            let pace = now.saturating_add(Patience::pace(job.request.marker_timeout));
            let end = self.patience.end(job.request.marker_timeout);
            let deadline = deadline.min(pace).min(end.unwrap_or(pace));
            self.line = Line::Marker { markers, deadline };
        }
    }

    /// The unit did not take what was sent. As the refusal may be an older one's, the line is out of step.
    pub(super) fn refused(&mut self, now: Stamp<Host>) {
        self.heard = true;
        self.patience.hear(now);
        let was_marker = match self.line {
            Line::Marker { markers, .. } => Some(markers),
            _ => None,
        };
        if let Some(markers) = was_marker {
            self.silence(markers, now);
            return;
        }
        self.fall_out_of_step(true, now);
        let Some(job) = self.job.as_mut() else {
            return;
        };
        if job.may_be_rejected(now) {
            // It was not carried out, so this attempt does not count.
            job.rejected = job.rejected.saturating_add(1);
            job.attempts = job.attempts.saturating_sub(1);
        } else {
            let attempts = job.attempts.saturating_add(job.rejected);
            self.job = None;
            self.done = Some(Err(Lost::Handshake { attempts }));
        }
    }

    pub(super) fn fall_out_of_step(&mut self, damaged: bool, now: Stamp<Host>) {
        self.stats.lost += 1;
        self.heard = false;
        self.patience.fall(now);
        self.codec.give_up(now);
        if let Some(job) = self.job.as_mut() {
            job.damaged = damaged;
            job.hastened = false;
        }
        self.line = Line::OutOfStep { markers: 0 };
    }

    /// A marker was not answered.
    pub(super) fn silence(&mut self, markers: u8, now: Stamp<Host>) {
        self.stats.lost += 1;
        self.codec.give_up(now);
        let timeout = self.job.map(|job| job.request.marker_timeout);
        let damage = timeout.and_then(|timeout| self.patience.end(timeout));
        let (again, counted) = match damage {
            // A unit that has to be left alone for longer will not be heard before that.
            Some(end) => (
                now.max(self.codec.deadline().unwrap_or(now)) < end,
                markers.saturating_sub(1),
            ),
            None => (markers < TRIES, markers),
        };
        if again && !self.is_worn_out(now) {
            self.line = Line::OutOfStep { markers: counted };
            return;
        }
        self.line = Line::OutOfStep { markers: 0 };
        let Some(job) = self.job else {
            return;
        };
        if self.heard || damage.is_some() {
            self.job = None;
            self.done = Some(Err(Lost::Answer {
                attempts: job.attempts.max(1),
                damaged: job.damaged || damage.is_some(),
            }));
        } else {
            self.lose_link(&job, now);
        }
    }

    /// A last attempt is over.
    pub(super) fn last_call(&mut self, job: &Job, now: Stamp<Host>) {
        let damaged = self.patience.is_hurt();
        self.lose_link(job, now);
        if damaged {
            self.done = Some(Err(Lost::Answer {
                attempts: job.attempts.max(1),
                damaged,
            }));
        }
    }

    pub(super) fn lose_link(&mut self, job: &Job, now: Stamp<Host>) {
        self.job = None;
        if let Line::Asked { .. } = self.line {
            self.fall_out_of_step(false, now);
        }
        self.done = Some(Err(Lost::Link {
            silent: now.saturating_since(job.first.unwrap_or(now)),
        }));
    }

    pub(super) fn back_in_step(&mut self) {
        self.line = Line::InStep;
        let Some(job) = self.job.as_mut() else {
            return;
        };
        // Its answer can no longer come.
        job.id = None;
        if job.attempts > job.request.retries {
            let lost = Lost::Answer {
                attempts: job.attempts,
                damaged: job.damaged,
            };
            self.job = None;
            self.done = Some(Err(lost));
        }
    }
}
