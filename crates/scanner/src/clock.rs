//! The lidar's clock against the host's: a lower envelope under the arrival times.
//!
//! A packet never arrives before it is complete, and some packet always arrives almost at once, so the lower edge of
//! (arrival - device time) is the clock; everything above it is the network and the operating system. The edge is
//! the lower convex hull of blocks of 30 s, the line of each block being the hull edge under its middle, neighbouring blocks
//! blended linearly so that slow wander of either oscillator is followed.
//! The smallest delay itself (a cable, an interrupt: tens of microseconds) is invisible to timing and stays in the
//! result; a host clock that is stepped during a recording is not modelled here.

use units::{Host, Lidar, Span, Stamp};

/// One packet as the clock sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// Device time of the packet's first firing.
    pub device: Stamp<Lidar>,
    /// When the packet could first have left: host receive time less the time the packet took to fill.
    pub host: Stamp<Host>,
}

/// Maps lidar time to host time.
#[derive(Clone, Debug)]
pub struct LidarClock {
    origin: Stamp<Lidar>,
    /// Host epoch minus lidar epoch at `origin`, the integer part of every offset.
    offset: i64,
    lines: Vec<Line>,
    residual: Span,
}

/// Offset over device time: `offset_ns + slope * (x - centre)`, with x in nanoseconds after the origin.
#[derive(Clone, Copy, Debug)]
struct Line {
    centre_ns: f64,
    offset_ns: f64,
    slope: f64,
}

/// Length of a block: long enough to meet a prompt packet on a busy link, short against an oscillator's wander.
const BLOCK_NS: f64 = 30e9;
/// No pair of crystal oscillators in working order drifts apart faster; holds the slope where a recording is too
/// short to measure it.
const MAX_SLOPE: f64 = 200e-6;

impl LidarClock {
    /// Fits the envelope. `None` without a single arrival.
    ///
    /// Arrivals need not be in order. Cost: n log n.
    #[must_use]
    pub fn fit(arrivals: &[Arrival]) -> Option<Self> {
        let mut sorted = arrivals.to_vec();
        sorted.sort_unstable_by_key(|a| (a.device, a.host));
        let first = *sorted.first()?;
        let last = *sorted.last()?;
        let origin = first.device;
        let offset = first.host.as_nanos().wrapping_sub(first.device.as_nanos());
        let points: Vec<(f64, f64)> = sorted
            .iter()
            .map(|a| {
                let x = a.device.saturating_since(origin).as_nanos() as f64;
                let y = a.host.as_nanos().wrapping_sub(a.device.as_nanos());
                (x, y.wrapping_sub(offset) as f64)
            })
            .collect();
        let length = last.device.saturating_since(origin).as_nanos() as f64;
        let lines = blocks(length)
            .filter_map(|(from, to)| {
                let low = points.partition_point(|p| p.0 < from);
                let high = points.partition_point(|p| p.0 <= to);
                points.get(low..high).and_then(line_below)
            })
            .collect();
        let mut clock = Self {
            origin,
            offset,
            lines,
            residual: Span::ZERO,
        };
        clock.residual = clock.median_lateness(&sorted);
        Some(clock)
    }

    /// The host time at which the lidar's clock read `device`.
    #[must_use]
    pub fn host(&self, device: Stamp<Lidar>) -> Stamp<Host> {
        self.moment(device).host
    }

    /// The same with what rounding to nanoseconds takes away.
    #[must_use]
    pub fn moment(&self, device: Stamp<Lidar>) -> Moment {
        let x = self.since_origin(device);
        self.moment_of(device, self.segment(x).offset_at(x))
    }

