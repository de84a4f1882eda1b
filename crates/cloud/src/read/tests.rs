use std::io::Cursor;

use super::*;
use crate::tests::samples::{SharedOutput, cloud_from, metadata};
use crate::{Column, Fields, Point, Sink};

/// Every column that can be read.
const COLUMNS: Fields = Fields::FILE.union(Fields::LASER.union(Fields::SD.union(Fields::ECHO)));

/// A file with all its columns.
fn whole(format: Format, bytes: Vec<u8>) -> Result<StoredCloud, ReadError> {
    let read = super::cloud(format, bytes, COLUMNS)?;
    for (column, values) in &read.columns {
        assert_eq!(values.len(), read.positions.len(), "{format}: {column:?}");
        assert!(values.iter().all(|value| value.is_finite()));
    }
    Ok(read)
}

/// The positions of a file, without its counts.
fn places(format: Format, bytes: Vec<u8>) -> Result<Positions, ReadError> {
    whole(format, bytes).map(|read| read.positions)
}

/// Columns by name.
fn named(read: &StoredCloud) -> Vec<(&'static str, &[f32])> {
    let columns = read.columns.iter();
    columns
        .map(|(column, values)| (column.name(), values.as_slice()))
        .collect()
}

/// Points of a day that every format can represent: ROS 2 ends in 2038.
fn cloud(count: u32) -> crate::Points {
    cloud_from(count, 1_700_000_000_000_000_000)
}

fn written(format: Format, points: &crate::Points) -> Vec<u8> {
    written_with(format, points, Fields::FILE)
}

fn written_with(format: Format, points: &crate::Points, fields: Fields) -> Vec<u8> {
    let output = SharedOutput::default();
    let mut writer = format.writer(output.clone(), fields);
    writer.begin(&metadata()).unwrap();
    writer.points(points).unwrap();
    writer.finish().unwrap();
    drop(writer);
    output.content()
}

#[test]
fn files_round_trip() {
    let points = cloud(3_000);
    for format in Format::ALL {
        let bytes = written(format, &points);
        let read = places(format, bytes.clone()).unwrap();
        assert_eq!(read.len(), points.len());
        // f32 at 100 m; 0.1 mm steps; shortest decimals.
        let most = match format {
            Format::Ply
            | Format::Pcd
            | Format::E57
            | Format::Mcap
            | Format::Kitti
            | Format::Npz => 4e-6,
            Format::Las | Format::Laz => 0.51e-4,
            Format::Csv | Format::Xyz => 0.0,
        };
        let off = (points.x_m().iter().zip(points.y_m()).zip(points.z_m()))
            .zip(&read)
            .map(|(((x, y), z), [a, b, c])| (x - a).abs().max((y - b).abs()).max((z - c).abs()));
        let off = off.fold(0.0, f64::max);
        assert!(off <= most, "{format}: {off}");
        let bare = positions(format, bytes).unwrap();
        assert_eq!(
            (&bare.positions, bare.columns),
            (&read, Vec::new()),
            "{format}"
        );
    }
}

