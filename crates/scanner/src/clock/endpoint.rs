//! Distance of the clock below the lowest packets: Pitman's estimate of the end of a distribution.
//!
//! A delay of several stages (waiting to be polled, waiting to be scheduled) is rarely near its
//! minimum. With two stages its density grows linearly from zero, and the lowest of n packets is
//! late by about n^-1/2 of the spread instead of n^-1. The convex hull is late with them.
//!
//! Near its end let the share of delays below d be proportional to d^a (a = 1: a step, a = 2: two
//! stages). For the packets less than D above the hull, the likelihood of a line d(x) below it is
//!
//! ```text
//!     product over packets of (r + d)^(a-1) / (D + d)^a
//!     r: delay above the hull; 0 if a packet precedes the line
//! ```
//!
//! Its maximum is a poor estimate at an end, as it may lie on the edge. Its mean over all lines has
//! the least variance among the equivariant estimates (E. J. G. Pitman, Biometrika 30, 1939, pp.
//! 391-421). It is taken over a grid of the line's two ends, and the spread over the grid is the
//! error of the line. Hill's estimator (B. M. Hill, Annals of Statistics 3, 1975, pp. 1163-1174)
//! gives the exponent from the lowest packets of the whole recording.

use super::envelope::Point;
use super::segment::OffsetLine;

/// Distribution of delays just above the smallest: the share below d is that of `depth_ns` times (d
/// / depth)^exponent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tail {
    depth_ns: f64,
    exponent: f64,
}

/// Standard deviation of a line at its beginning, middle and end, nanoseconds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ends {
    begin_ns: f64,
    middle_ns: f64,
    end_ns: f64,
}

/// Stages of delay at most, and the exponent above which there are several.
const MOST_STAGES: f64 = 3.0;
const SEVERAL_STAGES: f64 = 1.25;
/// Grid nodes per side, and reach of the second, finer grid in standard deviations.
const NODES: usize = 17;
const REACH: f64 = 3.5;
/// Reach of the first grid down and up, in multiples of the delay of the tenth lowest packet.
const TENTH: usize = 10;
const DOWN: f64 = 5.0;
const UP: f64 = 3.0;
/// Least reach: the tenth packet may be on the hull.
const LEAST_NS: f64 = 50.0;
/// Number of factors that can be multiplied without overflow of an f64.
const FACTORS: usize = 16;

impl Tail {
    /// The tail of a delay of two stages.
    pub const fn of_two_stages(depth_ns: f64) -> Self {
        Self {
            depth_ns,
            exponent: 2.0,
        }
    }

    /// The same depth with Hill's estimate of the exponent, limited to one to three stages.
    pub fn measured(self, late_ns: impl Iterator<Item = f64>) -> Self {
        let low = late_ns.filter(|r| *r > 0.0 && *r < self.depth_ns);
        let (count, sum) = low.fold((0.0, 0.0), |(count, sum), r| {
            (count + 1.0, sum + (self.depth_ns / r).ln())
        });
        let exponent = if sum > 0.0 { count / sum } else { 2.0 };
        Self {
            exponent: exponent.clamp(1.0, MOST_STAGES),
            ..self
        }
    }

    /// The tail of a delay of several stages with an exponent that is greater by one standard
    /// deviation: that of Hill's estimate from `count` packets (Hill 1975), and where they reach
    /// `beyond` the lowest share (0 to 1) half of the distance to three, as the exponent grows
    /// towards the end. `None` for one stage, whose exponent is the same everywhere.
    pub fn one_deviation_up(self, count: usize, beyond: f64) -> Option<Self> {
        let by_chance = self.exponent / (count.max(1) as f64).sqrt();
        let by_depth = 0.5 * beyond * (MOST_STAGES - self.exponent);
        (self.exponent > SEVERAL_STAGES).then(|| Self {
            exponent: self.exponent + by_chance.hypot(by_depth),
            ..self
        })
    }
}

impl Ends {
    /// The same deviation along the whole line.
    pub const fn all(ns: f64) -> Self {
        Self {
            begin_ns: ns,
            middle_ns: ns,
            end_ns: ns,
        }
    }

    /// With a further error: from `first` to `last` the distance of `one` from `other` is its
    /// standard deviation.
    pub fn and(self, one: &OffsetLine, other: &OffsetLine, [first, last]: [f64; 2]) -> Self {
        let with = |ns: f64, at: f64| ns.hypot(one.at(at) - other.at(at));
        Self {
            begin_ns: with(self.begin_ns, first),
            middle_ns: with(self.middle_ns, 0.5 * (first + last)),
            end_ns: with(self.end_ns, last),
        }
    }

    /// Standard deviation at -1 (beginning) to 1 (end), or outside: the variance of a line is a
    /// parabola.
    pub fn at(self, position: f64) -> f64 {
        let end = if position < 0.0 {
            self.begin_ns
        } else {
            self.end_ns
        };
        let middle = self.middle_ns * self.middle_ns;
        let more = (end * end - middle).max(0.0);
        (middle + more * position * position).sqrt()
    }
}

