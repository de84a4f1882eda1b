//! The drive's records over a step of the host's clock.
//!
//! What pairs requests with answers goes by their stamps and would stumble over time that goes back
//! or leaps. So stamps are sewn together while records come in, wherever they cannot be of one
//! clock: they go back, or leap while the lidar did not go on. The sewn time is for pairing only:
//! once it is known from the whole recording which clock was set and by how much, every stamp is
//! turned back into the one that was recorded, less the steps before it. Left out: how steps are
//! found.

use units::{Host, Span, Stamp};

/// Stamps that go back by more are of a clock that was set back.
const BACK: Span = Span::from_millis(-5);
/// A leap ahead of what the lidar shows by more is of a clock that was set forward. Less than this
/// disturbs no pairing.
const LEAP: Span = Span::from_millis(1_500);
/// What is put between two clocks: how long it truly was is not known to a microsecond, and after
/// so long a silence pairing begins anew.
const SEAM: Span = Span::from_millis(2_500);
/// The lidar tells how time went only while its packets come.
const ALIVE: Span = Span::from_millis(500);
/// Pauses from this length on are kept in mind: a step may hide in them.
const PAUSE: Span = Span::from_millis(8);
/// Records of the lidar and the drive are in the file's order to within so many packets.
const DISORDER: u32 = 754;
/// The drive speaks often enough to tell if it has so many samples within that on either side.
const DENSE: usize = 8;

/// Stamps of the drive's records as they come in.
#[derive(Clone, Debug, Default)]
pub(crate) struct ClockSteps {
    /// Recorded stamp of the last record.
    last: Option<Stamp<Host>>,
    /// Recorded less sewn time.
    shift: Span,
    /// From which sewn time on which shift holds.
    shifts: Vec<(Stamp<Host>, Span)>,
    pauses: Vec<Pause>,
    /// Packets of the lidar before each sample.
    samples: Vec<u32>,
    packets: u32,
    /// Device time and stamp of the lidar's last packet, and its device time at the drive's last
    /// record.
    lidar: Option<(i64, Stamp<Host>)>,
    lidar_then: Option<i64>,
}

/// Records with time between them, or none.
#[derive(Clone, Copy, Debug)]
struct Pause {
    /// Sewn time of the record after it.
    until: Stamp<Host>,
    /// By the stamps as recorded.
    length: Span,
    /// Packets of the lidar before the record after it.
    packets: u32,
}

impl ClockSteps {
    /// A packet of the lidar was recorded at `host`.
    pub fn packet(&mut self, device_ns: i64, host: Stamp<Host>) {
        self.packets = self.packets.saturating_add(1);
        self.lidar = Some((device_ns, host));
    }

    /// A sample of the shaft was completed by the last record.
    pub fn sample(&mut self) {
        self.samples.push(self.packets);
    }

