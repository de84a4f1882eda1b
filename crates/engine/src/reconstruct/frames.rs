//! One cloud per revolution of the lidar, cut at an azimuth.
//!
//! A file per revolution, or one message per revolution in an MCAP. Organised clouds keep shots
//! without a return.

use std::path::{Path, PathBuf};

use cloud::formats::Format;
use cloud::{Diagnostic, Fields, Metadata, Point, Points, Revolution, Sink, SinkError, TiltTrack};
use lidar::{
    Decoder, Duplicates, Firing, FiringBlock, FrameCutter, Options, OrganisedFrame, ReturnKind,
    RevolutionFrame, Stats, UtcClock,
};
use protocol::record::{Record, Wire};
use scanner::{Alignment, PlacementCounts, ReceiveOrder, revolution_of};
use units::{Degrees, Host, Lidar, Span, Stamp};

use crate::failure::{Failure, Kind};
use crate::output::{Target, sink_failure};

/// Requested frames.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// Azimuth at which one frame ends and the next begins.
    pub cut: Degrees,
    /// Whether shots without a return are kept: one row per ring, one column per firing.
    pub organised: bool,
    /// Path of the clouds; each gets the frame's number before the extension.
    pub output: PathBuf,
    /// Columns in addition to the position.
    pub fields: Fields,
    /// Whether existing files are overwritten.
    pub force: bool,
}

/// Writes one cloud per revolution: a file each, or a message each in one MCAP.
pub(super) struct FrameFiles<'a> {
    plan: &'a FramePlan,
    metadata: Metadata,
    /// The single file of formats that hold many clouds.
    mcap: Option<Target>,
    points: Points,
    /// Clouds written.
    pub clouds: u64,
    failure: Option<Failure>,
}

impl<'a> FrameFiles<'a> {
    /// Checks the plan, and opens the file that holds all frames.
    ///
    /// # Errors
    /// [`Kind::Usage`] for stdout, for an organised cloud that is not a PCD, and for frames of an
    /// earlier run.
    pub fn new(plan: &'a FramePlan) -> Result<Self, Failure> {
        if plan.output == Path::new("-") {
            return Err(Failure::new(
                Kind::Usage,
                "--frames makes many clouds, and stdout takes one".to_owned(),
            )
            .help("give -o a name, such as frame.ply"));
        }
        if plan.organised && plan.output.extension().is_none_or(|e| e != "pcd") {
            return Err(Failure::new(
                Kind::Usage,
                format!("{}: an organised cloud is a PCD", plan.output.display()),
            )
            .help("give -o a name that ends in .pcd, or leave --organised out"));
        }
        if !plan.force
            && let Some(earlier) = earlier_frame(&plan.output)
        {
            return Err(Failure::new(
                Kind::Usage,
                format!("{} exists already: frames of two recordings would mix", earlier.display()),
            )
            .help("give -o another name, remove the earlier frames, or overwrite those of the same number with --force"));
        }
        let mcap = match Format::from_path(&plan.output) {
            Ok(Format::Mcap) => Some(Target::by_revolution(
                &plan.output,
                plan.fields,
                plan.force,
            )?),
            _ => None,
        };
        Ok(Self {
            plan,
            metadata: Metadata::default(),
            mcap,
            // LAS numbers the returns of a pulse by their echo.
            points: Points::new(plan.fields | Fields::ECHO),
            clouds: 0,
            failure: None,
        })
    }

    /// The reason why a file could not be written, if that was the cause of `failure`.
    pub fn cause(&mut self, failure: Failure) -> Failure {
        self.failure.take().unwrap_or(failure)
    }

    /// Commits the file that holds all frames.
    ///
    /// # Errors
    /// As [`Target::commit`].
    pub fn commit(self) -> Result<(), Failure> {
        self.mcap.map_or(Ok(()), Target::commit)
    }

    /// Writes a frame with `rows` rows of points. Frames without points have none.
    fn write(&mut self, frame: &Revolution, points: &Points, rows: u64) -> Result<(), Failure> {
        self.clouds += 1;
        let plan = self.plan;
        if let Some(target) = &mut self.mcap {
            let sink = target.sink();
            return sink
                .points(points)
                .and_then(|()| sink.revolution(frame))
                .map_err(|error| sink_failure(&plan.output, &error));
        }
        let path = name(&plan.output, frame.index);
        let mut target = match plan.organised {
            true => Target::organised(&path, plan.fields, plan.force, rows)?,
            false => Target::open(&path, plan.fields, plan.force)?,
        };
        let mut metadata = self.metadata.clone();
        metadata.comments.push(frame_comment(frame));
        if plan.organised {
            metadata.comments.push(
                "organised: one row per ring, the lowest first, and one column per firing; in dual return the rings of the second returns follow"
                    .to_owned(),
            );
        }
        let sink = target.sink();
        sink.begin(&metadata)
            .and_then(|()| sink.points(points))
            .map_err(|error| sink_failure(&path, &error))?;
        target.commit()
    }

