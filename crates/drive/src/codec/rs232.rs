//! The master's side of an EPOS2 RS232 dialogue: opcode, `O`, body, `O`; then `00`, `O`, answer, `O` (Communication Guide,
//! "RS232 Communication").
//!
//! A dialogue that went wrong leaves the unit anywhere in it. It is brought back by `F`s: where the unit awaits a
//! handshake they refuse, where it awaits the rest of a body they fill it up to a checksum that cannot hold, and where it awaits an
//! opcode they are none, which it refuses in turn. Then the line must be quiet for a while, so that nothing said before is taken for
//! an answer to what comes next. The guide itself only promises that the unit forgets an unfinished frame after 500 ms of
//! silence, and what it makes of an unknown opcode it does not say; so where a unit stays silent after two of them the line is
//! left silent for as long as the guide says.
//!
//! What must not wait, a stop on a line that does not answer, is shouted: flush, opcode, body and both handshakes in one go. A unit
//! that hears but cannot be heard carries it out.

use std::collections::VecDeque;

use protocol::epos2::Frame;
use protocol::epos2::rs232::{self, BodyDecoder, FAILED, FRAME_TIMEOUT_MS, OKAY};
use units::{Host, Span, Stamp};

use super::{Decoded, Outgoing, decoded};

/// The master's side.
#[derive(Clone, Debug)]
pub(super) struct Dialogue {
    turn: Turn,
    body: Vec<u8>,
    out: VecDeque<Outgoing>,
    deadline: Stamp<Host>,
    /// What dialogues given up one after the other cost.
    failures: u32,
    /// The unit has said something in this one.
    heard: bool,
}

#[derive(Clone, Debug)]
enum Turn {
    /// Nothing is under way.
    Idle,
    /// The opcode is out, its `O` is awaited.
    Ready,
    /// The body is out, its `O` is awaited.
    Accepted,
    /// The answer's opcode is awaited.
    Lead,
    /// The answer is awaited.
    Answer(BodyDecoder),
    /// The line is to be quiet until this time.
    Quiet { span: Span, until: Stamp<Host> },
}

/// Longer than any answer's way through an adapter with a latency timer of 16 ms.
const QUIET: Span = Span::from_millis(20);
/// As long as the guide says, and some.
const SILENCE: Span = Span::from_millis(FRAME_TIMEOUT_MS as i64 + 20);
/// Fills the longest body that `F` announces itself: 71 words, after a length and before a checksum.
const FLUSH: usize = 1 + 2 * (FAILED as usize + 1) + 2;
/// The flush takes 38 ms at 38400 baud, the slowest any EPOS2 is delivered with.
const FLUSH_TIME: Span = Span::from_millis(40);
/// What failures in a row may cost before silence is tried: a unit that does not say anything may be one that flushes do not bring
/// back, while one that is heard damaged will be back when the line is well again.
const FAILURES: u32 = 8;
const UNHEARD: u32 = 4;
const DAMAGED: u32 = 1;

impl Dialogue {
    pub fn new() -> Self {
        Self {
            turn: Turn::Idle,
            body: Vec::new(),
            out: VecDeque::new(),
            deadline: Stamp::from_nanos(0),
            failures: 0,
            heard: false,
        }
    }

    pub fn is_idle(&self) -> bool {
        matches!(self.turn, Turn::Idle) && self.out.is_empty()
    }

    /// Begins; gives back the opcode. After `deadline` the dialogue gives itself up.
    pub fn begin(&mut self, frame: &Frame, deadline: Stamp<Host>) -> Vec<u8> {
        self.body.clear();
        // Every request has words.
        let _ = rs232::encode_body(frame, &mut self.body);
        self.turn = Turn::Ready;
        self.heard = false;
        self.deadline = deadline;
        vec![frame.opcode]
    }

    /// The whole of a request at once, to a unit that may be anywhere in a dialogue and may not be heard; what it says to that is
    /// passed over.
    pub fn shout(&mut self, frame: &Frame, now: Stamp<Host>) -> Vec<u8> {
        self.out.clear();
        let span = QUIET;
        let until = now.saturating_add(FLUSH_TIME).saturating_add(span);
        self.turn = Turn::Quiet { span, until };
        let mut bytes = vec![FAILED; FLUSH];
        bytes.push(frame.opcode);
        // Every request has words.
        let _ = rs232::encode_body(frame, &mut bytes);
        bytes.extend([OKAY; 2]);
        bytes
    }