#[test]
fn columns_round_trip() {
    let points = cloud(3_000);
    let first = points.time()[0];
    for format in Format::ALL {
        let mut bytes = Vec::new();
        if format == Format::Xyz {
            // The names are in its companion.
            bytes.extend(
                b"x_m y_m z_m intensity ring time_s tilt_deg laser device_time_s sd_m echo\n",
            );
        }
        bytes.extend(written_with(format, &points, Fields::ALL));
        let read = whole(format, bytes).unwrap();
        let has = match format {
            Format::Kitti => Fields::INTENSITY,
            // The joint has the tilt.
            Format::Mcap => COLUMNS - Fields::TILT,
            _ => COLUMNS,
        };
        let columns: Vec<Column> = read.columns.iter().map(|(column, _)| *column).collect();
        assert_eq!(columns, has.columns().collect::<Vec<_>>(), "{format}");
        for (column, values) in &read.columns {
            let of = |point: Point| match column {
                Column::Intensity => point.intensity.into(),
                Column::Ring => point.ring.into(),
                Column::Time => point.time.saturating_since(first).as_secs_f64(),
                Column::Tilt => point.tilt.0,
                Column::Laser => point.laser.into(),
                Column::Sd => point.sd_m,
                Column::Echo => point.echo.into(),
                Column::DeviceTime => unreachable!(),
            };
            let most = match column {
                // Two times of f64 Unix seconds, or seconds of f32 after one.
                Column::Time => 4e-7,
                Column::Tilt => 2e-6,
                Column::Sd => 1e-9,
                Column::Intensity if format == Format::Kitti => 2e-5,
                _ => 0.0,
            };
            for (value, point) in values.iter().zip(points.iter()) {
                let off = (f64::from(*value) - of(point)).abs();
                assert!(off <= most, "{format}: {column:?}: {value} of {point:?}");
            }
        }
    }
}

/// LAS has zeros for columns that a cloud lacks.
#[test]
fn clouds_without_a_column_have_none() {
    let mut points = crate::Points::new(Fields::RING);
    cloud(30).iter().for_each(|point| points.push(point));
    for format in [
        Format::Ply,
        Format::Pcd,
        Format::E57,
        Format::Csv,
        Format::Laz,
    ] {
        let read = whole(format, written_with(format, &points, Fields::RING)).unwrap();
        let names: Vec<&str> = named(&read).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["ring"], "{format}");
    }
}

#[test]
fn every_prefix_of_a_file_is_an_error_or_its_first_points() {
    let points = cloud(5);
    for format in Format::ALL {
        let bytes = written_with(format, &points, Fields::ALL);
        let whole = places(format, bytes.clone()).unwrap();
        for end in 0..bytes.len() {
            match places(format, bytes[..end].to_vec()) {
                Err(error) => assert!(error.offset <= end, "{error}"),
                Ok(some) => assert!(some.len() <= whole.len(), "{format}: {end}"),
            }
        }
    }
}

/// A file with a changed byte gives an error or points, without a panic and without memory reserved
/// by an unverified header.
#[test]
fn changed_bytes_never_panic() {
    let points = cloud(5);
    for format in Format::ALL {
        let bytes = written_with(format, &points, Fields::ALL);
        for at in 0..bytes.len() {
            for change in [0x01, 0x80, 0xFF] {
                let mut changed = bytes.clone();
                changed[at] ^= change;
                if let Err(error) = places(format, changed) {
                    assert!(error.offset <= bytes.len(), "{error}");
                }
            }
        }
    }
}

#[test]
fn ply_files_of_other_programs_are_read() {
    let little = |rest: &[u8]| {
        let mut bytes = b"ply\nformat binary_little_endian 1.0\ncomment by hand\nelement camera 1\nproperty list uchar short view\nelement vertex 2\nproperty uchar red\nproperty double z\nproperty float x\nproperty short y\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n".to_vec();
        bytes.extend(rest);
        bytes
    };
    let mut data = vec![2, 1, 0, 2, 0];
    for (x, y, z) in [(1.5_f32, -2_i16, 3.25_f64), (0.0, 7, -0.5)] {
        data.push(255);
        data.extend(z.to_le_bytes());
        data.extend(x.to_le_bytes());
        data.extend(y.to_le_bytes());
    }
    data.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    let expected = [[1.5, -2.0, 3.25], [0.0, 7.0, -0.5]];
    assert_eq!(places(Format::Ply, little(&data)).unwrap(), expected);
    let mut big = b"ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty int z\nend_header\n".to_vec();
    big.extend(1.5_f32.to_be_bytes());
    big.extend((-2.0_f32).to_be_bytes());
    big.extend(3_i32.to_be_bytes());
    assert_eq!(places(Format::Ply, big).unwrap(), [[1.5, -2.0, 3.0]]);
    let text = "ply\r\nformat ascii 1.0\r\nelement vertex 2\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\nend_header\r\n1.5 -2 3.25\r\n0 7 -0.5\r\n";
    assert_eq!(places(Format::Ply, text.into()).unwrap(), expected);
}

