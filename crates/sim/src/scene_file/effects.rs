//! `[effects]`: a table for each effect, by its name, and nothing for those that are not there.
//!
//! One field here, one file in [`crate::effects`], one arm in `build`.

use std::ops::Range;
use std::sync::Arc;

use serde::Deserialize;
use toml::Spanned;

use super::{Wrong, finite};
use crate::effects::{Asked, RangeNoise};

/// The section as it is written.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Section {
    range_noise: Option<Spanned<RangeNoiseSection>>,
}

/// `[effects.range_noise]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RangeNoiseSection {
    /// One standard deviation, metres.
    sd_m: Spanned<f64>,
}

/// The effects of a scene.
#[derive(Debug, Default)]
pub struct AskedFor {
    /// All of them, as the engine takes them.
    pub effects: Asked,
    /// Where each is asked for, in the order of the file's sections.
    pub lines: Vec<EffectLine>,
    places: Vec<usize>,
}

/// Where a scene file asks for an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EffectLine {
    /// Its name.
    pub name: &'static str,
    /// The line, from 1.
    pub line: usize,
}

impl AskedFor {
    /// Whether there is none: nothing of effects has to be in the run then.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        self.lines.is_empty()
    }

    fn note(&mut self, name: &'static str, at: Range<usize>) {
        self.lines.push(EffectLine { name, line: 0 });
        self.places.push(at.start);
    }

    pub(super) fn find_lines(&mut self, line_of: impl Fn(usize) -> usize) {
        for (line, at) in self.lines.iter_mut().zip(&self.places) {
            line.line = line_of(*at);
        }
    }
}

impl Section {
    pub fn build(&self, seed: u64, clock: Option<fn() -> u64>) -> Result<AskedFor, Wrong> {
        let mut asked = AskedFor::default();
        if let Some(section) = &self.range_noise {
            let sd_m = &section.get_ref().sd_m;
            let metres = finite(sd_m, "a standard deviation in metres")?;
            if metres < 0.0 {
                let what = format!("expected a standard deviation of 0 m or more, got {metres}");
                return Err(Wrong::new(sd_m.span(), what));
            }
            let effect = Arc::new(RangeNoise::new(metres, seed));
            let surface = &mut asked.effects.firings.surface;
            surface.push(crate::effects::Listed::new(effect, clock));
            asked.note(RangeNoise::NAME, section.span());
        }
        Ok(asked)
    }
}
