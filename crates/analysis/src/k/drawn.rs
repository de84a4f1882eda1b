//! Pairs of points drawn one by one, for points that need not be in memory.
//!
//! All pairs are equally likely and draws are independent. So the largest error of the share of
//! pairs up to any angle exceeds `e` with a probability of at most `2 exp(-2 m e2)` for `m` draws
//! (Dvoretzky, Kiefer and Wolfowitz 1956; Massart 1990). The draws are pseudo-random.

use glam::DVec3;
use rayon::prelude::*;

use super::cells::scaled;
use super::sampled::check_setting;
use super::{Edges, Estimate, KError, Sampling};
use crate::noise::SeededNoise;

/// Draws of one seed. Threads share them, so that the result does not depend on their number.
const BATCH: u64 = 1 << 18;

/// Part of the tolerance for the draws; rounding and uneven draws have the rest.
const OF_DRAWS: f64 = 0.999;

/// Pairs that bound the error by the tolerance.
pub(super) fn draws(sampling: &Sampling) -> f64 {
    let log = (2.0 / sampling.risk).ln();
    (log / (2.0 * (OF_DRAWS * sampling.tolerance).powi(2))).ceil()
}

/// Estimates from draws alone. `direction` gives each of `points` directions by its number, of
/// length 1; the time depends on the tolerance, not on their number.
///
/// # Errors
/// [`KError::Setting`] for a tolerance or a risk not between 0 and 1, [`KError::NotUnit`] for
/// directions missing or not of length 1, [`KError::Undecided`].
pub fn drawn(
    points: u64,
    direction: &(impl Fn(u64) -> Option<DVec3> + Sync),
    edges: &Edges,
    sampling: &Sampling,
) -> Result<Estimate, KError> {
    check_setting(sampling)?;
    if points < 2 {
        return Ok(Estimate::without_pairs("drawn", edges, points as usize));
    }
    let pairs = draws(sampling) as u64;
    let batch = |number: u64| {
        let mut chance = SeededNoise(SeededNoise(sampling.seed).bits() ^ number);
        let mut counts = vec![0_u64; edges.bins()];
        let mut on_edges = 0_u64;
        for _ in 0..BATCH.min(pairs - number * BATCH) {
            let first = scaled(chance.bits(), points as usize) as u64;
            let other = first + 1 + scaled(chance.bits(), points as usize - 1) as u64;
            let [a, b] = [first, other % points].map(|index| {
                let unit = direction(index).unwrap_or(DVec3::NAN);
                match (unit.length_squared() - 1.0).abs() <= 2.0 * super::UNIT_WITHIN {
                    true => Ok(unit),
                    false => Err(KError::NotUnit {
                        index: index as usize,
                        length: unit.length(),
                    }),
                }
            });
            let (a, b) = (a?, b?);
            let bin = edges.bin(a, b)?;
            let is_on = edges.is_on(bin, a, b) || bin > 0 && edges.is_on(bin - 1, a, b);
            on_edges += u64::from(is_on);
            if let Some(count) = counts.get_mut(bin) {
                *count += 1;
            }
        }
        Ok((counts, on_edges))
    };
    let add = |(mut sums, on_edges): (Vec<u64>, u64), (counts, others): (Vec<u64>, u64)| {
        for (sum, count) in sums.iter_mut().zip(counts) {
            *sum += count;
        }
        Ok((sums, on_edges + others))
    };
    let batches = (0..pairs.div_ceil(BATCH)).into_par_iter().map(batch);
    let (counts, on_edges) = batches.try_reduce(|| (vec![0; edges.bins()], 0), add)?;
    let sums = counts.iter().scan(0_u64, |sum, count| {
        *sum += count;
        Some(*sum as f64 / pairs as f64)
    });
    let shares: Vec<f64> = sums.collect();
    // The uneven distribution of 64-bit draws adds less than 2 n / 2^64.
    let bound = OF_DRAWS * sampling.tolerance + 2.0 * points as f64 / 2.0_f64.powi(64);
    let mut bounds = vec![bound; shares.len()];
    // All pairs are within pi.
    if let Some(last) = bounds.last_mut() {
        *last = 0.0;
    }
    let all = points as f64 * (points as f64 - 1.0) / 2.0;
    Ok(Estimate {
        method: "drawn",
        edges: edges.clone(),
        shares,
        bounds,
        risk: sampling.risk,
        points: points as usize,
        on_edges: (on_edges as f64 / pairs as f64 * all).round() as u64,
    })
}
