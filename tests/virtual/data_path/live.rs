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