    pub fn outgoing(&mut self, now: Stamp<Host>) -> Option<Outgoing> {
        let out = self.out.pop_front()?;
        if let Turn::Quiet { span, until } = &mut self.turn {
            // Quiet begins when the bytes are out.
            let wire = if out.bytes.len() > 1 {
                FLUSH_TIME
            } else {
                *span
            };
            *until = now.saturating_add(wire);
        }
        Some(out)
    }

    /// Takes a byte from the unit.
    pub fn push(&mut self, byte: u8, now: Stamp<Host>) -> Option<Decoded> {
        self.heard = true;
        match (&mut self.turn, byte) {
            (Turn::Idle, _) => Some(Decoded::Noise),
            (Turn::Quiet { span, until }, _) => {
                *until = now.saturating_add(*span);
                Some(Decoded::Step)
            }
            (Turn::Ready, OKAY) => {
                self.turn = Turn::Accepted;
                self.out.push_back(Outgoing {
                    bytes: std::mem::take(&mut self.body),
                    is_body: true,
                });
                Some(Decoded::Step)
            }
            (Turn::Accepted, OKAY) => {
                self.turn = Turn::Lead;
                Some(Decoded::Step)
            }
            (Turn::Lead, Frame::ANSWER) => {
                self.turn = Turn::Answer(BodyDecoder::new(Frame::ANSWER));
                self.say(OKAY);
                Some(Decoded::Step)
            }
            (Turn::Answer(decoder), _) => {
                let frame = decoder.push(byte)?;
                if frame.is_ok() {
                    self.turn = Turn::Idle;
                    self.failures = 0;
                    self.say(OKAY);
                } else {
                    self.hush(now);
                    self.say(FAILED);
                }
                Some(decoded(&frame))
            }
            (Turn::Ready | Turn::Accepted, FAILED) => {
                // A unit that was elsewhere in the dialogue may refuse each byte of a body.
                self.hush(now);
                Some(Decoded::Refused)
            }
            (Turn::Ready | Turn::Accepted | Turn::Lead, _) => Some(Decoded::Damaged),
        }
    }

    /// Forgets the dialogue under way and brings the unit back to its beginning.
    pub fn give_up(&mut self, now: Stamp<Host>) {
        if matches!(self.turn, Turn::Idle | Turn::Quiet { .. }) {
            return;
        }
        let cost = if self.heard { DAMAGED } else { UNHEARD };
        self.failures = self.failures.saturating_add(cost);
        self.out.clear();
        let span = if self.failures > FAILURES {
            SILENCE
        } else {
            self.out.push_back(Outgoing {
                bytes: vec![FAILED; FLUSH],
                is_body: false,
            });
            QUIET
        };
        let until = now.saturating_add(span);
        self.turn = Turn::Quiet { span, until };
    }

    pub fn deadline(&self) -> Option<Stamp<Host>> {
        match self.turn {
            Turn::Idle => None,
            Turn::Quiet { until, .. } => Some(until),
            Turn::Ready | Turn::Accepted | Turn::Lead | Turn::Answer(_) => Some(self.deadline),
        }
    }

    pub fn expire(&mut self, now: Stamp<Host>) {
        match self.turn {
            // Quiet begins when the flush is out.
            Turn::Quiet { until, .. } if until <= now && self.out.is_empty() => {
                self.turn = Turn::Idle;
            }
            Turn::Idle | Turn::Quiet { .. } => {}
            _ if self.deadline <= now => self.give_up(now),
            _ => {}
        }
    }

    /// The unit awaits an opcode, but may not have said all yet.
    fn hush(&mut self, now: Stamp<Host>) {
        let until = now.saturating_add(QUIET);
        self.turn = Turn::Quiet { span: QUIET, until };
    }

    fn say(&mut self, byte: u8) {
        self.out.push_back(Outgoing {
            bytes: vec![byte],
            is_body: false,
        });
    }
}
