//! Runs the drive client over a port: bytes and the time go in, frames come out.
//!
//! The client is a machine without I/O; this loop is all that stands between it and a wire. Time comes from the caller, so
//! that the same loop runs against the clock and, in tests, in virtual time.
//! Whatever ends a procedure early (Ctrl-C, a fault), the axis is stopped before this returns, or the error says that it could not be.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use drive::{Client, Command, DriveError, Event, Outcome};
use io::port::{Port, PortError};
use thiserror::Error;
use units::{Host, Span, Stamp};

/// Why a procedure did not come to its end.
#[derive(Debug, Error)]
pub enum SessionError {
    /// The user asked to stop; the axis has stopped.
    #[error("stopped by the user")]
    Interrupted,
    /// The drive refused, reported a fault or did not answer. The axis has stopped unless the error says otherwise.
    #[error("{0}")]
    Drive(DriveError),
    /// The port itself failed: nothing can be sent any more.
    #[error("{0}; the axis could not be told to stop")]
    Port(#[from] PortError),
}

/// A drive client on a port.
pub struct Session<P> {
    client: Client,
    port: P,
    now: fn(&P) -> Stamp<Host>,
    interrupt: Arc<AtomicBool>,
}

/// How long a silent port may keep the loop from looking at the interrupt flag.
const LOOK_UP: Span = Span::from_millis(20);

impl<P: Port> Session<P> {
    /// A session over `port`, whose time is `now`, that stops the axis when `interrupt` becomes true.
    pub fn new(
        client: Client,
        port: P,
        now: fn(&P) -> Stamp<Host>,
        interrupt: Arc<AtomicBool>,
    ) -> Self {
        Self {
            client,
            port,
            now,
            interrupt,
        }
    }

    /// Runs `command` to its end.
    ///
    /// # Errors
    /// [`SessionError`]; the axis has been stopped unless the error says that it could not be.
    pub fn run(
        &mut self,
        command: Command,
        on_event: &mut dyn FnMut(&Event),
    ) -> Result<Outcome, SessionError> {
        self.client.start(command).map_err(SessionError::Drive)?;
        match self.pump(on_event, true)? {
            Ended::Done(outcome) => Ok(outcome),
            Ended::Failed(error) => Err(SessionError::Drive(error)),
            Ended::Interrupted => {
                self.client
                    .start(Command::Stop)
                    .map_err(SessionError::Drive)?;
                match self.pump(on_event, false)? {
                    Ended::Failed(error) => Err(SessionError::Drive(error)),
                    Ended::Done(_) | Ended::Interrupted => Err(SessionError::Interrupted),
                }
            }
        }
    }

    fn pump(
        &mut self,
        on_event: &mut dyn FnMut(&Event),
        interruptible: bool,
    ) -> Result<Ended, PortError> {
        let mut buffer = [0; 512];
        loop {
            while let Some(frame) = self.client.poll_transmit((self.now)(&self.port)) {
                self.port.write_frame(&frame)?;
            }
            while let Some(event) = self.client.poll_event() {
                on_event(&event);
                match event {
                    Event::Done(outcome) => return Ok(Ended::Done(outcome)),
                    Event::Failed(error) => return Ok(Ended::Failed(error)),
                    _ => {}
                }
            }
            if interruptible && self.interrupt.load(Ordering::Relaxed) {
                return Ok(Ended::Interrupted);
            }
            let now = (self.now)(&self.port);
            let wait = self
                .client
                .poll_timeout()
                .map_or(LOOK_UP, |at| at.saturating_since(now))
                .clamp(Span::ZERO, LOOK_UP);
            match self.port.read(&mut buffer, wait)? {
                Some((count, at)) => {
                    let bytes = buffer.get(..count).unwrap_or_default();
                    self.client.handle_input(bytes, at);
                }
                None => self.client.handle_timeout((self.now)(&self.port)),
            }
        }
    }
}

enum Ended {
    Done(Outcome),
    Failed(DriveError),
    Interrupted,
}
