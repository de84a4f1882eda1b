use std::io::Cursor;

use mcap::MessageStream;
use proptest::prelude::*;
use units::Metres;

use crate::mount::Mount;

use super::*;
use crate::tests::samples::{self, NOW_NS, SharedOutput, SmallDisk, cloud_from, metadata};
use crate::{DiagnosticLevel, Point};

const MS: i64 = 1_000_000;

fn at(after_ns: i64) -> Stamp<Host> {
    Stamp::from_nanos(NOW_NS + after_ns)
}

/// Points at these nanoseconds after the start.
fn points(after_ns: impl IntoIterator<Item = i64>) -> Points {
    let mut points = Points::new(Fields::FILE);
    for after in after_ns {
        points.push(Point {
            position_m: [after as f64, 1.0, 2.0],
            time: at(after),
            ..Point::default()
        });
    }
    points
}

/// Two sweeps, 0..100 ms and 150..250 ms, and a sample per millisecond from 10 ms before to 10 ms
/// after.
fn track() -> TiltTrack {
    TiltTrack {
        mount: Some(Mount::new(Metres(0.06))),
        samples: (-10..=260)
            .map(|ms| (at(ms * MS), Degrees(ms as f64 / 10.0)))
            .collect(),
        sweeps: vec![(at(0), at(100 * MS)), (at(150 * MS), at(250 * MS))],
    }
}

fn diagnostics() -> Vec<Diagnostic> {
    vec![Diagnostic {
        name: "clock".into(),
        level: DiagnosticLevel::Warn,
        message: "a step".into(),
        values: vec![("by".into(), "1 s".into())],
    }]
}

struct Read {
    topic: String,
    log_ns: i64,
    data: Vec<u8>,
}

fn read(bytes: &[u8]) -> Vec<Read> {
    let messages = MessageStream::new(bytes).unwrap();
    messages
        .map(|message| {
            let message = message.unwrap();
            let channel = &message.channel;
            assert_eq!(channel.message_encoding, "cdr");
            let schema = channel.schema.as_ref().unwrap();
            assert_eq!(schema.encoding, "ros2msg");
            Read {
                topic: channel.topic.clone(),
                log_ns: message.log_time as i64 - NOW_NS,
                data: message.data.to_vec(),
            }
        })
        .collect()
}

/// Log time and points of each cloud.
fn clouds(messages: &[Read]) -> Vec<(i64, u32)> {
    messages
        .iter()
        .filter(|m| m.topic == "/velomotion/points")
        .map(|m| {
            // After the stamp: a string, then height and width.
            let frame = u32::from_le_bytes(m.data[12..16].try_into().unwrap()) as usize;
            let width = (16 + frame).next_multiple_of(4) + 4;
            let width = u32::from_le_bytes(m.data[width..width + 4].try_into().unwrap());
            (m.log_ns, width)
        })
        .collect()
}

fn written(
    writer: McapWriter<Cursor<Vec<u8>>>,
    track: Option<&TiltTrack>,
    batches: &[Points],
) -> Vec<u8> {
    let mut writer = writer;
    writer.begin(&metadata()).unwrap();
    if let Some(track) = track {
        writer.tilt(track).unwrap();
    }
    for batch in batches {
        writer.points(batch).unwrap();
        writer.revolution(&Revolution::default()).unwrap();
    }
    writer.diagnostics(&diagnostics()).unwrap();
    writer.finish().unwrap();
    writer.into_inner().unwrap().into_inner()
}

fn new() -> McapWriter<Cursor<Vec<u8>>> {
    McapWriter::new(Cursor::new(Vec::new()), Fields::FILE)
}

#[test]
fn clouds_per_sweep_are_independent_of_batches() {
    let all: Vec<i64> = (0..=100).chain(150..=250).map(|ms| ms * MS).collect();
    for batch in [7, 101, 1000] {
        let batches: Vec<Points> = all
            .chunks(batch)
            .map(|c| points(c.iter().copied()))
            .collect();
        let messages = read(&written(new(), Some(&track()), &batches));
        assert_eq!(
            clouds(&messages),
            [(100 * MS, 101), (250 * MS, 101)],
            "{batch}"
        );
    }
}