    /// A record of the drive was stamped `host`: the sewn stamp to pair it by.
    pub fn to_monotonic(&mut self, host: Stamp<Host>) -> Stamp<Host> {
        if let Some(last) = self.last {
            let length = host.saturating_since(last);
            let went = self.went_on(last, host);
            if length < BACK || went.is_some_and(|went| length.saturating_sub(went) > LEAP) {
                self.shift = self.shift.saturating_add(length).saturating_sub(SEAM);
                let sewn = before(host, self.shift);
                self.shifts.push((sewn, self.shift));
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

    /// How far the lidar's clock went since the drive's last record, if it is there to ask.
    fn went_on(&self, last: Stamp<Host>, host: Stamp<Host>) -> Option<Span> {
        let (now, stamp) = self.lidar?;
        let near = |other: Stamp<Host>| {
            let apart = stamp.saturating_since(other);
            -ALIVE < apart && apart < ALIVE
        };
        let went = Span::from_nanos(now.saturating_sub(self.lidar_then?));
        ((near(last) || near(host)) && went >= Span::ZERO).then_some(went)
    }

    /// Whether the drive's records jump by about `by` about where the lidar's packet `at` is in the
    /// file.
    pub fn shows(&self, at: usize, by: Span) -> bool {
        self.pause(at, by).is_some()
    }

    /// Whether the drive was heard often enough about there that it would.
    pub fn is_dense(&self, at: usize) -> bool {
        let at = packets(at);
        let here = self.samples.partition_point(|s| *s < at);
        let first = self
            .samples
            .partition_point(|s| *s < at.saturating_sub(DISORDER / 2));
        let end = at.saturating_add(DISORDER / 2);
        let last = self.samples.partition_point(|s| *s <= end);
        here - first >= DENSE && last - here >= DENSE
    }

    /// The first sewn time after a step of the host's clock by `by`, at the lidar's packet `at`;
    /// `None` where no record follows.
    pub fn boundary(&self, at: usize, by: Span) -> Option<Stamp<Host>> {
        let after = packets(at).saturating_sub(NEAR);
        let pause = self.pause(at, by).or_else(|| {
            // A drive that said nothing for a while.
            self.pauses.iter().find(|pause| pause.packets >= after)
        });
        pause.map(|pause| pause.until)
    }

    /// The jump that is most like it.
    fn pause(&self, at: usize, by: Span) -> Option<&Pause> {
        let at = packets(at);
        let excess = |pause: &Pause| pause.length.saturating_sub(by);
        self.pauses
            .iter()
            .filter(|pause| pause.packets.abs_diff(at) <= DISORDER)
            .filter(|pause| BACK < excess(pause) && excess(pause) < most_excess(by))
            .min_by_key(|pause| {
                // Another pause of that length may be about, but not so near.
                let apart = i64::from(pause.packets.abs_diff(at));
                let excess = excess(pause).as_nanos().saturating_abs();
                excess.saturating_add(apart.saturating_mul(PER_PACKET_NS))
            })
    }
}

/// A record of the drive this many packets before the step in the file may come after it.
const NEAR: u32 = 4;

/// A pause that is a packet farther from the step must fit it better by so much.
const PER_PACKET_NS: i64 = 200_000;

/// How much longer than the step a pause may be.
fn most_excess(by: Span) -> Span {
    Span::from_nanos((by.as_nanos().saturating_abs() / 2).clamp(10_000_000, 250_000_000))
}

fn packets(at: usize) -> u32 {
    u32::try_from(at).unwrap_or(u32::MAX)
}

/// From sewn stamps to the host's clock as it was at the recording's begin.
#[derive(Clone, Debug)]
pub(crate) struct HostTimeline {
    shifts: Vec<(Stamp<Host>, Span)>,
    steps: Vec<(Stamp<Host>, Span)>,
}

impl HostTimeline {
    /// Stamps as they were recorded.
    pub fn new(monotonic: &ClockSteps) -> Self {
        Self {
            shifts: monotonic.shifts.clone(),
            steps: Vec::new(),
        }
    }

    /// The host's clock was set forward by `by` before the sewn time `from`.
    pub fn set(&mut self, from: Option<Stamp<Host>>, by: Span) {
        if let Some(from) = from {
            let before = self.steps.last().map_or(Span::ZERO, |last| last.1);
            self.steps.push((from, before.saturating_add(by)));
        }
    }

    /// The stamp as it would have been had nobody set the clock.
    pub fn host(&self, sewn: Stamp<Host>) -> Stamp<Host> {
        let at = |line: &[(Stamp<Host>, Span)]| {
            let past = line.partition_point(|(from, _)| *from <= sewn);
            let last = past.checked_sub(1).and_then(|i| line.get(i));
            last.map_or(Span::ZERO, |last| last.1)
        };
        before(sewn.saturating_add(at(&self.shifts)), at(&self.steps))
    }
}

/// An instant, by a clock that was not yet set forward by `by`.
pub(super) const fn before(host: Stamp<Host>, by: Span) -> Stamp<Host> {
    host.saturating_add(Span::ZERO.saturating_sub(by))
}
