//! Frames of a tilting scan: all of its points by revolution, and organised clouds with empty
//! shots.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use engine::reconstruct::frames::FramePlan;
use engine::reconstruct::replay::TimeReference;
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::report::ScanReport;
use engine::reconstruct::source::Source;
use scanner::TiltSource;
use units::Degrees;
use velomotion_tests::capture::{Captured, Setting};

fn frames(log: &Path, output: &Path, organised: bool) -> ScanReport {
    let request = Reconstruction {
        recording: &Source::open(log, None).unwrap(),
        tilt: TiltSource::Log,
        options: lidar::Options::default(),
        time: TimeReference::Host,
        accuracy: scanner::Accuracy::Best,
        pace: None,
        truth: None,
        live: false,
        lost_records: 0,
        georeference: None,
        interrupt: &AtomicBool::new(false),
    };
    let plan = FramePlan {
        cut: Degrees(90.0),
        organised,
        fields: cloud::Fields::FILE,
        output: output.to_owned(),
        force: false,
    };
    replay::frames(&request, &plan).unwrap()
}

/// The clouds in a folder by number: header up to `mark`, and the data behind it.
fn clouds(folder: &Path, mark: &str) -> Vec<(String, Vec<u8>)> {
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    let parted = |path: &std::path::PathBuf| {
        let bytes = std::fs::read(path).unwrap();
        let at = bytes
            .windows(mark.len())
            .position(|window| window == mark.as_bytes())
            .unwrap()
            + mark.len();
        let head = String::from_utf8(bytes[..at].to_vec()).unwrap();
        (head, bytes[at..].to_vec())
    };
    paths.iter().map(parted).collect()
}

#[test]
fn frames_contain_the_whole_cloud_in_order() {
    let captured = Captured::new(Setting::default());
    let whole = std::fs::read(captured.cloud_file("whole.ply")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let scan = frames(&captured.log(), &folder.path().join("turn.ply"), false);
    let clouds = clouds(folder.path(), "end_header\n");
    // 0.81 s at 10 Hz, cut at any azimuth.
    assert!((9..=10).contains(&clouds.len()), "{}", clouds.len());
    assert_eq!(scan.clouds, Some(clouds.len() as u64));
    let rows: Vec<u8> = clouds.into_iter().flat_map(|(_, rows)| rows).collect();
    assert_eq!(rows.len() as u64, 29 * scan.points);
    let cloud = &whole[whole.len() - rows.len()..];
    let mut rounded = 0;
    for (a, b) in cloud.chunks(29).zip(rows.chunks(29)) {
        // x, y, z; intensity, ring, time; tilt. Frames are placed point by point, the cloud in
        // blocks: a nanometre may round a coordinate to the neighbouring f32.
        assert_eq!(a[12..25], b[12..25], "the frames differ from the cloud");
        for at in [0, 4, 8, 25] {
            let bits = |row: &[u8]| u32::from_le_bytes(row[at..at + 4].try_into().unwrap());
            // Near zero a nanometre is many steps of an f32.
            let apart = (f32::from_bits(bits(a)) - f32::from_bits(bits(b))).abs();
            assert!(
                bits(a).abs_diff(bits(b)) <= 1 || apart <= 2e-9,
                "the frames differ from the cloud by {apart} at byte {at}"
            );
            rounded += u32::from(bits(a) != bits(b));
        }
    }
    assert!(rounded < 100, "{rounded}");
}

#[test]
fn organised_frames_keep_every_shot() {
    let captured = Captured::new(Setting::default());
    let folder = tempfile::tempdir().unwrap();
    let scan = frames(&captured.log(), &folder.path().join("turn.pcd"), true);
    let mut returns = 0;
    for (head, rows) in clouds(folder.path(), "DATA binary\n") {
        let number = |name: &str| -> usize {
            let line = head.lines().find(|line| line.starts_with(name)).unwrap();
            line[name.len()..].trim().parse().unwrap()
        };
        let (width, height) = (number("WIDTH"), number("HEIGHT"));
        assert_eq!((height, rows.len()), (16, 29 * 16 * width));
        for (i, row) in rows.chunks(29).enumerate() {
            let float = |at: usize| f32::from_le_bytes(row[at..at + 4].try_into().unwrap());
            assert_eq!(
                usize::from(row[16]),
                i / width,
                "row by row from the lowest ring"
            );
            let finite = float(0).is_finite();
            assert_eq!(finite, float(4).is_finite() && float(8).is_finite());
            returns += u64::from(finite);
        }
    }
    assert_eq!(returns, scan.points);
}
