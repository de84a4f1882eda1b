use std::io::Cursor;

use las::{Reader, Version};
use units::Stamp;

use super::*;
use crate::Point;
use crate::tests::samples::{LATE_NS, SmallDisk, cloud, metadata};
use crate::{Sink, SinkError};

fn written(writer: LasWriter<Cursor<Vec<u8>>>, metadata: &Metadata, batches: &[Points]) -> Vec<u8> {
    let mut writer = writer;
    writer.begin(metadata).unwrap();
    let mut expected = Summary::default();
    for batch in batches {
        writer.points(batch).unwrap();
        expected.add(batch.summary());
    }
    assert_eq!(writer.finish().unwrap(), expected);
    writer.into_inner().unwrap().into_inner()
}

fn points_of(reader: &mut Reader) -> impl Iterator<Item = las::Result<las::Point>> {
    let points: Vec<_> = reader.read_all().unwrap().points().collect();
    points.into_iter()
}

fn both(batches: &[Points]) -> [Vec<u8>; 2] {
    let empty = || Cursor::new(vec![]);
    [
        written(LasWriter::las(empty(), Fields::FILE), &metadata(), batches),
        written(LasWriter::laz(empty(), Fields::FILE), &metadata(), batches),
    ]
}

#[test]
fn las_and_laz_points_round_trip() {
    let batches = [cloud(300), cloud(0), cloud(7)];
    let given: Vec<Point> = batches.iter().flat_map(Points::iter).collect();
    for bytes in both(&batches) {
        let mut reader = Reader::new(Cursor::new(bytes)).unwrap();
        let read: Vec<las::Point> = points_of(&mut reader).map(Result::unwrap).collect();
        assert_eq!(read.len(), given.len());
        for (got, expected) in read.iter().zip(&given) {
            for (got, expected) in [got.x, got.y, got.z].into_iter().zip(expected.position_m) {
                assert!((got - expected).abs() <= 0.5001e-4, "{got} {expected}");
            }
            assert_eq!(got.intensity, u16::from(expected.intensity) * 257);
            assert_eq!((got.return_number, got.number_of_returns), (1, 1));
            assert!(
                got.is_synthetic,
                "every point of a simulated cloud is marked"
            );
            assert!((got.gps_time.unwrap() - gps_time::adjusted_s(expected.time)).abs() < 1e-12);
            let (ring, rest) = got.extra_bytes.split_at(1);
            let (time, tilt) = rest.split_at(8);
            assert_eq!(ring, [expected.ring]);
            let time = f64::from_le_bytes(time.try_into().unwrap());
            assert!((time - expected.time.as_nanos() as f64 * 1e-9).abs() < 1e-6);
            let tilt = f32::from_le_bytes(tilt.try_into().unwrap());
            assert!((f64::from(tilt) - expected.tilt.0).abs() < 2e-6);
        }
    }
}

#[test]
fn the_header_has_counts_bounds_and_software() {
    let batches = [cloud(300)];
    let expected = batches[0].summary().bounds.unwrap();
    for (bytes, compressed) in both(&batches).into_iter().zip([false, true]) {
        let reader = Reader::new(Cursor::new(bytes)).unwrap();
        let header = reader.header();
        assert_eq!(header.number_of_points(), 300);
        assert_eq!(header.number_of_points_by_return(1), Some(300));
        assert_eq!(header.point_format().to_u8().unwrap(), 6);
        assert_eq!(header.version(), Version::new(1, 4));
        assert_eq!(
            header.system_identifier(),
            "SIMULATED VLP-16 on a tilt axis"
        );
        assert_eq!(header.generating_software(), "velomotion 0.1.0");
        assert!(header.gps_time_type().is_standard());
        assert_eq!(header.date(), None);
        assert_eq!(header.laz_vlr().is_ok(), compressed);
        let bounds = header.bounds();
        let [min, max] = [bounds.min, bounds.max].map(|v| [v.x, v.y, v.z]);
        for (got, expected) in min.into_iter().zip(expected.min_m) {
            assert!((got - expected).abs() < 2e-4);
        }
        for (got, expected) in max.into_iter().zip(expected.max_m) {
            assert!((got - expected).abs() < 2e-4);
        }
        let text = header.vlrs().iter().find(|vlr| vlr.record_id == 3).unwrap();
        assert!(text.data.starts_with(b"SIMULATED"));
        assert_eq!(text.description, "SIMULATED cloud");
    }
}

