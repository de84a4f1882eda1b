//! The recording thread: takes records from any thread and writes them in order of time.
//!
//! Records of the two devices arrive nearly in order of time. The thread holds them for 0.2 to 0.4
//! s and writes them sorted, so a killed process loses at most the last half second. A sender never
//! waits for the disk, since it may control the motor: when the queue is full, the record is
//! dropped and counted. A finished log is synced to disk.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use protocol::record::Record;
use units::{Host, Stamp};

use super::owned::OwnedRecord;
use super::writer::{LogCounts, LogError, LogWriter};
use crate::files;

/// Shortest time that a record is held for sorting, and the interval of flushes.
const HOLD: Duration = Duration::from_millis(200);
/// Capacity of the queue: 40 s of a VLP-16 in dual return and a drive polled at 300 Hz, 80 MB.
const QUEUE_LEN: usize = 65_536;
/// Interval at which [`LogRecorder::finish_while`] polls the thread.
const POLL_INTERVAL: Duration = Duration::from_millis(2);

enum RecorderMessage {
    Record(OwnedRecord),
    Finish,
}

/// Numbers of records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RecorderCounts {
    /// Content of the file.
    pub log: LogCounts,
    /// Records dropped because the disk was too slow.
    pub dropped: u64,
    /// Records that the format cannot hold (too long, before 1970).
    pub refused: u64,
    /// Records that arrived too late for sorting; written in order of arrival.
    pub out_of_order: u64,
}

#[derive(Debug, Default)]
struct RecorderState {
    dropped: AtomicU64,
    failed: AtomicBool,
}

/// A running recording thread. End it with [`LogRecorder::finish`]; dropping it may lose records.
#[derive(Debug)]
pub struct LogRecorder {
    handle: RecorderHandle,
    thread: JoinHandle<Result<RecorderCounts, LogError>>,
}

/// A sender of records; clone it for each thread.
#[derive(Clone, Debug)]
pub struct RecorderHandle {
    queue: SyncSender<RecorderMessage>,
    shared: Arc<RecorderState>,
}

impl RecorderHandle {
    /// Queues a record without waiting. A full queue drops and counts it; [`LogRecorder::failed`]
    /// reports a failed log.
    pub fn record(&self, record: &Record<'_>) {
        match self
            .queue
            .try_send(RecorderMessage::Record(OwnedRecord::from(record)))
        {
            Ok(()) => {}
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {
                self.shared.dropped.fetch_add(1, Ordering::Relaxed);
            }
        }
    }
}

impl LogRecorder {
    /// Starts the thread on a file with a written header. [`LogRecorder::finish`] syncs it to disk.
    ///
    /// # Errors
    /// [`LogError::Thread`] if the system refuses a thread.
    pub fn to_disk(writer: LogWriter<File>) -> Result<Self, LogError> {
        Self::with_end(writer, files::sync)
    }

    /// Starts the thread on any writer with a written header.
    ///
    /// # Errors
    /// [`LogError::Thread`] if the system refuses a thread.
    pub fn start<W: Write + Send + 'static>(writer: LogWriter<W>) -> Result<Self, LogError> {
        Self::with_end(writer, |_| Ok(()))
    }

    fn with_end<W: Write + Send + 'static>(
        writer: LogWriter<W>,
        end: impl FnOnce(&W) -> io::Result<()> + Send + 'static,
    ) -> Result<Self, LogError> {
        let (queue, inbox) = sync_channel(QUEUE_LEN);
        let shared = Arc::new(RecorderState::default());
        let thread_shared = Arc::clone(&shared);
        let thread = thread::Builder::new()
            .name("log".to_owned())
            .spawn(move || {
                let done = Sorter::new(writer).run(&inbox, end);
                thread_shared.failed.store(done.is_err(), Ordering::Release);
                done
            })
            .map_err(|e| LogError::Thread(format!("cannot start: {e}")))?;
        Ok(Self {
            handle: RecorderHandle { queue, shared },
            thread,
        })
    }

    /// Returns a sender of records.
    #[must_use]
    pub fn handle(&self) -> RecorderHandle {
        self.handle.clone()
    }

    /// Whether writing failed; [`LogRecorder::finish`] returns the error.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.handle.shared.failed.load(Ordering::Acquire)
    }

    /// Writes all records, flushes and stops the thread. Remaining senders become ineffective.
    ///
    /// # Errors
    /// [`LogError::Write`] if a write failed; [`LogError::Thread`] if the thread panicked.
    pub fn finish(self) -> Result<RecorderCounts, LogError> {
        self.finish_while(|| {})
    }

    /// Like [`LogRecorder::finish`], calling `waiting` every few milliseconds meanwhile.
    ///
    /// # Errors
    /// As [`LogRecorder::finish`].
    pub fn finish_while(self, mut waiting: impl FnMut()) -> Result<RecorderCounts, LogError> {
        let mut is_requested = false;
        while !self.thread.is_finished() {
            // A full queue takes the message later. A thread that failed no longer reads it.
            is_requested =
                is_requested || self.handle.queue.try_send(RecorderMessage::Finish).is_ok();
            waiting();
            thread::sleep(POLL_INTERVAL);
        }
        match self.thread.join() {
            Ok(done) => done.map(|counts| RecorderCounts {
                dropped: self.handle.shared.dropped.load(Ordering::Relaxed),
                ..counts
            }),
            Err(_) => Err(LogError::Thread("panicked".to_owned())),
        }
    }
}

