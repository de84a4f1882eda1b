//! Decides where a cloud ends and the next message begins.

use std::ops::Range;

use units::{Host, Span, Stamp};

use super::CloudMessage;

/// Greatest number of points of a message: 23 MB, four seconds of a VLP-16.
pub const MOST_POINTS: u32 = 1 << 20;
/// Greatest duration of a message: the f32 times of its points then have steps of 0.5 us.
pub const MOST_SPAN: Span = Span::from_secs(8);

/// Splits points, in order of time, into clouds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cutter {
    by_revolution: bool,
    /// Ends of the sweeps, in order of time.
    sweep_ends: Vec<Stamp<Host>>,
    /// Number of ends that points have passed.
    passed: usize,
}

impl Cutter {
    /// A cutter that limits the length only; the caller ends revolutions.
    pub(crate) fn by_revolution() -> Self {
        Self {
            by_revolution: true,
            ..Self::default()
        }
    }

    /// Whether the caller ends clouds.
    pub(crate) const fn is_by_revolution(&self) -> bool {
        self.by_revolution
    }

    /// Sets the sweeps, unless the caller ends clouds.
    pub(crate) fn sweep(&mut self, sweeps: &[(Stamp<Host>, Stamp<Host>)]) {
        if !self.by_revolution {
            self.sweep_ends = sweeps.iter().map(|sweep| sweep.1).collect();
        }
    }

    /// End of those of `rows` that belong to `cloud`.
    pub(crate) fn end(
        &self,
        cloud: &CloudMessage,
        times: &[Stamp<Host>],
        rows: &Range<usize>,
    ) -> usize {
        let room = MOST_POINTS.saturating_sub(cloud.points()) as usize;
        let end = rows.end.min(rows.start.saturating_add(room));
        let part = times.get(rows.start..end).unwrap_or_default();
        let first = match cloud.points() {
            0 => part.first().copied(),
            _ => Some(cloud.times().0),
        };
        let Some(first) = first else {
            return end;
        };
        let mut latest = first.saturating_add(MOST_SPAN);
        if let Some(sweep_end) = self.sweep_ends.get(self.passed) {
            latest = latest.min(*sweep_end);
        }
        let over = part.iter().position(|time| *time > latest);
        over.map_or(end, |over| rows.start + over)
    }

    /// Advances to the sweep of `time`, or the next one; returns whether a sweep ended.
    pub(crate) fn go_on_to(&mut self, time: Stamp<Host>) -> bool {
        let before = self.passed;
        while self
            .sweep_ends
            .get(self.passed)
            .is_some_and(|end| *end < time)
        {
            self.passed += 1;
        }
        self.passed > before
    }
}
