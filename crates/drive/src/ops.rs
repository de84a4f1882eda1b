//! What a procedure may do: read, write, wait, sample, tell.
//!
//! Each operation is a future that leaves its wish in a shared core and is ready once the core has the answer. The core is
//! driven from outside by [`crate::Client`]; there is no runtime, no I/O and no clock here, and a procedure that is
//! dropped in the middle leaves nothing behind but perhaps one answer still under way.

mod stream;
mod transfer;

use std::collections::VecDeque;
use std::future::poll_fn;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::Poll;

use protocol::epos2::objects::{self, Address, Object, Scalar};
use units::{Host, Quadcounts, Span, Stamp};

use crate::bus::{Alarm, Bus};
use crate::config::AxisConfig;
use crate::error::{DriveError, Operation, Wrote};
use crate::event::{Event, Progress, ShaftSample, Taken};
use crate::link::{Answered, Link, Lost, Request};
use crate::pairing::Access;

/// What procedures and client share.
#[derive(Debug)]
pub(crate) struct Core {
    pub link: Link,
    /// What there is on a CAN bus beside requests.
    pub bus: Option<Bus>,
    /// The axis has known its position since it was connected.
    pub referenced: bool,
    pub now: Stamp<Host>,
    /// A command was started at a time that is not known yet.
    pub begins: bool,
    /// The running procedure waits for this instant.
    pub wake: Option<Stamp<Host>>,
    pub events: VecDeque<Event>,
}

pub(crate) type Shared = Arc<Mutex<Core>>;

/// Nothing panics while holding the lock, so a poisoned one is as good as any.
pub(crate) fn lock(core: &Shared) -> MutexGuard<'_, Core> {
    core.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A procedure's handle on the drive.
#[derive(Debug)]
pub(crate) struct Ops {
    core: Shared,
    pub config: Arc<AxisConfig>,
    /// The axis may be moving: do not wait long for answers.
    moving: bool,
    /// An alarm of the bus ends the procedure.
    watching: bool,
    next_sample: Option<Stamp<Host>>,
}

/// How long a marker waits while the axis moves: a link that has lost an answer must soon be known to work or not.
const MARKER_MOVING: Span = Span::from_millis(40);
/// How long a quick stop waits for its answer on a link that seems dead.
const LAST_TRY: Span = Span::from_millis(80);

impl Ops {
    pub fn new(core: Shared, config: Arc<AxisConfig>) -> Self {
        Self {
            core,
            config,
            moving: false,
            watching: false,
            next_sample: None,
        }
    }

    /// Whether the axis may be moving, so that a lost answer is noticed sooner.
    pub fn set_moving(&mut self, moving: bool) {
        self.moving = moving;
    }

    /// Whether what the bus reports beside answers (an emergency, a restart) ends the procedure.
    pub fn watch(&mut self, watching: bool) {
        self.watching = watching;
    }

    /// What there is on a CAN bus beside requests; `None` on other links.
    pub fn on_bus<R>(&self, act: impl FnOnce(&mut Bus, Stamp<Host>) -> R) -> Option<R> {
        let mut core = lock(&self.core);
        let now = core.now;
        core.bus.as_mut().map(|bus| act(bus, now))
    }

    pub fn was_referenced(&self) -> bool {
        lock(&self.core).referenced
    }

    pub fn set_referenced(&self, referenced: bool) {
        lock(&self.core).referenced = referenced;
    }

    pub fn now(&self) -> Stamp<Host> {
        lock(&self.core).now
    }

    pub fn tell(&self, progress: Progress) {
        lock(&self.core).events.push_back(Event::Progress(progress));
    }

    /// Reads an object; what the drive sends beyond the object's width is cut off.
    pub async fn read<T: Scalar>(&self, object: Object<T>) -> Result<T, DriveError> {
        Ok(self.read_timed(object).await?.0)
    }

