//! One question at a time over a link that may lose, delay or corrupt answers.
//!
//! A request goes out, its answer comes back or is lost. After a loss the link is out of step until a marker has been answered
//! (see [`crate::pairing`]); only then is the read repeated or the failure reported, so that a late answer is never taken for
//! another's. Writes are not repeated by themselves, as nobody knows whether the lost one was carried out; but a request
//! that the drive itself refused for its checksum was not, and goes out again.
//! What is asked, and what a failure means for the motion, is decided elsewhere.

use protocol::epos2::CommError;
use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use crate::codec::{Codec, Decoded, Reply};
use crate::pairing::{Access, Asked, MARKERS, Paired, Pairing};

/// A question to the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Request {
    pub address: Address,
    pub access: Access,
    /// How long each attempt waits.
    pub timeout: Span,
    /// How often it is repeated after a lost answer.
    pub retries: u8,
    /// Goes out even while the link is out of step, and again once it is in step: for what must not wait.
    pub urgent: bool,
}

/// An answer, with the times at which the question was handed out and the answer read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

#[derive(Clone, Copy, Debug)]
struct Job {
    request: Request,
    /// The latest copy on the wire.
    id: Option<u64>,
    attempts: u8,
    rejected: u8,
    damaged: bool,
    first: Option<Stamp<Host>>,
    hastened: bool,
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
            stats: LinkStats::default(),
        }
    }

    /// Asks; replaces whatever was asked before.
    pub fn submit(&mut self, request: Request) {
        self.done = None;
        self.job = Some(Job {
            request,
            id: None,
            attempts: 0,
            rejected: 0,
            damaged: false,
            first: None,
            hastened: false,
        });
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

    /// When something has to happen without input.
    pub fn deadline(&self) -> Option<Stamp<Host>> {
        match self.line {
            Line::Asked { deadline } | Line::Marker { deadline, .. } => Some(deadline),
            Line::InStep | Line::OutOfStep { .. } => None,
        }
    }

    /// The next frame to write, if one is due.
    pub fn transmit(&mut self, now: Stamp<Host>) -> Option<Vec<u8>> {
        self.expire(now);
        let job = self.job?;
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
                    deadline: now.saturating_add(job.request.timeout),
                };
                Some(self.send_marker(now))
            }
            Line::Asked { .. } | Line::Marker { .. } => None,
        }
    }

    /// Takes bytes from the port.
    pub fn input(&mut self, bytes: &[u8], now: Stamp<Host>) {
        for &byte in bytes {
            match self.codec.push(byte) {
                None => {}
                Some(Decoded::Reply(reply)) => self.reply(reply, now),
                Some(Decoded::Foreign) => self.stats.foreign += 1,
                Some(Decoded::Damaged) => self.damaged(),
            }
        }
    }

    /// Acts on deadlines that have passed.
    pub fn expire(&mut self, now: Stamp<Host>) {
        if let (true, Line::Asked { deadline }) = (self.hurry, self.line) {
            self.hurry = false;
            self.line = Line::Asked {
                deadline: deadline.min(now.saturating_add(PATIENCE)),
            };
        }
        match self.line {
            Line::Asked { deadline } if deadline <= now => self.fall_out_of_step(false),
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
        let (address, access) = (job.request.address, job.request.access);
        let frame = self.send(address, access, now);
        if let Some(job) = self.job.as_mut() {
            job.id = Some(self.last_id);
        }
        frame
    }

    fn send_marker(&mut self, now: Stamp<Host>) -> Vec<u8> {
        let [(this, _), (other, _)] = MARKERS;
        self.marker = if self.marker == this { other } else { this };
        self.send(self.marker, Access::Read, now)
    }

    fn send(&mut self, address: Address, access: Access, now: Stamp<Host>) -> Vec<u8> {
        self.last_id += 1;
        self.stats.requests += 1;
        self.pairing.sent(Asked {
            address,
            access,
            at: now,
            id: self.last_id,
        });
        self.codec.encode(address, access)
    }

    fn reply(&mut self, reply: Reply, now: Stamp<Host>) {
        self.heard = true;
        match self.pairing.received(&reply) {
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
                deadline: now.saturating_add(job.request.timeout),
            };
        }
    }

    fn answer(&mut self, asked: Asked, reply: Reply, now: Stamp<Host>) {
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
            reply,
            request: asked.at,
            answer: now,
        }));
    }

    fn damaged(&mut self) {
        self.stats.damaged += 1;
        self.heard = true;
        // The frame may have been our answer: no use in waiting for the timeout.
        if matches!(self.line, Line::Asked { .. }) {
            self.fall_out_of_step(true);
        }
    }

    fn fall_out_of_step(&mut self, damaged: bool) {
        self.stats.lost += 1;
        self.heard = false;
        if let Some(job) = self.job.as_mut() {
            job.damaged = damaged;
            job.hastened = false;
        }
        self.line = Line::OutOfStep { markers: 0 };
    }

    /// A marker was not answered.
    fn silence(&mut self, markers: u8, now: Stamp<Host>) {
        self.stats.lost += 1;
        if markers < TRIES {
            self.line = Line::OutOfStep { markers };
            return;
        }
        self.line = Line::OutOfStep { markers: 0 };
        if let Some(job) = self.job.take() {
            let first = job.first.unwrap_or(now);
            self.done = Some(Err(if self.heard {
                Lost::Answer {
                    attempts: job.attempts.max(1),
                    damaged: job.damaged,
                }
            } else {
                Lost::Link {
                    silent: now.saturating_since(first),
                }
            }));
        }
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
