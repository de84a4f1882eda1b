//! Changes of the cloud by effects, and their cost: a sample of the scene's firings is simulated
//! with an effect and without it, and both logs become clouds as `replay` makes them.
//!
//! Random draws depend on seed, effect and firing alone, so that the difference of the two is that
//! of the effect.

mod choice;
mod unmet;

use std::collections::HashMap;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use cloud::{Fields, Points, Sink, SinkError};
use lidar::{Duplicates, Options};
use protocol::epos2::usb;
use protocol::record::{Direction, DriveLink, Record, Wire};
use scanner::{Accuracy, TiltSource, align, place};
use serde::Serialize;
use sim::TruePoint;
use sim::effect_models::EffectsConfig;
use sim::effects::{EncoderEffect, Stopwatch};
use sim::scene_file::{EffectDemand, SceneFile};
use sim::simulate::{SimulationEvent, SimulationSink};
use units::{Host, Stamp};
use utoipa::ToSchema;

pub use choice::EffectChoice;
pub use unmet::unmet;

use super::log::{SOURCE, frame_of, scan_config};
use super::stopwatch::nanoseconds;
use crate::failure::{Failure, Kind};

/// Firings of a sample, about: 65,000 shots of a VLP-16.
const FIRINGS: f64 = 4_096.0;
/// The beginning of a scene that is sampled, seconds of it: ten times as long as a usual scan.
const SAMPLED_S: f64 = 300.0;
/// Longest sample of which all packets without a return are kept, seconds. Of a longer one, one in
/// `EMPTY_KEPT` of them is kept, for the clock.
const ALL_KEPT_S: f64 = 20.0;
const EMPTY_KEPT: u64 = 16;

/// What an effect changes in the cloud.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct EffectSize {
    /// Name of the effect.
    pub effect: &'static str,
    /// Whether the simulation has it.
    pub is_on: bool,
    /// Points that are there only with it, percent.
    pub gained_percent: f64,
    /// Points that are there only without it, percent.
    pub lost_percent: f64,
    /// Points that are displaced by more than a millimetre, percent.
    pub moved_percent: f64,
    /// Median displacement of the points in both clouds, millimetres.
    pub median_mm: f64,
    /// The 99th percentile of the displacements, millimetres.
    pub p99_mm: f64,
    /// The greatest displacement, millimetres.
    pub worst_mm: f64,
    /// Its share of the computing time of a simulation with it, percent.
    pub time_percent: f64,
    /// The facts that call for it, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub demand: Option<EffectDemand>,
}

/// Differences of two clouds of the same firings.
struct Difference {
    gained: usize,
    lost: usize,
    /// Displacements of points in both, ascending, metres.
    displaced_m: Vec<f64>,
}

/// Points by time on the lidar's clock, laser, and number of the return.
type SamplePoints = HashMap<(i64, u8, u8), [f64; 3]>;

/// A cloud of the sample.
struct SampleCloud {
    points: SamplePoints,
    took_s: f64,
    /// Share of the computing time by effect, percent.
    time_percent: Vec<(&'static str, f64)>,
}

/// Measures effects of a scene.
pub struct Sampler<'a> {
    scene: &'a SceneFile,
    /// The effects of the simulation.
    on: Vec<&'static str>,
    every: u64,
    threads: NonZeroUsize,
    interrupt: Option<&'a AtomicBool>,
}

/// Firings from one of a sample to the next, of a lidar without packets: for as many shots as of a
/// VLP-16, over all azimuths. With a divisor in common with the firings of a revolution it would
/// meet the same azimuths in all of them.
fn every_of_points(scene: &SceneFile, sampled_s: f64) -> u64 {
    const VLP16_LASERS: f64 = 16.0;
    let (sensor, rotation) = (&scene.simulation.sensor, scene.simulation.rotation);
    let per_s = sensor.firings_at_once() as f64 / (1e-9 * sensor.firing_period_ns as f64);
    let lasers = sensor.beams.len() as f64 / sensor.firings_at_once() as f64;
    let shots = FIRINGS * VLP16_LASERS;
    let mut every = ((sampled_s * per_s * lasers / shots) as u64).max(1);
    let revolution = (60.0 * per_s / f64::from(rotation.rpm)).round() as u64;
    while divisor(every, revolution) > 1 {
        every += 1;
    }
    every
}

