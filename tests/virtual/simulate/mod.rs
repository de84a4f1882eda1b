//! Simulated scenes through their logs, compared with the truth.

mod accuracy;
mod calibrate;
mod light;
mod models;
mod points;
mod round_trip;
mod tolerance;

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use cloud::{Fields, Points};
use engine::reconstruct::replay;
use engine::reconstruct::report::ScanReport;
use engine::reconstruct::source::Source;
use engine::simulate;
use scanner::TiltSource;
use sim::TruePoint;
use sim::scene_file::SceneFile;
use sim::simulate::{SimulationEvent, SimulationSink};
use tempfile::TempDir;

/// A simulated scene: its log, and the truth by firing and laser.
struct Simulated {
    folder: TempDir,
    report: simulate::SimulationReport,
    truth: BTreeMap<(i64, u8), Vec<TruePoint>>,
    firing_ns: i64,
    clock_ns: i64,
}

#[derive(Default)]
struct Truth(Vec<TruePoint>);

impl SimulationSink for Truth {
    fn event(&mut self, _: &SimulationEvent) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn wants_truth(&self) -> bool {
        true
    }

    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        self.0.extend_from_slice(points);
        ControlFlow::Continue(())
    }
}

impl Simulated {
    /// Simulates twice: into a log, and for the truth alone. `more` adds to the scene.
    fn new(text: &str, more: impl Fn(&mut SceneFile)) -> Self {
        let read = || {
            let mut scene = simulate::read("test", text, None, None).unwrap();
            more(&mut scene);
            scene
        };
        let folder = tempfile::tempdir().unwrap();
        let request = simulate::SimulationRequest {
            name: "test".to_owned(),
            output: simulate::SimulationOutput::Log {
                path: folder.path().join("scene.pcapng"),
                force: false,
            },
            truth: None,
            threads: NonZeroUsize::new(2).unwrap(),
            explain: false,
            interrupt: &AtomicBool::new(false),
            progressed: &mut |_| {},
        };
        let (report, failure) = simulate::make(read(), request).unwrap();
        assert!(failure.is_none(), "{failure:?}");
        let mut scene = read();
        let mut truth = Truth::default();
        let effects = &mut scene.effects.effects;
        let one = NonZeroUsize::MIN;
        scene.simulation.run(effects, one, &mut truth).unwrap();
        let mut found = Self {
            folder,
            report,
            truth: BTreeMap::new(),
            firing_ns: scene.simulation.sensor.firing_period_ns,
            clock_ns: i64::from(scene.simulation.clock_at_start_us) * 1_000,
        };
        for point in truth.0 {
            let key = found.key(point.device_ns + found.clock_ns, point.laser);
            found.truth.entry(key).or_default().push(point);
        }
        found
    }

    fn log(&self) -> PathBuf {
        self.folder.path().join("scene.pcapng")
    }

    /// The firing of a laser at a given time of the lidar's hour: its delay is less than a period.
    fn key(&self, device_ns: i64, laser: u8) -> (i64, u8) {
        let since = (device_ns - self.clock_ns).rem_euclid(3_600_000_000_000);
        // Stamps are truncated to microseconds.
        ((since + 1_000) / self.firing_ns, laser)
    }

    /// Distance from every point to the nearest truth of its firing and laser, and range, metres.
    fn errors(&self, cloud: &Points) -> Vec<(f64, f64)> {
        let shots = cloud.device_time().iter().zip(cloud.laser());
        cloud
            .positions()
            .zip(shots)
            .map(|(seen, (time, laser))| {
                let truth = &self.truth[&self.key(time.as_nanos(), *laser)];
                let distance = |point: &TruePoint| {
                    let there = point.position_m.to_array();
                    let apart = seen.iter().zip(there).map(|(a, b)| (a - b) * (a - b));
                    apart.sum::<f64>().sqrt()
                };
                let nearest = truth
                    .iter()
                    .min_by(|a, b| distance(a).total_cmp(&distance(b)));
                let nearest = nearest.unwrap();
                (distance(nearest), nearest.range_m)
            })
            .collect()
    }
}

/// The report and the cloud of a log.
fn replayed(log: &Path, tilt: TiltSource) -> (ScanReport, Points) {
    let mut points = Points::new(Fields::ALL);
    let request = replay::Reconstruction {
        recording: &Source::open(log, None).unwrap(),
        tilt,
        options: lidar::Options::default(),
        time: engine::reconstruct::replay::TimeReference::Host,
        accuracy: scanner::Accuracy::Best,
        pace: None,
        truth: None,
        live: false,
        lost_records: 0,
        georeference: None,
        interrupt: &AtomicBool::new(false),
    };
    let scan = replay::scan(&request, &mut points, Path::new("memory")).unwrap();
    (scan, points)
}
