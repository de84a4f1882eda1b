//! Where a cloud ends and the next message begins.

use std::ops::Range;

use units::{Host, Span, Stamp};

use super::CloudMessage;

/// Points of a message at most: 23 MB, four seconds of a VLP-16.
pub const MOST_POINTS: u32 = 1 << 20;
/// Time of a message at most: its points' times are f32 after its stamp, which then step by 0.5 us.
pub const MOST_SPAN: Span = Span::from_secs(8);

/// Cuts points in the order of their times into clouds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cutter {
    by_revolution: bool,
    /// When sweeps end, in the order of time.
    sweep_ends: Vec<Stamp<Host>>,
    /// Those that points have passed.
    passed: usize,
}

impl Cutter {
    /// One that leaves it to others to say when a turn ends, and cuts only what is too long.
    pub(crate) fn by_revolution() -> Self {
        Self {
            by_revolution: true,
            ..Self::default()
        }
    }

    /// Whether others say when a cloud ends.
    pub(crate) const fn is_by_turns(&self) -> bool {
        self.by_revolution
    }

    /// Cuts where these sweeps end, unless turns are told.
    pub(crate) fn sweep(&mut self, sweeps: &[(Stamp<Host>, Stamp<Host>)]) {
        if !self.by_revolution {
            self.sweep_ends = sweeps.iter().map(|sweep| sweep.1).collect();
        }
    }

    /// The end of those of `rows` that still belong to `cloud`.
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

    /// Goes on to the sweep in which `time` is, or which comes after it; whether it was in an
    /// earlier one.
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
