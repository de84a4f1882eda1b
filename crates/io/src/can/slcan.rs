//! A CAN bus behind an SLCAN adapter on a serial port (CANUSB, CANable and others).
//!
//! Some adapters answer commands and some do not; both work. A received frame has the time of the
//! read that completed its line. The adapter's own time stamps, in milliseconds, stay disabled.

use std::collections::VecDeque;

use protocol::canopen::CanFrame;
use protocol::canopen::slcan::{Bitrate, Line, ReplyDecoder, SlcanCommand, SlcanReply};
use units::{Host, Span, Stamp};

use super::{CanError, CanPort};
use crate::port::Port;

/// Time that an adapter has to answer a command.
const ANSWER_TIMEOUT: Span = Span::from_millis(200);
/// After the close command: silence that ends the draining of earlier traffic, and its longest
/// duration.
const QUIET: Span = Span::from_millis(50);
const DRAIN_TIMEOUT: Span = Span::from_millis(300);
/// Interval at which an answering adapter is queried for lost frames. A missing answer is no error.
const STATUS_PERIOD: Span = Span::from_secs(1);
/// Flags of lost frames (CANUSB manual, command F): bit 0, receive queue full; bit 3, data overrun.
const LOST: u8 = 1 << 0 | 1 << 3;

/// An open channel of an adapter. Dropping it closes the channel.
#[derive(Debug)]
pub struct Slcan<P: Port> {
    port: P,
    decoder: ReplyDecoder,
    /// Decoded, but not yet processed.
    replies: VecDeque<(SlcanReply, Stamp<Host>)>,
    /// Received frames and refusals that the caller has not read.
    received: VecDeque<Result<(CanFrame, Stamp<Host>), CanError>>,
    answers: bool,
    /// Sent frames without an answer so far; meaningless if the adapter does not answer.
    unanswered: u32,
    noise: u64,
    status: StatusQuery,
    dropped: u64,
}

/// The query for the status flags.
#[derive(Debug, Default)]
struct StatusQuery {
    /// Time of the next query; `None`: never.
    next: Option<Stamp<Host>>,
    /// While a query is pending: answers to earlier frames that precede its answer.
    answers_before: Option<u32>,
}

impl<P: Port> Slcan<P> {
    /// Opens the adapter's channel: closes it, as another program may have left it open, sets the
    /// bit rate (the EPOS2's factory setting is 1 Mbit/s) and opens it. This takes 50 ms with an
    /// adapter that answers and half a second with one that does not.
    ///
    /// # Errors
    /// [`CanError::Refused`], [`CanError::Port`].
    pub fn open(port: P, bitrate: Bitrate) -> Result<Self, CanError> {
        let mut channel = Self {
            port,
            decoder: ReplyDecoder::new(),
            replies: VecDeque::new(),
            received: VecDeque::new(),
            answers: false,
            unanswered: 0,
            noise: 0,
            status: StatusQuery::default(),
            dropped: 0,
        };
        // The empty line ends a partial one. An adapter may refuse to close a closed channel.
        channel.send(&SlcanCommand::Empty)?;
        channel.send(&SlcanCommand::Close)?;
        channel.drain()?;
        channel.command(&SlcanCommand::Bitrate(bitrate))?;
        // Frames that arrived before the channel was closed.
        channel.replies.clear();
        channel.received.clear();
        channel.command(&SlcanCommand::Open)?;
        if channel.answers {
            channel.status.next = Some(channel.port.now().saturating_add(STATUS_PERIOD));
        }
        Ok(channel)
    }

    /// Lines that were neither frames nor answers: a sign of a wrong baud rate or lost bytes.
    #[must_use]
    pub const fn noise(&self) -> u64 {
        self.noise
    }

    fn since(&self, begin: Stamp<Host>) -> Span {
        self.port.now().saturating_since(begin)
    }

    /// Whether a status query is due; schedules the next one.
    fn is_status_due(&mut self) -> bool {
        let now = self.port.now();
        let due = self.status.next.is_some_and(|next| next <= now);
        if due {
            self.status = StatusQuery {
                next: Some(now.saturating_add(STATUS_PERIOD)),
                answers_before: Some(self.unanswered),
            };
        }
        due
    }

    fn send(&mut self, command: &SlcanCommand) -> Result<Stamp<Host>, CanError> {
        let mut line = Line::new();
        command.encode(&mut line);
        Ok(self.port.write_frame(&line)?)
    }

    /// Discards the adapter's output up to a silence after the close command.
    fn drain(&mut self) -> Result<(), CanError> {
        let begin = self.port.now();
        while self.since(begin) < DRAIN_TIMEOUT && self.receive(QUIET)? {
            while let Some((reply, _)) = self.replies.pop_front() {
                self.answers |= matches!(reply, SlcanReply::Done | SlcanReply::Refused);
            }
        }
        self.decoder = ReplyDecoder::new();
        self.noise = 0;
        Ok(())
    }