#[test]
fn pcd_files_of_other_programs_are_read() {
    let head = "# .PCD v.7\nVERSION .7\nFIELDS rgb x y z\nSIZE 1 4 4 4\nTYPE U F F F\nCOUNT 3 1 1 1\nWIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\n";
    let expected = [[1.5, -2.0, 3.25], [0.0, 7.0, -0.5]];
    let text = format!("{head}DATA ascii\n1 2 3 1.5 -2 3.25\n0 0 0 nan nan nan\n0 0 0 0 7 -0.5\n");
    assert_eq!(places(Format::Pcd, text.into()).unwrap(), expected);
    let rows = [[1.5_f32, -2.0, 3.25], [f32::NAN; 3], [0.0, 7.0, -0.5]];
    let mut binary = format!("{head}DATA binary\n").into_bytes();
    for row in rows {
        binary.extend([9, 9, 9]);
        binary.extend(row.iter().flat_map(|axis| axis.to_le_bytes()));
    }
    assert_eq!(places(Format::Pcd, binary).unwrap(), expected);
    // Columns; the first, nine nines, as a literal and an overlapping copy.
    let mut packed = vec![0, 9, 6 << 5, 0];
    for axis in 0..3 {
        packed.push(11);
        packed.extend(rows.iter().flat_map(|row| row[axis].to_le_bytes()));
    }
    let mut compressed = format!("{head}DATA binary_compressed\n").into_bytes();
    compressed.extend((packed.len() as u32).to_le_bytes());
    compressed.extend(45_u32.to_le_bytes());
    compressed.extend(&packed);
    assert_eq!(places(Format::Pcd, compressed.clone()).unwrap(), expected);
    let end = compressed.len();
    for spoilt in [end - 1, end - 30] {
        assert!(places(Format::Pcd, compressed[..spoilt].to_vec()).is_err());
    }
}

#[test]
fn text_files_of_other_programs_are_read() {
    for text in [
        "1,2,3\n4,5,6\n",
        "1 2 3\n\n4 5 6",
        "# by hand\nx;y;z\n1;2;3\n4;5;6\n",
        "time,z,\"y\",x\n0,3,2,1\n0,6,5,4\n",
        "//X Y Z\n1 2 3\n4 5 6\n",
        "\u{feff}x y z i\n1 2 3 0\n4 5 6 0\n",
    ] {
        let read = places(Format::Csv, text.into()).unwrap();
        assert_eq!(read, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "{text}");
    }
    assert!(places(Format::Csv, Vec::new()).unwrap().is_empty());
}

