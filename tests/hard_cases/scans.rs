//! Whole scans at the limits of numbers.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use cloud::{Fields, Points};
use engine::failure::Failure;
use engine::reconstruct::frames::FramePlan;
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::report::ScanReport;
use engine::reconstruct::source::Source;
use firmware_sim::epos2::Servo;
use io::log::{LogConfig, LogWriter};
use io::recording::Recording;
use protocol::record::{Record, Wire};
use scanner::TiltSource;
use sim::Attachment;
use units::{DegPerS2, Degrees, Span, Stamp};
use velomotion_tests::capture::{Captured, Setting};

/// 2100-01-01 00:00:00 UTC during the sweep: nanoseconds over 2^61, where a double steps by half a
/// microsecond. The same scan some whole hours earlier gives the same points.
#[test]
fn a_scan_into_the_year_2100_equals_one_of_today() {
    let now = Setting::default();
    let midnight = 4_102_444_800_000_000_000;
    let hour = 3_600_000_000_000;
    let (from, to) = Captured::new(now).sweep_span();
    let middle = from + (to - from).half() - now.start;
    let then = Stamp::from_nanos(midnight) - middle;
    let before = Stamp::from_nanos(then.as_nanos() - hour * 24 * 365 * 50);
    let [then, before] = [then, before].map(|start| Captured::new(Setting { start, ..now }));
    let error = then.error();
    assert!(error.points > 180_000 && error.worst_m < 10e-3, "{error:?}");
    let (then, before) = (then.cloud(), before.cloud());
    assert!(then.time().first().unwrap().as_nanos() < midnight);
    assert!(then.time().last().unwrap().as_nanos() > midnight);
    assert_eq!(then.len(), before.len());
    for (a, b) in then.positions().zip(before.positions()) {
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }
}

/// From one limit of the axis to the other and back with a servo that overshoots. The drive accepts
/// targets at its limits, samples outside them are not faults, and the points at both ends are
/// correct.
#[test]
fn scans_between_both_tilt_limits_are_accurate() {
    for attached in [Attachment::Usb, Attachment::Can] {
        let mut setting = Setting::over(attached);
        setting.sweep_request.acceleration = DegPerS2(500.0);
        setting.sweep_request.sweeps = 2;
        setting.sweep_request.both_ways = true;
        setting.servo = Some(Servo::SecondOrder {
            natural_millihertz: 15_000,
            damping_permille: 400,
        });
        let captured = Captured::new(setting);
        let (scan, cloud) = captured.scan();
        assert_eq!(scan.sweeps.len(), 2, "{attached:?}");
        for limit in [Degrees(-45.0), Degrees(0.0)] {
            let near = cloud.iter().filter(|p| (p.tilt.0 - limit.0).abs() < 0.01);
            assert!(near.count() > 1_000, "{attached:?}: {limit:?}");
        }
        let outside = |p: &cloud::Point| p.tilt.0 < -45.02 || p.tilt.0 > 0.02;
        let outside = cloud.iter().filter(outside).count();
        assert!(
            outside > 100,
            "{attached:?}: {outside} points beyond the limits"
        );
        let error = captured.error();
        assert!(error.worst_m < 10e-3 && error.rms_m < 2e-3, "{error:?}");
    }
}

/// A log that ends within a sweep, as after a power failure: its points are as accurate as in the
/// whole log, their uncertainty is no smaller, and the report says that the sweep was cut short.
#[test]
fn logs_that_end_in_mid_sweep_give_a_cloud() {
    for attached in [Attachment::Usb, Attachment::Can] {
        let captured = Captured::new(Setting::over(attached));
        let (from, to) = captured.sweep_span();
        let (_, whole) = captured.scan();
        for part in [0.2, 0.6] {
            let end = from + Span::from_secs_f64((to - from).as_secs_f64() * part);
            let folder = tempfile::tempdir().unwrap();
            let log = folder.path().join("cut.pcapng");
            std::fs::write(&log, cut(&captured.log(), end)).unwrap();
            let (scan, cloud) = scan(&log);
            let truth =
                |time: Stamp<units::Lidar>, laser| captured.truth().point(time.as_nanos(), laser);
            let error = analysis::truth::compare(&cloud, truth).unwrap();
            let share = cloud.len() as f64 / whole.len() as f64;
            println!(
                "{attached:?} {part}: {error:?}, {share:.3}, {:?}",
                scan.contents.warnings
            );
            assert!(share > part - 0.05, "{attached:?} {part}: {share}");
            assert!(error.rms_m < 2e-3 && error.worst_m < 10e-3, "{error:?}");
            let mean_sd = |cloud: &Points| cloud.sd_m().iter().sum::<f64>() / cloud.len() as f64;
            assert!(mean_sd(&cloud) > 0.9 * mean_sd(&whole));
            assert!(
                scan.contents
                    .warnings
                    .iter()
                    .any(|w| w.contains("cut short")),
                "{attached:?} {part}: {:?}",
                scan.contents.warnings
            );
        }
    }
}

