//! One cloud per revolution of the lidar, cut at an azimuth.
//!
//! A file per revolution, or one message per revolution in an MCAP. Organised clouds keep shots
//! without a return.

use std::path::{Path, PathBuf};

use cloud::formats::Format;
use cloud::{Fields, Metadata, Point, Points};
use lidar::{
    Decoder, Duplicates, Firing, FrameCutter, Options, OrganisedFrame, ReturnKind, RevolutionFrame,
    Stats, UtcClock,
};
use protocol::record::{Record, Wire};
use scanner::{Alignment, PlacementCounts};
use units::{Degrees, Host, Lidar, Span, Stamp};

use super::replay::tilt_track;
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

/// Writes one cloud per frame.
pub struct FrameWriter<'a> {
    plan: &'a FramePlan,
    metadata: Metadata,
    decoder: Decoder,
    builder: FrameBuilder<'a>,
    /// The single file of formats that hold many clouds.
    mcap: Option<Target>,
}

/// Totals over all frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct FrameTotals {
    /// Points, and returns without a tilt angle.
    pub placed: PlacementCounts,
    /// Points omitted because the lidar's clock was not locked to UTC.
    pub without_utc: u64,
    /// Clouds written.
    pub clouds: u64,
}

/// The frame under construction.
struct FrameBuilder<'a> {
    alignment: &'a Alignment,
    /// UTC clock of the lidar's receiver, if point times are in UTC.
    utc: Option<&'a UtcClock>,
    organised: bool,
    /// Whether two equal returns of a pulse become one point.
    merge_equal: bool,
    cutter: FrameCutter,
    points: Points,
    grid: OrganisedFrame,
    totals: FrameTotals,
    /// Completed frames with their row counts, not written yet.
    ended: Vec<(RevolutionFrame, Points, u64)>,
    error: Option<Failure>,
    /// Receive time of the last record.
    received: Option<Stamp<Host>>,
}

