//! `[effects]`: a table for each effect, by its name, and nothing for those that are not there.
//!
//! Which there are, and what their tables say, is [`crate::effects::Wishes`]; here they get their lines.

use std::sync::Arc;

use super::Wrong;
use crate::effects::{Asked, Listed, MovingObjects, Stopwatch, Wish, Wishes};

/// The effects of a scene.
#[derive(Debug, Default)]
pub struct AskedFor {
    /// All of them, as the engine takes them.
    pub effects: Asked,
    /// Where each is asked for, in the order in which they act.
    pub lines: Vec<EffectLine>,
    wishes: Vec<Wish>,
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
    pub(super) fn new(
        wishes: &Wishes,
        text: &str,
        seed: u64,
        clock: Option<fn() -> u64>,
    ) -> Result<Self, Wrong> {
        let effects = wishes.make(seed, clock).map_err(|wrong| {
            let offset = wrong.offset(text);
            Wrong::new(offset..offset, wrong.unfit.to_string())
        })?;
        Ok(Self {
            effects,
            lines: Vec::new(),
            wishes: wishes.asked_for(),
        })
    }

    /// Whether there is none: nothing of effects has to be in the run then.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        self.lines.is_empty()
    }

    /// Objects of the scene that move, together with those of the effect's own table, if there is one; else the effect is asked for by that line.
    pub(super) fn move_objects(&mut self, all: MovingObjects, line: usize, clock: Stopwatch) {
        let name = MovingObjects::NAME;
        // No other effect moves anything.
        self.effects.firings.objects = vec![Listed::new(Arc::new(all), clock)];
        if self.lines.iter().any(|asked| asked.name == name) {
            return;
        }
        let place = |name: &str| Wishes::NAMES.iter().position(|known| *known == name);
        let at = self
            .lines
            .partition_point(|asked| place(asked.name) < place(name));
        self.lines.insert(at, EffectLine { name, line });
    }

    /// Leaves out effects that the file asks for, by name: as if it did not. What is left draws as before.
    pub fn leave_out(&mut self, is_out: impl Fn(&str) -> bool) {
        self.effects.retain(|name| !is_out(name));
        self.lines.retain(|line| !is_out(line.name));
        self.wishes.retain(|wish| !is_out(wish.name));
    }

    pub(super) fn find_lines(&mut self, line_of: impl Fn(usize) -> usize) {
        let line = |wish: &Wish| EffectLine {
            name: wish.name,
            line: line_of(wish.at.start),
        };
        self.lines = self.wishes.iter().map(line).collect();
    }
}
