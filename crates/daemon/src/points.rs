//! Points while they are measured: what the page gets to see of a sweep that goes on.
//!
//! `scanner::Live` runs on a thread of its own, behind a bounded queue that nobody waits for: what does not fit is left out of the view and
//! counted; the log has it. The binary layout is that of docs/src/daemon.md.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use cloud::{Fields, Points, Sink, SinkError};
use io::log::OwnedRecord;
use protocol::record::Record;
use scanner::{Live, ScanConfig};

use super::hub::{Event, Hub};
use super::limits::{FRAME_POINTS, LIVE_RECORDS};

/// What a frame carries beside positions.
const FIELDS: [Fields; 5] = [
    Fields::INTENSITY,
    Fields::RING,
    Fields::TIME,
    Fields::TILT,
    Fields::SD,
];
/// How old the first point of a frame gets before it is sent.
const PAUSE: Duration = Duration::from_millis(50);
const HEAD: usize = 32;

/// Some thousand points of a sweep that goes on.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The scan's id.
    pub scan: Arc<str>,
    /// Number of this frame within the scan.
    pub number: u32,
    /// Records that were left out of the view so far.
    pub left_out: u32,
    /// The points, with intensity, ring, time, tilt and sd.
    pub points: Points,
}

impl Frame {
    /// Every `thin`-th point in the binary layout.
    #[must_use]
    pub fn encode(&self, thin: usize) -> Vec<u8> {
        let thin = thin.max(1);
        let points = &self.points;
        let count = points.len().div_ceil(thin);
        let first_ns = points.time().first().map_or(0, |time| time.as_nanos());
        let tilt = points.tilt_deg().last().copied().unwrap_or(f64::NAN);
        let mut bytes = Vec::with_capacity(HEAD + 22 * count);
        bytes.extend_from_slice(b"VMP1");
        bytes.extend_from_slice(&u32::try_from(count).unwrap_or(u32::MAX).to_le_bytes());
        bytes.extend_from_slice(&(first_ns as f64 * 1e-9).to_le_bytes());
        bytes.extend_from_slice(&self.number.to_le_bytes());
        bytes.extend_from_slice(&self.left_out.to_le_bytes());
        bytes.extend_from_slice(&(tilt as f32).to_le_bytes());
        bytes.extend_from_slice(&0_u32.to_le_bytes());
        let mut put = |value: f64| bytes.extend_from_slice(&(value as f32).to_le_bytes());
        for position in points.positions().step_by(thin) {
            position.into_iter().for_each(&mut put);
        }
        for time in points.time().iter().step_by(thin) {
            put((time.as_nanos() - first_ns) as f64 * 1e-9);
        }
        points.sd_m().iter().step_by(thin).copied().for_each(put);
        bytes.extend(points.intensity().iter().step_by(thin));
        bytes.extend(points.ring().iter().step_by(thin));
        bytes
    }
}

/// Where both devices put their records while a scan is watched. Clones are of one place.
#[derive(Clone, Default)]
pub struct Feed {
    place: Arc<Mutex<Option<Way>>>,
}

#[derive(Clone)]
struct Way {
    queue: SyncSender<Message>,
    left_out: Arc<AtomicU64>,
}

enum Message {
    Record(OwnedRecord),
    End,
}

impl Feed {
    /// Hands a record over without waiting, if a scan is watched.
    pub fn record(&self, record: &Record<'_>) {
        let place = self.place.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(way) = &*place else { return };
        match way.queue.try_send(Message::Record(record.into())) {
            Ok(()) | Err(TrySendError::Disconnected(_)) => {}
            Err(TrySendError::Full(_)) => {
                way.left_out.fetch_add(1, Ordering::Relaxed);
            }
        }
    }

    fn put(&self, way: Option<Way>) {
        *self.place.lock().unwrap_or_else(PoisonError::into_inner) = way;
    }
}

/// A scan that is watched. Dropped, the watching ends.
pub struct Watching {
    feed: Feed,
    queue: SyncSender<Message>,
    thread: Option<JoinHandle<()>>,
}

