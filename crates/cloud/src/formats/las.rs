//! LAS 1.4 and LAZ, point format 6, by the `las` crate.
//!
//! Coordinates are in a local frame without a coordinate reference system, in 0.1 mm steps from
//! offset 0, which reaches 214.7 km. Intensity is the reflectivity times 257, so that 0..=255 fills
//! 0..=65535. `gps_time` is adjusted standard GPS time, from the host's Unix time and the leap
//! seconds. Ring, time (f64 Unix seconds), tilt (f32 degrees) and further columns are described
//! extra bytes, which readers show by name. A simulated cloud is marked in the system identifier,
//! in the text record, and by the synthetic flag of every point, which survives merging with other
//! clouds. There is no creation date, as the same log must give the same bytes.

pub(crate) mod extra_bytes;

use std::io::{Seek, Write};

use las::{Builder, GpsTimeType, PointData, PointDataBuilder, Transform, Vector, Vlr};

use self::extra_bytes::ExtraColumn;
use super::fallible::{ErrorHidingOutput, WriteFault};
use super::file_sink::{EncodeError, FileSink, FormatEncoder};
use super::gps_time;
use super::seconds::seconds;
use crate::rows::{fill, fill_values};
use crate::{Fields, Metadata, Points, Summary};

const SCALE_M: f64 = 1e-4;
const STEPS_PER_M: f64 = 1e4;
/// The greatest coordinate of 32 bits in 0.1 mm.
const LIMIT_M: f64 = (i32::MAX as f64) / STEPS_PER_M;
pub(crate) const INTENSITY_STEP: u16 = u16::MAX / u8::MAX as u16;

/// Offsets in point format 6 (LAS 1.4 R15, section 2.6.7); all other fields are zero.
mod at {
    pub const XYZ: [usize; 3] = [0, 4, 8];
    pub const INTENSITY: usize = 12;
    pub const RETURNS: usize = 14;
    pub const FLAGS: usize = 15;
    pub const GPS_TIME: usize = 22;
    pub const EXTRA: usize = 30;
}
/// Rows of LAZ written at once: eight chunks of 50,000, which the library compresses in parallel.
const ROWS_OF_LAZ: usize = 400_000;

/// Return number, and number of returns in the upper half.
const ONE_OF_ONE: u8 = 0x11;
const ONE_OF_TWO: u8 = 0x21;
const TWO_OF_TWO: u8 = 0x22;
/// Classification flag bit 0: not from a real lidar.
const SYNTHETIC: u8 = 1;

/// Writes LAS or LAZ batch by batch to an output that seeks. LAZ writes in small pieces: use a
/// buffered output. It is compressed on all cores.
///
/// Unlike with PLY, a file whose output failed is lost: its header cannot be completed.
pub(super) type LasWriter<W> = FileSink<LasEncoder<W>>;

/// Encoder of [`LasWriter`].
pub(super) struct LasEncoder<W: Write + Seek + Send + Sync + 'static> {
    format: &'static str,
    extras: Vec<ExtraColumn>,
    flags: u8,
    dual_return: bool,
    fault: WriteFault,
    /// Before begin, or after finish.
    output: Option<ErrorHidingOutput<W>>,
    open: Option<OpenLasFile<W>>,
}

/// An output with its header, and the rows that are not written yet.
struct OpenLasFile<W: Write + Seek + Send + Sync + 'static> {
    writer: las::Writer<ErrorHidingOutput<W>>,
    rows: PointData,
}

impl<W: Write + Seek + Send + Sync + 'static> OpenLasFile<W> {
    /// Writes at most `limit` rows and keeps the rest.
    fn write_rows(&mut self, limit: usize) -> las::Result<()> {
        let end = limit.saturating_mul(self.rows.record_len());
        let rest = self.rows.raw_bytes().get(end..).unwrap_or_default();
        let rest = rest.to_vec();
        self.rows.resize_for(self.rows.len().min(limit));
        self.writer.write_points(&self.rows)?;
        let kept = rest.len() / self.rows.record_len();
        self.rows.resize_for(kept).copy_from_slice(&rest);
        Ok(())
    }
}

