//! What happens, to everybody who wants to know it: each subscriber has a bounded queue, and the one who does not read is left behind.
//!
//! Telling never waits. Left out: how it reaches anybody (`http::events`).

pub mod inside;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use axum::body::Bytes;
use axum::extract::ws::Utf8Bytes;
use serde::Serialize;
use tokio::sync::{Notify, mpsc};
use units::{Host, Stamp};

use super::limits::{QUEUE, SUBSCRIBERS};
use super::points::Frame;
use super::scans::ScanView;
use super::view::Status;
use inside::Teller;

/// Something that happens. As JSON with a `type`, but for points.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Event {
    /// How everything is.
    Status {
        /// That.
        status: Box<Status>,
    },
    /// The axis moves.
    Motion {
        /// Where it is.
        angle_deg: f64,
        /// How fast it moves.
        speed_deg_s: f64,
        /// How long the move will still take.
        left_s: Option<f64>,
        /// Lidar packets of the capture so far.
        packets: u64,
        /// When it was there.
        #[serde(skip)]
        at: Stamp<Host>,
    },
    /// A scan began, changed, or is gone.
    Scan {
        /// Which.
        scan: Box<ScanView>,
        /// Whether it is gone.
        deleted: bool,
    },
    /// Something to be said.
    Message {
        /// How bad it is.
        level: Level,
        /// What.
        text: String,
        /// What to do about it.
        help: Option<String>,
    },
    /// Points while they are measured.
    #[serde(skip)]
    Points(Box<Frame>),
}

/// How bad a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Good to know.
    Info,
    /// Something may be wrong.
    Warning,
    /// Something is.
    Error,
}

/// An event on its way; its bytes are made once, when the first wants them.
#[derive(Debug)]
pub struct Told {
    /// What happened.
    pub event: Event,
    text: OnceLock<Utf8Bytes>,
    bytes: OnceLock<Bytes>,
}

impl From<Event> for Told {
    fn from(event: Event) -> Self {
        Self {
            event,
            text: OnceLock::new(),
            bytes: OnceLock::new(),
        }
    }
}

impl Told {
    /// The event as JSON; points have none.
    #[must_use]
    pub fn json(&self) -> Utf8Bytes {
        let text = || {
            serde_json::to_string(&self.event)
                .unwrap_or_default()
                .into()
        };
        self.text.get_or_init(text).clone()
    }

    /// Every `thin`-th point in the binary layout; `None` of what is no points.
    #[must_use]
    pub fn points(&self, thin: usize) -> Option<Bytes> {
        let Event::Points(frame) = &self.event else {
            return None;
        };
        Some(match thin {
            0 | 1 => self.bytes.get_or_init(|| frame.encode(1).into()).clone(),
            _ => frame.encode(thin).into(),
        })
    }
}

/// Where everything is told.
#[derive(Debug, Default)]
pub struct Hub {
    subscribers: Mutex<Vec<Subscriber>>,
    inside: Mutex<Vec<Teller>>,
    dropped: AtomicU64,
    next: AtomicU64,
}

#[derive(Debug)]
struct Subscriber {
    id: u64,
    points: bool,
    queue: mpsc::Sender<Arc<Told>>,
    gone: Arc<Notify>,
}

/// One who is told.
#[derive(Debug)]
pub struct Subscription {
    hub: Arc<Hub>,
    id: u64,
    queue: mpsc::Receiver<Arc<Told>>,
    gone: Arc<Notify>,
}

impl Hub {
    fn subscribers(&self) -> MutexGuard<'_, Vec<Subscriber>> {
        self.subscribers
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    fn inside(&self) -> MutexGuard<'_, Vec<Teller>> {
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells from now on, points too if they are wanted; `None` where there are too many already.
    #[must_use]
    pub fn subscribe(self: &Arc<Self>, points: bool) -> Option<Subscription> {
        let mut subscribers = self.subscribers();
        if subscribers.len() >= SUBSCRIBERS {
            return None;
        }
        let (queue, inbox) = mpsc::channel(QUEUE);
        let gone = Arc::new(Notify::new());
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        subscribers.push(Subscriber {
            id,
            points,
            queue,
            gone: Arc::clone(&gone),
        });
        Some(Subscription {
            hub: Arc::clone(self),
            id,
            queue: inbox,
            gone,
        })
    }

