//! The master's side of an EPOS2 RS232 dialogue: opcode, `O`, body, `O`; then `00`, `O`, answer,
//! `O` (Communication Guide, "RS232 Communication").
//!
//! After a failure the drive may be anywhere in the dialogue. A flush of `F` bytes resets it: as a
//! handshake `F` refuses, in a body it completes a frame with a wrong checksum, as an opcode it is
//! unknown and refused. The line must then stay quiet for a while, so that no stale byte is taken
//! for an answer. The guide itself only promises that the drive drops an incomplete frame after 500
//! ms of silence and does not describe unknown opcodes. If a drive stays silent after two flushes,
//! the master therefore waits for the guide's silence instead.
//!
//! A request that must not wait, a stop on a line without answers, is sent unsolicited: flush,
//! opcode, body and both handshakes at once. A drive whose answers are lost still executes it.

use std::collections::VecDeque;

use protocol::epos2::SerialFrame;
use protocol::epos2::rs232::{self, BodyDecoder, FAILED, FRAME_TIMEOUT_MS, OKAY};
use units::{Host, Span, Stamp};

use super::{DecodedFrame, Outgoing, decode_serial};

/// The master's side of the dialogue.
#[derive(Clone, Debug)]
pub(super) struct Rs232Master {
    state: DialogueState,
    body: Vec<u8>,
    out: VecDeque<Outgoing>,
    deadline: Stamp<Host>,
    /// Accumulated cost of consecutive failures.
    failures: u32,
    /// The drive has sent a byte in this dialogue.
    has_input: bool,
}

#[derive(Clone, Debug)]
enum DialogueState {
    Idle,
    /// Opcode sent, awaiting its `O`.
    OpcodeSent,
    /// Body sent, awaiting its `O`.
    BodySent,
    /// Awaiting the answer's opcode.
    AwaitAnswer,
    /// Receiving the answer.
    Answer(BodyDecoder),
    /// The line must stay quiet until this time; each byte restarts the span.
    Quiet {
        span: Span,
        until: Stamp<Host>,
    },
}

/// Longer than an answer takes through a serial adapter with a latency timer of 16 ms.
const QUIET: Span = Span::from_millis(20);
/// The drive's frame timeout plus 20 ms.
const SILENCE: Span = Span::from_millis(FRAME_TIMEOUT_MS as i64 + 20);
/// Completes the longest body that `F` as a length announces: length, 71 words, checksum.
const FLUSH_LEN: usize = 1 + 2 * (FAILED as usize + 1) + 2;
/// 145 bytes of 10 bits take 38 ms at 38400 baud, the slowest factory setting of an EPOS2.
const FLUSH_TIME: Span = Span::from_millis(40);
/// Cost of consecutive failures above which silence replaces the flush.
const MAX_FAILURE_COST: u32 = 8;
/// Cost of a dialogue without any byte from the drive: a flush may not reset it.
const COST_SILENT: u32 = 4;
/// Cost of a dialogue with damaged bytes: the drive responds once the line is good again.
const COST_DAMAGED: u32 = 1;

impl Rs232Master {
    pub fn new() -> Self {
        Self {
            state: DialogueState::Idle,
            body: Vec::new(),
            out: VecDeque::new(),
            deadline: Stamp::from_nanos(0),
            failures: 0,
            has_input: false,
        }
    }

    pub fn is_idle(&self) -> bool {
        matches!(self.state, DialogueState::Idle) && self.out.is_empty()
    }

    /// Starts a dialogue that ends at `deadline`; returns the opcode.
    pub fn begin(&mut self, frame: &SerialFrame, deadline: Stamp<Host>) -> Vec<u8> {
        self.body.clear();
        // Cannot fail: every request has words.
        let _ = rs232::encode_body(frame, &mut self.body);
        self.state = DialogueState::OpcodeSent;
        self.has_input = false;
        self.deadline = deadline;
        vec![frame.opcode]
    }

    /// Encodes a complete request for a drive in an unknown state; the drive's bytes are discarded.
    pub fn send_unsolicited(&mut self, frame: &SerialFrame, now: Stamp<Host>) -> Vec<u8> {
        self.out.clear();
        self.state = DialogueState::Quiet {
            span: QUIET,
            until: now.saturating_add(FLUSH_TIME).saturating_add(QUIET),
        };
        let mut bytes = vec![FAILED; FLUSH_LEN];
        bytes.push(frame.opcode);
        // Cannot fail: every request has words.
        let _ = rs232::encode_body(frame, &mut bytes);
        bytes.extend([OKAY; 2]);
        bytes
    }