/// The greatest common divisor.
const fn divisor(mut a: u64, mut b: u64) -> u64 {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl<'a> Sampler<'a> {
    /// A sampler of a scene with the effects that it has now.
    #[must_use]
    pub fn new(scene: &'a SceneFile, threads: NonZeroUsize) -> Self {
        let sampled_s = scene.simulation.motion.end_s.min(SAMPLED_S);
        let period_s = 1e-9 * scene.simulation.sensor.firing_period_ns as f64;
        let usage = scene.effects.effects.usage();
        Self {
            scene,
            on: usage.iter().map(|used| used.name).collect(),
            every: match scene.simulation.sensor.packets {
                Some(_) => (sampled_s / period_s / FIRINGS) as u64,
                None => every_of_points(scene, sampled_s),
            },
            threads,
            interrupt: None,
        }
    }

    /// The same, which ends with a failure once the flag is set.
    #[must_use]
    pub fn interrupted_by(self, interrupt: Option<&'a AtomicBool>) -> Self {
        Self { interrupt, ..self }
    }

    fn is_interrupted(&self) -> bool {
        let flag = self.interrupt;
        flag.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Seconds of the scene that are sampled, if it is longer.
    fn beginning_s(&self) -> Option<f64> {
        (self.scene.simulation.motion.end_s > SAMPLED_S).then_some(SAMPLED_S)
    }

    /// Effects of the simulation and those that the scene calls for, in the order in which they
    /// act.
    pub fn candidates(&self) -> Vec<&'static str> {
        let names = EffectsConfig::NAMES.iter().copied();
        names
            .filter(|name| self.on.contains(name) || self.scene.demand(name).is_some())
            .collect()
    }

    /// Effects that are off, though the scene calls for them.
    pub fn off(&self) -> Vec<&'static str> {
        let mut off = self.candidates();
        off.retain(|name| !self.on.contains(name));
        off
    }

    /// The size of each of these effects.
    ///
    /// # Errors
    /// [`Failure`] for a scene that gives no cloud.
    pub fn sizes(&self, wanted: &[&'static str]) -> Result<Vec<EffectSize>, Failure> {
        if wanted.is_empty() {
            return Ok(Vec::new());
        }
        let usual = self.cloud(&self.on)?;
        let size = |effect: &'static str| {
            let others = self.on.iter().copied().filter(|other| *other != effect);
            if self.on.contains(&effect) {
                let others: Vec<_> = others.collect();
                let change = usual.difference(&self.cloud(&others)?);
                return Ok(self.size(effect, true, &change, &usual));
            }
            let all: Vec<_> = others.chain([effect]).collect();
            let with = self.cloud(&all)?;
            Ok(self.size(effect, false, &with.difference(&usual), &with))
        };
        wanted.iter().copied().map(size).collect()
    }

    /// Change that these effects, which are off, would make together, in the name of the first.
    ///
    /// # Errors
    /// As [`Sampler::sizes`].
    pub fn size_of_all(&self, off: &[&'static str]) -> Result<Option<EffectSize>, Failure> {
        let Some(first) = off.first() else {
            return Ok(None);
        };
        let all: Vec<_> = self.on.iter().chain(off).copied().collect();
        let with = self.cloud(&all)?;
        let change = with.difference(&self.cloud(&self.on)?);
        Ok(Some(self.size(first, false, &change, &with)))
    }

    fn size(
        &self,
        effect: &'static str,
        is_on: bool,
        change: &Difference,
        with: &SampleCloud,
    ) -> EffectSize {
        let time = with.time_percent.iter().find(|(name, _)| *name == effect);
        EffectSize {
            effect,
            is_on,
            gained_percent: change.percent(change.gained),
            lost_percent: change.percent(change.lost),
            moved_percent: change.percent(change.moved(1.0)),
            median_mm: change.quantile_mm(0.5),
            p99_mm: change.quantile_mm(0.99),
            worst_mm: change.quantile_mm(1.0),
            time_percent: time.map_or(0.0, |(_, percent)| *percent),
            demand: self.scene.demand(effect).cloned(),
        }
    }

    /// The cloud of the sample with these effects.
    fn cloud(&self, names: &[&'static str]) -> Result<SampleCloud, Failure> {
        let scene = self.scene;
        let failed = |error: &dyn std::fmt::Display| {
            Failure::new(Kind::BadInput, format!("a sample of the scene: {error}"))
                .help("correct the scene file; docs: Scenes")
        };
        let clock: Stopwatch = Some(nanoseconds);
        let mut effects = (scene.sampled(|name| names.contains(&name), self.every, clock))
            .map_err(|error| failed(&error))?;
        let polls = scene.simulation.polls;
        let gearing = polls.map(|polls| effects.encoder.gearing().unwrap_or(polls.gearing));
        let has_packets = scene.simulation.sensor.packets.is_some();
        let mut log = SampleLog {
            interrupt: self.interrupt,
            gearing,
            records: Vec::new(),
            measured: (!has_packets).then(HashMap::new),
            end_ns: scene.simulation.start.as_nanos() + (SAMPLED_S * 1e9) as i64,
            is_thinned: scene.simulation.motion.end_s > ALL_KEPT_S,
            datagrams: 0,
            had_return: false,
        };
        let began = Instant::now();
        scene
            .simulation
            .run(&mut effects, self.threads, &mut log)
            .map_err(|error| failed(&error))?;
        if self.is_interrupted() {
            let stopped = "stopped by the user while effects were compared";
            return Err(Failure::new(Kind::Interrupted, stopped).help("nothing was written"));
        }
        let took_s = began.elapsed().as_secs_f64();
        let busy_ns = 1e9 * took_s * self.threads.get() as f64;
        let time_percent = (effects.usage().iter())
            .map(|used| (used.name, 100.0 * used.counts.spent_ns as f64 / busy_ns))
            .collect();
        let mut cloud = SampleCloud {
            points: HashMap::new(),
            took_s,
            time_percent,
        };
        if let Some(measured) = log.measured {
            cloud.points = measured;
            return Ok(cloud);
        }
        let options = Options {
            duplicates: Duplicates::All,
            ..Options::default()
        };
        let tilt = match polls {
            Some(_) => TiltSource::Log,
            None => TiltSource::None,
        };
        let records = || log.records.iter().map(SampleRecord::as_record);
        let config = scan_config("", scene, gearing);
        let alignment = align(
            records(),
            &config,
            options.clone(),
            &tilt,
            Accuracy::default(),
        )
        .map_err(|error| {
            Failure::new(Kind::BadInput, format!("a sample of the scene gives no cloud: {error}"))
                .help("replay refuses the log of the scene alike: see [drive], [link] and what loses their messages")
        })?;
        place(records(), &alignment, options, &mut cloud).map_err(|error| failed(&error))?;
        Ok(cloud)
    }
}

impl SampleCloud {
    /// Difference of this cloud from one without an effect.
    fn difference(&self, without: &Self) -> Difference {
        let mut displaced_m = Vec::new();
        for (key, a) in &self.points {
            if let Some(b) = without.points.get(key) {
                let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
                displaced_m.push(square.sqrt());
            }
        }
        displaced_m.sort_by(f64::total_cmp);
        Difference {
            gained: self.points.len() - displaced_m.len(),
            lost: without.points.len() - displaced_m.len(),
            displaced_m,
        }
    }
}

impl Sink for SampleCloud {
    fn fields(&self) -> Fields {
        Fields::DEVICE_TIME | Fields::LASER
    }

    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        for point in batch.iter() {
            let mut key = (point.device_time.as_nanos(), point.laser, 0);
            while self.points.contains_key(&key) {
                key.2 += 1;
            }
            self.points.insert(key, point.position_m);
        }
        Ok(())
    }
}

impl Difference {
    /// Points of either cloud.
    fn percent(&self, part: usize) -> f64 {
        let all = self.gained + self.lost + self.displaced_m.len();
        100.0 * part as f64 / all.max(1) as f64
    }

    fn quantile_mm(&self, share: f64) -> f64 {
        let last = self.displaced_m.len().saturating_sub(1);
        let at = (share * last as f64).round() as usize;
        1e3 * self.displaced_m.get(at).copied().unwrap_or(0.0)
    }

    /// Number of points that are displaced by more than a length.
    fn moved(&self, displaced_mm: f64) -> usize {
        let within = (self.displaced_m).partition_point(|d| *d * 1e3 <= displaced_mm);
        self.displaced_m.len() - within
    }

    fn beyond_percent(&self, displaced_mm: f64) -> f64 {
        self.percent(self.gained + self.lost + self.moved(displaced_mm))
    }
}

/// The messages of a sample.
struct SampleLog<'a> {
    interrupt: Option<&'a AtomicBool>,
    gearing: Option<units::Gearing>,
    records: Vec<SampleRecord>,
    /// The points of a lidar without packets, as measured.
    measured: Option<SamplePoints>,
    end_ns: i64,
    is_thinned: bool,
    datagrams: u64,
    /// Whether the last datagram had a return: the next one ends its azimuths.
    had_return: bool,
}