    /// Follows the clock through device times that mostly grow, without a search for each.
    #[must_use]
    pub const fn cursor(&self) -> ClockCursor<'_> {
        ClockCursor {
            clock: self,
            segment: None,
        }
    }

    fn since_origin(&self, device: Stamp<Lidar>) -> f64 {
        device.saturating_since(self.origin).as_nanos() as f64
    }

    fn moment_of(&self, device: Stamp<Lidar>, offset_ns: f64) -> Moment {
        // Only the small remainder goes through floating point: the sum stays exact at any date.
        let fine = round(offset_ns);
        let host = device
            .as_nanos()
            .wrapping_add(self.offset)
            .wrapping_add(fine);
        Moment {
            host: Stamp::from_nanos(host),
            rest_ns: offset_ns - fine as f64,
        }
    }

    /// Median of how late packets came above the envelope: the link's typical delay beyond its smallest.
    #[must_use]
    pub fn residual(&self) -> Span {
        self.residual
    }

    /// Drift of the lidar's clock against the host's at the middle of the recording, in parts per million; positive when
    /// the lidar's seconds are long.
    #[must_use]
    pub fn drift_ppm(&self) -> f64 {
        let middle = self.lines.len() / 2;
        self.lines.get(middle).map_or(0.0, |line| line.slope * 1e6)
    }

    /// The stretch between two lines' centres, or beyond all of them, that `x` falls into.
    fn segment(&self, x: f64) -> Segment {
        let next = self.lines.partition_point(|line| line.centre_ns <= x);
        let before = next.checked_sub(1).and_then(|i| self.lines.get(i)).copied();
        let after = self.lines.get(next).copied();
        Segment {
            from_ns: before.map_or(f64::NEG_INFINITY, |line| line.centre_ns),
            to_ns: after.map_or(f64::INFINITY, |line| line.centre_ns),
            first: before.or(after).unwrap_or(Line::NONE),
            second: before.and(after),
        }
    }

    fn median_lateness(&self, arrivals: &[Arrival]) -> Span {
        let mut late: Vec<i64> = arrivals
            .iter()
            .map(|a| a.host.saturating_since(self.host(a.device)).as_nanos())
            .collect();
        let middle = late.len() / 2;
        if late.is_empty() {
            return Span::ZERO;
        }
        Span::from_nanos(*late.select_nth_unstable(middle).1)
    }
}

/// A host time and what is left of it below a nanosecond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// To the nearest nanosecond.
    pub host: Stamp<Host>,
    /// The true instant is this many nanoseconds later, -0.5 to 0.5.
    pub rest_ns: f64,
}

/// The clock over some microseconds, where it is a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent {
    /// Host time at its start.
    pub at: Moment,
    /// Nanoseconds that the host gains per nanosecond of the lidar.
    pub gain: f64,
}

/// Follows a clock through device times that mostly grow.
#[derive(Clone, Debug)]
pub struct ClockCursor<'a> {
    clock: &'a LidarClock,
    segment: Option<Segment>,
}

/// Between two centres, where the clock blends from one line into the other.
#[derive(Clone, Copy, Debug)]
struct Segment {
    from_ns: f64,
    to_ns: f64,
    first: Line,
    second: Option<Line>,
}

/// A blend may bend away from its tangent by this much: at 1 rad/s it moves a point 100 m away by 0.05 nm.
const MOST_BEND_NS: f64 = 5e-4;

impl ClockCursor<'_> {
    /// The clock from `device` on for `length`. `None` where it is no straight line there: ask it instant by instant.
    #[inline(always)]
    pub fn tangent(&mut self, device: Stamp<Lidar>, length: Span) -> Option<Tangent> {
        let x = self.clock.since_origin(device);
        let segment = match self.segment {
            Some(segment) if segment.from_ns <= x && x < segment.to_ns => segment,
            _ => *self.segment.insert(self.clock.segment(x)),
        };
        let length_ns = length.as_nanos() as f64;
        (x + length_ns < segment.to_ns && segment.bend_ns(length_ns) < MOST_BEND_NS).then(|| {
            Tangent {
                at: self.clock.moment_of(device, segment.offset_at(x)),
                gain: segment.slope_at(x),
            }
        })
    }
}

impl Moment {
    /// Whether it is `host` or later.
    #[must_use]
    pub fn reaches(&self, host: Stamp<Host>) -> bool {
        self.host > host || (self.host == host && self.rest_ns >= 0.0)
    }
}

impl Tangent {
    /// Host times that are `delays_ns` after the start by the lidar's clock, to the nearest nanosecond.
    #[inline(always)]
    pub fn times<const N: usize>(&self, delays_ns: &[f64; N], times: &mut [Stamp<Host>; N]) {
        let bits = NO_FRACTION.to_bits() as i64;
        let start = self.at.host.as_nanos().wrapping_sub(bits);
        let stretch = 1.0 + self.gain;
        for (time, delay) in times.iter_mut().zip(delays_ns) {
            let whole = delay * stretch + self.at.rest_ns + NO_FRACTION;
            *time = Stamp::from_nanos(start.wrapping_add(whole.to_bits() as i64));
        }
    }
}

impl Segment {
    fn offset_at(&self, x: f64) -> f64 {
        match self.second {
            Some(after) => {
                let weight = self.weight(x);
                self.first.at(x) * (1.0 - weight) + after.at(x) * weight
            }
            None => self.first.at(x),
        }
    }

    /// The derivative of [`Segment::offset_at`].
    fn slope_at(&self, x: f64) -> f64 {
        match self.second {
            Some(after) => {
                let weight = self.weight(x);
                self.first.slope * (1.0 - weight)
                    + after.slope * weight
                    + (after.at(x) - self.first.at(x)) / (self.to_ns - self.from_ns)
            }
            None => self.first.slope,
        }
    }

