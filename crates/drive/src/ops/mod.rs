//! The operations of a procedure: read, write, wait, sample, report.
//!
//! Each operation is a future that puts its request into a shared core and is ready once the core
//! has the result. [`crate::DriveClient`] drives the core from outside; there is no runtime, I/O or
//! clock here. A procedure dropped halfway leaves at most one reply outstanding.

mod stream;
mod transfer;

use std::collections::VecDeque;
use std::future::poll_fn;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::Poll;

use protocol::epos2::objects::{self, Address, Scalar, TypedObject};
use units::{Degrees, Host, Quadcounts, Span, Stamp};

use crate::can_services::{Alarm, CanServices};
use crate::config::AxisConfig;
use crate::error::{DriveError, Operation, WrittenData};
use crate::event::{CommandProgress, DriveEvent, SampleTrigger, ShaftSample};
use crate::exchange::ObjectAccess;
use crate::link::{LinkRequest, RequestFailure, RequestLink, TimedReply};

/// State shared by the procedure and the client.
#[derive(Debug)]
pub(crate) struct Core {
    pub link: RequestLink,
    /// Services other than SDO, on a CAN bus.
    pub can: Option<CanServices>,
    /// The axis has been referenced since it was connected.
    pub referenced: bool,
    /// Lag of the axis behind its demand, as far as known: a stop takes this distance more.
    pub lag: Option<Degrees>,
    /// Time at which the host was last delayed.
    pub host_delayed: Option<Stamp<Host>>,
    pub now: Stamp<Host>,
    /// A command was started, but [`Core::begin`] has not run yet.
    pub is_starting: bool,
    /// Time at which the running procedure continues without input.
    pub wake: Option<Stamp<Host>>,
    pub events: VecDeque<DriveEvent>,
}

pub(crate) type SharedCore = Arc<Mutex<Core>>;

/// Locks the core. No code panics while it holds the lock, so a poisoned one is consistent.
pub(crate) fn lock(core: &SharedCore) -> MutexGuard<'_, Core> {
    core.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A procedure's handle on the drive.
#[derive(Debug)]
pub(crate) struct Ops {
    core: SharedCore,
    pub config: Arc<AxisConfig>,
    /// The axis may be moving: time limits are short.
    pub is_moving: bool,
    /// Time without any input from the drive that an operation tolerates.
    pub silence_limit: Span,
    /// Time tolerated at least while the host is loaded.
    pub loaded_silence_limit: Span,
    /// An alarm of the CAN bus fails the operation in progress.
    pub aborts_on_alarm: bool,
    /// The power was switched off: friction stops the axis, without a brake slower than a ramp.
    pub is_coasting: bool,
    /// Replies are known to come late: time limits are long, also while the axis may be moving.
    pub is_slow: bool,
    next_sample: Option<Stamp<Host>>,
}

/// Time limit of a probe while the axis moves: it must soon be known whether the link works.
const PROBE_TIMEOUT_MOVING: Span = Span::from_millis(40);
/// Time limit of a quick stop on a link that seems lost: two such probes.
const LAST_ATTEMPT_TIMEOUT: Span = Span::from_millis(80);
/// Time after a delay of the host for which it counts as loaded. With four busy loops per processor
/// delays follow each other within a second or two.
const LOADED_TIME: Span = Span::from_secs(5);

impl Ops {
    pub fn new(core: SharedCore, config: Arc<AxisConfig>) -> Self {
        Self {
            core,
            loaded_silence_limit: config.timing.silence_limit,
            config,
            is_moving: false,
            silence_limit: Span::ZERO,
            aborts_on_alarm: false,
            is_coasting: false,
            is_slow: false,
            next_sample: None,
        }
    }

    /// Calls `act` with the CAN services; `None` on other links.
    pub fn on_can<R>(&self, act: impl FnOnce(&mut CanServices, Stamp<Host>) -> R) -> Option<R> {
        let mut core = lock(&self.core);
        let now = core.now;
        core.can.as_mut().map(|can| act(can, now))
    }

    pub fn was_referenced(&self) -> bool {
        lock(&self.core).referenced
    }

    pub fn set_referenced(&self, referenced: bool) {
        lock(&self.core).referenced = referenced;
    }

    pub fn lag(&self) -> Option<Degrees> {
        lock(&self.core).lag
    }

    pub fn set_lag(&self, lag: Degrees) {
        lock(&self.core).lag = Some(lag);
    }

    pub fn now(&self) -> Stamp<Host> {
        lock(&self.core).now
    }

    pub fn report(&self, progress: CommandProgress) {
        let event = DriveEvent::Progress(progress);
        lock(&self.core).events.push_back(event);
    }

    /// Reads an object. Bits above the object's width are dropped.
    pub async fn read<T: Scalar>(&self, object: TypedObject<T>) -> Result<T, DriveError> {
        Ok(self.read_timed(object).await?.0)
    }

