//! What effects change in the cloud: a sample of the scene's firings is simulated with an effect
//! and without it, and both logs become clouds as `replay` makes them.
//!
//! Random draws depend on seed, effect and firing alone, so that the difference of the two is that
//! of the effect.

use std::collections::HashMap;
use std::fmt::Write;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::time::Instant;

use cloud::{Fields, Points, Sink, SinkError};
use lidar::{Duplicates, Options};
use protocol::epos2::usb;
use protocol::record::{Direction, DriveLink, Record, Wire};
use scanner::{Accuracy, TiltSource, align, place};
use serde::Serialize;
use sim::effect_models::{EffectTolerance, EffectsConfig};
use sim::effects::EncoderEffect;
use sim::scene_file::{EffectDemand, SceneFile};
use sim::simulate::{SimulationEvent, SimulationSink};
use units::{Host, Stamp};
use utoipa::ToSchema;

use super::log::{SOURCE, frame_of, scan_config};
use engine::failure::{Failure, Kind};

/// Firings of a sample, about: 65,000 shots of a VLP-16.
const FIRINGS: f64 = 4_096.0;
/// The beginning of a scene that is sampled, seconds of it.
const SAMPLED_S: f64 = 20.0;
/// An effect that is off is reported from these sizes on: percent of the points, and millimetres of
/// the 99 % displacement.
const NOTABLE: (f64, f64) = (0.1, 1.0);

/// What an effect changes in the cloud.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
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
    /// The facts that call for it, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub demand: Option<EffectDemand>,
}

/// Effects chosen by a tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct EffectChoice {
    /// The tolerance.
    pub tolerance: EffectTolerance,
    /// Effects that are on.
    pub on: Vec<&'static str>,
    /// Effects that are off, though the file or a fact of the scene calls for them.
    pub off: Vec<&'static str>,
    /// Points of the sample that are missing, added or displaced by more than the tolerance,
    /// compared with all effects, percent.
    pub left_percent: f64,
    /// Computing time of the sample over that with all effects, each the least of three.
    pub time_ratio: f64,
}

/// Differences of two clouds of the same firings.
struct Difference {
    gained: usize,
    lost: usize,
    /// Displacements of points in both, ascending, metres.
    displaced_m: Vec<f64>,
}

/// A cloud of the sample; keys are time on the lidar's clock, laser, and number of the return.
struct SampleCloud {
    points: HashMap<(i64, u8, u8), [f64; 3]>,
    took_s: f64,
}

/// Measures effects of a scene.
pub(super) struct Sampler<'a> {
    scene: &'a SceneFile,
    /// The effects of the simulation.
    on: Vec<&'static str>,
    every: u64,
    threads: NonZeroUsize,
}

impl<'a> Sampler<'a> {
    pub fn new(scene: &'a SceneFile, threads: NonZeroUsize) -> Self {
        let sampled_s = scene.simulation.motion.end_s.min(SAMPLED_S);
        let period_s = 1e-9 * scene.simulation.sensor.model.firing_period_ns() as f64;
        let usage = scene.effects.effects.usage();
        Self {
            scene,
            on: usage.iter().map(|used| used.name).collect(),
            every: (sampled_s / period_s / FIRINGS) as u64,
            threads,
        }
    }