    /// How far the blend is from its tangent after `length_ns`: half of the second derivative times the length squared.
    fn bend_ns(&self, length_ns: f64) -> f64 {
        self.second.map_or(0.0, |after| {
            let bend = (after.slope - self.first.slope) / (self.to_ns - self.from_ns);
            bend.abs() * length_ns * length_ns
        })
    }

    fn weight(&self, x: f64) -> f64 {
        (x - self.from_ns) / (self.to_ns - self.from_ns)
    }
}

impl Line {
    /// Where there is none.
    const NONE: Self = Self {
        centre_ns: 0.0,
        offset_ns: 0.0,
        slope: 0.0,
    };

    fn at(self, x: f64) -> f64 {
        self.offset_ns + self.slope * (x - self.centre_ns)
    }
}

/// Blocks of 30 s that overlap by half and are spread evenly, so that the last one is as long as the first.
fn blocks(length_ns: f64) -> impl Iterator<Item = (f64, f64)> {
    let strides = ((length_ns - BLOCK_NS) / (BLOCK_NS / 2.0)).ceil().max(0.0);
    let stride = if strides > 0.0 {
        (length_ns - BLOCK_NS) / strides
    } else {
        0.0
    };
    (0..=strides as u64).map(move |k| {
        let from = k as f64 * stride;
        (from, from + BLOCK_NS)
    })
}

/// The line under all of `points` (sorted by x) that is closest to them in sum: the hull edge under their mean x, its slope
/// held to what oscillators do.
fn line_below(points: &[(f64, f64)]) -> Option<Line> {
    let (first, last) = (points.first()?, points.last()?);
    let centre = 0.5 * (first.0 + last.0);
    let mean = points.iter().map(|p| p.0 - centre).sum::<f64>() / points.len() as f64 + centre;
    let hull = lower_hull(points);
    let edge = hull
        .windows(2)
        .find(|edge| matches!(edge, [_, b] if b.0 >= mean))
        .and_then(|edge| match edge {
            [a, b] if b.0 > a.0 => Some((b.1 - a.1) / (b.0 - a.0)),
            _ => None,
        });
    let slope = edge.unwrap_or(0.0).clamp(-MAX_SLOPE, MAX_SLOPE);
    let offset = hull
        .iter()
        .map(|p| p.1 - slope * (p.0 - centre))
        .fold(f64::INFINITY, f64::min);
    Some(Line {
        centre_ns: centre,
        offset_ns: offset,
        slope,
    })
}

/// Andrew's monotone chain over points sorted by x.
fn lower_hull(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut hull: Vec<(f64, f64)> = Vec::new();
    for &p in points {
        while let [.., a, b] = hull.as_slice() {
            let turn = (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0);
            if turn > 0.0 {
                break;
            }
            hull.pop();
        }
        // Of several points at one x only the lowest can be on the hull.
        match hull.last() {
            Some(top) if top.0 == p.0 && top.1 <= p.1 => {}
            Some(top) if top.0 == p.0 => {
                hull.pop();
                hull.push(p);
            }
            _ => hull.push(p),
        }
    }
    hull
}

/// 1.5 x 2^52: with this added a number below 2^51 has no room left for a fraction, and its nearest integer in the low bits.
const NO_FRACTION: f64 = 6_755_399_441_055_744.0;

