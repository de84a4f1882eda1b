//! Lines under the arrivals, one per block of 30 s, neighbouring blocks blended linearly, so that
//! slow wander of either oscillator is followed.
//!
//! A block's line is first the edge of its lower convex hull under its middle. On a link with many
//! packets near the smallest delay, that is the clock to a fraction of a microsecond. Otherwise
//! `endpoint` estimates the distance of the clock below the hull.

use super::device::ErrorCell;
use super::endpoint::{self, Ends, Tail};
use super::segment::OffsetLine;

/// Length of a block: long enough to contain a prompt packet on a busy link, short against the
/// wander of an oscillator.
pub(super) const BLOCK_NS: f64 = 30e9;
/// Greatest drift between two working crystal oscillators; limits the slope if a recording is too
/// short to measure it.
const MAX_SLOPE: f64 = 200e-6;
/// Greatest drift of a slewed clock (500 ppm by the kernel), and the time needed to tell it from
/// delays.
const MAX_SLEW: f64 = 600e-6;
const SLEW_NS: f64 = 10e9;
/// Share of all packets that defines the spread of the lowest delays, and their least number in a
/// short recording.
const LOW_SHARE: f64 = 0.02;
const MIN_LOW_PACKETS: usize = 64;
/// With fewer packets per block the hull is not refined.
const MIN_BLOCK_PACKETS: usize = 8 * MIN_LOW_PACKETS;
/// With the lowest packets within this of the hull, the hull is the clock to a fraction of a
/// microsecond.
const PROMPT_NS: f64 = 5e3;
/// Iterations between the lines and the distribution of the delays above them.
const ROUNDS: usize = 3;
/// Rate of change of the drift between two ordinary oscillators (0.03 ppm/s): across a block of
/// length L a straight line misses L^2/8 of it. If neighbouring blocks show more, theirs counts,
/// enlarged by a quarter.
const WANDER_PER_S: f64 = 0.03e-6;
const WANDER_MARGIN: f64 = 1.25;
/// Standard deviations that contain a whole recording in 99 of 100 cases.
pub(super) const BOUND_SDS: f64 = 3.5;
/// Cells per block.
const CELLS: f64 = 16.0;
/// A cell's smallest delay is not by chance if this many packets were expected below it.
const EXPECTED_BELOW: f64 = 9.0;
/// Greater delays are held up by the network: a clock step of that size is found.
const MAX_DELAY_NS: f64 = 10e6;
/// Error at the edge of a small step, relative to the delays of neighbouring cells.
const EDGE_MARGIN: f64 = 1.5;
/// Standard deviation of a uniform distribution, in halves of its width: 1 / sqrt(3).
const UNIFORM_SD: f64 = 0.577_350_269_189_625_8;
/// Bound with one or two packets: networks rarely delay a packet by a second.
const UNKNOWN_NS: f64 = 1e9;

/// A point of (device time, offset), both in nanoseconds.
pub(super) type Point = (f64, f64);

/// The clock under the points of a recording.
#[derive(Default)]
pub(super) struct Envelope {
    pub lines: Vec<OffsetLine>,
    pub cells: Vec<ErrorCell>,
}

/// Distribution of the lowest delays: `share` of all are below `depth_ns`.
#[derive(Clone, Copy)]
struct LowDelays {
    share: f64,
    depth_ns: f64,
}

impl LowDelays {
    /// Upper limit of the smallest of `count` delays, for one or two stages of delay and packets in
    /// bursts.
    fn least_of(self, count: usize) -> f64 {
        let part = EXPECTED_BELOW / (self.share * count as f64);
        2.0 * self.depth_ns * part.max(part.sqrt())
    }
}

/// A block with its line.
struct EnvelopeBlock<'a> {
    points: &'a [Point],
    line: OffsetLine,
    /// Standard deviations of the line.
    ends: Ends,
    /// Number of standard deviations that contain the line, in 99 of 100 recordings.
    sds: f64,
}

impl Envelope {
    /// The envelope of points sorted by time.
    pub fn below(points: &[Point]) -> Self {
        let (Some(first), Some(last)) = (points.first(), points.last()) else {
            return Self::default();
        };
        let length_ns = last.0 - first.0;
        let mut blocks: Vec<EnvelopeBlock<'_>> = blocks(first.0, length_ns)
            .filter_map(|(from, to)| {
                let low = points.partition_point(|p| p.0 < from);
                let high = points.partition_point(|p| p.0 <= to);
                let points = points.get(low..high)?;
                Some(EnvelopeBlock {
                    points,
                    line: line_below(points)?,
                    ends: Ends::default(),
                    sds: BOUND_SDS,
                })
            })
            .collect();
        let spread = refine(&mut blocks);
        let cells = cells(points, &blocks, spread);
        Self {
            lines: blocks.iter().map(|block| block.line).collect(),
            cells,
        }
    }
}

