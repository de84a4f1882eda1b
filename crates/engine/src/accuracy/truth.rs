//! The truth of a simulated log: one scene and one seed give the same shots again.

use std::collections::HashMap;
use std::fmt::Display;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::failure::{Failure, Kind};
use crate::reconstruct::source::Source;
use scanner::config::SimulatedScene;
use sim::TruePoint;
use sim::simulate::{SimulationEvent, SimulationSink};

use crate::simulate::{find, invalid_setting, read};

/// True places of the first returns of a scene, by firing and laser.
pub struct TruePlaces {
    places: HashMap<(i64, u8), [f64; 3]>,
    clock_ns: i64,
    firing_ns: i64,
}

const HOUR_NS: i64 = 3_600_000_000_000;
/// Stamps of packets are truncated to microseconds.
const STAMP_NS: i64 = 1_000;

impl TruePlaces {
    /// Simulates a scene again, with seed and effects of the logs of it.
    ///
    /// # Errors
    /// [`Kind::BadInput`] for an invalid scene; [`Kind::Usage`] for one that the logs are not of.
    pub fn new(scene: &Path, seed: Option<u64>, logs: &[PathBuf]) -> Result<Self, Failure> {
        let (name, text) = find(scene)?;
        let simulated = simulated(logs, scene, &text, seed)?;
        let seed_of_logs = (simulated.as_ref())
            .map(|simulated| simulated.seed.parse().map_err(|_| no_seed(simulated)))
            .transpose()?;
        let mut scene = read(&name, &text, seed.or(seed_of_logs), None)?;
        if let Some(simulated) = simulated {
            let was_on = |effect: &str| simulated.effects.iter().any(|name| name == effect);
            let selected = scene.select(was_on, None);
            scene.effects = selected.map_err(|error| invalid_setting(&name, &error))?;
        }
        let simulation = &scene.simulation;
        if simulation.motion.end_s >= 3_600.0 {
            let what =
                format!("scene {name}: an hour or longer, after which the lidar's clock repeats");
            return Err(Failure::new(Kind::BadInput, what).help("compare a shorter scan"));
        }
        let mut places = Self {
            places: HashMap::new(),
            clock_ns: i64::from(simulation.clock_at_start_us).saturating_mul(1_000),
            firing_ns: simulation.sensor.firing_period_ns,
        };
        let threads = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let run = simulation.run(&mut scene.effects.effects, threads, &mut places);
        run.map_err(|error| {
            Failure::new(Kind::BadInput, format!("scene {name}: {error}"))
                .help("name the scene with which the log was simulated")
        })?;
        Ok(places)
    }

    /// The place that a laser hit when it fired, by the lidar's clock.
    pub fn place(&self, time_ns: i64, laser: u8) -> Option<[f64; 3]> {
        let since_ns = (time_ns - self.clock_ns).rem_euclid(HOUR_NS);
        self.places.get(&self.firing(since_ns, laser)).copied()
    }

    const fn firing(&self, since_ns: i64, laser: u8) -> (i64, u8) {
        ((since_ns + STAMP_NS) / self.firing_ns, laser)
    }
}

fn no_seed(simulated: &SimulatedScene) -> Failure {
    let what = format!("the log's seed is no number: {}", simulated.seed);
    Failure::new(Kind::BadInput, what).help("simulate the scene again")
}

/// Simulated scene that the logs record; `None` without logs.
///
/// # Errors
/// [`Kind::Usage`] where it is not this scene with this seed.
fn simulated(
    logs: &[PathBuf],
    scene: &Path,
    text: &str,
    seed: Option<u64>,
) -> Result<Option<SimulatedScene>, Failure> {
    let mut first: Option<SimulatedScene> = None;
    for (index, log) in logs.iter().enumerate() {
        let found = Source::open(log, None)?.config()?.simulation;
        if index > 0 && found != first {
            let what = format!(
                "{} is of another simulation than the first log",
                log.display()
            );
            return Err(
                Failure::new(Kind::Usage, what).help("compare one log at a time with a scene")
            );
        }
        let Some(found) = found else {
            let what = format!("{} does not say that a scene was simulated", log.display());
            return Err(Failure::new(Kind::Usage, what)
                .help("compare a log (.pcapng) of velomotion simulate with its scene"));
        };
        let other = |what: &str, given: &dyn Display, expected: &str| {
            let what = format!("{} has the {what} {expected}, not {given}", log.display());
            Failure::new(Kind::Usage, what).help(format!(
                "compare it with: --scene {}, and without --seed",
                found.scene
            ))
        };
        let is_other = match &found.fingerprint {
            Some(fingerprint) => *fingerprint != SimulatedScene::fingerprint_of(text),
            None => Path::new(&found.scene).file_name() != scene.file_name(),
        };
        if is_other && Path::new(&found.scene) == scene {
            let what = format!(
                "{scene} has changed since {log} was simulated",
                scene = scene.display(),
                log = log.display()
            );
            return Err(Failure::new(Kind::Usage, what).help("simulate the scene again"));
        }
        if is_other {
            return Err(other("scene", &scene.display(), &found.scene));
        }
        if let Some(seed) = seed.filter(|seed| seed.to_string() != found.seed) {
            return Err(other("seed", &seed, &found.seed));
        }
        first = Some(found);
    }
    Ok(first)
}

impl SimulationSink for TruePlaces {
    fn event(&mut self, _: &SimulationEvent) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn wants_truth(&self) -> bool {
        true
    }

    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        for point in points.iter().filter(|point| point.echo == 0) {
            let firing = self.firing(point.device_ns, point.laser);
            self.places.insert(firing, point.position_m.to_array());
        }
        ControlFlow::Continue(())
    }
}
