//! The last times of one kind, such as those from request to reply, and what is usual of them.

use units::Span;

/// Times kept: a spike of the link soon leaves them.
const KEPT: usize = 16;
/// Fewer do not show what is usual.
const MIN_TIMES: usize = 4;

/// The last times of one kind.
#[derive(Clone, Debug, Default)]
pub(super) struct RecentTimes {
    times: [Span; KEPT],
    count: usize,
    was_late: bool,
}

/// A time that is later than usual: after both this time and this multiple of the longest usual.
#[derive(Clone, Copy, Debug)]
pub(super) struct LatenessThreshold {
    pub time: Span,
    pub ratio: i64,
}

impl RecentTimes {
    pub fn learn(&mut self, time: Span) {
        if let Some(slot) = self.times.get_mut(self.count % KEPT) {
            *slot = time;
        }
        self.count += 1;
    }

    /// Shortest and longest usual time.
    pub fn usual(&self) -> Option<(Span, Span)> {
        let known = self.times.get(..self.count.min(KEPT))?;
        let (least, greatest) = (known.iter().min(), known.iter().max());
        let ends = least.copied().zip(greatest.copied());
        ends.filter(|_| known.len() >= MIN_TIMES)
    }

    /// Whether a time is later than usual; else it is learned. The second late one in a row is of a
    /// link that has become slower.
    pub fn is_late(&mut self, time: Span, after: LatenessThreshold) -> bool {
        let limit = |(_, longest): (Span, Span)| {
            let multiple = longest.as_nanos().saturating_mul(after.ratio);
            after.time.max(Span::from_nanos(multiple))
        };
        let is_above = self.usual().is_some_and(|usual| time > limit(usual));
        self.was_late = is_above && !self.was_late;
        if !self.was_late {
            self.learn(time);
        }
        self.was_late
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_late_time_is_not_usual_and_two_are_of_a_slower_link() {
        let after = LatenessThreshold {
            time: Span::from_millis(3),
            ratio: 2,
        };
        let mut times = RecentTimes::default();
        let mut is_late = |ms| times.is_late(Span::from_millis(ms), after);
        assert!(!is_late(100), "nothing is usual yet");
        assert!((0..KEPT).all(|_| !is_late(2)));
        assert!(is_late(5));
        assert!((0..3).all(|_| !is_late(4)));
        assert!(is_late(900));
        // The second in a row is usual from now on.
        assert!(!is_late(900));
        assert!((0..3).all(|_| !is_late(1_700)));
    }
}
