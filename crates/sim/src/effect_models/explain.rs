//! The work of effects in a run: which are on and by which line, how often
//! they acted, their cost, and which were not needed.

use super::EffectsConfig;
use crate::effects::EffectUsage;

use serde::Serialize;
use utoipa::ToSchema;

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
    /// Unit of its calls: firings, polls...
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
    /// Reason why it was not needed, if it never acted.
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
    fn effects_that_ran_and_absent_ones_are_all_effects() {
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
        let [divergence, noise, weather] = &explanation.on[..] else {
            panic!("{explanation:?}")
        };
        assert_eq!((divergence.line, divergence.acted_percent), (Some(14), 0.0));
        assert!(divergence.not_needed.unwrap().starts_with("no edge lies"));
        assert_eq!((noise.line, noise.acted_percent), (None, 100.0));
        assert_eq!((noise.not_needed, noise.time_percent), (None, Some(25.0)));
        assert_eq!(weather.changed, 48);
        assert_eq!(
            explanation.on.len() + explanation.absent.len(),
            EffectsConfig::NAMES.len()
        );
    }

    #[test]
    fn explanations_without_effects_or_timings_are_valid() {
        let nothing = Explanation::new(&[], &[], 0);
        assert_eq!(nothing.absent, EffectsConfig::NAMES);
        let unmeasured = Explanation::new(&[used("weather", 1)], &[], 0);
        assert_eq!(unmeasured.on[0].time_percent, None);
    }
}
