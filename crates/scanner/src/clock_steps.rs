//! Clocks that are set in mid-recording: found, attributed and undone.
//!
//! Three clocks stamp a recording, and two of them may be set: the host's (by NTP, for a leap
//! second, by hand) and the lidar's (by its pulse per second, or at a restart). Either appears as a
//! lasting jump of (arrival - device time), while delays are made up for (`jumps`). The drive's
//! records are stamped by the host's clock alone. If they jump by as much at the same place, the
//! host's clock was set. Otherwise, or without records of the drive, it was the clock whose spacing
//! from packet to packet is irregular.
//!
//! All host stamps after a step of the host's clock, including the drive's (`monotonic`), are
//! converted to the clock before it. After a step of the lidar's clock, that clock has another
//! piece. The grid of the stamps shows steps of the lidar's clock down to 0.05 ms on any network;
//! where whole packets seem to be missing, the delays show that none are. Steps of the host's clock
//! from 1 ms to 10 ms are found where neither device was recorded for half a second, as on a host
//! that sleeps, and where the samples show them: by the drive's own clock (`drive_clock`), or by
//! the motion of the axis (`motion`). On a quiet network these show steps from 0.1 ms on. Where
//! nothing shows the cause, the change of the delay is reported. Others, and forward steps undone
//! within six seconds, are not found; the clock's bound contains all of them. `lidar` unwraps
//! hours.

mod drive_clock;
mod jumps;
mod monotonic;
mod motion;

use core::fmt;
use core::ops::Range;

use drive::ShaftSample;
use units::{Host, Span, Stamp};

use crate::clock::{Arrival, Joint, LidarClock, Stretch};
use jumps::{Evidence, Jump, Regular, shifted};
use monotonic::before;
pub(crate) use monotonic::{ClockSteps, HostTimeline};

/// The clock that was set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SetClock {
    /// The recording host's clock.
    Host,
    /// The lidar's clock, set or restarted.
    Lidar,
}

/// A step of a clock in mid-recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ClockStep {
    /// The clock.
    pub clock: SetClock,
    /// Time of the step, by the host's clock as it was at the beginning.
    pub when: Stamp<Host>,
    /// Time since the lidar's first packet.
    pub after: Span,
    /// Size of the step; negative if the clock was set back.
    pub by: Span,
    /// Packets that seem to be missing, as the lidar's clock was set forward by whole packets.
    pub phantom_packets: u64,
}

impl fmt::Display for ClockStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let way = if self.by < Span::ZERO {
            "back"
        } else {
            "forward"
        };
        let (by, after) = (self.by.as_secs_f64().abs(), self.after.as_secs_f64());
        match self.clock {
            SetClock::Host => write!(
                f,
                "the host's clock was set {way} by {by:.5} s, {after:.3} s into the recording; times after it are given by the clock before it"
            ),
            SetClock::Lidar => write!(
                f,
                "the lidar's clock was set {way} by {by:.5} s or started again, {after:.3} s into the recording; times of the host are not affected"
            ),
        }
    }
}

/// A sudden and lasting change of the packets' delay of which nothing shows the cause: the
/// network's delay, or a step of the host's clock that is too small for the samples. The clock's
/// bound contains it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DelayChange {
    /// Time since the lidar's first packet.
    pub after: Span,
    /// By how much packets arrive later from then on; negative if earlier.
    pub by: Span,
}

/// Clock and stamps, without the steps of the host's clock.
pub(crate) struct Timeline {
    pub clock: LidarClock,
    pub steps: Vec<ClockStep>,
    pub delay_changes: Vec<DelayChange>,
    /// Converts host stamps of the drive's records.
    pub drive: HostTimeline,
    /// The lidar's packets, with converted stamps.
    pub arrivals: Vec<Arrival>,
}

/// Packets this near to a step are not used: their side of it is uncertain.
const UNCERTAIN_PACKETS: usize = 16;