impl<'a> FrameWriter<'a> {
    /// Creates a writer.
    ///
    /// # Errors
    /// [`Kind::Usage`] for an invalid azimuth, for stdout, or for an organised cloud that is not a
    /// PCD.
    pub fn new(
        plan: &'a FramePlan,
        alignment: &'a Alignment,
        utc: Option<&'a UtcClock>,
        options: Options,
        metadata: Metadata,
    ) -> Result<Self, Failure> {
        let cutter = frame_cutter(plan.cut)?;
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
        let merge_equal = options.duplicates == Duplicates::Unique;
        let mcap = match Format::from_path(&plan.output) {
            Ok(Format::Mcap) => Some(open_mcap(plan, alignment, utc.is_some(), &metadata)?),
            _ => None,
        };
        Ok(Self {
            mcap,
            plan,
            metadata,
            decoder: Decoder::new(options),
            builder: FrameBuilder {
                merge_equal,
                alignment,
                utc,
                organised: plan.organised,
                cutter,
                // LAS numbers the returns of a pulse by their echo.
                points: Points::new(plan.fields | Fields::ECHO),
                grid: OrganisedFrame::new(),
                totals: FrameTotals::default(),
                ended: Vec::new(),
                error: None,
                received: None,
            },
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
        let builder = &mut self.builder;
        builder.received = Some(record.host);
        self.decoder
            .packet(record.host, payload, &mut |firing| builder.firing(firing));
        self.write()
    }

    /// Writes the last frame. Returns the totals, and the uncommitted target that holds all frames.
    ///
    /// # Errors
    /// As [`FrameWriter::observe`].
    pub fn finish(mut self) -> Result<(FrameTotals, Stats, Option<Target>), Failure> {
        let builder = &mut self.builder;
        self.decoder.finish(&mut |firing| builder.firing(firing));
        if let Some(frame) = self.builder.cutter.finish() {
            self.builder.end(frame);
        }
        self.write()?;
        let stats = self.decoder.stats().clone();
        Ok((self.builder.totals, stats, self.mcap))
    }

    fn write(&mut self) -> Result<(), Failure> {
        if let Some(error) = self.builder.error.take() {
            return Err(error);
        }
        for (frame, points, rows) in std::mem::take(&mut self.builder.ended) {
            self.builder.totals.clouds += 1;
            if let Some(target) = &mut self.mcap {
                let sink = target.sink();
                sink.points(&points)
                    .and_then(|()| sink.revolution())
                    .map_err(|error| sink_failure(&self.plan.output, &error))?;
                continue;
            }
            let path = name(&self.plan.output, frame.index);
            let mut target = if self.plan.organised {
                Target::organised(&path, self.plan.fields, self.plan.force, rows)?
            } else {
                Target::open(&path, self.plan.fields, self.plan.force)?
            };
            let mut metadata = self.metadata.clone();
            metadata.comments.push(frame_comment(&frame));
            if self.plan.organised {
                metadata.comments.push(
                    "organised: a row a ring, the lowest first, a column a firing; in dual return the second returns' rings follow"
                        .to_owned(),
                );
            }
            let sink = target.sink();
            sink.begin(&metadata)
                .and_then(|()| sink.points(&points))
                .map_err(|error| sink_failure(&path, &error))?;
            target.commit()?;
        }
        Ok(())
    }
}

/// Cuts revolutions at an azimuth.
pub(super) fn frame_cutter(cut: Degrees) -> Result<FrameCutter, Failure> {
    FrameCutter::new(cut.0).map_err(|error| {
        Failure::new(Kind::Usage, error.to_string())
            .help("give --frames an azimuth in degrees, such as 180")
    })
}

/// Opens the file that holds all frames.
fn open_mcap(
    plan: &FramePlan,
    alignment: &Alignment,
    in_utc: bool,
    metadata: &Metadata,
) -> Result<Target, Failure> {
    let mut target = Target::by_revolution(&plan.output, plan.fields, plan.force)?;
    let mut track = tilt_track(alignment);
    if in_utc {
        // Samples carry host times, points carry UTC.
        track.samples.clear();
    }
    let sink = target.sink();
    sink.begin(metadata)
        .and_then(|()| sink.tilt(&track))
        .map_err(|error| sink_failure(&plan.output, &error))?;
    Ok(target)
}

impl FrameBuilder<'_> {
    fn firing(&mut self, firing: &Firing<'_>) {
        if let Some(frame) = self.cutter.firing(firing) {
            self.end(frame);
        }
        if self.organised {
            if self.utc.is_some_and(|clock| !has_utc(clock, firing)) {
                self.totals.without_utc += firing.points().count() as u64;
                return;
            }
            if let Err(error) = self.grid.push(firing) {
                let error = Failure::new(Kind::BadInput, error.to_string())
                    .help("set the model with --model");
                self.error.get_or_insert(error);
            }
            return;
        }
        for seen in firing.points() {
            match self.alignment.place_received(&seen, self.received) {
                Some(point) => self.push(point),
                None => self.totals.placed.outside += 1,
            }
        }
    }

    /// Adds a point to an unorganised frame.
    fn push(&mut self, mut point: Point) {
        if let Some(clock) = self.utc {
            let Some(time) = in_utc(clock, point.device_time) else {
                self.totals.without_utc += 1;
                return;
            };
            point.time = time;
        }
        self.totals.placed.points += 1;
        self.points.push(point);
    }

    /// Completes the frame; frames without points are dropped.
    fn end(&mut self, frame: RevolutionFrame) {
        let before = self.totals.placed.points;
        let fields = self.points.fields();
        let mut rows = 1;
        if self.organised {
            rows = (self.grid.layers() * self.grid.rings()) as u64;
            self.append_grid();
            self.grid.clear();
        }
        let points = std::mem::replace(&mut self.points, Points::new(fields));
        let any = if self.organised {
            self.totals.placed.points > before
        } else {
            !points.is_empty()
        };
        if any {
            self.ended.push((frame, points, rows));
        }
    }

    /// Converts the grid to points, row by row.
    fn append_grid(&mut self) {
        let (grid, alignment) = (&self.grid, self.alignment);
        for layer in 0..grid.layers() {
            for ring in 0..grid.rings() {
                for column in 0..grid.columns().len() {
                    let seen = grid.cell(layer, ring, column).filter(|seen| {
                        !(self.merge_equal
                            && layer > 0
                            && seen.echo == ReturnKind::LastAndStrongest)
                    });
                    let placed =
                        seen.and_then(|seen| alignment.place_received(seen, self.received));
                    match (seen, placed) {
                        (_, Some(_)) => self.totals.placed.points += 1,
                        (Some(_), None) => self.totals.placed.outside += 1,
                        (None, None) => {}
                    }
                    let empty_cell = || empty_cell(alignment, self.received, grid, ring, column);
                    let mut point = placed.unwrap_or_else(empty_cell);
                    let fired = grid.time(ring, column);
                    if let Some(time) = fired.zip(self.utc).and_then(|(at, utc)| in_utc(utc, at)) {
                        point.time = time;
                    }
                    self.points.push(point);
                }
            }
        }
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
fn frame_comment(frame: &RevolutionFrame) -> String {
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
