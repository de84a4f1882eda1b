//! Which SYNC a process data frame answers.
//!
//! The frame does not say. Frames come in the order of the beats, but either may be lost, and with a beat a millisecond an
//! answer may come after the next beat. What must never happen is that a position is given a beat later than itself: the
//! span from beat to arrival would not hold the time at which it was taken. An older beat than the true one makes the span longer, not
//! wrong. So the pairing begins with a lone beat, goes on in order, and after a loss skips a beat only where the
//! drive's own clock shows that the next one, too, came before the position was taken.
//! That clock is tied to the host's by the pairs themselves: a position is never older than its beat, so the largest
//! (beat - drive's time) of all pairs is a lower bound of the clocks' difference.
//! The live client and the listener on a log share this code, so a log pairs the way the capture did.

use std::collections::VecDeque;

use units::{Host, Span, Stamp};

/// Pairs beats with what answers them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Beats {
    /// Unanswered, oldest first.
    sent: VecDeque<Stamp<Host>>,
    /// The last one sent, if answers may still come of which it is not known to which beat they belong.
    open: Option<Stamp<Host>>,
    /// Since when the bus is watched.
    since: Option<Stamp<Host>>,
    chain: Option<Chain>,
}

/// The answer before.
#[derive(Clone, Copy, Debug)]
struct Chain {
    beat: Stamp<Host>,
    device_us: u32,
    /// Lower bound of the host's time at that answer's position.
    host: Stamp<Host>,
    /// Beats skipped whose answers may come after all.
    skipped: u32,
}

impl Chain {
    /// Whether a beat is sure to have gone out before the answer's position was taken, though an earlier one may be answered
    /// late: by the bound, or nearly so a whole beat after the answer before.
    fn is_due(&self, beat: Stamp<Host>, elapsed_us: i64, taken: Stamp<Host>) -> bool {
        let period = beat.saturating_since(self.beat);
        let regular = Span::from_micros(elapsed_us) >= period.half();
        beat <= taken || (regular && beat <= taken.saturating_add(SLACK))
    }
}

/// An unanswered beat of this age will not be answered: a drive answers within some control cycles, but adapters and hosts
/// may be held up.
const EXPIRY: Span = Span::from_millis(100);
/// Nor will one of this age that nobody knows of; shorter, as a log may begin where a command does.
const UNKNOWN: Span = Span::from_millis(10);
/// A pairing that has not been confirmed for this long begins anew: the clocks have moved apart.
const STALE: Span = Span::from_secs(2);
/// What a comparison with the bound allows for: less than a beat needs to reach the drive.
const SLACK: Span = Span::from_micros(5);
/// How far two clocks may move apart in that time, in millionths.
const DRIFT_PPM: i64 = 200;

impl Beats {
    /// The bus is watched at this time.
    pub fn watch(&mut self, now: Stamp<Host>) {
        self.since.get_or_insert(now);
    }

    /// A beat went out.
    pub fn sent(&mut self, at: Stamp<Host>) {
        self.watch(at);
        self.purge(at);
        if self.is_stale(at) {
            self.chain = None;
        }
        if at < self.earliest(at) {
            // What answers this one cannot be known.
            self.sent.clear();
        } else {
            self.sent.push_back(at);
        }
        self.open = Some(at);
    }

    /// When the next beat may go out if its answer is to be paired.
    pub fn earliest(&self, now: Stamp<Host>) -> Stamp<Host> {
        if self.chain.is_some() && !self.is_stale(now) {
            return now;
        }
        let unknown = self.since.map(|since| since.saturating_add(UNKNOWN));
        let open = self.open.map(|open| open.saturating_add(EXPIRY));
        unknown.max(open).unwrap_or(now)
    }

    /// The beat that an answer belongs to, by the drive's time in it and its arrival; `None` where that is not certain.
    pub fn answered(&mut self, device_us: u32, at: Stamp<Host>) -> Option<Stamp<Host>> {
        self.watch(at);
        self.purge(at);
        let Some(chain) = self.chain else {
            let beat = self.sent.pop_front()?;
            self.open = None;
            self.chain = Some(Chain {
                beat,
                device_us,
                host: beat,
                skipped: 0,
            });
            return Some(beat);
        };
        // Wraps every 71 minutes.
        let elapsed_us = i64::from(device_us.wrapping_sub(chain.device_us).cast_signed());
        if elapsed_us == 0 {
            // The bus repeated the frame.
            return None;
        }
        if elapsed_us < 0 || Span::from_micros(elapsed_us) > STALE {
            // Another clock: the drive has restarted.
            self.forget();
            return None;
        }
        Some(self.paired(chain, device_us, elapsed_us, at))
    }

    /// Whether a beat has been paired, so that the next ones can be.
    pub fn is_paired(&self) -> bool {
        self.chain.is_some()
    }

    /// Begins anew, with a lone beat.
    pub fn forget(&mut self) {
        self.chain = None;
        self.sent.clear();
    }

    fn paired(
        &mut self,
        mut chain: Chain,
        device_us: u32,
        elapsed_us: i64,
        at: Stamp<Host>,
    ) -> Stamp<Host> {
        let elapsed_ns = elapsed_us * 1_000 - elapsed_us * DRIFT_PPM / 1_000;
        let taken = chain.host.saturating_add(Span::from_nanos(elapsed_ns));
        let bound = taken.saturating_add(SLACK);
        let mut skips = 0;
        while self.sent.get(1).is_some_and(|second| *second <= bound) {
            self.sent.pop_front();
            skips += 1;
        }
        chain.skipped = chain.skipped.saturating_add(skips);
        let next = self.sent.front().copied().filter(|beat| *beat <= at);
        let beat = match next {
            // Perhaps the late answer to a beat that was skipped: the beat before is sure to be older.
            Some(beat)
                if chain.skipped > 0 && skips == 0 && !chain.is_due(beat, elapsed_us, taken) =>
            {
                chain.skipped -= 1;
                chain.beat
            }
            Some(beat) => {
                self.sent.pop_front();
                beat
            }
            None => {
                chain.skipped = chain.skipped.saturating_sub(1);
                chain.beat
            }
        };
        if self.sent.is_empty() && chain.skipped == 0 {
            self.open = None;
        }
        self.chain = Some(Chain {
            beat,
            device_us,
            // A beat that was reached by skipping was compared with the bound: it cannot raise it.
            host: if skips == 0 { taken.max(beat) } else { taken },
            skipped: chain.skipped,
        });
        beat
    }

    fn purge(&mut self, now: Stamp<Host>) {
        while self
            .sent
            .front()
            .is_some_and(|beat| now.saturating_since(*beat) > EXPIRY)
        {
            self.sent.pop_front();
            if let Some(chain) = &mut self.chain {
                // Too late for its answer.
                chain.skipped = 0;
            }
        }
    }

    fn is_stale(&self, now: Stamp<Host>) -> bool {
        self.chain
            .is_some_and(|chain| now.saturating_since(chain.host) > STALE)
    }
}

#[cfg(test)]
mod tests;