/// The bytes of a log up to its last record before `end`.
fn cut(log: &Path, end: Stamp<units::Host>) -> Vec<u8> {
    let bytes = std::fs::read(log).unwrap();
    // Enhanced packet blocks (pcapng, 4.3): type, length, interface, time in two words, of
    // nanoseconds here.
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let mut at = 0;
    while at + 12 <= bytes.len() {
        if word(at) == 6 {
            let ns = u64::from(word(at + 12)) << 32 | u64::from(word(at + 16));
            if ns as i64 > end.as_nanos() {
                break;
            }
        }
        at += word(at + 4) as usize;
    }
    assert!(at < bytes.len());
    bytes[..at].to_vec()
}

/// A recorder that drops replies of the drive: a single one in mid-sweep, one in twenty, or those
/// to the writes that begin the sweep. The cloud loses no points and no accuracy.
#[test]
fn logs_without_some_replies_of_the_drive_give_the_whole_cloud() {
    for attached in [Attachment::Usb, Attachment::Rs232, Attachment::Can] {
        let captured = Captured::new(Setting::over(attached));
        let (from, to) = captured.sweep_span();
        let (_, whole) = captured.scan();
        let middle = from + (to - from).half();
        let before = from + Span::from_millis(-60);
        let is_dropped = std::cell::Cell::new(false);
        let single = |at: Stamp<units::Host>, _: usize| at >= middle && !is_dropped.replace(true);
        let share = |_: Stamp<units::Host>, count: usize| count.is_multiple_of(20);
        let starting = |at: Stamp<units::Host>, count: usize| {
            (before..from).contains(&at) && count.is_multiple_of(2)
        };
        type Dropped<'a> = &'a dyn Fn(Stamp<units::Host>, usize) -> bool;
        let cases: [(&str, Dropped<'_>); 3] = [
            ("single", &single),
            ("one in twenty", &share),
            ("at the start", &starting),
        ];
        for (name, dropped) in cases {
            let folder = tempfile::tempdir().unwrap();
            let log = folder.path().join("lossy.pcapng");
            std::fs::write(&log, without_replies(&captured.log(), dropped)).unwrap();
            let (scan, cloud) = scan(&log);
            let truth =
                |time: Stamp<units::Lidar>, laser| captured.truth().point(time.as_nanos(), laser);
            let error = analysis::truth::compare(&cloud, truth).unwrap();
            let share = cloud.len() as f64 / whole.len() as f64;
            println!(
                "{attached:?} {name}: {error:?}, {share:.4}, {:?}",
                scan.contents.warnings
            );
            assert_eq!(scan.sweeps.len(), 1, "{attached:?} {name}");
            assert!((share - 1.0).abs() < 0.005, "{attached:?} {name}: {share}");
            assert!(
                error.rms_m < 2e-3 && error.worst_m < 10e-3,
                "{attached:?} {name}: {error:?}"
            );
        }
    }
}

/// The bytes of a log without the drive's replies for which `dropped` is true, given their time and
/// number.
fn without_replies(log: &Path, dropped: &dyn Fn(Stamp<units::Host>, usize) -> bool) -> Vec<u8> {
    let bytes = std::fs::read(log).unwrap();
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let mut kept = Vec::new();
    let (mut at, mut replies, mut lost) = (0, 0, 0);
    while at + 12 <= bytes.len() {
        let length = word(at + 4) as usize;
        // Interface 1 is the drive. The option epb_flags (2) follows the data; inbound is 1.
        let is_drive = word(at) == 6 && word(at + 8) == 1;
        let options = at + 28 + (word(at + 20) as usize).next_multiple_of(4);
        let is_reply = is_drive && word(options) == 2 | 4 << 16 && word(options + 4) & 3 == 1;
        let ns = u64::from(word(at + 12)) << 32 | u64::from(word(at + 16));
        replies += usize::from(is_reply);
        match is_reply && dropped(Stamp::from_nanos(ns as i64), replies) {
            true => lost += 1,
            false => kept.extend_from_slice(&bytes[at..at + length]),
        }
        at += length;
    }
    assert!(lost > 0, "no reply was dropped");
    kept
}

/// `cat`, and `mergecap`, which merges by time and appends the names of the files to the comment:
/// each log has its own clocks, zero and configuration, so that no cloud of two is right. A single
/// log that mergecap has copied is whole.
#[test]
fn logs_that_were_joined_are_refused_and_a_copy_is_not() {
    let captured = Captured::new(Setting::default());
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("joined.pcapng");
    let bytes = std::fs::read(captured.log()).unwrap();
    std::fs::write(&log, [&bytes[..], &bytes].concat()).unwrap();
    let refused = try_scan(&log).unwrap_err().message;
    let place = format!("a second one begins at byte {}", bytes.len());
    assert!(refused.contains(&place), "{refused}");
    let whole = captured.scan().1;
    for (files, is_whole) in [(1, true), (2, false)] {
        let mut comment = config_of(&captured.log());
        comment.push_str("\nFile created by merging: \n");
        (1..=files).for_each(|n| comment.push_str(&format!("File{n}: part-{n}.pcapng \n")));
        std::fs::write(&log, rewritten(&captured.log(), &comment, 0)).unwrap();
        match try_scan(&log) {
            Ok((_, cloud)) => assert!(is_whole && cloud.len() == whole.len()),
            Err(error) => assert!(!is_whole && error.message.contains("several")),
        }
    }
}

/// A recorder that writes stretches of packets twice, longer than what a decoder reorders.
#[test]
fn packets_that_were_recorded_twice_in_bursts_count_once() {
    let captured = Captured::new(Setting::default());
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("doubled.pcapng");
    let comment = config_of(&captured.log());
    std::fs::write(&log, rewritten(&captured.log(), &comment, 20)).unwrap();
    let (scan, cloud) = scan(&log);
    assert_eq!(cloud.len(), captured.scan().1.len());
    assert_eq!(scan.contents.lost_packets, 0);
    let warnings = &scan.contents.warnings;
    assert!(
        warnings.len() == 1 && warnings[0].contains("arrived twice"),
        "{warnings:?}"
    );
}

fn config_of(log: &Path) -> String {
    Recording::open(log).unwrap().metadata().unwrap().to_owned()
}

/// The lidar's clock is set back in mid-sweep by less than a packet's time, as where its receiver
/// regains the pulse. A decoder emits a packet when the next one arrives, so that the last one
/// before the step comes with the receive time of the first one after it.
#[test]
fn no_packet_is_misplaced_where_the_clock_of_the_lidar_is_set_back() {
    let captured = Captured::new(Setting::default());
    let whole = captured.scan().1;
    let (from, to) = captured.sweep_span();
    let middle = from + (to - from).half();
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("stepped.pcapng");
    for by_us in [100, 300, 1_200] {
        std::fs::write(&log, set_back(&captured.log(), middle, by_us)).unwrap();
        let (scan, cloud) = scan(&log);
        assert_eq!(
            scan.sync.steps.len(),
            1,
            "{by_us} us: {:?}",
            scan.sync.steps
        );
        assert_eq!(cloud.len(), whole.len(), "{by_us} us");
        let apart = cloud.positions().zip(whole.positions()).map(|(a, b)| {
            let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
            squares.sum::<f64>().sqrt()
        });
        let worst = apart.fold(0.0, f64::max);
        // A packet at the wrong time would be up to 20 mm off.
        assert!(worst < 0.3e-3, "{by_us} us: {worst}");
    }
}

/// The same for frames, whose points come from the packets of the cloud.
#[test]
fn frames_are_the_cloud_where_the_clock_of_the_lidar_is_set_back() {
    let captured = Captured::new(Setting::default());
    let (from, to) = captured.sweep_span();
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("stepped.pcapng");
    std::fs::write(
        &log,
        set_back(&captured.log(), from + (to - from).half(), 300),
    )
    .unwrap();
    let (_, cloud) = scan(&log);
    let shots = cloud.time().iter().zip(cloud.ring());
    let mut expected: Vec<_> = shots
        .map(|(time, ring)| (*ring, time.as_nanos() / 1_000))
        .collect();
    expected.sort_unstable();
    for (organised, output) in [(false, "plain/frame.pcd"), (true, "organised/frame.pcd")] {
        let output = folder.path().join(output);
        std::fs::create_dir(output.parent().unwrap()).unwrap();
        let plan = FramePlan {
            cut: Degrees(90.0),
            organised,
            fields: Fields::FILE,
            output: output.clone(),
            force: false,
        };
        let source = Source::open(&log, None).unwrap();
        let interrupt = AtomicBool::new(false);
        replay::frames(&request(&source, &interrupt), &plan).unwrap();
        let mut found: Vec<(u8, i64)> = Vec::new();
        for file in std::fs::read_dir(output.parent().unwrap()).unwrap() {
            let bytes = std::fs::read(file.unwrap().path()).unwrap();
            let mark = b"DATA binary\n";
            let at = bytes.windows(mark.len()).position(|text| text == mark);
            // x, y, z; intensity, ring, time; tilt.
            for row in bytes[at.unwrap() + mark.len()..].chunks(29) {
                if f32::from_le_bytes(row[..4].try_into().unwrap()).is_finite() {
                    let time_s = f64::from_le_bytes(row[17..25].try_into().unwrap());
                    found.push((row[16], (time_s * 1e6).floor() as i64));
                }
            }
        }
        found.sort_unstable();
        assert_eq!(found.len(), expected.len(), "organised: {organised}");
        for (found, expected) in found.iter().zip(&expected) {
            // A packet at the wrong time would be 300 us off; doubles of today step by 0.2 us.
            let apart_us = (found.1 - expected.1).abs();
            assert!(
                found.0 == expected.0 && apart_us <= 1,
                "organised: {organised}: {found:?}, {expected:?}"
            );
        }
    }
}

/// The bytes of a log whose lidar has set its clock back when a packet of time `at` is received.
fn set_back(log: &Path, at: Stamp<units::Host>, by_us: u32) -> Vec<u8> {
    let config = LogConfig {
        metadata: config_of(log),
        ..LogConfig::default()
    };
    let mut writer = LogWriter::new(Vec::new(), &config).unwrap();
    let mut recording = Recording::open(log).unwrap();
    while let Some(record) = recording.next_record().unwrap() {
        let Wire::Lidar {
            source,
            port,
            payload,
        } = record.wire
        else {
            writer.write(&record).unwrap();
            continue;
        };
        let mut payload = payload.to_vec();
        if payload.len() == 1206 && record.host >= at {
            let us = u32::from_le_bytes(payload[1200..1204].try_into().unwrap());
            // Microseconds of the hour.
            let us = match us.checked_sub(by_us) {
                Some(us) => us,
                None => us + 3_600_000_000 - by_us,
            };
            payload[1200..1204].copy_from_slice(&us.to_le_bytes());
        }
        let payload = &payload[..];
        let wire = Wire::Lidar {
            source,
            port,
            payload,
        };
        writer.write(&Record { wire, ..record }).unwrap();
    }
    writer.finish().unwrap().1
}

/// The bytes of a log with another comment, and with every stretch of `burst` data packets twice.
fn rewritten(log: &Path, comment: &str, burst: usize) -> Vec<u8> {
    let config = LogConfig {
        metadata: comment.to_owned(),
        ..LogConfig::default()
    };
    let mut writer = LogWriter::new(Vec::new(), &config).unwrap();
    let mut recording = Recording::open(log).unwrap();
    let mut stretch = Vec::new();
    while let Some(record) = recording.next_record().unwrap() {
        writer.write(&record).unwrap();
        if let Wire::Lidar {
            source,
            port,
            payload,
        } = record.wire
            && payload.len() == 1206
        {
            stretch.push((record.host, source, port, payload.to_vec()));
        }
        if burst > 0 && stretch.len() == burst {
            for (host, source, port, payload) in stretch.drain(..) {
                let payload = &payload[..];
                let wire = Wire::Lidar {
                    source,
                    port,
                    payload,
                };
                writer.write(&Record { host, wire }).unwrap();
            }
        }
    }
    writer.finish().unwrap().1
}

fn scan(log: &Path) -> (ScanReport, Points) {
    try_scan(log).unwrap()
}

fn try_scan(log: &Path) -> Result<(ScanReport, Points), Failure> {
    let mut points = Points::new(Fields::ALL);
    let source = Source::open(log, None).unwrap();
    let interrupt = AtomicBool::new(false);
    let request = request(&source, &interrupt);
    let scan = replay::scan(&request, &mut points, Path::new("memory"))?;
    Ok((scan, points))
}

fn request<'a>(recording: &'a Source, interrupt: &'a AtomicBool) -> Reconstruction<'a> {
    Reconstruction {
        recording,
        tilt: TiltSource::Log,
        options: lidar::Options::default(),
        time: engine::reconstruct::replay::TimeReference::Host,
        accuracy: scanner::Accuracy::Best,
        pace: None,
        truth: None,
        live: false,
        lost_records: 0,
        georeference: None,
        interrupt,
    }
}
