//! The cheapest method whose bound is good enough.
//!
//! What a method costs is a model, measured by the benchmark `k` and written down in `docs/src/k.md`; it decides how long the answer takes, never what it is.
//! Left out: measuring the machine at hand.

use std::num::NonZeroUsize;

use glam::DVec3;
use serde::Serialize;

use super::{Edges, Estimate, FrameRotation, KError, Sampling, exact, sampled, turned};

/// Below so many points every pair is counted: it takes less than a few tenths of a second.
pub const EXACT_BELOW: usize = 65_000;

/// A way to the K function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum KMethod {
    /// [`exact()`].
    Exact,
    /// [`turned()`]: exact, too.
    Turned,
    /// [`sampled()`].
    Sampled,
}

/// CPU seconds that a method is expected to take with AVX-512, for bounds of this tolerance; none where it cannot meet it.
fn cost_s(method: KMethod, points: f64, frames: Option<usize>, wish: &Sampling) -> Option<f64> {
    let tolerance = wish.tolerance;
    let pairs = points * points / 2.0;
    match method {
        // 5e9 pairs a second where leaves are as wide as a few bins.
        KMethod::Exact => Some(0.002 + pairs / 5e9),
        // A frame with all points, 2e9 a second and more.
        KMethod::Turned => frames.map(|frames| 0.01 + points * points / frames as f64 / 2e9),
        // Sorting, and pairs of cells: their number goes with the fourth power of the side, which goes with the third root of the tolerance.
        KMethod::Sampled => {
            let cells = 0.05 * (1e-4 / tolerance).powf(4.0 / 3.0);
            (tolerance >= 1e-6 && wish.risk > 0.0).then_some(points * 9e-8 + cells)
        }
    }
}

/// Which method is expected to be the cheapest with a bound of at most this tolerance: 0 for exact counts. A risk of 0 asks for a proof. Scans of turned
/// frames can be told so.
#[must_use]
pub fn choose(points: usize, rotation: Option<&FrameRotation>, wish: &Sampling) -> KMethod {
    let tolerance = wish.tolerance;
    let frames = rotation.map(|rotation| rotation.frames);
    let mut best = (KMethod::Exact, f64::INFINITY);
    let exact_only = tolerance.is_nan() || tolerance <= 0.0 || points < EXACT_BELOW;
    let methods: &[KMethod] = if exact_only {
        &[KMethod::Exact, KMethod::Turned]
    } else {
        &[KMethod::Exact, KMethod::Turned, KMethod::Sampled]
    };
    for &method in methods {
        let cost = cost_s(method, points as f64, frames, wish);
        if let Some(cost) = cost.filter(|cost| *cost < best.1) {
            best = (method, cost);
        }
    }
    best.0
}

/// Estimates by the method that [`choose()`] takes. Where a sample's or a grid's bound turns out above the tolerance, every pair is counted after all.
///
/// # Errors
/// Those of the methods.
pub fn estimate(
    points: &[DVec3],
    rotation: Option<&FrameRotation>,
    edges: &Edges,
    wish: &Sampling,
    threads: NonZeroUsize,
) -> Result<Estimate, KError> {
    let tolerance = wish.tolerance;
    let found = match choose(points.len(), rotation, wish) {
        KMethod::Sampled => sampled(points, edges, wish)?,
        KMethod::Exact => return by_all(points, None, edges, threads),
        KMethod::Turned => return by_all(points, rotation, edges, threads),
    };
    if found.bound.largest() <= tolerance {
        return Ok(found);
    }
    by_all(points, rotation, edges, threads)
}

/// Every pair, by turning where that is known.
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
