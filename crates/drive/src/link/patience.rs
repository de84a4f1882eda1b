//! How long a line that is out of step is tried.
//!
//! Where nothing comes, two markers must do: silence costs a moving axis most. Damaged answers prove that the drive lives and talks, and
//! bursts of them end (a relay, a motor's cable beside the drive's), so there markers go out twice as fast and do not count until the
//! damage has lasted four times as long as a marker may take: 160 ms while the axis moves.
//! What is done with the time is the link's business.

use units::{Host, Span, Stamp};

/// What has come in since the line was last known to work.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Patience {
    /// When the first of it came.
    since: Option<Stamp<Host>>,
    /// Some of it came since the last marker went out.
    fresh: bool,
    /// Since when a question waits for a line that is out of step.
    waits: Option<Stamp<Host>>,
}

/// Times that a marker may take for which damage is put up with.
const DAMAGE: i64 = 4;
/// The same for everything, late answers and damaged ones by turns included.
const ALL: i64 = 6;

impl Patience {
    /// Something came that is no answer, or not yet.
    pub fn hear(&mut self, now: Stamp<Host>) {
        self.since.get_or_insert(now);
        self.fresh = true;
    }

    /// A whole answer came: what came before was part of it, or is over.
    pub fn is_well(&mut self) {
        *self = Self {
            waits: self.waits,
            ..Self::default()
        };
    }

    /// Whether anything has come since the line was last known to work.
    pub fn is_hurt(&self) -> bool {
        self.since.is_some()
    }

    /// A marker went out.
    pub fn ask(&mut self) {
        self.fresh = false;
    }

    /// Until when the line is tried; `None` where it is silent, and its markers count.
    pub fn end(&self, marker_timeout: Span) -> Option<Stamp<Host>> {
        let since = self.since.filter(|_| self.fresh)?;
        Some(since.saturating_add(times(marker_timeout, DAMAGE)))
    }

    /// The line fell out of step.
    pub fn fall(&mut self, now: Stamp<Host>) {
        self.waits = Some(now);
    }

    /// A question waits for it.
    pub fn wait(&mut self, now: Stamp<Host>) {
        self.waits.get_or_insert(now);
    }

    /// Whether a line that answers, but never so that it is known to be in step, is given up.
    pub fn is_worn_out(&self, marker_timeout: Span, now: Stamp<Host>) -> bool {
        self.waits
            .is_some_and(|since| now >= since.saturating_add(times(marker_timeout, ALL)))
    }

    /// How long a marker is awaited whose answer seems to have come damaged.
    pub fn pace(marker_timeout: Span) -> Span {
        marker_timeout.half()
    }
}

fn times(span: Span, times: i64) -> Span {
    Span::from_nanos(span.as_nanos().saturating_mul(times))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;
    const TIMEOUT: Span = Span::from_millis(40);

    #[test]
    fn silence_gets_no_more_time() {
        let mut patience = Patience::default();
        assert_eq!(patience.end(TIMEOUT), None);
        patience.hear(Stamp::from_nanos(3 * MS));
        patience.ask();
        assert_eq!(patience.end(TIMEOUT), None, "nothing since the marker");
    }

    #[test]
    fn damage_is_put_up_with_from_its_beginning() {
        let mut patience = Patience::default();
        for ms in [3, 50, 90] {
            patience.ask();
            patience.hear(Stamp::from_nanos(ms * MS));
            assert_eq!(patience.end(TIMEOUT), Some(Stamp::from_nanos(163 * MS)));
        }
        patience.is_well();
        patience.hear(Stamp::from_nanos(95 * MS));
        assert_eq!(patience.end(TIMEOUT), Some(Stamp::from_nanos(255 * MS)));
    }
}
