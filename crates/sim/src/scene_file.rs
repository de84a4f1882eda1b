//! Scene files: TOML in, a [`Simulation`] and its effects out.
//!
//! The facts that a file states call for effects of [`crate::effect_models`] ([`EffectDemand`]),
//! which are on with usual settings. A key of `[effects]` changes that: `false`, `true`, or a table
//! of settings. The surroundings are the file's own objects or a shipped scene (`scene = "hall"`),
//! see [`crate::scenery`]. Unknown keys are errors, and errors name the line.

mod demands;
mod facts;
mod sections;
mod surroundings;
mod trial_shots;

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Deserialize;
use thiserror::Error;
use toml::Spanned;
use units::{Host, Stamp};

use crate::effect_models::settings_of::{BaseDrift, WeatherSettings};
use crate::effect_models::{
    Divergence, EffectTolerance, EffectsConfig, InvalidSetting, MovingObjects,
};
use crate::effects::{ConfiguredEffects, FiringSample, MeteredEffect, Stopwatch};
use crate::scenery::{
    FilePosition, InvalidValue, MaterialTable, ObjectTable, line_of_value, no_files, toml_message,
};
use crate::simulate::Simulation;
use demands::SceneFacts;
use facts::StatedFact;
use sections::{DriveSection, LinkSection, MotionSection, MountSection, SensorSection, invalid};

pub use crate::effect_models::EffectLine;
pub use crate::scenery::SHIPPED;
pub use demands::EffectDemand;

/// A scene file that is read.
#[derive(Debug)]
#[non_exhaustive]
pub struct SceneFile {
    /// The simulation.
    pub simulation: Simulation,
    /// The effects and the lines that configure them.
    pub effects: SceneEffects,
    /// Its text.
    pub text: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// The tolerance that decides which effects are on, if the file states one.
    pub tolerance: Option<EffectTolerance>,
    /// Effects that the scene's facts call for, on or off.
    pub demands: Vec<EffectDemand>,
    /// `[effects]` of the file.
    requests: EffectsConfig,
    /// Settings of all effects that are configured or called for.
    config: EffectsConfig,
    /// Lines of the file's requests.
    file_lines: Vec<EffectLine>,
    /// The objects of the scene that move.
    movers: MovingObjects,
    /// The beam, which all selections share: it caches where the scene is plain.
    beam: Option<Arc<Divergence>>,
}

/// The effects of a scene.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct SceneEffects {
    /// All of them, as [`Simulation::run`] takes them.
    pub effects: ConfiguredEffects,
    /// The line that configures each, in the order in which they act.
    pub lines: Vec<EffectLine>,
}

/// An invalid scene file.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("line {line}: {what}")]
#[non_exhaustive]
pub struct SceneFileError {
    /// The line, from 1.
    pub line: usize,
    /// The error.
    pub what: String,
}

/// The sections of the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sections {
    /// Seed of all random draws.
    #[serde(default)]
    seed: u64,
    /// Host time of the start, Unix seconds.
    #[serde(default = "default_start")]
    start_unix_s: f64,
    /// The lidar's clock at the start, microseconds past the hour.
    #[serde(default)]
    lidar_clock_us: u32,
    /// A description for people.
    #[serde(default, rename = "about")]
    _about: String,
    /// The name of a shipped scene, instead of materials and objects.
    scene: Option<String>,
    #[serde(default)]
    materials: BTreeMap<Spanned<String>, Spanned<MaterialTable>>,
    #[serde(default)]
    objects: Vec<Spanned<ObjectTable>>,
    #[serde(default)]
    sensor: SensorSection,
    motion: MotionSection,
    #[serde(default)]
    mount: MountSection,
    #[serde(default)]
    drive: DriveSection,
    #[serde(default)]
    link: LinkSection,
    weather: Option<WeatherSettings>,
    base: Option<BaseDrift>,
    /// The tolerance that decides which effects are on, such as "5mm,0.1%".
    tolerance: Option<Spanned<String>>,
    #[serde(default)]
    effects: EffectsConfig,
}

/// A time in November 2026.
const fn default_start() -> f64 {
    1_795_226_733.0
}

impl SceneEffects {
    /// Whether there is no effect.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.effects.usage().is_empty()
    }

    /// The line that configures an effect, from 1.
    #[must_use]
    pub fn line(&self, name: &str) -> Option<usize> {
        let line = self.lines.iter().find(|line| line.name == name);
        line.and_then(|line| line.line)
    }

    /// Removes effects by name. The others keep their random draws.
    pub fn leave_out(&mut self, is_out: impl Fn(&str) -> bool) {
        self.effects.retain(|name| !is_out(name));
        self.lines.retain(|line| !is_out(line.name));
    }
}

impl SceneFile {
    /// Reads a scene file. `seed` replaces the file's seed; `stopwatch` measures the cost of
    /// effects.
    ///
    /// # Errors
    /// [`SceneFileError`] for text that is not TOML, unknown or missing keys and invalid values.
    pub fn parse(
        text: &str,
        seed: Option<u64>,
        stopwatch: Stopwatch,
    ) -> Result<Self, SceneFileError> {
        Self::parse_with(text, seed, stopwatch, &mut no_files)
    }

