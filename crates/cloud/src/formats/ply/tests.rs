use std::io::Cursor;

use proptest::prelude::*;
use units::Degrees;

use super::*;
use crate::Point;
use crate::tests::samples::{SmallDisk, cloud, metadata};
use crate::{Sink, SinkError};

/// An independent, slow reader of PLY by the format's description.
struct Read {
    comments: Vec<String>,
    vertices: usize,
    properties: Vec<(String, String)>,
    rows: Vec<Vec<f64>>,
    rest: usize,
}

fn read(bytes: &[u8]) -> Read {
    let end = b"end_header\n";
    let at = bytes.windows(end.len()).position(|w| w == end).unwrap();
    let header = std::str::from_utf8(&bytes[..at]).unwrap();
    assert!(header.is_ascii());
    let mut lines = header.lines();
    assert_eq!(lines.next(), Some("ply"));
    assert_eq!(lines.next(), Some("format binary_little_endian 1.0"));
    let mut read = Read {
        comments: vec![],
        vertices: usize::MAX,
        properties: vec![],
        rows: vec![],
        rest: 0,
    };
    for line in lines {
        match line.split_once(' ').unwrap() {
            ("comment", text) => read.comments.push(text.to_owned()),
            ("element", text) => {
                let count = text.strip_prefix("vertex ").unwrap();
                read.vertices = count.parse().unwrap();
                assert_eq!(count, read.vertices.to_string(), "a plain number");
            }
            ("property", text) => {
                let (kind, name) = text.split_once(' ').unwrap();
                read.properties.push((kind.to_owned(), name.to_owned()));
            }
            other => panic!("{other:?}"),
        }
    }
    let mut data = &bytes[at + end.len()..];
    for _ in 0..read.vertices {
        let mut row = vec![];
        for (kind, _) in &read.properties {
            let size = match kind.as_str() {
                "float" => 4,
                "double" => 8,
                "uchar" => 1,
                other => panic!("{other}"),
            };
            let (value, after) = data.split_at(size);
            data = after;
            row.push(match kind.as_str() {
                "float" => f32::from_le_bytes(value.try_into().unwrap()).into(),
                "double" => f64::from_le_bytes(value.try_into().unwrap()),
                _ => value[0].into(),
            });
        }
        read.rows.push(row);
    }
    read.rest = data.len();
    read
}

fn written(fields: Fields, batches: &[Points]) -> (Vec<u8>, Vec<u8>) {
    let mut file = PlyWriter::new(Cursor::new(vec![]), fields);
    let mut pipe = PlyPipe::new(vec![], Cursor::new(vec![]), fields);
    let mut both = (&mut file, &mut pipe);
    both.begin(&metadata()).unwrap();
    for batch in batches {
        both.points(batch).unwrap();
    }
    both.finish().unwrap();
    (file.into_inner().into_inner(), pipe.into_inner())
}

#[test]
fn the_header_describes_the_rows() {
    let (bytes, _) = written(Fields::FILE, &[cloud(7), cloud(5)]);
    let read = read(&bytes);
    assert_eq!(read.vertices, 12);
    assert_eq!(read.rest, 0);
    let properties: Vec<_> = read
        .properties
        .iter()
        .map(|(kind, name)| (kind.as_str(), name.as_str()))
        .collect();
    assert_eq!(
        properties,
        [
            ("float", "x"),
            ("float", "y"),
            ("float", "z"),
            ("float", "intensity"),
            ("uchar", "ring"),
            ("double", "time"),
            ("float", "tilt"),
        ]
    );
    assert!(read.comments[0].starts_with("SIMULATED"));
    for line in ["software: velomotion 0.1.0", "first", "second"] {
        assert!(read.comments.iter().any(|c| c == line), "{line}");
    }
}

#[test]
fn the_header_does_not_grow_with_the_count() {
    let lengths: Vec<_> = [0, 9, 10, 12_345_678, u64::MAX]
        .map(|count| count_lines(count).len())
        .into();
    assert!(
        lengths.iter().all(|length| *length == lengths[0]),
        "{lengths:?}"
    );
}

#[test]
fn pipes_and_files_get_the_same_bytes() {
    let (file, pipe) = written(Fields::ALL, &[cloud(3), cloud(0), cloud(40)]);
    let (file, pipe) = (read(&file), read(&pipe));
    assert_eq!(file.rows, pipe.rows);
    assert_eq!(file.properties, pipe.properties);
    assert_eq!(pipe.vertices, 43);
}

#[test]
fn an_empty_cloud_is_a_valid_file() {
    let (bytes, pipe) = written(Fields::FILE, &[]);
    assert_eq!((read(&bytes).vertices, read(&bytes).rest), (0, 0));
    assert_eq!((read(&pipe).vertices, read(&pipe).rest), (0, 0));
}

