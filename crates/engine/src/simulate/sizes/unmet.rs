//! Effects that are off though the scene calls for them, in words.

use sim::scene_file::EffectDemand;

use super::{EffectSize, Sampler};
use crate::failure::Failure;

/// Effects that are off are reported if they would change so many of the points, percent.
const NOTABLE_PERCENT: f64 = 0.1;
/// Up to this number, each effect that is off is measured for its warning.
const FEW: usize = 2;

/// Warnings about effects that are off, though facts of the scene call for them. `measured` has
/// their sizes, if they are known; a tolerance has left out those of `is_chosen_out`.
///
/// # Errors
/// As [`Sampler::sizes`].
pub fn unmet(
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
    size.gained_percent + size.lost_percent + size.moved_percent >= NOTABLE_PERCENT
}

fn would(size: &EffectSize) -> String {
    format!(
        "add {:.1} % of the points, remove {:.1} %, and move {:.1} % by over 1 mm, the farthest by {:.0} mm",
        size.gained_percent, size.lost_percent, size.moved_percent, size.worst_mm
    )
}

/// An effect and the fact that calls for it.
fn fact(sampler: &Sampler<'_>, name: &str) -> String {
    match sampler.scene.demand(name) {
        Some(demand) => format!("{name} ({})", demand.reason_and_line()),
        None => name.to_owned(),
    }
}