/// A low packet: position in the block (0 to 1) and delay above the hull.
type Low = (f64, f64);

/// A grid over the distances of the line's beginning and end below the hull.
struct LineGrid {
    begin: (f64, f64),
    end: (f64, f64),
}

/// Mean and deviation of the line's beginning and end, and deviation of its middle.
struct LinePosterior {
    begin: (f64, f64),
    end: (f64, f64),
    middle: f64,
}

/// Pitman's estimate of the line from the lowest points of a block, with its deviations. `None`
/// with too few points.
pub(super) fn line(points: &[Point], hull: OffsetLine, tail: Tail) -> Option<(OffsetLine, Ends)> {
    let (first, last) = (points.first()?.0, points.last()?.0);
    let length = last - first;
    if length <= 0.0 {
        return None;
    }
    let mut low: Vec<Low> = points
        .iter()
        .map(|p| ((p.0 - first) / length, p.1 - hull.at(p.0)))
        .filter(|(_, r)| *r < tail.depth_ns)
        .collect();
    if low.len() <= TENTH {
        return None;
    }
    low.select_nth_unstable_by(TENTH, |a, b| a.1.total_cmp(&b.1));
    let tenth = low.get(TENTH)?.1.max(LEAST_NS);
    let first_side = (-UP * tenth, DOWN * tenth);
    let coarse = LineGrid {
        begin: first_side,
        end: first_side,
    }
    .spread(&low, tail)?;
    let fine = LineGrid {
        begin: side(coarse.begin),
        end: side(coarse.end),
    };
    // If all of the likelihood is between two nodes the finer grid may miss it.
    let spread = fine.spread(&low, tail).unwrap_or(coarse);
    let line = OffsetLine {
        centre_ns: hull.centre_ns,
        offset_ns: hull.offset_ns - 0.5 * (spread.begin.0 + spread.end.0),
        slope: hull.slope - (spread.end.0 - spread.begin.0) / length,
    };
    let ends = Ends {
        begin_ns: spread.begin.1,
        middle_ns: spread.middle,
        end_ns: spread.end.1,
    };
    Some((line, ends))
}

impl LineGrid {
    fn node(side: (f64, f64), i: usize) -> f64 {
        side.0 + (side.1 - side.0) * i as f64 / (NODES - 1) as f64
    }

    /// Mean and deviations over the grid; `None` if no node is possible.
    fn spread(&self, low: &[Low], tail: Tail) -> Option<LinePosterior> {
        let mut nodes: Vec<(f64, f64, f64)> = Vec::with_capacity(NODES * NODES);
        for i in 0..NODES {
            for k in 0..NODES {
                let (begin, end) = (Self::node(self.begin, i), Self::node(self.end, k));
                if let Some(likelihood) = log_likelihood(low, begin, end, tail) {
                    nodes.push((begin, end, likelihood));
                }
            }
        }
        let most = nodes.iter().map(|n| n.2).fold(f64::NEG_INFINITY, f64::max);
        let mean = |of: &dyn Fn(f64, f64) -> f64| {
            let (sum, all) = nodes.iter().fold((0.0, 0.0), |(sum, all), n| {
                let weight = (n.2 - most).exp();
                (sum + weight * of(n.0, n.1), all + weight)
            });
            sum / all
        };
        if !most.is_finite() {
            return None;
        }
        let (begin, end) = (mean(&|b, _| b), mean(&|_, e| e));
        let deviation = |of: &dyn Fn(f64, f64) -> f64| mean(&|b, e| of(b, e).powi(2)).sqrt();
        Some(LinePosterior {
            begin: (begin, deviation(&|b, _| b - begin)),
            end: (end, deviation(&|_, e| e - end)),
            middle: deviation(&|b, e| 0.5 * (b + e - begin - end)),
        })
    }
}

/// The grid's side around a mean with a deviation.
fn side((mean, deviation): (f64, f64)) -> (f64, f64) {
    let reach = REACH * deviation.max(1.0);
    (mean - reach, mean + reach)
}

/// Log likelihood of the line `begin` and `end` below the hull; `None` if a packet would precede
/// it.
fn log_likelihood(low: &[Low], begin: f64, end: f64, tail: Tail) -> Option<f64> {
    let per_depth = 1.0 / tail.depth_ns;
    let (mut up, mut down) = (0.0, 0.0);
    for some in low.chunks(FACTORS) {
        // One logarithm per group of factors: logarithms cost more than products.
        let (mut late, mut deep) = (1.0, 1.0);
        for (at, r) in some {
            let below = begin + (end - begin) * at;
            let lateness = r + below;
            if lateness <= 0.0 {
                return None;
            }
            late *= lateness * per_depth;
            deep *= 1.0 + below * per_depth;
        }
        up += late.ln();
        down += deep.ln();
    }
    Some((tail.exponent - 1.0) * up - tail.exponent * down)
}
