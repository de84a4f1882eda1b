use super::*;
use std::io;
use std::sync::Mutex;

use protocol::record::{Direction, DriveLink, Wire};

use crate::files::Overwrite;
use crate::log::LogConfig;
use crate::recording::{End, Recording};

fn record(ns: i64, frame: &[u8]) -> Record<'_> {
    Record {
        host: Stamp::from_nanos(ns),
        wire: Wire::Drive {
            link: DriveLink::Usb,
            direction: Direction::ToDrive,
            frame,
        },
    }
}

fn times(path: &std::path::Path) -> (Vec<i64>, End) {
    let mut recording = Recording::open(path).unwrap().keep_foreign();
    let mut times = Vec::new();
    while let Some(record) = recording.next_record().unwrap() {
        times.push(record.host.as_nanos());
    }
    (times, recording.end().cloned().unwrap())
}

#[test]
fn records_of_many_threads_are_sorted_by_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.pcapng");
    let writer = LogWriter::create(&path, &LogConfig::default(), Overwrite::Refuse).unwrap();
    let recorder = LogRecorder::start(writer).unwrap();
    let threads: Vec<_> = (0..4)
        .map(|t| {
            let handle = recorder.handle();
            thread::spawn(move || {
                for i in 0..500_i64 {
                    handle.record(&record(i * 4 + t, b"frame"));
                }
            })
        })
        .collect();
    threads.into_iter().for_each(|t| t.join().unwrap());
    let kept = recorder.handle();
    let counts = recorder.finish().unwrap();
    assert_eq!(counts.log.drive, 2000);
    assert_eq!(
        (counts.dropped, counts.refused, counts.out_of_order),
        (0, 0, 0)
    );
    let (times, end) = times(&path);
    assert_eq!(times, (0..2000).collect::<Vec<_>>());
    assert_eq!(end, End::Complete);
    kept.record(&record(1, b"after the end")); // is ignored
}

#[test]
fn records_of_equal_time_keep_their_order() {
    let sink = SharedSink::default();
    let writer = LogWriter::new(sink.clone(), &LogConfig::default()).unwrap();
    let recorder = LogRecorder::start(writer).unwrap();
    for n in 0..100 {
        recorder.handle().record(&record(7, &[n]));
    }
    recorder.finish().unwrap();
    let file = sink.0.lock().unwrap().clone();
    let mut recording = Recording::new(file.as_slice(), "log")
        .unwrap()
        .keep_foreign();
    for n in 0..100 {
        let record = recording.next_record().unwrap().unwrap();
        assert_eq!(
            record.wire,
            Wire::Drive {
                link: DriveLink::Usb,
                direction: Direction::ToDrive,
                frame: &[n]
            }
        );
    }
}

#[test]
fn records_are_in_the_file_within_a_second() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.pcapng");
    let writer = LogWriter::create(&path, &LogConfig::default(), Overwrite::Refuse).unwrap();
    let recorder = LogRecorder::start(writer).unwrap();
    // The latest time arrives first and no record after it: neither clock steps nor silence delay a
    // record.
    for ns in [1_000_000_000_000, 5, 3, 4] {
        recorder.handle().record(&record(ns, b"x"));
    }
    // The file as after kill -9. Two periods take 0.4 s; the rest is for a busy machine.
    let deadline = Instant::now() + Duration::from_secs(3);
    let (mut seen, mut end) = times(&path);
    while seen.len() < 4 && Instant::now() < deadline {
        thread::sleep(Duration::from_millis(50));
        (seen, end) = times(&path);
    }
    assert_eq!(seen, [3, 4, 5, 1_000_000_000_000]);
    assert_eq!(end, End::Complete);
    recorder.handle().record(&record(6, b"late"));
    let counts = recorder.finish().unwrap();
    assert_eq!(counts.out_of_order, 1);
    assert_eq!(times(&path).0, [3, 4, 5, 1_000_000_000_000, 6]);
}

#[test]
fn invalid_records_are_counted_and_skipped() {
    let sink = SharedSink::default();
    let writer = LogWriter::new(sink.clone(), &LogConfig::default()).unwrap();
    let recorder = LogRecorder::start(writer).unwrap();
    recorder.handle().record(&record(-5, b"before 1970"));
    recorder.handle().record(&record(5, b"sound"));
    let counts = recorder.finish().unwrap();
    assert_eq!((counts.refused, counts.log.drive), (1, 1));
}

#[derive(Clone, Debug, Default)]
struct SharedSink(Arc<Mutex<Vec<u8>>>);

impl Write for SharedSink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Accepts the header of a log and fails afterwards.
#[derive(Debug)]
struct FullDisk {
    writes: usize,
}

impl Write for FullDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writes += 1;
        if self.writes > 1 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn failed_writes_are_reported_at_once_and_at_the_end() {
    let writer = LogWriter::new(FullDisk { writes: 0 }, &LogConfig::default()).unwrap();
    let recorder = LogRecorder::start(writer).unwrap();
    assert!(!recorder.failed());
    let handle = recorder.handle();
    let deadline = Instant::now() + Duration::from_secs(10);
    while !recorder.failed() {
        assert!(Instant::now() < deadline, "the failure was never reported");
        handle.record(&record(1, b"x"));
        thread::sleep(Duration::from_millis(5));
    }
    handle.record(&record(2, b"x"));
    let error = recorder.finish().unwrap_err();
    let LogError::Write { source, .. } = error else {
        panic!("{error}");
    };
    assert_eq!(source.kind(), io::ErrorKind::StorageFull);
}

/// A disk that blocks until it is released.
#[derive(Debug)]
struct StuckDisk {
    open: Arc<AtomicBool>,
    waiting: Arc<AtomicBool>,
    first: bool,
}

impl Write for StuckDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.waiting.store(!self.first, Ordering::Release);
        while !self.first && !self.open.load(Ordering::Acquire) {
            thread::sleep(Duration::from_millis(1));
        }
        self.first = false;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_blocked_disk_does_not_block_senders() {
    let open = Arc::new(AtomicBool::new(false));
    let waiting = Arc::new(AtomicBool::new(false));
    let disk = StuckDisk {
        open: Arc::clone(&open),
        waiting: Arc::clone(&waiting),
        first: true,
    };
    let writer = LogWriter::new(disk, &LogConfig::default()).unwrap();
    let recorder = LogRecorder::start(writer).unwrap();
    let handle = recorder.handle();
    handle.record(&record(0, b"x"));
    while !waiting.load(Ordering::Acquire) {
        thread::sleep(Duration::from_millis(5));
    }
    let sent = QUEUE_LEN as u64 + 1000;
    let start = Instant::now();
    for ns in 0..sent {
        handle.record(&record(ns as i64, b"x"));
    }
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "senders do not wait"
    );
    open.store(true, Ordering::Release);
    let counts = recorder.finish().unwrap();
    assert_eq!(counts.dropped, 1000);
    assert_eq!(counts.log.drive + counts.dropped, sent + 1);
}