    /// Sends a command and waits for the answer, which some adapters omit.
    fn command(&mut self, command: &SlcanCommand) -> Result<(), CanError> {
        self.send(command)?;
        let begin = self.port.now();
        while self.since(begin) < ANSWER_TIMEOUT
            && self.receive(ANSWER_TIMEOUT - self.since(begin))?
        {
            while let Some((reply, host)) = self.replies.pop_front() {
                match reply {
                    SlcanReply::Done => {
                        self.answers = true;
                        return Ok(());
                    }
                    SlcanReply::Refused => {
                        return Err(CanError::Refused {
                            command: name(command),
                        });
                    }
                    // A node may send frames as soon as the channel is open.
                    reply => self.process(reply, host),
                }
            }
        }
        Ok(())
    }

    /// Reads the port once; returns whether bytes arrived within `timeout`.
    fn receive(&mut self, timeout: Span) -> Result<bool, CanError> {
        let mut buffer = [0; 512];
        let Some((length, host)) = self.port.read(&mut buffer, timeout)? else {
            return Ok(false);
        };
        for &byte in buffer.get(..length).unwrap_or_default() {
            match self.decoder.push(byte) {
                Some(Ok(reply)) => self.replies.push_back((reply, host)),
                Some(Err(_)) => self.noise += 1,
                None => {}
            }
        }
        Ok(true)
    }

    /// Processes a reply on an open channel.
    fn process(&mut self, reply: SlcanReply, host: Stamp<Host>) {
        match reply {
            SlcanReply::Received { frame, .. } => self.received.push_back(Ok((frame, host))),
            SlcanReply::Done | SlcanReply::Sent | SlcanReply::SentExtended => self.frame_answered(),
            // Reading clears the flags, so each set flag is a new loss, of an unknown number of
            // frames.
            SlcanReply::Status(flags) => {
                self.status.answers_before = None;
                self.dropped += u64::from(flags & LOST != 0);
            }
            // An adapter without status flags is not queried again.
            SlcanReply::Refused if self.status.answers_before == Some(0) => {
                self.status = StatusQuery::default()
            }
            SlcanReply::Refused if self.answers && self.unanswered > 0 => {
                self.frame_answered();
                self.received.push_back(Err(CanError::NotSent));
            }
            SlcanReply::Refused | SlcanReply::Unknown(_) => self.noise += 1,
            // Answers to commands that are never sent.
            SlcanReply::Version(_) | SlcanReply::SerialNumber(_) => {}
        }
    }

    /// Counts the answer to the oldest frame: answers arrive in the order of frames.
    fn frame_answered(&mut self) {
        self.unanswered = self.unanswered.saturating_sub(1);
        if let Some(answers_before) = &mut self.status.answers_before {
            *answers_before = answers_before.saturating_sub(1);
        }
    }
}

impl<P: Port> CanPort for Slcan<P> {
    fn write_frame(&mut self, frame: &CanFrame) -> Result<Stamp<Host>, CanError> {
        let host = self.send(&SlcanCommand::Transmit(*frame))?;
        self.unanswered = self.unanswered.saturating_add(1);
        if self.is_status_due() {
            // This frame is sent; a failing port reports the error with the next one.
            drop(self.send(&SlcanCommand::Status));
        }
        Ok(host)
    }

    fn read(&mut self, timeout: Span) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError> {
        let begin = self.port.now();
        let mut left = timeout;
        loop {
            while let Some((reply, host)) = self.replies.pop_front() {
                self.process(reply, host);
            }
            if let Some(received) = self.received.pop_front() {
                return received.map(Some);
            }
            // The bytes held no frame: continue for the rest of the time.
            let is_over = left <= Span::ZERO && left != timeout;
            if is_over || !self.receive(left)? {
                return Ok(None);
            }
            left = timeout - self.since(begin);
        }
    }

    /// Number of losses that the adapter reported, a lower bound of frames.
    fn dropped(&self) -> u64 {
        self.dropped
    }

    fn name(&self) -> &str {
        "SLCAN"
    }

    fn now(&self) -> Stamp<Host> {
        self.port.now()
    }
}

impl<P: Port> Drop for Slcan<P> {
    fn drop(&mut self) {
        // The port may be disconnected, which is no error here.
        drop(self.send(&SlcanCommand::Close));
    }
}

/// The command as sent.
fn name(command: &SlcanCommand) -> String {
    let mut line = Line::new();
    command.encode(&mut line);
    String::from_utf8_lossy(&line).trim_end().to_owned()
}

#[cfg(test)]
mod tests;
