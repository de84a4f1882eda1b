//! Threads of the daemon that are told: they are no clients, and are not left behind. What their queue has no room for is left out and counted.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::Duration;

use super::{Event, Hub, Told};
use crate::limits::QUEUE;

/// What a thread wants to be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Wants {
    /// What becomes of scans.
    Scans,
    /// Everything but points.
    Events,
    /// Everything.
    Points,
}

impl Wants {
    const fn wants(self, event: &Event) -> bool {
        match self {
            Self::Scans => matches!(event, Event::Scan { .. }),
            Self::Events => !matches!(event, Event::Points(_)),
            Self::Points => true,
        }
    }
}

/// What can be changed about it by whoever has one.
#[derive(Clone, Debug)]
pub struct SweepRequest(Arc<AtomicU8>);

impl SweepRequest {
    fn new(wants: Wants) -> Self {
        Self(Arc::new(AtomicU8::new(wants as u8)))
    }

    /// From now on this.
    pub fn set(&self, wants: Wants) {
        self.0.store(wants as u8, Ordering::Relaxed);
    }

    fn get(&self) -> Wants {
        match self.0.load(Ordering::Relaxed) {
            0 => Wants::Scans,
            1 => Wants::Events,
            _ => Wants::Points,
        }
    }
}

/// The hub's end.
#[derive(Debug)]
pub(super) struct Teller {
    id: u64,
    wish: SweepRequest,
    queue: SyncSender<Arc<Told>>,
    missed: Arc<AtomicU64>,
}

impl Teller {
    pub(super) fn wants(&self, event: &Event) -> bool {
        self.wish.get().wants(event)
    }

    pub(super) fn wants_points(&self) -> bool {
        self.wish.get() == Wants::Points
    }

    pub(super) fn tell(&self, told: &Arc<Told>) {
        if self.queue.try_send(Arc::clone(told)).is_err() {
            self.missed.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// The thread's end. Dropped, it is told no more.
#[derive(Debug)]
pub struct Inside {
    hub: Arc<Hub>,
    id: u64,
    wish: SweepRequest,
    queue: Receiver<Arc<Told>>,
}

impl Hub {
    /// Tells a thread of the daemon from now on what it `wants`; `missed` counts what it had no room for.
    #[must_use]
    pub fn subscribe_inside(self: &Arc<Self>, wants: Wants, missed: &Arc<AtomicU64>) -> Inside {
        let (queue, inbox) = sync_channel(QUEUE);
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        let wish = SweepRequest::new(wants);
        self.inside().push(Teller {
            id,
            wish: wish.clone(),
            queue,
            missed: Arc::clone(missed),
        });
        Inside {
            hub: Arc::clone(self),
            id,
            wish,
            queue: inbox,
        }
    }
}

impl Inside {
    /// The next event, or that none came in this time.
    ///
    /// # Errors
    /// [`RecvTimeoutError::Timeout`].
    pub fn next(&self, within: Duration) -> Result<Arc<Told>, RecvTimeoutError> {
        self.queue.recv_timeout(within)
    }

    /// What changes what it wants.
    #[must_use]
    pub fn wish(&self) -> SweepRequest {
        self.wish.clone()
    }
}

impl Drop for Inside {
    fn drop(&mut self) {
        self.hub.inside().retain(|teller| teller.id != self.id);
    }
}

#[cfg(test)]
mod tests {
    use super::super::Level;
    use super::*;

    #[test]
    fn what_a_thread_has_no_room_for_is_counted_and_it_goes_on() {
        let hub = Arc::new(Hub::default());
        let missed = Arc::new(AtomicU64::new(0));
        let inside = hub.subscribe_inside(Wants::Events, &missed);
        assert!(!hub.is_empty() && !hub.wants_points());
        inside.wish().set(Wants::Points);
        assert!(hub.wants_points());
        inside.wish().set(Wants::Events);
        let say = |number: usize| hub.say(Level::Info, number.to_string(), None);
        (0..QUEUE + 3).for_each(say);
        assert_eq!(missed.load(Ordering::Relaxed), 3);
        assert_eq!((hub.len(), hub.dropped()), (0, 0));
        let next = || inside.next(Duration::ZERO).map(|told| told.json());
        for number in 0..QUEUE {
            assert!(next().unwrap().contains(&format!("\"{number}\"")));
        }
        assert_eq!(next(), Err(RecvTimeoutError::Timeout));
        say(7);
        assert!(next().unwrap().contains("\"7\""));
        // What is not wanted takes no room.
        inside.wish().set(Wants::Scans);
        (0..QUEUE + 3).for_each(say);
        assert_eq!(missed.load(Ordering::Relaxed), 3);
        drop(inside);
        assert!(hub.is_empty());
    }
}
