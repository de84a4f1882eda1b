//! The argument of `analyze --sweep`: parameters of a pattern with their ranges.

use std::str::FromStr;

/// Parameters to vary.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepRanges {
    pub(crate) ranges: Vec<SettingRange>,
}

/// One parameter with its range.
#[derive(Clone, Debug, PartialEq)]
pub struct SettingRange {
    pub(crate) key: String,
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) steps: usize,
}

/// Default number of steps.
const STEPS: usize = 8;
/// Upper limit on settings.
const MOST: usize = 10_000;

impl FromStr for SweepRanges {
    type Err = String;

    /// `KEY=FROM..TO[/N]`, several with commas.
    fn from_str(text: &str) -> Result<Self, String> {
        let ranges: Vec<SettingRange> = text
            .split(',')
            .map(SettingRange::from_str)
            .collect::<Result<_, _>>()?;
        for (place, range) in ranges.iter().enumerate() {
            if ranges
                .iter()
                .take(place)
                .any(|other| other.key == range.key)
            {
                return Err(format!("{}: expected one range of it, got two", range.key));
            }
        }
        let settings = ranges
            .iter()
            .try_fold(1_usize, |all, range| all.checked_mul(range.steps));
        match settings {
            Some(1..=MOST) => Ok(Self { ranges }),
            _ => Err(format!("expected at most {MOST} settings in all")),
        }
    }
}

impl FromStr for SettingRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("expected KEY=FROM..TO or KEY=FROM..TO/STEPS, got {text:?}");
        let (key, range) = text.split_once('=').ok_or_else(wrong)?;
        if matches!(key, "tilt" | "seam") {
            return Err(format!(
                "{key} is no number and has no range: set it in the pattern's name, as in velomotion16:50,{}",
                if key == "tilt" {
                    "tilt=stepped"
                } else {
                    "seam=once"
                }
            ));
        }
        let (range, steps) = match range.split_once('/') {
            Some((range, steps)) => (range, steps.parse().map_err(|_| wrong())?),
            None => (range, STEPS),
        };
        let (from, to) = range.split_once("..").ok_or_else(wrong)?;
        let number = |text: &str| text.parse::<f64>().ok().filter(|n| n.is_finite());
        let (from, to) = (
            number(from).ok_or_else(wrong)?,
            number(to).ok_or_else(wrong)?,
        );
        if steps == 0 || (steps == 1 && from != to) {
            return Err(format!(
                "{key}: expected at least 2 steps from {from} to {to}"
            ));
        }
        // A single value is a single setting.
        let steps = if from == to { 1 } else { steps };
        let key = key.to_owned();
        Ok(Self {
            key,
            from,
            to,
            steps,
        })
    }
}

impl SettingRange {
    /// Value of a step: geometric if both ends are positive, else linear. Both ends are exact;
    /// rates between are those that heads have, multiples of 60 rpm.
    pub(crate) fn value(&self, step: usize) -> f64 {
        if step == 0 {
            return self.from;
        }
        if step + 1 >= self.steps {
            return self.to;
        }
        let share = step as f64 / (self.steps - 1) as f64;
        let value = if self.from > 0.0 && self.to > 0.0 {
            self.from * (self.to / self.from).powf(share)
        } else {
            self.from + (self.to - self.from) * share
        };
        match self.key.as_str() {
            "rpm" => (value / 60.0).round() * 60.0,
            _ => value,
        }
    }
}