    /// Reads an object; also returns the reply with its times.
    pub async fn read_timed<T: Scalar>(
        &self,
        object: TypedObject<T>,
    ) -> Result<(T, TimedReply), DriveError> {
        let request = self.request(object.address, ObjectAccess::Read);
        let reply = self.send(request).await?;
        let raw = reply.reply.value().unwrap_or_default();
        if object.address == objects::STATUSWORD.address {
            self.report(CommandProgress::Statusword(u16::from_raw(raw)));
        }
        Ok((T::from_raw(raw), reply))
    }

    /// Writes an object.
    pub async fn write<T: Scalar>(
        &self,
        object: TypedObject<T>,
        value: T,
    ) -> Result<(), DriveError> {
        self.send(self.write_request(object, value)).await.map(drop)
    }

    /// Writes an object of `width` bytes.
    pub async fn write_raw(
        &self,
        address: Address,
        value: u32,
        width: u8,
    ) -> Result<(), DriveError> {
        let request = self.request(address, ObjectAccess::Write { value, width });
        self.send(request).await.map(drop)
    }

    /// Writes an object and reads it back.
    pub async fn write_verified<T: Scalar>(
        &self,
        object: TypedObject<T>,
        value: T,
    ) -> Result<(), DriveError> {
        self.write(object, value).await?;
        self.verify(object, value).await
    }

