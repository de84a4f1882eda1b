//! Runs the drive client over a port: bytes and time go in, frames come out.
//!
//! The client does no I/O; this loop alone connects it to a wire. Time comes from the port, so that
//! the same loop runs in real time and, in tests, in virtual time. If a procedure ends early
//! (Ctrl-C, a fault, a panic in an observer), the axis is stopped before this returns, or the error
//! reports that it may still move.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use drive::{CommandKind, CommandOutcome, DriveClient, DriveCommand, DriveError, DriveEvent};
use io::port::{Port, PortError};
use thiserror::Error;
use units::{Host, Span, Stamp};

use super::guardian::{Guardian, GuardianError};
use super::sleep_inhibitor::SleepInhibitor;
use crate::failure::Kind;

/// Reason for the early end of a procedure.
#[derive(Debug, Error)]
pub enum SessionError {
    /// The user asked to stop; the axis has stopped.
    #[error("stopped by the user")]
    Interrupted,
    /// The drive did not follow a requested stop.
    #[error("stopped by the user, but the axis may still move: {0}")]
    NotStopped(DriveError),
    /// The drive refused, reported a fault or did not answer. The axis has stopped unless the error
    /// says otherwise.
    #[error("{0}")]
    Drive(DriveError),
    /// The port failed. A stop was sent if the port still accepted it; its answer cannot be
    /// received.
    #[error("{0}; the axis may still move")]
    Port(#[from] PortError),
    /// The guardian process has stopped the axis, or is gone. The port must be opened again.
    #[error(transparent)]
    Guardian(#[from] GuardianError),
}

impl SessionError {
    /// Whether the axis may still move: no standstill was observed.
    #[must_use]
    pub const fn may_move(&self) -> bool {
        match self {
            Self::Interrupted => false,
            Self::NotStopped(_) | Self::Port(_) => true,
            Self::Drive(error) => matches!(error, DriveError::NotStopped { .. }),
            Self::Guardian(error) => error.may_move(),
        }
    }

    /// Kind of its failure: [`Kind::Interrupted`] only where the axis is known to be at rest.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Interrupted => Kind::Interrupted,
            Self::Guardian(GuardianError::Acted { .. }) if !self.may_move() => Kind::Interrupted,
            _ => Kind::DeviceFault,
        }
    }

    /// The remedy.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Interrupted => None,
            Self::Drive(error) => Some(match error {
                DriveError::Fault { .. } => format!("{}\n{CLEARING}", error.help()),
                error => error.help(),
            }),
            Self::Guardian(error) if !error.may_move() => Some(
                "the move is not resumed: begin again; velomotion help tilt describes the guardian"
                    .to_owned(),
            ),
            Self::NotStopped(_) | Self::Port(_) | Self::Guardian(_) => Some(
                "switch the motor's supply off if the axis moves, then check cable and supply"
                    .to_owned(),
            ),
        }
    }
}

/// Ways to clear a fault.
pub const CLEARING: &str = "tilt faults --clear clears it, and so does homing the axis";

/// A drive client on a port. Dropped while the axis may move, it sends a stop; if that fails too,
/// its guardian stops the axis.
pub struct Session<'g, P: Port> {
    client: DriveClient,
    port: P,
    /// Stops the axis if this process cannot.
    guardian: Option<&'g mut Guardian>,
    /// Whether the machine stays awake while the axis may move or is powered.
    keeps_awake: bool,
    inhibitor: Option<SleepInhibitor>,
    interrupt: Arc<AtomicBool>,
    /// Whether a command that can move or power the axis has begun and no later command has
    /// disabled the axis.
    unsafe_to_leave: bool,
}

/// Longest time between two checks of the interrupt flag.
const INTERRUPT_POLL: Span = Span::from_millis(20);
/// A loop that is so late shows that the machine did not run this program.
const HOST_DELAY: Span = Span::from_millis(20);
/// Frames that a late loop reads in a turn: more than 1 Mbit/s carries in a millisecond.
const FRAMES_A_TURN: usize = 32;
/// Attempts of a stop before it counts as failed; each takes some tenths of a second.
const STOP_TRIES: u32 = 5;
/// Time that a session dropped in motion waits for the axis to stop.
const LAST_RESORT: Span = Span::from_secs(1);

