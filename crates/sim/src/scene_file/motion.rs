//! `[motion]`: how the tilt axis moves, or for how long it stands.

use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::Wrong;
use crate::motion::{Motion, MotionError, Sweeps};

/// The section as it is written. Which keys belong to which kind is checked here and not by serde, which would lose the line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Section {
    kind: Kind,
    /// Fixed: the angle, degrees.
    angle_deg: Option<Spanned<f64>>,
    /// Fixed: for how long, seconds.
    duration_s: Option<Spanned<f64>>,
    /// Sweeps: where they begin, degrees.
    from_deg: Option<Spanned<f64>>,
    /// Where they end.
    to_deg: Option<Spanned<f64>>,
    /// How fast, degrees per second.
    speed_deg_s: Option<Spanned<f64>>,
    /// How quickly that is reached; absent: at once, as ideal scan patterns have it.
    accel_deg_s2: Option<Spanned<f64>>,
    /// How many.
    count: Option<Spanned<u32>>,
    /// Whether the way back is one too.
    both_ways: Option<Spanned<bool>>,
    /// How long the axis rests before, between and after, seconds.
    rest_s: Option<Spanned<f64>>,
}

/// The kinds by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Kind {
    /// The axis stands.
    Fixed,
    /// It sweeps.
    Sweeps,
}

/// Time for the drive to be asked where it is at rest, and to be told where to go.
const REST_S: f64 = 0.1;

impl Section {
    pub fn build(&self, section: Range<usize>) -> Result<Motion, Wrong> {
        match self.kind {
            Kind::Fixed => self.fixed(section),
            Kind::Sweeps => self.sweeps(section),
        }
    }

    fn fixed(&self, section: Range<usize>) -> Result<Motion, Wrong> {
        refuse(
            "an axis that stands has no such key",
            &[
                span(&self.from_deg),
                span(&self.to_deg),
                span(&self.speed_deg_s),
                span(&self.accel_deg_s2),
                span(&self.count),
                span(&self.both_ways),
                span(&self.rest_s),
            ],
        )?;
        let duration_s = needed(&self.duration_s, "duration_s", &section)?;
        let angle_deg = self
            .angle_deg
            .as_ref()
            .map_or(0.0, |angle| *angle.get_ref());
        Motion::fixed(angle_deg, duration_s).map_err(|error| self.refused(&error, section))
    }

    fn sweeps(&self, section: Range<usize>) -> Result<Motion, Wrong> {
        refuse(
            "sweeps have no such key: they last as long as they take",
            &[span(&self.angle_deg), span(&self.duration_s)],
        )?;
        let both_ways = self.both_ways.as_ref().is_some_and(|both| *both.get_ref());
        let one_each = if both_ways { 2 } else { 1 };
        let sweeps = Sweeps {
            from_deg: needed(&self.from_deg, "from_deg", &section)?,
            to_deg: needed(&self.to_deg, "to_deg", &section)?,
            speed_deg_s: needed(&self.speed_deg_s, "speed_deg_s", &section)?,
            accel_deg_s2: self.accel_deg_s2.as_ref().map(|accel| *accel.get_ref()),
            count: self
                .count
                .as_ref()
                .map_or(one_each, |count| *count.get_ref()),
            both_ways,
            rest_s: self.rest_s.as_ref().map_or(REST_S, |rest| *rest.get_ref()),
        };
        if let Some(count) = self.count.as_ref().filter(|_| sweeps.count == 0) {
            return Err(Wrong::new(
                count.span(),
                "count: expected a sweep at least, got 0",
            ));
        }
        Motion::sweeps(&sweeps).map_err(|error| self.refused(&error, section))
    }

    /// A value that cannot be, where it stands.
    fn refused(&self, error: &MotionError, section: Range<usize>) -> Wrong {
        let at = match error {
            MotionError::TooMany { .. } => span(&self.count),
            MotionError::Number { key, .. } => match *key {
                "angle_deg" => span(&self.angle_deg),
                "duration_s" => span(&self.duration_s),
                "from_deg" => span(&self.from_deg),
                "to_deg" => span(&self.to_deg),
                "speed_deg_s" => span(&self.speed_deg_s),
                "accel_deg_s2" => span(&self.accel_deg_s2),
                "rest_s" => span(&self.rest_s),
                _ => None,
            },
        };
        Wrong::new(at.unwrap_or(section), error.to_string())
    }
}

/// Complains of the first key that is there.
fn refuse(why: &str, keys: &[Option<Range<usize>>]) -> Result<(), Wrong> {
    match keys.iter().flatten().next() {
        Some(at) => Err(Wrong::new(at.clone(), why)),
        None => Ok(()),
    }
}

fn span<T>(key: &Option<Spanned<T>>) -> Option<Range<usize>> {
    key.as_ref().map(Spanned::span)
}

fn needed(key: &Option<Spanned<f64>>, name: &str, section: &Range<usize>) -> Result<f64, Wrong> {
    match key {
        Some(number) => Ok(*number.get_ref()),
        None => Err(Wrong::new(
            section.clone(),
            format!("[motion] lacks {name}"),
        )),
    }
}
