//! Clouds as the page reads them: binary PLY, made of logs and of clouds in other formats.

use std::fs::File;
use std::io::{BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use cloud::formats::Format;
use cloud::formats::ply::PlyWriter;
use cloud::read::StoredCloud;
use cloud::{Column, Fields, Points, Sink, SinkError, TiltTrack};
use engine::capture::completeness;
use engine::failure::{Failure, Kind};
use engine::reconstruct::decoder_options::{DecoderRequest, decoder_options};
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::source::Source;
use io::files::ReopenableFile;
use protocol::record::Wire;
use scanner::{Accuracy, TiltSource};
use units::{Host, Stamp};

use crate::commands::analyze::input::{CloudMarks, companion, help_on};

/// Longest header of a PLY that is served as it is.
const HEADER_BYTES: u64 = 64 << 10;
/// Steps in which the progress of a cloud is shown.
const SHARE_STEP: f64 = 0.01;

/// A cloud as binary PLY.
pub struct MadeCloud {
    pub file: ReopenableFile,
    pub points: u64,
    pub simulated: bool,
    pub scanner: bool,
    /// Failure that reports its missing data.
    pub missing: Option<Failure>,
    /// What the replay of a log reports.
    pub report: Option<serde_json::Value>,
}

fn no_scratch(error: std::io::Error) -> Failure {
    let what = format!("no room for the cloud: {error}");
    Failure::new(Kind::Incomplete, what)
        .help("free some space there, or name another folder with TMPDIR")
}

fn scratch() -> Result<ReopenableFile, Failure> {
    ReopenableFile::scratch().map_err(no_scratch)
}

/// The cloud of a log or recording, without tilt if that has no drive.
pub fn log(
    source: &Source,
    share: &dyn Fn(f64),
    interrupt: &AtomicBool,
) -> Result<MadeCloud, Failure> {
    let mut tilted = false;
    source.read_until(|record| {
        tilted = matches!(record.wire, Wire::Drive { .. });
        !tilted
    })?;
    let request = Reconstruction {
        tilt: match tilted {
            true => TiltSource::Log,
            false => TiltSource::None,
        },
        options: decoder_options(&DecoderRequest::default(), source)?,
        ..Reconstruction::of_log(source, Accuracy::Best, interrupt)?
    };
    let file = scratch()?;
    let fields = Fields::FILE | Fields::LASER | Fields::SD | Fields::ECHO;
    let writer = PlyWriter::new(file.file().try_clone().map_err(no_scratch)?, fields);
    let mut sinks = (writer, ShareSink::new(share));
    let output = PathBuf::from("the cloud");
    let scan = replay::scan(&request, &mut sinks, &output)?;
    sinks
        .finish()
        .map_err(|error| engine::output::sink_failure(&output, &error))?;
    Ok(MadeCloud {
        file,
        points: scan.points,
        simulated: scan.contents.simulated,
        scanner: tilted,
        missing: completeness::missing(&scan),
        report: serde_json::to_value(&scan).ok(),
    })
}

/// Reports which part of the sweeps has been placed.
struct ShareSink<'a> {
    report: &'a dyn Fn(f64),
    span: Option<(Stamp<Host>, Stamp<Host>)>,
    reported: f64,
}

impl<'a> ShareSink<'a> {
    const fn new(report: &'a dyn Fn(f64)) -> Self {
        Self {
            report,
            span: None,
            reported: 0.0,
        }
    }
}

impl Sink for ShareSink<'_> {
    fn fields(&self) -> Fields {
        Fields::TIME
    }

    fn wants_tilt(&self) -> bool {
        true
    }

    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        let begin = track.sweeps.iter().map(|(start, _)| *start).min();
        self.span = begin.zip(track.sweeps.iter().map(|(_, end)| *end).max());
        Ok(())
    }

    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        if let (Some((start, end)), Some(time)) = (self.span, batch.time().last()) {
            let passed = time.saturating_since(start).as_nanos() as f64;
            let whole = (end.saturating_since(start).as_nanos() as f64).max(1.0);
            let share = (passed / whole).min(1.0);
            if share >= self.reported + SHARE_STEP {
                self.reported = share;
                (self.report)(self.reported);
            }
        }
        Ok(())
    }
}

fn unreadable(path: &Path, error: &std::io::Error) -> Failure {
    let what = format!("{}: cannot read: {error}", path.display());
    Failure::new(Kind::BadInput, what).help("check the name and the read permission")
}

