//! Choice of the cheapest method whose bound meets a tolerance.
//!
//! The cost of a method is a model, measured by the benchmark `k` and recorded in `docs/src/k.md`.
//! It affects the duration, never the result.

use std::num::NonZeroUsize;

use glam::DVec3;

use super::drawn::draws;
use super::{Edges, Estimate, FrameRotation, KError, Sampling, drawn, exact, sampled, turned};

/// Every pair is counted below this number of points: it takes less than a few tenths of a second.
pub const EXACT_BELOW: usize = 65_000;

/// A method of computing the K function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KMethod {
    /// [`exact()`].
    Exact,
    /// [`turned()`], which is exact too.
    Turned,
    /// [`sampled()`].
    Sampled,
    /// [`drawn()`].
    Drawn,
}

/// CPU seconds per draw of a pair from memory.
const DRAW_S: f64 = 1.5e-7;
/// Tolerance of the smallest cells: below, only the number of draws grows.
const SMALLEST_CELLS: f64 = 4e-7;
/// Least tolerance of samples: rounding alone may add a tenth of it.
const LEAST_SAMPLED: f64 = 1e-8;

/// Expected CPU seconds with AVX-512 for bounds of this tolerance; `None` if the method cannot meet
/// it.
fn cost_s(method: KMethod, points: f64, frames: Option<usize>, sampling: &Sampling) -> Option<f64> {
    let tolerance = sampling.tolerance;
    let pairs = points * points / 2.0;
    match method {
        // 5e9 pairs per second if leaves are as wide as a few bins.
        KMethod::Exact => Some(0.002 + pairs / 5e9),
        // One frame against all points, at least 2e9 pairs per second.
        KMethod::Turned => frames.map(|frames| 0.01 + points * points / frames as f64 / 2e9),
        // Sorting and pairs of cells. The number of pairs grows with the fourth power of the side,
        // and the side with the cube root of the tolerance.
        KMethod::Sampled => {
            let cells = 0.05 * (1e-4 / tolerance.max(SMALLEST_CELLS)).powf(4.0 / 3.0);
            let draws = (SMALLEST_CELLS / tolerance).max(1.0).powi(2);
            let is_able = tolerance >= LEAST_SAMPLED && sampling.risk > 0.0;
            is_able.then_some(points * 9e-8 + cells * draws)
        }
        // Two points from anywhere in memory per draw.
        KMethod::Drawn => (sampling.risk > 0.0).then_some(draws(sampling) * DRAW_S),
    }
}

/// The method with the lowest expected cost and a bound of at most `tolerance`. A tolerance or a
/// risk of 0 demands exact counts. `rotation` tells that the frames are rotated copies of one
/// frame.
#[must_use]
pub fn choose(points: usize, rotation: Option<&FrameRotation>, sampling: &Sampling) -> KMethod {
    let all = [
        KMethod::Exact,
        KMethod::Turned,
        KMethod::Sampled,
        KMethod::Drawn,
    ];
    cheapest(&all, points, rotation, sampling)
}

/// The cheapest of some methods.
fn cheapest(
    methods: &[KMethod],
    points: usize,
    rotation: Option<&FrameRotation>,
    sampling: &Sampling,
) -> KMethod {
    let tolerance = sampling.tolerance;
    let frames = rotation.map(|rotation| rotation.frames);
    let mut best = (KMethod::Exact, f64::INFINITY);
    let exact_only = tolerance.is_nan() || tolerance <= 0.0 || points < EXACT_BELOW;
    let is_exact = |method: &KMethod| matches!(method, KMethod::Exact | KMethod::Turned);
    for &method in methods
        .iter()
        .filter(|method| !exact_only || is_exact(method))
    {
        let cost = cost_s(method, points as f64, frames, sampling);
        if let Some(cost) = cost.filter(|cost| *cost < best.1) {
            best = (method, cost);
        }
    }
    best.0
}

/// Estimates with the method of [`choose()`]. If the bound of a sample exceeds the tolerance, the
/// cheapest of the other methods follows.
///
/// # Errors
/// Those of the methods.
pub fn estimate(
    points: &[DVec3],
    rotation: Option<&FrameRotation>,
    edges: &Edges,
    sampling: &Sampling,
    threads: NonZeroUsize,
) -> Result<Estimate, KError> {
    let mut method = choose(points.len(), rotation, sampling);
    if method == KMethod::Sampled {
        let found = sampled(points, edges, sampling)?;
        if found.largest_bound() <= sampling.tolerance {
            return Ok(found);
        }
        let others = [KMethod::Exact, KMethod::Turned, KMethod::Drawn];
        method = cheapest(&others, points.len(), rotation, sampling);
    }
    match method {
        KMethod::Exact => by_all(points, None, edges, threads),
        KMethod::Turned => by_all(points, rotation, edges, threads),
        KMethod::Sampled | KMethod::Drawn => {
            let direction = |index: u64| points.get(index as usize).copied();
            drawn(points.len() as u64, &direction, edges, sampling)
        }
    }
}

/// Counts every pair, by frame rotation where it is known.
fn by_all(
    points: &[DVec3],
    rotation: Option<&FrameRotation>,
    edges: &Edges,
    threads: NonZeroUsize,
) -> Result<Estimate, KError> {
    if let Some(rotation) = rotation {
        let counts = turned(points, rotation, edges, threads)?;
        return Ok(Estimate {
            method: "turned",
            ..counts.into()
        });
    }
    Ok(exact(points, edges, threads)?.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The choice gets no slower as the tolerance grows, and a twentieth more of it saves at most a
    /// sixth: there is no tolerance at which another method costs many times as much.
    #[test]
    fn costs_fall_with_the_tolerance_without_jumps() {
        let rotation = FrameRotation {
            axis: DVec3::Y,
            step_rad: 0.1,
            frames: 30,
        };
        for points in [65_000, 1_000_000, 16_000_000, 26_000_000, 32_000_000] {
            for rotation in [None, Some(&rotation)] {
                let mut last = f64::INFINITY;
                for step in 0..330 {
                    let sampling = Sampling {
                        tolerance: LEAST_SAMPLED * 1.05_f64.powi(step),
                        ..Sampling::default()
                    };
                    let method = choose(points, rotation, &sampling);
                    let frames = rotation.map(|rotation| rotation.frames);
                    let cost = cost_s(method, points as f64, frames, &sampling).unwrap();
                    let saved = cost / last;
                    assert!(
                        saved <= 1.0 && (step == 0 || saved > 0.83),
                        "{points} points, {}: {method:?} {saved}",
                        sampling.tolerance
                    );
                    last = cost;
                }
            }
        }
    }
}