impl Timeline {
    /// Finds the lidar's clock and the steps, from packets and samples in order of recording, the
    /// samples with monotonic stamps. `None` without packets.
    pub fn new(
        arrivals: &[Arrival],
        samples: &[ShaftSample],
        clock_steps: &ClockSteps,
    ) -> Option<Self> {
        let found = jumps::find(arrivals);
        let begin = arrivals.first()?.host;
        let mut cuts: Vec<Cut> = Vec::new();
        let mut changed = Vec::new();
        for jump in &found.jumps {
            match attribute(*jump, &found, samples, clock_steps) {
                Cause::Set(cut) => cuts.push(cut),
                Cause::Delay => {}
                Cause::Unknown { at, by } => changed.push((at, by)),
            }
        }
        cuts.sort_by_key(|cut| (cut.at, cut.clock == SetClock::Host));
        separate(&mut cuts, arrivals.len());
        let pieces = pieces(arrivals, &cuts, &found.strays);
        let joints: Vec<Joint> = cuts.iter().map(Cut::joint).collect();
        let (clock, rises) = LidarClock::fit_pieces(&pieces, &joints)?;
        let mut line = HostTimeline::new(clock_steps);
        let mut steps = Vec::new();
        let mut host_steps = Vec::new();
        let mut total = Span::ZERO;
        for (cut, rise) in cuts.iter().zip(rises) {
            let first = arrivals.get(cut.at)?;
            let mut when = before(first.host, total);
            let mut by = Span::ZERO.saturating_sub(rise);
            if cut.clock == SetClock::Host {
                by = rise;
                when = before(when, by);
                total = total.saturating_add(by);
                host_steps.push((cut.at, by));
                let boundary = cut
                    .boundary
                    .or_else(|| clock_steps.boundary(cut.at, by, found.silence(cut.at)));
                line.set(boundary, by, cut.samples.clone());
            }
            steps.push(ClockStep {
                clock: cut.clock,
                when,
                after: when.saturating_since(begin),
                by,
                phantom_packets: match cut.clock {
                    SetClock::Lidar => found.phantom_packets(by),
                    SetClock::Host => 0,
                },
            });
        }
        let arrivals = shifted(arrivals, host_steps, |arrival, by| Arrival {
            host: before(arrival.host, by),
            ..arrival
        });
        let delay_changes = changed.into_iter().filter_map(|(at, by)| {
            let after = arrivals.get(at)?.host.saturating_since(begin);
            Some(DelayChange { after, by })
        });
        Some(Self {
            clock,
            steps,
            delay_changes: delay_changes.collect(),
            drive: line,
            arrivals,
        })
    }
}

/// A step of a clock among the packets.
#[derive(Clone, Debug)]
struct Cut {
    /// First packet after it.
    at: usize,
    clock: SetClock,
    /// By how much the lidar's clock was set forward, if its stamps show it.
    known: Option<Span>,
    /// Monotonic time of the first record of the drive after it, if known.
    boundary: Option<Stamp<Host>>,
    /// The samples around it, if they show it and their stamps do not tell its place.
    samples: Option<Range<usize>>,
}

impl Cut {
    const fn joint(&self) -> Joint {
        match (self.clock, self.known) {
            (SetClock::Host, _) => Joint::HostWasSet,
            (SetClock::Lidar, None) => Joint::DeviceWasSet,
            (SetClock::Lidar, Some(by)) => Joint::DeviceWasSetBy(by),
        }
    }
}

/// Puts at least one packet between two cuts, and removes those for which there is none.
fn separate(cuts: &mut Vec<Cut>, packets: usize) {
    let mut least = 1;
    for cut in cuts.iter_mut() {
        cut.at = cut.at.max(least);
        least = cut.at + 1;
    }
    cuts.retain(|cut| cut.at < packets);
}

/// Cause of a jump of the delays.
enum Cause {
    /// A clock was set.
    Set(Cut),
    /// Packets were delayed, or chance.
    Delay,
    /// The delays change from this packet on, by so much.
    Unknown { at: usize, by: Span },
}

impl From<Option<Cut>> for Cause {
    fn from(cut: Option<Cut>) -> Self {
        cut.map_or(Self::Delay, Self::Set)
    }
}

