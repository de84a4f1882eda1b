//! MCAP with ROS 2 messages: opens in Foxglove, plays with `ros2 bag`.
//!
//! Profile `ros2`, every channel CDR with its definition (`ros2msg`), chunks of 1 MiB compressed by
//! LZ4, with an index. A cloud is one `PointCloud2` per sweep, or per revolution of the lidar. A
//! cloud longer than [`MOST_POINTS`] or [`MOST_SPAN`] continues in further messages, as no reader
//! handles a single message of 360 MB (42 seconds of a VLP-16). Memory is bounded: one message is
//! held, 23 MB at most with the default columns.
//!
//! The file also contains the tilt joint at every sample of the track, transforms at most every
//! [`TRANSFORMS_EVERY`], the mount of the lidar (latched), and the diagnostics of the scan. The log
//! time of a message is when its content was complete: that of a cloud is the time of its last
//! point, while its header has that of its first. Messages are in order of log time. The tilt is no
//! column, as the joint carries it.

mod bag;
mod channels;

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use mcap::{Compression, WriteOptions};
use units::{Degrees, Host, Span, Stamp};

use self::channels::McapChannels;
use super::fallible::{ErrorHidingOutput, WriteFault};
use super::file_sink::EncodeError;
use super::stage::Stage;
use crate::messages::cdr::Cdr;
use crate::messages::{
    Cloud, Frames, MessageSplitter, Time, Topic, diagnostic_array, joint_state, tf_message,
};
use crate::{
    Companion, Diagnostic, EastNorthUp, Fields, Metadata, Points, Revolution, Sink, SinkError,
    Summary, TiltTrack,
};

pub use crate::messages::{MOST_POINTS, MOST_SPAN};

const FORMAT: &str = "mcap";
/// Least interval of transforms: on the steepest ramp, 500 deg/s^2, a straight line over it is off
/// by one step of the encoder.
pub const TRANSFORMS_EVERY: Span = Span::from_millis(5);
/// Uncompressed bytes of a chunk, which readers hold at once; a longer message makes a longer
/// chunk.
const CHUNK_BYTES: u64 = 1 << 20;

/// Writes MCAP to an output that seeks.
///
/// A file whose output failed cannot be completed; `mcap recover` restores its whole chunks.
pub struct McapWriter<W: Write + Seek> {
    stage: Stage,
    clouds: MessageSplitter,
    log: McapLog<W>,
}

/// Messages on their way into the file, in order of time.
struct McapLog<W: Write + Seek> {
    fault: WriteFault,
    state: McapState<W>,
    hardware: String,
    east_north_up: Option<EastNorthUp>,
    track: TiltTrack,
    /// Number of written samples of the track.
    samples: usize,
    transformed: Option<Stamp<Host>>,
    cdr: Cdr,
    /// The time up to which messages are written.
    now: Option<Stamp<Host>>,
    /// Points so far.
    points: u64,
}

enum McapState<W: Write + Seek> {
    Idle(ErrorHidingOutput<W>),
    Open {
        writer: Box<mcap::Writer<ErrorHidingOutput<W>>>,
        channels: McapChannels,
    },
    Done {
        output: ErrorHidingOutput<W>,
        channels: McapChannels,
    },
    Lost,
}

impl<W: Write + Seek> McapWriter<W> {
    /// A writer into `output` with the columns of [`Fields::FILE`] without the tilt, one cloud per
    /// sweep.
    pub fn new(output: W, fields: Fields) -> Self {
        let (output, fault) = ErrorHidingOutput::new(output);
        Self {
            stage: Stage::default(),
            clouds: MessageSplitter::new(FORMAT, fields, Frames::default()),
            log: McapLog {
                fault,
                state: McapState::Idle(output),
                hardware: String::new(),
                east_north_up: None,
                track: TiltTrack::default(),
                samples: 0,
                transformed: None,
                cdr: Cdr::new(),
                now: None,
                points: 0,
            },
        }
    }

    /// Writes one cloud per revolution of the lidar, which [`Sink::revolution`] ends; only before
    /// [`Sink::begin`].
    #[must_use]
    pub fn by_revolution(mut self) -> Self {
        self.clouds.by_revolution = true;
        self
    }

