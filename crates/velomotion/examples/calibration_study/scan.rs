//! Logs of simulated scanners, and their delays.

use std::collections::HashMap;
use std::error::Error;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use cloud::{Fields, Points};
use engine::config::MountSettings;
use engine::reconstruct::replay::{Reconstruction, scan};
use engine::reconstruct::source::Source;
use engine::simulate::{SimulationOutput, SimulationRequest, make, read};
use scanner::Accuracy;
use sim::TruePoint;
use sim::simulate::{SimulationEvent, SimulationSink};

/// Simulates a scene file into a log.
pub fn simulate(text: &str, seed: u64, log: &Path) -> Result<(), Box<dyn Error>> {
    let scene = read("study", text, Some(seed), None).map_err(|failure| failure.message)?;
    let interrupt = AtomicBool::new(false);
    let request = SimulationRequest {
        name: "study".to_owned(),
        output: SimulationOutput::Log {
            path: log.to_owned(),
            force: true,
        },
        truth: None,
        threads: NonZeroUsize::MIN,
        explain: false,
        interrupt: &interrupt,
        progressed: &mut |_| {},
    };
    make(scene, request).map_err(|failure| failure.message)?;
    Ok(())
}

/// The points of a log by a mount, with the columns `fields`.
pub fn points(log: &Path, mount: Option<&Path>, fields: Fields) -> Result<Points, Box<dyn Error>> {
    let mut source = Source::open(log, None).map_err(|failure| failure.message)?;
    let mount = match mount {
        Some(file) => engine::config::load_mount(file).map_err(|failure| failure.message)?,
        None => MountSettings::from(scanner::config::MountConfig::upright(0.0)),
    };
    source.set_mount(mount);
    let interrupt = AtomicBool::new(false);
    let request = Reconstruction::of_log(&source, Accuracy::Best, &interrupt);
    let request = request.map_err(|failure| failure.message)?;
    let mut points = Points::new(fields);
    scan(&request, &mut points, log).map_err(|failure| failure.message)?;
    Ok(points)
}

/// True tilts by firing, of one laser: all are in the middle of its firing.
#[derive(Default)]
struct TrueTilts(HashMap<i64, f64>);

const LASER: u8 = 7;

/// The firing at a time of the lidar's clock, whose stamps are truncated to microseconds.
const fn firing(device_ns: i64) -> i64 {
    (device_ns.rem_euclid(3_600_000_000_000) + 1_000) / 55_296
}

impl SimulationSink for TrueTilts {
    fn event(&mut self, _: &SimulationEvent) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn wants_truth(&self) -> bool {
        true
    }

    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        for point in points.iter().filter(|point| point.laser == LASER) {
            self.0.insert(firing(point.device_ns), point.tilt_deg);
        }
        ControlFlow::Continue(())
    }
}

/// The time by which the platform is ahead of the log's angles, microseconds: the platform's tilt
/// less ripple, less that of the log, against the rate. No calibration can know it better.
pub fn delay_us(
    text: &str,
    seed: u64,
    log: &Path,
    ripple: [f64; 2],
) -> Result<f64, Box<dyn Error>> {
    let mut scene = read("study", text, Some(seed), None).map_err(|failure| failure.message)?;
    let mut truth = TrueTilts::default();
    let simulation = &scene.simulation;
    simulation.run(&mut scene.effects.effects, NonZeroUsize::MIN, &mut truth)?;
    let fields = Fields::DEVICE_TIME
        .union(Fields::LASER)
        .union(Fields::TILT)
        .union(Fields::TIME);
    let points = points(log, None, fields)?;
    let mine: Vec<_> = points.iter().filter(|point| point.laser == LASER).collect();
    let (mut n, mut sums, mut matched) = (0.0, [0.0; 4], 0);
    for pair in mine.windows(21) {
        let (first, middle, last) = (pair[0], pair[10], pair[20]);
        let seconds = (last.time - first.time).as_secs_f64();
        if seconds > 0.02 {
            continue;
        }
        let Some(tilt) = truth.0.get(&firing(middle.device_time.as_nanos())) else {
            continue;
        };
        let rate = (last.tilt.0 - first.tilt.0) / seconds;
        let (sin, cos) = (120.0 * middle.tilt.0.to_radians()).sin_cos();
        let ahead = tilt - middle.tilt.0 - ripple[0] * sin - ripple[1] * cos;
        matched += 1;
        n += 1.0;
        for (sum, value) in sums
            .iter_mut()
            .zip([rate, rate * rate, ahead, rate * ahead])
        {
            *sum += value;
        }
    }
    if matched < 1_000 {
        return Err(format!("only {matched} firings of the log are in the truth").into());
    }
    let [r, rr, a, ra] = sums.map(|sum| sum / n);
    Ok(1e6 * (ra - r * a) / (rr - r * r))
}
