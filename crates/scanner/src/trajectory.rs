//! The tilt angle over host time: from shaft samples to an angle at any instant.
//!
//! A [`Trajectory`] is what the synchroniser asks; how it came about (interpolation now, a fit of the commanded profile
//! behind the same interface) is nobody else's concern. It never extrapolates: outside its samples there is no angle.

use units::{Degrees, Host, Span, Stamp};

/// The platform's angle at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleSample {
    /// When the angle held: middle of request and answer.
    pub host: Stamp<Host>,
    /// Half of the round trip: the angle held within this span of `host` for certain.
    pub bound: Span,
    /// Tilt angle.
    pub angle: Degrees,
}

/// The tilt angle as a function of host time.
#[derive(Clone, Debug)]
pub enum Trajectory {
    /// A platform that does not tilt.
    Fixed(Degrees),
    /// Straight lines between samples.
    Linear(Linear),
}

impl Trajectory {
    /// The angle at `host`; `None` outside the time that samples cover.
    #[must_use]
    pub fn angle(&self, host: Stamp<Host>) -> Option<Degrees> {
        match self {
            Self::Fixed(angle) => Some(*angle),
            Self::Linear(linear) => linear.angle(host),
        }
    }

    /// Name of the method for reports.
    #[must_use]
    pub fn method(&self) -> &'static str {
        match self {
            Self::Fixed(_) => "none",
            Self::Linear(_) => "linear",
        }
    }
}

/// Linear interpolation over samples in strictly increasing time.
#[derive(Clone, Debug)]
pub struct Linear {
    samples: Vec<AngleSample>,
}

impl Linear {
    /// Takes samples in any order. Of several at one instant the first is kept. `None` without samples.
    #[must_use]
    pub fn new(mut samples: Vec<AngleSample>) -> Option<Self> {
        samples.sort_by_key(|s| s.host);
        samples.dedup_by_key(|s| s.host);
        (!samples.is_empty()).then_some(Self { samples })
    }

    /// The angle at `host`; `None` before the first and after the last sample.
    #[must_use]
    pub fn angle(&self, host: Stamp<Host>) -> Option<Degrees> {
        let next = self.samples.partition_point(|s| s.host < host);
        let after = self.samples.get(next)?;
        if after.host == host {
            return Some(after.angle);
        }
        let before = self.samples.get(next.checked_sub(1)?)?;
        Some(between(before, after, host))
    }

    /// How far off the angle may be between samples within `spans`, at worst: half a poll's round trip at the speed there, and what a
    /// straight line misses where the speed changes from one stretch to the next over a hole.
    #[must_use]
    pub fn worst_bound(&self, spans: &[(Stamp<Host>, Stamp<Host>)]) -> Degrees {
        let inside = |t: Stamp<Host>| spans.iter().any(|(from, to)| *from <= t && t <= *to);
        let worst = self
            .samples
            .windows(4)
            .filter_map(|w| match w {
                [a, b, c, d] if inside(b.host) && inside(c.host) => {
                    let (before, across, after) = (rate(a, b), rate(b, c), rate(c, d));
                    let bent = (after - before).abs() * seconds(b, c) / 8.0;
                    let held = across.abs() * b.bound.as_secs_f64().max(c.bound.as_secs_f64());
                    Some(bent + held)
                }
                _ => None,
            })
            .fold(0.0, f64::max);
        Degrees(worst)
    }

    /// How well samples predict each other: the RMS of each sample against the line between its neighbours, over samples
    /// within `spans`. `None` where fewer than three samples fall there.
    ///
    /// It holds the jitter of the stamps and what a straight line misses of a ramp over twice the sampling interval; a constant
    /// delay does not show.
    #[must_use]
    pub fn leave_one_out_rms(&self, spans: &[(Stamp<Host>, Stamp<Host>)]) -> Option<Degrees> {
        let inside = |t: Stamp<Host>| spans.iter().any(|(from, to)| *from <= t && t <= *to);
        let (sum, count) = self
            .samples
            .windows(3)
            .filter_map(|w| match w {
                [a, b, c] if inside(a.host) && inside(c.host) => {
                    Some(between(a, c, b.host).0 - b.angle.0)
                }
                _ => None,
            })
            .fold((0.0, 0u32), |(sum, n), e| (sum + e * e, n + 1));
        (count > 0).then(|| Degrees((sum / f64::from(count)).sqrt()))
    }
}

