//! Clocks that are set in mid-recording: found, told apart, undone.
//!
//! Three clocks stamp what is recorded, and two of them may be set: the host's (by NTP, for a leap
//! second, by hand) and the lidar's (by its pulse per second, or because it began anew). Either
//! shows as a jump of (arrival - device time) that stays: a delay goes as it came, this does not
//! (`jumps`). Whose clock it was is told by who else saw it. The drive's records are stamped by the
//! host's clock alone, so if they jump by as much at the same place of the recording, it was the
//! host's; else, and without records of the drive, it was the clock whose spacing from packet to
//! packet was not its usual one.
//!
//! All host stamps after a step of the host's clock, the drive's too (`monotonic`), are brought
//! back to the clock before it, so time goes on evenly and so do clock and trajectory. A lidar's
//! clock that was set has another piece from then on. Steps of the host's clock below 10 ms are not
//! looked for: they show in the clock's bound. So does what is undone within six seconds. An hour
//! that wraps is nothing to be found here: `lidar` unwraps it.

mod jumps;
mod monotonic;

use core::fmt;

use units::{Host, Span, Stamp};

use crate::clock::{Arrival, LidarClock, Stretch};
use jumps::Jump;
use monotonic::before;
pub(crate) use monotonic::{ClockSteps, HostTimeline};

/// Which clock was set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetClock {
    /// The recording host's.
    Host,
    /// The lidar's, or the lidar began anew.
    Lidar,
}

/// A clock that was set in mid-recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClockStep {
    /// Which.
    pub clock: SetClock,
    /// When, by the host's clock as it was at the recording's begin.
    pub when: Stamp<Host>,
    /// How long after the lidar's first packet.
    pub after: Span,
    /// How far forward; negative where it was set back.
    pub by: Span,
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
                "the lidar's clock was set {way} by {by:.5} s or began anew, {after:.3} s into the recording; times of the host are not affected"
            ),
        }
    }
}

/// Time as it went on.
pub(crate) struct Timeline {
    pub clock: LidarClock,
    pub steps: Vec<ClockStep>,
    /// Host stamps of the drive's records, brought to one clock.
    pub drive: HostTimeline,
    /// The lidar's packets, likewise.
    pub arrivals: Vec<Arrival>,
}

/// Packets this near to a step say nothing: which side they are of is not certain.
const UNSURE: usize = 16;

impl Timeline {
    /// Finds the lidar's clock and what steps there were, from packets in the order in which they
    /// were recorded. `None` without a packet.
    pub fn new(arrivals: &[Arrival], monotonic: &ClockSteps) -> Option<Self> {
        let found = jumps::find(arrivals);
        let mut cuts: Vec<(Jump, SetClock)> = found
            .jumps
            .iter()
            .filter_map(|jump| Some((*jump, judge(*jump, &found, arrivals, monotonic)?)))
            .collect();
        cuts.sort_by_key(|(jump, _)| jump.at);
        let pieces = pieces(arrivals, &cuts, &found.strays);
        let host_was_set: Vec<bool> = cuts
            .iter()
            .map(|(_, clock)| *clock == SetClock::Host)
            .collect();
        let (clock, rises) = LidarClock::fit_pieces(&pieces, &host_was_set)?;
        let begin = arrivals.first()?.host;
        let mut line = HostTimeline::new(monotonic);
        let mut steps = Vec::new();
        let mut corrected = arrivals.to_vec();
        let mut total = Span::ZERO;
        for ((jump, clock), rise) in cuts.iter().zip(rises) {
            let first = arrivals.get(jump.at)?;
            let when = before(first.host, total);
            let by = match clock {
                SetClock::Host => rise,
                SetClock::Lidar => Span::ZERO.saturating_sub(rise),
            };
            if *clock == SetClock::Host {
                total = total.saturating_add(by);
                for arrival in corrected.get_mut(jump.at..).unwrap_or_default() {
                    arrival.host = before(arrival.host, by);
                }
                line.set(monotonic.boundary(jump.at, by), by);
            }
            let when = match clock {
                SetClock::Host => before(when, by),
                SetClock::Lidar => when,
            };
            steps.push(ClockStep {
                clock: *clock,
                when,
                after: when.saturating_since(begin),
                by,
            });
        }
        Some(Self {
            clock,
            steps,
            drive: line,
            arrivals: corrected,
        })
    }
}

/// Whose clock jumped; `None` where neither did, and packets were merely delayed.
fn judge(
    jump: Jump,
    found: &jumps::JumpReport,
    arrivals: &[Arrival],
    monotonic: &ClockSteps,
) -> Option<SetClock> {
    if monotonic.shows(jump.at, jump.by) {
        return Some(SetClock::Host);
    }
    let device_jumped = found.device_jumped(arrivals, jump.at);
    if monotonic.is_dense(jump.at) {
        return device_jumped.then_some(SetClock::Lidar);
    }
    if device_jumped {
        Some(SetClock::Lidar)
    } else {
        Some(SetClock::Host)
    }
}

/// The packets between the cuts, without those that are not certain, in order of device time; with
/// the first and last of all.
fn pieces(arrivals: &[Arrival], cuts: &[(Jump, SetClock)], strays: &[usize]) -> Vec<Stretch> {
    let ends = cuts.iter().map(|(jump, _)| jump.at).chain([arrivals.len()]);
    let mut from = 0;
    let mut pieces = Vec::new();
    for to in ends {
        let sound = |range: core::ops::Range<usize>| -> Vec<Arrival> {
            let sound = range.filter(|i| strays.binary_search(i).is_err());
            sound.filter_map(|i| arrivals.get(i).copied()).collect()
        };
        let whole = sound(from..to);
        let begin = if from > 0 { from + UNSURE } else { from };
        let end = if to < arrivals.len() {
            to.saturating_sub(UNSURE)
        } else {
            to
        };
        let mut sure = sound(begin..end.max(begin));
        if sure.len() < UNSURE {
            sure.clone_from(&whole);
        }
        let devices = || whole.iter().map(|arrival| arrival.device);
        if let (Some(first), Some(last)) = (devices().min(), devices().max()) {
            sure.sort_unstable_by_key(|a| (a.device, a.host));
            pieces.push(Stretch {
                arrivals: sure,
                first,
                last,
                join: whole.first().map_or(first, |arrival| arrival.device),
            });
        }
        from = to;
    }
    pieces
}

#[cfg(test)]
mod tests;
