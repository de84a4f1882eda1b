//! Binary little-endian PLY.
//!
//! `float x y z` in metres, then by default `float intensity` (0..255), `uchar ring`, `double time`
//! (Unix seconds of the host), `float tilt` (degrees). Intensity is a float because PCL's point
//! types declare it so, and PCL matches fields by type. Ring is a uchar because every reader knows
//! that type: Open3D 0.20 skips a ushort, and meshio fails on one. An f32 coordinate is within 4 um
//! of the truth at 100 m, an f32 tilt within 2e-6 deg at 45.
//!
//! The vertex count is in the header but known at the end. [`PlyWriter`] seeks back; a comment
//! before the count keeps its length constant, so that the count is a plain number for every
//! reader. [`PlyPipe`] stores the rows in the meantime.

use std::io::{self, Read, Seek, SeekFrom, Write};

use super::layout::RowLayout;
use super::stage::Stage;
use crate::rows::NumberType;
use crate::{Fields, Metadata, Points, Sink, SinkError, Summary};

const FORMAT: &str = "ply";

/// Writes PLY to an output that seeks. Each batch is one write: the output needs no buffer.
#[derive(Debug)]
pub struct PlyWriter<W> {
    output: W,
    layout: RowLayout,
    stage: Stage,
    count_at: u64,
    summary: Summary,
}

/// Writes PLY to an output that does not seek, such as a pipe. The header contains the count, so
/// the rows (29 bytes per point) wait in a scratch file, or in memory (`Cursor<Vec<u8>>`), until
/// [`Sink::finish`].
#[derive(Debug)]
pub struct PlyPipe<W, S> {
    output: W,
    scratch: S,
    layout: RowLayout,
    stage: Stage,
    head: String,
    summary: Summary,
}

/// The header up to the count.
fn head(metadata: &Metadata) -> String {
    let mut head = String::from("ply\nformat binary_little_endian 1.0\n");
    for line in metadata.lines() {
        head += &format!("comment {line}\n");
    }
    head
}

/// The header from the count on.
fn tail(layout: &RowLayout) -> String {
    let mut tail = String::new();
    for (name, kind) in layout.properties() {
        let kind = match kind {
            NumberType::F32 => "float",
            NumberType::F64 => "double",
            NumberType::U16 => "ushort",
            NumberType::U8 => "uchar",
        };
        tail += &format!("property {kind} {name}\n");
    }
    tail + "end_header\n"
}

/// The count as a header line, behind a comment that makes the length constant.
fn count_lines(points: u64) -> String {
    const DIGITS: usize = 20; // of u64::MAX
    let count = points.to_string();
    let slack = ".".repeat(DIGITS.saturating_sub(count.len()));
    format!("comment room for the count .{slack}\nelement vertex {count}\n")
}

fn failed(points: u64) -> impl Fn(io::Error) -> SinkError {
    move |source| SinkError::Write {
        format: FORMAT,
        points,
        source,
    }
}

impl<W: Write + Seek> PlyWriter<W> {
    /// A writer into `output` from its current position, with the columns of [`Fields::FILE`].
    pub fn new(output: W) -> Self {
        Self {
            output,
            layout: RowLayout::new(Fields::FILE),
            stage: Stage::default(),
            count_at: 0,
            summary: Summary::default(),
        }
    }

    /// Sets the columns; only before [`Sink::begin`].
    #[must_use]
    pub fn with_fields(mut self, fields: Fields) -> Self {
        self.layout = RowLayout::new(fields);
        self
    }

    /// Returns the output.
    pub fn into_inner(self) -> W {
        self.output
    }

    fn write_header(&mut self, metadata: &Metadata) -> io::Result<()> {
        let head = head(metadata);
        self.count_at = self.output.stream_position()? + head.len() as u64;
        let header = head + &count_lines(0) + &tail(&self.layout);
        self.output.write_all(header.as_bytes())
    }

    fn write_count(&mut self) -> io::Result<()> {
        self.output.seek(SeekFrom::Start(self.count_at))?;
        self.output
            .write_all(count_lines(self.summary.points).as_bytes())?;
        self.output.seek(SeekFrom::End(0))?;
        self.output.flush()
    }
}

/// After a failed batch, [`Sink::finish`] still completes a file of the batches before it.
impl<W: Write + Seek> Sink for PlyWriter<W> {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.stage.points(FORMAT)?;
        let rows = self.layout.encode(batch)?;
        if let Err(source) = self.output.write_all(rows) {
            self.stage.cut();
            return Err(failed(self.summary.points)(source));
        }
        self.summary.add(batch.summary());
        Ok(())
    }

    fn fields(&self) -> Fields {
        self.layout.fields()
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        self.stage.begin(FORMAT)?;
        self.write_header(metadata).map_err(failed(0))?;
        self.stage.opened();
        Ok(())
    }

    fn finish(&mut self) -> Result<Summary, SinkError> {
        self.stage.finish(FORMAT)?;
        self.write_count().map_err(failed(self.summary.points))?;
        Ok(self.summary)
    }
}

impl<W: Write, S: Read + Write + Seek> PlyPipe<W, S> {
    /// A writer into `output` with the columns of [`Fields::FILE`]; `scratch` is empty.
    pub fn new(output: W, scratch: S) -> Self {
        Self {
            output,
            scratch,
            layout: RowLayout::new(Fields::FILE),
            stage: Stage::default(),
            head: String::new(),
            summary: Summary::default(),
        }
    }

    /// Sets the columns; only before [`Sink::begin`].
    #[must_use]
    pub fn with_fields(mut self, fields: Fields) -> Self {
        self.layout = RowLayout::new(fields);
        self
    }

    /// Returns the output.
    pub fn into_inner(self) -> W {
        self.output
    }

    fn write_all(&mut self) -> io::Result<()> {
        let header = format!(
            "{}element vertex {}\n{}",
            self.head,
            self.summary.points,
            tail(&self.layout)
        );
        self.output.write_all(header.as_bytes())?;
        self.scratch.rewind()?;
        io::copy(&mut self.scratch, &mut self.output)?;
        self.output.flush()
    }
}

impl<W: Write, S: Read + Write + Seek> Sink for PlyPipe<W, S> {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.stage.points(FORMAT)?;
        let rows = self.layout.encode(batch)?;
        if let Err(source) = self.scratch.write_all(rows) {
            self.stage.cut();
            return Err(failed(self.summary.points)(source));
        }
        self.summary.add(batch.summary());
        Ok(())
    }

    fn fields(&self) -> Fields {
        self.layout.fields()
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        self.stage.begin(FORMAT)?;
        self.head = head(metadata);
        self.stage.opened();
        Ok(())
    }

    fn finish(&mut self) -> Result<Summary, SinkError> {
        self.stage.finish(FORMAT)?;
        self.write_all().map_err(failed(0))?;
        Ok(self.summary)
    }
}

#[cfg(test)]
mod tests;