    /// Reads an object and compares its value.
    pub async fn verify<T: Scalar>(
        &self,
        object: TypedObject<T>,
        value: T,
    ) -> Result<(), DriveError> {
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

    /// Changes the bits of `mask` in an object.
    pub async fn write_bits(
        &self,
        object: TypedObject<u16>,
        mask: u16,
        bits: u16,
    ) -> Result<(), DriveError> {
        let old = self.read(object).await?;
        self.write_verified(object, (old & !mask) | (bits & mask))
            .await
    }

    /// Writes an object, with the retries of a read: executing the write twice does no harm.
    pub async fn write_idempotent<T: Scalar>(
        &self,
        object: TypedObject<T>,
        value: T,
    ) -> Result<(), DriveError> {
        let request = LinkRequest {
            retries: self.config.timing.read_retries,
            ..self.write_request(object, value)
        };
        self.send(request).await.map(drop)
    }

    /// Writes an object before anything else, even before the link is resynchronised.
    pub async fn write_urgent<T: Scalar>(
        &self,
        object: TypedObject<T>,
        value: T,
    ) -> Result<(), DriveError> {
        let request = LinkRequest {
            timeout: self.timeout_moving(),
            retries: self.config.timing.read_retries,
            is_urgent: true,
            ..self.write_request(object, value)
        };
        self.send(request).await.map(drop)
    }

    /// Writes an object on a link that seems lost: the drive may still receive. Given up soon;
    /// repeated if the link recovers without a reply.
    pub async fn write_last_attempt<T: Scalar>(
        &self,
        object: TypedObject<T>,
        value: T,
    ) -> Result<(), DriveError> {
        let timing = &self.config.timing;
        let request = LinkRequest {
            timeout: match self.is_slow {
                true => timing.timeout,
                false => timing.timeout_moving.min(LAST_ATTEMPT_TIMEOUT),
            },
            retries: timing.read_retries,
            is_urgent: true,
            is_last_attempt: true,
            ..self.write_request(object, value)
        };
        self.send(request).await.map(drop)
    }

    /// The next position sample: from the stream, else polled on the grid of the poll period.
    pub async fn next_sample(&mut self) -> Result<ShaftSample, DriveError> {
        if let Some(sample) = self.next_streamed().await {
            self.next_sample = None;
            return Ok(sample);
        }
        self.poll_position().await
    }

    async fn poll_position(&mut self) -> Result<ShaftSample, DriveError> {
        if let Some(due) = self.next_sample {
            self.sleep_until(due).await;
        }
        let (position, reply) = self.read_timed(objects::POSITION_ACTUAL).await?;
        let sample = ShaftSample {
            request: reply.sent,
            answer: reply.received,
            position: Quadcounts(position),
            trigger: SampleTrigger::Request,
            drive_us: None,
        };
        let period = self.config.timing.poll_period;
        let due = self.next_sample.unwrap_or(reply.sent);
        let on_grid = due.saturating_add(period);
        // After a delay of more than a period a new grid begins, so that no burst follows.
        self.next_sample = Some(if on_grid > reply.sent {
            on_grid
        } else {
            reply.sent.saturating_add(period)
        });
        let event = DriveEvent::Sample(sample);
        lock(&self.core).events.push_back(event);
        Ok(sample)
    }

    pub async fn sleep(&self, span: Span) {
        self.sleep_until(self.now().saturating_add(span)).await;
    }

    /// Waits until a time, or until an alarm; the next request then fails with it.
    pub async fn sleep_until(&self, until: Stamp<Host>) {
        poll_fn(|_| {
            let mut core = lock(&self.core);
            if core.now >= until || self.is_interrupted(&core) {
                core.wake = None;
                return Poll::Ready(());
            }
            core.wake = Some(until);
            Poll::Pending
        })
        .await;
    }

    /// Time limit of a reply while the axis moves.
    fn timeout_moving(&self) -> Span {
        let timing = &self.config.timing;
        match self.is_slow {
            true => timing.timeout,
            false => timing.timeout_moving,
        }
    }

    fn is_host_loaded(&self) -> bool {
        let core = lock(&self.core);
        core.host_delayed
            .is_some_and(|delayed| core.now.saturating_since(delayed) < LOADED_TIME)
    }

    fn is_interrupted(&self, core: &Core) -> bool {
        self.aborts_on_alarm && core.can.as_ref().is_some_and(|can| can.alarm.is_some())
    }

    fn write_request<T: Scalar>(&self, object: TypedObject<T>, value: T) -> LinkRequest {
        let access = ObjectAccess::Write {
            value: value.to_raw(),
            width: T::BYTES,
        };
        self.request(object.address, access)
    }

    fn request(&self, address: Address, access: ObjectAccess) -> LinkRequest {
        let timing = &self.config.timing;
        let loaded = match self.is_host_loaded() {
            true => self.loaded_silence_limit,
            false => Span::ZERO,
        };
        let (timeout, probe_timeout) = if self.is_moving {
            let timeout = self.timeout_moving();
            let probe_timeout = match self.is_slow {
                true => timeout,
                false => timeout.min(PROBE_TIMEOUT_MOVING),
            };
            (timeout, probe_timeout)
        } else {
            let timeout = timing.timeout.max(loaded);
            (timeout, timeout)
        };
        LinkRequest {
            address,
            access,
            timeout,
            probe_timeout,
            retries: match access {
                ObjectAccess::Read => timing.read_retries,
                _ => 0,
            },
            silence_limit: self.silence_limit.max(loaded),
            is_urgent: false,
            is_last_attempt: false,
        }
    }

    async fn send(&self, request: LinkRequest) -> Result<TimedReply, DriveError> {
        let operation = Operation {
            address: request.address,
            written: match request.access {
                ObjectAccess::Write { value, .. } => Some(WrittenData::Value(value)),
                _ => None,
            },
        };
        self.send_as(operation, request).await
    }

    /// Sends one request of `operation`.
    async fn send_as(
        &self,
        operation: Operation,
        request: LinkRequest,
    ) -> Result<TimedReply, DriveError> {
        lock(&self.core).link.submit(request);
        let result = poll_fn(|_| {
            let mut core = lock(&self.core);
            if self.aborts_on_alarm
                && let Some(alarm) = core.can.as_mut().and_then(|can| can.alarm.take())
            {
                core.link.abandon();
                return Poll::Ready(Err(self.alarm_error(alarm)));
            }
            match core.link.take_result() {
                Some(result) => Poll::Ready(Ok(result)),
                None => Poll::Pending,
            }
        })
        .await?;
        match result {
            Ok(reply) if reply.reply.error().is_none() => Ok(reply),
            Ok(reply) => Err(DriveError::Refused {
                operation,
                error: reply.reply.error(),
            }),
            Err(RequestFailure::NoReply { attempts, damaged }) => Err(DriveError::NoAnswer {
                operation,
                attempts,
                damaged,
            }),
            Err(RequestFailure::LinkLost { silent }) => {
                Err(DriveError::LinkLost { operation, silent })
            }
            Err(RequestFailure::HandshakeRefused { attempts }) => Err(DriveError::Handshake {
                operation,
                attempts,
            }),
        }
    }

    fn alarm_error(&self, alarm: Alarm) -> DriveError {
        let node = self.config.node;
        match alarm {
            Alarm::Emergency(error) => DriveError::Fault { error: Some(error) },
            Alarm::BootUp => DriveError::Restarted { error: None },
            Alarm::HeartbeatLost(silence) => DriveError::NodeSilent { node, silence },
            Alarm::NotOperational(state) => DriveError::NodeLeft { node, state },
        }
    }
}

impl Core {
    /// Starts the CAN services of a command, once its start time is known.
    pub fn begin(&mut self, now: Stamp<Host>) {
        if std::mem::take(&mut self.is_starting)
            && let Some(can) = &mut self.can
        {
            can.begin(now);
        }
    }

    /// Ends a command.
    pub fn end(&mut self) {
        self.wake = None;
        if let Some(can) = &mut self.can {
            can.end();
        }
    }
}