    /// Effects of the simulation and those that the scene calls for, in the order in which they
    /// act.
    fn candidates(&self) -> Vec<&'static str> {
        let names = EffectsConfig::NAMES.iter().copied();
        names
            .filter(|name| self.on.contains(name) || self.demand(name).is_some())
            .collect()
    }

    fn demand(&self, name: &str) -> Option<&EffectDemand> {
        self.scene.demands.iter().find(|other| other.effect == name)
    }

    /// The sizes of all candidates, or of those that are off.
    ///
    /// # Errors
    /// [`Failure`] for a scene that gives no cloud.
    pub fn sizes(&self, only_off: bool) -> Result<Vec<EffectSize>, Failure> {
        let candidates = self.candidates();
        let wanted: Vec<_> = (candidates.iter().copied())
            .filter(|name| !only_off || !self.on.contains(name))
            .collect();
        if wanted.is_empty() {
            return Ok(Vec::new());
        }
        let usual = self.cloud(&self.on)?;
        let size = |effect: &'static str| {
            let is_on = self.on.contains(&effect);
            let mut others = self.on.clone();
            let change = match is_on {
                true => {
                    others.retain(|other| *other != effect);
                    usual.difference(&self.cloud(&others)?)
                }
                false => {
                    others.push(effect);
                    self.cloud(&others)?.difference(&usual)
                }
            };
            Ok(EffectSize {
                effect,
                is_on,
                gained_percent: change.percent(change.gained),
                lost_percent: change.percent(change.lost),
                moved_percent: change.percent(change.moved(1.0)),
                median_mm: change.quantile_mm(0.5),
                p99_mm: change.quantile_mm(0.99),
                worst_mm: change.quantile_mm(1.0),
                demand: self.demand(effect).cloned(),
            })
        };
        wanted.into_iter().map(size).collect()
    }

    /// As few effects as keep the cloud within the tolerance of that with all candidates, without
    /// those that `is_out` names: the smallest are left out one after the other, each checked
    /// together with those before.
    ///
    /// # Errors
    /// [`Failure`] for a scene that gives no cloud, and for a share that the sample cannot show.
    pub fn choose(
        &self,
        tolerance: EffectTolerance,
        is_out: &dyn Fn(&str) -> bool,
    ) -> Result<EffectChoice, Failure> {
        let mut all = self.candidates();
        all.retain(|name| !is_out(name));
        let reference = self.cloud(&all)?;
        // No event in n trials is below a share of 3 / n with a confidence of 95 %.
        let least_percent = 300.0 / reference.points.len().max(1) as f64;
        if tolerance.percent < least_percent {
            let points = reference.points.len();
            let message = format!(
                "--tolerance: expected a share of {least_percent:.2} % or more, which {points} sampled points can show, got {} %",
                tolerance.percent
            );
            return Err(Failure::new(Kind::Usage, message).help("state a greater share"));
        }
        let left = |names: &[&'static str]| -> Result<f64, Failure> {
            let difference = reference.difference(&self.cloud(names)?);
            Ok(difference.beyond_percent(tolerance.displaced_mm))
        };
        let without = |names: &[&'static str], out: &str| -> Vec<&'static str> {
            names.iter().copied().filter(|name| *name != out).collect()
        };
        let mut alone = Vec::new();
        for name in &all {
            alone.push((left(&without(&all, name))?, *name));
        }
        alone.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let mut on = all.clone();
        let mut left_percent = 0.0;
        for (percent, name) in alone {
            if percent > tolerance.percent {
                break;
            }
            let fewer = without(&on, name);
            let percent = left(&fewer)?;
            if percent <= tolerance.percent {
                (on, left_percent) = (fewer, percent);
            }
        }
        let (mut chosen_s, mut all_s) = (f64::INFINITY, reference.took_s);
        for _ in 0..3 {
            chosen_s = chosen_s.min(self.cloud(&on)?.took_s);
            all_s = all_s.min(self.cloud(&all)?.took_s);
        }
        Ok(EffectChoice {
            tolerance,
            off: (all.iter().copied())
                .filter(|name| !on.contains(name))
                .collect(),
            on,
            left_percent,
            time_ratio: chosen_s / all_s,
        })
    }

    /// The cloud of the sample with these effects.
    fn cloud(&self, names: &[&'static str]) -> Result<SampleCloud, Failure> {
        let scene = self.scene;
        let failed = |error: &dyn std::fmt::Display| {
            Failure::new(Kind::BadInput, format!("a sample of the scene: {error}"))
                .help("correct the scene file; docs: Scenes")
        };
        let mut effects = (scene.sampled(|name| names.contains(&name), self.every))
            .map_err(|error| failed(&error))?;
        let polls = scene.simulation.polls;
        let gearing = polls.map(|polls| effects.encoder.gearing().unwrap_or(polls.gearing));
        let mut log = SampleLog {
            gearing,
            records: Vec::new(),
            end_ns: scene.simulation.start.as_nanos() + (SAMPLED_S * 1e9) as i64,
        };
        let began = Instant::now();
        scene
            .simulation
            .run(&mut effects, self.threads, &mut log)
            .map_err(|error| failed(&error))?;
        let took_s = began.elapsed().as_secs_f64();
        let options = Options {
            duplicates: Duplicates::All,
            ..Options::default()
        };
        let tilt = match polls {
            Some(_) => TiltSource::Log,
            None => TiltSource::None,
        };
        let records = || log.records.iter().map(SampleRecord::as_record);
        let config = scan_config(scene, gearing);
        let alignment = align(
            records(),
            &config,
            options.clone(),
            &tilt,
            Accuracy::default(),
        )
        .map_err(|error| failed(&error))?;
        let mut cloud = SampleCloud {
            points: HashMap::new(),
            took_s,
        };
        place(records(), &alignment, options, &mut cloud).map_err(|error| failed(&error))?;
        Ok(cloud)
    }
}

impl SampleCloud {
    /// How this cloud differs from one without an effect.
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
struct SampleLog {
    gearing: Option<units::Gearing>,
    records: Vec<SampleRecord>,
    end_ns: i64,
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

impl SimulationSink for SampleLog {
    fn event(&mut self, event: &SimulationEvent) -> ControlFlow<()> {
        let record = match event {
            SimulationEvent::Datagram { at, port, payload } => Some(SampleRecord {
                host: *at,
                from: Ok(*port),
                bytes: payload.clone(),
            }),
            _ => frame_of(event, self.gearing).map(|(host, direction, frame)| SampleRecord {
                host,
                from: Err(direction),
                bytes: usb::to_bytes(&frame).to_vec(),
            }),
        };
        let is_over = record
            .as_ref()
            .is_some_and(|record| record.host.as_nanos() > self.end_ns);
        self.records.extend(record);
        match is_over {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

/// Warnings about effects that are off, though facts of the scene call for them.
pub(super) fn warnings(sizes: &[EffectSize]) -> Vec<String> {
    let (percent, mm) = NOTABLE;
    let is_notable = |size: &&EffectSize| {
        !size.is_on && (size.gained_percent + size.lost_percent >= percent || size.p99_mm >= mm)
    };
    let warning = |size: &EffectSize| {
        let EffectSize { effect, p99_mm, .. } = size;
        let (gained, lost) = (size.gained_percent, size.lost_percent);
        let why = size.demand.as_ref().map_or_else(String::new, |demand| {
            let line = demand
                .line
                .map_or_else(String::new, |line| format!(" (line {line})"));
            format!(", though {}{line}", demand.reason)
        });
        format!(
            "{effect} is off{why}: it would add {gained:.1} % of the points, remove {lost:.1} %, and move 1 in 100 by {p99_mm:.1} mm or more"
        )
    };
    sizes.iter().filter(is_notable).map(warning).collect()
}

/// The sizes as a table of at most 80 columns.
pub(super) fn table(sizes: &[EffectSize]) -> String {
    let mut text = format!(
        "{:<20} {:>3} {:>7} {:>7} {:>9} {:>9} {:>8} {:>9}\n",
        "in the cloud", "on", "gained", "lost", "over 1 mm", "median mm", "99 % mm", "worst mm"
    );
    for size in sizes {
        let on = if size.is_on { "yes" } else { "no" };
        let percent = |percent: f64| format!("{percent:.2} %");
        let (gained, lost) = (percent(size.gained_percent), percent(size.lost_percent));
        let _ = writeln!(
            text,
            "{:<20} {on:>3} {gained:>7} {lost:>7} {:>9} {:>9.3} {:>8.2} {:>9.1}",
            size.effect,
            percent(size.moved_percent),
            size.median_mm,
            size.p99_mm,
            size.worst_mm
        );
    }
    for size in sizes {
        if let Some(demand) = &size.demand {
            let line = demand
                .line
                .map_or_else(String::new, |line| format!(" (line {line})"));
            let reason = format!("{}: {}{line}", size.effect, demand.reason);
            text.push_str(&textwrap::fill(
                &reason,
                textwrap::Options::new(80).subsequent_indent("  "),
            ));
            text.push('\n');
        }
    }
    text
}

impl EffectChoice {
    /// One line of the report.
    pub(super) fn text(&self) -> String {
        let list = |names: &[&str]| match names.is_empty() {
            true => "none".to_owned(),
            false => names.join(", "),
        };
        format!(
            "{} on, {} off: {:.3} % of the sampled points are missing, added or displaced by more than {} mm (at most {} %); {:.0} % of the time with all effects",
            list(&self.on),
            list(&self.off),
            self.left_percent,
            self.tolerance.displaced_mm,
            self.tolerance.percent,
            100.0 * self.time_ratio
        )
    }
}

#[cfg(test)]
mod tests;