    /// Returns the output; `None` if writing failed or was not finished.
    pub fn into_inner(self) -> Option<W> {
        match self.log.state {
            McapState::Idle(output) | McapState::Done { output, .. } => Some(output.into_inner()),
            McapState::Open { .. } | McapState::Lost => None,
        }
    }
}

impl<W: Write + Seek> McapLog<W> {
    fn outcome<T>(&self, result: mcap::McapResult<T>) -> Result<T, SinkError> {
        let outcome = self.fault.outcome(result);
        outcome.map_err(|fault| fault.into_sink_error(self.points, FORMAT))
    }

    fn time(&self, stamp: Stamp<Host>) -> Result<Time, SinkError> {
        Time::of(stamp)
            .map_err(|error| EncodeError::library(error).into_sink_error(self.points, FORMAT))
    }

    /// Writes the message in `self.cdr`.
    fn write(&mut self, topic: Topic, at: Stamp<Host>) -> Result<(), SinkError> {
        let cdr = std::mem::take(&mut self.cdr);
        let written = self.write_bytes(topic, at, cdr.bytes());
        self.cdr = cdr;
        written
    }

    fn write_bytes(
        &mut self,
        topic: Topic,
        at: Stamp<Host>,
        bytes: &[u8],
    ) -> Result<(), SinkError> {
        let McapState::Open { writer, channels } = &mut self.state else {
            return Err(SinkError::Order {
                format: FORMAT,
                expected: "begin",
                got: "a message",
            });
        };
        let result = channels.write(writer, topic, at, bytes);
        self.outcome(result)
    }

    /// Writes all messages up to `at`; the first time also the static ones.
    fn write_until(&mut self, at: Stamp<Host>) -> Result<(), SinkError> {
        if self.now.is_none() {
            let first = self.track.samples.first().map(|sample| sample.0);
            self.write_mount(first.map_or(at, |first| first.min(at)))?;
        }
        while let Some((time, tilt)) = self.track.samples.get(self.samples).copied() {
            if time > at {
                break;
            }
            self.samples += 1;
            self.write_sample(time, tilt)?;
        }
        self.now = self.now.max(Some(at));
        Ok(())
    }

    fn write_mount(&mut self, at: Stamp<Host>) -> Result<(), SinkError> {
        let stamp = self.time(at)?;
        let frames = Frames::default();
        let mut transforms = frames.fixed(self.track.mount);
        transforms.extend(self.east_north_up.map(|axes| frames.in_map(axes)));
        tf_message(&mut self.cdr, stamp, &transforms);
        self.write(Topic::StaticTransforms, at)
    }

    fn write_sample(&mut self, at: Stamp<Host>, tilt: Degrees) -> Result<(), SinkError> {
        let stamp = self.time(at)?;
        joint_state(&mut self.cdr, stamp, tilt);
        self.write(Topic::JointStates, at)?;
        let due = self
            .transformed
            .is_none_or(|last| at.saturating_since(last) >= TRANSFORMS_EVERY);
        let last_one = self.samples == self.track.samples.len();
        if !due && !last_one {
            return Ok(());
        }
        self.transformed = Some(at);
        let frames = Frames::default();
        let tilted = frames.tilted(tilt);
        tf_message(&mut self.cdr, stamp, &[tilted]);
        self.write(Topic::Transforms, at)
    }

    fn write_cloud(&mut self, cloud: Cloud<'_>) -> Result<(), SinkError> {
        let (first, last) = cloud.times;
        if self.now.is_none() {
            self.write_until(first)?;
        }
        self.write_until(last)?;
        self.write_bytes(Topic::Points, self.now.unwrap_or(last), cloud.bytes)
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        self.hardware.clone_from(&metadata.source);
        self.east_north_up = metadata.east_north_up;
        let McapState::Idle(output) = std::mem::replace(&mut self.state, McapState::Lost) else {
            return Ok(());
        };
        let options = WriteOptions::new()
            .profile("ros2")
            .library(&metadata.software)
            .compression(Some(Compression::Lz4))
            .chunk_size(Some(CHUNK_BYTES));
        let writer = options.create(output).and_then(|mut writer| {
            writer.write_metadata(&record(metadata))?;
            writer.write_metadata(&bag::record())?;
            Ok(writer)
        });
        self.state = McapState::Open {
            writer: Box::new(self.outcome(writer)?),
            channels: McapChannels::default(),
        };
        Ok(())
    }

