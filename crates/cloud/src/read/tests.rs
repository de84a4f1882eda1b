use super::*;

/// The positions of a file, without its counts.
fn places(format: Format, bytes: Vec<u8>) -> Result<Positions, ReadError> {
    positions(format, bytes).map(|read| read.positions)
}
use crate::tests::samples::{SharedOutput, cloud_from, metadata};
use crate::{Fields, Sink};

/// Points of a day that every format can represent: ROS 2 ends in 2038.
fn cloud(count: u32) -> crate::Points {
    cloud_from(count, 1_700_000_000_000_000_000)
}

fn written(format: Format, points: &crate::Points) -> Vec<u8> {
    let output = SharedOutput::default();
    let mut writer = format.writer(output.clone(), Fields::FILE);
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
        let read = places(format, bytes).unwrap();
        assert_eq!(read.len(), points.len());
        // f32 at 100 m; 0.1 mm steps; shortest decimals.
        let most = match format {
            Format::Ply | Format::Pcd | Format::E57 | Format::Mcap | Format::Kitti => 4e-6,
            Format::Las | Format::Laz => 0.51e-4,
            Format::Csv | Format::Xyz => 0.0,
        };
        let off = (points.x_m().iter().zip(points.y_m()).zip(points.z_m()))
            .zip(&read)
            .map(|(((x, y), z), [a, b, c])| (x - a).abs().max((y - b).abs()).max((z - c).abs()));
        let off = off.fold(0.0, f64::max);
        assert!(off <= most, "{format}: {off}");
    }
}

#[test]
fn every_prefix_of_a_file_is_an_error_or_its_first_points() {
    let points = cloud(5);
    for format in Format::ALL {
        let bytes = written(format, &points);
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
        let bytes = written(format, &points);
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
