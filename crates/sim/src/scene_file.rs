//! Scene files: TOML in, a [`Simulation`] and its effects out.
//!
//! Every key of `[effects]` is a table of its own and the name of one file in [`crate::effects`]; a scene file without it has no such effect, and
//! without any there is none at all. What stands around the scanner is [`crate::scenery`]'s, of the file itself or of a scene that comes with the simulator
//! (`scene = "hall"`). Keys that are not known are errors, and errors name the line. Left out: reading files.

mod around;
mod drive;
mod effects;
mod motion;
mod sensor;

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;
use serde::Deserialize;
use thiserror::Error;
use toml::Spanned;
use units::{Host, Stamp};

use crate::effects::{MovingObjects, Wishes};
pub use crate::scenery::SHIPPED;
use crate::scenery::{MaterialTable, ObjectTable, no_files, rotation};
use crate::simulate::{Mount, Simulation};
pub use effects::{AskedFor, EffectLine};

/// What a scene file asks for.
#[derive(Debug)]
pub struct Scene {
    /// What is to be simulated.
    pub simulation: Simulation,
    /// The effects and the lines that ask for them.
    pub effects: AskedFor,
    /// What draws depend on.
    pub seed: u64,
}

/// What is wrong with a scene file.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("line {line}: {what}")]
pub struct SceneError {
    /// Which line, from 1.
    pub line: usize,
    /// What is wrong there.
    pub what: String,
}

/// The file as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    /// What draws depend on.
    #[serde(default)]
    seed: u64,
    /// Host time of the start, Unix seconds.
    #[serde(default = "default_start")]
    start_unix_s: Spanned<f64>,
    /// What the lidar's clock shows then, microseconds past the hour.
    #[serde(default)]
    lidar_clock_us: u32,
    /// What it shows, for people.
    #[serde(default, rename = "about")]
    _about: String,
    /// What stands around, by the name of a scene that comes with the simulator; else the next two say it.
    scene: Option<Spanned<String>>,
    /// What things are made of.
    #[serde(default)]
    materials: BTreeMap<Spanned<String>, Spanned<MaterialTable>>,
    /// What there is.
    #[serde(default)]
    objects: Vec<Spanned<ObjectTable>>,
    #[serde(default)]
    sensor: sensor::Section,
    motion: Spanned<motion::Section>,
    #[serde(default)]
    mount: MountSection,
    #[serde(default)]
    drive: drive::Section,
    #[serde(default)]
    effects: Wishes,
}

/// `[mount]`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct MountSection {
    /// Height of the lidar's origin above the tilt axis, metres (d of Eq. 4-6).
    #[serde(default)]
    d_m: Option<Spanned<f64>>,
    /// How far it is moved beside that, metres in the frame of the platform: x right, y along the axis, z up.
    position_m: Option<Spanned<[f64; 3]>>,
    /// How it is turned about x, then y, then z of the platform, degrees.
    rotation_deg: Option<Spanned<[f64; 3]>>,
}

impl MountSection {
    fn build(&self) -> Result<Mount, Wrong> {
        let d_m = match &self.d_m {
            Some(d_m) => finite(d_m, "a height in metres")?,
            None => 0.0,
        };
        let three = |key: &Option<Spanned<[f64; 3]>>| match key {
            Some(three) if three.get_ref().iter().all(|number| number.is_finite()) => {
                Ok(*three.get_ref())
            }
            Some(three) => {
                let what = format!("expected three numbers, got {:?}", three.get_ref());
                Err(Wrong::new(three.span(), what))
            }
            None => Ok([0.0; 3]),
        };
        let mut mount = Mount::above(d_m);
        mount.at_m += DVec3::from_array(three(&self.position_m)?);
        mount.turn = rotation(three(&self.rotation_deg)?);
        Ok(mount)
    }
}

/// A time in November 2026.
fn default_start() -> Spanned<f64> {
    Spanned::new(0..0, 1_795_226_733.0)
}

