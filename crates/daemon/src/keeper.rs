//! The thread that has the devices: opens them, opens them again when they come back, and does one order after the other.
//!
//! It alone touches the drive. A panic in an order has the axis stopped as the session unwinds, and the thread goes on.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use drive::DriveCommand;
use tokio::sync::oneshot;
use units::Span;

use super::line::{Axis, Line};
use super::maker::Making;
use super::orders::{panic_failure, port_lost};
use super::shared::Shared;
use super::view::Doing;
use engine::capture::jog::{self as tilting, JogRequest, Report};
use engine::capture::request::CapturePlan;
use engine::devices::drive_port as ports;
use engine::devices::drive_session::SessionError;
use engine::devices::profile as devices;
use engine::devices::simulated::Simulated;
use engine::failure::{Failure, Kind};

/// How often the drive is asked how it is while nothing is done.
const LOOK: Duration = Duration::from_secs(2);
/// Between two tries to reach a device: at first, and at most.
const AGAIN: (Duration, Duration) = (Duration::from_millis(250), Duration::from_secs(5));
/// What software devices remember of what truly happened before a capture.
const MEMORY: Span = Span::from_secs(60);

/// The answer of an order that moves the axis by hand.
pub type Answer = oneshot::Sender<Result<Report, Failure>>;

/// What the keeper is told to do. Whoever sends one has taken the axis ([`Shared::take`]), but for the last two.
pub enum Order {
    /// Make a scan.
    Capture {
        /// Decided.
        setup: Box<CapturePlan>,
        /// Its id.
        id: String,
    },
    /// Run commands.
    Tilt {
        /// These.
        commands: Vec<DriveCommand>,
        /// Who wants to know.
        answer: Answer,
    },
    /// The machine has slept: what was open may be stale.
    Reopen,
    /// Look whether the daemon ends.
    Wake,
}

/// The keeper.
pub struct Keeper {
    pub(super) shared: Arc<Shared>,
    pub(super) axis: drive::AxisConfig,
    orders: Receiver<Order>,
    pub(super) maker: Sender<Making>,
    pub(super) devices: Option<Simulated>,
    pub(super) lidar_again: Backoff,
}

/// When the next try is due.
pub(super) struct Backoff {
    wait: Duration,
    due: Instant,
}

impl Backoff {
    pub(super) fn new() -> Self {
        Self {
            wait: AGAIN.0,
            due: Instant::now(),
        }
    }

    pub(super) fn failed(&mut self) {
        self.due = Instant::now() + self.wait;
        self.wait = (self.wait * 2).min(AGAIN.1);
    }

    pub(super) fn left(&self) -> Duration {
        self.due.saturating_duration_since(Instant::now())
    }
}

/// Why the keeper lets go of a port.
pub(super) enum Lost {
    /// The daemon ends.
    Ending,
    /// The device went away.
    Port(Failure),
    /// It may be another by now.
    Stale,
}

impl Keeper {
    /// Of the devices of `shared`; what is recorded goes to `maker`.
    ///
    /// # Errors
    /// Where the configuration describes no axis.
    pub fn new(
        shared: &Arc<Shared>,
        orders: Receiver<Order>,
        maker: Sender<Making>,
    ) -> Result<Self, Failure> {
        Ok(Self {
            axis: devices::axis(&shared.config.axis)?,
            shared: Arc::clone(shared),
            orders,
            maker,
            devices: None,
            lidar_again: Backoff::new(),
        })
    }

    /// Until the daemon ends.
    pub fn run(mut self) {
        let mut again = Backoff::new();
        while !self.shared.is_ending() {
            self.shared.beat();
            self.listen();
            match self.open() {
                Ok(opened) => {
                    again = Backoff::new();
                    match self.serve(opened) {
                        Lost::Ending => break,
                        Lost::Stale => {}
                        Lost::Port(failure) => self.absent(failure),
                    }
                }
                Err(failure) => self.absent(failure),
            }
            again.failed();
            self.refuse_for(again.left());
        }
        self.shared.set_hearing(None);
        if let Some(devices) = self.devices.take() {
            // Nobody is left to compare with the truth.
            drop(devices.stop());
        }
    }