/// Attributes a jump to one of the clocks, or to packets that were merely delayed.
fn attribute(
    jump: Jump,
    found: &jumps::JumpReport,
    samples: &[ShaftSample],
    clock_steps: &ClockSteps,
) -> Cause {
    let cut = |clock| Cut {
        at: jump.at,
        clock,
        known: None,
        boundary: None,
        samples: None,
    };
    match jump.evidence {
        Evidence::Grid => {
            return Cause::Set(Cut {
                known: Some(Span::ZERO.saturating_sub(jump.by)),
                ..cut(SetClock::Lidar)
            });
        }
        Evidence::Spacing => return Cause::Set(cut(SetClock::Lidar)),
        Evidence::Silence(silence) => {
            let sleeps = clock_steps.sleeps(jump.at, silence);
            return match sleeps {
                true => Cause::Set(cut(SetClock::Host)),
                false => Cause::Unknown {
                    at: jump.at,
                    by: jump.by,
                },
            };
        }
        // No delay puts the records of the drive back.
        Evidence::Regular(_)
            if jump.by <= Span::from_nanos(-jumps::SMALLEST_OF_HOST_NS)
                && clock_steps.shows(jump.at, jump.by, Span::ZERO) =>
        {
            return Cause::Set(cut(SetClock::Host));
        }
        Evidence::Regular(regular) => {
            let next = clock_steps.next_sample(jump.at);
            let has_device_time = drive_clock::is_known(samples, next);
            let around = match has_device_time {
                true => drive_clock::step(samples, next, jump.by),
                // After a step back stamps are those of samples before it, too.
                false => motion::step(samples, next, jump.by).map(|first| first..first + 1),
            };
            let excluded = || match has_device_time {
                true => drive_clock::excludes(samples, next, jump.by),
                false => motion::excludes(samples, next, jump.by),
            };
            return match around {
                Some(around) if has_device_time => Cause::Set(Cut {
                    boundary: samples.get(around.start).map(|sample| sample.request),
                    samples: Some(around),
                    ..cut(SetClock::Host)
                }),
                Some(around) => Cause::Set(Cut {
                    boundary: samples.get(around.start).map(|sample| sample.request),
                    samples: (jump.by < Span::ZERO)
                        .then(|| around.start.saturating_sub(1)..around.end),
                    ..cut(SetClock::Host)
                }),
                None => match regular {
                    Regular::Certain { at, by } if !excluded() => Cause::Unknown { at, by },
                    _ => Cause::Delay,
                },
            };
        }
        Evidence::Delays => {}
    }
    if clock_steps.shows(jump.at, jump.by, found.silence(jump.at)) {
        return Cause::Set(cut(SetClock::Host));
    }
    if found.device_jumped(&found.level, jump.at) {
        return Cause::Set(cut(SetClock::Lidar));
    }
    let is_dense = clock_steps.is_dense(jump.at);
    (!is_dense).then(|| cut(SetClock::Host)).into()
}

/// The packets between the steps, without uncertain ones, in order of device time.
fn pieces(arrivals: &[Arrival], cuts: &[Cut], strays: &[usize]) -> Vec<Stretch> {
    let ends = cuts.iter().map(|cut| cut.at).chain([arrivals.len()]);
    let mut from = 0;
    let mut pieces = Vec::new();
    for to in ends {
        let sound = |range: core::ops::Range<usize>| -> Vec<Arrival> {
            let sound = range.filter(|i| strays.binary_search(i).is_err());
            sound.filter_map(|i| arrivals.get(i).copied()).collect()
        };
        let whole = sound(from..to);
        let begin = if from > 0 {
            from + UNCERTAIN_PACKETS
        } else {
            from
        };
        let end = if to < arrivals.len() {
            to.saturating_sub(UNCERTAIN_PACKETS)
        } else {
            to
        };
        let mut sure = sound(begin..end.max(begin));
        let devices = || whole.iter().map(|arrival| arrival.device);
        let begins = whole.first();
        if let (Some(first), Some(last), Some(begins)) = (devices().min(), devices().max(), begins)
        {
            let (join, received) = (begins.device, begins.host);
            let mut all = whole;
            for some in [&mut all, &mut sure] {
                some.sort_unstable_by_key(|a| (a.device, a.host));
            }
            pieces.push(Stretch {
                all,
                sure,
                first,
                last,
                join,
                received,
            });
        }
        from = to;
    }
    pieces
}

#[cfg(test)]
mod tests;