/// To the nearest whole number, and to the even one from halfway.
fn round(x: f64) -> i64 {
    // f64::round is a call on most processors.
    if x.abs() < NO_FRACTION / 4.0 {
        ((x + NO_FRACTION) - NO_FRACTION) as i64
    } else {
        x.round() as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A reproducible stream of numbers in 0..1 (xorshift64*).
    struct Noise(u64);
    impl Noise {
        fn next(&mut self) -> f64 {
            self.0 ^= self.0 >> 12;
            self.0 ^= self.0 << 25;
            self.0 ^= self.0 >> 27;
            (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    const EPOCH: i64 = 1_795_000_000_000_000_000;

    /// Arrivals of a clock that drifts by `ppm`, with exponential delays of `mean_us` and some millisecond spikes.
    fn link(seconds: f64, ppm: f64, mean_us: f64) -> Vec<Arrival> {
        let mut noise = Noise(7);
        (0..(seconds / 1.327_104e-3) as i64)
            .map(|i| {
                let device = 1_000_000_000 + i * 1_327_104;
                let late = -mean_us * 1e3 * (1.0 - noise.next()).ln()
                    + if noise.next() < 0.01 {
                        5e6 * noise.next()
                    } else {
                        0.0
                    };
                let host = EPOCH + device + ((i * 1_327_104) as f64 * ppm * 1e-6) as i64;
                Arrival {
                    device: Stamp::from_nanos(device),
                    host: Stamp::from_nanos(host + late as i64),
                }
            })
            .collect()
    }

    fn worst_us(seconds: f64, ppm: f64, mean_us: f64) -> f64 {
        let arrivals = link(seconds, ppm, mean_us);
        let clock = LidarClock::fit(&arrivals).unwrap();
        arrivals
            .iter()
            .map(|a| {
                let x = a.device.as_nanos() - 1_000_000_000;
                let truth = EPOCH + a.device.as_nanos() + (x as f64 * ppm * 1e-6) as i64;
                (clock.host(a.device).as_nanos() - truth).abs() as f64 * 1e-3
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_drifting_clock_is_found_under_the_noise() {
        for ppm in [-50.0, 0.0, 50.0] {
            let worst = worst_us(45.0, ppm, 66.0);
            assert!(worst < 5.0, "{ppm} ppm: {worst} us");
        }
        assert!(worst_us(600.0, 50.0, 66.0) < 10.0);
    }

    #[test]
    fn one_packet_gives_its_own_offset() {
        let only = Arrival {
            device: Stamp::from_nanos(5),
            host: Stamp::from_nanos(EPOCH),
        };
        let clock = LidarClock::fit(&[only]).unwrap();
        assert_eq!(clock.host(Stamp::from_nanos(5)).as_nanos(), EPOCH);
        assert_eq!(
            clock.host(Stamp::from_nanos(1_005)).as_nanos(),
            EPOCH + 1_000
        );
        assert!(LidarClock::fit(&[]).is_none());
    }

    #[test]
    fn two_packets_do_not_make_a_slope_out_of_jitter() {
        // 1 ms of jitter over one packet would be 750,000 ppm.
        let arrivals = [(0, 0), (1_327_104, 2_327_104)].map(|(device, host)| Arrival {
            device: Stamp::from_nanos(device),
            host: Stamp::from_nanos(EPOCH + host),
        });
        let clock = LidarClock::fit(&arrivals).unwrap();
        assert!(clock.drift_ppm().abs() <= 200.0);
        for a in arrivals {
            assert!(clock.host(a.device) <= a.host);
        }
    }

    #[test]
    fn repeated_device_times_take_the_earliest_arrival() {
        let arrivals = [30, 10, 20].map(|late| Arrival {
            device: Stamp::from_nanos(0),
            host: Stamp::from_nanos(EPOCH + late),
        });
        let clock = LidarClock::fit(&arrivals).unwrap();
        assert_eq!(clock.host(Stamp::from_nanos(0)).as_nanos(), EPOCH + 10);
    }

    #[test]
    fn nanoseconds_survive_the_year_2100() {
        let host = 4_102_444_800_000_000_001;
        let arrivals = [0, 1_327_104].map(|t| Arrival {
            device: Stamp::from_nanos(t),
            host: Stamp::from_nanos(host + t),
        });
        let clock = LidarClock::fit(&arrivals).unwrap();
        assert_eq!(clock.host(Stamp::from_nanos(1)).as_nanos(), host + 1);
    }

    proptest! {
        #[test]
        fn a_block_line_is_never_above_a_point(
            late in proptest::collection::vec(0i64..20_000_000, 1..200),
        ) {
            let arrivals: Vec<Arrival> = late.iter().enumerate().map(|(i, late)| Arrival {
                device: Stamp::from_nanos(i as i64 * 1_327_104),
                host: Stamp::from_nanos(EPOCH + i as i64 * 1_327_104 + late),
            }).collect();
            let clock = LidarClock::fit(&arrivals).unwrap();
            for a in &arrivals {
                // One nanosecond for rounding.
                prop_assert!(clock.host(a.device).as_nanos() <= a.host.as_nanos() + 1);
            }
        }

        #[test]
        fn the_hull_is_below_its_points_and_convex(
            ys in proptest::collection::vec(-1e6f64..1e6, 1..60),
        ) {
            let points: Vec<(f64, f64)> = ys.iter().enumerate().map(|(i, y)| (i as f64, *y)).collect();
            let hull = lower_hull(&points);
            for w in hull.windows(3) {
                prop_assert!((w[1].1 - w[0].1) / (w[1].0 - w[0].0) < (w[2].1 - w[1].1) / (w[2].0 - w[1].0));
            }
            for p in &points {
                let k = hull.partition_point(|h| h.0 <= p.0).clamp(1, hull.len().max(2) - 1);
                if let (Some(a), Some(b)) = (hull.get(k - 1), hull.get(k)) {
                    let y = a.1 + (b.1 - a.1) * (p.0 - a.0) / (b.0 - a.0);
                    prop_assert!(y <= p.1 + 1e-6);
                }
            }
        }
    }
}