#[test]
fn a_real_cloud_is_not_marked_simulated() {
    let metadata = Metadata {
        simulated: false,
        ..metadata()
    };
    let bytes = written(
        LasWriter::laz(Cursor::new(vec![]), Fields::FILE),
        &metadata,
        &[cloud(3)],
    );
    assert!(!bytes.windows(9).any(|window| window == b"SIMULATED"));
    let mut reader = Reader::new(Cursor::new(bytes)).unwrap();
    assert!(points_of(&mut reader).all(|point| !point.unwrap().is_synthetic));
}

/// The last return is the farther one of two.
#[test]
fn returns_of_dual_mode_are_numbered_by_distance() {
    let dual = Metadata {
        dual_return: true,
        ..metadata()
    };
    // Kinds of returns, each with the number of its pulse. The packets have the last return of a
    // pulse first.
    let given = [
        (0, 0),
        (3, 1),
        (2, 2),
        (4, 2),
        (2, 3),
        (4, 4),
        (2, 5),
        (4, 5),
    ];
    let mut points = Points::new(Fields::ALL);
    for (echo, pulse) in given {
        points.push(Point {
            echo,
            time: Stamp::from_nanos(2_304 * pulse),
            ..Point::default()
        });
    }
    let (one, pair) = ((1, 1), [(2, 2), (1, 2)]);
    let numbered = [one, one, pair[0], pair[1], one, one, pair[0], pair[1]];
    for (metadata, expected) in [(dual, numbered), (metadata(), [one; 8])] {
        let writer = LasWriter::las(Cursor::new(vec![]), Fields::NONE);
        let bytes = written(writer, &metadata, std::slice::from_ref(&points));
        let mut reader = Reader::new(Cursor::new(bytes)).unwrap();
        let found = points_of(&mut reader).map(Result::unwrap);
        let found: Vec<_> = found
            .map(|point| (point.return_number, point.number_of_returns))
            .collect();
        assert_eq!(found, expected);
    }
}

#[test]
fn every_set_of_columns_can_be_requested() {
    let given = cloud(20);
    for (fields, extra) in [(Fields::NONE, 0), (Fields::ALL, 27)] {
        let writer = LasWriter::laz(Cursor::new(vec![]), fields);
        let bytes = written(writer, &metadata(), std::slice::from_ref(&given));
        let mut reader = Reader::new(Cursor::new(bytes)).unwrap();
        for (got, expected) in points_of(&mut reader).map(Result::unwrap).zip(given.iter()) {
            assert_eq!(got.extra_bytes.len(), extra);
            if fields == Fields::ALL {
                assert_eq!(got.extra_bytes[13], expected.laser);
                let time = f64::from_le_bytes(got.extra_bytes[14..22].try_into().unwrap());
                assert!((time - expected.device_time.as_nanos() as f64 * 1e-9).abs() < 1e-12);
                let sd = f32::from_le_bytes(got.extra_bytes[22..26].try_into().unwrap());
                assert_eq!(sd, expected.sd_m as f32);
                assert_eq!(got.extra_bytes[26], expected.echo);
            }
        }
    }
}

#[test]
fn an_empty_cloud_is_a_valid_file() {
    for bytes in both(&[]) {
        let mut reader = Reader::new(Cursor::new(bytes)).unwrap();
        assert_eq!(reader.header().number_of_points(), 0);
        assert_eq!(points_of(&mut reader).count(), 0);
    }
}

#[test]
fn equal_points_give_equal_bytes() {
    assert_eq!(both(&[cloud(50)]), both(&[cloud(50)]));
}

#[test]
fn long_and_non_ascii_names_are_shortened() {
    let metadata = Metadata {
        source: "Größe ".repeat(20),
        software: "v".repeat(100),
        comments: vec!["z".repeat(100_000)],
        ..metadata()
    };
    for writer in [
        LasWriter::las(Cursor::new(vec![]), Fields::FILE),
        LasWriter::laz(Cursor::new(vec![]), Fields::FILE),
    ] {
        let bytes = written(writer, &metadata, &[cloud(5)]);
        let mut reader = Reader::new(Cursor::new(bytes)).unwrap();
        assert_eq!(reader.header().generating_software(), "v".repeat(32));
        assert_eq!(
            reader.header().system_identifier(),
            "SIMULATED Gr??e Gr??e Gr??e Gr??"
        );
        assert_eq!(points_of(&mut reader).count(), 5);
    }
}

