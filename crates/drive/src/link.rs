//! One question at a time over a link that may lose, delay or corrupt answers.
//!
//! A request goes out, its answer comes back or is lost. After a loss the link is out of step until a marker has been answered
//! (see [`crate::pairing`]); only then is the read repeated or the failure reported, so that a late answer is never taken for
//! another's. Writes are not repeated by themselves, as nobody knows whether the lost one was carried out; but a request
//! that the drive itself refused for its checksum was not, and goes out again.
//! What is asked, and what a failure means for the motion, is decided elsewhere.

mod patience;
mod request;
mod resync;

use std::collections::VecDeque;

use protocol::canopen::CanFrame;
use protocol::epos2::CommError;
use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use crate::codec::{Codec, Decoded, Reply};
use crate::pairing::{Asked, Paired, Pairing};
use patience::Patience;
use request::Job;

pub use request::LinkStats;
pub(crate) use request::{Answered, Lost, Request};

/// The state of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Line {
    /// Nothing is under way.
    InStep,
    /// A request is under way, awaited until the deadline, and no longer than the limit.
    Asked {
        deadline: Stamp<Host>,
        limit: Stamp<Host>,
    },
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
    patience: Patience,
    /// The request under way has no owner any more: do not wait long for it.
    hurry: bool,
    last_id: u64,
    /// Frames of the bus that are no answers to this client.
    frames: VecDeque<CanFrame>,
    stats: LinkStats,
}

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
            patience: Patience::default(),
            hurry: false,
            last_id: 0,
            frames: VecDeque::new(),
            stats: LinkStats::default(),
        }
    }

    /// Asks; replaces whatever was asked before.
    pub fn submit(&mut self, request: Request) {
        self.done = None;
        self.patience = Patience::default();
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

    /// Bytes of the longest segment.
    pub fn segment_len(&self) -> usize {
        self.codec.segment_len()
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
            Line::Asked { deadline, .. } | Line::Marker { deadline, .. } => Some(deadline),
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
        if out_of_step {
            self.patience.wait(now);
        }
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
                let limit = now.saturating_add(job.request.timeout);
                self.line = Line::Asked {
                    deadline: limit,
                    limit,
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
                None => self.began(now),
                Some(Decoded::Step) => {}
                Some(Decoded::Reply(reply)) => self.reply(&reply, now),
                Some(Decoded::Refused) => self.refused(now),
                Some(Decoded::Bus(frame)) => self.frames.push_back(frame),
                Some(Decoded::Foreign) => self.stats.foreign += 1,
                Some(Decoded::Noise) => {
                    self.stats.damaged += 1;
                    self.patience.hear(now);
                }
                Some(Decoded::Damaged) => self.damaged(now),
            }
        }
    }

    /// Acts on deadlines that have passed.
    pub fn expire(&mut self, now: Stamp<Host>) {
        self.codec.expire(now);
        if self.hurry {
            let soon = now.saturating_add(PATIENCE);
            if let Line::Asked { deadline, .. } | Line::Marker { deadline, .. } = &mut self.line {
                *deadline = soon.min(*deadline);
            }
            self.hurry = false;
        }
        if let Some(job) = self.job
            && job.last_call().is_some_and(|end| end <= now)
        {
            self.last_call(&job, now);
        }
        match self.line {
            Line::Asked { deadline, .. } if deadline <= now => self.fall_out_of_step(false, now),
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
        let paired = self.pairing.received(reply);
        match paired {
            Paired::Stray => {
                self.stats.strays += 1;
                self.patience.hear(now);
            }
            Paired::Marker(_) | Paired::To(_) => self.patience.is_well(),
        }
        match paired {
            Paired::Stray => {}
            Paired::Marker(marker) => self.passed(marker, now),
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

    fn answer(&mut self, asked: Asked, reply: &Reply, now: Stamp<Host>) {
        self.stats.answers += 1;
        if let Some(job) = self.job.as_mut()
            && reply.error == CommError::CRC
            && job.may_be_rejected(now)
        {
            // It was not carried out, so this attempt does not count.
            job.rejected = job.rejected.saturating_add(1);
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
}