/// Writes the waiting rows, since the library completes a file that is dropped.
impl<W: Write + Seek + Send + Sync + 'static> Drop for LasEncoder<W> {
    fn drop(&mut self) {
        if let Some(open) = &mut self.open {
            // Nothing can report a failure any more.
            let _ = open.write_rows(usize::MAX);
        }
    }
}

impl<W: Write + Seek + Send + Sync + 'static> LasWriter<W> {
    /// A writer of uncompressed LAS into `output` with the columns `fields`.
    pub(super) fn las(output: W, fields: Fields) -> Self {
        Self::new("las", output, fields)
    }

    /// A writer of LAZ into `output` with the columns `fields`.
    pub(super) fn laz(output: W, fields: Fields) -> Self {
        Self::new("laz", output, fields)
    }

    fn new(format: &'static str, output: W, fields: Fields) -> Self {
        let (output, fault) = ErrorHidingOutput::new(output);
        let encoder = LasEncoder {
            format,
            extras: extra_bytes::layout(fields),
            flags: 0,
            dual_return: false,
            fault,
            output: Some(output),
            open: None,
        };
        Self::of(encoder, fields)
    }

    /// Returns the output at its start; `None` if writing the header failed.
    #[cfg(test)]
    fn into_inner(mut self) -> Option<W> {
        let open = self.encoder.open.take();
        let open = open.map(|file| file.writer.into_inner());
        let output = self.encoder.output.take().or_else(|| open?.ok());
        output.map(ErrorHidingOutput::into_inner)
    }
}

impl<W: Write + Seek + Send + Sync + 'static> LasEncoder<W> {
    fn header(&self, metadata: &Metadata) -> las::Result<las::Header> {
        let axis = Transform {
            scale: SCALE_M,
            offset: 0.0,
        };
        let mut point_format = las::point::Format::new(6)?;
        point_format.extra_bytes = extra_bytes::length(&self.extras);
        point_format.is_compressed = self.format == "laz";
        let prefix = if metadata.simulated { "SIMULATED " } else { "" };
        // The builder has private fields, so it cannot be written as one literal.
        let mut builder = Builder::from((1, 4));
        builder.point_format = point_format;
        builder.transforms = Vector {
            x: axis,
            y: axis,
            z: axis,
        };
        builder.gps_time_type = GpsTimeType::Standard;
        builder.system_identifier = fitting(&format!("{prefix}{}", metadata.source));
        builder.generating_software = fitting(&metadata.software);
        builder.vlrs = vec![
            extra_bytes::record(&self.extras),
            text_record(metadata, prefix),
        ];
        builder.into_header()
    }
}

/// Return number and number of returns in dual mode: the last return (2) is followed by the nearer
/// one of its pulse (4). One whose partner has no distance is the only one.
fn return_numbers(batch: &Points, row: usize) -> u8 {
    let of = |row: usize| Some((*batch.echo().get(row)?, batch.time().get(row)?));
    let is_pair = |last: Option<usize>, nearer: usize| {
        let (last, nearer) = (last.and_then(of), of(nearer));
        last.zip(nearer)
            .is_some_and(|(last, nearer)| (last.0, nearer.0) == (2, 4) && last.1 == nearer.1)
    };
    if is_pair(Some(row), row + 1) {
        TWO_OF_TWO
    } else if is_pair(row.checked_sub(1), row) {
        ONE_OF_TWO
    } else {
        ONE_OF_ONE
    }
}

