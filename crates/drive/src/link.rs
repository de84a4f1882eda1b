//! One question at a time over a link that may lose, delay or corrupt answers.
//!
//! A request goes out, its answer comes back or is lost. After a loss the link is out of step until a marker has been answered
//! (see [`crate::pairing`]); only then is the read repeated or the failure reported, so that a late answer is never taken for
//! another's. Writes are not repeated by themselves, as nobody knows whether the lost one was carried out; but a request
//! that the drive itself refused for its checksum was not, and goes out again.
//! What is asked, and what a failure means for the motion, is decided elsewhere.

mod request;

use std::collections::VecDeque;

use protocol::canopen::CanFrame;
use protocol::epos2::CommError;
use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use crate::codec::{Codec, Decoded, Reply};
use crate::pairing::{Access, Asked, MARKERS, Paired, Pairing};
use request::Job;

pub use request::LinkStats;
pub(crate) use request::{Answered, Lost, Request};

/// The state of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Line {
    /// Nothing is under way.
    InStep,
    /// A request is under way.
    Asked { deadline: Stamp<Host> },
    /// Out of step, marker yet to be sent.
    OutOfStep { markers: u8 },
    /// Out of step, marker under way.
    Marker { markers: u8, deadline: Stamp<Host> },
}

/// The link with its one request.
#[derive(Debug)]
pub(crate) struct Link {
    codec: Codec,
    pairing: Pairing,
    line: Line,
    job: Option<Job>,
    done: Option<Result<Answered, Lost>>,
    /// The marker that was sent last.
    marker: Address,
    /// Something came in since the line went out of step.
    heard: bool,
    /// The request under way has no owner any more: do not wait long for it.
    hurry: bool,
    last_id: u64,
    /// Frames of the bus that are no answers to this client.
    frames: VecDeque<CanFrame>,
    stats: LinkStats,
}

/// Markers tried before a request is given up.
const TRIES: u8 = 2;
/// Repeats of a request that the drive refused for its checksum.
const REJECTIONS: u8 = 2;
/// How long a request is awaited after its owner gave it up.
const PATIENCE: Span = Span::from_millis(50);

impl Link {
    pub fn new(codec: Codec) -> Self {
        Self {
            codec,
            pairing: Pairing::default(),
            line: Line::InStep,
            job: None,
            done: None,
            marker: Address::default(),
            heard: false,
            hurry: false,
            last_id: 0,
            frames: VecDeque::new(),
            stats: LinkStats::default(),
        }
    }

    /// Asks; replaces whatever was asked before.
    pub fn submit(&mut self, request: Request) {
        self.done = None;
        self.job = Some(Job::new(request));
    }

    /// The answer, once.
    pub fn take(&mut self) -> Option<Result<Answered, Lost>> {
        self.done.take()
    }

    /// The owner of the request went away. What is already on the wire will still be answered and is not forgotten.
    pub fn abandon(&mut self) {
        self.job = None;
        self.done = None;
        self.hurry = true;
    }

    pub fn stats(&self) -> LinkStats {
        self.stats
    }

    /// A frame of the bus that is no answer to this client, oldest first.
    pub fn take_frame(&mut self) -> Option<CanFrame> {
        self.frames.pop_front()
    }

    /// When something has to happen without input.
    pub fn deadline(&self) -> Option<Stamp<Host>> {
        let line = match self.line {
            Line::Asked { deadline } | Line::Marker { deadline, .. } => Some(deadline),
            Line::InStep | Line::OutOfStep { .. } => None,
        };
        let last_call = self.job.and_then(|job| job.last_call());
        [line, last_call, self.codec.deadline()]
            .into_iter()
            .flatten()
            .min()
    }

