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

use super::file_sink::{EncodeError, FileSink, FormatEncoder};
use super::layout::RowLayout;
use crate::rows::NumberType;
use crate::{Fields, Metadata, Points, Summary};

/// Writes PLY to an output that seeks. Each batch is one write: the output needs no buffer.
pub type PlyWriter<W> = FileSink<PlyEncoder<W>>;

/// Writes PLY to an output that does not seek, such as a pipe. The header contains the count, so
/// the rows (29 bytes per point) wait in a scratch file, or in memory (`Cursor<Vec<u8>>`), until
/// [`finish`](crate::Sink::finish).
pub type PlyPipe<W, S> = FileSink<PipeEncoder<W, S>>;

/// Encoder of [`PlyWriter`].
#[derive(Debug)]
pub struct PlyEncoder<W> {
    output: W,
    layout: RowLayout,
    count_at: u64,
}

/// Encoder of [`PlyPipe`].
#[derive(Debug)]
pub struct PipeEncoder<W, S> {
    output: W,
    scratch: S,
    layout: RowLayout,
    head: String,
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

impl<W: Write + Seek> PlyWriter<W> {
    /// A writer into `output` from its current position, with the columns `fields`.
    pub fn new(output: W, fields: Fields) -> Self {
        let encoder = PlyEncoder {
            output,
            layout: RowLayout::new(fields),
            count_at: 0,
        };
        Self::of(encoder, fields)
    }

    /// Returns the output.
    pub fn into_inner(self) -> W {
        self.encoder.output
    }
}

impl<W: Write + Seek> FormatEncoder for PlyEncoder<W> {
    fn format(&self) -> &'static str {
        "ply"
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), EncodeError> {
        let head = head(metadata);
        self.count_at = self.output.stream_position()? + head.len() as u64;
        let header = head + &count_lines(0) + &tail(&self.layout);
        Ok(self.output.write_all(header.as_bytes())?)
    }

    fn points(&mut self, batch: &Points) -> Result<(), EncodeError> {
        Ok(self.output.write_all(self.layout.encode(batch))?)
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), EncodeError> {
        self.output.seek(SeekFrom::Start(self.count_at))?;
        self.output
            .write_all(count_lines(summary.points).as_bytes())?;
        self.output.seek(SeekFrom::End(0))?;
        Ok(self.output.flush()?)
    }
}

impl<W: Write, S: Read + Write + Seek> PlyPipe<W, S> {
    /// A writer into `output` with the columns `fields`; `scratch` is empty.
    pub fn new(output: W, scratch: S, fields: Fields) -> Self {
        let encoder = PipeEncoder {
            output,
            scratch,
            layout: RowLayout::new(fields),
            head: String::new(),
        };
        Self::of(encoder, fields)
    }

    #[cfg(test)]
    fn into_inner(self) -> W {
        self.encoder.output
    }
}

impl<W: Write, S: Read + Write + Seek> FormatEncoder for PipeEncoder<W, S> {
    fn format(&self) -> &'static str {
        "ply"
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), EncodeError> {
        self.head = head(metadata);
        Ok(())
    }

    fn points(&mut self, batch: &Points) -> Result<(), EncodeError> {
        Ok(self.scratch.write_all(self.layout.encode(batch))?)
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), EncodeError> {
        let count = format!("element vertex {}\n", summary.points);
        for part in [&self.head, &count, &tail(&self.layout)] {
            self.output.write_all(part.as_bytes())?;
        }
        self.scratch.rewind()?;
        io::copy(&mut self.scratch, &mut self.output)?;
        Ok(self.output.flush()?)
    }
}

#[cfg(test)]
mod tests;