    fn keep(&mut self, written: Result<(), Failure>) -> Result<(), SinkError> {
        written.map_err(|failure| {
            let error = SinkError::Other(failure.message.clone().into());
            self.failure = Some(failure);
            error
        })
    }
}

impl Sink for FrameFiles<'_> {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        Ok(self.points.append(batch)?)
    }

    fn fields(&self) -> Fields {
        self.points.fields()
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        self.metadata = metadata.clone();
        let mcap = self.mcap.as_mut();
        mcap.map_or(Ok(()), |target| target.sink().begin(metadata))
    }

    fn wants_tilt(&self) -> bool {
        self.mcap.is_some()
    }

    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        let mcap = self.mcap.as_mut();
        mcap.map_or(Ok(()), |target| target.sink().tilt(track))
    }

    fn revolution(&mut self, revolution: &Revolution) -> Result<(), SinkError> {
        if self.points.is_empty() {
            return Ok(());
        }
        let empty = Points::new(self.points.fields());
        let points = std::mem::replace(&mut self.points, empty);
        let written = self.write(revolution, &points, 1);
        self.keep(written)
    }

    fn diagnostics(&mut self, diagnostics: &[Diagnostic]) -> Result<(), SinkError> {
        let mcap = self.mcap.as_mut();
        mcap.map_or(Ok(()), |target| target.sink().diagnostics(diagnostics))
    }
}

/// Cuts revolutions at an azimuth.
pub(super) fn frame_cutter(cut: Degrees) -> Result<FrameCutter, Failure> {
    FrameCutter::new(cut.0).map_err(|error| {
        Failure::new(Kind::Usage, error.to_string())
            .help("give --frames an azimuth in degrees, such as 180")
    })
}

/// Builds organised frames, which keep shots without a return, and writes them.
pub(super) struct OrganisedFrames<'a, 'f> {
    files: &'f mut FrameFiles<'a>,
    decoder: Decoder,
    receive_order: ReceiveOrder,
    builder: FrameBuilder<'f>,
}

/// The frame under construction.
struct FrameBuilder<'a> {
    alignment: &'a Alignment,
    /// UTC clock of the lidar's receiver, if point times are in UTC.
    utc: Option<&'a UtcClock>,
    /// Whether two equal returns of a pulse become one point.
    merge_equal: bool,
    cutter: FrameCutter,
    grid: OrganisedFrame,
    /// Receive time of each column's packet.
    received: Vec<Stamp<Host>>,
    counts: PlacementCounts,
    /// Points omitted because the lidar's clock was not locked to UTC.
    without_utc: u64,
    /// Completed frames with their row counts, not written yet.
    ended: Vec<(RevolutionFrame, Points, u64)>,
    fields: Fields,
    error: Option<Failure>,
}

impl<'a, 'f> OrganisedFrames<'a, 'f> {
    /// Frames of `alignment` for `files`.
    ///
    /// # Errors
    /// [`Kind::Usage`] for an invalid azimuth.
    pub fn new(
        files: &'f mut FrameFiles<'a>,
        alignment: &'f Alignment,
        utc: Option<&'f UtcClock>,
        options: Options,
        metadata: &Metadata,
    ) -> Result<Self, Failure> {
        files.metadata = metadata.clone();
        let builder = FrameBuilder {
            alignment,
            utc,
            merge_equal: options.duplicates == Duplicates::Unique,
            cutter: frame_cutter(files.plan.cut)?,
            grid: OrganisedFrame::new(),
            received: Vec::new(),
            counts: PlacementCounts::default(),
            without_utc: 0,
            ended: Vec::new(),
            fields: files.fields(),
            error: None,
        };
        Ok(Self {
            files,
            decoder: Decoder::new(options),
            receive_order: ReceiveOrder::default(),
            builder,
        })
    }

    /// Processes a record.
    ///
    /// # Errors
    /// A cloud cannot be written, or the lidar's model changes within a frame.
    pub fn observe(&mut self, record: &Record<'_>) -> Result<(), Failure> {
        let Wire::Lidar { payload, .. } = record.wire else {
            return Ok(());
        };
        let host = self.receive_order.distinct(record.host);
        let builder = &mut self.builder;
        self.decoder
            .decode_blocks(host, payload, &mut |block| builder.block(block));
        self.write()
    }

    /// Writes the last frame. Returns the counts of points, and of those omitted without UTC.
    ///
    /// # Errors
    /// As [`OrganisedFrames::observe`].
    pub fn finish(mut self) -> Result<(PlacementCounts, u64, Stats), Failure> {
        let builder = &mut self.builder;
        self.decoder
            .finish_blocks(&mut |block| builder.block(block));
        if let Some(frame) = self.builder.cutter.finish() {
            self.builder.end(frame);
        }
        self.write()?;
        let stats = self.decoder.stats().clone();
        Ok((self.builder.counts, self.builder.without_utc, stats))
    }