impl Watching {
    /// Watches the scan `id` of devices that are configured so, by what comes through `feed`. `None` where that cannot be: a scan is worth
    /// making all the same.
    #[must_use]
    pub fn start(id: &str, config: &ScanConfig, feed: &Feed, hub: &Arc<Hub>) -> Option<Self> {
        let (queue, inbox) = sync_channel(LIVE_RECORDS);
        let left_out = Arc::new(AtomicU64::new(0));
        let frames = Frames::new(id, hub, &left_out);
        let config = config.clone();
        let thread = std::thread::Builder::new()
            .name("live points".to_owned())
            .spawn(move || watch(&config, frames, &inbox))
            .ok()?;
        let way = Way {
            queue: queue.clone(),
            left_out,
        };
        feed.put(Some(way));
        Some(Self {
            feed: feed.clone(),
            queue,
            thread: Some(thread),
        })
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        self.feed.put(None);
        // Waits where the queue is full, of a thread that does nothing but empty it.
        let _ = self.queue.send(Message::End);
        if let Some(thread) = self.thread.take() {
            // A panic there loses the view, not the scan.
            let _ = thread.join();
        }
    }
}

fn watch(config: &ScanConfig, mut frames: Frames, inbox: &Receiver<Message>) {
    let Ok(mut live) = Live::new(config, lidar::Options::default(), &mut frames) else {
        return;
    };
    while let Ok(Message::Record(record)) = inbox.recv() {
        if live.observe(&record.as_record()).is_err() {
            break;
        }
    }
    // This sink refuses nothing.
    let _ = live.finish();
    frames.send();
}

/// A sink that sends frames.
struct Frames {
    scan: Arc<str>,
    hub: Arc<Hub>,
    left_out: Arc<AtomicU64>,
    points: Points,
    since: Instant,
    number: u32,
}

impl Frames {
    fn new(id: &str, hub: &Arc<Hub>, left_out: &Arc<AtomicU64>) -> Self {
        Self {
            scan: id.into(),
            hub: Arc::clone(hub),
            left_out: Arc::clone(left_out),
            points: Points::new(fields()),
            since: Instant::now(),
            number: 0,
        }
    }

    fn send(&mut self) {
        if self.points.is_empty() {
            return;
        }
        let points = std::mem::replace(&mut self.points, Points::new(fields()));
        let left_out = self.left_out.load(Ordering::Relaxed);
        self.hub.tell(Event::Points(Box::new(Frame {
            scan: Arc::clone(&self.scan),
            number: self.number,
            left_out: u32::try_from(left_out).unwrap_or(u32::MAX),
            points,
        })));
        self.number += 1;
    }
}

fn fields() -> Fields {
    FIELDS
        .into_iter()
        .fold(Fields::NONE, |all, field| all | field)
}

impl Sink for Frames {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        // Unasked is absent.
        if !self.hub.wants_points() {
            return Ok(());
        }
        if self.points.is_empty() {
            self.since = Instant::now();
        }
        for point in batch.iter() {
            self.points.push(point);
            if self.points.len() >= FRAME_POINTS {
                self.send();
            }
        }
        if self.since.elapsed() >= PAUSE {
            self.send();
        }
        Ok(())
    }

    fn fields(&self) -> Fields {
        fields()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloud::Point;
    use units::{Degrees, Stamp};

    #[test]
    fn the_layout_is_as_documented() {
        let mut points = Points::new(fields());
        for number in 0..5_u8 {
            points.push(Point {
                position_m: [f64::from(number), 0.5, -2.0],
                intensity: 10 + number,
                ring: number,
                time: Stamp::from_nanos(1_700_000_000_000_000_000 + 1_000_000 * i64::from(number)),
                tilt: Degrees(-10.0 - f64::from(number)),
                sd_m: 0.03,
                ..Point::default()
            });
        }
        let frame = Frame {
            scan: "hall".into(),
            number: 7,
            left_out: 2,
            points,
        };
        let bytes = frame.encode(2);
        let f32_at = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let u32_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!(&bytes[..4], b"VMP1");
        let n = 3;
        assert_eq!((u32_at(4), u32_at(16), u32_at(20)), (3, 7, 2));
        let base = f64::from_le_bytes(bytes[8..16].try_into().unwrap());
        assert!((base - 1.7e9).abs() < 1e-6);
        assert!((f32_at(24) + 14.0).abs() < 1e-6);
        assert_eq!(
            (f32_at(32 + 12), f32_at(32 + 16), f32_at(32 + 20)),
            (2.0, 0.5, -2.0)
        );
        assert!((f32_at(32 + 12 * n + 4) - 0.002).abs() < 1e-9);
        assert!((f32_at(32 + 16 * n) - 0.03).abs() < 1e-9);
        assert_eq!(bytes[32 + 20 * n..32 + 21 * n], [10, 12, 14]);
        assert_eq!(bytes[32 + 21 * n..], [0, 2, 4]);
    }
}