fn seconds(a: &AngleSample, b: &AngleSample) -> f64 {
    b.host.saturating_since(a.host).as_secs_f64()
}

/// Degrees per second; samples are in strictly increasing time.
fn rate(a: &AngleSample, b: &AngleSample) -> f64 {
    (b.angle.0 - a.angle.0) / seconds(a, b)
}

fn between(a: &AngleSample, b: &AngleSample, host: Stamp<Host>) -> Degrees {
    let whole = b.host.saturating_since(a.host).as_nanos() as f64;
    let part = host.saturating_since(a.host).as_nanos() as f64;
    Degrees(a.angle.0 + (b.angle.0 - a.angle.0) * (part / whole))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ns: i64, angle: f64) -> AngleSample {
        AngleSample {
            host: Stamp::from_nanos(ns),
            bound: Span::ZERO,
            angle: Degrees(angle),
        }
    }

    #[test]
    fn it_goes_through_its_samples_and_straight_between_them() {
        let linear = Linear::new(vec![at(10, 1.0), at(0, 0.0), at(30, -1.0)]).unwrap();
        let angle = |ns| linear.angle(Stamp::from_nanos(ns)).map(|a| a.0);
        assert_eq!(angle(0), Some(0.0));
        assert_eq!(angle(5), Some(0.5));
        assert_eq!(angle(20), Some(0.0));
        assert_eq!(angle(30), Some(-1.0));
    }

    #[test]
    fn it_never_extrapolates() {
        let linear = Linear::new(vec![at(0, 0.0), at(10, 1.0)]).unwrap();
        assert_eq!(linear.angle(Stamp::from_nanos(-1)), None);
        assert_eq!(linear.angle(Stamp::from_nanos(11)), None);
        assert!(Linear::new(Vec::new()).is_none());
    }

    #[test]
    fn identical_timestamps_do_not_divide_by_zero() {
        let linear = Linear::new(vec![at(0, 0.0), at(0, 9.0), at(10, 1.0)]).unwrap();
        assert_eq!(linear.angle(Stamp::from_nanos(5)), Some(Degrees(0.5)));
    }

    #[test]
    fn the_bound_sees_slow_polls_and_holes() {
        let all = [(Stamp::from_nanos(0), Stamp::from_nanos(1_000_000_000))];
        let moving = |holes: &[i64], bound_us: i64| {
            let samples = (0..100)
                .filter(|i| !holes.contains(i))
                .map(|i| AngleSample {
                    bound: Span::from_micros(bound_us),
                    ..at(
                        i * 1_000_000,
                        0.05 * f64::from(i32::try_from(i - 50).unwrap().max(0)),
                    )
                });
            Linear::new(samples.collect()).unwrap().worst_bound(&all).0
        };
        // 50 deg/s: 1 ms of doubt is 0.05 deg, and from rest to 50 deg/s over 11 ms 50 x 0.011 / 8.
        assert!((moving(&[], 1_000) - (0.05 + 0.00625)).abs() < 1e-3);
        let hole: Vec<i64> = (45..55).collect();
        assert!((moving(&hole, 0) - 50.0 * 0.011 / 8.0).abs() < 1e-3);
        assert!(moving(&[], 0) < 0.01);
    }

    #[test]
    fn leaving_one_out_sees_noise_but_not_uniform_motion() {
        let all = [(Stamp::from_nanos(0), Stamp::from_nanos(1_000))];
        let smooth = (0..100).map(|i| at(i * 10, i as f64)).collect();
        let rms = Linear::new(smooth).unwrap().leave_one_out_rms(&all);
        assert!(rms.unwrap().0 < 1e-12);
        let noisy = (0..100)
            .map(|i| at(i * 10, i as f64 + if i % 2 == 0 { 0.1 } else { -0.1 }))
            .collect();
        let rms = Linear::new(noisy).unwrap().leave_one_out_rms(&all);
        assert!((rms.unwrap().0 - 0.2).abs() < 1e-9);
    }
}