/// A record that owns its bytes.
struct SampleRecord {
    host: Stamp<Host>,
    /// Port of a datagram, direction of a frame.
    from: Result<u16, Direction>,
    bytes: Vec<u8>,
}

impl SampleRecord {
    fn as_record(&self) -> Record<'_> {
        let wire = match self.from {
            Ok(port) => Wire::Lidar {
                source: SOURCE,
                port,
                payload: &self.bytes,
            },
            Err(direction) => Wire::Drive {
                link: DriveLink::Usb,
                direction,
                frame: &self.bytes,
            },
        };
        Record {
            host: self.host,
            wire,
        }
    }
}

impl SampleLog<'_> {
    /// Ends the run where the sample ends, or where the user stops it.
    fn go_on(&self, reached: Option<Stamp<Host>>) -> ControlFlow<()> {
        let is_over = reached.is_some_and(|host| host.as_nanos() > self.end_ns);
        let flag = self.interrupt;
        match is_over || flag.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    /// Whether to keep a datagram.
    fn keeps(&mut self, payload: &[u8]) -> bool {
        let has_return = has_return(payload);
        let is_needed = has_return || self.had_return;
        self.had_return = has_return;
        self.datagrams += 1;
        is_needed || !self.is_thinned || self.datagrams.is_multiple_of(EMPTY_KEPT)
    }
}