    fn write_diagnostics(&mut self, diagnostics: &[Diagnostic]) -> Result<(), SinkError> {
        let last = self.track.samples.last().map(|sample| sample.0);
        let Some(end) = last.max(self.now) else {
            // Without messages there is no time.
            return Ok(());
        };
        self.write_until(end)?;
        let stamp = self.time(end)?;
        diagnostic_array(&mut self.cdr, stamp, &self.hardware, diagnostics);
        self.write(Topic::Diagnostics, end)
    }

    fn finish(&mut self) -> Result<(), SinkError> {
        let McapState::Open {
            mut writer,
            channels,
        } = std::mem::replace(&mut self.state, McapState::Lost)
        else {
            return Ok(());
        };
        let finished = writer.finish();
        self.outcome(finished)?;
        let mut output = writer.into_inner();
        let flushed = output.flush().map_err(mcap::McapError::from);
        self.outcome(flushed)?;
        self.state = McapState::Done { output, channels };
        Ok(())
    }
}

/// The metadata record, uncompressed.
fn record(metadata: &Metadata) -> mcap::records::Metadata {
    let about = metadata.lines().join("\n");
    let simulated = metadata.simulated.to_string();
    mcap::records::Metadata {
        name: "velomotion".to_owned(),
        metadata: BTreeMap::from([
            ("about".to_owned(), about),
            ("simulated".to_owned(), simulated),
        ]),
    }
}

impl<W: Write + Seek> McapWriter<W> {
    fn end_cloud(&mut self) -> Result<(), SinkError> {
        self.clouds.end(|cloud| self.log.write_cloud(cloud))
    }
}

impl<W: Write + Seek> Sink for McapWriter<W> {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.stage.points(FORMAT)?;
        self.clouds.check(batch)?;
        let mut take = |cloud: Cloud<'_>| self.log.write_cloud(cloud);
        if let Err(error) = self.clouds.points(batch, &mut take) {
            self.stage = Stage::Cut;
            return Err(error);
        }
        self.log.points = self.clouds.summary.points;
        Ok(())
    }

    fn fields(&self) -> Fields {
        self.clouds.fields()
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        self.stage.begin(FORMAT)?;
        self.log.begin(metadata)?;
        self.clouds.east_north_up = metadata.east_north_up;
        self.stage = Stage::Open;
        Ok(())
    }

    fn wants_tilt(&self) -> bool {
        true
    }

    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        self.stage.points(FORMAT)?;
        self.log.track = track.clone();
        self.clouds.tilt(track);
        Ok(())
    }

    fn revolution(&mut self, _: &Revolution) -> Result<(), SinkError> {
        self.stage.points(FORMAT)?;
        self.clouds.revolution(|cloud| self.log.write_cloud(cloud))
    }

    fn diagnostics(&mut self, diagnostics: &[Diagnostic]) -> Result<(), SinkError> {
        self.stage.points(FORMAT)?;
        self.end_cloud()?;
        self.log.write_diagnostics(diagnostics)
    }

    fn companion(&self, file_name: &str) -> Option<Companion> {
        let McapState::Done { channels, .. } = &self.log.state else {
            return None;
        };
        Some(bag::companion(file_name, channels))
    }

    fn finish(&mut self) -> Result<Summary, SinkError> {
        let whole = self.stage == Stage::Open;
        self.stage.finish(FORMAT)?;
        if whole {
            self.end_cloud()?;
            if let Some((last, _)) = self.log.track.samples.last().copied() {
                self.log.write_until(last)?;
            }
        }
        self.log.finish()?;
        Ok(self.clouds.summary)
    }
}

#[cfg(test)]
mod tests;
