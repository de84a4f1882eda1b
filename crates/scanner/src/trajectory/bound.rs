//! Greatest error of an angle, for fits and for connected samples. The caller adds the error of the
//! lidar's clock.

use units::{Host, Span, Stamp};

use super::choose::SweepFit;
use super::pieces::PiecewiseCubic;
use super::{AngleSample, Method, latch, noise};

/// Standard deviations within a bound.
pub(super) const BOUND_SDS: f64 = 3.0;

/// Bound of a fit within a span, degrees: its scatter, and the delay that all samples may share at
/// the speed there.
pub(super) fn of_fit(
    pieces: &PiecewiseCubic,
    (from, to): (Stamp<Host>, Stamp<Host>),
    fit: &SweepFit,
) -> f64 {
    let shared_s = fit.shared_s();
    let all = pieces.as_slice();
    // The piece that contains the beginning counts too.
    let first = all.partition_point(|p| p.from <= from).saturating_sub(1);
    let inside = all.iter().skip(first).take_while(|p| p.from <= to);
    inside
        .map(|piece| BOUND_SDS * piece.sd_deg + shared_s * piece.rate(0.0).abs() * 1e9)
        .fold(0.0, f64::max)
}

/// Error of a corner of the motion that the samples do not determine, degrees: a quarter of the
/// change of speed times the median interval of the samples.
pub(super) fn of_corner(samples: &[AngleSample], fastest_deg_s: f64) -> f64 {
    let pairs = samples.windows(2).filter_map(|pair| match pair {
        [a, b] => Some(b.host.saturating_since(a.host).as_secs_f64()),
        _ => None,
    });
    let mut intervals_s: Vec<f64> = pairs.collect();
    intervals_s.sort_by(f64::total_cmp);
    let median_s = intervals_s.get(intervals_s.len() / 2).copied();
    fastest_deg_s.abs() * median_s.unwrap_or_default() / 4.0
}

/// Bound of connected samples within a span, degrees.
pub(super) fn of_joined(
    samples: &[AngleSample],
    (from, to): (Stamp<Host>, Stamp<Host>),
    method: Method,
) -> f64 {
    // Two more on either side determine the speeds at the ends.
    let low = samples.partition_point(|s| s.host < from).saturating_sub(2);
    let high = samples.partition_point(|s| s.host <= to).saturating_add(2);
    let around = samples
        .get(low..high.min(samples.len()))
        .unwrap_or_default();
    let jump = match method {
        Method::Nearest => widest_step(around) / 2.0,
        _ => 0.0,
    };
    of_lines(around) + jump
}

/// Greatest difference between a sample's instant and that of its angle, seconds: its bound and its
/// age.
fn reach_s(sample: &AngleSample) -> f64 {
    let age_s = if sample.bound > Span::ZERO {
        latch::CYCLE_S
    } else {
        0.0
    };
    sample.bound.as_secs_f64() + age_s
}

/// Greatest step between neighbouring samples, degrees.
fn widest_step(samples: &[AngleSample]) -> f64 {
    let steps = samples.windows(2).map(|pair| match pair {
        [a, b] => (b.angle.0 - a.angle.0).abs(),
        _ => 0.0,
    });
    steps.fold(0.0, f64::max)
}

/// Half of a round trip and a sample's age at the speed there, and the error of a line where the
/// speed changes. That error is a quarter of the change times the time between two samples if the
/// change is sudden, an eighth if it is even. With fewer than four samples the bound is the
/// greatest step.
fn of_lines(samples: &[AngleSample]) -> f64 {
    if samples.len() < 4 {
        return widest_step(samples);
    }
    let rate = |a: &AngleSample, b: &AngleSample| (b.angle.0 - a.angle.0) / noise::seconds(a, b);
    samples
        .windows(4)
        .map(|w| match w {
            [a, b, c, d] => {
                let (before, across, after) = (rate(a, b), rate(b, c), rate(c, d));
                let bent = (after - before).abs() * noise::seconds(b, c) / 4.0;
                bent + across.abs() * reach_s(b).max(reach_s(c))
            }
            _ => 0.0,
        })
        .fold(0.0, f64::max)
}
