//! The client as a state machine without I/O: commands and bytes in, bytes and events out, time as
//! an argument.
//!
//! The port's owner writes the bytes of [`DriveClient::poll_transmit`], passes what it reads to
//! [`DriveClient::handle_input`], wakes up at [`DriveClient::poll_timeout`] for
//! [`DriveClient::handle_timeout`], and takes events from [`DriveClient::poll_event`]. After each
//! input and timeout it calls `poll_transmit` until that returns `None`.
//!
//! A command is a sequential `async fn` over [`crate::ops::Ops`], polled here with a waker that
//! does nothing. Dropping it cancels the command.

use std::collections::VecDeque;
use std::fmt;
use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex};
use std::task::{Context, Poll, Waker};

use protocol::canopen::NodeId;
use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use crate::can_services::CanServices;
use crate::codec::Codec;
use crate::command::{CommandKind, DriveCommand};
use crate::config::AxisConfig;
use crate::error::DriveError;
use crate::event::{CommandOutcome, CommandProgress, DriveEvent};
use crate::link::{LinkStats, RequestLink};
use crate::ops::{Core, Ops, SharedCore, lock};
use crate::procedures;

type Procedure = Pin<Box<dyn Future<Output = Result<CommandOutcome, DriveError>> + Send>>;

/// A client of one EPOS2 axis.
///
/// On USB and RS232 it exchanges bytes, on a CAN bus frames of 16 bytes (`struct can_frame`).
pub struct DriveClient {
    config: Arc<AxisConfig>,
    core: SharedCore,
    running: Option<(CommandKind, Procedure)>,
    connected: bool,
    link: DriveLink,
}

impl DriveClient {
    /// Creates a client of an axis on this link. It sends nothing before a command starts.
    #[must_use]
    pub fn new(config: AxisConfig, link: DriveLink) -> Self {
        let node = NodeId::new(config.node).filter(|_| link == DriveLink::Can);
        let core = Core {
            link: RequestLink::new(Codec::new(link, config.node)),
            can: node.map(|node| CanServices::new(node, config.can)),
            referenced: false,
            lag: None,
            host_delayed: None,
            now: Stamp::from_nanos(0),
            is_starting: false,
            wake: None,
            events: VecDeque::new(),
        };
        Self {
            config: Arc::new(config),
            core: Arc::new(Mutex::new(core)),
            running: None,
            connected: false,
            link,
        }
    }

    /// The link to the drive.
    #[must_use]
    pub fn link(&self) -> DriveLink {
        self.link
    }

    /// Starts a command. [`DriveCommand::Stop`] cancels the running command, which then ends
    /// without an event; any other command is refused while one runs.
    ///
    /// # Errors
    /// Before a byte is sent: [`DriveError::Config`], [`DriveError::Busy`],
    /// [`DriveError::NotConnected`]; for moves [`DriveError::Limits`], [`DriveError::Speed`] and
    /// [`DriveError::Acceleration`]; for writes [`DriveError::Reserved`].
    pub fn start(&mut self, command: DriveCommand) -> Result<(), DriveError> {
        let kind = command.kind();
        self.config.check()?;
        if let (Some((running, _)), true) = (&self.running, kind != CommandKind::Stop) {
            return Err(DriveError::Busy {
                requested: kind,
                running: *running,
            });
        }
        if needs_connection(kind) && !self.connected {
            return Err(DriveError::NotConnected { requested: kind });
        }
        let ops = Ops::new(Arc::clone(&self.core), Arc::clone(&self.config));
        let procedure: Procedure = match command {
            DriveCommand::Connect => {
                self.connected = false;
                Box::pin(procedures::connect(ops))
            }
            DriveCommand::Home => Box::pin(procedures::home(ops)),
            DriveCommand::Goto(to) => Box::pin(procedures::goto(ops, self.config.validate(to)?)),
            DriveCommand::Sweep(to) => Box::pin(procedures::sweep(ops, self.config.validate(to)?)),
            DriveCommand::Hold { until } => Box::pin(procedures::hold(ops, until)),
            DriveCommand::Stop => Box::pin(procedures::stop(ops)),
            DriveCommand::Brake => Box::pin(procedures::brake(ops)),
            DriveCommand::ClearFaults => Box::pin(procedures::clear_faults(ops)),
            DriveCommand::Status => Box::pin(procedures::status(ops)),
            DriveCommand::Read(address) => Box::pin(procedures::read(ops, address)),
            DriveCommand::Write { address, bytes } => {
                procedures::check_writable(address)?;
                Box::pin(procedures::write(ops, address, bytes))
            }
        };
        self.cancel();
        self.running = Some((kind, procedure));
        let mut core = lock(&self.core);
        core.is_starting = true;
        let started = DriveEvent::Progress(CommandProgress::Started(kind));
        core.events.push_back(started);
        Ok(())
    }

