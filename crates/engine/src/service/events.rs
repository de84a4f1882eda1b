//! Events for every client of the devices: one broadcast channel, which never makes a sender wait.
//!
//! A subscriber that falls more than [`QUEUE`] events behind misses the oldest ones and finds out
//! at its next event.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

use serde::Serialize;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, broadcast};
use units::{Host, Stamp};
use utoipa::ToSchema;

pub use tokio::sync::broadcast::error::RecvError;

use super::live_preview::PreviewFrame;
use super::scan_record::ScanView;
use super::status::ServiceStatus;
use crate::failure::Failure;

/// Event clients at once (docs/src/daemon.md).
pub const SUBSCRIBERS: usize = 32;
/// Events that may wait for a subscriber: 12 s of a moving axis, which reports 20 times a second.
pub const QUEUE: usize = 256;

/// Something that happened. All but points have a JSON form with a `type`.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(example = json!({
    "type": "motion", "angle_deg": -12.5, "speed_deg_s": -56.25, "left_s": 0.6, "received": 5_210,
}))]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Event {
    /// The status changed, or a second has passed.
    Status {
        /// The status at that time.
        status: Box<ServiceStatus>,
    },
    /// The axis moved.
    Motion {
        /// Angle, degrees.
        angle_deg: f64,
        /// Speed, degrees per second.
        speed_deg_s: f64,
        /// Time left of the move, seconds.
        left_s: Option<f64>,
        /// Lidar packets of the capture so far.
        received: u64,
        /// Time of the angle.
        #[serde(skip)]
        at: Stamp<Host>,
    },
    /// A scan was begun, changed or deleted.
    Scan {
        /// The scan.
        scan: Box<ScanView>,
        /// Whether it was deleted.
        deleted: bool,
    },
    /// A message for people.
    Message {
        /// Severity.
        level: MessageLevel,
        /// Text.
        text: String,
        /// What to do about it.
        help: Option<String>,
    },
    /// Points of a sweep in progress.
    #[serde(skip)]
    Points(Box<PreviewFrame>),
}

/// Severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum MessageLevel {
    /// For information.
    Info,
    /// Something may be wrong.
    Warning,
    /// Something is wrong.
    Error,
}

/// The sending side, shared by everything that reports events.
#[derive(Debug)]
pub struct Events {
    logs: bool,
    sender: broadcast::Sender<Arc<Event>>,
    client_permits: Arc<Semaphore>,
    disconnected: AtomicU64,
    points_requests: AtomicUsize,
}

impl Events {
    /// Without subscribers; `logs` writes messages to the log, too.
    #[must_use]
    pub fn new(logs: bool) -> Self {
        Self {
            logs,
            sender: broadcast::Sender::new(QUEUE),
            client_permits: Arc::new(Semaphore::new(SUBSCRIBERS)),
            disconnected: AtomicU64::new(0),
            points_requests: AtomicUsize::new(0),
        }
    }

    /// Subscribes a client; `None` while [`SUBSCRIBERS`] clients are connected.
    #[must_use]
    pub fn subscribe_client(&self) -> Option<Subscription> {
        let permit = Arc::clone(&self.client_permits).try_acquire_owned().ok()?;
        Some(Subscription {
            receiver: self.sender.subscribe(),
            _permit: Some(permit),
        })
    }

    /// Subscribes a part of this program, which does not count as a client.
    #[must_use]
    pub fn subscribe(&self) -> Subscription {
        Subscription {
            receiver: self.sender.subscribe(),
            _permit: None,
        }
    }

    /// Sends an event to all subscribers.
    pub fn send(&self, event: Event) {
        if self.has_subscribers() {
            // The last subscriber may have left meanwhile.
            let _ = self.sender.send(Arc::new(event));
        }
    }

    /// Logs a message and sends it to all subscribers.
    pub fn message(&self, level: MessageLevel, text: impl Into<String>, help: Option<String>) {
        let text = text.into();
        // The log has the help on a line of its own.
        let line = match &help {
            Some(help) => format!("{text}\n{help}"),
            None => text.clone(),
        };
        match level {
            _ if !self.logs => {}
            MessageLevel::Info => tracing::info!("{line}"),
            MessageLevel::Warning => tracing::warn!("{line}"),
            MessageLevel::Error => tracing::error!("{line}"),
        }
        self.send(Event::Message { level, text, help });
    }

    /// Sends a failure as a message, with its help.
    pub fn failure(&self, level: MessageLevel, failure: Failure) {
        self.message(level, failure.message, failure.help);
    }

    /// Whether anything subscribes.
    #[must_use]
    pub fn has_subscribers(&self) -> bool {
        self.sender.receiver_count() > 0
    }

    /// Clients connected now.
    #[must_use]
    pub fn clients(&self) -> usize {
        SUBSCRIBERS.saturating_sub(self.client_permits.available_permits())
    }

    /// Waits until no client is connected.
    pub async fn clients_gone(&self) {
        let all = u32::try_from(SUBSCRIBERS).unwrap_or(u32::MAX);
        drop(self.client_permits.acquire_many(all).await);
    }