/// State of the thread. At the end of each period of [`HOLD`], all records up to the latest one of
/// the period before are written. So no record is held for more than two periods, whatever steps
/// the clock makes.
struct Sorter<W> {
    writer: LogWriter<W>,
    /// Records by time and order of arrival.
    held: BTreeMap<(Stamp<Host>, u64), OwnedRecord>,
    arrivals: u64,
    latest_this_period: Option<Stamp<Host>>,
    latest_last_period: Option<Stamp<Host>>,
    last_written: Option<Stamp<Host>>,
    counts: RecorderCounts,
}

impl<W: Write> Sorter<W> {
    fn new(writer: LogWriter<W>) -> Self {
        Self {
            writer,
            held: BTreeMap::new(),
            arrivals: 0,
            latest_this_period: None,
            latest_last_period: None,
            last_written: None,
            counts: RecorderCounts::default(),
        }
    }

    fn run(
        mut self,
        inbox: &Receiver<RecorderMessage>,
        end: impl FnOnce(&W) -> io::Result<()>,
    ) -> Result<RecorderCounts, LogError> {
        let mut period_ends = Instant::now() + HOLD;
        loop {
            let wait = period_ends.saturating_duration_since(Instant::now());
            match inbox.recv_timeout(wait) {
                Ok(RecorderMessage::Record(record)) => self.hold(record),
                Ok(RecorderMessage::Finish) | Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if Instant::now() >= period_ends {
                self.end_period()?;
                period_ends = Instant::now() + HOLD;
            }
        }
        self.write_held(None)?;
        let (log, out) = self.writer.finish()?;
        end(&out).map_err(|source| LogError::Write {
            offset: log.bytes,
            source,
        })?;
        Ok(RecorderCounts { log, ..self.counts })
    }

    fn hold(&mut self, record: OwnedRecord) {
        let host = record.host();
        self.latest_this_period = self.latest_this_period.max(Some(host));
        self.held.insert((host, self.arrivals), record);
        self.arrivals += 1;
    }

    fn end_period(&mut self) -> Result<(), LogError> {
        if let Some(limit) = self.latest_last_period {
            self.write_held(Some(limit))?;
        }
        self.latest_last_period = self.latest_this_period.take();
        self.writer.flush()
    }

    /// Writes the held records up to `limit`, or all of them.
    fn write_held(&mut self, limit: Option<Stamp<Host>>) -> Result<(), LogError> {
        while let Some(first) = self.held.first_entry() {
            let host = first.key().0;
            if limit.is_some_and(|limit| host > limit) {
                break;
            }
            match self.writer.write(&first.remove().as_record()) {
                Ok(()) => {}
                Err(LogError::TooLong { .. } | LogError::Time { .. }) => {
                    self.counts.refused += 1;
                    continue;
                }
                Err(e) => return Err(e),
            }
            if self.last_written > Some(host) {
                self.counts.out_of_order += 1;
            } else {
                self.last_written = Some(host);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
