//! Matches TPDOs to the SYNC messages that triggered them.
//!
//! A PDO does not name its SYNC. PDOs arrive in the order of the SYNCs, but both may be lost, and
//! at 1 kHz a PDO may arrive after the next SYNC. A position must never be matched to a SYNC later
//! than itself: the span from SYNC to arrival would not contain the time of the sample. An earlier
//! SYNC only makes the span longer. Matching therefore starts with a single SYNC, or with the
//! first since the PDOs were enabled, and goes on in order. After a loss it skips a SYNC only if
//! the drive's clock shows that the next one also preceded the sample. The matches themselves
//! relate that clock to the host's: a sample is never older than its SYNC, so the maximum of (SYNC
//! - drive time) over all matches is a lower bound of the clock offset.
//!
//! The client and the listener share this code, so a log is matched as its capture was.

use std::collections::VecDeque;

use units::{Host, Span, Stamp};

/// Matches SYNC messages with the PDOs that answer them.
#[derive(Clone, Debug, Default)]
pub(crate) struct SyncMatcher {
    /// Unanswered SYNCs, oldest first.
    unanswered: VecDeque<Stamp<Host>>,
    /// The last SYNC, while a PDO may arrive that cannot be matched.
    last_open: Option<Stamp<Host>>,
    /// Start of observation.
    since: Option<Stamp<Host>>,
    /// Whether every SYNC since the PDOs were enabled is known: the first PDO is not older than
    /// the oldest of them.
    is_complete: bool,
    last: Option<SyncMatch>,
}

/// The latest match.
#[derive(Clone, Copy, Debug)]
struct SyncMatch {
    sync: Stamp<Host>,
    drive_us: u32,
    /// Lower bound of the host time of the sample.
    sampled: Stamp<Host>,
    /// Skipped SYNCs whose PDOs may still arrive.
    skipped: u32,
}

impl SyncMatch {
    /// Whether `sync` certainly preceded the sample: by the lower bound, or by a margin of
    /// [`SLACK`] if at least half a period passed since the last sample.
    fn precedes(&self, sync: Stamp<Host>, elapsed_us: i64, sampled: Stamp<Host>) -> bool {
        let period = sync.saturating_since(self.sync);
        let regular = Span::from_micros(elapsed_us) >= period.half();
        sync <= sampled || (regular && sync <= sampled.saturating_add(SLACK))
    }
}

/// Age at which a SYNC counts as lost. A drive answers within a few control cycles of 1 ms;
/// adapters and busy hosts add delay.
const EXPIRY: Span = Span::from_millis(100);
/// The same for SYNCs before the start of observation; shorter, as a log may start with a command.
const STARTUP: Span = Span::from_millis(10);
/// Shortest period of SYNCs: the drive's position control runs at 1 kHz. A SYNC that follows after
/// less than half of it was sent because the one before it was answered, not by jitter.
const CONTROL_CYCLE: Span = Span::from_millis(1);
/// Age of the last match after which matching restarts: the clocks may have drifted by 0.4 ms.
const STALE: Span = Span::from_secs(2);
/// Margin of comparisons with the lower bound: less than a SYNC takes to the drive (a frame of at
/// least 44 bits takes 44 us at 1 Mbit/s).
const SLACK: Span = Span::from_micros(5);
/// Largest relative drift of the two clocks, in ppm (two crystals of 100 ppm).
const DRIFT_PPM: i64 = 200;

impl SyncMatcher {
    /// Records that the bus is observed.
    pub fn observe(&mut self, now: Stamp<Host>) {
        self.since.get_or_insert(now);
    }

    pub fn handle_sync(&mut self, sent: Stamp<Host>) {
        self.observe(sent);
        self.expire(sent);
        if self.is_stale(sent) {
            self.restart();
        }
        let is_early = |open: &Stamp<Host>| sent.saturating_since(*open) < CONTROL_CYCLE.half();
        if self.last.is_none() && !self.is_complete && self.unanswered.back().is_some_and(is_early)
        {
            // The master has received the PDO of the single SYNC; a recorder has dropped it.
            self.unanswered.clear();
            self.last_open = None;
        }
        if sent < self.earliest_sync(sent) && !self.is_complete {
            // Its PDO cannot be distinguished from an earlier one's.
            self.unanswered.clear();
        } else {
            self.unanswered.push_back(sent);
        }
        self.last_open = Some(sent);
    }

