//! ASTM E57 (E2807), by the `e57` crate.
//!
//! One point cloud with its pose (identity), bounds, limits, the times at which acquisition began
//! and ended, and the metadata in its description, which begins with SIMULATED for software
//! devices. A point has cartesianX, Y, Z (f32), intensity (0..=255), rowIndex (the ring) and
//! timeStamp (f64 seconds after a whole second). Tilt and further columns are attributes of an
//! extension, which other readers ignore. There is no columnIndex, as a cloud of several
//! revolutions is not a grid, and no creation date, as the same log must give the same bytes.
//!
//! The library's writer of a cloud borrows its writer of a file, so both live on a thread of their
//! own, fed by a short queue.

mod attributes;
mod identity;
mod worker;

use std::io::{Read, Seek, Write};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use units::{Host, Stamp};

use self::attributes::PointAttributes;
use self::worker::{FileEnding, WorkerCommand};
use super::fallible::{FallibleOutput, WriteFault};
use super::gps_time;
use super::stage::Stage;
use crate::{Fields, Metadata, Points, Sink, SinkError, Summary};

const FORMAT: &str = "e57";
/// Batches in the queue: enough to decouple producer and encoder.
const QUEUE: usize = 4;

/// Writes E57 to an output that seeks and reads back what it wrote. It writes pages of 1 KiB: use a
/// buffered output.
///
/// If the output fails, or the writer is dropped before [`Sink::finish`], the file is lost, as the
/// description of its points is at the end.
pub struct E57Writer<W: Read + Write + Seek + Send + 'static> {
    fields: Fields,
    stage: Stage,
    fault: WriteFault,
    output: Option<FallibleOutput<W>>,
    worker: Option<EncoderThread>,
    description: Vec<String>,
    /// The whole second of the first point.
    start: Option<Stamp<Host>>,
    end: Option<Stamp<Host>>,
    summary: Summary,
}

struct EncoderThread {
    orders: SyncSender<WorkerCommand>,
    thread: JoinHandle<e57::Result<()>>,
}

impl<W: Read + Write + Seek + Send + 'static> E57Writer<W> {
    /// A writer into `output`, which is empty, with the columns of [`Fields::FILE`].
    pub fn new(output: W) -> Self {
        let (output, fault) = FallibleOutput::new(output);
        Self {
            fields: Fields::FILE,
            stage: Stage::default(),
            fault,
            output: Some(output),
            worker: None,
            description: Vec::new(),
            start: None,
            end: None,
            summary: Summary::default(),
        }
    }

    /// Sets the columns; only before [`Sink::begin`].
    #[must_use]
    pub fn with_fields(mut self, fields: Fields) -> Self {
        self.fields = fields;
        self
    }

    fn encoding(&self, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> SinkError {
        SinkError::Encode {
            format: FORMAT,
            points: self.summary.points,
            source: source.into(),
        }
    }

    /// The error of the output, which the library does not see.
    fn written(&self) -> Result<(), SinkError> {
        match self.fault.get() {
            Some(source) => Err(SinkError::Write {
                format: FORMAT,
                points: self.summary.points,
                source,
            }),
            None => Ok(()),
        }
    }

    /// Sends a command to the thread; if it has ended, returns its error.
    fn order(&mut self, order: WorkerCommand) -> Result<(), SinkError> {
        self.written()?;
        let sent = self.worker.as_ref().map(|worker| worker.orders.send(order));
        match sent {
            Some(Ok(())) => Ok(()),
            Some(Err(_)) | None => {
                self.wait()?;
                Err(self.encoding("the encoder has ended"))
            }
        }
    }

    /// Waits for the end of the thread.
    fn wait(&mut self) -> Result<(), SinkError> {
        let ended = self.worker.take().map(|worker| {
            drop(worker.orders);
            worker.thread.join()
        });
        self.written()?;
        match ended {
            Some(Ok(Err(error))) => Err(self.encoding(error)),
            Some(Err(_)) => Err(self.encoding("the encoder broke off")),
            Some(Ok(Ok(()))) | None => Ok(()),
        }
    }

    fn note_times(&mut self, batch: &Points) {
        let times = batch.time();
        let (Some(least), Some(greatest)) = (times.iter().min(), times.iter().max()) else {
            return;
        };
        let second = |ns: i64| Stamp::from_nanos(ns - ns.rem_euclid(1_000_000_000));
        self.start.get_or_insert_with(|| second(least.as_nanos()));
        self.end = self.end.max(Some(*greatest));
    }
}

impl<W: Read + Write + Seek + Send + 'static> Sink for E57Writer<W> {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.stage.points(FORMAT)?;
        batch.fields().require(self.fields)?;
        batch.check_coordinates(FORMAT, f64::from(f32::MAX), self.summary.points)?;
        self.note_times(batch);
        let start = self.start.unwrap_or(Stamp::from_nanos(0));
        if let Err(error) = self.order(WorkerCommand::Points(Box::new(batch.clone()), start)) {
            self.stage.cut();
            return Err(error);
        }
        self.summary.add(batch.summary());
        Ok(())
    }

    fn fields(&self) -> Fields {
        self.fields
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        self.stage.begin(FORMAT)?;
        self.description = metadata.lines();
        let Some(output) = self.output.take() else {
            return Ok(());
        };
        let attributes = PointAttributes::new(self.fields);
        let about = worker::CloudDescription::new(metadata);
        let (orders, receiver) = sync_channel(QUEUE);
        let thread = thread::Builder::new()
            .name(FORMAT.to_owned())
            .spawn(move || worker::run(output, &attributes, &about, &receiver))
            .map_err(|error| self.encoding(error))?;
        self.worker = Some(EncoderThread { orders, thread });
        self.stage.opened();
        Ok(())
    }

    fn finish(&mut self) -> Result<Summary, SinkError> {
        self.stage.finish(FORMAT)?;
        let ending = FileEnding {
            identity: identity::of(&self.description, self.summary, [self.start, self.end]),
            start_gps_s: self.start.map(gps_time::gps_s),
            end_gps_s: self.end.map(gps_time::gps_s),
        };
        self.order(WorkerCommand::Finish(ending))?;
        self.wait()?;
        Ok(self.summary)
    }
}

/// Waits until the output is no longer used.
impl<W: Read + Write + Seek + Send + 'static> Drop for E57Writer<W> {
    fn drop(&mut self) {
        // An error cannot be returned here.
        let _ = self.wait();
    }
}

#[cfg(test)]
mod tests;