    /// The next frame to write, if one is due.
    pub fn transmit(&mut self, now: Stamp<Host>) -> Option<Vec<u8>> {
        self.expire(now);
        if let Some(out) = self.codec.outgoing(now) {
            if out.is_body {
                self.pairing.restamp(self.last_id, now);
            }
            return Some(out.bytes);
        }
        let job = self.job.as_mut()?;
        job.first.get_or_insert(now);
        let job = *job;
        let out_of_step = matches!(self.line, Line::OutOfStep { .. } | Line::Marker { .. });
        if job.request.urgent && !job.hastened && out_of_step {
            let Request {
                address, access, ..
            } = job.request;
            if let Some(bytes) = self.codec.shout(address, access, now) {
                return Some(self.shouted(bytes));
            }
        }
        if !self.codec.is_ready() {
            return None;
        }
        match self.line {
            Line::InStep => {
                self.line = Line::Asked {
                    deadline: now.saturating_add(job.request.timeout),
                };
                self.hurry = false;
                Some(self.send_job(now, true))
            }
            Line::OutOfStep { .. } | Line::Marker { .. } if job.request.urgent && !job.hastened => {
                Some(self.send_job(now, false))
            }
            Line::OutOfStep { markers } => {
                self.line = Line::Marker {
                    markers: markers.saturating_add(1),
                    deadline: now.saturating_add(job.request.marker_timeout),
                };
                Some(self.send_marker(now, job.request.marker_timeout))
            }
            Line::Asked { .. } | Line::Marker { .. } => None,
        }
    }

    /// Takes bytes from the port; on CAN whole frames.
    pub fn input(&mut self, bytes: &[u8], now: Stamp<Host>) {
        for piece in bytes.chunks(self.codec.piece()) {
            match self.codec.push(piece, now) {
                None => {}
                Some(Decoded::Reply(reply)) => self.reply(&reply, now),
                Some(Decoded::Refused) => self.refused(now),
                Some(Decoded::Bus(frame)) => self.frames.push_back(frame),
                Some(Decoded::Foreign) => self.stats.foreign += 1,
                Some(Decoded::Noise) => self.stats.damaged += 1,
                Some(Decoded::Damaged) => self.damaged(now),
            }
        }
    }

    /// Acts on deadlines that have passed.
    pub fn expire(&mut self, now: Stamp<Host>) {
        self.codec.expire(now);
        if self.hurry {
            let soon = now.saturating_add(PATIENCE);
            if let Line::Asked { deadline } | Line::Marker { deadline, .. } = &mut self.line {
                *deadline = soon.min(*deadline);
            }
            self.hurry = false;
        }
        if let Some(job) = self.job
            && job.last_call().is_some_and(|end| end <= now)
        {
            self.lose_link(&job, now);
        }
        match self.line {
            Line::Asked { deadline } if deadline <= now => self.fall_out_of_step(false, now),
            Line::Marker { markers, deadline } if deadline <= now => self.silence(markers, now),
            _ => {}
        }
    }

    fn send_job(&mut self, now: Stamp<Host>, counts: bool) -> Vec<u8> {
        let Some(job) = self.job.as_mut() else {
            return Vec::new();
        };
        job.first.get_or_insert(now);
        job.hastened = true;
        job.attempts = job.attempts.saturating_add(u8::from(counts));
        let request = job.request;
        let frame = self.send(&request, now);
        if let Some(job) = self.job.as_mut() {
            job.id = Some(self.last_id);
        }
        frame
    }

    /// A request that may have been heard goes out again once the link is in step.
    fn shouted(&mut self, bytes: Vec<u8>) -> Vec<u8> {
        self.stats.requests += 1;
        if let Some(job) = self.job.as_mut() {
            job.hastened = true;
        }
        if let Line::Marker { .. } = self.line {
            self.line = Line::OutOfStep { markers: 0 };
        }
        bytes
    }

