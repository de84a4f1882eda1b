//! Observations for the fit of a motion, from samples.

use units::{Host, Stamp};

use super::AngleSample;
use super::noise::{Noise, rates};
use super::profile::Profile;
use super::profile_fit::Observed;

/// Settling time of a head's servo after a ramp, seconds.
const SETTLED_S: f64 = 0.1;
/// Observations of the cruise in a profile's fit, at most.
const MAX_CRUISE_OBSERVATIONS: usize = 100;

/// Observations for a fit. A run of equal samples at rest weighs as one.
pub(super) fn observed(
    samples: &[AngleSample],
    noise: &Noise,
    origin: Stamp<Host>,
) -> Vec<Observed> {
    let rates = rates(samples);
    let mut observed: Vec<Observed> = samples
        .iter()
        .zip(rates)
        .map(|(s, rate)| Observed {
            at_s: s.host.saturating_since(origin).as_secs_f64(),
            angle_deg: s.angle.0,
            sd_deg: noise.sd_deg(s, rate).max(f64::EPSILON),
        })
        .collect();
    for run in observed.chunk_by_mut(is_alike) {
        let count = run.len() as f64;
        for o in run {
            o.sd_deg *= count.sqrt();
        }
    }
    observed
}

/// Merges neighbours of the cruise if there are many: parts of a straight line carry no more
/// information.
pub(super) fn condensed(observed: &[Observed], guess: &Profile) -> Vec<Observed> {
    let [start, up, brake, end] = guess.corners_s();
    // The guess may be off, and the servo settles later.
    let margin_s = SETTLED_S + 0.5 * (up - start).max(end - brake);
    let is_straight = |o: &Observed| o.at_s > up + margin_s && o.at_s < brake - margin_s;
    let first = observed.partition_point(|o| !is_straight(o) && o.at_s < brake);
    let last = observed
        .partition_point(|o| o.at_s < brake - margin_s)
        .max(first);
    let (before, rest) = observed.split_at_checked(first).unwrap_or((observed, &[]));
    let (straight, after) = rest.split_at_checked(last - first).unwrap_or((rest, &[]));
    let group = straight.len() / MAX_CRUISE_OBSERVATIONS + 1;
    let few = straight.chunks(group).filter_map(merged);
    let few: Vec<Observed> = few.collect();
    [before, &few, after].concat()
}

/// Observations of a straight line as one.
fn merged(some: &[Observed]) -> Option<Observed> {
    let first = some.first()?;
    let (mut weight, mut late, mut ahead) = (0.0, 0.0, 0.0);
    for o in some {
        let w = 1.0 / (o.sd_deg * o.sd_deg);
        weight += w;
        late += w * (o.at_s - first.at_s);
        ahead += w * (o.angle_deg - first.angle_deg);
    }
    Some(Observed {
        at_s: first.at_s + late / weight,
        angle_deg: first.angle_deg + ahead / weight,
        sd_deg: 1.0 / weight.sqrt(),
    })
}

fn is_alike(a: &Observed, b: &Observed) -> bool {
    (a.angle_deg - b.angle_deg).abs() < f64::EPSILON * 64.0
}
