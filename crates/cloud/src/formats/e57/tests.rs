use std::io::Cursor;

use e57::{E57Reader, RecordName, RecordValue};

use super::*;
use crate::Point;
use crate::tests::samples::{LATE_NS, NOW_NS, SharedOutput, SmallDisk, cloud_from, metadata};
use crate::{Sink, SinkError};

fn written(fields: Fields, batches: &[Points]) -> Vec<u8> {
    let file = SharedOutput::default();
    let mut writer = E57Writer::new(file.clone(), fields);
    writer.begin(&metadata()).unwrap();
    for batch in batches {
        writer.points(batch).unwrap();
    }
    let summary = writer.finish().unwrap();
    assert_eq!(summary.points, batches.iter().map(|b| b.len() as u64).sum());
    file.content()
}

#[test]
fn files_round_trip() {
    let cloud = cloud_from(20_000, NOW_NS + 123);
    let bytes = written(Fields::ALL, std::slice::from_ref(&cloud));
    let mut file = E57Reader::new(Cursor::new(bytes)).unwrap();
    assert_eq!(file.extensions().len(), 1);
    let [about] = &file.pointclouds()[..] else {
        panic!("one cloud")
    };
    assert_eq!(about.records, 20_000);
    let names: Vec<RecordName> = about.prototype.iter().map(|r| r.name.clone()).collect();
    let raw: Vec<Vec<RecordValue>> = file
        .pointcloud_raw(about)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    assert_eq!(raw.len(), cloud.len());
    for (values, point) in raw.iter().zip(cloud.iter()) {
        for (name, value) in names.iter().zip(values) {
            let expected = match name {
                RecordName::CartesianInvalidState => RecordValue::Integer(0),
                RecordName::CartesianX => RecordValue::Single(point.position_m[0] as f32),
                RecordName::CartesianY => RecordValue::Single(point.position_m[1] as f32),
                RecordName::CartesianZ => RecordValue::Single(point.position_m[2] as f32),
                RecordName::Intensity => RecordValue::Integer(point.intensity.into()),
                RecordName::RowIndex => RecordValue::Integer(point.ring.into()),
                RecordName::TimeStamp => {
                    let RecordValue::Double(since) = value else {
                        panic!("{value:?}")
                    };
                    let expected = (point.time.as_nanos() - NOW_NS) as f64 * 1e-9;
                    assert!((since - expected).abs() < 1e-15, "{since} {expected}");
                    continue;
                }
                RecordName::Unknown { name, .. } => match name.as_str() {
                    "tilt" => RecordValue::Single(point.tilt.0 as f32),
                    "sd" => RecordValue::Single(point.sd_m as f32),
                    "laser" => RecordValue::Integer(point.laser.into()),
                    "echo" => RecordValue::Integer(point.echo.into()),
                    "device_time" => RecordValue::Double(point.device_time.as_secs_f64()),
                    other => panic!("{other}"),
                },
                other => panic!("{other:?}"),
            };
            assert_eq!(*value, expected, "{name:?}");
        }
    }
    assert_eq!(names.len(), 12);
}

#[test]
fn the_file_describes_itself() {
    let cloud = cloud_from(10, NOW_NS + 500_000_000);
    let file = E57Reader::new(Cursor::new(written(
        Fields::FILE,
        std::slice::from_ref(&cloud),
    )))
    .unwrap();
    let about = file.pointclouds().remove(0);
    assert!(about.description.unwrap().starts_with("SIMULATED"));
    assert_eq!(about.sensor_model.as_deref(), Some("VLP-16 on a tilt axis"));
    assert_eq!(about.guid.as_deref(), Some(file.guid()));
    assert!(!file.guid().contains("0000-0000"), "{}", file.guid());
    let start = about.acquisition_start.unwrap();
    assert_eq!(
        start.gps_time,
        (NOW_NS / 1_000_000_000 - 315_964_800 + 18) as f64
    );
    assert!(about.acquisition_end.unwrap().gps_time > start.gps_time);
    let limits = about.intensity_limits.unwrap();
    let of = |value: Option<RecordValue>| value.unwrap();
    assert_eq!(of(limits.intensity_min), RecordValue::Integer(0));
    assert_eq!(of(limits.intensity_max), RecordValue::Integer(255));
    let (bounds, expected) = (
        about.cartesian_bounds.unwrap(),
        cloud.summary().bounds.unwrap(),
    );
    let near = |got: Option<f64>, wanted: f64| assert!((got.unwrap() - wanted).abs() < 4e-6);
    for (axis, (min, max)) in [
        (bounds.x_min, bounds.x_max),
        (bounds.y_min, bounds.y_max),
        (bounds.z_min, bounds.z_max),
    ]
    .into_iter()
    .enumerate()
    {
        near(min, expected.min_m[axis]);
        near(max, expected.max_m[axis]);
    }
    let pose = about.transform.unwrap();
    assert_eq!((pose.rotation.w, pose.translation.z), (1.0, 0.0));
}

