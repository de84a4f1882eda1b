//! Sweeps while they happen. [`MoveWatch::sweeps`] finds them more exactly afterwards.

use units::{Degrees, Gearing, Host, Span, Stamp};

use super::{END_TOLERANCE_DEG, MoveWatch, REST_QC};
use crate::angles::AngleSample;
use crate::config::SweepPlan;

/// Follows the samples of an axis, and reports when sweeps begin and end.
#[derive(Clone, Debug)]
pub(crate) struct SweepWatch {
    rest_deg: f64,
    spans: Vec<(Stamp<Host>, Stamp<Host>)>,
    /// Number of moves handled.
    seen: usize,
    last: Option<AngleSample>,
    state: Watched,
}

#[derive(Clone, Copy, Debug)]
enum Watched {
    Nothing,
    /// A sweep was commanded, and the axis is still in its place.
    Rest(Degrees),
    /// The last sample that moved.
    Motion(AngleSample),
}

/// An axis at rest for this long has ended its sweep.
const STILL: Span = Span::from_millis(50);

impl SweepWatch {
    /// An observer of an axis with `gearing`.
    pub(crate) fn new(gearing: Gearing) -> Self {
        Self {
            rest_deg: REST_QC * gearing.degrees_per_qc(),
            spans: Vec::new(),
            seen: 0,
            last: None,
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
        if let Some((count, target)) = moves.newest().filter(|(count, _)| *count > self.seen) {
            self.seen = count;
            self.end(sample.host);
            let is_sweep = plan.is_none_or(|plan| {
                plan.is_next_sweep(self.spans.len(), last.angle, target, END_TOLERANCE_DEG)
            });
            if is_sweep {
                self.state = Watched::Rest(last.angle);
            }
        }
        let moved = |from: Degrees| (sample.angle.0 - from.0).abs() > self.rest_deg;
        match self.state {
            Watched::Rest(from) if moved(from) => {
                self.spans.push((last.host, Stamp::from_nanos(i64::MAX)));
                self.state = Watched::Motion(*sample);
            }
            Watched::Motion(_) if moves.newest().is_some_and(|(_, target)| !moved(target)) => {
                self.end(sample.host);
            }
            Watched::Motion(seen) if moved(seen.angle) => self.state = Watched::Motion(*sample),
            Watched::Motion(seen) if sample.host.saturating_since(seen.host) > STILL => {
                self.end(sample.host);
            }
            _ => {}
        }
        self.last = Some(*sample);
    }

    fn end(&mut self, host: Stamp<Host>) {
        if let (Watched::Motion(_), Some((_, end))) = (self.state, self.spans.last_mut()) {
            *end = host;
        }
        self.state = Watched::Nothing;
    }
}
