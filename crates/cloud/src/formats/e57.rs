//! ASTM E57 (E2807), by the `e57` crate.
//!
//! One point cloud per sweep, or one in all if there are no sweeps, with its pose (the identity, or
//! the heading of a georeferenced cloud, whose points stay in the scanner's axes), bounds, limits,
//! the times at which acquisition began and ended, and the metadata in its description, which
//! begins with SIMULATED for simulated devices. A point has cartesianX, Y, Z (f32), intensity
//! (0..=255), rowIndex (the ring) and timeStamp (f64 seconds after a whole second). Tilt and
//! further columns are attributes of an extension, which other readers ignore. There is no
//! columnIndex, as a cloud of several revolutions is not a grid, and no creation date, as the same
//! log must give the same bytes.
//!
//! The library's writer of a cloud borrows its writer of a file, so both live on a thread of their
//! own, fed by a short queue.

mod attributes;
mod identity;
mod worker;

use std::error::Error;
use std::io::{Read, Seek, Write};
use std::ops::Range;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use units::{Host, Stamp};

use self::attributes::PointAttributes;
use self::worker::{ScanEnding, WorkerCommand};
use super::fallible::{ErrorHidingOutput, WriteFault};
use super::file_sink::{EncodeError, FileSink, FormatEncoder};
use super::gps_time;
use crate::{Fields, Metadata, Points, Summary, TiltTrack};

const FORMAT: &str = "e57";
/// Batches in the queue: enough to decouple producer and encoder.
const QUEUE: usize = 4;

/// Writes E57 to an output that seeks and reads back what it wrote. It writes pages of 1 KiB: use a
/// buffered output.
///
/// If the output fails, or the writer is dropped before [`Sink::finish`], the file is lost, as the
/// description of its points is at the end.
pub(super) type E57Writer<W> = FileSink<E57Encoder<W>>;

/// Encoder of [`E57Writer`].
pub(super) struct E57Encoder<W: Read + Write + Seek + Send + 'static> {
    fields: Fields,
    fault: WriteFault,
    output: Option<ErrorHidingOutput<W>>,
    worker: Option<EncoderThread>,
    description: Vec<String>,
    /// Ends of all sweeps but the last, in order of time; empty for a file of one scan.
    sweep_ends: Vec<Stamp<Host>>,
    /// Index of the current sweep.
    sweep: usize,
    scan: ScanExtent,
    /// Start of the first scan.
    start: Option<Stamp<Host>>,
}

/// Points and times of the current scan.
#[derive(Default)]
struct ScanExtent {
    summary: Summary,
    /// The whole second of the first point.
    start: Option<Stamp<Host>>,
    end: Option<Stamp<Host>>,
}

impl ScanExtent {
    fn add(&mut self, batch: &Points) {
        self.summary.add(batch.summary());
        let times = batch.time();
        let (Some(least), Some(greatest)) = (times.iter().min(), times.iter().max()) else {
            return;
        };
        let second = |ns: i64| Stamp::from_nanos(ns - ns.rem_euclid(1_000_000_000));
        self.start.get_or_insert_with(|| second(least.as_nanos()));
        self.end = self.end.max(Some(*greatest));
    }
}

/// Some rows of a batch.
fn part(batch: &Points, rows: Range<usize>) -> Points {
    let mut part = Points::with_capacity(batch.fields(), rows.len());
    rows.filter_map(|row| batch.get(row))
        .for_each(|point| part.push(point));
    part
}

struct EncoderThread {
    commands: SyncSender<WorkerCommand>,
    thread: JoinHandle<e57::Result<()>>,
}

impl<W: Read + Write + Seek + Send + 'static> E57Writer<W> {
    /// A writer into `output`, which is empty, with the columns `fields`.
    pub(super) fn new(output: W, fields: Fields) -> Self {
        let (output, fault) = ErrorHidingOutput::new(output);
        let encoder = E57Encoder {
            fields,
            fault,
            output: Some(output),
            worker: None,
            description: Vec::new(),
            sweep_ends: Vec::new(),
            sweep: 0,
            scan: ScanExtent::default(),
            start: None,
        };
        Self::of(encoder, fields)
    }
}