    /// Clients disconnected because they did not read.
    #[must_use]
    pub fn disconnected(&self) -> u64 {
        self.disconnected.load(Ordering::Relaxed)
    }

    /// Counts a client that was disconnected because it did not read.
    pub fn count_disconnected(&self) {
        self.disconnected.fetch_add(1, Ordering::Relaxed);
    }

    /// Whether any subscriber wants points.
    #[must_use]
    pub fn wants_points(&self) -> bool {
        self.points_requests.load(Ordering::Relaxed) > 0
    }
}

/// The receiving side. Dropping it ends the subscription.
#[derive(Debug)]
pub struct Subscription {
    receiver: broadcast::Receiver<Arc<Event>>,
    _permit: Option<OwnedSemaphorePermit>,
}

impl Subscription {
    /// The next event.
    ///
    /// # Errors
    /// [`RecvError`].
    pub async fn next(&mut self) -> Result<Arc<Event>, RecvError> {
        self.receiver.recv().await
    }

    /// Whether events have been lost already, though the next call has not reported it yet.
    #[must_use]
    pub fn has_lagged(&self) -> bool {
        self.receiver.len() > QUEUE
    }
}

/// A request for points that can be switched on and off. Dropping it withdraws the request.
#[derive(Debug)]
pub struct PointsRequest {
    events: Arc<Events>,
    wanted: AtomicBool,
}

impl PointsRequest {
    /// A request for points, if they are `wanted` from the start.
    #[must_use]
    pub fn new(events: &Arc<Events>, wanted: bool) -> Self {
        let request = Self {
            events: Arc::clone(events),
            wanted: AtomicBool::new(false),
        };
        request.set(wanted);
        request
    }

    /// Changes the request.
    pub fn set(&self, wanted: bool) {
        let requests = &self.events.points_requests;
        match (self.wanted.swap(wanted, Ordering::Relaxed), wanted) {
            (false, true) => requests.fetch_add(1, Ordering::Relaxed),
            (true, false) => requests.fetch_sub(1, Ordering::Relaxed),
            _ => 0,
        };
    }
}

impl Drop for PointsRequest {
    fn drop(&mut self) {
        self.set(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(number: usize) -> Event {
        Event::Message {
            level: MessageLevel::Info,
            text: number.to_string(),
            help: None,
        }
    }

    /// The next event without waiting.
    fn next(subscription: &mut Subscription) -> Result<Arc<Event>, RecvError> {
        use std::future::Future;
        use std::task::{Context, Poll, Waker};
        let mut next = std::pin::pin!(subscription.next());
        match next.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            Poll::Ready(event) => event,
            Poll::Pending => Err(RecvError::Closed),
        }
    }

    fn text(event: &Event) -> String {
        serde_json::to_string(event).unwrap()
    }

    #[test]
    fn slow_subscribers_lag_without_affecting_others() {
        let events = Arc::new(Events::new(false));
        let mut idle = events.subscribe_client().unwrap();
        let mut reader = events.subscribe_client().unwrap();
        for number in 0..QUEUE + 3 {
            events.send(message(number));
            let event = next(&mut reader).unwrap();
            assert!(text(&event).contains(&format!("\"{number}\"")));
        }
        assert!(idle.has_lagged() && !reader.has_lagged());
        assert_eq!(next(&mut idle).unwrap_err(), RecvError::Lagged(3));
        // It continues with the oldest remaining event.
        for number in 3..QUEUE + 3 {
            let event = next(&mut idle).unwrap();
            assert!(text(&event).contains(&format!("\"{number}\"")));
        }
        assert_eq!((events.clients(), events.disconnected()), (2, 0));
        drop(idle);
        events.count_disconnected();
        assert_eq!((events.clients(), events.disconnected()), (1, 1));
        drop(reader);
        assert!(!events.has_subscribers());
    }

    #[test]
    fn clients_are_limited_and_other_subscribers_are_not() {
        let events = Arc::new(Events::new(false));
        let all: Vec<_> = (0..SUBSCRIBERS)
            .map(|_| events.subscribe_client())
            .collect();
        assert!(all.iter().all(Option::is_some));
        assert!(events.subscribe_client().is_none());
        let other = events.subscribe();
        assert_eq!(events.clients(), SUBSCRIBERS);
        drop(all);
        assert!(events.subscribe_client().is_some());
        assert!(events.has_subscribers());
        drop(other);
        assert!(!events.has_subscribers());
    }

    #[test]
    fn points_are_produced_while_any_request_is_active() {
        let events = Arc::new(Events::new(false));
        let (one, other) = (
            PointsRequest::new(&events, false),
            PointsRequest::new(&events, true),
        );
        assert!(events.wants_points());
        drop(other);
        assert!(!events.wants_points());
        one.set(true);
        one.set(true);
        assert!(events.wants_points());
        one.set(false);
        assert!(!events.wants_points());
    }

    #[test]
    fn events_are_json_with_a_type() {
        let text = serde_json::to_value(message(3)).unwrap();
        let wanted =
            serde_json::json!({"type": "message", "level": "info", "text": "3", "help": null});
        assert_eq!(text, wanted);
    }
}