/// A stored cloud: its file where the page can read it, else a PLY of its points.
pub fn cloud(path: &Path, format: Format) -> Result<MadeCloud, Failure> {
    let wrong = |error: std::io::Error| unreadable(path, &error);
    // A FIFO without a writer would block.
    if !path.metadata().map_err(wrong)?.is_file() {
        return Err(wrong(std::io::Error::other("not a regular file")));
    }
    let file = ReopenableFile::open(path).map_err(wrong)?;
    let length = file.file().metadata().map_err(wrong)?.len();
    if format == Format::Ply {
        let mut head = Vec::new();
        let read = Read::take(file.file(), HEADER_BYTES).read_to_end(&mut head);
        read.map_err(wrong)?;
        if let Some(points) = own_ply(&head, length) {
            let CloudMarks { simulated, scanner } = CloudMarks::of(path, format, &head);
            return Ok(MadeCloud {
                points,
                simulated,
                scanner,
                file,
                missing: None,
                report: None,
            });
        }
    }
    let mut bytes = header_beside(path, format);
    let header_bytes = bytes.len();
    let mut whole = file.reopen().map_err(wrong)?;
    whole.read_to_end(&mut bytes).map_err(wrong)?;
    let CloudMarks { simulated, scanner } = CloudMarks::of(path, format, &bytes);
    // The page has no use for the lidar's own times.
    let wanted = Fields::ALL - Fields::DEVICE_TIME;
    let read = cloud::read::cloud(format, bytes, wanted).map_err(|mut error| {
        error.offset = error.offset.saturating_sub(header_bytes);
        let what = format!("{}: {error}", path.display());
        Failure::new(Kind::BadInput, what).help(help_on(format))
    })?;
    if read.positions.is_empty() {
        let what = format!("{}: the file has no points", path.display());
        return Err(Failure::new(Kind::BadInput, what).help(help_on(format)));
    }
    let file = scratch()?;
    write_ply(file.file(), &read).map_err(no_scratch)?;
    Ok(MadeCloud {
        file,
        points: read.positions.len() as u64,
        simulated,
        scanner,
        missing: None,
        report: None,
    })
}

/// Comments of velomotion's own clouds, of which georeferenced ones have the second.
const FRAMES: [&str; 2] = [
    "frame: x right, y forward, z up in metres from ",
    "frame: x east, y north, z up in metres, origin at ",
];

/// Number of points of a PLY of velomotion, which the page reads as it is: binary, little-endian,
/// finite coordinates and nothing but points. A file of other programs, or one that is not whole,
/// is none.
fn own_ply(head: &[u8], length: u64) -> Option<u64> {
    const END: &[u8] = b"end_header\n";
    let end = head.windows(END.len()).position(|window| window == END)?;
    let text = std::str::from_utf8(head.get(..end)?).ok()?;
    let (mut points, mut row_bytes) = (None, 0);
    for line in text.lines() {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words.as_slice() {
            ["format", kind, ..] if *kind != "binary_little_endian" => return None,
            ["element", "vertex", count] => points = Some(count.parse::<u64>().ok()?),
            ["element", ..] => return None,
            ["property", "uchar", _] => row_bytes += 1,
            ["property", "ushort", _] => row_bytes += 2,
            ["property", "float" | "uint", _] => row_bytes += 4,
            ["property", "double", _] => row_bytes += 8,
            ["property", ..] => return None,
            _ => {}
        }
    }
    let header_bytes = (end + END.len()) as u64;
    let is_whole = |points: &u64| points.checked_mul(row_bytes) == length.checked_sub(header_bytes);
    let is_own = FRAMES.iter().any(|frame| text.contains(frame));
    points.filter(is_whole).filter(|_| is_own)
}

/// The names of an XYZ file's columns, which its companion has, as the header row of a text.
fn header_beside(path: &Path, format: Format) -> Vec<u8> {
    let text = match format {
        Format::Xyz => companion(path, format),
        _ => Vec::new(),
    };
    let text = String::from_utf8_lossy(&text);
    let mut names = text
        .lines()
        .filter_map(|line| line.strip_prefix("columns: "));
    let header = names.find(|names| names.starts_with("x_m y_m z_m"));
    header.map_or_else(Vec::new, |names| format!("{names}\n").into_bytes())
}