    /// The running command.
    #[must_use]
    pub fn running(&self) -> Option<CommandKind> {
        self.running.as_ref().map(|(kind, _)| *kind)
    }

    /// The next bytes to write to the port, on CAN one frame. `now` becomes the time of the
    /// request.
    pub fn poll_transmit(&mut self, now: Stamp<Host>) -> Option<Vec<u8>> {
        self.advance(now);
        let mut core = lock(&self.core);
        let period = self.config.timing.poll_period;
        let frame = core.can.as_mut().and_then(|can| can.transmit(now, period));
        match frame {
            Some(frame) => Some(frame.to_socketcan().to_vec()),
            None => core.link.transmit(now),
        }
    }

    /// Processes bytes from the port in portions of any size, on CAN whole frames. `now` becomes
    /// the time of the reply they complete.
    pub fn handle_input(&mut self, bytes: &[u8], now: Stamp<Host>) {
        {
            let mut core = lock(&self.core);
            core.begin(now);
            core.link.handle_input(bytes, now);
            while let Some(frame) = core.link.take_frame() {
                let can = core.can.as_mut();
                let sample = can.and_then(|can| can.handle_frame(&frame, now));
                core.events.extend(sample.map(DriveEvent::Sample));
            }
        }
        self.advance(now);
    }

    /// Time at which [`DriveClient::handle_timeout`] is due without input.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Stamp<Host>> {
        let core = lock(&self.core);
        let can = core.can.as_ref().and_then(CanServices::deadline);
        let is_running = self.running.is_some();
        let of_command = [core.wake, can].into_iter().filter(|_| is_running);
        of_command.chain([core.link.deadline()]).flatten().min()
    }

    /// Acts on deadlines that have passed. The caller has read all input, so that a frame which
    /// waited for a delayed host is no silence.
    pub fn handle_timeout(&mut self, now: Stamp<Host>) {
        if let (true, Some(can)) = (self.running.is_some(), &mut lock(&self.core).can) {
            can.expire(now);
        }
        self.advance(now);
    }

    /// Reports that the host did not run for this time, up to `now`: replies may wait to be read,
    /// so deadlines move. A machine that delays one program delays others, such as the system's
    /// part of the link or a simulated drive: for some seconds silence is tolerated where only an
    /// unloaded machine proves the link lost.
    pub fn handle_host_delay(&mut self, delay: Span, now: Stamp<Host>) {
        let mut core = lock(&self.core);
        core.host_delayed = Some(now);
        core.link.postpone(delay);
        if let Some(can) = &mut core.can {
            can.postpone(delay);
        }
    }

    /// Takes the oldest event.
    pub fn poll_event(&mut self) -> Option<DriveEvent> {
        lock(&self.core).events.pop_front()
    }

    /// Whether the drive is on a CAN bus, where frames come unasked.
    #[must_use]
    pub fn is_on_can(&self) -> bool {
        lock(&self.core).can.is_some()
    }

    /// Counters of the link.
    #[must_use]
    pub fn link_stats(&self) -> LinkStats {
        lock(&self.core).link.stats()
    }

    /// The configuration of the axis.
    #[must_use]
    pub fn config(&self) -> &AxisConfig {
        &self.config
    }

    fn cancel(&mut self) {
        if self.running.take().is_some() {
            let mut core = lock(&self.core);
            core.end();
            core.link.abandon();
        }
    }

    fn advance(&mut self, now: Stamp<Host>) {
        {
            let mut core = lock(&self.core);
            core.now = now;
            core.begin(now);
            core.link.expire(now);
        }
        let Some((kind, procedure)) = self.running.as_mut() else {
            return;
        };
        let mut context = Context::from_waker(Waker::noop());
        let Poll::Ready(result) = procedure.as_mut().poll(&mut context) else {
            return;
        };
        if *kind == CommandKind::Connect {
            self.connected = result.is_ok();
        }
        self.running = None;
        let mut core = lock(&self.core);
        core.end();
        core.events.push_back(match result {
            Ok(outcome) => DriveEvent::Done(outcome),
            Err(error) => DriveEvent::Failed(error),
        });
    }
}

/// Whether a command relies on the settings made by [`DriveCommand::Connect`].
fn needs_connection(kind: CommandKind) -> bool {
    matches!(
        kind,
        CommandKind::Home | CommandKind::Goto | CommandKind::Sweep | CommandKind::Hold
    )
}

impl fmt::Debug for DriveClient {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DriveClient")
            .field("config", &self.config)
            .field("running", &self.running())
            .field("core", &self.core)
            .finish()
    }
}
