//! A cloud for each turn of the lidar, cut at an azimuth, firing by firing; on request organised, with the shots that brought nothing
//! back. A file a turn, or a message a turn in one MCAP.

use std::path::{Path, PathBuf};

use cloud::formats::Format;
use cloud::{Fields, Metadata, Point, Points};
use lidar::{
    Decoder, Duplicates, Echo, Firing, Frame, FrameCutter, Options, OrganisedFrame, Stats, UtcClock,
};
use protocol::record::{Record, Wire};
use scanner::{Alignment, PlacementCounts};
use units::{Degrees, Host, Lidar, Span, Stamp};

use super::replay::tilt_track;
use crate::failure::{Failure, Kind};
use crate::output::{Target, sink_failure};

/// How frames are wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// Azimuth at which one ends and the next begins.
    pub cut: Degrees,
    /// Whether shots without a return are kept: a row a ring, a column a firing.
    pub organised: bool,
    /// Name of the clouds, each with the frame's number before its extension.
    pub output: PathBuf,
    /// Their columns beside the position.
    pub fields: Fields,
    /// Whether clouds that exist are overwritten.
    pub force: bool,
}

/// Makes clouds of frames.
pub struct FrameWriter<'a> {
    plan: &'a FramePlan,
    metadata: Metadata,
    decoder: Decoder,
    filling: Filling<'a>,
    /// The one file of all turns, where the format has room for many clouds.
    all: Option<Target>,
}

/// What was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// Points, and returns that have no place.
    pub placed: PlacementCounts,
    /// Points that were left out: the lidar's clock was not locked to UTC.
    pub without_utc: u64,
    /// Clouds.
    pub clouds: u64,
}

/// The frame being filled.
struct Filling<'a> {
    alignment: &'a Alignment,
    /// UTC by the lidar's receiver, where times are to be in it.
    utc: Option<&'a UtcClock>,
    organised: bool,
    /// Whether a return that is both of its pair is one point.
    once: bool,
    cutter: FrameCutter,
    points: Points,
    grid: OrganisedFrame,
    placed: PlacementCounts,
    without_utc: u64,
    /// Frames that have ended and are not written yet, with their rows.
    ended: Vec<(Frame, Points, u64)>,
    error: Option<Failure>,
    /// When the last record came.
    near: Option<Stamp<Host>>,
}

impl<'a> FrameWriter<'a> {
    /// A writer of frames as planned.
    ///
    /// # Errors
    /// [`Kind::Usage`] for an azimuth that is no number, or an organised cloud of another format than PCD.
    pub fn new(
        plan: &'a FramePlan,
        alignment: &'a Alignment,
        utc: Option<&'a UtcClock>,
        options: Options,
        metadata: Metadata,
    ) -> Result<Self, Failure> {
        let cutter = FrameCutter::new(plan.cut.0).map_err(|error| {
            Failure::new(Kind::Usage, error.to_string())
                .help("give --frames an azimuth in degrees, such as 180")
        })?;
        if plan.output == Path::new("-") {
            return Err(Failure::new(
                Kind::Usage,
                "--frames makes many clouds, and stdout takes one".to_owned(),
            )
            .help("give -o a name, such as turn.ply"));
        }
        if plan.organised && plan.output.extension().is_none_or(|e| e != "pcd") {
            return Err(Failure::new(
                Kind::Usage,
                format!("{}: an organised cloud is a PCD", plan.output.display()),
            )
            .help("give -o a name that ends in .pcd, or leave --organised out"));
        }
        let once = options.duplicates == Duplicates::Unique;
        let all = match Format::from_path(&plan.output) {
            Ok(Format::Mcap) => Some(one_file(plan, alignment, utc.is_some(), &metadata)?),
            _ => None,
        };
        Ok(Self {
            all,
            plan,
            metadata,
            decoder: Decoder::new(options),
            filling: Filling {
                once,
                alignment,
                utc,
                organised: plan.organised,
                cutter,
                points: Points::new(plan.fields),
                grid: OrganisedFrame::new(),
                placed: PlacementCounts::default(),
                without_utc: 0,
                ended: Vec::new(),
                error: None,
                near: None,
            },
        })
    }

    /// Takes a record.
    ///
    /// # Errors
    /// Where a cloud cannot be written, or the lidar turns into another model in mid-frame.
    pub fn observe(&mut self, record: &Record<'_>, written: &mut Written) -> Result<(), Failure> {
        let Wire::Lidar { payload, .. } = record.wire else {
            return Ok(());
        };
        let filling = &mut self.filling;
        filling.near = Some(record.host);
        self.decoder
            .packet(record.host, payload, &mut |firing| filling.firing(firing));
        self.write(written)
    }

    /// Writes the last frame. Where all are in one file, that is still to be committed.
    ///
    /// # Errors
    /// As [`FrameWriter::observe`].
    pub fn finish(mut self, written: &mut Written) -> Result<(Stats, Option<Target>), Failure> {
        let filling = &mut self.filling;
        self.decoder.finish(&mut |firing| filling.firing(firing));
        if let Some(frame) = self.filling.cutter.finish() {
            self.filling.end(frame);
        }
        self.write(written)?;
        written.placed = self.filling.placed;
        written.without_utc = self.filling.without_utc;
        Ok((self.decoder.stats().clone(), self.all))
    }

