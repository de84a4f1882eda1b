//! The least that reads back the positions of each format, so that a writer's rounding is measured and not computed by the writer's
//! own rule. The formats' layouts are those of their specifications; LAZ is unpacked by the `laz` crate, E57 and the container of MCAP are read
//! by the crates that write them. Left out: all other columns.

use std::io::Cursor;

use ::cloud::formats::Format;
use analysis::tradeoff::StudyError;
use laz::{LasZipDecompressor, LazVlr};

/// x, y and z in metres.
pub(super) type Places = [Vec<f64>; 3];

/// A format's bytes, and where a reader stands in what it says of them.
struct File<'a> {
    format: &'static str,
    bytes: &'a [u8],
}

/// The positions of a file that should hold `points`.
pub(super) fn places(format: Format, bytes: &[u8], points: usize) -> Result<Places, StudyError> {
    let file = File {
        format: format.extension(),
        bytes,
    };
    let places = match format {
        Format::Ply => file.rows_of_f32(b"\nend_header\n", "a row of 29 bytes"),
        Format::Pcd => file.rows_of_f32(b"\nDATA binary\n", "a row of 29 bytes"),
        Format::Las => file.las(),
        Format::Laz => file.laz(points),
        Format::E57 => file.e57(),
        Format::Mcap => file.mcap(),
        Format::Csv => file.csv(),
    }?;
    let got = places[0].len();
    if got != points {
        return Err(file.wrong(bytes.len(), &format!("{points} points"), got.to_string()));
    }
    Ok(places)
}

/// x y z as f32, intensity f32, ring u8, time f64, tilt f32: a row of PLY or PCD.
const ROW_BYTES: usize = 29;

/// The public header of LAS 1.4 (R15, table 3): where it says what.
mod at {
    pub const HEADER_BYTES: usize = 94;
    pub const POINTS: usize = 96;
    pub const RECORDS: usize = 100;
    pub const RECORD_BYTES: usize = 105;
    pub const SCALES: usize = 131;
    pub const OFFSETS: usize = 155;
    pub const COUNT: usize = 247;
    /// Of a variable length record: the number of what follows its 54 bytes.
    pub const VLR_BYTES: usize = 20;
    pub const VLR_HEADER: usize = 54;
}

