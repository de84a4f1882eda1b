//! CSV: a header row with units, one row per point, without rounding. XYZ is the same rows with
//! spaces and nothing else, since readers fail on comments: the rest is in its companion.
//!
//! `x_m,y_m,z_m,intensity,ring,time_s,tilt_deg`; metadata as lines that start with `#` before the
//! header row. Coordinates and angles are the shortest decimals that read back to the same f64;
//! times have nine decimals. No field needs quoting.

use std::io::{self, Write};

use super::Format;
use super::file_sink::{EncodeError, FileSink, FormatEncoder};
use crate::{Column, Companion, Fields, Metadata, Point, Points, Summary};

/// Writes CSV. Each batch is one write: the output needs no buffer.
pub(super) type CsvWriter<W> = FileSink<CsvEncoder<W>>;

/// Encoder of [`CsvWriter`].
#[derive(Debug)]
pub(super) struct CsvEncoder<W> {
    output: W,
    format: Format,
    fields: Fields,
    /// Metadata for the companion of XYZ.
    lines: Vec<String>,
    /// Text of a batch, kept for its memory.
    text: Vec<u8>,
}

impl<W: Write> CsvWriter<W> {
    /// A writer of CSV or XYZ into `output` with the columns `fields`.
    pub(super) fn new(output: W, format: Format, fields: Fields) -> Self {
        let encoder = CsvEncoder {
            output,
            format,
            fields,
            lines: Vec::new(),
            text: Vec::new(),
        };
        Self::of(encoder, fields)
    }
}

fn encode_field(text: &mut Vec<u8>, column: Column, point: &Point) -> io::Result<()> {
    match column {
        Column::Intensity => write!(text, "{}", point.intensity),
        Column::Ring => write!(text, "{}", point.ring),
        Column::Laser => write!(text, "{}", point.laser),
        Column::Tilt => write!(text, "{}", point.tilt.0),
        Column::Sd => write!(text, "{}", point.sd_m),
        Column::Echo => write!(text, "{}", point.echo),
        Column::Time => encode_seconds(text, point.time.as_nanos()),
        Column::DeviceTime => encode_seconds(text, point.device_time.as_nanos()),
    }
}

/// Seconds with all nine decimals.
fn encode_seconds(text: &mut Vec<u8>, ns: i64) -> io::Result<()> {
    let sign = if ns < 0 { "-" } else { "" };
    let magnitude = ns.unsigned_abs();
    let (whole, rest) = (magnitude / 1_000_000_000, magnitude % 1_000_000_000);
    write!(text, "{sign}{whole}.{rest:09}")
}

const fn heading(column: Column) -> &'static str {
    match column {
        Column::Time => "time_s",
        Column::DeviceTime => "device_time_s",
        Column::Tilt => "tilt_deg",
        Column::Sd => "sd_m",
        plain => plain.name(),
    }
}

impl<W> CsvEncoder<W> {
    /// Names of the columns, with units.
    fn names(&self) -> Vec<&'static str> {
        let more = self.fields.columns().map(heading);
        ["x_m", "y_m", "z_m"].into_iter().chain(more).collect()
    }
}

