//! The cheapest method whose bound is good enough.
//!
//! What a method costs is a model, measured by the benchmark `k` and written down in `docs/src/k.md`; it decides how long the answer takes, never what it is.
//! Left out: measuring the machine at hand.

use std::num::NonZeroUsize;

use glam::DVec3;
use serde::Serialize;

use super::{Edges, Estimate, KError, Sampling, Turning, exact, gridded, sampled, turned};

/// Below so many points every pair is counted: it takes less than a few tenths of a second.
pub const EXACT_BELOW: usize = 65_000;

/// A way to the K function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// [`exact()`].
    Exact,
    /// [`turned()`]: exact, too.
    Turned,
    /// [`sampled()`].
    Sampled,
    /// [`gridded()`].
    Gridded,
}

/// CPU seconds that a method is expected to take with AVX-512, for bounds of this tolerance; none where it cannot meet it.
fn cost_s(method: Method, points: f64, frames: Option<usize>, wish: &Sampling) -> Option<f64> {
    let tolerance = wish.tolerance;
    let pairs = points * points / 2.0;
    match method {
        // 5e9 pairs a second where leaves are as wide as a few bins.
        Method::Exact => Some(0.002 + pairs / 5e9),
        // A frame with all points, 2e9 a second and more.
        Method::Turned => frames.map(|frames| 0.01 + points * points / frames as f64 / 2e9),
        // Sorting, and pairs of cells: their number goes with the fourth power of the side, which goes with the third root of the tolerance.
        Method::Sampled => {
            let cells = 0.05 * (1e-4 / tolerance).powf(4.0 / 3.0);
            (tolerance >= 1e-6 && wish.risk > 0.0).then_some(points * 9e-8 + cells)
        }
        // 1.2 over the side is the bound.
        Method::Gridded => {
            let side = gridded_side(tolerance) as f64;
            (side <= 64.0).then_some(points * 4e-8 + 18.0 * side.powi(4) * 3e-9)
        }
    }
}

fn gridded_side(tolerance: f64) -> usize {
    (1.2 / tolerance).ceil().clamp(2.0, 1e6) as usize
}

/// Which method is expected to be the cheapest with a bound of at most this tolerance: 0 for exact counts. A risk of 0 asks for a proof. Scans of turned
/// frames can be told so.
#[must_use]
pub fn choose(points: usize, turning: Option<&Turning>, wish: &Sampling) -> Method {
    let tolerance = wish.tolerance;
    let frames = turning.map(|turning| turning.frames);
    let mut best = (Method::Exact, f64::INFINITY);
    let exact_only = tolerance.is_nan() || tolerance <= 0.0 || points < EXACT_BELOW;
    let methods: &[Method] = if exact_only {
        &[Method::Exact, Method::Turned]
    } else {
        &[
            Method::Exact,
            Method::Turned,
            Method::Sampled,
            Method::Gridded,
        ]
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
    turning: Option<&Turning>,
    edges: &Edges,
    wish: &Sampling,
    threads: NonZeroUsize,
) -> Result<Estimate, KError> {
    let tolerance = wish.tolerance;
    let found = match choose(points.len(), turning, wish) {
        Method::Sampled => sampled(points, edges, wish)?,
        Method::Gridded => gridded(points, edges, gridded_side(tolerance))?,
        Method::Exact => return by_all(points, None, edges, threads),
        Method::Turned => return by_all(points, turning, edges, threads),
    };
    if found.bound.largest() <= tolerance {
        return Ok(found);
    }
    by_all(points, turning, edges, threads)
}

/// Every pair, by turning where that is known.
fn by_all(
    points: &[DVec3],
    turning: Option<&Turning>,
    edges: &Edges,
    threads: NonZeroUsize,
) -> Result<Estimate, KError> {
    if let Some(turning) = turning {
        let counts = turned(points, turning, edges, threads)?;
        return Ok(Estimate {
            method: "turned",
            ..counts.into()
        });
    }
    Ok(exact(points, edges, threads)?.into())
}