/// Readers apply the pose; other formats have points that are turned already.
#[test]
fn a_georeferenced_scan_has_the_heading_as_its_pose() {
    for heading_deg in [30.0, -270.0, 300.0] {
        assert_heading_is_pose(heading_deg);
    }
}

fn assert_heading_is_pose(heading_deg: f64) {
    let cloud = cloud_from(100, NOW_NS);
    let axes = crate::EastNorthUp::new(units::Degrees(heading_deg));
    let georeferenced = Metadata {
        east_north_up: Some(axes),
        ..metadata()
    };
    let file = SharedOutput::default();
    let mut writer = E57Writer::new(file.clone(), Fields::FILE);
    writer.begin(&georeferenced).unwrap();
    writer.points(&cloud).unwrap();
    let bounds = writer.finish().unwrap().bounds.unwrap();
    let about = E57Reader::new(Cursor::new(file.content())).unwrap();
    let pose = about.pointclouds().remove(0).transform.unwrap();
    let half = (heading_deg / 2.0).to_radians();
    assert!(pose.rotation.w >= 0.0);
    assert!((pose.rotation.w - half.cos().abs()).abs() < 1e-15);
    assert!((pose.rotation.z.abs() - half.sin().abs()).abs() < 1e-15);
    let description = about.pointclouds().remove(0).description.unwrap();
    assert!(description.contains("frame: x east, y north, z up"));
    assert!(description.contains(", after the pose"), "{description}");
    let read = crate::read::positions(crate::formats::Format::E57, file.content()).unwrap();
    assert_eq!(read.positions.len(), cloud.len());
    for (read, point) in read.positions.iter().zip(cloud.iter()) {
        let placed = axes.place(point.position_m);
        let off = |axis: usize| (read[axis] - placed[axis]).abs();
        assert!(off(0) < 8e-6 && off(1) < 8e-6 && off(2) < 8e-6);
        assert!((0..3).all(|axis| placed[axis] <= bounds.max_m[axis]));
    }
}

/// Sweeps become scans for any batches; one without points, here the second, is left out.
#[test]
fn each_sweep_is_a_scan() {
    let cloud = cloud_from(2000, NOW_NS);
    let at = |ms: i64| Stamp::from_nanos(NOW_NS + ms * 1_000_000);
    let sweeps = vec![
        (at(0), cloud.time()[499]),
        (at(2), cloud.time()[499]),
        (at(3), at(9)),
    ];
    let mut first_content = None;
    for batch in [1, 7, 500, 2000] {
        let file = SharedOutput::default();
        let mut writer = E57Writer::new(file.clone(), Fields::FILE);
        writer.begin(&metadata()).unwrap();
        assert!(writer.wants_tilt());
        let track = TiltTrack {
            sweeps: sweeps.clone(),
            ..TiltTrack::default()
        };
        writer.tilt(&track).unwrap();
        for row in (0..2000).step_by(batch) {
            let rows = row..(row + batch).min(2000);
            writer.points(&part(&cloud, rows)).unwrap();
        }
        assert_eq!(writer.finish().unwrap(), cloud.summary());
        let content = file.content();
        assert_eq!(*first_content.get_or_insert(content.clone()), content);
        let mut file = E57Reader::new(Cursor::new(content)).unwrap();
        let scans = file.pointclouds();
        let names: Vec<_> = scans.iter().flat_map(|scan| scan.name.clone()).collect();
        assert_eq!(names, ["SIMULATED sweep 1", "SIMULATED sweep 3"]);
        let guids = [&scans[0].guid, &scans[1].guid].map(|guid| guid.clone().unwrap());
        assert!(guids[0] != guids[1] && !guids.contains(&file.guid().to_owned()));
        let mut read = Vec::new();
        for (scan, rows) in scans.iter().zip([0..500, 500..2000]) {
            let part = part(&cloud, rows);
            let end = scan.acquisition_end.as_ref().unwrap().gps_time;
            let last = gps_time::gps_s(*part.time().last().unwrap());
            assert!((end - last).abs() < 1e-6 && scan.transform.is_some());
            assert_eq!(scan.records, part.len() as u64);
            assert!(scan.description.clone().unwrap().starts_with("SIMULATED"));
            let x = |row: e57::Result<Vec<RecordValue>>| row.unwrap()[0].clone();
            read.extend(file.pointcloud_raw(scan).unwrap().map(x));
        }
        let x = cloud.x_m().iter().map(|x| RecordValue::Single(*x as f32));
        assert!(x.eq(read));
    }
}

