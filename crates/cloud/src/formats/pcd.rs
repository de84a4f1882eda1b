//! PCD 0.7, binary: the format of the Point Cloud Library, with a grid for organised clouds.
//!
//! An unorganised cloud is one row of all points. An organised one has a row per ring and a column
//! per firing; cells without a return have NaN positions.

use std::io::{self, Seek, SeekFrom, Write};

use super::file_sink::{EncodeError, FileSink, FormatEncoder};
use super::layout::RowLayout;
use crate::rows::NumberType;
use crate::{Fields, Metadata, Points, Summary};

/// Digits of u64::MAX: the counts are written again at the end, with the same length.
const DIGITS: usize = 20;

/// Writes PCD.
pub type PcdWriter<W> = FileSink<PcdEncoder<W>>;

/// Encoder of [`PcdWriter`].
#[derive(Debug)]
pub struct PcdEncoder<W> {
    output: W,
    layout: RowLayout,
    counts_at: u64,
    rows: u64,
}

impl<W: Write + Seek> PcdWriter<W> {
    /// A writer into `output` from its current position, with the columns `fields`.
    pub fn new(output: W, fields: Fields) -> Self {
        Self::organised(output, 1, fields)
    }

    /// A writer of an organised cloud of `rows` rows (at least one), whose points come row by row.
    pub fn organised(output: W, rows: u64, fields: Fields) -> Self {
        let encoder = PcdEncoder {
            output,
            layout: RowLayout::new(fields),
            counts_at: 0,
            rows: rows.max(1),
        };
        Self::of(encoder, fields)
    }
}

const fn letter(kind: NumberType) -> &'static str {
    match kind {
        NumberType::F32 | NumberType::F64 => "F",
        NumberType::U8 | NumberType::U16 => "U",
    }
}

impl<W> PcdEncoder<W> {
    /// The lines with the counts, of constant length.
    fn counts(&self, points: u64) -> String {
        let rows = self.rows;
        format!(
            "WIDTH {:<DIGITS$}\nHEIGHT {rows:<DIGITS$}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points:<DIGITS$}\n",
            points / rows
        )
    }
}

impl<W: Write + Seek> FormatEncoder for PcdEncoder<W> {
    fn format(&self) -> &'static str {
        "pcd"
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), EncodeError> {
        let mut head = String::from("# .PCD v0.7 - Point Cloud Data file format\n");
        for line in metadata.lines() {
            head += &format!("# {line}\n");
        }
        let properties: Vec<_> = self.layout.properties().collect();
        let list = |what: &dyn Fn(&(&'static str, NumberType)) -> String| {
            let values: Vec<String> = properties.iter().map(what).collect();
            values.join(" ")
        };
        head += "VERSION 0.7\n";
        head += &format!("FIELDS {}\n", list(&|(name, _)| (*name).to_owned()));
        head += &format!("SIZE {}\n", list(&|(_, kind)| kind.bytes().to_string()));
        head += &format!("TYPE {}\n", list(&|(_, kind)| letter(*kind).to_owned()));
        head += &format!("COUNT {}\n", list(&|_| "1".to_owned()));
        self.counts_at = self.output.stream_position()? + head.len() as u64;
        head += &self.counts(0);
        head += "DATA binary\n";
        Ok(self.output.write_all(head.as_bytes())?)
    }

    fn points(&mut self, batch: &Points) -> Result<(), EncodeError> {
        Ok(self.output.write_all(self.layout.encode(batch))?)
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), EncodeError> {
        if !summary.points.is_multiple_of(self.rows) {
            return Err(EncodeError::Output(io::Error::other(format!(
                "an organised cloud of {} rows: expected as many points in each, got {} in all",
                self.rows, summary.points
            ))));
        }
        self.output.seek(SeekFrom::Start(self.counts_at))?;
        let counts = self.counts(summary.points);
        self.output.write_all(counts.as_bytes())?;
        self.output.seek(SeekFrom::End(0))?;
        Ok(self.output.flush()?)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::Sink;
    use crate::tests::samples::{cloud, metadata};

    fn written(rows: u64, points: &Points) -> Vec<u8> {
        let mut pcd = PcdWriter::organised(Cursor::new(Vec::new()), rows, Fields::FILE);
        pcd.begin(&metadata()).unwrap();
        pcd.points(points).unwrap();
        pcd.finish().unwrap();
        pcd.encoder.output.into_inner()
    }

    /// The header's lines as (name, rest), and the data.
    fn parsed(bytes: &[u8]) -> (Vec<(String, String)>, &[u8]) {
        let end = b"DATA binary\n";
        let at = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        let head = std::str::from_utf8(&bytes[..at]).unwrap();
        let lines = head.lines().filter(|line| !line.starts_with('#'));
        let lines = lines.map(|line| {
            let (name, rest) = line.split_once(' ').unwrap();
            (name.to_owned(), rest.trim().to_owned())
        });
        (lines.collect(), &bytes[at..])
    }

    #[test]
    fn the_header_describes_the_rows() {
        let cloud = cloud(12);
        let bytes = written(1, &cloud);
        let (head, data) = parsed(&bytes);
        let expected = [
            ("VERSION", "0.7"),
            ("FIELDS", "x y z intensity ring time tilt"),
            ("SIZE", "4 4 4 4 1 8 4"),
            ("TYPE", "F F F F U F F"),
            ("COUNT", "1 1 1 1 1 1 1"),
            ("WIDTH", "12"),
            ("HEIGHT", "1"),
            ("VIEWPOINT", "0 0 0 1 0 0 0"),
            ("POINTS", "12"),
            ("DATA", "binary"),
        ];
        let head: Vec<_> = head.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
        assert_eq!(head, expected);
        assert_eq!(data.len(), 12 * 29);
        for (i, row) in data.chunks(29).enumerate() {
            let float = |at: usize| f32::from_le_bytes(row[at..at + 4].try_into().unwrap());
            assert_eq!(float(0), cloud.x_m()[i] as f32);
            assert_eq!(float(8), cloud.z_m()[i] as f32);
            assert_eq!(float(12), f32::from(cloud.intensity()[i]));
            assert_eq!(row[16], cloud.ring()[i]);
            let time = f64::from_le_bytes(row[17..25].try_into().unwrap());
            assert!((time - cloud.time()[i].as_nanos() as f64 * 1e-9).abs() < 1e-6);
        }
    }

    #[test]
    fn an_organised_cloud_has_rows() {
        let (head, _) = parsed(&written(4, &cloud(12)));
        assert!(head.contains(&("WIDTH".to_owned(), "3".to_owned())));
        assert!(head.contains(&("HEIGHT".to_owned(), "4".to_owned())));
        let mut pcd = PcdWriter::organised(Cursor::new(Vec::new()), 5, Fields::FILE);
        pcd.begin(&metadata()).unwrap();
        pcd.points(&cloud(12)).unwrap();
        let error = pcd.finish().unwrap_err().to_string();
        assert!(error.contains("5 rows"), "{error}");
    }
}
