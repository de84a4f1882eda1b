//! A CAN bus behind an adapter on a serial port that speaks SLCAN (CANUSB, CANable and the like).
//!
//! Adapters differ in what they answer; those that answer nothing are taken at their silence. A
//! received frame's time is that of the read which brought its line: an adapter's own time stamps
//! are milliseconds, and stay switched off.

use std::collections::VecDeque;

use protocol::canopen::CanFrame;
use protocol::canopen::slcan::{Bitrate, Command, Line, Reply, ReplyDecoder};
use units::{Host, Span, Stamp};

use super::{CanError, CanPort};
use crate::port::Port;

/// How long an adapter is given to answer a command.
const ANSWER_TIMEOUT: Span = Span::from_millis(200);
/// After closing: how long nothing comes until what was under way is taken to be over, and how long
/// that may take.
const QUIET: Span = Span::from_millis(50);
const DRAIN_TIMEOUT: Span = Span::from_millis(300);
/// How often an adapter that answers is asked whether frames were lost in it. An answer that does
/// not come is not missed.
const STATUS_PERIOD: Span = Span::from_secs(1);
/// What tells of lost frames in its answer (CANUSB manual, command F): bit 0, its receive queue was
/// full; bit 3, its controller was overrun.
const LOST: u8 = 1 << 0 | 1 << 3;

/// An open channel of an adapter. Dropping it closes the channel.
#[derive(Debug)]
pub struct Slcan<P: Port> {
    port: P,
    decoder: ReplyDecoder,
    /// Decoded and not looked at.
    replies: VecDeque<(Reply, Stamp<Host>)>,
    /// Not fetched: frames, and frames that the adapter refused.
    waiting: VecDeque<Result<(CanFrame, Stamp<Host>), CanError>>,
    answers: bool,
    /// Frames sent whose answer has not come; without meaning where the adapter does not answer.
    unanswered: u32,
    noise: u64,
    status: Status,
    dropped: u64,
}

/// The question for the status flags.
#[derive(Debug, Default)]
struct Status {
    /// When it is due; `None`: never.
    next: Option<Stamp<Host>>,
    /// Asked: frames sent before it whose answers come first.
    behind: Option<u32>,
}

impl<P: Port> Slcan<P> {
    /// Opens the adapter's channel: closes it, as another program may have left it open, sets the
    /// bit rate (an EPOS2 has 1 Mbit/s from the factory) and opens it. Takes 50 ms with an adapter
    /// that answers, half a second with one that does not.
    ///
    /// # Errors
    /// [`CanError::Refused`], [`CanError::Port`].
    pub fn open(port: P, bitrate: Bitrate) -> Result<Self, CanError> {
        let mut channel = Self {
            port,
            decoder: ReplyDecoder::new(),
            replies: VecDeque::new(),
            waiting: VecDeque::new(),
            answers: false,
            unanswered: 0,
            noise: 0,
            status: Status::default(),
            dropped: 0,
        };
        // A line that was begun must not swallow the command. An adapter may refuse to close what
        // is closed.
        channel.send(&Command::Empty)?;
        channel.send(&Command::Close)?;
        channel.drain()?;
        channel.command(&Command::Bitrate(bitrate))?;
        // From before, if the channel was open against its will.
        channel.replies.clear();
        channel.waiting.clear();
        channel.command(&Command::Open)?;
        if channel.answers {
            channel.status.next = Some(channel.port.now().saturating_add(STATUS_PERIOD));
        }
        Ok(channel)
    }

    /// Whether the adapter answers commands. One that does not cannot say that it refuses a frame.
    #[must_use]
    pub const fn answers(&self) -> bool {
        self.answers
    }

    /// Lines so far that were neither frames nor answers: a sign of a wrong baud rate or of lost
    /// bytes.
    #[must_use]
    pub const fn noise(&self) -> u64 {
        self.noise
    }

    /// The port inside.
    pub const fn port(&self) -> &P {
        &self.port
    }

    fn since(&self, begin: Stamp<Host>) -> Span {
        self.port.now().saturating_since(begin)
    }

    /// Whether the adapter is to be asked for its status now; it is noted as asked.
    fn is_status_due(&mut self) -> bool {
        let now = self.port.now();
        let due = self.status.next.is_some_and(|next| next <= now);
        if due {
            self.status = Status {
                next: Some(now.saturating_add(STATUS_PERIOD)),
                behind: Some(self.unanswered),
            };
        }
        due
    }