#[test]
fn coordinates_out_of_range_are_reported() {
    for (bad, fits) in [
        (f64::NAN, false),
        (f64::INFINITY, false),
        (214_749.0, false),
        (-214_748.0, true),
        (214_748.0, true),
    ] {
        let mut batch = cloud(4);
        batch.push(Point {
            position_m: [0.0, bad, 0.0],
            ..Point::default()
        });
        let mut writer = LasWriter::las(Cursor::new(vec![]), Fields::FILE);
        writer.begin(&metadata()).unwrap();
        writer.points(&cloud(10)).unwrap();
        let result = writer.points(&batch);
        assert_eq!(result.is_ok(), fits, "{bad}");
        if let Err(error) = result {
            assert!(
                matches!(
                    error,
                    SinkError::Coordinate {
                        axis: 'y',
                        point: 14,
                        ..
                    }
                ),
                "{error}"
            );
        }
        let count = writer.finish().unwrap().points;
        assert_eq!(count, if fits { 15 } else { 10 });
    }
}

/// The library panics when it cannot complete its file on drop: a disk that fills up at any byte
/// must not cause that.
#[test]
fn a_full_disk_is_an_error_at_every_byte_and_never_a_panic() {
    for make in [LasWriter::las, LasWriter::laz] {
        let [las, laz] = both(&[cloud(20)]).map(|bytes| bytes.len() as u64);
        for room in (0..las.max(laz)).step_by(3) {
            let mut writer = make(SmallDisk::new(room), Fields::FILE);
            let result = writer
                .begin(&metadata())
                .and_then(|()| writer.points(&cloud(20)))
                .and_then(|()| writer.finish());
            match result {
                Ok(summary) => assert_eq!(summary.points, 20),
                Err(error) => {
                    assert!(matches!(error, SinkError::Write { .. }), "{error}");
                    assert!(room < las.max(laz));
                }
            }
        }
        let mut writer = make(SmallDisk::new(100), Fields::FILE);
        assert!(writer.begin(&metadata()).is_err());
        assert!(matches!(
            writer.points(&cloud(1)),
            Err(SinkError::Order { .. })
        ));
    }
}

#[test]
fn a_file_truncated_by_a_full_disk_cannot_be_finished() {
    let header = both(&[])[0].len() as u64;
    let mut writer = LasWriter::las(SmallDisk::new(header + 500), Fields::FILE);
    writer.begin(&metadata()).unwrap();
    writer.points(&cloud(10)).unwrap();
    let error = writer.points(&cloud(10)).unwrap_err();
    assert!(
        matches!(error, SinkError::Write { points: 10, .. }),
        "{error}"
    );
    assert!(matches!(
        writer.points(&cloud(1)),
        Err(SinkError::Order { .. })
    ));
    let error = writer.finish().unwrap_err();
    assert!(
        matches!(error, SinkError::Write { points: 10, .. }),
        "{error}"
    );
}

#[test]
fn a_dropped_writer_leaves_a_file_of_its_batches() {
    let file = crate::tests::samples::SharedOutput::default();
    let mut writer = LasWriter::laz(file.clone(), Fields::FILE);
    writer.begin(&metadata()).unwrap();
    writer.points(&cloud(12)).unwrap();
    drop(writer);
    let mut reader = Reader::new(Cursor::new(file.content())).unwrap();
    assert_eq!(points_of(&mut reader).count(), 12);
}

/// Rows that wait until eight chunks of LAZ are full are not lost, in whatever batches they come.
#[test]
fn rows_of_several_slabs_of_laz_are_all_there_in_order() {
    let batches = [cloud(399_999), cloud(3), cloud(450_000), cloud(1)];
    let x_m: Vec<f64> = batches
        .iter()
        .flat_map(|batch| batch.x_m().to_vec())
        .collect();
    for bytes in both(&batches) {
        let mut reader = Reader::new(Cursor::new(bytes)).unwrap();
        let mut read = points_of(&mut reader);
        for x_m in &x_m {
            assert!((read.next().unwrap().unwrap().x - x_m).abs() <= 0.5001e-4);
        }
        assert!(read.next().is_none());
    }
}

#[test]
fn times_of_2099_keep_a_quarter_microsecond() {
    let bytes = &both(&[cloud(2)])[0];
    let mut reader = Reader::new(Cursor::new(bytes.clone())).unwrap();
    let times: Vec<f64> = points_of(&mut reader)
        .map(|p| p.unwrap().gps_time.unwrap())
        .collect();
    assert!((times[1] - times[0] - 2.304e-6).abs() < 0.25e-6);
    let seconds = LATE_NS / 1_000_000_000 + 18 - 315_964_800 - 1_000_000_000;
    assert_eq!(times[0], seconds as f64);
}
