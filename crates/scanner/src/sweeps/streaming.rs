//! Sweeps while they happen. [`MoveWatch::sweeps`] finds them more exactly afterwards. A move whose
//! start or target was not recorded is the plan's next sweep if it begins like it.

use units::{Degrees, Gearing, Host, Span, Stamp};

use super::uncommanded::REST;
use super::{END_TOLERANCE_DEG, MoveWatch, REST_QC};
use crate::angles::{AngleSample, MAX_SPEED_DEG_S, is_reached};
use crate::config::SweepPlan;

/// Follows the samples of an axis, and reports when sweeps begin and end.
#[derive(Clone, Debug)]
pub(crate) struct SweepWatch {
    rest_deg: f64,
    spans: Vec<(Stamp<Host>, Stamp<Host>)>,
    /// Number of moves handled.
    seen: usize,
    last: Option<AngleSample>,
    /// First sample of the present rest.
    rest: Option<AngleSample>,
    state: Watched,
}

#[derive(Clone, Copy, Debug)]
enum Watched {
    Nothing,
    /// A sweep to this target was commanded, and the axis is still in its place.
    Rest(Degrees, Degrees),
    /// Another move was commanded.
    OtherMove(Degrees),
    /// The last sample that moved, and the target.
    Motion(AngleSample, Degrees),
    /// The axis came to rest at the first angle, before its target: it may be held.
    RestOnTheWay(Degrees, Degrees),
}

/// An axis at rest for this long has ended its sweep: the slowest, at 0.05 deg/s, goes two counts
/// of the encoder in 60 ms.
const STILL: Span = Span::from_millis(100);

impl SweepWatch {
    /// An observer of an axis with `gearing`.
    pub(crate) fn new(gearing: Gearing) -> Self {
        Self {
            rest_deg: REST_QC * gearing.degrees_per_qc(),
            spans: Vec::new(),
            seen: 0,
            last: None,
            rest: None,
            state: Watched::Nothing,
        }
    }

    /// The sweeps so far; a current one has no end.
    pub(crate) fn spans(&self) -> &[(Stamp<Host>, Stamp<Host>)] {
        &self.spans
    }

    /// Takes a sample, in order of time. Without a plan every move is a sweep.
    pub(crate) fn sample(
        &mut self,
        sample: &AngleSample,
        moves: &MoveWatch,
        plan: Option<&SweepPlan>,
    ) {
        let last = *self.last.get_or_insert(*sample);
        let rest = *self.rest.get_or_insert(*sample);
        let rest_deg = self.rest_deg;
        let moved = |from: Degrees| (sample.angle.0 - from.0).abs() > rest_deg;
        let due = plan.map(|plan| plan.ends(self.spans.len()).1);
        let is_next = |from, target| {
            plan.is_none_or(|plan| {
                plan.is_next_sweep(self.spans.len(), from, target, END_TOLERANCE_DEG)
            })
        };
        let number = moves.count();
        // The samples may show a move before the record of its command does.
        let is_begun = |target: Degrees| match (self.state, self.spans.last()) {
            (Watched::Motion(_, going), Some((start, _))) => {
                (going.0 - target.0).abs() <= END_TOLERANCE_DEG
                    && sample.host.saturating_since(*start) < REST
            }
            _ => false,
        };
        if number > self.seen && moves.newest_target().is_some_and(is_begun) {
            self.seen = number;
        } else if number > self.seen {
            // A target where the axis already is was that of the move before.
            let is_elsewhere =
                |target: &Degrees| (target.0 - last.angle.0).abs() > END_TOLERANCE_DEG;
            let target = moves.newest_target().filter(is_elsewhere).or(due);
            let is_sweep = target.is_some_and(|target| is_next(last.angle, target));
            self.seen = number;
            self.end(sample.host);
            self.state = match target {
                Some(target) if is_sweep => Watched::Rest(last.angle, target),
                Some(target) => Watched::OtherMove(target),
                None => Watched::Nothing,
            };
        } else if let (Watched::Nothing | Watched::RestOnTheWay(..), Some(due)) = (self.state, due)
            && moves.is_position_mode()
            && moved(rest.angle)
            && last.host.saturating_since(rest.host) >= REST
            && (sample.angle.0 - rest.angle.0) * (due.0 - rest.angle.0) > 0.0
            && is_next(rest.angle, due)
        {
            self.state = Watched::Rest(rest.angle, due);
        }
        match self.state {
            Watched::Rest(from, target) if moved(from) => {
                self.spans.push((last.host, Stamp::from_nanos(i64::MAX)));
                self.state = Watched::Motion(*sample, target);
            }
            Watched::Motion(_, target) | Watched::OtherMove(target) if !moved(target) => {
                self.end(sample.host);
            }
            // The drive has restarted.
            Watched::Motion(seen, _) if !is_reached(&seen, sample, MAX_SPEED_DEG_S) => {
                self.end(seen.host);
            }
            Watched::Motion(seen, target) if moved(seen.angle) => {
                self.state = Watched::Motion(*sample, target);
            }
            Watched::Motion(seen, target) if sample.host.saturating_since(seen.host) > STILL => {
                self.end(sample.host);
                self.state = Watched::RestOnTheWay(seen.angle, target);
            }
            Watched::RestOnTheWay(at, target)
                if moved(at)
                    && moves.is_position_mode()
                    && (sample.angle.0 - at.0) * (target.0 - at.0) > 0.0 =>
            {
                if let Some((_, end)) = self.spans.last_mut() {
                    *end = Stamp::from_nanos(i64::MAX);
                }
                self.state = Watched::Motion(*sample, target);
            }
            _ => {}
        }
        if moved(rest.angle) {
            self.rest = Some(*sample);
        }
        self.last = Some(*sample);
    }

    fn end(&mut self, host: Stamp<Host>) {
        if let (Watched::Motion(..), Some((_, end))) = (self.state, self.spans.last_mut()) {
            *end = host;
        }
        self.state = Watched::Nothing;
    }
}
