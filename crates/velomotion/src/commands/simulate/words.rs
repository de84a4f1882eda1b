//! Sizes of effects in words.

use std::fmt::Write;

use sim::effect_models::Explanation;
use sim::scene_file::EffectDemand;

use super::{EffectSize, Sampler};
use engine::failure::Failure;

/// Width of the text, columns.
const WIDTH: usize = 80;
/// Effects that are off are reported from these sizes on: percent of the points, and millimetres of
/// the 99 % displacement.
const NOTABLE: (f64, f64) = (0.1, 1.0);
/// Up to this number, each effect that is off is measured for its warning.
const FEW: usize = 2;

/// Warnings about effects that are off, though facts of the scene call for them. `measured` has
/// their sizes, if they are known; a tolerance has left out those of `is_chosen_out`.
pub(in crate::commands::simulate) fn unmet(
    sampler: &Sampler<'_>,
    measured: Option<&[EffectSize]>,
    is_chosen_out: &dyn Fn(&str) -> bool,
) -> Result<Vec<String>, Failure> {
    let mut off = sampler.off();
    off.retain(|name| !is_chosen_out(name));
    if measured.is_none() && off.len() > FEW {
        let Some(size) = sampler.size_of_all(&off)?.filter(is_notable) else {
            return Ok(Vec::new());
        };
        let facts: Vec<String> = off.iter().map(|name| fact(sampler, name)).collect();
        let facts = facts.join("; ");
        return Ok(vec![format!(
            "off, though the scene calls for them: {facts}. Together they would {}",
            would(&size)
        )]);
    }
    let measured = match measured {
        Some(measured) => measured.to_vec(),
        None => sampler.sizes(&off)?,
    };
    let unmet = (measured.iter()).filter(|size| off.contains(&size.effect) && is_notable(size));
    Ok(unmet
        .map(|size| {
            let why = size.demand.as_ref().map(EffectDemand::reason_and_line);
            let why = why.map_or_else(String::new, |why| format!(", though {why}"));
            format!("{} is off{why}: it would {}", size.effect, would(size))
        })
        .collect())
}

fn is_notable(size: &EffectSize) -> bool {
    let (percent, mm) = NOTABLE;
    size.gained_percent + size.lost_percent >= percent || size.p99_mm >= mm
}

fn would(size: &EffectSize) -> String {
    format!(
        "add {:.1} % of the points, remove {:.1} %, and move 1 in 100 by {:.1} mm or more",
        size.gained_percent, size.lost_percent, size.p99_mm
    )
}

/// An effect and the fact that calls for it.
fn fact(sampler: &Sampler<'_>, name: &str) -> String {
    match sampler.scene.demand(name) {
        Some(demand) => format!("{name} ({})", demand.reason_and_line()),
        None => name.to_owned(),
    }
}

/// The sizes as a table of at most 80 columns, and how to read it.
pub(in crate::commands::simulate) fn table(sizes: &[EffectSize]) -> String {
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
        "  on: what it does. off: the scene calls for it, and this is what it would do.",
        "  added, removed: points that only one of the clouds has; moved: by over 1 mm.",
        "  median, 99 %, worst: displacements. time: its share of the computing time.",
    ] {
        let _ = writeln!(text, "{line}");
    }
    text
}

/// Why each effect is on or off, how often it acted, and those that are not simulated.
pub(in crate::commands::simulate) fn reasons(
    sizes: &[EffectSize],
    explanation: &Explanation,
) -> String {
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
