//! The tilt angle over host time: from shaft samples to an angle at any instant.
//!
//! A [`Trajectory`] is what the synchroniser asks; how it came about (interpolation now, a fit of the commanded profile
//! behind the same interface) is nobody else's concern. It never extrapolates: outside its samples there is no angle.

use cloud::mount::{MOST_AHEAD_RAD, Tilt};
use units::{Degrees, Host, Span, Stamp};

use crate::clock::{Moment, Tangent};

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
    /// The angle at an instant; `None` outside the time that samples cover.
    #[must_use]
    pub fn angle(&self, at: Moment) -> Option<Degrees> {
        match self {
            Self::Fixed(angle) => Some(*angle),
            Self::Linear(linear) => linear.angle(at),
        }
    }

    /// Follows the angle through times that mostly grow, without a search for each.
    #[must_use]
    pub fn cursor(&self) -> TrajectoryCursor<'_> {
        TrajectoryCursor {
            fixed: match self {
                Self::Fixed(angle) => Some(*angle),
                Self::Linear(_) => None,
            },
            samples: match self {
                Self::Fixed(_) => &[],
                Self::Linear(linear) => &linear.samples,
            },
            next: 0,
            anchor: Anchor::NONE,
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

    /// The angle at an instant; `None` before the first and after the last sample, to the nanosecond.
    #[must_use]
    pub fn angle(&self, at: Moment) -> Option<Degrees> {
        let (first, last) = (self.samples.first()?, self.samples.last()?);
        if at.host < first.host || last.host < at.host {
            return None;
        }
        // To the nanosecond the first and the last sample's moments belong to it.
        let past = self.samples.partition_point(|s| at.reaches(s.host));
        let next = past.clamp(1, self.samples.len().max(2) - 1);
        match (self.samples.get(next - 1), self.samples.get(next)) {
            (Some(before), Some(after)) => Some(between(before, after, at)),
            _ => Some(first.angle),
        }
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
                    Some(between(a, c, at_once(b.host)).0 - b.angle.0)
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

fn between(a: &AngleSample, b: &AngleSample, at: Moment) -> Degrees {
    let whole = b.host.saturating_since(a.host).as_nanos() as f64;
    let part = at.host.saturating_since(a.host).as_nanos() as f64 + at.rest_ns;
    Degrees(a.angle.0 + (b.angle.0 - a.angle.0) * (part / whole))
}

const fn at_once(host: Stamp<Host>) -> Moment {
    Moment { host, rest_ns: 0.0 }
}

/// Follows a trajectory through times that mostly grow.
#[derive(Clone, Debug)]
pub struct TrajectoryCursor<'a> {
    fixed: Option<Degrees>,
    samples: &'a [AngleSample],
    /// The first sample after the last start.
    next: usize,
    anchor: Anchor,
}

/// A stretch of time from whose start angles are counted, so that sine and cosine are computed once for many blocks. Where it
/// begins and ends depends on the samples alone.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    /// Place of the sample after it.
    next: usize,
    from: Stamp<Host>,
    /// Exclusive.
    until: Stamp<Host>,
    angle: Degrees,
    tilt: Tilt,
}

impl Anchor {
    const NONE: Self = Self {
        next: 0,
        from: Stamp::from_nanos(0),
        until: Stamp::from_nanos(0),
        angle: Degrees(0.0),
        tilt: Tilt::LEVEL,
    };

    #[inline(always)]
    fn holds(&self, next: usize, host: Stamp<Host>) -> bool {
        self.next == next && self.from <= host && host < self.until
    }

    /// The one that `host`, between two samples, belongs to.
    #[cold]
    fn new(next: usize, a: &AngleSample, b: &AngleSample, host: Stamp<Host>) -> Self {
        let rate = rad_per_ns(a, b).abs();
        let whole_ns = b.host.saturating_since(a.host).as_nanos();
        // As a number held to the range of the integer, at a rate of 0 too.
        let length_ns = ((MOST_AHEAD_RAD / 2.0 / rate) as i64).clamp(1, whole_ns.max(1));
        let part = host.saturating_since(a.host).as_nanos() / length_ns;
        let from = a.host.saturating_add(Span::from_nanos(part * length_ns));
        let angle = between(a, b, at_once(from));
        Self {
            next,
            from,
            until: from.saturating_add(Span::from_nanos(length_ns)).min(b.host),
            angle,
            tilt: Tilt::new(angle),
        }
    }
}

/// The angle over some instants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// There is none at any of them.
    Unknown,
    /// Ask moment by moment: at some of them there may be none, or it goes farther than half of [`MOST_AHEAD_RAD`].
    MomentByMoment,
    /// From this it is counted.
    Known(Degrees, Tilt),
}

