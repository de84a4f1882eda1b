//! Choice of the cheapest method whose bound meets a tolerance.
//!
//! The cost of a method is a model, measured by the benchmark `k` and recorded in `docs/src/k.md`.
//! It affects the duration, never the result.

use std::num::NonZeroUsize;

use glam::DVec3;

use super::{Edges, Estimate, FrameRotation, KError, Sampling, exact, sampled, turned};

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
}

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
            let cells = 0.05 * (1e-4 / tolerance).powf(4.0 / 3.0);
            (tolerance >= 1e-6 && sampling.risk > 0.0).then_some(points * 9e-8 + cells)
        }
    }
}

/// The method with the lowest expected cost and a bound of at most `tolerance`. A tolerance or a
/// risk of 0 demands exact counts. `rotation` tells that the frames are rotated copies of one
/// frame.
#[must_use]
pub fn choose(points: usize, rotation: Option<&FrameRotation>, sampling: &Sampling) -> KMethod {
    let tolerance = sampling.tolerance;
    let frames = rotation.map(|rotation| rotation.frames);
    let mut best = (KMethod::Exact, f64::INFINITY);
    let exact_only = tolerance.is_nan() || tolerance <= 0.0 || points < EXACT_BELOW;
    let methods: &[KMethod] = if exact_only {
        &[KMethod::Exact, KMethod::Turned]
    } else {
        &[KMethod::Exact, KMethod::Turned, KMethod::Sampled]
    };
    for &method in methods {
        let cost = cost_s(method, points as f64, frames, sampling);
        if let Some(cost) = cost.filter(|cost| *cost < best.1) {
            best = (method, cost);
        }
    }
    best.0
}

/// Estimates with the method of [`choose()`], and counts every pair if the bound of a sample
/// exceeds the tolerance.
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
    let tolerance = sampling.tolerance;
    let found = match choose(points.len(), rotation, sampling) {
        KMethod::Sampled => sampled(points, edges, sampling)?,
        KMethod::Exact => return by_all(points, None, edges, threads),
        KMethod::Turned => return by_all(points, rotation, edges, threads),
    };
    if found.largest_bound() <= tolerance {
        return Ok(found);
    }
    by_all(points, rotation, edges, threads)
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