/// Lowers the lines to where the distribution of delays ends, if that matters. Returns the
/// distribution.
fn refine(blocks: &mut [EnvelopeBlock<'_>]) -> Option<LowDelays> {
    let low = |blocks: &[EnvelopeBlock<'_>]| {
        let mut late: Vec<f64> = blocks.iter().flat_map(EnvelopeBlock::lateness).collect();
        lowest(&mut late)
    };
    let (depth_ns, count) = low(blocks)?;
    let all: usize = blocks.iter().map(|block| block.points.len()).sum();
    for block in blocks.iter_mut() {
        // The lowest of k packets with delays up to D has a delay of about D / sqrt(k), or less.
        let own = (count * block.points.len()) as f64 / all as f64;
        block.ends = Ends::all(depth_ns / own.max(1.0).sqrt());
    }
    let too_few = blocks
        .iter()
        .any(|block| block.points.len() < MIN_BLOCK_PACKETS);
    let spread = LowDelays {
        share: count as f64 / all as f64,
        depth_ns,
    };
    if depth_ns < PROMPT_NS || too_few {
        return Some(spread);
    }
    let hulls: Vec<OffsetLine> = blocks.iter().map(|block| block.line).collect();
    let mut tail = Tail::of_two_stages(depth_ns);
    for round in 0..ROUNDS {
        if round > 0 {
            tail = tail.measured(blocks.iter().flat_map(EnvelopeBlock::lateness));
        }
        for (block, hull) in blocks.iter_mut().zip(&hulls) {
            if let Some((line, ends)) = endpoint::line(block.points, *hull, tail) {
                (block.line, block.ends) = (line, ends);
                // Its own low packets determine a line, and a quarter of them each of its ends.
                let own = (count * block.points.len()) as f64 / all as f64;
                block.sds = student(BOUND_SDS, own / 4.0);
            }
        }
    }
    // The exponent has an error, too, which all blocks share.
    let beyond = (spread.share / LOW_SHARE - 1.0).clamp(0.0, 1.0);
    let Some(other) = tail.one_deviation_up(count, beyond) else {
        return Some(spread);
    };
    for (block, hull) in blocks.iter_mut().zip(&hulls) {
        if let Some((line, _)) = endpoint::line(block.points, *hull, other)
            && let (Some(first), Some(last)) = (block.points.first(), block.points.last())
        {
            block.ends = block.ends.and(&line, &block.line, [first.0, last.0]);
        }
    }
    Some(spread)
}

/// Standard deviations that contain as much of Student's distribution as `sds` of the normal one
/// (Abramowitz and Stegun 26.7.5): those of few packets are estimates themselves.
fn student(sds: f64, freedom: f64) -> f64 {
    let freedom = freedom.max(1.0);
    let square = sds * sds;
    let first = sds * (square + 1.0) / 4.0;
    let second = sds * ((5.0 * square + 16.0) * square + 3.0) / 96.0;
    sds + first / freedom + second / (freedom * freedom)
}

/// The delay below which the lowest share lies, and the number of packets in it.
fn lowest(late: &mut [f64]) -> Option<(f64, usize)> {
    let count = ((late.len() as f64 * LOW_SHARE) as usize).max(MIN_LOW_PACKETS.min(late.len() / 8));
    if late.is_empty() {
        return None;
    }
    let (_, depth, _) = late.select_nth_unstable_by(count, f64::total_cmp);
    Some((depth.max(0.0), count.max(1)))
}

/// Error bounds of the clock, cell by cell, from the deviations of the lines and from cells in
/// which all packets are late.
fn cells(
    points: &[Point],
    blocks: &[EnvelopeBlock<'_>],
    spread: Option<LowDelays>,
) -> Vec<ErrorCell> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Vec::new();
    };
    let length_ns = last.0 - first.0;
    let count = (CELLS * length_ns / BLOCK_NS).ceil().max(CELLS) as usize;
    let width = length_ns / count as f64;
    let block_s = length_ns.min(BLOCK_NS) * 1e-9;
    let wander_per_s = blocks
        .windows(2)
        .map(wander_per_s)
        .fold(WANDER_PER_S, f64::max);
    let wander_ns = wander_per_s * block_s * block_s / 8.0 * 1e9;
    let from = |i: usize| first.0 + i as f64 * width;
    let late: Vec<f64> = (0..count)
        .map(|i| {
            let low = points.partition_point(|p| p.0 < from(i));
            let high = points.partition_point(|p| p.0 <= from(i + 1));
            let here = points.get(low..high).unwrap_or_default();
            let late = here.iter().map(|p| p.1 - blended(blocks, p.0));
            let least = late.fold(f64::INFINITY, f64::min);
            let usual = spread.map_or(f64::INFINITY, |spread| spread.least_of(here.len()));
            if least > usual && least < MAX_DELAY_NS {
                least
            } else {
                0.0
            }
        })
        .collect();
    let sds = blocks
        .iter()
        .map(|block| block.sds)
        .fold(BOUND_SDS, f64::max);
    let known = |x: f64| wander_ns + sds * deviation(blocks, x);
    (0..count)
        .map(|i| {
            let (from_ns, to_ns) = (from(i), from(i + 1));
            let near = late.get(i.saturating_sub(1)..(i + 2).min(count));
            let late_ns = near.unwrap_or_default().iter().copied();
            let late_ns = EDGE_MARGIN * late_ns.fold(0.0, f64::max);
            if points.len() < 3 {
                return ErrorCell {
                    from_ns,
                    bound_ns: UNKNOWN_NS,
                    host_ns: 0.0,
                    sd_ns: UNIFORM_SD * UNKNOWN_NS,
                };
            }
            let line_ns = deviation(blocks, from_ns).max(deviation(blocks, to_ns));
            ErrorCell {
                from_ns,
                bound_ns: known(from_ns).max(known(to_ns)).max(late_ns),
                host_ns: late_ns,
                sd_ns: line_ns.hypot(UNIFORM_SD * wander_ns.max(late_ns)),
            }
        })
        .collect()
}

