//! Stamps of the drive's records across steps of the host's clock.
//!
//! Requests are paired with answers by their stamps, which must not go back or leap. While records
//! come in, stamps that cannot be of one clock are therefore made monotonic: those that go back, or
//! leap while the lidar's clock does not. Monotonic time serves pairing only. Once the steps are
//! known from the whole recording, [`HostTimeline`] converts each stamp to the recorded one, less
//! the steps before it.

use core::ops::Range;

use drive::ShaftSample;
use units::{Host, Span, Stamp};

use super::drive_clock;

/// Stamps that go back by more are of a clock that was set back.
const BACK: Span = Span::from_millis(-2);
/// Stamps that leap by more than the lidar's clock are of a clock that was set forward. Smaller
/// leaps do not disturb pairing.
const LEAP: Span = Span::from_millis(1_500);
/// Monotonic time put between two clocks where the lidar's clock does not show the true interval:
/// after so long a silence pairing restarts.
const STEP_GAP: Span = Span::from_millis(2_500);
/// Otherwise pairing goes on, as answers may be under way. By this much the time put between
/// exceeds the true one, so that no request seems to be earlier than it was.
const GAP_MARGIN: Span = Span::from_millis(20);
/// The lidar's clock is compared only if its packets are this near.
const MAX_PACKET_DISTANCE: Span = Span::from_millis(500);
/// Pauses from this length on are recorded: a step may be hidden in them.
const PAUSE: Span = Span::from_millis(8);
/// Records of lidar and drive are in order within this number of packets.
const MAX_DISORDER: u32 = 754;
/// Shortest time for which a host sleeps.
const SLEEP: Span = Span::from_millis(50);
/// Records of lidar and drive after it are in order within this number of packets.
const MAX_SLEEP_DISORDER: u32 = 64;
/// Samples within that on either side that make a pause evident.
const MIN_DENSE_SAMPLES: usize = 8;

/// Stamps of the drive's records, made monotonic across steps of the host's clock.
#[derive(Clone, Debug, Default)]
pub(crate) struct ClockSteps {
    /// Recorded stamp of the last record.
    last: Option<Stamp<Host>>,
    /// Recorded less monotonic time.
    shift: Span,
    /// Monotonic time from which on each shift holds.
    shifts: Vec<(Stamp<Host>, Span)>,
    pauses: Vec<Pause>,
    /// Number of lidar packets before each sample.
    samples: Vec<u32>,
    packets: u32,
    /// Device time and stamp of the lidar's last packet, and its device time at the drive's last
    /// record.
    lidar: Option<(i64, Stamp<Host>)>,
    lidar_then: Option<i64>,
}

/// A pause between two records of the drive, or a step back.
#[derive(Clone, Copy, Debug)]
struct Pause {
    /// Monotonic time of the record after it.
    until: Stamp<Host>,
    /// Length by the recorded stamps.
    length: Span,
    /// Number of lidar packets before the record after it.
    packets: u32,
}

impl ClockSteps {
    /// Takes the stamp of a lidar packet.
    pub fn packet(&mut self, device_ns: i64, host: Stamp<Host>) {
        self.packets = self.packets.saturating_add(1);
        self.lidar = Some((device_ns, host));
    }

    /// Notes that the last record completed a shaft sample.
    pub fn sample(&mut self) {
        self.samples.push(self.packets);
    }

    /// Takes the stamp of a record of the drive, and returns its monotonic time.
    pub fn monotonic(&mut self, host: Stamp<Host>) -> Stamp<Host> {
        if let Some(last) = self.last {
            let length = host.saturating_since(last);
            let advance = self.lidar_advance(last, host);
            if length < BACK || advance.is_some_and(|advance| length.saturating_sub(advance) > LEAP)
            {
                let gap = advance.map_or(STEP_GAP, |advance| {
                    STEP_GAP.min(advance.saturating_add(GAP_MARGIN))
                });
                self.shift = self.shift.saturating_add(length).saturating_sub(gap);
                let monotonic = before(host, self.shift);
                self.shifts.push((monotonic, self.shift));
            }
            if length < BACK || length > PAUSE {
                self.pauses.push(Pause {
                    until: before(host, self.shift),
                    length,
                    packets: self.packets,
                });
            }
        }
        self.last = Some(host);
        self.lidar_then = self.lidar.map(|lidar| lidar.0);
        before(host, self.shift)
    }