    /// The same with when it was asked and answered.
    pub async fn read_timed<T: Scalar>(
        &self,
        object: Object<T>,
    ) -> Result<(T, Answered), DriveError> {
        let request = self.request(object.address, Access::Read, T::BYTES);
        let answered = self.ask(request).await?;
        let raw = answered.reply.value.unwrap_or_default();
        Ok((T::from_raw(raw), answered))
    }

    /// Writes an object.
    pub async fn write<T: Scalar>(&self, object: Object<T>, value: T) -> Result<(), DriveError> {
        self.write_raw(object.address, value.to_raw(), T::BYTES)
            .await
    }

    /// Writes an object of `width` bytes.
    pub async fn write_raw(
        &self,
        address: Address,
        value: u32,
        width: u8,
    ) -> Result<(), DriveError> {
        let request = self.request(address, Access::Write(value), width);
        self.ask(request).await.map(drop)
    }

    /// Writes an object and reads it back.
    pub async fn set<T: Scalar>(&self, object: Object<T>, value: T) -> Result<(), DriveError> {
        self.write(object, value).await?;
        self.expect(object, value).await
    }

    /// Reads an object that must hold a value.
    pub async fn expect<T: Scalar>(&self, object: Object<T>, value: T) -> Result<(), DriveError> {
        let got = self.read(object).await?.to_raw();
        let expected = value.to_raw();
        if got != expected {
            return Err(DriveError::NotTaken {
                address: object.address,
                expected,
                got,
            });
        }
        Ok(())
    }

    /// Sets some bits of an object and leaves the others as they are.
    pub async fn set_bits(
        &self,
        object: Object<u16>,
        mask: u16,
        bits: u16,
    ) -> Result<(), DriveError> {
        let old = self.read(object).await?;
        self.set(object, (old & !mask) | (bits & mask)).await
    }

    /// Writes what may be written twice: repeated, as reads are, where its answer is lost.
    pub async fn write_again<T: Scalar>(
        &self,
        object: Object<T>,
        value: T,
    ) -> Result<(), DriveError> {
        let request = Request {
            retries: self.config.timing.read_retries,
            ..self.request(object.address, Access::Write(value.to_raw()), T::BYTES)
        };
        self.ask(request).await.map(drop)
    }

    /// Writes an object ahead of everything, even of finding out what became of an earlier request.
    pub async fn write_urgently<T: Scalar>(
        &self,
        object: Object<T>,
        value: T,
    ) -> Result<(), DriveError> {
        let request = Request {
            timeout: self.config.timing.timeout_moving,
            retries: self.config.timing.read_retries,
            urgent: true,
            ..self.request(object.address, Access::Write(value.to_raw()), T::BYTES)
        };
        self.ask(request).await.map(drop)
    }

    /// The same where the link seems dead: sent for a drive that may hear without being heard, and given up soon. Until then it is
    /// repeated where the link comes back without its answer.
    pub async fn write_at_last<T: Scalar>(
        &self,
        object: Object<T>,
        value: T,
    ) -> Result<(), DriveError> {
        let request = Request {
            timeout: self.config.timing.timeout_moving.min(LAST_TRY),
            retries: self.config.timing.read_retries,
            urgent: true,
            last: true,
            ..self.request(object.address, Access::Write(value.to_raw()), T::BYTES)
        };
        self.ask(request).await.map(drop)
    }

    /// The next sample of the shaft's position: of the stream where there is one, else asked for on the grid of the poll period.
    pub async fn sample(&mut self) -> Result<ShaftSample, DriveError> {
        if let Some(sample) = self.streamed().await {
            self.next_sample = None;
            return Ok(sample);
        }
        self.poll().await
    }

    async fn poll(&mut self) -> Result<ShaftSample, DriveError> {
        if let Some(due) = self.next_sample {
            self.sleep_until(due).await;
        }
        let (position, answered) = self.read_timed(objects::POSITION_ACTUAL).await?;
        let sample = ShaftSample {
            request: answered.request,
            answer: answered.answer,
            position: Quadcounts(position),
            taken: Taken::Asked,
            device_us: None,
        };
        self.pace(answered.request);
        lock(&self.core).events.push_back(Event::Sample(sample));
        Ok(sample)
    }