impl<'g, P: Port> Session<'g, P> {
    /// Makes a session over `port`, with the port's time. It stops the axis when `interrupt`
    /// becomes true.
    pub fn new(client: DriveClient, port: P, interrupt: Arc<AtomicBool>) -> Self {
        Self {
            client,
            port,
            interrupt,
            guardian: None,
            keeps_awake: false,
            inhibitor: None,
            unsafe_to_leave: false,
        }
    }

    /// Has the axis guarded while it may move or is powered.
    #[must_use]
    pub fn guarded_by(mut self, guardian: Option<&'g mut Guardian>) -> Self {
        self.guardian = guardian;
        self
    }

    /// Keeps the machine awake while the axis may move or is powered, on every link. Not needed
    /// for a simulated axis.
    #[must_use]
    pub fn keeping_awake(mut self, keeps_awake: bool) -> Self {
        self.keeps_awake = keeps_awake;
        self
    }

    /// Runs `command` to its end.
    ///
    /// # Errors
    /// [`SessionError`]; the axis has been stopped unless the error says that it could not be.
    pub fn run(
        &mut self,
        command: DriveCommand,
        on_event: &mut dyn FnMut(&DriveEvent),
    ) -> Result<CommandOutcome, SessionError> {
        let kind = command.kind();
        if may_leave_power_on(kind) && !self.unsafe_to_leave {
            self.guardian
                .as_mut()
                .map_or(Ok(()), |guardian| guardian.arm())?;
            self.inhibitor = self.keeps_awake.then(SleepInhibitor::take).flatten();
        }
        if let Err(error) = self.client.start(command) {
            self.stop(on_event)?;
            return Err(SessionError::Drive(error));
        }
        self.unsafe_to_leave |= may_leave_power_on(kind);
        let ended = self.pump(on_event, true, None)?;
        match ended {
            CommandEnd::Done(outcome) => {
                if matches!(kind, CommandKind::Stop | CommandKind::Brake) {
                    self.set_safe(true);
                }
                Ok(outcome)
            }
            // The client has stopped the axis, or has reported that it could not.
            CommandEnd::Failed(error) => {
                let error = match kind {
                    CommandKind::Stop => SessionError::NotStopped(error),
                    _ => SessionError::Drive(error),
                };
                self.set_safe(!error.may_move());
                Err(error)
            }
            CommandEnd::Interrupted => {
                self.stop(on_event)?;
                Err(SessionError::Interrupted)
            }
            CommandEnd::Unguarded(error) => {
                self.stop(on_event)?;
                Err(error.after_own_stop().into())
            }
        }
    }

    /// The port.
    pub fn port(&self) -> &P {
        &self.port
    }

    /// Stops the axis and sets the brake.
    ///
    /// # Errors
    /// [`SessionError::NotStopped`] with the last error if every attempt failed, or the port's.
    pub(super) fn stop(
        &mut self,
        on_event: &mut dyn FnMut(&DriveEvent),
    ) -> Result<(), SessionError> {
        let mut last = None;
        for _ in 0..STOP_TRIES {
            last = match self.client.start(DriveCommand::Stop) {
                Err(error) => Some(error),
                Ok(()) => match self.pump(on_event, false, None)? {
                    CommandEnd::Failed(error) => Some(error),
                    CommandEnd::Done(_) | CommandEnd::Interrupted => None,
                    // The next attempt has no guardian.
                    CommandEnd::Unguarded(_) => continue,
                },
            };
            if last.is_none() {
                self.set_safe(true);
                return Ok(());
            }
        }
        last.map_or(Ok(()), |error| Err(SessionError::NotStopped(error)))
    }

    /// Records whether the axis is at rest as it may be left.
    fn set_safe(&mut self, safe: bool) {
        self.unsafe_to_leave = !safe;
        if safe {
            self.inhibitor = None;
            if let Some(guardian) = &mut self.guardian {
                guardian.disarm();
            }
        }
    }