#[test]
fn georeferenced_clouds_are_in_the_frame_map() {
    let metadata = Metadata {
        east_north_up: Some(EastNorthUp::new(Degrees(90.0))),
        ..metadata()
    };
    let mut writer = new();
    writer.begin(&metadata).unwrap();
    writer.points(&points([0, 5])).unwrap();
    let summary = writer.finish().unwrap();
    // Forward, 1 m, is east, and right, 0 to 5 m, is south.
    let expected = [[1.0, 0.0, 2.0], [1.0, -5.0, 2.0]];
    assert!((summary.bounds.unwrap().max_m[0] - 1.0).abs() < 1e-12);
    let bytes = writer.into_inner().unwrap().into_inner();
    let fixed = &read(&bytes)[0];
    assert_eq!(fixed.topic, "/tf_static");
    for frame in [&b"map\0"[..], b"base_link\0"] {
        let names = |window: &[u8]| window == frame;
        assert!(fixed.data.windows(frame.len()).any(names));
    }
    let stored = crate::read::cloud(crate::formats::Format::Mcap, bytes, Fields::NONE).unwrap();
    for (position, expected) in stored.positions.iter().zip(expected) {
        for (got, expected) in position.iter().zip(expected) {
            assert!((got - expected).abs() < 1e-6, "{position:?}");
        }
    }
    assert_eq!(stored.positions.len(), 2);
}

#[test]
fn revolutions_split_clouds() {
    let batches = [
        points([0, MS]),
        points([]),
        points([2 * MS, 120 * MS, 160 * MS]),
    ];
    let messages = read(&written(new().by_revolution(), Some(&track()), &batches));
    assert_eq!(clouds(&messages), [(MS, 2), (160 * MS, 3)]);
}

#[test]
fn messages_are_complete_and_sorted_by_time() {
    let track = track();
    let batches = [
        points((0..=100).map(|ms| ms * MS)),
        points((150..=250).map(|ms| ms * MS)),
    ];
    let messages = read(&written(new(), Some(&track), &batches));
    assert!(messages.is_sorted_by_key(|m| m.log_ns));
    let count = |topic: &str| messages.iter().filter(|m| m.topic == topic).count();
    assert_eq!(count("/joint_states"), track.samples.len());
    // Every 5 ms of 270, both ends included.
    assert_eq!(count("/tf"), 55);
    assert_eq!((count("/tf_static"), count("/diagnostics")), (1, 1));
    assert_eq!(messages[0].topic, "/tf_static");
    assert_eq!(messages.last().unwrap().topic, "/diagnostics");
}

#[test]
fn long_clouds_continue_in_further_messages() {
    // By number.
    let most = MOST_POINTS as i64;
    let batches: Vec<Points> = (0..9)
        .map(|i| points(i * most / 4..(i + 1) * most / 4))
        .collect();
    let messages = read(&written(new(), None, &batches));
    let sizes: Vec<u32> = clouds(&messages).iter().map(|c| c.1).collect();
    assert_eq!(sizes, [MOST_POINTS, MOST_POINTS, MOST_POINTS / 4]);
    // By time.
    let batch = points((0..20).map(|s| s * 1000 * MS));
    let messages = read(&written(new(), None, &[batch]));
    let sizes: Vec<u32> = clouds(&messages).iter().map(|c| c.1).collect();
    assert_eq!(sizes, [9, 9, 2]);
}

#[test]
fn a_fixed_platform_has_no_frame_that_tilts() {
    let messages = read(&written(new(), None, &[points([0])]));
    let topics: Vec<&str> = messages.iter().map(|m| m.topic.as_str()).collect();
    assert_eq!(topics, ["/tf_static", "/velomotion/points", "/diagnostics"]);
    let contains =
        |message: &Read, text: &[u8]| message.data.windows(text.len()).any(|w| w == text);
    assert!(contains(&messages[1], b"base_link\0") && !contains(&messages[0], b"tilt"));
    assert!(contains(&messages[0], b"base_link\0") && contains(&messages[0], b"lidar\0"));
}

#[test]
fn an_empty_cloud_is_a_valid_file() {
    let bytes = written(new(), None, &[]);
    assert!(read(&bytes).is_empty());
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.stats.unwrap().message_count, 0);
}

#[test]
fn files_name_their_source_and_are_reproducible() {
    let cloud = cloud_from(1000, NOW_NS);
    let bytes = written(new(), Some(&track()), std::slice::from_ref(&cloud));
    assert_eq!(bytes, written(new(), Some(&track()), &[cloud]));
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.channels.len(), 5);
    let names: Vec<&str> = summary
        .metadata_indexes
        .iter()
        .map(|m| m.name.as_str())
        .collect();
    assert_eq!(names, ["velomotion", "rosbag2"]);
    assert!(bytes.windows(4).any(|w| w == b"ros2"));
    assert!(bytes.windows(10).any(|w| w == b"SIMULATED:"));
}

