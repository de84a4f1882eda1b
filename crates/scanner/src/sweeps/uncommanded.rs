//! Moves whose start the log lacks, from the samples: the axis leaves its place while nothing
//! commands it.

use std::ops::Range;

use units::{Degrees, Span};

use super::{END_TOLERANCE_DEG, Move, MoveWatch};
use crate::angles::AngleSample;
use crate::config::SweepPlan;

/// An axis in one place for this long is at rest. The slowest axis leaves it within that time.
pub(super) const REST: Span = Span::from_millis(40);

/// The last rest in `place` before the axis leaves it, as indices of samples.
pub(super) fn rest_before_departure(
    samples: &[AngleSample],
    range: Range<usize>,
    place: Degrees,
    rest_deg: f64,
) -> Option<Range<usize>> {
    let all = samples.get(range.clone())?;
    let is_there = |s: &AngleSample| (s.angle.0 - place.0).abs() <= END_TOLERANCE_DEG;
    let mut first = range.start;
    for stretch in all.chunk_by(|a, b| is_there(a) == is_there(b)) {
        let end = first + stretch.len();
        if stretch.first().is_some_and(is_there) && end < range.end {
            let rest = longest_rest(stretch, rest_deg);
            if let Some(rest) = rest {
                return Some(first + rest.start..first + rest.end);
            }
        }
        first = end;
    }
    None
}

/// The longest rest in a stretch of samples. A slow axis is hardly away from its place while it
/// starts.
fn longest_rest(stretch: &[AngleSample], rest_deg: f64) -> Option<Range<usize>> {
    let mut longest = (REST, None);
    let mut first = 0;
    while let Some(place) = stretch.get(first) {
        let is_away = |s: &AngleSample| (s.angle.0 - place.angle.0).abs() > rest_deg;
        let rest = stretch.get(first..)?;
        let count = rest.iter().position(is_away).unwrap_or(rest.len());
        let last = rest.get(count.checked_sub(1)?)?;
        let duration = last.host.saturating_since(place.host);
        if duration >= longest.0 {
            longest = (duration, Some(first..first + count));
        }
        first += count;
    }
    longest.1
}

/// A sample that is surely at rest: at both ends of a rest a slow axis may already move.
pub(super) const fn middle(rest: &Range<usize>) -> usize {
    usize::midpoint(rest.start, rest.end)
}

impl MoveWatch {
    /// The first move among the samples of `range`, of which the log lacks the start: the axis
    /// leaves an end of the plan in position mode.
    pub(super) fn uncommanded(
        &self,
        samples: &[AngleSample],
        range: Range<usize>,
        rest_deg: f64,
        plan: &SweepPlan,
    ) -> Option<Move> {
        let ends = [plan.from_deg, plan.to_deg].map(Degrees);
        let rest = |end| rest_before_departure(samples, range.clone(), end, rest_deg);
        let rests = ends.into_iter().filter_map(rest);
        let rest = rests.min_by_key(|rest| rest.end)?;
        let left = samples.get(rest.end)?.host;
        let place = samples.get(rest.start)?.angle;
        let is_elsewhere = |target: &Degrees| (target.0 - place.0).abs() > END_TOLERANCE_DEG;
        let setting = self.settings.iter().rev().find(|s| s.from <= left)?;
        setting.is_position_mode.then_some(Move {
            // One sample of the rest is before it.
            commanded: samples.get(middle(&rest) + 1)?.host,
            // A target where the axis already is was that of the move before.
            target: setting.target.filter(is_elsewhere),
            motion: setting.motion,
            has_no_start: true,
        })
    }
}