    fn pump(
        &mut self,
        on_event: &mut dyn FnMut(&DriveEvent),
        interruptible: bool,
        until: Option<Stamp<Host>>,
    ) -> Result<CommandEnd, SessionError> {
        let mut buffer = [0; 512];
        let mut last_read = self.port.now();
        loop {
            match self.guardian.as_mut().map(|guardian| guardian.heartbeat()) {
                Some(Err(error)) if error.may_move() || matches!(error, GuardianError::Lost) => {
                    self.guardian = None;
                    return Ok(CommandEnd::Unguarded(error));
                }
                Some(Err(error)) => {
                    // The guardian has used the port, and the axis is at rest.
                    self.unsafe_to_leave = false;
                    return Err(error.into());
                }
                Some(Ok(())) | None => {}
            }
            self.report_delay(last_read);
            let writes = self.port.now();
            while let Some(frame) = self.client.poll_transmit(self.port.now()) {
                self.port.write_frame(&frame)?;
            }
            while let Some(event) = self.client.poll_event() {
                on_event(&event);
                match event {
                    DriveEvent::Done(outcome) => return Ok(CommandEnd::Done(outcome)),
                    DriveEvent::Failed(error) => return Ok(CommandEnd::Failed(error)),
                    _ => {}
                }
            }
            self.report_delay(writes);
            let now = self.port.now();
            if (interruptible && self.interrupt.load(Ordering::Relaxed))
                || until.is_some_and(|until| now >= until)
            {
                return Ok(CommandEnd::Interrupted);
            }
            let wait = self
                .client
                .poll_timeout()
                .map_or(INTERRUPT_POLL, |at| at.saturating_since(now))
                .clamp(Span::ZERO, INTERRUPT_POLL);
            last_read = self.read_input(&mut buffer, now, wait)?;
        }
    }

    /// Passes input to the client, or the time where none arrives in `wait`; returns the time of
    /// the last read. On a bus a late loop reads all that is there: at one frame a turn a slow
    /// machine would fall behind 1000 samples a second.
    fn read_input(
        &mut self,
        buffer: &mut [u8],
        began: Stamp<Host>,
        mut wait: Span,
    ) -> Result<Stamp<Host>, SessionError> {
        let is_late = wait == Span::ZERO && self.client.is_on_can();
        let mut due = began.saturating_add(wait);
        for _ in 0..if is_late { FRAMES_A_TURN } else { 1 } {
            let received = self.port.read(buffer, wait)?;
            self.report_delay(due);
            due = self.port.now();
            // The stamp of these bytes comes from a clock that may step; the log has it.
            let Some((count, _)) = received else {
                self.client.handle_timeout(due);
                break;
            };
            let bytes = buffer.get(..count).unwrap_or_default();
            self.client.handle_input(bytes, due);
            wait = Span::ZERO;
        }
        Ok(due)
    }

    /// Reports to the client if the loop is later than it should be.
    fn report_delay(&mut self, due: Stamp<Host>) {
        let now = self.port.now();
        let delay = now.saturating_since(due);
        if delay >= HOST_DELAY {
            self.client.handle_host_delay(delay, now);
        }
    }
}

/// Whether a command can leave the power stage on.
fn may_leave_power_on(kind: CommandKind) -> bool {
    matches!(
        kind,
        CommandKind::Home | CommandKind::Goto | CommandKind::Sweep | CommandKind::Hold
    )
}

impl<P: Port> Drop for Session<'_, P> {
    /// After a panic or an error of the port: sends the stop and waits for its end if the port
    /// still works.
    fn drop(&mut self) {
        let until = self.port.now().saturating_add(LAST_RESORT);
        while self.unsafe_to_leave && self.client.start(DriveCommand::Stop).is_ok() {
            // The error that dropped the session has been reported already. Without a confirmed
            // stop the guardian stays armed: it tries once more when it hears nothing from here.
            match self.pump(&mut |_| {}, false, Some(until)) {
                Ok(CommandEnd::Done(_)) => self.set_safe(true),
                // The stop is this process's own now.
                Ok(CommandEnd::Unguarded(_)) => {}
                _ => return,
            }
        }
    }
}

enum CommandEnd {
    Done(CommandOutcome),
    Failed(DriveError),
    Interrupted,
    /// The guardian is gone, or could not stop the axis.
    Unguarded(GuardianError),
}