/// An f32 step between 64 and 128 m is 2^-17 m; half of it is the bound. Measured over the whole
/// sphere of 100 m.
#[test]
fn f32_positions_are_within_4_um_at_100_m() {
    let mut worst: f64 = 0.0;
    for i in 0..200_000_u32 {
        let turn = f64::from(i) * 2.399_963_229_728_653;
        let up = 1.0 - 2.0 * (f64::from(i) + 0.5) / 200_000.0;
        let flat = (1.0 - up * up).sqrt();
        for value in [
            100.0 * flat * turn.sin(),
            100.0 * flat * turn.cos(),
            100.0 * up,
        ] {
            worst = worst.max((f64::from(value as f32) - value).abs());
        }
    }
    let bound = 2.0_f64.powi(-18);
    assert!(worst <= bound, "{worst} m");
    assert!(
        worst > 0.99 * bound,
        "the measurement must reach the bound: {worst} m"
    );
    assert!(bound < 4e-6);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn rows_hold_the_points(
        given in prop::collection::vec(
            (prop::array::uniform3(-120.0..120.0f64), any::<(u8, u8, u8)>(), 0..4_102_444_800_000_000_000i64, -180.0..180.0f64),
            0..20,
        ),
    ) {
        let mut points = Points::new(Fields::ALL);
        for &(position_m, (intensity, ring, laser), ns, tilt) in &given {
            points.push(Point {
                position_m, intensity, ring, laser,
                time: units::Stamp::from_nanos(ns),
                device_time: units::Stamp::from_nanos(ns / 1000),
                tilt: Degrees(tilt),
                sd_m: tilt.abs() / 1e3,
                echo: laser % 5,
            });
        }
        let (bytes, _) = written(Fields::ALL, &[points]);
        let read = read(&bytes);
        prop_assert_eq!(read.rows.len(), given.len());
        for (row, (position_m, (intensity, ring, laser), ns, tilt)) in read.rows.iter().zip(given) {
            for (got, expected) in row[..3].iter().zip(position_m) {
                prop_assert!((got - expected).abs() < 4e-6);
            }
            prop_assert_eq!((row[3], row[4], row[7]), (intensity.into(), ring.into(), laser.into()));
            prop_assert_eq!(row[10], f64::from(laser % 5));
            prop_assert!((row[5] - ns as f64 * 1e-9).abs() < 1e-6);
            prop_assert!((row[6] - tilt).abs() < 8e-6);
            prop_assert!((row[8] - ns as f64 * 1e-12).abs() < 1e-8);
            prop_assert!((row[9] - tilt.abs() / 1e3).abs() < 8e-9);
        }
    }
}

#[test]
fn a_full_disk_leaves_a_valid_file_of_earlier_batches() {
    let whole = written(Fields::FILE, &[cloud(10), cloud(10)]).0.len() as u64;
    let mut reached = std::collections::BTreeSet::new();
    for room in 0..whole {
        let mut writer = PlyWriter::new(SmallDisk::new(room), Fields::FILE);
        if let Err(error) = writer.begin(&metadata()) {
            assert!(
                matches!(error, SinkError::Write { points: 0, .. }),
                "{error}"
            );
            assert!(writer.finish().is_err());
            reached.insert(None);
            continue;
        }
        let first = writer.points(&cloud(10));
        let second = writer.points(&cloud(10));
        assert!(second.is_err());
        if first.is_err() {
            assert!(matches!(second, Err(SinkError::Order { .. })));
        }
        let summary = writer.finish().unwrap();
        let read = read(writer.into_inner().file.get_ref());
        assert_eq!(read.vertices as u64, summary.points);
        assert_eq!(summary.points, if first.is_ok() { 10 } else { 0 });
        reached.insert(Some(summary.points));
    }
    assert_eq!(
        reached.len(),
        3,
        "header, first and second batch all failed once"
    );
}

#[test]
fn calls_out_of_order_are_refused() {
    let mut writer = PlyWriter::new(Cursor::new(vec![]), Fields::FILE);
    assert!(matches!(
        writer.points(&cloud(1)),
        Err(SinkError::Order {
            expected: "begin",
            ..
        })
    ));
    assert!(matches!(writer.finish(), Err(SinkError::Order { .. })));
    writer.begin(&metadata()).unwrap();
    assert!(matches!(
        writer.begin(&metadata()),
        Err(SinkError::Order { .. })
    ));
    let bare = Points::new(Fields::RING);
    assert!(matches!(writer.points(&bare), Err(SinkError::Columns(_))));
    writer.points(&cloud(1)).unwrap();
    writer.finish().unwrap();
    assert!(matches!(
        writer.points(&cloud(1)),
        Err(SinkError::Order { .. })
    ));
    assert!(matches!(writer.finish(), Err(SinkError::Order { .. })));
}

#[test]
fn a_file_may_start_at_an_offset_of_the_output() {
    let mut output = Cursor::new(vec![]);
    output.write_all(b"before").unwrap();
    let mut writer = PlyWriter::new(output, Fields::FILE);
    writer.begin(&metadata()).unwrap();
    writer.points(&cloud(3)).unwrap();
    writer.finish().unwrap();
    let bytes = writer.into_inner().into_inner();
    assert_eq!(&bytes[..6], b"before");
    assert_eq!(read(&bytes[6..]).vertices, 3);
}