    /// Tells everybody. Whose queue is full is left behind.
    pub fn tell(&self, event: Event) {
        if self.is_empty() {
            return;
        }
        let points = matches!(event, Event::Points(_));
        let told = Arc::new(Told::from(event));
        for teller in self.inside().iter().filter(|t| t.wants(&told.event)) {
            teller.tell(&told);
        }
        self.subscribers().retain(|subscriber| {
            if points && !subscriber.points {
                return true;
            }
            let keeps_up = subscriber.queue.try_send(Arc::clone(&told)).is_ok();
            if !keeps_up {
                self.dropped.fetch_add(1, Ordering::Relaxed);
                subscriber.gone.notify_one();
            }
            keeps_up
        });
    }

    /// Says something.
    pub fn say(&self, level: Level, text: impl Into<String>, help: Option<String>) {
        let text = text.into();
        // What to do is a line of its own.
        let line = match &help {
            Some(help) => format!("{text}\n{help}"),
            None => text.clone(),
        };
        match level {
            Level::Info => tracing::info!("{line}"),
            Level::Warning => tracing::warn!("{line}"),
            Level::Error => tracing::error!("{line}"),
        }
        self.tell(Event::Message { level, text, help });
    }

    /// Whether anybody wants points.
    #[must_use]
    pub fn wants_points(&self) -> bool {
        self.subscribers().iter().any(|s| s.points)
            || self.inside().iter().any(Teller::wants_points)
    }

    /// Clients that are told now; threads of the daemon are none.
    #[must_use]
    pub fn len(&self) -> usize {
        self.subscribers().len()
    }

    /// Whether nobody is told.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.subscribers().is_empty() && self.inside().is_empty()
    }

    /// How many were left behind.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }
}

impl Subscription {
    /// The next event; `None` once this one was left behind.
    pub async fn next(&mut self) -> Option<Arc<Told>> {
        self.queue.recv().await
    }

    /// What tells, once, that this one was left behind: also to who is busy with an older event.
    #[must_use]
    pub fn left_behind(&self) -> Arc<Notify> {
        Arc::clone(&self.gone)
    }
}

impl Drop for Subscription {
    fn drop(&mut self) {
        let mut subscribers = self.hub.subscribers();
        subscribers.retain(|subscriber| subscriber.id != self.id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(number: usize) -> Event {
        Event::Message {
            level: Level::Info,
            text: number.to_string(),
            help: None,
        }
    }

    #[test]
    fn who_does_not_read_is_left_behind_and_the_others_miss_nothing() {
        let hub = Arc::new(Hub::default());
        let idle = hub.subscribe(true).unwrap();
        let mut reader = hub.subscribe(true).unwrap();
        for number in 0..=QUEUE {
            hub.tell(message(number));
            let told = reader.queue.try_recv().unwrap();
            assert!(told.json().contains(&format!("\"{number}\"")));
        }
        assert_eq!((hub.len(), hub.dropped()), (1, 1));
        drop(idle);
        assert_eq!(hub.len(), 1);
        drop(reader);
        assert!(hub.is_empty());
    }

    #[test]
    fn there_are_no_more_subscribers_than_allowed() {
        let hub = Arc::new(Hub::default());
        let all: Vec<_> = (0..SUBSCRIBERS).map(|_| hub.subscribe(false)).collect();
        assert!(all.iter().all(Option::is_some));
        assert!(hub.subscribe(false).is_none());
        drop(all);
        assert!(hub.subscribe(true).is_some());
    }

    #[test]
    fn events_are_json_with_a_type() {
        let text = serde_json::to_value(message(3)).unwrap();
        let wanted =
            serde_json::json!({"type": "message", "level": "info", "text": "3", "help": null});
        assert_eq!(text, wanted);
    }
}