impl File<'_> {
    fn wrong(&self, offset: usize, expected: &str, got: String) -> StudyError {
        StudyError::ReadBack {
            format: self.format,
            offset,
            expected: expected.to_owned(),
            got,
        }
    }

    /// Rows behind a header that ends with `mark`, each beginning with x, y and z as f32.
    fn rows_of_f32(&self, mark: &[u8], expected: &str) -> Result<Places, StudyError> {
        let found = self.bytes.windows(mark.len()).position(|w| w == mark);
        let start = found.map(|at| at + mark.len());
        let rows = start.and_then(|start| self.bytes.get(start..));
        let rows = rows.ok_or_else(|| self.wrong(0, "the end of the header", "none".to_owned()))?;
        if rows.len() % ROW_BYTES != 0 {
            let left = rows.len() % ROW_BYTES;
            return Err(self.wrong(self.bytes.len(), expected, format!("{left} bytes")));
        }
        let mut places = Places::default();
        for row in rows.chunks_exact(ROW_BYTES) {
            for (axis, value) in places.iter_mut().zip(row.as_chunks::<4>().0) {
                axis.push(f64::from(f32::from_le_bytes(*value)));
            }
        }
        Ok(places)
    }

    fn number<const N: usize>(&self, offset: usize) -> Result<[u8; N], StudyError> {
        let value = self.bytes.get(offset..).and_then(|b| b.first_chunk());
        let short = || format!("{} in all", self.bytes.len());
        let value = value.ok_or_else(|| self.wrong(offset, &format!("{N} bytes"), short()));
        value.copied()
    }

    fn u16(&self, offset: usize) -> Result<usize, StudyError> {
        Ok(usize::from(u16::from_le_bytes(self.number(offset)?)))
    }

    fn u32(&self, offset: usize) -> Result<usize, StudyError> {
        Ok(u32::from_le_bytes(self.number(offset)?) as usize)
    }

    /// The whole records of a LAS file.
    fn las(&self) -> Result<Places, StudyError> {
        let start = self.u32(at::POINTS)?;
        let records = self.bytes.get(start..).unwrap_or_default();
        let count = u64::from_le_bytes(self.number(at::COUNT)?) as usize;
        let bytes = count.saturating_mul(self.u16(at::RECORD_BYTES)?);
        let records = records.get(..bytes).ok_or_else(|| {
            self.wrong(
                start,
                &format!("{bytes} bytes of records"),
                records.len().to_string(),
            )
        })?;
        self.las_records(records)
    }

    /// The same unpacked.
    fn laz(&self, points: usize) -> Result<Places, StudyError> {
        let start = self.u32(at::POINTS)?;
        let packed = self.laszip_record()?;
        let failed =
            |error: laz::LasZipError| self.wrong(start, "packed records", error.to_string());
        let vlr = LazVlr::from_buffer(packed).map_err(failed)?;
        let mut source = Cursor::new(self.bytes);
        source.set_position(start as u64);
        let mut records = vec![0; points.saturating_mul(self.u16(at::RECORD_BYTES)?)];
        let mut unpack = LasZipDecompressor::new(source, vlr).map_err(failed)?;
        let unpacked = unpack.decompress_many(&mut records);
        unpacked.map_err(|error| self.wrong(start, "packed records", error.to_string()))?;
        self.las_records(&records)
    }

    /// What the variable length record of LASzip holds.
    fn laszip_record(&self) -> Result<&[u8], StudyError> {
        let mut offset = self.u16(at::HEADER_BYTES)?;
        for _ in 0..self.u32(at::RECORDS)? {
            let length = self.u16(offset.saturating_add(at::VLR_BYTES))?;
            let user: [u8; 16] = self.number(offset.saturating_add(2))?;
            let start = offset.saturating_add(at::VLR_HEADER);
            let end = start.saturating_add(length);
            if user.starts_with(b"laszip encoded") {
                let short = || self.wrong(start, "LASzip's record", "the end".to_owned());
                return self.bytes.get(start..end).ok_or_else(short);
            }
            offset = end;
        }
        Err(self.wrong(offset, "LASzip's record", "none".to_owned()))
    }

    fn las_records(&self, records: &[u8]) -> Result<Places, StudyError> {
        let record_bytes = self.u16(at::RECORD_BYTES)?.max(1);
        let mut places = Places::default();
        for (i, axis) in places.iter_mut().enumerate() {
            let scale = f64::from_le_bytes(self.number(at::SCALES + 8 * i)?);
            let offset = f64::from_le_bytes(self.number(at::OFFSETS + 8 * i)?);
            let steps = records
                .chunks_exact(record_bytes)
                .filter_map(|record| record.get(4 * i..)?.first_chunk());
            axis.extend(steps.map(|s| f64::from(i32::from_le_bytes(*s)) * scale + offset));
        }
        Ok(places)
    }

    fn e57(&self) -> Result<Places, StudyError> {
        let wrong = |error: e57::Error| self.wrong(0, "an E57 file", error.to_string());
        let mut reader = e57::E57Reader::new(Cursor::new(self.bytes)).map_err(wrong)?;
        let mut places = Places::default();
        for cloud in reader.pointclouds() {
            for point in reader.pointcloud_raw(&cloud).map_err(wrong)? {
                let point = point.map_err(wrong)?;
                for ((axis, value), record) in places.iter_mut().zip(&point).zip(&cloud.prototype) {
                    axis.push(value.to_f64(&record.data_type).map_err(wrong)?);
                }
            }
        }
        Ok(places)
    }

    /// The clouds of a recording, one after the other.
    fn mcap(&self) -> Result<Places, StudyError> {
        let wrong = |error: mcap::McapError| self.wrong(0, "an MCAP file", error.to_string());
        let mut places = Places::default();
        for message in mcap::MessageStream::new(self.bytes).map_err(wrong)? {
            let message = message.map_err(wrong)?;
            if message.channel.topic == "/velomotion/points" {
                let cloud = File {
                    format: self.format,
                    bytes: &message.data,
                };
                cloud.message(&mut places)?;
            }
        }
        Ok(places)
    }

    /// The rows of a PointCloud2 in CDR; x, y and z are its first fields.
    fn message(&self, places: &mut Places) -> Result<(), StudyError> {
        const ENCAPSULATION: usize = 4;
        let aligned = |at: usize| (at - ENCAPSULATION).next_multiple_of(4) + ENCAPSULATION;
        // The header's stamp, then its frame.
        let mut at = ENCAPSULATION + 8;
        at = aligned(at.saturating_add(4).saturating_add(self.u32(at)?));
        // Height and width, then how many fields there are.
        let fields = self.u32(at.saturating_add(8))?;
        at = at.saturating_add(12);
        for _ in 0..fields {
            // A name, its offset, its type, how many.
            at = aligned(at.saturating_add(4).saturating_add(self.u32(at)?));
            at = aligned(at.saturating_add(5)).saturating_add(4);
        }
        // Whether it is big-endian, then bytes of a point, of a row and of all.
        at = aligned(at.saturating_add(1));
        let (point_bytes, length) = (self.u32(at)?, self.u32(at.saturating_add(8))?);
        let start = at.saturating_add(12);
        let rows = self.bytes.get(start..start.saturating_add(length));
        let short = || {
            self.wrong(
                start,
                &format!("{length} bytes of points"),
                "the end".to_owned(),
            )
        };
        for row in rows.ok_or_else(short)?.chunks_exact(point_bytes.max(1)) {
            for (axis, value) in places.iter_mut().zip(row.as_chunks::<4>().0) {
                axis.push(f64::from(f32::from_le_bytes(*value)));
            }
        }
        Ok(())
    }

    fn csv(&self) -> Result<Places, StudyError> {
        let text = std::str::from_utf8(self.bytes)
            .map_err(|error| self.wrong(error.valid_up_to(), "text", "other bytes".to_owned()))?;
        let mut places = Places::default();
        let mut offset = 0;
        let mut lines = text.split_inclusive('\n').map(|line| {
            let start = offset;
            offset += line.len();
            (start, line.trim_end())
        });
        let is_comment = |line: &str| line.starts_with('#');
        let header = lines.find(|(_, line)| !is_comment(line)).unwrap_or((0, ""));
        if !header.1.starts_with("x_m,y_m,z_m") {
            return Err(self.wrong(header.0, "x_m,y_m,z_m", header.1.chars().take(20).collect()));
        }
        for (start, line) in lines {
            let mut fields = line.split(',');
            for axis in &mut places {
                let field = fields.next().unwrap_or("");
                let number = field.parse();
                axis.push(number.map_err(|_| self.wrong(start, "a number", format!("{field:?}")))?);
            }
        }
        Ok(places)
    }
}