    /// Answers orders that came before it was known that the drive is gone.
    fn refuse_for(&mut self, wait: Duration) {
        let until = Instant::now() + wait;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            match self.orders.recv_timeout(left) {
                Ok(order) => self.refuse(order),
                Err(_) => return,
            }
            if self.shared.is_ending() {
                return;
            }
        }
    }

    fn refuse(&self, order: Order) {
        let drive = self.shared.drive();
        let failure = drive.problem.unwrap_or_else(|| {
            Failure::new(Kind::NoDevice, "the drive is not connected").help("see the status")
        });
        match order {
            Order::Capture { id, .. } => self.failed(&id, failure),
            Order::Tilt { answer, .. } => {
                self.shared.set_idle();
                drop(answer.send(Err(failure)));
            }
            Order::Reopen => self.forget_lidar(),
            Order::Wake => {}
        }
    }

    /// Does orders with an open port until it is lost.
    fn serve(&mut self, mut line: Line) -> Lost {
        let mut look = Instant::now();
        let mut greeted = Backoff::new();
        loop {
            self.shared.beat();
            self.listen();
            if self.shared.is_ending() {
                return Lost::Ending;
            }
            // Unless an order is on its way.
            if line.axis != Axis::Known
                && greeted.left().is_zero()
                && self.shared.claim(Doing::Connecting)
            {
                let done = self.ask(&mut line, &[DriveCommand::Connect]);
                self.shared.set_idle();
                match done {
                    Ok(_) => greeted = Backoff::new(),
                    Err(SessionError::Port(error)) => return Lost::Port(ports::failure(&error)),
                    Err(_) => {
                        if line.axis == Axis::MayMove {
                            // It is not let run any longer than it must.
                            greeted = Backoff::new();
                        }
                        greeted.failed();
                    }
                }
                look = Instant::now() + LOOK;
            }
            if look.saturating_duration_since(Instant::now()).is_zero() {
                if line.axis == Axis::Known
                    && let Err(SessionError::Port(error)) = self.ask(&mut line, &[])
                {
                    return Lost::Port(ports::failure(&error));
                }
                look = Instant::now() + LOOK;
                if let Some(devices) = &self.devices {
                    devices.forget_before(io::clock::now().saturating_add(-MEMORY));
                }
            }
            let next = match line.axis {
                Axis::Known => look.saturating_duration_since(Instant::now()),
                Axis::Unknown | Axis::MayMove => greeted.left(),
            };
            match self.orders.recv_timeout(next) {
                Ok(Order::Reopen) => {
                    self.forget();
                    return Lost::Stale;
                }
                Ok(Order::Wake) | Err(RecvTimeoutError::Timeout) => {}
                Ok(order) => {
                    if let Some(lost) = self.obey(&mut line, order) {
                        return lost;
                    }
                    look = Instant::now() + LOOK;
                }
                Err(RecvTimeoutError::Disconnected) => return Lost::Ending,
            }
        }
    }

    /// Does one order, whatever happens in it.
    fn obey(&mut self, line: &mut Line, order: Order) -> Option<Lost> {
        if self.shared.is_ending() {
            self.refuse(order);
            return Some(Lost::Ending);
        }
        match order {
            Order::Capture { setup, id } => self.capture(line, *setup, &id),
            Order::Tilt { commands, answer } => {
                let done = catch_unwind(AssertUnwindSafe(|| self.ask(line, &commands)));
                let (answered, lost) = match done {
                    Ok(Ok(report)) => (Ok(report), None),
                    Ok(Err(error)) => {
                        let failure = tilting::failure(&error);
                        let reason = self.shared.stop_reason();
                        let lost = port_lost(&error);
                        (Err(reason.unwrap_or(failure)), lost)
                    }
                    Err(_) => {
                        self.fault(panic_failure());
                        (Err(panic_failure()), Some(Lost::Stale))
                    }
                };
                // First this: whoever gets the answer may send the next order.
                self.shared.set_idle();
                // Whoever asked may be gone.
                let _ = answer.send(answered);
                lost
            }
            Order::Reopen | Order::Wake => None,
        }
    }
}

/// What a move by hand is for the client, and what it is called meanwhile.
///
/// # Errors
/// [`Kind::Usage`] for a move that the axis cannot make.
pub fn tilt_order(
    request: JogRequest,
    shared: &Shared,
) -> Result<(Doing, Vec<DriveCommand>), Failure> {
    let commands = tilting::commands(request, &shared.config, &shared.device)?;
    let doing = match request {
        JogRequest::Home => Doing::Homing,
        JogRequest::Goto { .. } => Doing::Moving,
        JogRequest::Status | JogRequest::Stop | JogRequest::ClearFaults => Doing::Stopping,
    };
    Ok((doing, commands))
}
