//! What effects did in a run, told to people and programs: which are on and by which line, how often they acted, what they cost, and which were not needed.
//!
//! Left out: measuring (lists of effects count, [`super::Listed`]), and JSON itself: [`Explanation`] can be serialised.

use core::fmt::{self, Display, Write};

use serde::Serialize;

use super::{Used, Wishes};

/// The width that the table keeps to, columns.
const WIDTH: usize = 80;

/// One effect that was on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explained {
    /// Its name.
    pub effect: &'static str,
    /// The line of the scene that asked for it, from 1, where it was a file's.
    pub line: Option<usize>,
    /// What it was asked for each of.
    pub each: &'static str,
    /// How often it was asked.
    pub asked: u64,
    /// How often it changed anything.
    pub acted: u64,
    /// The same as a share of how often it was asked, percent; 0 if never.
    pub acted_percent: f64,
    /// What it changed altogether: lasers, steps, parcels.
    pub changed: u64,
    /// Its share of the run's time, percent; `None` if that was not measured.
    pub time_percent: Option<f64>,
    /// Why it was not needed, if it never acted.
    pub not_needed: Option<&'static str>,
}

/// The effects of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Explanation {
    /// Those that were on, in the order in which they act.
    pub on: Vec<Explained>,
    /// Those that were not asked for: nothing of them was run.
    pub absent: Vec<&'static str>,
}

impl Explanation {
    /// Of what effects did; `lines` says by name which line asked for them, `busy_ns` how long all threads together worked (0: not measured).
    #[must_use]
    pub fn new(used: &[Used], lines: &[(&str, usize)], busy_ns: u64) -> Self {
        let line = |name: &str| lines.iter().find(|(other, _)| *other == name);
        let percent = |part: u64, whole: u64| match whole {
            0 => 0.0,
            whole => 100.0 * part as f64 / whole as f64,
        };
        let on = used.iter().map(|used| Explained {
            effect: used.name,
            line: line(used.name).map(|(_, line)| *line),
            each: used.each,
            asked: used.usage.asked,
            acted: used.usage.acted,
            acted_percent: percent(used.usage.acted, used.usage.asked),
            changed: used.usage.changed,
            time_percent: (busy_ns > 0).then(|| percent(used.usage.spent_ns, busy_ns)),
            not_needed: (used.usage.acted == 0).then_some(used.why_idle),
        });
        let is_on = |name: &&str| used.iter().any(|used| used.name == *name);
        Self {
            on: on.collect(),
            absent: (Wishes::NAMES.iter().copied())
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

/// A percentage that is 0 only for nothing and 100 only for all.
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

/// Words in lines of at most [`WIDTH`], indented after the first.
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
    use super::*;
    use crate::effects::Usage;

    fn used(name: &'static str, acted: u64) -> Used {
        Used {
            name,
            each: "firings",
            usage: Usage {
                asked: 10_000,
                acted,
                changed: 16 * acted,
                spent_ns: 2_500,
            },
            why_idle: "no edge lies within a footprint: 0 % of firings took sub-rays",
        }
    }

    #[test]
    fn the_table_keeps_to_80_columns_and_says_what_was_not_needed() {
        let used = [
            used("divergence", 0),
            used("range_noise", 10_000),
            used("weather", 3),
        ];
        let explanation = Explanation::new(&used, &[("divergence", 14), ("weather", 107)], 10_000);
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
        has("absent: limited_field_of_view, own_shadow, moving_objects,");
        assert!(!text.contains("not needed: range_noise"));
        assert_eq!(
            explanation.on.len() + explanation.absent.len(),
            Wishes::NAMES.len()
        );
    }

    #[test]
    fn nothing_on_and_nothing_measured() {
        let nothing = Explanation::new(&[], &[], 0);
        assert_eq!(nothing.absent, Wishes::NAMES);
        assert!(nothing.to_string().starts_with("absent: "));
        let unmeasured = Explanation::new(&[used("weather", 1)], &[], 0);
        assert_eq!(unmeasured.on[0].time_percent, None);
    }
}
