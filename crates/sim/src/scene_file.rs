//! Scene files: TOML in, a [`Simulation`] and its effects out.
//!
//! Each key of `[effects]` is a table named after an effect of [`crate::effect_models`]; an effect
//! without a table is absent. The surroundings are the file's own objects or a shipped scene
//! (`scene = "hall"`), see [`crate::scenery`]. Unknown keys are errors, and errors name the line.

mod demands;
mod sections;
mod surroundings;

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Deserialize;
use thiserror::Error;
use toml::Spanned;
use units::{Host, Stamp};

use crate::effect_models::{EffectsConfig, InvalidSetting, MovingObjects};
use crate::effects::{ConfiguredEffects, FiringSample, MeteredEffect, Stopwatch};
use crate::scenery::{
    FilePosition, InvalidValue, MaterialTable, ObjectTable, line_of_value, no_files,
};
use crate::simulate::Simulation;
use demands::SceneFacts;
use sections::{DriveSection, MotionSection, MountSection, SensorSection, invalid};

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
    /// Seed of all random draws.
    pub seed: u64,
    /// Effects that the scene's facts call for, configured or not.
    pub demands: Vec<EffectDemand>,
    config: EffectsConfig,
    file_lines: Vec<EffectLine>,
    /// The objects of the scene that move.
    movers: MovingObjects,
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

    /// Sets all moving objects, those of the scene and those of the effect's table. Without a
    /// table, `line` configures the effect.
    fn set_moving_objects(&mut self, all: MovingObjects, line: usize, stopwatch: Stopwatch) {
        let name = MovingObjects::NAME;
        // No other effect moves objects.
        self.effects.firings.objects = vec![MeteredEffect::new(Arc::new(all), stopwatch)];
        if self.lines.iter().any(|other| other.name == name) {
            return;
        }
        let rank = |name: &str| EffectsConfig::NAMES.iter().position(|known| *known == name);
        let place = (self.lines).partition_point(|other| rank(other.name) < rank(name));
        let line = Some(line);
        self.lines.insert(place, EffectLine { name, line });
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
            what: error.message().to_owned(),
        })?;
        let seed = seed.unwrap_or(sections.seed);
        let mut scene =
            Self::new(&sections, text, seed, stopwatch).map_err(|error| SceneFileError {
                line: line_of_value(text, &error.path),
                what: error.what,
            })?;
        let boxes = sections.effects.moving_objects.clone().unwrap_or_default();
        let is_ideal = sections.sensor.is_ideal();
        let line = |name: &Spanned<String>| FilePosition::of(text, name.span().start).line;
        let lines: BTreeMap<String, usize> = (sections.materials.keys())
            .map(|name| (name.get_ref().clone(), line(name)))
            .collect();
        let surroundings = surroundings::build(text, sections, seed, files)?;
        scene.simulation.scene = surroundings.scene;
        let line = surroundings.first_mover_line;
        scene.movers = MovingObjects::of(&boxes)
            .map_err(|error| SceneFileError {
                line: line.unwrap_or(1),
                what: error.to_string(),
            })?
            .and(surroundings.movers);
        if let Some(line) = line {
            let all = scene.movers.clone();
            scene.effects.set_moving_objects(all, line, stopwatch);
        }
        let of_boxes = scene.effects.line(MovingObjects::NAME);
        scene.file_lines.clone_from(&scene.effects.lines);
        let placed = scene.simulation.scene.placed();
        let facts = SceneFacts {
            is_ideal,
            materials: (placed.materials.iter())
                .map(|material| (material, lines.get(&material.name).copied()))
                .collect(),
            objects: placed.objects.len(),
            movers: (scene.movers.count(), line.or(of_boxes)),
            has_drive: scene.simulation.polls.is_some(),
        };
        scene.demands = facts.demands();
        Ok(scene)
    }

    fn new(
        sections: &Sections,
        text: &str,
        seed: u64,
        stopwatch: Stopwatch,
    ) -> Result<Self, InvalidValue> {
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
        let effects = sections.effects.build(seed, stopwatch).map_err(|error| {
            let path = format!("effects.{}.{}", error.effect, error.setting);
            invalid(path, error.to_string())
        })?;
        let lines = sections.effects.configured().map(|name| EffectLine {
            name,
            line: Some(line_of_value(text, &format!("effects.{name}"))),
        });
        let lines: Vec<EffectLine> = lines.collect();
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
            effects: SceneEffects { effects, lines },
            seed,
            demands: Vec::new(),
            config: sections.effects.clone(),
            file_lines: Vec::new(),
            movers: MovingObjects::default(),
        })
    }

    /// Those effects that `keep` selects, of the file's and those that the scene's facts call for,
    /// which have usual settings if the file has none. They draw the same random numbers in every
    /// selection.
    ///
    /// # Errors
    /// [`InvalidSetting`] for the first setting that is invalid.
    pub fn select(
        &self,
        keep: impl Fn(&str) -> bool,
        stopwatch: Stopwatch,
    ) -> Result<SceneEffects, InvalidSetting> {
        let mut config = self.config.clone();
        for demand in &self.demands {
            config.add_usual(demand.effect);
        }
        let mut effects = config.build(self.seed, stopwatch)?;
        if self.movers.count() > 0 {
            let movers = Arc::new(self.movers.clone());
            effects.firings.objects = vec![MeteredEffect::new(movers, stopwatch)];
        }
        effects.retain(&keep);
        let lines = (effects.usage().iter())
            .map(|used| {
                let demand = self.demands.iter().find(|other| other.effect == used.name);
                let line = self.file_lines.iter().find(|line| line.name == used.name);
                let line = line.and_then(|line| line.line);
                EffectLine {
                    name: used.name,
                    line: line.or(demand.and_then(|demand| demand.line)),
                }
            })
            .collect();
        Ok(SceneEffects { effects, lines })
    }

    /// Those effects, for a sample: of the firings only each `every`-th has returns.
    ///
    /// # Errors
    /// As [`SceneFile::select`].
    pub fn sampled(
        &self,
        keep: impl Fn(&str) -> bool,
        every: u64,
    ) -> Result<ConfiguredEffects, InvalidSetting> {
        let mut effects = self.select(keep, None)?.effects;
        let sample = Arc::new(FiringSample { every });
        (effects.firings.view).push(MeteredEffect::new(sample, None));
        Ok(effects)
    }
}

#[cfg(test)]
mod tests;