/// Whether a data packet has a distance above 0: blocks of four bytes and 32 times three.
fn has_return(payload: &[u8]) -> bool {
    let blocks = payload.chunks_exact(100).take(12);
    let mut shots = blocks.flat_map(|block| block.get(4..).unwrap_or_default().chunks_exact(3));
    shots.any(|shot| !shot.starts_with(&[0, 0]))
}

impl SimulationSink for SampleLog<'_> {
    fn event(&mut self, event: &SimulationEvent) -> ControlFlow<()> {
        let record = match event {
            SimulationEvent::Datagram { at, port, payload } => {
                self.keeps(payload).then(|| SampleRecord {
                    host: *at,
                    from: Ok(*port),
                    bytes: payload.clone(),
                })
            }
            _ => frame_of(event, self.gearing).map(|(host, direction, frame)| SampleRecord {
                host,
                from: Err(direction),
                bytes: usb::to_bytes(&frame).to_vec(),
            }),
        };
        let host = record.as_ref().map(|record| record.host);
        self.records.extend(record);
        self.go_on(host)
    }

    fn reached(&mut self, at: Stamp<Host>) -> ControlFlow<()> {
        self.go_on(Some(at))
    }

    fn wants_truth(&self) -> bool {
        self.measured.is_some()
    }

    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        let by_key = points.iter().map(|point| {
            let key = (point.device_ns, point.laser, point.echo);
            (key, point.measured_m.to_array())
        });
        if let Some(measured) = &mut self.measured {
            measured.extend(by_key);
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests;
