//! Greatest error of an angle, for fits and for connected samples. The caller adds the error of the
//! lidar's clock.

use units::{Host, Span, Stamp};

use super::choose::SweepFit;
use super::pieces::PiecewiseCubic;
use super::profile::Profile;
use super::{AngleSample, Method, latch, noise};

/// Standard deviations within a bound.
pub(super) const BOUND_SDS: f64 = 3.0;

/// Bound of a fit within a span, degrees: its scatter, at least half a step of the encoder, and the
/// delay that all samples may share at the greatest speed there. Any curve within half a step of
/// the samples agrees with all of them, so that they do not show a servo which rounds a corner by
/// less: the scatter of the motion without it may be far smaller. A head that catches up is fastest
/// within a piece, not at its ends.
pub(super) fn of_fit(
    pieces: &PiecewiseCubic,
    (from, to): (Stamp<Host>, Stamp<Host>),
    fit: &SweepFit,
    step_deg: f64,
) -> f64 {
    let shared_s = fit.shared_s();
    pieces
        .within(from, to)
        .map(|(piece, length_ns)| {
            let fastest_deg_s = piece.fastest(length_ns) * 1e9;
            (BOUND_SDS * piece.sd_deg).max(step_deg / 2.0) + shared_s * fastest_deg_s
        })
        .fold(0.0, f64::max)
}

/// Error of a corner of the motion that the samples of a sweep do not determine, degrees: a quarter
/// of the change of speed times the interval of the samples there. It is the longest interval
/// within a ramp, and at least the median one.
pub(super) fn of_corner(samples: &[AngleSample], profile: &Profile) -> f64 {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return 0.0;
    };
    let intervals_s = |pair: &[AngleSample]| match pair {
        [a, b] => noise::seconds(a, b),
        _ => 0.0,
    };
    let is_in_ramp = |pair: &&[AngleSample]| match pair {
        [a, b] => {
            noise::seconds(first, a) < profile.ramp_up_s
                || noise::seconds(b, last) < profile.ramp_down_s
        }
        _ => false,
    };
    let ramps = samples.windows(2).filter(is_in_ramp).map(intervals_s);
    let longest_s = ramps.fold(0.0, f64::max);
    let mut all_s: Vec<f64> = samples.windows(2).map(intervals_s).collect();
    all_s.sort_by(f64::total_cmp);
    let median_s = all_s.get(all_s.len() / 2).copied().unwrap_or_default();
    profile.speed_deg_s.abs() * longest_s.max(median_s) / 4.0
}

/// Half of it where a ramp is so short that most such ramps have no sample in them: below a quarter
/// of the interval. The servo's lag there is not determined, but it turns the speed evenly rather
/// than at once, and an even change within an interval leaves the corner by an eighth. Zero for
/// longer ramps.
pub(super) fn of_short_ramps(samples: &[AngleSample], profile: &Profile) -> f64 {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return 0.0;
    };
    let intervals = samples.len().saturating_sub(1).max(1);
    let mean_s = noise::seconds(first, last) / intervals as f64;
    match profile.ramp_up_s.min(profile.ramp_down_s) < mean_s / 4.0 {
        true => of_corner(samples, profile) / 2.0,
        false => 0.0,
    }
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

#[cfg(test)]
mod tests {
    use units::Degrees;

    use super::super::pieces::CubicPiece;
    use super::*;

    /// A curve that the scatter of its samples makes certain to a hundredth of a step.
    #[test]
    fn a_fit_is_never_known_to_less_than_half_a_step() {
        let (from, to) = (Stamp::from_nanos(0), Stamp::from_nanos(1_000_000_000));
        let rate = 0.7e-9;
        let piece = CubicPiece::hermite(from, 1e9, [0.0, rate], [0.7, rate]).with_sd(5e-6);
        let pieces = PiecewiseCubic::new(vec![piece], to).unwrap();
        let fit = SweepFit {
            method: Method::Profile,
            rms_deg: 0.0,
            sd_deg: 0.0,
            delay: (Span::from_millis(-1), Span::ZERO),
            profile: None,
            condition: None,
            remarks: Vec::new(),
        };
        let bound = |step_deg| of_fit(&pieces, (from, to), &fit, step_deg);
        assert!((bound(0.0015) - 0.00145).abs() < 1e-9);
        assert!((bound(0.0) - 0.000715).abs() < 1e-9);
    }

    /// Polls every 20 ms; those from 20 to 180 ms, in the first ramp, are missing.
    #[test]
    fn a_gap_in_a_ramp_bounds_its_corner() {
        let sample = |ms: i64| AngleSample {
            host: Stamp::from_nanos(ms * 1_000_000),
            bound: Span::ZERO,
            angle: Degrees(0.0),
        };
        let profile = Profile {
            start_s: 0.0,
            speed_deg_s: -50.0,
            ramp_up_s: 0.1,
            ramp_down_s: 0.1,
            from_deg: 0.0,
            way_deg: -45.0,
            lag_s: 0.0,
            inertia_s2: 0.0,
        };
        let bound = |times: &[i64]| {
            let samples: Vec<AngleSample> = times.iter().map(|ms| sample(*ms)).collect();
            of_corner(&samples, &profile)
        };
        let polls: Vec<i64> = (0..=50).map(|number| 20 * number).collect();
        let without = |missing: std::ops::Range<i64>| -> Vec<i64> {
            let is_kept = |ms: &i64| !missing.contains(ms);
            polls.iter().copied().filter(is_kept).collect()
        };
        assert!((bound(&polls) - 0.25).abs() < 1e-9);
        assert!((bound(&without(20..200)) - 2.5).abs() < 1e-9);
        assert!((bound(&without(820..1000)) - 2.5).abs() < 1e-9);
        // A gap in the cruise hides no corner.
        assert!((bound(&without(420..600)) - 0.25).abs() < 1e-9);
        assert_eq!(bound(&[]), 0.0);
    }
}