    /// The earliest time for the next SYNC whose PDO can be matched.
    pub fn earliest_sync(&self, now: Stamp<Host>) -> Stamp<Host> {
        if self.last.is_some() && !self.is_stale(now) {
            return now;
        }
        let startup = self.since.map(|since| since.saturating_add(STARTUP));
        let open = self.last_open.map(|open| open.saturating_add(EXPIRY));
        startup.max(open).unwrap_or(now)
    }

    /// The SYNC that triggered a PDO with this drive time; `None` where that is not certain.
    pub fn handle_pdo(&mut self, drive_us: u32, arrival: Stamp<Host>) -> Option<Stamp<Host>> {
        self.observe(arrival);
        self.expire(arrival);
        let Some(last) = self.last else {
            let sync = self.unanswered.pop_front()?;
            self.last_open = None;
            self.last = Some(SyncMatch {
                sync,
                drive_us,
                sampled: sync,
                skipped: 0,
            });
            return Some(sync);
        };
        // The drive's counter wraps every 71 minutes.
        let elapsed_us = i64::from(drive_us.wrapping_sub(last.drive_us).cast_signed());
        if elapsed_us == 0 {
            // The bus repeated the frame.
            return None;
        }
        if elapsed_us < 0 || Span::from_micros(elapsed_us) > STALE {
            // The drive has restarted its clock.
            self.restart();
            return None;
        }
        Some(self.next_match(last, drive_us, elapsed_us, arrival))
    }

    /// Whether a first match exists, so that further SYNCs may follow in sequence.
    pub fn is_started(&self) -> bool {
        self.last.is_some()
    }

    /// Restarts matching with a single SYNC.
    pub fn restart(&mut self) {
        self.last = None;
        self.unanswered.clear();
        self.is_complete = false;
    }

    /// Restarts matching where the PDOs are enabled: no PDO is under way.
    pub fn handle_enabled(&mut self) {
        self.restart();
        self.is_complete = true;
    }

    fn next_match(
        &mut self,
        mut last: SyncMatch,
        drive_us: u32,
        elapsed_us: i64,
        arrival: Stamp<Host>,
    ) -> Stamp<Host> {
        let elapsed_ns = elapsed_us * 1_000 - elapsed_us * DRIFT_PPM / 1_000;
        let sampled = last.sampled.saturating_add(Span::from_nanos(elapsed_ns));
        // No sample is later than its arrival: the drive's clock has advanced by more than the
        // host's, which was set back meanwhile.
        let sampled = match sampled > arrival {
            true => last.sync,
            false => sampled,
        };
        let bound = sampled.saturating_add(SLACK);
        let mut skips = 0;
        while self.unanswered.get(1).is_some_and(|next| *next <= bound) {
            self.unanswered.pop_front();
            skips += 1;
        }
        last.skipped = last.skipped.saturating_add(skips);
        let next = self.unanswered.front().copied();
        let sync = match next.filter(|sync| *sync <= arrival) {
            // Possibly the late PDO of a skipped SYNC: the last SYNC is certainly earlier.
            Some(sync)
                if last.skipped > 0 && skips == 0 && !last.precedes(sync, elapsed_us, sampled) =>
            {
                last.skipped -= 1;
                last.sync
            }
            Some(sync) => {
                self.unanswered.pop_front();
                sync
            }
            None => {
                last.skipped = last.skipped.saturating_sub(1);
                last.sync
            }
        };
        if self.unanswered.is_empty() && last.skipped == 0 {
            self.last_open = None;
        }
        self.last = Some(SyncMatch {
            sync,
            drive_us,
            // A SYNC reached by skipping was compared with the bound and cannot raise it.
            sampled: if skips == 0 {
                sampled.max(sync)
            } else {
                sampled
            },
            skipped: last.skipped,
        });
        sync
    }

    fn expire(&mut self, now: Stamp<Host>) {
        while self
            .unanswered
            .front()
            .is_some_and(|sync| now.saturating_since(*sync) > EXPIRY)
        {
            self.unanswered.pop_front();
            // PDOs of skipped SYNCs are even older.
            match &mut self.last {
                Some(last) => last.skipped = 0,
                None => self.restart(),
            }
        }
    }

    fn is_stale(&self, now: Stamp<Host>) -> bool {
        self.last
            .is_some_and(|last| now.saturating_since(last.sampled) > STALE)
    }
}

#[cfg(test)]
mod tests;