    fn send_marker(&mut self, now: Stamp<Host>, timeout: Span) -> Vec<u8> {
        let [(this, _), (other, _)] = MARKERS;
        self.marker = if self.marker == this { other } else { this };
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

    fn send(&mut self, request: &Request, now: Stamp<Host>) -> Vec<u8> {
        self.last_id += 1;
        self.stats.requests += 1;
        self.pairing.sent(Asked {
            address: request.address,
            access: request.access,
            at: now,
            id: self.last_id,
        });
        let deadline = now.saturating_add(request.timeout);
        self.codec
            .encode(request.address, request.access, request.width, deadline)
    }

    fn reply(&mut self, reply: &Reply, now: Stamp<Host>) {
        self.heard = true;
        match self.pairing.received(reply) {
            Paired::Stray => self.stats.strays += 1,
            Paired::Marker => self.still_coming(now),
            Paired::To(asked) if self.job.and_then(|job| job.id) == Some(asked.id) => {
                self.answer(asked, reply, now);
            }
            Paired::To(_) => {
                self.stats.strays += 1;
                self.still_coming(now);
            }
        }
        if self.line != Line::InStep && self.pairing.in_step() {
            self.back_in_step();
        }
    }

    /// An older answer came while a marker is awaited: the marker's is still to come, and gets its full time from here.
    fn still_coming(&mut self, now: Stamp<Host>) {
        if let (Line::Marker { markers, .. }, Some(job)) = (self.line, self.job) {
            self.line = Line::Marker {
                markers,
                deadline: now.saturating_add(job.request.marker_timeout),
            };
        }
    }

    fn answer(&mut self, asked: Asked, reply: &Reply, now: Stamp<Host>) {
        self.stats.answers += 1;
        if let Some(job) = self.job.as_mut()
            && reply.error == CommError::CRC
            && job.rejected < REJECTIONS
        {
            // It was not carried out, so this attempt does not count.
            job.rejected += 1;
            job.attempts = job.attempts.saturating_sub(1);
            job.id = None;
            return;
        }
        self.job = None;
        self.done = Some(Ok(Answered {
            reply: *reply,
            request: asked.at,
            answer: now,
        }));
    }

    fn damaged(&mut self, now: Stamp<Host>) {
        self.stats.damaged += 1;
        self.heard = true;
        // The frame may have been our answer: no use in waiting for the timeout.
        if matches!(self.line, Line::Asked { .. }) {
            self.fall_out_of_step(true, now);
            return;
        }
        self.codec.give_up(now);
        if let (Line::Marker { markers, .. }, false) = (self.line, self.codec.is_ready()) {
            // A dialogue that broke off has no answer any more.
            self.silence(markers, now);
        }
    }

    /// The unit did not take what was sent. As the refusal may be an older one's, the line is out of step.
    fn refused(&mut self, now: Stamp<Host>) {
        self.heard = true;
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
        if job.rejected < REJECTIONS {
            // It was not carried out, so this attempt does not count.
            job.rejected += 1;
            job.attempts = job.attempts.saturating_sub(1);
        } else {
            let attempts = job.attempts.saturating_add(job.rejected);
            self.job = None;
            self.done = Some(Err(Lost::Handshake { attempts }));
        }
    }

    fn fall_out_of_step(&mut self, damaged: bool, now: Stamp<Host>) {
        self.stats.lost += 1;
        self.heard = false;
        self.codec.give_up(now);
        if let Some(job) = self.job.as_mut() {
            job.damaged = damaged;
            job.hastened = false;
        }
        self.line = Line::OutOfStep { markers: 0 };
    }

    /// A marker was not answered.
    fn silence(&mut self, markers: u8, now: Stamp<Host>) {
        self.stats.lost += 1;
        self.codec.give_up(now);
        if markers < TRIES {
            self.line = Line::OutOfStep { markers };
            return;
        }
        self.line = Line::OutOfStep { markers: 0 };
        let Some(job) = self.job else {
            return;
        };
        if self.heard {
            self.job = None;
            self.done = Some(Err(Lost::Answer {
                attempts: job.attempts.max(1),
                damaged: job.damaged,
            }));
        } else {
            self.lose_link(&job, now);
        }
    }

    fn lose_link(&mut self, job: &Job, now: Stamp<Host>) {
        self.job = None;
        if let Line::Asked { .. } = self.line {
            self.fall_out_of_step(false, now);
        }
        self.done = Some(Err(Lost::Link {
            silent: now.saturating_since(job.first.unwrap_or(now)),
        }));
    }

    fn back_in_step(&mut self) {
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
