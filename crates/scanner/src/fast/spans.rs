//! Looks up whether mostly increasing times fall within a sweep.

use units::{Host, Span, Stamp};

/// The part of an interval that lies within the spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coverage {
    All,
    /// Possibly some of it.
    Some,
    None,
}

/// Follows spans through mostly increasing times.
#[derive(Clone, Debug)]
pub(super) struct SpanCursor<'a> {
    spans: &'a [(Stamp<Host>, Stamp<Host>)],
    /// Interval for which the last answer holds.
    holds: (Stamp<Host>, Stamp<Host>),
    answer: Coverage,
}

impl<'a> SpanCursor<'a> {
    pub(super) const fn new(spans: &'a [(Stamp<Host>, Stamp<Host>)]) -> Self {
        Self {
            spans,
            holds: (Stamp::from_nanos(0), Stamp::from_nanos(-1)),
            answer: Coverage::None,
        }
    }

    #[inline]
    pub(super) fn within(&mut self, start: Stamp<Host>, end: Stamp<Host>) -> Coverage {
        if self.holds.0 <= start && end <= self.holds.1 {
            return self.answer;
        }
        self.search(start, end)
    }

    #[cold]
    fn search(&mut self, start: Stamp<Host>, end: Stamp<Host>) -> Coverage {
        let around = self
            .spans
            .iter()
            .find(|(from, to)| *from <= start && end <= *to);
        if let Some(span) = around {
            (self.holds, self.answer) = (*span, Coverage::All);
            return Coverage::All;
        }
        if self
            .spans
            .iter()
            .any(|(from, to)| *from <= end && start <= *to)
        {
            return Coverage::Some;
        }
        let ends_before = self
            .spans
            .iter()
            .map(|span| span.1)
            .filter(|to| *to < start)
            .max();
        let begins_after = self
            .spans
            .iter()
            .map(|span| span.0)
            .filter(|from| end < *from)
            .min();
        let nearest = Span::from_nanos(1);
        self.holds = (
            ends_before.map_or(Stamp::from_nanos(i64::MIN), |to| to.saturating_add(nearest)),
            begins_after.map_or(Stamp::from_nanos(i64::MAX), |from| {
                from.saturating_add(-nearest)
            }),
        );
        self.answer = Coverage::None;
        Coverage::None
    }
}