impl<W: Write> FormatEncoder for CsvEncoder<W> {
    fn format(&self) -> &'static str {
        self.format.extension()
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), EncodeError> {
        if self.format == Format::Xyz {
            self.lines = metadata.lines();
            return Ok(());
        }
        for line in metadata.lines() {
            writeln!(self.text, "# {line}")?;
        }
        let names = self.names().join(",");
        writeln!(self.text, "{names}")?;
        Ok(self.output.write_all(&self.text)?)
    }

    fn points(&mut self, batch: &Points) -> Result<(), EncodeError> {
        self.text.clear();
        let between = if self.format == Format::Xyz { ' ' } else { ',' };
        for point in batch.iter() {
            let [x, y, z] = point.position_m;
            write!(self.text, "{x}{between}{y}{between}{z}")?;
            for column in self.fields.columns() {
                write!(self.text, "{between}")?;
                encode_field(&mut self.text, column, &point)?;
            }
            self.text.push(b'\n');
        }
        Ok(self.output.write_all(&self.text)?)
    }

    fn finish(&mut self, _: &Summary) -> Result<(), EncodeError> {
        Ok(self.output.flush()?)
    }

    fn companion(&self, file_name: &str) -> Option<Companion> {
        (self.format == Format::Xyz)
            .then(|| Companion::metadata(file_name, &self.names().join(" "), &self.lines))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::samples::{SmallDisk, cloud, metadata};
    use crate::{Sink, SinkError};

    fn written(fields: Fields, points: &Points) -> String {
        let mut writer = CsvWriter::new(vec![], Format::Csv, fields);
        writer.begin(&metadata()).unwrap();
        writer.points(points).unwrap();
        assert_eq!(writer.finish().unwrap(), points.summary());
        String::from_utf8(writer.encoder.output).unwrap()
    }

    #[test]
    fn the_first_line_is_simulated_and_the_header_has_units() {
        let text = written(Fields::FILE, &cloud(2));
        assert!(text.starts_with("# SIMULATED"));
        let header = text.lines().find(|line| !line.starts_with('#'));
        assert_eq!(header, Some("x_m,y_m,z_m,intensity,ring,time_s,tilt_deg"));
    }

    #[test]
    fn xyz_has_the_same_rows_with_spaces_and_the_rest_beside_it() {
        let mut writer = CsvWriter::new(vec![], Format::Xyz, Fields::INTENSITY);
        writer.begin(&metadata()).unwrap();
        writer.points(&cloud(3)).unwrap();
        writer.finish().unwrap();
        let beside = writer.companion("scan.xyz").unwrap();
        assert_eq!(beside.name, "scan.xyz.txt");
        assert!(beside.text.contains("\nSIMULATED"), "{}", beside.text);
        assert!(
            beside.text.contains("x_m y_m z_m intensity\n"),
            "{}",
            beside.text
        );
        let xyz = String::from_utf8(writer.encoder.output).unwrap();
        let csv = written(Fields::INTENSITY, &cloud(3));
        let rows: Vec<String> = csv.lines().map(|line| line.replace(',', " ")).collect();
        assert_eq!(xyz.lines().collect::<Vec<_>>(), rows[rows.len() - 3..]);
    }

    #[test]
    fn values_are_exact() {
        let given = cloud(200);
        let text = written(Fields::ALL, &given);
        let rows: Vec<Vec<&str>> = text
            .lines()
            .filter(|line| !line.starts_with('#'))
            .skip(1)
            .map(|line| line.split(',').collect())
            .collect();
        assert_eq!(rows.len(), given.len());
        let ns = |text: &str| text.replace('.', "").parse::<i64>().unwrap();
        for (row, point) in rows.iter().zip(given.iter()) {
            let number = |i: usize| row[i].parse::<f64>().unwrap();
            assert_eq!([number(0), number(1), number(2)], point.position_m);
            assert_eq!(row[3], point.intensity.to_string());
            assert_eq!(row[4], point.ring.to_string());
            assert_eq!(ns(row[5]), point.time.as_nanos());
            assert_eq!(number(6), point.tilt.0);
            assert_eq!(row[7], point.laser.to_string());
            assert_eq!(ns(row[8]), point.device_time.as_nanos());
            assert_eq!(number(9), point.sd_m);
            assert_eq!(row[10], point.echo.to_string());
        }
    }

    #[test]
    fn times_keep_their_sign_and_zeros() {
        for (ns, expected) in [
            (0, "0.000000000"),
            (-1, "-0.000000001"),
            (1_000_000_010, "1.000000010"),
            (i64::MIN, "-9223372036.854775808"),
        ] {
            let mut text = vec![];
            encode_seconds(&mut text, ns).unwrap();
            assert_eq!(String::from_utf8(text).unwrap(), expected);
        }
    }

    #[test]
    fn a_full_disk_is_an_error_with_the_number_of_points() {
        let mut writer = CsvWriter::new(SmallDisk::new(20_000), Format::Csv, Fields::FILE);
        writer.begin(&metadata()).unwrap();
        writer.points(&cloud(10)).unwrap();
        let error = writer.points(&cloud(1000)).unwrap_err();
        assert!(
            matches!(error, SinkError::Write { points: 10, .. }),
            "{error}"
        );
        assert!(matches!(
            writer.points(&cloud(1)),
            Err(SinkError::Order { .. })
        ));
        assert_eq!(writer.finish().unwrap().points, 10);
    }
}