    /// Advance of the lidar's clock since the drive's last record, if packets are near.
    fn lidar_advance(&self, last: Stamp<Host>, host: Stamp<Host>) -> Option<Span> {
        let (now, stamp) = self.lidar?;
        let near = |other: Stamp<Host>| {
            let distance = stamp.saturating_since(other);
            -MAX_PACKET_DISTANCE < distance && distance < MAX_PACKET_DISTANCE
        };
        let advance = Span::from_nanos(now.saturating_sub(self.lidar_then?));
        ((near(last) || near(host)) && advance >= Span::ZERO).then_some(advance)
    }

    /// Whether the drive's records jump by about `by` near the lidar's packet `at`, before which
    /// the lidar was silent for so long.
    pub fn shows(&self, at: usize, by: Span, silence: Span) -> bool {
        self.pause(at, by, silence).is_some()
    }

    /// Whether the drive's records pause, too, while the lidar's are silent before its packet `at`.
    pub fn sleeps(&self, at: usize, silence: Span) -> bool {
        let at = packets(at);
        self.pauses
            .iter()
            .any(|pause| pause.packets.abs_diff(at) <= NEAR && pause.length >= silence.half())
    }

    /// Number of samples before the lidar's packet `at`.
    pub fn next_sample(&self, at: usize) -> usize {
        self.samples.partition_point(|s| *s < packets(at))
    }

    /// Whether the drive's samples are dense enough near there to show a jump.
    pub fn is_dense(&self, at: usize) -> bool {
        let at = packets(at);
        let here = self.samples.partition_point(|s| *s < at);
        let first = self
            .samples
            .partition_point(|s| *s < at.saturating_sub(MAX_DISORDER / 2));
        let end = at.saturating_add(MAX_DISORDER / 2);
        let last = self.samples.partition_point(|s| *s <= end);
        here - first >= MIN_DENSE_SAMPLES && last - here >= MIN_DENSE_SAMPLES
    }

    /// First monotonic time after a step of the host's clock by `by` at the lidar's packet `at`,
    /// before which the lidar was silent for so long; `None` if no record follows.
    pub fn boundary(&self, at: usize, by: Span, silence: Span) -> Option<Stamp<Host>> {
        let after = packets(at).saturating_sub(NEAR);
        let pause = self.pause(at, by, silence).or_else(|| {
            // The drive was silent for a while.
            self.pauses.iter().find(|pause| pause.packets >= after)
        });
        pause.map(|pause| pause.until)
    }

    /// The pause that matches the step best. While the host sleeps, the drive's records pause for
    /// up to as long as the lidar's, in addition to the step.
    fn pause(&self, at: usize, by: Span, silence: Span) -> Option<&Pause> {
        let at = packets(at);
        let excess = |pause: &Pause| pause.length.saturating_sub(by);
        let is_within = |excess: Span, longest: Span| BACK < excess && excess < longest;
        let is_of_step = |pause: &Pause| {
            let is_near = pause.packets.abs_diff(at) <= MAX_DISORDER;
            is_near && is_within(excess(pause), max_excess(by))
        };
        let is_of_sleep = |pause: &Pause| {
            let is_near = pause.packets.abs_diff(at) <= MAX_SLEEP_DISORDER;
            let is_long = pause.length < BACK || pause.length > SLEEP;
            let longest = silence.saturating_add(max_excess(silence));
            silence > SLEEP && is_near && is_long && is_within(excess(pause), longest)
        };
        self.pauses
            .iter()
            .filter(|pause| is_of_step(pause) || is_of_sleep(pause))
            .min_by_key(|pause| {
                // A pause of the same length may be near, but not as near.
                let distance = i64::from(pause.packets.abs_diff(at));
                let excess = excess(pause).as_nanos();
                let beyond_silence = excess.saturating_sub(silence.as_nanos());
                let excess = excess.saturating_abs().min(beyond_silence.saturating_abs());
                excess.saturating_add(distance.saturating_mul(PER_PACKET_NS))
            })
    }
}

