//! The live cloud: the same records one by one.

use cloud::{Fields, Points};
use engine::reconstruct::source::Source;
use io::recording::Recording;
use scanner::Live;
use sim::Attachment;
use units::Span;
use velomotion_tests::capture::{Captured, Setting};

/// Longest lag of the cloud behind the newest angle.
const MOST_LAG: Span = Span::from_millis(50);

#[test]
fn the_live_cloud_is_nearly_as_accurate_as_a_replay() {
    for attached in [
        Attachment::Usb,
        Attachment::Rs232,
        Attachment::Slcan,
        Attachment::Can,
    ] {
        let captured = Captured::new(Setting::over(attached));
        let (from, to) = captured.sweep_span();
        let mut recording = Recording::open(captured.log()).unwrap();
        let config = Source::open(&captured.log(), None)
            .unwrap()
            .config()
            .unwrap();
        let mut points = Points::new(Fields::ALL);
        let mut live = Live::new(&config, lidar::Options::default(), &mut points).unwrap();
        let mut most = Span::ZERO;
        while let Some(record) = recording.next_record().unwrap() {
            live.observe(&record).unwrap();
            if from < record.host && record.host < to {
                most = most.max(live.lag().unwrap());
            }
        }
        let (placed, _) = live.finish().unwrap();
        assert_eq!(placed.points, points.len() as u64);
        let truth = |time: units::Stamp<units::Lidar>, laser| {
            captured.truth().point(time.as_nanos(), laser)
        };
        let (live, offline) = (
            analysis::truth::compare(&points, truth).unwrap(),
            captured.error(),
        );
        println!(
            "{attached:?}: lag {:.1} ms; live rms {:.2} mm, worst {:.2} mm; replayed rms {:.2} mm, worst {:.2} mm",
            most.as_secs_f64() * 1e3,
            live.rms_m * 1e3,
            live.worst_m * 1e3,
            offline.rms_m * 1e3,
            offline.worst_m * 1e3
        );
        assert!(most < MOST_LAG, "{attached:?}: {most:?}");
        // With constant delays both are limited by the range's 2 mm: equal to 3 %, as the points at
        // the ends of the sweep differ.
        assert!(
            offline.rms_m <= live.rms_m * 1.03 && offline.worst_m <= live.worst_m,
            "{attached:?}"
        );
        assert!(live.rms_m < 5e-3, "{attached:?}");
        let (few, all) = (points.len() as f64, captured.cloud().len() as f64);
        assert!(
            (few / all - 1.0).abs() < 0.01,
            "{attached:?}: {few} of {all} points"
        );
    }
}

#[test]
fn the_live_view_is_compared_with_the_cloud() {
    for attached in [Attachment::Usb, Attachment::Rs232, Attachment::Can] {
        let captured = Captured::new(Setting::over(attached));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.ply");
        let source = engine::reconstruct::source::Source::open(&captured.log(), None).unwrap();
        let interrupt = std::sync::atomic::AtomicBool::new(false);
        let request = engine::reconstruct::replay::Reconstruction {
            live: true,
            ..engine::reconstruct::replay::Reconstruction::of_log(
                &source,
                scanner::Accuracy::Best,
                &interrupt,
            )
        };
        let target = engine::output::Target::open(&path, cloud::Fields::FILE, false).unwrap();
        let scan = engine::reconstruct::replay::make(&request, target).unwrap();
        let live = scan.live.unwrap();
        println!("{attached:?}: {live:?}");
        let share = live.points as f64 / scan.points as f64;
        assert!((share - 1.0).abs() < 0.01, "{attached:?}: {share}");
        // Straight lines between polls, and ages of a latch up to 1 ms at 56.25 deg/s: 0.06 deg.
        assert!(live.rms_m.unwrap() < 6e-3, "{attached:?}: {live:?}");
        assert!(live.worst_m.unwrap() < 40e-3, "{attached:?}: {live:?}");
        assert!(live.lag_s < 0.1, "{attached:?}: {live:?}");
        // Bytes of the cloud do not depend on the comparison.
        let plain = folder.path().join("plain.ply");
        let target = engine::output::Target::open(&plain, cloud::Fields::FILE, false).unwrap();
        let request = engine::reconstruct::replay::Reconstruction::of_log(
            &source,
            scanner::Accuracy::Best,
            &interrupt,
        );
        assert_eq!(
            engine::reconstruct::replay::make(&request, target)
                .unwrap()
                .live,
            None
        );
        assert_eq!(
            std::fs::read(&plain).unwrap(),
            std::fs::read(&path).unwrap()
        );
    }
}