    pub fn outgoing(&mut self, now: Stamp<Host>) -> Option<Outgoing> {
        let out = self.out.pop_front()?;
        if let DialogueState::Quiet { span, until } = &mut self.state {
            // The quiet span starts after the last byte is on the line.
            let wait = if out.bytes.len() > 1 {
                FLUSH_TIME
            } else {
                *span
            };
            *until = now.saturating_add(wait);
        }
        Some(out)
    }

    /// Processes a byte from the drive.
    pub fn push(&mut self, byte: u8, now: Stamp<Host>) -> Option<DecodedFrame> {
        use DialogueState::{Answer, AwaitAnswer, BodySent, Idle, OpcodeSent, Quiet};
        self.has_input = true;
        match (&mut self.state, byte) {
            (Idle, _) => Some(DecodedFrame::Noise),
            (Quiet { span, until }, _) => {
                *until = now.saturating_add(*span);
                Some(DecodedFrame::Handshake)
            }
            (OpcodeSent, OKAY) => {
                self.state = BodySent;
                self.out.push_back(Outgoing {
                    bytes: std::mem::take(&mut self.body),
                    is_body: true,
                });
                Some(DecodedFrame::Handshake)
            }
            (BodySent, OKAY) => {
                self.state = AwaitAnswer;
                Some(DecodedFrame::Handshake)
            }
            (AwaitAnswer, SerialFrame::ANSWER) => {
                self.state = Answer(BodyDecoder::new(SerialFrame::ANSWER));
                self.send(vec![OKAY]);
                Some(DecodedFrame::Handshake)
            }
            (Answer(decoder), _) => {
                let frame = decoder.push(byte)?;
                if frame.is_ok() {
                    self.state = Idle;
                    self.failures = 0;
                    self.send(vec![OKAY]);
                } else {
                    self.drain_stale(now);
                    self.send(vec![FAILED]);
                }
                Some(decode_serial(&frame))
            }
            (OpcodeSent | BodySent, FAILED) => {
                // A desynchronised drive may refuse each byte of a body.
                self.drain_stale(now);
                Some(DecodedFrame::Refused)
            }
            (OpcodeSent | BodySent | AwaitAnswer, _) => Some(DecodedFrame::Damaged),
        }
    }

    /// Cancels the dialogue in progress and resets the drive.
    pub fn cancel(&mut self, now: Stamp<Host>) {
        if matches!(
            self.state,
            DialogueState::Idle | DialogueState::Quiet { .. }
        ) {
            return;
        }
        let cost = if self.has_input {
            COST_DAMAGED
        } else {
            COST_SILENT
        };
        self.failures = self.failures.saturating_add(cost);
        self.out.clear();
        let span = if self.failures > MAX_FAILURE_COST {
            SILENCE
        } else {
            self.send(vec![FAILED; FLUSH_LEN]);
            QUIET
        };
        let until = now.saturating_add(span);
        self.state = DialogueState::Quiet { span, until };
    }

    pub fn deadline(&self) -> Option<Stamp<Host>> {
        match self.state {
            DialogueState::Idle => None,
            DialogueState::Quiet { until, .. } => Some(until),
            _ => Some(self.deadline),
        }
    }

    /// Moves the deadline by a time in which the host read no input.
    pub fn postpone(&mut self, delay: Span) {
        self.deadline = self.deadline.saturating_add(delay);
    }

    pub fn expire(&mut self, now: Stamp<Host>) {
        match self.state {
            // The quiet span starts after the flush is sent.
            DialogueState::Quiet { until, .. } if until <= now && self.out.is_empty() => {
                self.state = DialogueState::Idle;
            }
            DialogueState::Idle | DialogueState::Quiet { .. } => {}
            _ if self.deadline <= now => self.cancel(now),
            _ => {}
        }
    }

    /// Discards input until the line is quiet: the drive awaits an opcode but may still be sending.
    fn drain_stale(&mut self, now: Stamp<Host>) {
        let until = now.saturating_add(QUIET);
        self.state = DialogueState::Quiet { span: QUIET, until };
    }

    fn send(&mut self, bytes: Vec<u8>) {
        let is_body = false;
        self.out.push_back(Outgoing { bytes, is_body });
    }
}
