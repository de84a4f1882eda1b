//! Lines under the arrivals: the lower convex hulls of overlapping blocks.
//!
//! The line of each block is the hull edge under its middle; neighbouring blocks are blended linearly, so that slow wander of
//! either oscillator is followed.

use super::device::Line;

/// Length of a block: long enough to meet a prompt packet on a busy link, short against an oscillator's wander.
const BLOCK_NS: f64 = 30e9;
/// No pair of crystal oscillators in working order drifts apart faster; holds the slope where a recording is too
/// short to measure it.
const MAX_SLOPE: f64 = 200e-6;

/// The lines under points of (device time, offset), both in nanoseconds, sorted.
pub(super) fn lines(points: &[(f64, f64)]) -> Vec<Line> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Vec::new();
    };
    blocks(first.0, last.0 - first.0)
        .filter_map(|(from, to)| {
            let low = points.partition_point(|p| p.0 < from);
            let high = points.partition_point(|p| p.0 <= to);
            points.get(low..high).and_then(line_below)
        })
        .collect()
}

/// Blocks of 30 s that overlap by half and are spread evenly, so that the last one is as long as the first.
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
pub(super) fn lower_hull(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
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
