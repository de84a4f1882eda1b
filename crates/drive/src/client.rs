//! The client as a machine without I/O: commands and bytes in, bytes and events out, time an argument.
//!
//! The owner of the port writes what [`Client::poll_transmit`] hands out, passes what it reads to [`Client::handle_input`], wakes up at
//! [`Client::poll_timeout`], and takes events from [`Client::poll_event`]. After each of the first three, `poll_transmit` is asked again.
//! Inside, a command is a plain sequential `async fn` over [`crate::ops::Ops`], polled here with a waker that does nothing: dropping
//! it cancels the command. Nothing here knows which bytes a transport uses.

use std::collections::VecDeque;
use std::fmt;
use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex};
use std::task::{Context, Poll, Waker};

use protocol::canopen::NodeId;
use protocol::record::DriveLink;
use units::{Host, Stamp};

use crate::bus::Bus;
use crate::codec::Codec;
use crate::command::{Command, CommandKind};
use crate::config::AxisConfig;
use crate::error::DriveError;
use crate::event::{Event, Outcome, Progress};
use crate::link::{Link, LinkStats};
use crate::ops::{Core, Ops, Shared, lock};
use crate::procedures;

type Procedure = Pin<Box<dyn Future<Output = Result<Outcome, DriveError>> + Send>>;

/// A client of one EPOS2 axis.
///
/// On USB and RS232 it takes and gives bytes; on a CAN bus the 16 bytes of a `struct can_frame` each, as in a log's records.
pub struct Client {
    config: Arc<AxisConfig>,
    core: Shared,
    running: Option<(CommandKind, Procedure)>,
    connected: bool,
    attached: DriveLink,
}

impl Client {
    /// A client for an axis on USB; nothing is sent before a command starts.
    #[must_use]
    pub fn new(config: AxisConfig) -> Self {
        Self::with_link(config, DriveLink::Usb)
    }

    /// A client for an axis on any of its links; nothing is sent before a command starts.
    #[must_use]
    pub fn with_link(config: AxisConfig, link: DriveLink) -> Self {
        let bus = NodeId::new(config.node).filter(|_| link == DriveLink::Can);
        let core = Core {
            link: Link::new(Codec::new(link, config.node)),
            bus: bus.map(|node| Bus::new(node, config.can)),
            referenced: false,
            now: Stamp::from_nanos(0),
            begins: false,
            wake: None,
            events: VecDeque::new(),
        };
        Self {
            config: Arc::new(config),
            core: Arc::new(Mutex::new(core)),
            running: None,
            connected: false,
            attached: link,
        }
    }

    /// How the axis is attached.
    #[must_use]
    pub fn link(&self) -> DriveLink {
        self.attached
    }

    /// Starts a command. [`Command::Stop`] cancels whatever runs (that command then ends without an event of its own); any other
    /// has to wait for the end of the one before.
    ///
    /// # Errors
    /// Before a byte is sent: [`DriveError::Config`], [`DriveError::Busy`], [`DriveError::NotConnected`], and for moves
    /// [`DriveError::Limits`], [`DriveError::Speed`] and [`DriveError::Acceleration`], for writes [`DriveError::Reserved`].
    pub fn start(&mut self, command: Command) -> Result<(), DriveError> {
        let kind = command.kind();
        self.config.check()?;
        if let (Some((running, _)), true) = (&self.running, kind != CommandKind::Stop) {
            return Err(DriveError::Busy {
                asked: kind,
                running: *running,
            });
        }
        if needs_connection(kind) && !self.connected {
            return Err(DriveError::NotConnected { asked: kind });
        }
        let ops = Ops::new(Arc::clone(&self.core), Arc::clone(&self.config));
        let procedure: Procedure = match command {
            Command::Connect => {
                self.connected = false;
                Box::pin(procedures::connect(ops))
            }
            Command::Home => Box::pin(procedures::home(ops)),
            Command::Goto(to) => Box::pin(procedures::goto(ops, self.config.aim(to)?)),
            Command::Sweep(to) => Box::pin(procedures::sweep(ops, self.config.aim(to)?)),
            Command::Hold { until } => Box::pin(procedures::hold(ops, until)),
            Command::Stop => Box::pin(procedures::stop(ops)),
            Command::Brake => Box::pin(procedures::brake(ops)),
            Command::ClearFaults => Box::pin(procedures::clear_faults(ops)),
            Command::Status => Box::pin(procedures::status(ops)),
            Command::Read(address) => Box::pin(procedures::read(ops, address)),
            Command::Write { address, bytes } => {
                procedures::check_writable(address)?;
                Box::pin(procedures::write(ops, address, bytes))
            }
        };
        self.cancel();
        self.running = Some((kind, procedure));
        let mut core = lock(&self.core);
        core.begins = true;
        let started = Event::Progress(Progress::Started(kind));
        core.events.push_back(started);
        Ok(())
    }

    /// The command that is running.
    #[must_use]
    pub fn running(&self) -> Option<CommandKind> {
        self.running.as_ref().map(|(kind, _)| *kind)
    }

    /// The next bytes to write to the port, on CAN a frame; `now` becomes the request's time.
    pub fn poll_transmit(&mut self, now: Stamp<Host>) -> Option<Vec<u8>> {
        self.advance(now);
        let mut core = lock(&self.core);
        let period = self.config.timing.poll_period;
        let frame = core.bus.as_mut().and_then(|bus| bus.transmit(now, period));
        match frame {
            Some(frame) => Some(frame.to_socketcan().to_vec()),
            None => core.link.transmit(now),
        }
    }

    /// Takes bytes that were read from the port, in any portions, on CAN whole frames of 16 bytes; `now` becomes the time of the
    /// answer they complete.
    pub fn handle_input(&mut self, bytes: &[u8], now: Stamp<Host>) {
        {
            let mut core = lock(&self.core);
            core.begin(now);
            core.link.input(bytes, now);
            while let Some(frame) = core.link.take_frame() {
                let sample = core.bus.as_mut().and_then(|bus| bus.handle(&frame, now));
                core.events.extend(sample.map(Event::Sample));
            }
        }
        self.advance(now);
    }

    /// When [`Client::handle_timeout`] is due if nothing else happens before.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Stamp<Host>> {
        let core = lock(&self.core);
        let runs = self.running.is_some();
        let wake = core.wake.filter(|_| runs);
        let bus = core.bus.as_ref().and_then(Bus::deadline).filter(|_| runs);
        [core.link.deadline(), wake, bus]
            .into_iter()
            .flatten()
            .min()
    }

    /// Lets time pass.
    pub fn handle_timeout(&mut self, now: Stamp<Host>) {
        self.advance(now);
    }

    /// What happened, oldest first.
    pub fn poll_event(&mut self) -> Option<Event> {
        lock(&self.core).events.pop_front()
    }

    /// What the link went through so far.
    #[must_use]
    pub fn link_stats(&self) -> LinkStats {
        lock(&self.core).link.stats()
    }

    /// The axis this client was made for.
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
            if let (true, Some(bus)) = (self.running.is_some(), &mut core.bus) {
                bus.expire(now);
            }
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
            Ok(outcome) => Event::Done(outcome),
            Err(error) => Event::Failed(error),
        });
    }
}

/// Whether a command relies on the settings that connecting makes and verifies.
fn needs_connection(kind: CommandKind) -> bool {
    matches!(
        kind,
        CommandKind::Home | CommandKind::Goto | CommandKind::Sweep | CommandKind::Hold
    )
}

impl fmt::Debug for Client {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Client")
            .field("config", &self.config)
            .field("running", &self.running())
            .field("core", &self.core)
            .finish()
    }
}