#[test]
fn clouds_without_points_or_columns_are_valid_files() {
    for (fields, batches) in [
        (Fields::FILE, vec![]),
        (Fields::NONE, vec![cloud_from(3, LATE_NS)]),
    ] {
        let file = E57Reader::new(Cursor::new(written(fields, &batches))).unwrap();
        let about = file.pointclouds().remove(0);
        assert_eq!(about.records, 3 * batches.len() as u64);
        assert_eq!(file.extensions().is_empty(), fields == Fields::NONE);
    }
}

#[test]
fn equal_points_give_equal_bytes_and_different_points_another_identifier() {
    let cloud = |count| vec![cloud_from(count, NOW_NS)];
    assert_eq!(
        written(Fields::FILE, &cloud(500)),
        written(Fields::FILE, &cloud(500))
    );
    let identity = |count| {
        let bytes = written(Fields::FILE, &cloud(count));
        E57Reader::new(Cursor::new(bytes))
            .unwrap()
            .guid()
            .to_owned()
    };
    assert_ne!(identity(500), identity(501));
}

#[test]
fn metadata_cannot_break_the_description() {
    let file = SharedOutput::default();
    let mut writer = E57Writer::new(file.clone(), Fields::FILE);
    let metadata = Metadata {
        source: "]]></description>".into(),
        comments: vec!["<&>]]>".into()],
        ..metadata()
    };
    writer.begin(&metadata).unwrap();
    writer.finish().unwrap();
    let file = E57Reader::new(Cursor::new(file.content())).unwrap();
    let description = file.pointclouds().remove(0).description.unwrap();
    assert!(description.contains("<&>]] >"), "{description}");
}

#[test]
fn invalid_positions_are_refused_and_earlier_batches_kept() {
    let file = SharedOutput::default();
    let mut writer = E57Writer::new(file.clone(), Fields::FILE);
    writer.begin(&metadata()).unwrap();
    writer.points(&cloud_from(10, NOW_NS)).unwrap();
    let mut nowhere = Points::new(Fields::FILE);
    nowhere.push(Point {
        position_m: [0.0, f64::INFINITY, 0.0],
        ..Point::default()
    });
    let error = writer.points(&nowhere).unwrap_err();
    assert!(
        matches!(
            error,
            SinkError::Coordinate {
                point: 10,
                axis: 'y',
                ..
            }
        ),
        "{error}"
    );
    assert_eq!(writer.finish().unwrap().points, 10);
    let file = E57Reader::new(Cursor::new(file.content())).unwrap();
    assert_eq!(file.pointclouds().remove(0).records, 10);
}

/// The first error is returned by one of the following calls, at the latest by the last.
#[test]
fn a_full_disk_is_an_error_at_every_byte_and_never_a_panic() {
    let cloud = cloud_from(200, NOW_NS);
    let whole = written(Fields::FILE, std::slice::from_ref(&cloud)).len() as u64;
    for room in (0..=whole + 100).step_by(97) {
        let mut writer = E57Writer::new(SmallDisk::new(room), Fields::FILE);
        let result = writer
            .begin(&metadata())
            .and_then(|()| writer.points(&cloud))
            .and_then(|()| writer.finish());
        match result {
            Ok(summary) => assert!(summary.points == 200 && room >= whole, "{room} of {whole}"),
            Err(error) => assert!(
                matches!(error, SinkError::Write { .. }) && room < whole,
                "{room} of {whole}: {error}"
            ),
        }
        assert!(writer.finish().is_err());
    }
}

/// An unfinished writer leaves a file that no reader accepts, and releases its output.
#[test]
fn a_dropped_writer_leaves_no_cloud() {
    let file = SharedOutput::default();
    let mut writer = E57Writer::new(file.clone(), Fields::FILE);
    writer.begin(&metadata()).unwrap();
    writer.points(&cloud_from(10_000, NOW_NS)).unwrap();
    drop(writer);
    let bytes = file.content();
    assert!(bytes.len() > 1000 && E57Reader::new(Cursor::new(bytes)).is_err());
}
