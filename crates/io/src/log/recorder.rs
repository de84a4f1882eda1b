//! The recording thread: records in from any thread, a file in time order out.
//!
//! Records of the two devices reach the thread in nearly the order of their host times; they are
//! held for 0.2 to 0.4 s and written in that order, so that at most the last half second is lost
//! when the process is killed. A sender never waits for the disk: when the queue is full the record
//! is dropped and counted, for the motor must not wait. A log on a disk is durable once it is
//! finished: what is made of it is told as whole, also after a power cut.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
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

/// How long a record is held at least, for an earlier one to overtake it; also how often the file
/// is flushed.
const HOLD: Duration = Duration::from_millis(200);
/// Records that may wait for the disk: 40 s of a VLP-16 in dual return and a drive polled at 300
/// Hz, some 80 MB.
const QUEUE_LEN: usize = 65_536;
/// How often it is looked whether everything is saved.
const SAVING: Duration = Duration::from_millis(2);

enum Message {
    Record(OwnedRecord),
    Finish,
}

/// What a recorder did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecorderCounts {
    /// What is in the file.
    pub log: LogCounts,
    /// Records lost because the disk could not follow.
    pub dropped: u64,
    /// Records that could not be written as they were (too long, before 1970).
    pub refused: u64,
    /// Records that came too late to be put in order; written where they came.
    pub out_of_order: u64,
}

#[derive(Debug, Default)]
struct Shared {
    dropped: AtomicU64,
    failed: AtomicBool,
}

/// The owner's side of a recording thread. End it with [`Recorder::finish`]: merely dropped, it may
/// lose what it holds.
#[derive(Debug)]
pub struct Recorder {
    handle: RecorderHandle,
    thread: JoinHandle<Result<RecorderCounts, LogError>>,
}

/// A sender of records; clone one for each thread.
#[derive(Clone, Debug)]
pub struct RecorderHandle {
    queue: SyncSender<Message>,
    shared: Arc<Shared>,
}

impl RecorderHandle {
    /// Hands a record over without waiting. If the queue is full the record is counted as dropped;
    /// if the log failed, [`Recorder::failed`] says so.
    pub fn record(&self, record: &Record<'_>) {
        match self
            .queue
            .try_send(Message::Record(OwnedRecord::from(record)))
        {
            Ok(()) => {}
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {
                self.shared.dropped.fetch_add(1, Ordering::Relaxed);
            }
        }
    }
}

impl Recorder {
    /// Starts the thread on a file whose head is written; [`Recorder::finish`] returns when the
    /// disk has it all.
    ///
    /// # Errors
    /// [`LogError::Thread`] where the system gives no thread.
    pub fn to_disk(writer: LogWriter<File>) -> Result<Self, LogError> {
        Self::with_end(writer, files::sync)
    }

    /// Starts the thread on a log whose head is written, in anything that takes bytes.
    ///
    /// # Errors
    /// [`LogError::Thread`] where the system gives no thread.
    pub fn start<W: Write + Send + 'static>(writer: LogWriter<W>) -> Result<Self, LogError> {
        Self::with_end(writer, |_| Ok(()))
    }

    fn with_end<W: Write + Send + 'static>(
        writer: LogWriter<W>,
        end: impl FnOnce(&W) -> io::Result<()> + Send + 'static,
    ) -> Result<Self, LogError> {
        let (queue, inbox) = sync_channel(QUEUE_LEN);
        let shared = Arc::new(Shared::default());
        let theirs = Arc::clone(&shared);
        let thread = thread::Builder::new()
            .name("log".to_owned())
            .spawn(move || {
                let done = Order::new(writer).run(&inbox, end);
                theirs.failed.store(done.is_err(), Ordering::Release);
                done
            })
            .map_err(|e| LogError::Thread(format!("could not be started: {e}")))?;
        Ok(Self {
            handle: RecorderHandle { queue, shared },
            thread,
        })
    }

    /// A sender of records.
    #[must_use]
    pub fn handle(&self) -> RecorderHandle {
        self.handle.clone()
    }

    /// Whether the log cannot be written any more; [`Recorder::finish`] then tells why.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.handle.shared.failed.load(Ordering::Acquire)
    }

    /// Writes what is held, flushes and stops the thread, even if senders are still around.
    ///
    /// # Errors
    /// [`LogError::Write`] if a write failed, now or earlier; [`LogError::Thread`] if the thread
    /// died.
    pub fn finish(self) -> Result<RecorderCounts, LogError> {
        self.finish_while(|| {})
    }

    /// The same, with `waiting` called every few milliseconds until the disk has everything.
    ///
    /// # Errors
    /// As [`Recorder::finish`].
    pub fn finish_while(self, mut waiting: impl FnMut()) -> Result<RecorderCounts, LogError> {
        let mut told = false;
        while !self.thread.is_finished() {
            // A full queue takes it later. A thread that has ended on an error no longer listens;
            // its result says so.
            told = told || self.handle.queue.try_send(Message::Finish).is_ok();
            waiting();
            thread::sleep(SAVING);
        }
        match self.thread.join() {
            Ok(done) => done.map(|counts| RecorderCounts {
                dropped: self.handle.shared.dropped.load(Ordering::Relaxed),
                ..counts
            }),
            Err(_) => Err(LogError::Thread("died".to_owned())),
        }
    }
}

