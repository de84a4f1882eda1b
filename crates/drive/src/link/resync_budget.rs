//! Time limits of the link's resynchronisation.
//!
//! Without any input two unanswered probes end it: silence costs most while the axis moves. Damaged
//! replies prove that the drive is alive, and bursts of damage end (a relay, a motor cable next to
//! the drive's). Probes then go out twice as fast and do not count until the damage has lasted four
//! probe timeouts: 160 ms while the axis moves.

use units::{Host, Span, Stamp};

/// Input since the link last worked.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ResyncBudget {
    damaged_since: Option<Stamp<Host>>,
    /// Input arrived after the last probe was sent.
    has_new_input: bool,
    /// Since when a request waits for resynchronisation.
    waiting_since: Option<Stamp<Host>>,
}

/// Probe timeouts for which damaged input is tolerated.
const DAMAGE_TIMEOUTS: i64 = 4;
/// Probe timeouts after which the link is given up even if late and damaged replies alternate.
const TOTAL_TIMEOUTS: i64 = 6;

impl ResyncBudget {
    /// Records input that is not a matched reply.
    pub fn handle_input(&mut self, now: Stamp<Host>) {
        self.damaged_since.get_or_insert(now);
        self.has_new_input = true;
    }

    /// Records a matched reply: earlier input was part of it, or the damage is over.
    pub fn handle_reply(&mut self) {
        *self = Self {
            waiting_since: self.waiting_since,
            ..Self::default()
        };
    }

    pub fn handle_probe_sent(&mut self) {
        self.has_new_input = false;
    }

    pub fn handle_desynchronised(&mut self, now: Stamp<Host>) {
        self.waiting_since = Some(now);
    }

    /// Records that nothing has arrived: only input uses the budget up.
    pub fn handle_silence(&mut self, now: Stamp<Host>) {
        self.waiting_since = Some(now);
    }

    pub fn handle_request_waiting(&mut self, now: Stamp<Host>) {
        self.waiting_since.get_or_insert(now);
    }

    /// Moves the limits by a time in which the host read no input.
    pub fn postpone(&mut self, delay: Span) {
        for since in [&mut self.damaged_since, &mut self.waiting_since] {
            *since = since.map(|since| since.saturating_add(delay));
        }
    }

    /// Whether unmatched input arrived since the link last worked.
    pub fn has_damage(&self) -> bool {
        self.damaged_since.is_some()
    }

    /// Until when a damaged link is probed; `None` for a silent one, whose probes are counted.
    pub fn damage_deadline(&self, probe_timeout: Span) -> Option<Stamp<Host>> {
        let since = self.damaged_since.filter(|_| self.has_new_input)?;
        Some(since.saturating_add(times(probe_timeout, DAMAGE_TIMEOUTS)))
    }

    /// Whether a link that answers without ever resynchronising is given up.
    pub fn is_exhausted(&self, probe_timeout: Span, now: Stamp<Host>) -> bool {
        self.waiting_since
            .is_some_and(|since| now >= since.saturating_add(times(probe_timeout, TOTAL_TIMEOUTS)))
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
    fn silence_gets_no_extra_time() {
        let mut budget = ResyncBudget::default();
        assert_eq!(budget.damage_deadline(TIMEOUT), None);
        budget.handle_input(Stamp::from_nanos(3 * MS));
        budget.handle_probe_sent();
        assert_eq!(budget.damage_deadline(TIMEOUT), None, "no input since");
    }

    #[test]
    fn damage_is_tolerated_for_a_span_from_its_start() {
        let deadline = |ms| Some(Stamp::from_nanos(ms * MS));
        let mut budget = ResyncBudget::default();
        for ms in [3, 50, 90] {
            budget.handle_probe_sent();
            budget.handle_input(Stamp::from_nanos(ms * MS));
            assert_eq!(budget.damage_deadline(TIMEOUT), deadline(163));
        }
        budget.handle_reply();
        budget.handle_input(Stamp::from_nanos(95 * MS));
        assert_eq!(budget.damage_deadline(TIMEOUT), deadline(255));
    }
}