    fn write(&mut self, written: &mut Written) -> Result<(), Failure> {
        if let Some(error) = self.filling.error.take() {
            return Err(error);
        }
        for (frame, points, rows) in std::mem::take(&mut self.filling.ended) {
            if let Some(target) = &mut self.all {
                let sink = target.sink();
                sink.points(&points)
                    .and_then(|()| sink.turn())
                    .map_err(|error| sink_failure(&self.plan.output, &error))?;
                written.clouds += 1;
                continue;
            }
            let path = name(&self.plan.output, frame.index);
            let mut target = if self.plan.organised {
                Target::organised(&path, self.plan.fields, self.plan.force, rows)?
            } else {
                Target::open(&path, self.plan.fields, self.plan.force)?
            };
            let mut metadata = self.metadata.clone();
            metadata.comments.push(said(&frame));
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
            written.clouds += 1;
        }
        Ok(())
    }
}

/// Opens the one file of all turns.
fn one_file(
    plan: &FramePlan,
    alignment: &Alignment,
    in_utc: bool,
    metadata: &Metadata,
) -> Result<Target, Failure> {
    let mut target = Target::turns(&plan.output, plan.fields, plan.force)?;
    let mut track = tilt_track(alignment);
    if in_utc {
        // Samples have times of the host's clock, which the points have not.
        track.samples.clear();
    }
    let sink = target.sink();
    sink.begin(metadata)
        .and_then(|()| sink.tilt(&track))
        .map_err(|error| sink_failure(&plan.output, &error))?;
    Ok(target)
}

impl Filling<'_> {
    fn firing(&mut self, firing: &Firing<'_>) {
        if let Some(frame) = self.cutter.firing(firing) {
            self.end(frame);
        }
        if self.organised {
            if self.utc.is_some_and(|clock| !has_utc(clock, firing)) {
                self.without_utc += firing.points().count() as u64;
                return;
            }
            if let Err(error) = self.grid.push(firing) {
                let error = Failure::new(Kind::BadInput, error.to_string())
                    .help("say which model it is with --model");
                self.error.get_or_insert(error);
            }
            return;
        }
        for seen in firing.points() {
            match self.alignment.place_received(&seen, self.near) {
                Some(point) => self.keep(point),
                None => self.placed.outside += 1,
            }
        }
    }

    /// Adds a point to a frame that is not organised.
    fn keep(&mut self, mut point: Point) {
        if let Some(clock) = self.utc {
            let Some(time) = in_utc(clock, point.device_time) else {
                self.without_utc += 1;
                return;
            };
            point.time = time;
        }
        self.placed.points += 1;
        self.points.push(point);
    }

    /// The frame is complete; one without points is not worth a cloud.
    fn end(&mut self, frame: Frame) {
        let before = self.placed.points;
        let fields = self.points.fields();
        let mut rows = 1;
        if self.organised {
            rows = (self.grid.layers() * self.grid.rings()) as u64;
            self.lay_out();
            self.grid.clear();
        }
        let points = std::mem::replace(&mut self.points, Points::new(fields));
        let any = if self.organised {
            self.placed.points > before
        } else {
            !points.is_empty()
        };
        if any {
            self.ended.push((frame, points, rows));
        }
    }

    /// The grid as points, row by row.
    fn lay_out(&mut self) {
        let (grid, alignment) = (&self.grid, self.alignment);
        for layer in 0..grid.layers() {
            for ring in 0..grid.rings() {
                for column in 0..grid.columns().len() {
                    let seen = grid.cell(layer, ring, column).filter(|seen| {
                        !(self.once && layer > 0 && seen.echo == Echo::LastAndStrongest)
                    });
                    let placed = seen.and_then(|seen| alignment.place_received(seen, self.near));
                    match (seen, placed) {
                        (_, Some(_)) => self.placed.points += 1,
                        (Some(_), None) => self.placed.outside += 1,
                        (None, None) => {}
                    }
                    let nothing = || nothing(alignment, self.near, grid, ring, column);
                    let mut point = placed.unwrap_or_else(nothing);
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

/// Whether the clock was locked from a firing's first laser to its last: an organised frame has it whole or not at all.
fn has_utc(clock: &UtcClock, firing: &Firing<'_>) -> bool {
    let last = firing.model.lasers.iter().map(|laser| laser.delay_ns).max();
    let end = firing.start + Span::from_nanos(i64::from(last.unwrap_or(0)));
    clock.utc(firing.start).is_some() && clock.utc(end).is_some()
}

/// The point of a shot that brought nothing back: fired then, by that laser, without a place.
fn nothing(
    alignment: &Alignment,
    near: Option<Stamp<Host>>,
    grid: &OrganisedFrame,
    ring: usize,
    column: usize,
) -> Point {
    let time = grid
        .time(ring, column)
        .map_or(Stamp::from_nanos(0), |time| {
            alignment.clock.moment_near(time, near).host
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

/// What a frame's cloud says of it.
fn said(frame: &Frame) -> String {
    let whole = if frame.whole { "whole" } else { "not whole" };
    format!("frame {}, {whole}: {} firings", frame.index, frame.firings)
}

/// `scan.pcd` to `scan-00017.pcd`.
fn name(output: &Path, index: u64) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    let extension = output.extension().unwrap_or_default().to_string_lossy();
    output.with_file_name(format!("{stem}-{index:05}.{extension}"))
}
