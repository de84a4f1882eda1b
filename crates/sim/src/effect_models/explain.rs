//! The work of effects in a run, as a table and as JSON: which are on and by which line, how often
//! they acted, their cost, and which were not needed.

use super::EffectsConfig;
use crate::effects::EffectUsage;
use core::fmt::{self, Display, Write};

use serde::Serialize;
use utoipa::ToSchema;

/// Width of the table, columns.
const WIDTH: usize = 80;

/// The line of a scene file that configures an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct EffectLine {
    /// Name of the effect.
    pub name: &'static str,
    /// The line, from 1; absent for an effect that no line configures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
}

/// One effect that was on.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct EffectExplanation {
    /// Its name.
    pub effect: &'static str,
    /// The line of the scene file that configures it, from 1.
    pub line: Option<usize>,
    /// What it was called for: firings, polls...
    pub each: &'static str,
    /// Calls.
    pub asked: u64,
    /// Calls that changed anything.
    pub acted: u64,
    /// The same in percent of the calls; 0 without calls.
    pub acted_percent: f64,
    /// Changes in all: lasers, steps, messages.
    pub changed: u64,
    /// Its share of the run's time, percent; `None` if not measured.
    pub time_percent: Option<f64>,
    /// Why it was not needed, if it never acted.
    pub not_needed: Option<&'static str>,
}

/// The effects of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct Explanation {
    /// Effects that were on, in the order in which they act.
    pub on: Vec<EffectExplanation>,
    /// Effects that are not configured; none of their code ran.
    pub absent: Vec<&'static str>,
}

impl Explanation {
    /// From the counts of effects. `lines` are the lines that configure them; `busy_ns` is the
    /// working time of all threads (0 if not measured).
    #[must_use]
    pub fn new(used: &[EffectUsage], lines: &[EffectLine], busy_ns: u64) -> Self {
        let line = |name: &str| lines.iter().find(|line| line.name == name);
        let percent = |part: u64, whole: u64| match whole {
            0 => 0.0,
            whole => 100.0 * part as f64 / whole as f64,
        };
        let on = used.iter().map(|used| EffectExplanation {
            effect: used.name,
            line: line(used.name).and_then(|line| line.line),
            each: used.each,
            asked: used.counts.calls,
            acted: used.counts.acted,
            acted_percent: percent(used.counts.acted, used.counts.calls),
            changed: used.counts.changed,
            time_percent: (busy_ns > 0).then(|| percent(used.counts.spent_ns, busy_ns)),
            not_needed: (used.counts.acted == 0).then_some(used.idle_reason),
        });
        let is_on = |name: &&str| used.iter().any(|used| used.name == *name);
        Self {
            on: on.collect(),
            absent: (EffectsConfig::NAMES.iter().copied())
                .filter(|name| !is_on(name))
                .collect(),
        }
    }
}

impl Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.on.is_empty() {
            writeln!(
                f,
                "{:<22} {:>5}  {:>24}  {:>10}  {:>7}",
                "effect", "line", "acted in", "changed", "time"
            )?;
        }
        for effect in &self.on {
            let line = (effect.line).map_or_else(|| "-".to_owned(), |line| line.to_string());
            let time = match effect.time_percent {
                Some(percent) => format!("{percent:.1} %"),
                None => "-".to_owned(),
            };
            let acted = format!("{} of {}", share(effect.acted_percent), effect.each);
            let (name, changed) = (effect.effect, effect.changed);
            writeln!(
                f,
                "{name:<22} {line:>5}  {acted:>24}  {changed:>10}  {time:>7}"
            )?;
        }
        for effect in &self.on {
            if let Some(why) = effect.not_needed {
                let asked_at =
                    (effect.line).map_or_else(String::new, |line| format!(" (line {line})"));
                wrapped(
                    f,
                    &format!("not needed: {}{asked_at}: {why}", effect.effect),
                )?;
            }
        }
        match self.absent.is_empty() {
            true => Ok(()),
            false => wrapped(f, &format!("absent: {}", self.absent.join(", "))),
        }
    }
}

/// A percentage that is 0 only for none and 100 only for all.
fn share(percent: f64) -> String {
    if percent > 0.0 && percent < 0.1 {
        "below 0.1 %".to_owned()
    } else if percent < 100.0 && percent > 99.9 {
        "above 99.9 %".to_owned()
    } else if percent == 0.0 || percent == 100.0 {
        format!("{percent:.0} %")
    } else {
        format!("{percent:.1} %")
    }
}

/// Wraps words at [`WIDTH`] with an indent after the first line.
fn wrapped(f: &mut fmt::Formatter<'_>, text: &str) -> fmt::Result {
    let mut at = 0;
    for word in text.split(' ') {
        let long = word.chars().count();
        if at > 0 && at + 1 + long > WIDTH {
            write!(f, "\n  {word}")?;
            at = 2 + long;
        } else {
            if at > 0 {
                f.write_char(' ')?;
                at += 1;
            }
            f.write_str(word)?;
            at += long;
        }
    }
    f.write_char('\n')
}

#[cfg(test)]
mod tests {
    use super::Explanation;
    use super::*;
    use crate::effects::UsageCounts;

    fn used(name: &'static str, acted: u64) -> EffectUsage {
        EffectUsage {
            name,
            each: "firings",
            counts: UsageCounts {
                calls: 10_000,
                acted,
                changed: 16 * acted,
                spent_ns: 2_500,
            },
            idle_reason: "no edge lies within a footprint: 0 % of firings took sub-rays",
        }
    }

    #[test]
    fn the_table_fits_80_columns_and_lists_unneeded_effects() {
        let used = [
            used("divergence", 0),
            used("range_noise", 10_000),
            used("weather", 3),
        ];
        let lines = [("divergence", 14), ("weather", 107)];
        let lines = lines.map(|(name, line)| EffectLine {
            name,
            line: Some(line),
        });
        let explanation = Explanation::new(&used, &lines, 10_000);
        let text = explanation.to_string();
        assert!(
            text.lines().all(|line| line.chars().count() <= 80),
            "{text}"
        );
        let has = |words: &str| assert!(text.contains(words), "{words}: {text}");
        let row = |name: &str| -> Vec<&str> {
            let row = text.lines().find(|line| line.starts_with(name));
            row.unwrap().split_whitespace().collect()
        };
        let divergence = [
            "divergence",
            "14",
            "0",
            "%",
            "of",
            "firings",
            "0",
            "25.0",
            "%",
        ];
        assert_eq!(row("divergence"), divergence);
        assert_eq!(
            row("range_noise").join(" "),
            "range_noise - 100 % of firings 160000 25.0 %"
        );
        has("below 0.1 % of firings");
        has("not needed: divergence (line 14): no edge lies within a footprint:");
        has("absent: limited_field_of_view, own_shadow, base_drift, moving_objects,");
        assert!(!text.contains("not needed: range_noise"));
        assert_eq!(
            explanation.on.len() + explanation.absent.len(),
            EffectsConfig::NAMES.len()
        );
    }

    #[test]
    fn explanations_without_effects_or_timings_are_valid() {
        let nothing = Explanation::new(&[], &[], 0);
        assert_eq!(nothing.absent, EffectsConfig::NAMES);
        assert!(nothing.to_string().starts_with("absent: "));
        let unmeasured = Explanation::new(&[used("weather", 1)], &[], 0);
        assert_eq!(unmeasured.on[0].time_percent, None);
    }
}