/// Something wrong at a place in the file, before its line is known.
struct Wrong {
    at: Range<usize>,
    what: String,
}

impl Wrong {
    fn new(at: Range<usize>, what: impl Into<String>) -> Self {
        Self {
            at,
            what: what.into(),
        }
    }

    fn in_file(self, text: &str) -> SceneError {
        SceneError {
            line: line_of(text, self.at.start),
            what: self.what,
        }
    }
}

/// A number that must be finite.
fn finite(number: &Spanned<f64>, what: &str) -> Result<f64, Wrong> {
    let got = *number.get_ref();
    match got.is_finite() {
        true => Ok(got),
        false => Err(Wrong::new(
            number.span(),
            format!("expected {what}, got {got}"),
        )),
    }
}

/// The line of a byte, from 1.
fn line_of(text: &str, at: usize) -> usize {
    let before = text.as_bytes().get(..at).unwrap_or_default();
    before.iter().filter(|&&byte| byte == b'\n').count() + 1
}

impl Scene {
    /// Reads a scene file. Another seed than the file's may be given; `clock` (nanoseconds from any beginning) measures what effects cost.
    ///
    /// # Errors
    /// [`SceneError`] for what is no TOML, has keys that are not known, lacks some or has values that cannot be.
    pub fn parse(
        text: &str,
        seed: Option<u64>,
        clock: Option<fn() -> u64>,
    ) -> Result<Self, SceneError> {
        Self::parse_with(text, seed, clock, &mut no_files)
    }

    /// The same for a scene that names mesh files: `files` gives the bytes of each by its name in the scene, or says why it cannot.
    ///
    /// # Errors
    /// [`SceneError`], for files that cannot be had too.
    pub fn parse_with(
        text: &str,
        seed: Option<u64>,
        clock: Option<fn() -> u64>,
        files: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, SceneError> {
        let file: File = toml::from_str(text).map_err(|error| SceneError {
            line: error.span().map_or(1, |at| line_of(text, at.start)),
            what: error.message().to_owned(),
        })?;
        let seed = seed.unwrap_or(file.seed);
        let mut scene = Self::new(&file, text, seed, clock).map_err(|wrong| wrong.in_file(text))?;
        let boxes = file.effects.moving_objects.clone().map(Spanned::into_inner);
        let around = around::build(text, file, seed, files)?;
        scene.simulation.scene = around.scene;
        scene.effects.find_lines(|at| line_of(text, at));
        if let Some(line) = around.line {
            let all =
                MovingObjects::of(&boxes.unwrap_or_default()).map(|boxes| boxes.and(around.movers));
            let all = all.map_err(|unfit| SceneError {
                line,
                what: unfit.to_string(),
            })?;
            scene.effects.move_objects(all, line, clock);
        }
        Ok(scene)
    }

    fn new(file: &File, text: &str, seed: u64, clock: Option<fn() -> u64>) -> Result<Self, Wrong> {
        let (sensor, returns, spin) = file.sensor.build()?;
        let motion = file.motion.get_ref().build(file.motion.span())?;
        let polls = match motion.is_fixed() {
            true => None,
            false => Some(file.drive.build()?),
        };
        let start_s = finite(&file.start_unix_s, "Unix seconds")?;
        if !(0.0..1e10).contains(&start_s) {
            let what = format!("expected Unix seconds from 0 to 1e10, got {start_s}");
            return Err(Wrong::new(file.start_unix_s.span(), what));
        }
        Ok(Self {
            simulation: Simulation {
                scene: Arc::default(),
                sensor,
                returns,
                spin,
                mount: file.mount.build()?,
                motion,
                polls,
                start: Stamp::<Host>::from_nanos((start_s * 1e9).round() as i64),
                clock_at_start_us: file.lidar_clock_us,
            },
            effects: AskedFor::new(&file.effects, text, seed, clock)?,
            seed,
        })
    }
}

#[cfg(test)]
mod tests;