    /// Keeps to the grid of the poll period; a sample that is late by more than a period begins a new grid, not a burst.
    fn pace(&mut self, asked: Stamp<Host>) {
        let period = self.config.timing.poll_period;
        let ideal = self.next_sample.unwrap_or(asked).saturating_add(period);
        self.next_sample = Some(if ideal > asked {
            ideal
        } else {
            asked.saturating_add(period)
        });
    }

    pub async fn sleep(&self, span: Span) {
        self.sleep_until(self.now().saturating_add(span)).await;
    }

    /// An alarm ends it early; whatever is asked next tells of it.
    pub async fn sleep_until(&self, until: Stamp<Host>) {
        poll_fn(|_| {
            let mut core = lock(&self.core);
            if core.now >= until || (self.watching && core.has_alarm()) {
                core.wake = None;
                return Poll::Ready(());
            }
            core.wake = Some(until);
            Poll::Pending
        })
        .await;
    }

    fn request(&self, address: Address, access: Access, width: u8) -> Request {
        let timing = &self.config.timing;
        Request {
            address,
            access,
            width,
            timeout: if self.moving {
                timing.timeout_moving
            } else {
                timing.timeout
            },
            marker_timeout: if self.moving {
                timing.timeout_moving.min(MARKER_MOVING)
            } else {
                timing.timeout
            },
            retries: match access {
                Access::Read => timing.read_retries,
                _ => 0,
            },
            urgent: false,
            last: false,
        }
    }

    async fn ask(&self, request: Request) -> Result<Answered, DriveError> {
        let operation = Operation {
            address: request.address,
            wrote: match request.access {
                Access::Write(value) => Some(Wrote::Value(value)),
                _ => None,
            },
        };
        self.ask_as(operation, request).await
    }

    /// Asks on behalf of an operation that takes more than one request.
    async fn ask_as(&self, operation: Operation, request: Request) -> Result<Answered, DriveError> {
        lock(&self.core).link.submit(request);
        let result = poll_fn(|_| {
            let mut core = lock(&self.core);
            if self.watching
                && let Some(alarm) = core.bus.as_mut().and_then(Bus::take_alarm)
            {
                core.link.abandon();
                return Poll::Ready(Err(self.alarmed(alarm)));
            }
            match core.link.take() {
                Some(result) => Poll::Ready(Ok(result)),
                None => Poll::Pending,
            }
        })
        .await?;
        match result {
            Ok(answered) if answered.reply.error.is_none() => Ok(answered),
            Ok(answered) => Err(DriveError::Refused {
                operation,
                error: answered.reply.error,
            }),
            Err(Lost::Answer { attempts, damaged }) => Err(DriveError::NoAnswer {
                operation,
                attempts,
                damaged,
            }),
            Err(Lost::Link { silent }) => Err(DriveError::LinkLost { operation, silent }),
            Err(Lost::Handshake { attempts }) => Err(DriveError::Handshake {
                operation,
                attempts,
            }),
        }
    }

    fn alarmed(&self, alarm: Alarm) -> DriveError {
        let node = self.config.node;
        match alarm {
            Alarm::Emergency(error) => DriveError::Fault { error: Some(error) },
            Alarm::Restarted => DriveError::Restarted { error: None },
            Alarm::Silent(silence) => DriveError::NodeSilent { node, silence },
            Alarm::Left(state) => DriveError::NodeLeft { node, state },
        }
    }
}

impl Core {
    /// Does what the start of a command asks for, once its time is known.
    pub fn begin(&mut self, now: Stamp<Host>) {
        if std::mem::take(&mut self.begins)
            && let Some(bus) = &mut self.bus
        {
            bus.begin(now);
        }
    }

    /// A command has ended.
    pub fn end(&mut self) {
        self.wake = None;
        if let Some(bus) = &mut self.bus {
            bus.end();
        }
    }

    fn has_alarm(&self) -> bool {
        self.bus.as_ref().is_some_and(Bus::has_alarm)
    }
}