/// Packets before the step in the file within which a record of the drive may come after it.
const NEAR: u32 = 4;

/// Mismatch that outweighs one packet of distance.
const PER_PACKET_NS: i64 = 200_000;

/// Greatest length of a pause beyond that of the step or silence.
fn max_excess(by: Span) -> Span {
    Span::from_nanos((by.as_nanos().saturating_abs() / 2).clamp(10_000_000, 250_000_000))
}

fn packets(at: usize) -> u32 {
    u32::try_from(at).unwrap_or(u32::MAX)
}

/// Converts monotonic stamps to the host's clock as it was at the beginning.
#[derive(Clone, Debug)]
pub(crate) struct HostTimeline {
    shifts: Vec<(Stamp<Host>, Span)>,
    steps: Vec<HostStep>,
}

/// A step of the host's clock.
#[derive(Clone, Debug)]
struct HostStep {
    /// Monotonic time of the first record after it.
    from: Stamp<Host>,
    by: Span,
    /// The samples of which a stamp may precede or follow it, if they show it.
    samples: Option<Range<usize>>,
}

impl HostStep {
    fn at(&self, monotonic: Stamp<Host>) -> Span {
        match self.from <= monotonic {
            true => self.by,
            false => Span::ZERO,
        }
    }
}

impl HostTimeline {
    /// A timeline without steps.
    pub fn new(clock_steps: &ClockSteps) -> Self {
        Self {
            shifts: clock_steps.shifts.clone(),
            steps: Vec::new(),
        }
    }

    /// Adds a step of the host's clock by `by` before the monotonic time `from`, within `samples`.
    pub fn set(&mut self, from: Option<Stamp<Host>>, by: Span, samples: Option<Range<usize>>) {
        if let Some(from) = from {
            self.steps.push(HostStep { from, by, samples });
        }
    }

    /// The stamp by the host's clock as it was at the beginning.
    pub fn host(&self, monotonic: Stamp<Host>) -> Stamp<Host> {
        let by = self.steps.iter().map(|step| step.at(monotonic));
        before(self.recorded(monotonic), sum(by))
    }

    /// Converts the stamps of samples in order of recording. Of those near a step the request is
    /// the earliest possible and the answer the latest.
    pub fn convert(&self, samples: &mut [ShaftSample]) {
        for (i, sample) in samples.iter_mut().enumerate() {
            let (mut request, mut answer) = (Span::ZERO, Span::ZERO);
            for step in &self.steps {
                let by = step.by;
                let (early, late) = match &step.samples {
                    Some(around) if i < around.start => (Span::ZERO, Span::ZERO),
                    Some(around) if around.contains(&i) => (by.max(Span::ZERO), by.min(Span::ZERO)),
                    Some(_) => (by, by),
                    None => (step.at(sample.request), step.at(sample.answer)),
                };
                request = request.saturating_add(early);
                answer = answer.saturating_add(late);
            }
            sample.request = before(self.recorded(sample.request), request);
            sample.answer = before(self.recorded(sample.answer), answer);
        }
        for step in &self.steps {
            if let Some(around) = &step.samples {
                drive_clock::rematch(samples, around);
            }
        }
    }

    /// The recorded stamp.
    fn recorded(&self, monotonic: Stamp<Host>) -> Stamp<Host> {
        let past = self.shifts.partition_point(|(from, _)| *from <= monotonic);
        let last = past.checked_sub(1).and_then(|i| self.shifts.get(i));
        monotonic.saturating_add(last.map_or(Span::ZERO, |last| last.1))
    }
}

fn sum(spans: impl Iterator<Item = Span>) -> Span {
    spans.fold(Span::ZERO, Span::saturating_add)
}

/// An instant by the clock before a step of `by`.
pub(super) const fn before(host: Stamp<Host>, by: Span) -> Stamp<Host> {
    host.saturating_add(Span::ZERO.saturating_sub(by))
}