    fn send(&mut self, command: &Command) -> Result<Stamp<Host>, CanError> {
        let mut line = Line::new();
        command.encode(&mut line);
        Ok(self.port.write_frame(&line)?)
    }

    /// Waits until the adapter has said what it had to say to the close command, and forgets it.
    fn drain(&mut self) -> Result<(), CanError> {
        let begin = self.port.now();
        while self.since(begin) < DRAIN_TIMEOUT && self.receive(QUIET)? {
            while let Some((reply, _)) = self.replies.pop_front() {
                self.answers |= matches!(reply, Reply::Done | Reply::Refused);
            }
        }
        self.decoder = ReplyDecoder::new();
        self.noise = 0;
        Ok(())
    }

    /// Sends a command and waits for its answer; some adapters give none.
    fn command(&mut self, command: &Command) -> Result<(), CanError> {
        self.send(command)?;
        let begin = self.port.now();
        while self.since(begin) < ANSWER_TIMEOUT
            && self.receive(ANSWER_TIMEOUT - self.since(begin))?
        {
            while let Some((reply, host)) = self.replies.pop_front() {
                match reply {
                    Reply::Done => {
                        self.answers = true;
                        return Ok(());
                    }
                    Reply::Refused => {
                        return Err(CanError::Refused {
                            command: name(command),
                        });
                    }
                    // What is not an answer must not be lost: a node may speak as soon as the
                    // channel is open.
                    reply => self.take(reply, host),
                }
            }
        }
        Ok(())
    }

    /// Reads the port once; whether it brought anything within `timeout`.
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

    /// What a reply means on an open channel.
    fn take(&mut self, reply: Reply, host: Stamp<Host>) {
        match reply {
            Reply::Received { frame, .. } => self.waiting.push_back(Ok((frame, host))),
            Reply::Done | Reply::Sent | Reply::SentExtended => self.frame_answered(),
            // Flags are cleared by reading them, so each set one is another loss. They do not say
            // of how many frames.
            Reply::Status(flags) => {
                self.status.behind = None;
                self.dropped += u64::from(flags & LOST != 0);
            }
            // An adapter without status flags is not asked again.
            Reply::Refused if self.status.behind == Some(0) => self.status = Status::default(),
            Reply::Refused if self.answers && self.unanswered > 0 => {
                self.frame_answered();
                self.waiting.push_back(Err(CanError::NotSent));
            }
            Reply::Refused | Reply::Unknown(_) => self.noise += 1,
            // Answers to questions that were not asked.
            Reply::Version(_) | Reply::SerialNumber(_) => {}
        }
    }

    /// Answers come in the order of what was sent.
    fn frame_answered(&mut self) {
        self.unanswered = self.unanswered.saturating_sub(1);
        if let Some(behind) = &mut self.status.behind {
            *behind = behind.saturating_sub(1);
        }
    }
}

impl<P: Port> CanPort for Slcan<P> {
    fn write_frame(&mut self, frame: &CanFrame) -> Result<Stamp<Host>, CanError> {
        let host = self.send(&Command::Transmit(*frame))?;
        self.unanswered = self.unanswered.saturating_add(1);
        if self.is_status_due() {
            // A port that fails will say so with the next frame: this one is on its way.
            drop(self.send(&Command::Status));
        }
        Ok(host)
    }

    fn read(&mut self, timeout: Span) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError> {
        let begin = self.port.now();
        let mut left = timeout;
        loop {
            while let Some((reply, host)) = self.replies.pop_front() {
                self.take(reply, host);
            }
            if let Some(waiting) = self.waiting.pop_front() {
                return waiting.map(Some);
            }
            // What came held no frame: the rest of the time, and no more once it is over.
            let over = left <= Span::ZERO && left != timeout;
            if over || !self.receive(left)? {
                return Ok(None);
            }
            left = timeout - self.since(begin);
        }
    }

    /// How often the adapter said that it had lost frames: at least so many.
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
        // The port may be gone; there is nobody to tell.
        drop(self.send(&Command::Close));
    }
}

/// The command as it stands in its line.
fn name(command: &Command) -> String {
    let mut line = Line::new();
    command.encode(&mut line);
    String::from_utf8_lossy(&line).trim_end().to_owned()
}

#[cfg(test)]
mod tests;