    /// Reads a scene file with mesh files. `files` returns the bytes of a file by its name in the
    /// scene, or the reason why it cannot.
    ///
    /// # Errors
    /// As [`SceneFile::parse`], and for missing files.
    pub fn parse_with(
        text: &str,
        seed: Option<u64>,
        stopwatch: Stopwatch,
        files: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, SceneFileError> {
        let sections: Sections = toml::from_str(text).map_err(|error| SceneFileError {
            line: (error.span()).map_or(1, |span| FilePosition::of(text, span.start).line),
            what: toml_message(&error),
        })?;
        let seed = seed.unwrap_or(sections.seed);
        let in_file = |error: InvalidValue| SceneFileError {
            line: line_of_value(text, &error.path),
            what: error.what,
        };
        let mut scene = Self::new(&sections, text, seed).map_err(in_file)?;
        let (stated_config, stated) = facts::stated(&sections, text);
        let line = |name: &Spanned<String>| FilePosition::of(text, name.span().start).line;
        let material_lines: BTreeMap<String, usize> = (sections.materials.keys())
            .map(|name| (name.get_ref().clone(), line(name)))
            .collect();
        let is_ideal = sections.sensor.is_ideal();
        let scene_line = (sections.scene.as_ref()).map(|_| line_of_value(text, "scene"));
        let surroundings = surroundings::build(text, sections, seed, files)?;
        scene.simulation.scene = surroundings.scene;
        let boxes = scene.requests.moving_objects.settings().cloned();
        let boxes = MovingObjects::of(&boxes.unwrap_or_default());
        let boxes = boxes.map_err(|error| in_file(scene.invalid_value(&stated, &error)))?;
        scene.movers = boxes.and(surroundings.movers);
        scene.config.complete(stated_config);
        scene.check_empty(&stated).map_err(in_file)?;
        // Settings for estimates; those that nothing calls for go again below.
        let mut estimated = scene.config.clone();
        for name in EffectsConfig::NAMES {
            estimated.add_usual(name);
        }
        let facts = SceneFacts {
            is_ideal,
            simulation: &scene.simulation,
            movers: scene.movers.movers(),
            mover_names: &surroundings.names,
            boxes_line: scene.file_line(MovingObjects::NAME),
            material_lines: &material_lines,
            scene_line,
            stated: &stated,
            config: &estimated,
        };
        scene.demands = facts.demands();
        for demand in &scene.demands {
            scene.config.add_usual(demand.effect);
        }
        let beam = scene.config.divergence.settings().map(Divergence::new);
        let beam = beam.transpose();
        let beam = beam.map_err(|error| in_file(scene.invalid_value(&stated, &error)))?;
        scene.beam = beam.map(Arc::new);
        let effects = scene.select(|name| scene.is_requested(name), stopwatch);
        scene.effects = effects.map_err(|error| in_file(scene.invalid_value(&stated, &error)))?;
        Ok(scene)
    }

    fn new(sections: &Sections, text: &str, seed: u64) -> Result<Self, InvalidValue> {
        let (sensor, returns, rotation) = sections.sensor.build()?;
        let motion = sections.motion.build()?;
        let polls = match motion.is_fixed() {
            true => None,
            false => Some(sections.drive.build()?),
        };
        let start_s = sections.start_unix_s;
        if !(0.0..1e10).contains(&start_s) {
            let what = format!("expected Unix seconds from 0 to 1e10, got {start_s}");
            return Err(invalid("start_unix_s", what));
        }
        let tolerance = sections
            .tolerance
            .as_ref()
            .map(|text| text.get_ref().parse());
        let tolerance = tolerance
            .transpose()
            .map_err(|what: String| invalid("tolerance", what))?;
        let requests = sections.effects.clone();
        let lines = EffectsConfig::NAMES.iter().copied();
        let lines = lines
            .filter(|name| requests.has_key(name))
            .map(|name| EffectLine {
                name,
                line: Some(line_of_value(text, &format!("effects.{name}"))),
            });
        Ok(Self {
            simulation: Simulation {
                scene: Arc::default(),
                sensor,
                returns,
                rotation,
                mount: sections.mount.build()?,
                motion,
                polls,
                start: Stamp::<Host>::from_nanos((start_s * 1e9).round() as i64),
                clock_at_start_us: sections.lidar_clock_us,
            },
            effects: SceneEffects::default(),
            text: text.to_owned(),
            seed,
            tolerance,
            demands: Vec::new(),
            file_lines: lines.collect(),
            config: requests.clone(),
            requests,
            movers: MovingObjects::default(),
            beam: None,
        })
    }

    /// Whether the effect is on without a tolerance: by the file, or because a fact calls for it.
    #[must_use]
    pub fn is_requested(&self, name: &str) -> bool {
        let is_demanded = || self.demands.iter().any(|demand| demand.effect == name);
        let is_configured = || {
            self.requests
                .configured()
                .any(|configured| configured == name)
        };
        is_configured() || (is_demanded() && !self.requests.is_off(name))
    }

    /// Whether the effect is on in any case (`true` in the file).
    #[must_use]
    pub fn is_forced(&self, name: &str) -> bool {
        self.requests.forced().any(|forced| forced == name)
    }

    /// The first demand for an effect.
    #[must_use]
    pub fn demand(&self, name: &str) -> Option<&EffectDemand> {
        self.demands.iter().find(|demand| demand.effect == name)
    }

    /// The line of the effect's key in `[effects]`, from 1.
    #[must_use]
    pub fn file_line(&self, name: &str) -> Option<usize> {
        let line = self.file_lines.iter().find(|line| line.name == name);
        line.and_then(|line| line.line)
    }

    /// Refuses effects that are switched on without the settings that they need.
    fn check_empty(&self, stated: &[StatedFact]) -> Result<(), InvalidValue> {
        let requests = &self.requests;
        let is_stated = |effect| stated.iter().any(|fact| fact.effect == effect);
        for (effect, is_on, fact) in [
            ("weather", requests.weather.is_on(), "[weather]"),
            ("base_drift", requests.base_drift.is_on(), "[base]"),
            (
                "own_shadow",
                requests.own_shadow.is_on(),
                "shadow in [mount]",
            ),
        ] {
            if is_on && !is_stated(effect) {
                let path = format!("effects.{effect}");
                let what =
                    format!("{path}: expected a table of settings, or {fact}, got true alone");
                return Err(invalid(path, what));
            }
        }
        let nothing = WeatherSettings::default();
        if self.config.weather.settings() == Some(&nothing) && !requests.is_off("weather") {
            let is_table = requests.weather.settings().is_some() && !requests.weather.is_on();
            let path = if is_table {
                "effects.weather"
            } else {
                "weather"
            };
            let what = format!("{path}: expected visibility_m or rain_mm_h, got neither");
            return Err(invalid(path, what));
        }
        Ok(())
    }

    /// An invalid setting at its place in the file: in `[effects]`, or in the section of a fact.
    fn invalid_value(&self, stated: &[StatedFact], error: &InvalidSetting) -> InvalidValue {
        let fact = stated.iter().find(|fact| fact.effect == error.effect);
        let is_requested = self.requests.configured().any(|name| name == error.effect);
        // `true` leaves the settings to the fact.
        let is_table = is_requested && !self.is_forced(error.effect);
        let table = match fact {
            Some(fact) if !is_table => fact.path.to_owned(),
            _ => format!("effects.{}", error.effect),
        };
        let path = format!("{table}.{}", error.setting);
        let what = format!("{path}: expected {}, got {}", error.expected, error.got);
        invalid(path, what)
    }

    /// Those effects that `keep` selects, of the file's and those that the scene's facts call for.
    /// They draw the same random numbers in every selection, and share what they know of the scene:
    /// the simulation must not be changed between runs.
    ///
    /// # Errors
    /// [`InvalidSetting`] for the first setting that is invalid.
    pub fn select(
        &self,
        keep: impl Fn(&str) -> bool,
        stopwatch: Stopwatch,
    ) -> Result<SceneEffects, InvalidSetting> {
        let mut effects = self.config.clone().only(keep).build(self.seed, stopwatch)?;
        for objects in &mut effects.firings.objects {
            // No other effect moves objects.
            *objects = MeteredEffect::new(Arc::new(self.movers.clone()), stopwatch);
        }
        let beams = &mut effects.firings.beam;
        let footprints = beams
            .iter_mut()
            .filter(|beam| beam.effect.name() == Divergence::NAME);
        for (footprint, beam) in footprints.zip(&self.beam) {
            *footprint = MeteredEffect::new(Arc::<Divergence>::clone(beam), stopwatch);
        }
        let line = |name: &str| {
            let demand = self.demand(name).and_then(|demand| demand.line);
            self.file_line(name).or(demand)
        };
        let lines = (effects.usage().iter())
            .map(|used| EffectLine {
                name: used.name,
                line: line(used.name),
            })
            .collect();
        Ok(SceneEffects { effects, lines })
    }

    /// Whether a beam could meet anything.
    #[must_use]
    pub fn has_objects(&self) -> bool {
        let placed = self.simulation.scene.placed();
        !placed.objects.is_empty() || !self.movers.movers().is_empty()
    }

    /// Those effects, for a sample: of the firings only each `every`-th has returns.
    ///
    /// # Errors
    /// As [`SceneFile::select`].
    pub fn sampled(
        &self,
        keep: impl Fn(&str) -> bool,
        every: u64,
        stopwatch: Stopwatch,
    ) -> Result<ConfiguredEffects, InvalidSetting> {
        let mut effects = self.select(keep, stopwatch)?.effects;
        let sample = Arc::new(FiringSample { every });
        (effects.firings.view).push(MeteredEffect::new(sample, None));
        Ok(effects)
    }
}

#[cfg(test)]
mod tests;