#[test]
fn metadata_yaml_counts_what_was_written() {
    let mut writer = new();
    writer.begin(&metadata()).unwrap();
    assert!(writer.companion("a.mcap").is_none());
    writer.tilt(&track()).unwrap();
    writer.points(&points([0, MS])).unwrap();
    writer.finish().unwrap();
    let companion = writer.companion("sc\"an.mcap").unwrap();
    assert_eq!(companion.name, "metadata.yaml");
    for line in [
        "  message_count: 328",
        "    nanoseconds: 270000000",
        "    nanoseconds_since_epoch: 1795226732990000000",
        "        name: /joint_states",
        "      message_count: 271",
        r#"    - "sc\"an.mcap""#,
    ] {
        assert!(
            companion.text.lines().any(|l| l == line),
            "{line} in {}",
            companion.text
        );
    }
}

/// The library cannot continue after its output failed: it must neither panic nor report success.
#[test]
fn a_full_disk_is_an_error_at_every_byte_and_never_a_panic() {
    let cloud = cloud_from(50, NOW_NS);
    let whole = written(new(), Some(&track()), std::slice::from_ref(&cloud)).len() as u64;
    for room in (0..=whole + 10).step_by(7) {
        let mut writer = McapWriter::new(SmallDisk::new(room), Fields::FILE);
        let result = writer
            .begin(&metadata())
            .and_then(|()| writer.tilt(&track()))
            .and_then(|()| writer.points(&cloud))
            .and_then(|()| writer.diagnostics(&diagnostics()))
            .and_then(|()| writer.finish());
        match result {
            Ok(summary) => assert!(summary.points == 50 && room >= whole, "{room} of {whole}"),
            Err(error) => assert!(
                matches!(error, SinkError::Write { .. }) && room < whole,
                "{room} of {whole}: {error}"
            ),
        }
    }
}

#[test]
fn an_aborted_file_has_its_complete_chunks() {
    let file = SharedOutput::default();
    let mut writer = McapWriter::new(file.clone(), Fields::FILE);
    writer.begin(&metadata()).unwrap();
    writer.tilt(&track()).unwrap();
    let mut before = 0;
    for i in 0..20 {
        // After the sweeps, the cloud continues in further messages.
        let batch = points((0..20_000).map(|k| (i * 1000 + 300) * MS + k * 40_000));
        writer.points(&batch).unwrap();
        before = file.content().len();
    }
    let mut left = file.content();
    left.truncate(before);
    std::mem::forget(writer);
    let messages: Vec<_> =
        MessageStream::new_with_options(&left, mcap::read::Options::IgnoreEndMagic.into())
            .unwrap()
            .map_while(Result::ok)
            .collect();
    let clouds = messages
        .iter()
        .filter(|m| m.channel.topic == "/velomotion/points");
    assert_eq!(clouds.count(), 1);
}

#[test]
fn times_out_of_range_are_refused_and_earlier_batches_kept() {
    let mut writer = new();
    writer.begin(&metadata()).unwrap();
    writer.points(&points([0, 1])).unwrap();
    let mut nowhere = points([2]);
    nowhere.push(Point {
        position_m: [f64::NAN; 3],
        time: at(3),
        ..Point::default()
    });
    let error = writer.points(&nowhere).unwrap_err();
    assert!(
        matches!(
            error,
            SinkError::Coordinate {
                point: 3,
                axis: 'x',
                ..
            }
        ),
        "{error}"
    );
    assert_eq!(writer.finish().unwrap().points, 2);
    assert_eq!(
        clouds(&read(&writer.into_inner().unwrap().into_inner())),
        [(1, 2)]
    );

    let mut writer = new();
    writer.begin(&metadata()).unwrap();
    let error = writer.points(&samples::cloud(1)).unwrap_err();
    assert!(error.to_string().contains("2038"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// At any times, each point is in one cloud, and no cloud exceeds its time span.
    #[test]
    fn no_point_is_lost_or_duplicated(
        after in prop::collection::vec(-20_000 * MS..40_000 * MS, 0..300),
        batch in 1_usize..50,
        turns in any::<bool>(),
    ) {
        let batches: Vec<Points> = after.chunks(batch).map(|c| points(c.iter().copied())).collect();
        let writer = if turns { new().by_revolution() } else { new() };
        let messages = read(&written(writer, Some(&track()), &batches));
        let total: u32 = clouds(&messages).iter().map(|c| c.1).sum();
        prop_assert_eq!(total as usize, after.len());
        prop_assert!(messages.is_sorted_by_key(|m| m.log_ns));
    }
}