impl<W: Read + Write + Seek + Send + 'static> E57Encoder<W> {
    /// Sends a command to the thread; if it has ended, returns its error.
    fn command(&mut self, command: WorkerCommand) -> Result<(), EncodeError> {
        self.fault.outcome(Ok::<_, e57::Error>(()))?;
        let sent = self
            .worker
            .as_ref()
            .map(|worker| worker.commands.send(command));
        match sent {
            Some(Ok(())) => Ok(()),
            Some(Err(_)) | None => {
                self.wait()?;
                Err(EncodeError::library("the encoder has ended"))
            }
        }
    }

    /// Waits for the end of the thread.
    fn wait(&mut self) -> Result<(), EncodeError> {
        let ended = self.worker.take().map_or(Ok(()), |worker| {
            drop(worker.commands);
            match worker.thread.join() {
                Ok(result) => result.map_err(Into::into),
                Err(_) => Err(Box::<dyn Error + Send + Sync>::from(
                    "the encoder broke off",
                )),
            }
        });
        self.fault.outcome(ended)
    }

    /// Ends the current scan; the last one with the file's identifier.
    fn end_scan(&mut self, file: Option<String>) -> Result<(), EncodeError> {
        let scan = std::mem::take(&mut self.scan);
        self.start = self.start.or(scan.start);
        self.command(WorkerCommand::EndScan(ScanEnding {
            sweep: (!self.sweep_ends.is_empty()).then_some(self.sweep + 1),
            identity: identity::of(&self.description, scan.summary, [scan.start, scan.end]),
            start_gps_s: scan.start.map(gps_time::gps_s),
            end_gps_s: scan.end.map(gps_time::gps_s),
            file,
        }))
    }

    /// Adds points to the current scan.
    fn add(&mut self, part: Points) -> Result<(), EncodeError> {
        self.scan.add(&part);
        let start = self.scan.start.unwrap_or(Stamp::from_nanos(0));
        self.command(WorkerCommand::Points(Box::new(part), start))
    }
}

impl<W: Read + Write + Seek + Send + 'static> FormatEncoder for E57Encoder<W> {
    fn format(&self) -> &'static str {
        FORMAT
    }

    fn limit_m(&self) -> Option<f64> {
        Some(f32::MAX.into())
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), EncodeError> {
        self.description = worker::description(metadata);
        let Some(output) = self.output.take() else {
            return Ok(());
        };
        let attributes = PointAttributes::new(self.fields);
        let about = worker::CloudDescription::new(metadata);
        let (commands, receiver) = sync_channel(QUEUE);
        let thread = thread::Builder::new()
            .name(FORMAT.to_owned())
            .spawn(move || worker::run(output, &attributes, &about, &receiver))
            .map_err(EncodeError::library)?;
        self.worker = Some(EncoderThread { commands, thread });
        Ok(())
    }

    fn wants_tilt(&self) -> bool {
        true
    }

    fn has_pose(&self) -> bool {
        true
    }

    fn tilt(&mut self, track: &TiltTrack) {
        let sweeps = track
            .sweeps
            .split_last()
            .map_or(&[][..], |(_, before)| before);
        self.sweep_ends = sweeps.iter().map(|sweep| sweep.1).collect();
    }

    fn points(&mut self, batch: &Points) -> Result<(), EncodeError> {
        let (times, mut first) = (batch.time(), 0);
        while let Some(end) = self.sweep_ends.get(self.sweep).copied() {
            let rest = times.get(first..).unwrap_or_default();
            let Some(count) = rest.iter().position(|time| *time > end) else {
                break;
            };
            if count > 0 {
                self.add(part(batch, first..first + count))?;
            }
            if self.scan.summary.points > 0 {
                self.end_scan(None)?;
            }
            first += count;
            self.sweep += 1;
        }
        match first {
            0 => self.add(batch.clone()),
            _ => self.add(part(batch, first..batch.len())),
        }
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), EncodeError> {
        let times = [self.start.or(self.scan.start), self.scan.end];
        self.end_scan(Some(identity::of(&self.description, *summary, times)))?;
        self.wait()
    }
}

impl<W: Read + Write + Seek + Send + 'static> Drop for E57Encoder<W> {
    fn drop(&mut self) {
        // An error cannot be returned here.
        let _ = self.wait();
    }
}

#[cfg(test)]
mod tests;