#[test]
fn errors_name_offset_and_content() {
    for (format, text, words) in [
        (
            Format::Csv,
            "a,b,c\n1,2,3\n",
            "byte 0: expected columns x_m, y_m and z_m, got \"a,b,c\"",
        ),
        (
            Format::Csv,
            "x,y,z\n1,2,3\n4,five,6\n",
            "byte 12: expected a number, got \"five\"",
        ),
        (
            Format::Xyz,
            "0,305;2,414;0,353\n",
            "byte 0: expected columns x_m, y_m and z_m, got \"0,305;2,414;0,353\"",
        ),
        (
            Format::Csv,
            "x;y;z\n0,305;2,414;0,353\n",
            "byte 6: expected a number, got \"0,305\"",
        ),
        (
            Format::Csv,
            "1,2\n",
            "expected a number, got \"the end of the line\"",
        ),
        (Format::Ply, "plyy\n", "byte 0: expected ply, got \"plyy\""),
        (
            Format::Ply,
            "ply\nformat ascii 1.0\nend_header\n",
            "expected an element vertex",
        ),
        (
            Format::Ply,
            "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nend_header\n",
            "expected a property y of the vertices",
        ),
        (
            Format::Ply,
            "ply\nformat binary_little_endian 1.0\nelement vertex 99999999999999999\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
            "expected 99999999999999999 vertices of 12 bytes, got 0 bytes",
        ),
        (
            Format::Pcd,
            "VERSION 0.7\nFIELDS a b\nSIZE 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n",
            "columns x, y and z",
        ),
        // Very many elements of zero bytes.
        (
            Format::Ply,
            "ply\nformat binary_little_endian 1.0\nelement nothing 999999999999999999\nend_header\n",
            "expected an element vertex",
        ),
        (
            Format::Pcd,
            "FIELDS x y z a\nSIZE 8 8 8 8\nTYPE F F F F\nCOUNT 1 1 1 9999999999999999999\nPOINTS 9999999999999999999\nDATA binary\n",
            "pcd: byte",
        ),
        (
            Format::Pcd,
            "what\n",
            "byte 0: expected a line of a PCD header, got \"what\"",
        ),
        (
            Format::Las,
            "LAS",
            "las: byte 0: expected a LAS or LAZ file",
        ),
    ] {
        let message = places(format, text.into()).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
}

/// Rows without finite positions are skipped and counted in every format that allows them.
#[test]
fn non_finite_rows_are_skipped_and_counted() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\nnan nan nan\n4 inf 6\n7 8 9\n";
    let pcd = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA ascii\n1 2 3\nnan nan nan\n4 inf 6\n7 8 9\n";
    let csv = "x,y,z\n1,2,3\nnan,NaN,nan\n4,inf,6\n7,8,9\n";
    let mut binary = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n".to_vec();
    for value in [
        1.0,
        2.0,
        3.0,
        f32::NAN,
        0.0,
        0.0,
        4.0,
        f32::INFINITY,
        6.0,
        7.0,
        8.0,
        9.0_f32,
    ] {
        binary.extend(value.to_le_bytes());
    }
    for (format, bytes) in [
        (Format::Ply, ply.into()),
        (Format::Ply, binary),
        (Format::Pcd, pcd.into()),
        (Format::Csv, csv.into()),
    ] {
        let read = positions(format, bytes).unwrap();
        assert_eq!(
            read.positions,
            [[1.0, 2.0, 3.0], [7.0, 8.0, 9.0]],
            "{format}"
        );
        assert_eq!(read.without_numbers, 2, "{format}");
    }
}

/// Times count from the first one that is there: a f32 has steps of 128 s at 1.7e9 s.
#[test]
fn times_count_from_the_first_that_is_known() {
    let text = "x,y,z,time\n1,2,3,\n4,5,6,1700000000.25\n7,8,9,1700000001\n0,0,1,nan\n";
    let read = super::cloud(Format::Csv, text.into(), Fields::TIME).unwrap();
    assert_eq!(read.columns, [(Column::Time, vec![0.0, 0.0, 0.75, 0.0])]);
}