/// Rate of change of the drift between two neighbours.
fn wander_per_s(pair: &[EnvelopeBlock<'_>]) -> f64 {
    let [a, b] = pair else {
        return 0.0;
    };
    let distance_s = (b.line.centre_ns - a.line.centre_ns) * 1e-9;
    if distance_s > 0.0 {
        WANDER_MARGIN * (b.line.slope - a.line.slope).abs() / distance_s
    } else {
        0.0
    }
}

/// The blocks whose centres enclose `x`, and the weight of the second.
fn around<'b, 'p>(
    blocks: &'b [EnvelopeBlock<'p>],
    x: f64,
) -> Option<(&'b EnvelopeBlock<'p>, &'b EnvelopeBlock<'p>, f64)> {
    let next = blocks.partition_point(|block| block.line.centre_ns <= x);
    let after = blocks.get(next).or(blocks.last())?;
    let before = blocks.get(next.saturating_sub(1)).unwrap_or(after);
    let distance = after.line.centre_ns - before.line.centre_ns;
    let weight = if distance > 0.0 {
        ((x - before.line.centre_ns) / distance).clamp(0.0, 1.0)
    } else {
        0.0
    };
    Some((before, after, weight))
}

fn blended(blocks: &[EnvelopeBlock<'_>], x: f64) -> f64 {
    around(blocks, x).map_or(0.0, |(before, after, weight)| {
        before.line.at(x) * (1.0 - weight) + after.line.at(x) * weight
    })
}

fn deviation(blocks: &[EnvelopeBlock<'_>], x: f64) -> f64 {
    around(blocks, x).map_or(0.0, |(before, after, weight)| {
        before.deviation(x) * (1.0 - weight) + after.deviation(x) * weight
    })
}

impl EnvelopeBlock<'_> {
    fn lateness(&self) -> impl Iterator<Item = f64> {
        self.points.iter().map(|p| p.1 - self.line.at(p.0))
    }

    /// Standard deviation of the line at `x`.
    fn deviation(&self, x: f64) -> f64 {
        let half = self.points.first().zip(self.points.last());
        let half = half.map_or(0.0, |(a, b)| 0.5 * (b.0 - a.0));
        let position = if half > 0.0 {
            (x - self.line.centre_ns) / half
        } else {
            0.0
        };
        self.ends.at(position)
    }
}

/// Blocks of 30 s that overlap by half, evenly spaced, so that all have one length.
fn blocks(begin_ns: f64, length_ns: f64) -> impl Iterator<Item = (f64, f64)> {
    let strides = ((length_ns - BLOCK_NS) / (BLOCK_NS / 2.0)).ceil().max(0.0);
    let stride = if strides > 0.0 {
        (length_ns - BLOCK_NS) / strides
    } else {
        0.0
    };
    (0..=strides as u64).map(move |k| {
        let from = begin_ns + k as f64 * stride;
        (from, from + BLOCK_NS)
    })
}

/// The line under all of `points` (sorted by x) with the least sum of distances: the hull edge
/// under their mean x, its slope limited to the drift of oscillators.
fn line_below(points: &[Point]) -> Option<OffsetLine> {
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
    let most = if last.0 - first.0 > SLEW_NS {
        MAX_SLEW
    } else {
        MAX_SLOPE
    };
    let slope = edge.unwrap_or(0.0).clamp(-most, most);
    let offset = hull
        .iter()
        .map(|p| p.1 - slope * (p.0 - centre))
        .fold(f64::INFINITY, f64::min);
    Some(OffsetLine {
        centre_ns: centre,
        offset_ns: offset,
        slope,
    })
}

/// Andrew's monotone chain over points sorted by x.
pub(super) fn lower_hull(points: &[Point]) -> Vec<Point> {
    let mut hull: Vec<Point> = Vec::new();
    for &p in points {
        while let [.., a, b] = hull.as_slice() {
            let cross = (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0);
            if cross > 0.0 {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of Student's distribution (Abramowitz and Stegun, table 26.10).
    #[test]
    fn few_packets_give_wider_bounds() {
        for (normal, freedom, expected) in [(2.326, 10.0, 2.764), (3.09, 20.0, 3.552)] {
            let found = student(normal, freedom);
            assert!((found - expected).abs() < 0.02, "{found}, not {expected}");
        }
    }
}