    fn write(&mut self) -> Result<(), Failure> {
        if let Some(error) = self.builder.error.take() {
            return Err(error);
        }
        for (frame, points, rows) in self.builder.ended.drain(..) {
            self.files.write(&revolution_of(&frame), &points, rows)?;
        }
        Ok(())
    }
}

impl FrameBuilder<'_> {
    fn block(&mut self, block: &FiringBlock<'_>) {
        for firing in block.firings() {
            self.firing(&firing, block.began);
        }
    }

    fn firing(&mut self, firing: &Firing<'_>, received: Stamp<Host>) {
        if let Some(frame) = self.cutter.firing(firing) {
            self.end(frame);
        }
        if self.utc.is_some_and(|clock| !has_utc(clock, firing)) {
            self.without_utc += firing.points().count() as u64;
            return;
        }
        match self.grid.push(firing) {
            Ok(()) => self.received.push(received),
            Err(error) => {
                let error = Failure::new(Kind::BadInput, error.to_string())
                    .help("set the model with --model");
                self.error.get_or_insert(error);
            }
        }
    }

    /// Completes the frame; frames without points are dropped.
    fn end(&mut self, frame: RevolutionFrame) {
        let before = self.counts.points;
        let rows = (self.grid.layers() * self.grid.rings()) as u64;
        let points = self.points();
        self.grid.clear();
        self.received.clear();
        if self.counts.points > before {
            self.ended.push((frame, points, rows));
        }
    }

    /// The grid's points, row by row.
    fn points(&mut self) -> Points {
        let (grid, alignment) = (&self.grid, self.alignment);
        let mut points = Points::new(self.fields);
        for layer in 0..grid.layers() {
            for ring in 0..grid.rings() {
                for (column, received) in self.received.iter().enumerate() {
                    let received = Some(*received);
                    let seen = grid.cell(layer, ring, column).filter(|seen| {
                        !(self.merge_equal
                            && layer > 0
                            && seen.echo == ReturnKind::LastAndStrongest)
                    });
                    let placed = seen.and_then(|seen| alignment.place_received(seen, received));
                    match (seen, placed) {
                        (_, Some(_)) => self.counts.points += 1,
                        (Some(_), None) => self.counts.outside += 1,
                        (None, None) => {}
                    }
                    let empty_cell = || empty_cell(alignment, received, grid, ring, column);
                    let mut point = placed.unwrap_or_else(empty_cell);
                    let fired = grid.time(ring, column);
                    if let Some(time) = fired.zip(self.utc).and_then(|(at, utc)| in_utc(utc, at)) {
                        point.time = time;
                    }
                    points.push(point);
                }
            }
        }
        points
    }
}

fn in_utc(clock: &UtcClock, device_time: Stamp<Lidar>) -> Option<Stamp<Host>> {
    let utc = clock.utc(device_time)?;
    Some(Stamp::from_nanos(utc.as_nanos()))
}

/// Whether the clock was locked from the firing's first laser to its last. An organised frame keeps
/// or drops a firing whole.
fn has_utc(clock: &UtcClock, firing: &Firing<'_>) -> bool {
    let last = firing.model.lasers.iter().map(|laser| laser.delay_ns).max();
    let end = firing.start + Span::from_nanos(i64::from(last.unwrap_or(0)));
    clock.utc(firing.start).is_some() && clock.utc(end).is_some()
}

/// The point of a shot without a return: time and ring, no position.
fn empty_cell(
    alignment: &Alignment,
    received: Option<Stamp<Host>>,
    grid: &OrganisedFrame,
    ring: usize,
    column: usize,
) -> Point {
    let time = grid
        .time(ring, column)
        .map_or(Stamp::from_nanos(0), |time| {
            alignment.clock.moment_near(time, received).host
        });
    Point {
        position_m: [f64::NAN; 3],
        ring: u8::try_from(ring).unwrap_or(u8::MAX),
        time,
        tilt: Degrees(f64::NAN),
        sd_m: f64::NAN,
        ..Point::default()
    }
}

/// Comment in a frame's cloud.
fn frame_comment(frame: &Revolution) -> String {
    let whole = if frame.whole { "whole" } else { "not whole" };
    format!("frame {}, {whole}: {} firings", frame.index, frame.firings)
}

/// A frame of an earlier run with this output.
fn earlier_frame(output: &Path) -> Option<PathBuf> {
    let folder = output.parent().filter(|folder| *folder != Path::new(""));
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    let mut names =
        entries.filter_map(|entry| Some(output.with_file_name(entry.ok()?.file_name())));
    let is_frame = |path: &PathBuf| {
        let stem = path.file_stem().and_then(|stem| stem.to_str());
        let index = stem.and_then(|stem| stem.rsplit_once('-')?.1.parse().ok());
        index.is_some_and(|index| name(output, index) == *path)
    };
    names.find(is_frame)
}

/// `scan.pcd` with index 17 becomes `scan-00017.pcd`.
fn name(output: &Path, index: u64) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    let extension = output.extension().unwrap_or_default().to_string_lossy();
    output.with_file_name(format!("{stem}-{index:05}.{extension}"))
}
