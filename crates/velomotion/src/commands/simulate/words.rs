//! Sizes of effects in words.

use std::fmt::Write as _;

use sim::effect_models::Explanation;
use sim::scene_file::EffectDemand;

use engine::simulate::EffectSize;

/// Width of the text, columns.
const WIDTH: usize = 80;
/// The sizes as a table of at most 80 columns, and how to read it.
pub(super) fn table(sizes: &[EffectSize]) -> String {
    let mut text = format!(
        "{:<20} {:>5} {:>6} {:>7} {:>6} {:>7} {:>6} {:>7} {:>5}\n{:<20} {:>5} {:>6} {:>7} {:>6} {:>7} {:>6} {:>7} {:>5}\n",
        "effect",
        "state",
        "added",
        "removed",
        "moved",
        "median",
        "99 %",
        "worst",
        "time",
        "",
        "",
        "%",
        "%",
        "%",
        "mm",
        "mm",
        "mm",
        "%"
    );
    for size in sizes {
        let _ = writeln!(
            text,
            "{:<20} {:>5} {:>6.2} {:>7.2} {:>6.2} {:>7.3} {:>6.1} {:>7.0} {:>5.1}",
            size.effect,
            if size.is_on { "on" } else { "off" },
            size.gained_percent,
            size.lost_percent,
            size.moved_percent,
            size.median_mm,
            size.p99_mm,
            size.worst_mm,
            size.time_percent,
        );
    }
    for line in [
        "The cloud of a sample of the firings, with the effect against without it.",
        "  on: measured change. off: the scene calls for it; the change if it were on.",
        "  added, removed: points that only one of the clouds has; moved: by over 1 mm.",
        "  median, 99 %, worst: displacements. time: its share of the computing time.",
    ] {
        let _ = writeln!(text, "{line}");
    }
    text
}

/// Reasons why effects are on or off, how often they acted, and those that are not simulated.
pub(super) fn reasons(sizes: &[EffectSize], explanation: &Explanation) -> String {
    let mut text = String::from("why\n");
    let mut add = |line: &str| {
        let options = textwrap::Options::new(WIDTH)
            .initial_indent("  ")
            .subsequent_indent("    ");
        text.push_str(&textwrap::fill(line, options));
        text.push('\n');
    };
    for size in sizes {
        let ran = explanation.on.iter().find(|ran| ran.effect == size.effect);
        let line = ran.and_then(|ran| ran.line);
        let mut why = match (&size.demand, line) {
            (Some(demand), _) => demand.reason_and_line(),
            (None, Some(line)) => format!("requested in line {line}"),
            (None, None) => "requested".to_owned(),
        };
        if let Some(estimate) = size.demand.as_ref().and_then(EffectDemand::estimate) {
            let _ = write!(why, ", estimated {estimate}");
        }
        match ran {
            Some(ran) => match ran.not_needed {
                Some(idle) => _ = write!(why, "; never acted: {idle}"),
                None => {
                    _ = write!(why, "; acted in {:.1} % of {}", ran.acted_percent, ran.each);
                }
            },
            None => why.push_str("; off"),
        }
        add(&format!("{}: {why}", size.effect));
    }
    let not_called: Vec<&str> = (explanation.absent.iter().copied())
        .filter(|name| sizes.iter().all(|size| size.effect != *name))
        .collect();
    if !not_called.is_empty() {
        add(&format!(
            "nothing in the scene calls for: {}",
            not_called.join(", ")
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroUsize;

    use engine::simulate::{Sampler, nanoseconds, read};
    use sim::effect_models::EffectsConfig;

    use super::*;

    #[test]
    fn the_explanation_fits_80_columns_and_names_every_effect() {
        let text = "scene = \"hall\"\n[motion]\nkind = \"sweeps\"\nfrom_deg = 0\nto_deg = -30\n\
                    speed_deg_s = 60\naccel_deg_s2 = 500\n[effects]\nlink_jitter = false\n";
        let scene = read("test", text, None, Some(nanoseconds)).unwrap();
        let sampler = Sampler::new(&scene, NonZeroUsize::MIN);
        let sizes = sampler.sizes(&sampler.candidates()).unwrap();
        let effects = &scene.effects;
        let explanation = Explanation::new(&effects.effects.usage(), &effects.lines, 1);
        let text = table(&sizes) + &reasons(&sizes, &explanation);
        assert!(
            text.lines().all(|line| line.chars().count() <= 80),
            "{text}"
        );
        for name in EffectsConfig::NAMES {
            assert!(text.contains(name), "{name}: {text}");
        }
        let state = |name: &str| {
            let row = text.lines().find(|line| line.starts_with(name)).unwrap();
            row.split_whitespace().nth(1).unwrap().to_owned()
        };
        assert_eq!(
            (state("link_jitter"), state("reflectance")),
            ("off".into(), "on".into())
        );
    }
}
