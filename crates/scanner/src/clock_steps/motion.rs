//! Steps of the host's clock that the samples of a moving axis show.
//!
//! After a step forward the axis seems to be behind: its positions over the host's time jump by the
//! rate times the step. A network that becomes slower does not do that.

use drive::ShaftSample;
use nalgebra::{Matrix4, Vector4};
use units::Span;

/// Samples on either side of a step; more of them show a smaller one if the speed is even.
const SIDE: usize = 24;
const LONG_SIDE: usize = 96;
/// Greatest variance about the parabola through many samples, relative to that through few.
const MAX_VARIANCE_RATIO: f64 = 1.5;
const MIN_SIDE: usize = 10;
/// Samples by which the place of the step among them is uncertain.
const NEAR: usize = 6;
/// Greatest relative difference between the steps that packets and samples show.
const DIFFERENCE: f64 = 0.3;
/// Least jump of the positions, in its standard deviations.
const MIN_SDS: f64 = 4.0;
/// A step is excluded if half of it is so many standard deviations beyond the jump that fits.
const EXCLUDED_SDS: f64 = 3.0;

/// The index of the first sample after a step of the host's clock by `by`, if the samples show it
/// near the index `at`.
pub(super) fn step(samples: &[ShaftSample], at: usize, by: Span) -> Option<usize> {
    let places = at.saturating_sub(NEAR)..=at + NEAR;
    let best = |side: usize| {
        let fits = places
            .clone()
            .filter_map(|first| Some((first, JumpFit::new(samples, first, side)?)));
        fits.min_by(|a, b| a.1.squares.total_cmp(&b.1.squares))
    };
    let by_s = by.as_secs_f64();
    let shows =
        |fit: &JumpFit| (fit.by_s - by_s).abs() < DIFFERENCE * by_s.abs() && fit.sds > MIN_SDS;
    let (near, few) = best(SIDE)?;
    Some(if shows(&few) {
        near
    } else {
        let (far, many) = best(LONG_SIDE)?;
        let is_even = many.variance <= MAX_VARIANCE_RATIO * few.variance;
        (is_even && shows(&many)).then_some(far)?
    })
}

/// Whether the samples show that the host's clock was not set by `by` near the index `at`.
pub(super) fn excludes(samples: &[ShaftSample], at: usize, by: Span) -> bool {
    let by_s = by.as_secs_f64().abs();
    [SIDE, LONG_SIDE]
        .into_iter()
        .filter_map(|side| JumpFit::new(samples, at, side))
        .any(|fit| fit.sd_s.is_finite() && fit.by_s.abs() + EXCLUDED_SDS * fit.sd_s < 0.5 * by_s)
}

/// A parabola through the positions, with a jump.
struct JumpFit {
    /// The step of the clock.
    by_s: f64,
    /// Its standard deviation.
    sd_s: f64,
    /// The jump in its standard deviations.
    sds: f64,
    /// Sum of the squared residuals.
    squares: f64,
    variance: f64,
}

impl JumpFit {
    /// Least squares of `a + b t + c t^2 + d [i >= first]`.
    fn new(samples: &[ShaftSample], first: usize, side: usize) -> Option<Self> {
        let from = first.saturating_sub(side);
        let to = (first + side).min(samples.len());
        if first - from < MIN_SIDE || to.checked_sub(first)? < MIN_SIDE {
            return None;
        }
        let origin = samples.get(first)?;
        let rows = || {
            (from..to).filter_map(|i| {
                let sample = samples.get(i)?;
                let middle = |s: &ShaftSample| {
                    let length = s.answer.saturating_since(s.request);
                    s.request.saturating_since(origin.request).as_secs_f64()
                        + length.as_secs_f64() / 2.0
                };
                let t = middle(sample);
                let after = f64::from(u8::from(i >= first));
                let position = f64::from(sample.position.0.wrapping_sub(origin.position.0));
                Some((Vector4::new(1.0, t, t * t, after), position))
            })
        };
        let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for (row, position) in rows() {
            normal += row * row.transpose();
            right += row * position;
        }
        let inverse = normal.try_inverse()?;
        let found = inverse * right;
        let squares: f64 = rows()
            .map(|(row, position)| (position - row.dot(&found)).powi(2))
            .sum();
        // Counts are whole.
        let variance = (squares / ((to - from) as f64 - 4.0)).max(1.0 / 12.0);
        Some(Self {
            by_s: -found.w / found.y,
            sd_s: ((variance * inverse.m44).sqrt() / found.y).abs(),
            sds: found.w.abs() / (variance * inverse.m44).sqrt(),
            squares,
            variance,
        })
    }
}