#[test]
fn columns_of_other_programs_are_found_by_their_names() {
    let ply = |header: &str, data: &[u8]| {
        let head = format!("ply\nformat {header}\nend_header\n");
        [head.as_bytes(), data].concat()
    };
    let text = "ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty float scalar_Intensity\nproperty double scalar_GpsTime";
    // The row without numbers has neither values nor the first time.
    let rows = b"nan nan nan 9 9 9\n1 2 3 0 0.5 1000.25\n4 5 6 0 nan 1000.75\n";
    let read = whole(Format::Ply, ply(text, rows)).unwrap();
    assert_eq!(read.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!(read.without_numbers, 1);
    let expected: [(&str, &[f32]); 2] = [("intensity", &[0.5, 0.0]), ("time", &[0.0, 0.5])];
    assert_eq!(named(&read), expected);

    let binary = "binary_big_endian 1.0\nelement vertex 1\nproperty ushort ring\nproperty float x\nproperty float y\nproperty float z\nproperty int reflectivity";
    let mut data = 7_u16.to_be_bytes().to_vec();
    data.extend(
        [1.0_f32, 2.0, 3.0]
            .iter()
            .flat_map(|axis| axis.to_be_bytes()),
    );
    data.extend(40_000_i32.to_be_bytes());
    let read = whole(Format::Ply, ply(binary, &data)).unwrap();
    let expected: [(&str, &[f32]); 2] = [("intensity", &[40_000.0]), ("ring", &[7.0])];
    assert_eq!(named(&read), expected);

    // A time of whole numbers is Ouster's; a vector is no number.
    let pcd = "VERSION .7\nFIELDS x y z ring t intensity\nSIZE 4 4 4 1 4 4\nTYPE F F F U U F\nCOUNT 1 1 1 3 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 3 7 8 9 500000000 12.5\n4 5 6 7 8 9 2000000000 13.5\n";
    let read = whole(Format::Pcd, pcd.into()).unwrap();
    let expected: [(&str, &[f32]); 2] = [("intensity", &[12.5, 13.5]), ("time", &[0.0, 1.5])];
    assert_eq!(named(&read), expected);

    // An index without a name, an empty word, and a word that is no number.
    let csv = ",X,Y,\"Z\",Intensity,Timestamp\n0,1,2,3,,100\n1,4,5,6,high,102\n2,7,8,9,5,101\n";
    let read = whole(Format::Csv, csv.into()).unwrap();
    assert_eq!(read.positions.last(), Some(&[7.0, 8.0, 9.0]));
    let expected: [(&str, &[f32]); 2] =
        [("intensity", &[0.0, 0.0, 5.0]), ("time", &[0.0, 2.0, 1.0])];
    assert_eq!(named(&read), expected);
}

#[test]
fn columns_of_compressed_pcd_are_found() {
    let head = "FIELDS x y z intensity\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary_compressed\n";
    let mut packed = Vec::new();
    for axis in [[1.0_f32, 4.0], [2.0, 5.0], [3.0, 6.0]] {
        packed.push(7);
        packed.extend(axis.iter().flat_map(|axis| axis.to_le_bytes()));
    }
    packed.extend([1, 8, 9]);
    let mut bytes = head.as_bytes().to_vec();
    bytes.extend((packed.len() as u32).to_le_bytes());
    bytes.extend(26_u32.to_le_bytes());
    bytes.extend(packed);
    let read = whole(Format::Pcd, bytes).unwrap();
    assert_eq!(read.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    let expected: [(&str, &[f32]); 1] = [("intensity", &[8.0, 9.0])];
    assert_eq!(named(&read), expected);
}

/// Points without bytes would not end.
#[test]
fn axes_of_no_bytes_are_refused() {
    let pcd = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 0 0 0\nPOINTS 9999999999999999\nDATA binary_compressed\n\0\0\0\0\0\0\0\0";
    assert!(whole(Format::Pcd, pcd.into()).is_err());
}

/// Point format 1 of LAS 1.2, as airborne scanners write it.
#[test]
fn las_of_other_programs_keeps_intensity_time_and_the_last_return() {
    let written = |intensity: u16| {
        let mut builder = ::las::Builder::from((1, 2));
        builder.point_format = ::las::point::Format::new(1).unwrap();
        let output = Cursor::new(Vec::new());
        let mut writer = ::las::Writer::new(output, builder.into_header().unwrap()).unwrap();
        for (return_number, number_of_returns, time) in [(1, 2, 10.0), (2, 2, 10.0), (1, 1, 11.5)] {
            let point = ::las::Point {
                x: time,
                intensity,
                return_number,
                number_of_returns,
                gps_time: Some(time),
                ..::las::Point::default()
            };
            writer.write_point(point).unwrap();
        }
        writer.into_inner().unwrap().into_inner()
    };
    let read = whole(Format::Las, written(40_000)).unwrap();
    let expected: [(&str, &[f32]); 3] = [
        ("intensity", &[40_000.0; 3]),
        ("time", &[0.0, 0.0, 1.5]),
        ("echo", &[0.0, 2.0, 0.0]),
    ];
    assert_eq!(named(&read), expected);
    // LAS writes zeros for what is not there.
    let read = whole(Format::Las, written(0)).unwrap();
    assert_eq!(named(&read), &expected[1..]);
}

/// Two scans of another program: times count from each scan's beginning, a column that the second
/// lacks is none, and rows of a grid are no rings. The second has ranges and directions, and a
/// pose.
#[test]
fn scans_of_e57_are_joined_by_what_they_share() {
    use ::e57::{
        DateTime, E57Writer, Quaternion, Record, RecordDataType as Kind, RecordName as Name,
        RecordValue, Transform, Translation,
    };
    let kind = Kind::Double {
        min: None,
        max: None,
    };
    let record = |name| Record {
        name,
        data_type: kind.clone(),
    };
    let mut output = Cursor::new(Vec::new());
    let mut file = E57Writer::new(&mut output, "file").unwrap();
    let first = [
        Name::CartesianX,
        Name::CartesianY,
        Name::CartesianZ,
        Name::TimeStamp,
        Name::Intensity,
    ];
    let second = [
        Name::SphericalRange,
        Name::SphericalAzimuth,
        Name::SphericalElevation,
        Name::TimeStamp,
    ];
    let rows: [(&[Name], f64, [f64; 5]); 2] = [
        (&first, 1_000.0, [1.0, 2.0, 3.0, 0.25, 0.5]),
        (
            &second,
            1_060.0,
            [2.0, 0.0, std::f64::consts::FRAC_PI_6, 0.5, 0.0],
        ),
    ];
    for (names, start_s, values) in rows {
        let mut prototype: Vec<Record> = names.iter().cloned().map(record).collect();
        prototype.push(Record {
            name: Name::RowIndex,
            data_type: Kind::Integer { min: 0, max: 3_000 },
        });
        prototype.push(Record {
            name: Name::ColumnIndex,
            data_type: Kind::Integer { min: 0, max: 3_000 },
        });
        let mut scan = file.add_pointcloud("scan", prototype).unwrap();
        let mut values: Vec<RecordValue> = values.map(RecordValue::Double).into();
        values.truncate(names.len());
        values.extend([RecordValue::Integer(7), RecordValue::Integer(7)]);
        scan.add_point(values).unwrap();
        scan.set_acquisition_start(Some(DateTime {
            gps_time: start_s,
            atomic_reference: false,
        }));
        if start_s > 1_000.0 {
            // A quarter turn about z.
            let half = std::f64::consts::FRAC_1_SQRT_2;
            let (w, x, y, z) = (half, 0.0, 0.0, half);
            let rotation = Quaternion { w, x, y, z };
            let (x, y, z) = (10.0, 20.0, 30.0);
            let translation = Translation { x, y, z };
            scan.set_transform(Some(Transform {
                rotation,
                translation,
            }));
        }
        scan.finalize().unwrap();
    }
    file.finalize().unwrap();
    drop(file);
    let read = whole(Format::E57, output.into_inner()).unwrap();
    let expected = [[1.0, 2.0, 3.0], [10.0, 20.0 + 3.0_f64.sqrt(), 31.0]];
    assert_eq!(read.positions.len(), 2);
    for (got, expected) in read
        .positions
        .as_flattened()
        .iter()
        .zip(expected.as_flattened())
    {
        assert!((got - expected).abs() < 1e-12, "{got} {expected}");
    }
    let expected: [(&str, &[f32]); 1] = [("time", &[0.0, 60.25])];
    assert_eq!(named(&read), expected);
}