/// What rounding may make of an instant, twice over.
const EDGE: Span = Span::from_nanos(2);

impl TrajectoryCursor<'_> {
    /// The angle at moments that are `delays_ns` after a tangent's start by the lidar's clock, none of them after `last`: some
    /// angle, and in `ahead_rad` how far it was on from there at each.
    #[inline(always)]
    pub fn follow<const N: usize>(
        &mut self,
        tangent: &Tangent,
        last: Stamp<Host>,
        delays_ns: &[f64; N],
        ahead_rad: &mut [f64; N],
    ) -> Motion {
        let at = tangent.at;
        if let Some(angle) = self.fixed {
            ahead_rad.fill(0.0);
            return Motion::Known(angle, Tilt::new(angle));
        }
        self.seek(at);
        let (before, coming) = self.samples.split_at_checked(self.next).unwrap_or_default();
        let (Some(from), Some(to)) = (before.last(), coming.first()) else {
            let early = |first: &AngleSample| last.saturating_add(EDGE) < first.host;
            let known = before.last().is_some_and(|end| at.host <= end.host)
                || coming.first().is_some_and(|first| !early(first));
            return if known {
                Motion::MomentByMoment
            } else {
                Motion::Unknown
            };
        };
        if self
            .samples
            .last()
            .is_none_or(|end| end.host <= last.saturating_add(EDGE))
        {
            return Motion::MomentByMoment;
        }
        let anchor = match self.anchor {
            anchor if anchor.holds(self.next, at.host) => anchor,
            _ => Anchor::new(self.next, from, to, at.host),
        };
        self.anchor = anchor;
        let stretch = 1.0 + tangent.gain;
        let mut rate = rad_per_ns(from, to);
        let length_ns = last.saturating_since(at.host).as_nanos() as f64;
        let mut fastest = rate.abs();
        let before = at.host.saturating_since(anchor.from).as_nanos() as f64 + at.rest_ns;
        let (start, per_delay) = (rate * before, rate * stretch);
        for (ahead, delay) in ahead_rad.iter_mut().zip(delays_ns) {
            *ahead = start + per_delay * delay;
        }
        // Each sample that is passed bends the way: what comes after it turns at another rate.
        for (to, beyond) in coming.iter().zip(coming.iter().skip(1)) {
            if to.host > last.saturating_add(EDGE) {
                break;
            }
            let passed_ns = to.host.saturating_since(at.host).as_nanos() as f64 - at.rest_ns;
            let next_rate = rad_per_ns(to, beyond);
            for (ahead, delay) in ahead_rad.iter_mut().zip(delays_ns) {
                *ahead += (next_rate - rate) * (delay * stretch - passed_ns).max(0.0);
            }
            rate = next_rate;
            fastest = fastest.max(rate.abs());
        }
        if fastest * length_ns > MOST_AHEAD_RAD / 2.0 {
            return Motion::MomentByMoment;
        }
        Motion::Known(anchor.angle, anchor.tilt)
    }

    /// Makes `next` the first sample after `at`.
    #[inline]
    fn seek(&mut self, at: Moment) {
        let is_past = |i: usize| {
            self.samples
                .get(i)
                .is_some_and(|sample| at.reaches(sample.host))
        };
        if self
            .next
            .checked_sub(1)
            .is_some_and(|before| !is_past(before))
        {
            self.next = self
                .samples
                .partition_point(|sample| at.reaches(sample.host));
        }
        while is_past(self.next) {
            self.next += 1;
        }
    }
}

/// Samples are in strictly increasing time.
fn rad_per_ns(a: &AngleSample, b: &AngleSample) -> f64 {
    (b.angle.0 - a.angle.0).to_radians() / b.host.saturating_since(a.host).as_nanos() as f64
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
        let angle = |ns| linear.angle(at_once(Stamp::from_nanos(ns))).map(|a| a.0);
        assert_eq!(angle(0), Some(0.0));
        assert_eq!(angle(5), Some(0.5));
        assert_eq!(angle(20), Some(0.0));
        assert_eq!(angle(30), Some(-1.0));
    }

    #[test]
    fn it_never_extrapolates() {
        let linear = Linear::new(vec![at(0, 0.0), at(10, 1.0)]).unwrap();
        assert_eq!(linear.angle(at_once(Stamp::from_nanos(-1))), None);
        assert_eq!(linear.angle(at_once(Stamp::from_nanos(11))), None);
        assert!(Linear::new(Vec::new()).is_none());
    }

    #[test]
    fn identical_timestamps_do_not_divide_by_zero() {
        let linear = Linear::new(vec![at(0, 0.0), at(0, 9.0), at(10, 1.0)]).unwrap();
        assert_eq!(
            linear.angle(at_once(Stamp::from_nanos(5))),
            Some(Degrees(0.5))
        );
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
