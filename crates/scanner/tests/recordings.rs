//! The fast path against the definition on real recordings: the same points in the same order, at
//! most a nanometre and a nanosecond apart, for every model, return mode, field of view, and with
//! corrections.
#![expect(clippy::unwrap_used, reason = "a test of recordings")]

#[path = "../../../benches/common/mod.rs"]
mod common;

use std::sync::Arc;

use cloud::{Fields, Points, Revolution, Sink, SinkError};
use common::{RECORDINGS, Recording};
use drive::record::Wire;
use lidar::{Corrections, Decoder, Duplicates, FrameCutter, Options};
use protocol::vlp16::LidarModel;
use scanner::{Alignment, PlacementCounts, Placer};

fn fast(
    recording: &Recording,
    alignment: &Alignment,
    options: Options,
) -> (Points, PlacementCounts) {
    let mut points = Points::new(Fields::ALL);
    let (counts, stats) =
        scanner::place(recording.records(), alignment, options, &mut points).unwrap();
    assert_eq!(stats.corrections_refused, None);
    (points, counts)
}

fn slow(
    recording: &Recording,
    alignment: &Alignment,
    options: Options,
) -> (Points, PlacementCounts) {
    let (mut points, mut placed) = (Points::new(Fields::ALL), PlacementCounts::default());
    let mut decoder = Decoder::new(options);
    let mut each = |firing: &lidar::Firing<'_>| {
        for point in firing.points() {
            match alignment.place(&point) {
                Some(point) => {
                    placed.points += 1;
                    points.push(point);
                }
                None => placed.outside += 1,
            }
        }
    };
    for record in recording.records() {
        if let Wire::Lidar { payload, .. } = record.wire {
            decoder.packet(record.host, payload, &mut each);
        }
    }
    decoder.finish(&mut each);
    (points, placed)
}

fn assert_same(name: &str, recording: &Recording, alignment: &Alignment, options: &Options) {
    let (fast, fast_placed) = fast(recording, alignment, options.clone());
    let (slow, slow_placed) = slow(recording, alignment, options.clone());
    assert_eq!(fast_placed, slow_placed, "{name}");
    assert_eq!(fast.len(), slow.len(), "{name}");
    assert_eq!(fast.intensity(), slow.intensity(), "{name}");
    assert_eq!(fast.ring(), slow.ring(), "{name}");
    assert_eq!(fast.laser(), slow.laser(), "{name}");
    assert_eq!(fast.device_time(), slow.device_time(), "{name}");
    let (mut worst_m, mut worst_ns, mut worst_deg) = (0.0_f64, 0, 0.0_f64);
    for (a, b) in fast.iter().zip(slow.iter()) {
        for (a, b) in a.position_m.iter().zip(&b.position_m) {
            worst_m = worst_m.max((a - b).abs());
        }
        worst_ns = worst_ns.max((a.time - b.time).as_nanos().abs());
        worst_deg = worst_deg.max((a.tilt.0 - b.tilt.0).abs());
    }
    println!(
        "{}, {name}: {} points, worst {worst_m:.1e} m, {worst_ns} ns, {worst_deg:.1e} deg",
        recording.name,
        fast.len()
    );
    assert!(worst_m < 1e-9 && worst_ns <= 1 && worst_deg < 1e-9);
}

#[test]
fn every_recording_is_placed_as_the_definition_does() {
    assert_placed_as_defined(Recording::read_cut);
}

#[test]
#[ignore = "needs the whole recordings"]
fn every_whole_recording_is_placed_as_the_definition_does() {
    assert_placed_as_defined(Recording::read_whole);
}

fn assert_placed_as_defined(read: impl Fn(&'static str) -> Recording) {
    for recording in RECORDINGS.into_iter().map(read) {
        let (tilting, at_rest) = (recording.tilting(), recording.at_rest());
        let default = Options::default();
        let every = Options {
            duplicates: Duplicates::All,
            vertical_offsets: false,
            ..Options::default()
        };
        assert_same("tilting", &recording, &tilting, &default);
        assert_same("at rest", &recording, &at_rest, &default);
        assert_same("every return", &recording, &tilting, &every);
    }
}

#[test]
fn every_model_is_placed_as_the_definition_does() {
    assert_models_placed_as_defined(Recording::read_cut);
}

#[test]
#[ignore = "needs the whole recordings"]
fn every_model_is_placed_in_whole_recordings_as_the_definition_does() {
    assert_models_placed_as_defined(Recording::read_whole);
}

/// Decodes the packets as every model's, and with that model's own table, changed slightly, as
/// corrections.
fn assert_models_placed_as_defined(read: impl Fn(&'static str) -> Recording) {
    for recording in RECORDINGS.into_iter().map(read) {
        let tilting = recording.tilting();
        for model in protocol::vlp16::models::ALL {
            let corrected = Options {
                model: Some(model),
                ..Options::default()
            };
            assert_same(model.name, &recording, &tilting, &corrected);
            let corrected = Options {
                corrections: Some(Arc::new(moved(model))),
                ..corrected
            };
            assert_same("corrected", &recording, &tilting, &corrected);
        }
    }
}

/// Numbers of points at the ends of revolutions.
#[derive(Default)]
struct RevolutionEnds {
    points: usize,
    ends: Vec<usize>,
}

impl Sink for RevolutionEnds {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.points += batch.len();
        Ok(())
    }

    fn revolution(&mut self, _: &Revolution) -> Result<(), SinkError> {
        self.ends.push(self.points);
        Ok(())
    }
}

#[test]
fn revolutions_end_where_the_firings_say() {
    for recording in RECORDINGS.into_iter().map(Recording::read_cut) {
        for cut_deg in [0.0, 77.7] {
            let cutter = || FrameCutter::new(cut_deg).unwrap();
            let (alignment, options) = (recording.at_rest(), Options::default());
            let mut by_placer = RevolutionEnds::default();
            let placer = Placer::new(&alignment, options.clone(), &mut by_placer);
            let mut placer = placer.by_revolution(cutter());
            for record in recording.records() {
                placer.observe(&record).unwrap();
            }
            let (counts, _) = placer.finish().unwrap();

            let (mut points, mut ends, mut firings) = (0, Vec::new(), cutter());
            let mut each = |firing: &lidar::Firing<'_>| {
                if firings.firing(firing).is_some() {
                    ends.push(points);
                }
                let placed = firing.points().filter_map(|point| alignment.place(&point));
                points += placed.count();
            };
            let mut decoder = Decoder::new(options);
            for record in recording.records() {
                if let Wire::Lidar { payload, .. } = record.wire {
                    decoder.packet(record.host, payload, &mut each);
                }
            }
            decoder.finish(&mut each);
            ends.push(points);
            assert_eq!(by_placer.ends, ends, "{}", recording.name);
            assert_eq!(counts.points, points as u64, "{}", recording.name);
        }
    }
}

fn moved(model: &LidarModel) -> Corrections {
    let mut corrections = Corrections::from(model);
    for (laser, i) in corrections.lasers.iter_mut().zip(0..) {
        let i = f64::from(i);
        laser.elevation_deg += 0.01 * i;
        laser.azimuth_offset_deg -= 0.02 * i;
        laser.range_offset_m += 0.003 * i;
        laser.radial_offset_m = 0.04;
        laser.tangential_offset_m = 0.02 - 0.001 * i;
        laser.vertical_offset_m += 0.001 * i;
    }
    corrections
}
