//! Points of a sweep while it is recorded.
//!
//! `scanner::Live` runs on a thread of its own behind a bounded queue. Records that do not fit are
//! left out of the preview and counted; the log has them. docs/src/daemon.md describes the binary
//! layout.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use bytes::Bytes;
use cloud::{Fields, Points, Sink, SinkError};
use io::log::OwnedRecord;
use protocol::vlp16::models::VLP_16;
use scanner::{Live, ScanConfig};

use super::events::{Event, Events};
use super::record_feed::{RecordFeed, RecordQueue};

/// Points of a frame.
pub const FRAME_POINTS: usize = 16_384;
/// Records that may wait for the preview.
pub const WAITING_RECORDS: usize = 8_192;
/// Columns of a frame besides positions.
const FIELDS: Fields = Fields::INTENSITY
    .union(Fields::RING)
    .union(Fields::TIME)
    .union(Fields::TILT)
    .union(Fields::SD);
/// Age of the first point at which a frame is sent.
const FRAME_INTERVAL: Duration = Duration::from_millis(50);
/// Bytes of a frame before its columns.
const HEADER_BYTES: usize = 32;
/// Bytes per point: position, time and sd as f32, intensity and ring as u8.
const POINT_BYTES: usize = 22;

/// Some thousand points of a sweep in progress.
#[derive(Clone, Debug)]
pub struct PreviewFrame {
    /// Id of the scan.
    pub scan: Arc<str>,
    /// Number of this frame within the scan.
    pub number: u32,
    /// Records left out of the preview so far.
    pub left_out: u32,
    /// The points, with intensity, ring, time, tilt and sd.
    pub points: Points,
    /// All points in the binary layout, encoded for the first client that wants them.
    encoded: OnceLock<Bytes>,
}

impl PreviewFrame {
    /// Every `thin`-th point in the binary layout.
    #[must_use]
    pub fn bytes(&self, thin: usize) -> Bytes {
        match thin {
            0 | 1 => self.encoded.get_or_init(|| self.encode(1).into()).clone(),
            _ => self.encode(thin).into(),
        }
    }

    fn encode(&self, thin: usize) -> Vec<u8> {
        let points = &self.points;
        let count = points.len().div_ceil(thin);
        let first_ns = points.time().first().map_or(0, |time| time.as_nanos());
        let tilt = points.tilt_deg().last().copied().unwrap_or(f64::NAN);
        let mut bytes = Vec::with_capacity(HEADER_BYTES + POINT_BYTES * count);
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

/// A preview of one scan. Dropping it ends the preview.
pub struct LivePreview {
    feed: RecordFeed,
    thread: Option<JoinHandle<()>>,
}

impl LivePreview {
    /// Starts the preview of the scan `id`. `None` where there is no thread for it: the scan is
    /// worth recording all the same.
    pub(super) fn start(
        id: &str,
        config: &ScanConfig,
        feed: &RecordFeed,
        events: &Arc<Events>,
    ) -> Option<Self> {
        let (queue, records) = RecordQueue::new(WAITING_RECORDS);
        let frames = FrameSink::new(id, events, queue.left_out());
        let config = config.clone();
        let thread = std::thread::Builder::new()
            .name("live points".to_owned())
            .spawn(move || run(&config, frames, &records))
            .ok()?;
        feed.set(Some(queue));
        Some(Self {
            feed: feed.clone(),
            thread: Some(thread),
        })
    }
}

impl Drop for LivePreview {
    fn drop(&mut self) {
        // The thread ends after the records that wait.
        self.feed.set(None);
        if let Some(thread) = self.thread.take() {
            // A panic there loses the preview, not the scan.
            let _ = thread.join();
        }
    }
}

/// Decoder options of the view: the calibrated lasers of the scanner's VLP-16.
fn live_options(config: &ScanConfig) -> lidar::Options {
    let calibration = config.calibration.as_ref();
    let corrections = calibration.and_then(|all| {
        let table = lidar::Corrections::from(&VLP_16);
        all.corrections(VLP_16.name, table)
    });
    lidar::Options {
        corrections: corrections.map(Arc::new),
        ..lidar::Options::default()
    }
}

fn run(config: &ScanConfig, mut frames: FrameSink, records: &Receiver<OwnedRecord>) {
    let Ok(mut live) = Live::new(config, live_options(config), &mut frames) else {
        return;
    };
    while let Ok(record) = records.recv() {
        if live.observe(&record.as_record()).is_err() {
            break;
        }
    }
    // This sink refuses nothing.
    let _ = live.finish();
    frames.send();
}

/// A sink that sends frames as events.
struct FrameSink {
    scan: Arc<str>,
    events: Arc<Events>,
    left_out: Arc<AtomicU64>,
    points: Points,
    since: Instant,
    number: u32,
}

impl FrameSink {
    fn new(id: &str, events: &Arc<Events>, left_out: &Arc<AtomicU64>) -> Self {
        Self {
            scan: id.into(),
            events: Arc::clone(events),
            left_out: Arc::clone(left_out),
            points: Points::new(FIELDS),
            since: Instant::now(),
            number: 0,
        }
    }

    fn send(&mut self) {
        if self.points.is_empty() {
            return;
        }
        let points = std::mem::replace(&mut self.points, Points::new(FIELDS));
        let left_out = self.left_out.load(Ordering::Relaxed);
        self.events.send(Event::Points(Box::new(PreviewFrame {
            scan: Arc::clone(&self.scan),
            number: self.number,
            left_out: u32::try_from(left_out).unwrap_or(u32::MAX),
            points,
            encoded: OnceLock::new(),
        })));
        self.number += 1;
    }
}

impl Sink for FrameSink {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        if !self.events.wants_points() {
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
        if self.since.elapsed() >= FRAME_INTERVAL {
            self.send();
        }
        Ok(())
    }

    fn fields(&self) -> Fields {
        FIELDS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloud::Point;
    use units::{Degrees, Stamp};

    #[test]
    fn the_binary_layout_matches_its_documentation() {
        let mut points = Points::new(FIELDS);
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
        let frame = PreviewFrame {
            scan: "hall".into(),
            number: 7,
            left_out: 2,
            points,
            encoded: OnceLock::new(),
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