/// A record in the heap: by time, then by arrival.
#[derive(Debug)]
struct Held {
    key: (Stamp<Host>, u64),
    record: OwnedRecord,
}

impl PartialEq for Held {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}
impl Eq for Held {}
impl PartialOrd for Held {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Held {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.key.cmp(&other.key)
    }
}

/// The thread's state. Time is cut into turns of [`HOLD`]: at the end of each, everything up to the
/// latest record of the turn before is written, so that whatever clock steps do, no record is held
/// for more than two turns.
struct Order<W> {
    writer: LogWriter<W>,
    held: BinaryHeap<Reverse<Held>>,
    arrivals: u64,
    latest_this_turn: Option<Stamp<Host>>,
    latest_last_turn: Option<Stamp<Host>>,
    last_written: Option<Stamp<Host>>,
    counts: RecorderCounts,
}

impl<W: Write> Order<W> {
    fn new(writer: LogWriter<W>) -> Self {
        Self {
            writer,
            held: BinaryHeap::new(),
            arrivals: 0,
            latest_this_turn: None,
            latest_last_turn: None,
            last_written: None,
            counts: RecorderCounts::default(),
        }
    }

    fn run(
        mut self,
        inbox: &Receiver<Message>,
        end: impl FnOnce(&W) -> io::Result<()>,
    ) -> Result<RecorderCounts, LogError> {
        let mut turn_ends = Instant::now() + HOLD;
        loop {
            let wait = turn_ends.saturating_duration_since(Instant::now());
            match inbox.recv_timeout(wait) {
                Ok(Message::Record(record)) => self.hold(record),
                Ok(Message::Finish) | Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if Instant::now() >= turn_ends {
                self.end_turn()?;
                turn_ends = Instant::now() + HOLD;
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
        self.latest_this_turn = self.latest_this_turn.max(Some(host));
        self.held.push(Reverse(Held {
            key: (host, self.arrivals),
            record,
        }));
        self.arrivals += 1;
    }

    fn end_turn(&mut self) -> Result<(), LogError> {
        if let Some(limit) = self.latest_last_turn {
            self.write_held(Some(limit))?;
        }
        self.latest_last_turn = self.latest_this_turn.take();
        self.writer.flush()
    }

    /// Writes the held records up to `limit`, or all.
    fn write_held(&mut self, limit: Option<Stamp<Host>>) -> Result<(), LogError> {
        while let Some(Reverse(first)) = self.held.peek() {
            if limit.is_some_and(|limit| first.key.0 > limit) {
                break;
            }
            let Some(Reverse(held)) = self.held.pop() else {
                break;
            };
            match self.writer.write(&held.record.as_record()) {
                Ok(()) => {}
                Err(LogError::TooLong { .. } | LogError::Time { .. }) => {
                    self.counts.refused += 1;
                    continue;
                }
                Err(e) => return Err(e),
            }
            if self.last_written > Some(held.key.0) {
                self.counts.out_of_order += 1;
            } else {
                self.last_written = Some(held.key.0);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
