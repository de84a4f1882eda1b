//! What a procedure may do: read, write, wait, sample, tell.
//!
//! Each operation is a future that leaves its wish in a shared core and is ready once the core has the answer. The core is
//! driven from outside by [`crate::Client`]; there is no runtime, no I/O and no clock here, and a procedure that is
//! dropped in the middle leaves nothing behind but perhaps one answer still under way.

use std::collections::VecDeque;
use std::future::poll_fn;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::Poll;

use protocol::epos2::objects::{self, Address, Object, Scalar};
use units::{Host, Quadcounts, Span, Stamp};

use crate::config::AxisConfig;
use crate::error::{DriveError, Operation};
use crate::event::{Event, Progress, ShaftSample};
use crate::link::{Answered, Link, Lost, Request};
use crate::pairing::Access;

/// What procedures and client share.
#[derive(Debug)]
pub(crate) struct Core {
    pub link: Link,
    pub now: Stamp<Host>,
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
    next_sample: Option<Stamp<Host>>,
}

impl Ops {
    pub fn new(core: Shared, config: Arc<AxisConfig>) -> Self {
        Self {
            core,
            config,
            moving: false,
            next_sample: None,
        }
    }

    /// Whether the axis may be moving, so that a lost answer is noticed sooner.
    pub fn set_moving(&mut self, moving: bool) {
        self.moving = moving;
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

    async fn read_timed<T: Scalar>(&self, object: Object<T>) -> Result<(T, Answered), DriveError> {
        let request = self.request(object.address, Access::Read);
        let answered = self.ask(request).await?;
        let raw = answered.reply.value.unwrap_or_default();
        Ok((T::from_raw(raw), answered))
    }

    /// Writes an object.
    pub async fn write<T: Scalar>(&self, object: Object<T>, value: T) -> Result<(), DriveError> {
        let request = self.request(object.address, Access::Write(value.to_raw()));
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
            ..self.request(object.address, Access::Write(value.to_raw()))
        };
        self.ask(request).await.map(drop)
    }

    /// Samples the shaft's position on the grid of the poll period.
    pub async fn sample(&mut self) -> Result<ShaftSample, DriveError> {
        if let Some(due) = self.next_sample {
            self.sleep_until(due).await;
        }
        let (position, answered) = self.read_timed(objects::POSITION_ACTUAL).await?;
        let sample = ShaftSample {
            request: answered.request,
            answer: answered.answer,
            position: Quadcounts(position),
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

    pub async fn sleep_until(&self, until: Stamp<Host>) {
        poll_fn(|_| {
            let mut core = lock(&self.core);
            if core.now >= until {
                core.wake = None;
                return Poll::Ready(());
            }
            core.wake = Some(until);
            Poll::Pending
        })
        .await;
    }

    fn request(&self, address: Address, access: Access) -> Request {
        let timing = &self.config.timing;
        Request {
            address,
            access,
            timeout: if self.moving {
                timing.timeout_moving
            } else {
                timing.timeout
            },
            retries: match access {
                Access::Read => timing.read_retries,
                Access::Write(_) | Access::Other => 0,
            },
            urgent: false,
        }
    }

    async fn ask(&self, request: Request) -> Result<Answered, DriveError> {
        lock(&self.core).link.submit(request);
        let result = poll_fn(|_| match lock(&self.core).link.take() {
            Some(result) => Poll::Ready(result),
            None => Poll::Pending,
        })
        .await;
        let operation = Operation {
            address: request.address,
            wrote: match request.access {
                Access::Write(value) => Some(value),
                Access::Read | Access::Other => None,
            },
        };
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
        }
    }
}
