//! How far off an angle may be at worst, of fits and of samples that are joined.
//!
//! Left out: the lidar's clock, which is the caller's, and a delay that packets share.

use units::{Host, Stamp};

use super::choose::SweepFit;
use super::pieces::PiecewiseCubic;
use super::{AngleSample, Method, noise};

/// Standard deviations that a bound holds.
const SURE: f64 = 3.0;

/// Of a fit within a span: what it scatters, and the delay that all samples may share at the speed
/// there, degrees.
pub(super) fn of_fit(
    pieces: &PiecewiseCubic,
    (from, to): (Stamp<Host>, Stamp<Host>),
    fit: &SweepFit,
) -> f64 {
    let shared_s = fit.shared_s();
    let all = pieces.as_slice();
    // The one that has begun already is within it, too.
    let first = all.partition_point(|p| p.from <= from).saturating_sub(1);
    let inside = all.iter().skip(first).take_while(|p| p.from <= to);
    inside
        .map(|piece| SURE * piece.sd_deg + shared_s * piece.rate(0.0).abs() * 1e9)
        .fold(0.0, f64::max)
}

/// Of samples that are joined, within a span, degrees.
pub(super) fn of_joined(
    samples: &[AngleSample],
    (from, to): (Stamp<Host>, Stamp<Host>),
    method: Method,
) -> f64 {
    // Two more either side: they tell the speeds at its ends.
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

/// The greatest step from one sample to the next, degrees.
fn widest_step(samples: &[AngleSample]) -> f64 {
    let steps = samples.windows(2).map(|pair| match pair {
        [a, b] => (b.angle.0 - a.angle.0).abs(),
        _ => 0.0,
    });
    steps.fold(0.0, f64::max)
}

/// Half of a round trip at the speed there, and what a line misses of a change of speed: a quarter
/// of it times the time between two samples where it comes at once in the middle between them (if
/// it comes evenly, an eighth). Of fewer than four samples nothing is known but that the axis went
/// from one to the next.
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
                bent + across.abs() * b.bound.as_secs_f64().max(c.bound.as_secs_f64())
            }
            _ => 0.0,
        })
        .fold(0.0, f64::max)
}