/// Encodes a batch as records of format 6 into `rows`.
fn encode(
    batch: &Points,
    (flags, dual_return): (u8, bool),
    extras: &[ExtraColumn],
    rows: &mut [u8],
    row_bytes: usize,
) {
    let returns = (0..batch.len()).map(|row| match dual_return {
        true => [return_numbers(batch, row)],
        false => [ONE_OF_ONE],
    });
    fill(rows, row_bytes, at::RETURNS, returns);
    fill(rows, row_bytes, at::FLAGS, std::iter::repeat([flags]));
    for (offset, axis) in at::XYZ
        .into_iter()
        .zip([batch.x_m(), batch.y_m(), batch.z_m()])
    {
        let steps = axis.iter().map(|v| (v * STEPS_PER_M).round() as i32);
        fill(rows, row_bytes, offset, steps.map(i32::to_le_bytes));
    }
    let intensity = batch.intensity().iter();
    let scaled = intensity.map(|v| (u16::from(*v) * INTENSITY_STEP).to_le_bytes());
    fill(rows, row_bytes, at::INTENSITY, scaled);
    let gps = batch.time().iter().map(|t| gps_time::adjusted_s(*t));
    fill(rows, row_bytes, at::GPS_TIME, gps.map(f64::to_le_bytes));
    for extra in extras {
        let offset = at::EXTRA + extra.offset;
        let values = (batch.values(extra.column), 0..batch.len());
        fill_values(rows, row_bytes, offset, values, extra.number, seconds);
    }
}

/// The first 32 characters, the limit of LAS. The text record has the whole text.
fn fitting(text: &str) -> String {
    let ascii = |c: char| {
        if c == ' ' || c.is_ascii_graphic() {
            c
        } else {
            '?'
        }
    };
    text.trim().chars().map(ascii).take(32).collect()
}

/// The metadata as a text area description (LAS 1.4 R15, section 5.2: `LASF_Spec` 3).
fn text_record(metadata: &Metadata, prefix: &str) -> Vlr {
    let mut text = metadata.lines().join("\n").into_bytes();
    text.push(0);
    Vlr {
        user_id: "LASF_Spec".to_owned(),
        record_id: 3,
        description: format!("{prefix}cloud"),
        data: text,
    }
}

impl<W: Write + Seek + Send + Sync + 'static> FormatEncoder for LasEncoder<W> {
    fn format(&self) -> &'static str {
        self.format
    }

    fn limit_m(&self) -> Option<f64> {
        Some(LIMIT_M)
    }

    fn extra_columns(&self) -> Fields {
        Fields::ECHO
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), EncodeError> {
        self.flags = if metadata.simulated { SYNTHETIC } else { 0 };
        self.dual_return = metadata.dual_return;
        let header = self.header(metadata).map_err(EncodeError::library)?;
        let rows = PointDataBuilder::new().for_header(&header).build();
        if let Some(output) = self.output.take() {
            let writer = self.fault.outcome(las::Writer::new(output, header))?;
            self.open = Some(OpenLasFile { writer, rows });
        }
        Ok(())
    }

    fn points(&mut self, batch: &Points) -> Result<(), EncodeError> {
        let Some(open) = &mut self.open else {
            return Err(EncodeError::library("the file is not open"));
        };
        let row_bytes = open.rows.record_len();
        let waiting = open.rows.len();
        let rows = open.rows.resize_for(waiting + batch.len());
        let new_rows = rows.get_mut(waiting * row_bytes..).unwrap_or_default();
        let points = (self.flags, self.dual_return);
        encode(batch, points, &self.extras, new_rows, row_bytes);
        let at_once = match self.format {
            "laz" => ROWS_OF_LAZ,
            _ => open.rows.len(),
        };
        while open.rows.len() >= at_once.max(1) {
            self.fault.outcome(open.write_rows(at_once))?;
        }
        Ok(())
    }

    fn finish(&mut self, _: &Summary) -> Result<(), EncodeError> {
        if let Some(mut open) = self.open.take() {
            let written = open.write_rows(usize::MAX).and_then(|()| {
                let mut output = open.writer.into_inner()?;
                output.flush()?;
                Ok(output)
            });
            self.output = Some(self.fault.outcome(written)?);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