/// A cloud as a PLY whose positions are doubles: coordinates of a map need them.
fn write_ply(file: &File, cloud: &StoredCloud) -> std::io::Result<()> {
    let is_byte = |column| matches!(column, Column::Ring | Column::Laser | Column::Echo);
    let mut out = BufWriter::new(file);
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n",
        cloud.positions.len()
    )?;
    for (column, _) in &cloud.columns {
        let kind = if is_byte(*column) { "uchar" } else { "float" };
        writeln!(out, "property {kind} {}", column.name())?;
    }
    writeln!(out, "end_header")?;
    for (row, position) in cloud.positions.iter().enumerate() {
        for axis in position {
            out.write_all(&axis.to_le_bytes())?;
        }
        for (column, values) in &cloud.columns {
            let value = values.get(row).copied().unwrap_or_default();
            match is_byte(*column) {
                true => out.write_all(&[value as u8])?,
                false => out.write_all(&value.to_le_bytes())?,
            }
        }
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "ply\nformat binary_little_endian 1.0\ncomment SIMULATED: software\ncomment frame: x right, y forward, z up in metres from the tilt axis; tilt in degrees\nelement vertex 7\nproperty float x\nproperty uchar ring\n";

    #[test]
    fn only_a_whole_ply_of_velomotion_is_served_as_it_is() {
        let own = |head: &str, more: u64| own_ply(head.as_bytes(), head.len() as u64 + more);
        let whole = format!("{HEAD}end_header\n");
        assert_eq!(own(&whole, 35), Some(7));
        let georeferenced = "x east, y north, z up in metres, origin at";
        let georeferenced = whole.replace("x right, y forward, z up in metres from", georeferenced);
        assert_eq!(own(&georeferenced, 35), Some(7));
        // Cut off, or with bytes that are no points.
        assert_eq!([34, 36].map(|more| own(&whole, more)), [None, None]);
        for head in [
            HEAD.to_owned(),
            format!("{HEAD}property list uchar int neighbours\nend_header\n"),
            format!("{HEAD}element face 2\nproperty list uchar int vertices\nend_header\n"),
            whole.replace("little", "big"),
            whole.replace("frame: ", ""),
            whole.replace("vertex 7", "vertex many"),
        ] {
            assert_eq!(own(&head, 35), None, "{head}");
        }
    }

    /// As a program writes it that keeps pixels without a point: such rows are no points.
    #[test]
    fn rows_without_a_number_are_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("organised.ply");
        let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n".to_vec();
        for value in [f32::NAN, f32::NAN, f32::NAN, 1.0, 2.0, 3.0] {
            bytes.extend(value.to_le_bytes());
        }
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(cloud(&path, Format::Ply).unwrap().points, 1);
        bytes.pop();
        std::fs::write(&path, &bytes).unwrap();
        let failure = cloud(&path, Format::Ply).err().unwrap();
        assert_eq!(failure.kind, Kind::BadInput, "{failure}");
    }

    /// The served header and the cloud that the page reads.
    fn served(path: &Path, format: Format) -> (String, StoredCloud) {
        let made = cloud(path, format).unwrap();
        let mut bytes = Vec::new();
        let mut file = made.file.reopen().unwrap();
        file.read_to_end(&mut bytes).unwrap();
        let end = b"end_header\n";
        let end = bytes.windows(end.len()).position(|window| window == end);
        let head = String::from_utf8_lossy(&bytes[..end.unwrap()]).into_owned();
        let read = cloud::read::cloud(Format::Ply, bytes, Fields::ALL).unwrap();
        assert_eq!(made.points, read.positions.len() as u64);
        (head, read)
    }

    #[test]
    fn other_formats_become_a_ply_that_keeps_coordinates_of_a_map() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.csv");
        let text = "x,y,z,intensity,ring,time\n500000.125,4600000.5,-2,40000,3,1700000000.25\n1,2,3,0.5,300,1700000001\n";
        std::fs::write(&path, text).unwrap();
        let made = cloud(&path, Format::Csv).unwrap();
        assert_eq!((made.simulated, made.scanner), (false, false));
        let (head, read) = served(&path, Format::Csv);
        let properties = "property double z\nproperty float intensity\nproperty uchar ring\nproperty float time\n";
        assert!(head.ends_with(properties), "{head}");
        assert_eq!(
            read.positions,
            [[500_000.125, 4_600_000.5, -2.0], [1.0, 2.0, 3.0]]
        );
        let columns = [
            (Column::Intensity, vec![40_000.0, 0.5]),
            (Column::Ring, vec![3.0, 255.0]),
            (Column::Time, vec![0.0, 0.75]),
        ];
        assert_eq!(read.columns, columns);
    }

    /// A cloud of every format that velomotion writes, beside its companion.
    #[test]
    fn the_page_gets_the_columns_of_every_format() {
        let folder = tempfile::tempdir().unwrap();
        let mut points = Points::new(Fields::ALL);
        for row in 0..3_u8 {
            points.push(cloud::Point {
                position_m: [1.0, 2.0, f64::from(row)],
                intensity: 10 + row,
                ring: 1 + row,
                time: Stamp::from_nanos(1_700_000_000_000_000_000 + 500_000_000 * i64::from(row)),
                tilt: units::Degrees(-1.5),
                laser: 15 - row,
                sd_m: 0.25,
                echo: 1 + row,
                ..cloud::Point::default()
            });
        }
        let shown = [
            (Column::Intensity, vec![10.0, 11.0, 12.0]),
            (Column::Ring, vec![1.0, 2.0, 3.0]),
            (Column::Time, vec![0.0, 0.5, 1.0]),
            (Column::Tilt, vec![-1.5; 3]),
            (Column::Laser, vec![15.0, 14.0, 13.0]),
            (Column::Sd, vec![0.25; 3]),
            (Column::Echo, vec![1.0, 2.0, 3.0]),
        ];
        let metadata = cloud::Metadata {
            software: "velomotion 1.0".to_owned(),
            ..cloud::Metadata::default()
        };
        for format in Format::ALL {
            let name = format!("scan.{format}");
            let path = folder.path().join(&name);
            let mut options = File::options();
            let file = options
                .read(true)
                .write(true)
                .create_new(true)
                .open(&path)
                .unwrap();
            let mut writer = format.writer(file, Fields::ALL);
            writer.begin(&metadata).unwrap();
            writer.points(&points).unwrap();
            writer.finish().unwrap();
            if let Some(beside) = writer.companion(&name) {
                std::fs::write(folder.path().join(beside.name), beside.text).unwrap();
            }
            drop(writer);
            let has = |column: &Column| match format {
                Format::Kitti => *column == Column::Intensity,
                Format::Mcap => *column != Column::Tilt,
                _ => true,
            };
            let (_, read) = served(&path, format);
            let expected = shown.iter().filter(|(column, _)| has(column));
            assert!(
                read.columns.iter().eq(expected),
                "{format}: {:?}",
                read.columns
            );
        }
    }

    #[test]
    fn the_marks_of_text_are_in_it_or_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let write =
            |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        let marks = |name: &str| {
            let made = cloud(&folder.path().join(name), Format::Xyz).unwrap();
            (made.simulated, made.scanner)
        };
        write("renamed.txt", "# SIMULATED: no scan\n1 2 3\n");
        assert_eq!(marks("renamed.txt"), (true, false));
        write("plain.xyz", "1 2 3\n");
        assert_eq!(marks("plain.xyz"), (false, false));
        write("own.xyz", "1 2 3\n");
        write(
            "own.xyz.txt",
            "SIMULATED\nframe: z up in metres from the tilt axis\n",
        );
        assert_eq!(marks("own.xyz"), (true, true));
    }

    /// The row of names comes from the companion: offsets are still those of the file.
    #[test]
    fn errors_of_a_file_with_a_companion_have_its_offsets() {
        let folder = tempfile::tempdir().unwrap();
        let write =
            |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("cut.xyz", "1 2 3 4\n5 six 7 8\n");
        write("cut.xyz.txt", "columns: x_m y_m z_m intensity\n");
        let failure = cloud(&folder.path().join("cut.xyz"), Format::Xyz)
            .err()
            .unwrap();
        assert!(failure.message.contains(": byte 8: "), "{failure}");
    }

    #[test]
    fn progress_is_the_part_of_the_sweeps_that_is_placed() {
        let shares = std::cell::RefCell::new(Vec::new());
        let report = |share| shares.borrow_mut().push(share);
        let mut sink = ShareSink::new(&report);
        let at = Stamp::<Host>::from_nanos;
        let track = TiltTrack {
            sweeps: vec![(at(100), at(200)), (at(300), at(1_100))],
            ..TiltTrack::default()
        };
        sink.tilt(&track).unwrap();
        for ns in [100, 105, 600, 1_100, 1_200] {
            let mut batch = Points::new(sink.fields());
            batch.push(cloud::Point {
                time: at(ns),
                ..cloud::Point::default()
            });
            sink.points(&batch).unwrap();
        }
        assert_eq!(shares.into_inner(), [0.5, 1.0]);
    }
}
