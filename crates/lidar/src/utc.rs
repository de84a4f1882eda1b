//! UTC of a sensor with a GPS receiver: the hour from NMEA, minutes and below from the sensor's
//! clock.
//!
//! With a pulse per second and a valid fix the sensor sets its minutes and seconds from the
//! sentence and steers its clock by the pulse, so its time past the hour is that of UTC. The
//! sentence of a position packet only gives the hour, so its age of some seconds does not matter.
//! Without a lock UTC is unknown. The sensor's counter does not show leap seconds.

use std::collections::VecDeque;
use std::{fmt, mem};

use protocol::vlp16::{NmeaError, PositionPacket, Pps};
use thiserror::Error;
use units::{Host, Lidar, Span, Stamp};

const HOUR_NS: i64 = 3_600_000_000_000;
/// Oldest valid sentence. A sentence describes the second that has begun and is repeated until the
/// next, for which a receiver may take two seconds. Older ones are left from a receiver that
/// stopped sending.
const OLDEST_FIX: Span = Span::from_secs(5);
/// Larger differences are those of an unset clock, not of an old sentence.
const MAX_AGE_OF_SET_CLOCK: Span = Span::from_secs(60);
/// Newest valid sentence: some receivers send the time of the next pulse.
const NEWEST_FIX: Span = Span::from_millis(-1_500);
/// Longest time without a position packet while locked. Sensors send one every ten milliseconds.
const LONGEST_SILENCE: Span = Span::from_secs(5);
/// Up to this time before the last one position packets are out of order; beyond, the clock was
/// set.
const REORDER: Span = Span::from_secs(2);
/// Up to this time before the last one data are out of order; beyond, the clock was set.
const DATA_REORDER: Span = Span::from_millis(20);
/// Difference of two clocks of which one is set to a zone's time: from UTC-12 to UTC+14.
const MAX_ZONE_H: i64 = 26;
/// Limit of stored locks; the oldest are dropped.
const MAX_LOCKS: usize = 4_096;

/// Coordinated universal time: nanoseconds since 1970-01-01 without leap seconds.
pub enum Utc {}

/// Relation of the sensor's clock to UTC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UtcState {
    /// Pulse and fix are valid: UTC is device time plus a number of hours.
    Locked {
        /// Hours from device time, which follows the host's hour, to UTC; 0 if the host's clock is
        /// correct.
        hours: i64,
    },
    /// UTC is unknown.
    Unlocked(NoUtc),
}

/// Reason why UTC is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NoUtc {
    /// No position packet has arrived.
    #[error("no position packet yet")]
    NotYet,
    /// The pulse-per-second input is not locked.
    #[error("{}", pps_text(*.0))]
    Pulse(Pps),
    /// The NMEA sentence is missing or invalid.
    #[error("{0}")]
    Sentence(NmeaError),
    /// The receiver has no valid fix.
    #[error("the receiver has no valid fix")]
    NoFix,
    /// The sentence is left from a receiver that stopped sending.
    #[error("the sentence is {:.1} s old", age.as_secs_f64())]
    Stale {
        /// Device time since the second of the sentence.
        age: Span,
    },
    /// Device time past the hour differs from the sentence's: the sensor has not set its clock.
    #[error("device time is {:.1} s off the sentence's minutes and seconds", by.as_secs_f64())]
    Apart {
        /// Device time past the hour less the sentence's, within half an hour.
        by: Span,
    },
    /// No position packet for 5 s of device time.
    #[error("position packets stopped")]
    Silent,
    /// Device time decreased: the sensor set its clock.
    #[error("the device set its clock back")]
    ClockSet,
}

/// A change of the lock or of the reason for its absence.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct UtcChange {
    /// Device time of the change.
    pub at: Stamp<Lidar>,
    /// The new state.
    pub state: UtcState,
}

/// A span of device time in which UTC is known.
#[derive(Clone, Copy, Debug)]
struct UtcLock {
    from: Stamp<Lidar>,
    /// `None` for the current lock.
    until: Option<Stamp<Lidar>>,
    offset: Span,
}

/// Converts device time of one sensor into UTC by its position packets.
///
/// It takes packets in order of arrival, and device times of the decoder, so that both have the
/// same hour.
#[derive(Clone, Debug)]
pub struct UtcClock {
    state: UtcState,
    locks: VecDeque<UtcLock>,
    data: Option<Stamp<Lidar>>,
    position: Option<Stamp<Lidar>>,
}

impl Default for UtcClock {
    fn default() -> Self {
        Self::new()
    }
}

impl UtcClock {
    /// Creates a clock without a lock.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            state: UtcState::Unlocked(NoUtc::NotYet),
            locks: VecDeque::new(),
            data: None,
            position: None,
        }
    }

    /// Takes the device time of the last decoded firing. Returns the change if it ends the lock.
    pub fn data(&mut self, at: Stamp<Lidar>) -> Option<UtcChange> {
        let back = self
            .data
            .map_or(Span::ZERO, |last| last.saturating_since(at));
        if Span::ZERO < back && back <= DATA_REORDER {
            return None;
        }
        self.data = Some(at);
        if back > Span::ZERO {
            self.position = None;
            // The device repeats these times, so their earlier relation to UTC is ambiguous.
            self.locks.retain(|lock| lock.from < at);
            for lock in &mut self.locks {
                lock.until = Some(lock.until.map_or(at, |until| until.min(at)));
            }
            return self.unlock(at, NoUtc::ClockSet);
        }
        let silent = self
            .position
            .is_some_and(|last| at.saturating_since(last) > LONGEST_SILENCE);
        if silent && matches!(self.state, UtcState::Locked { .. }) {
            self.unlock(at, NoUtc::Silent)
        } else {
            None
        }
    }

    /// Takes a position packet that arrived at `host`. Returns the change it causes.
    ///
    /// Packets that arrive after a later one are ignored.
    pub fn position(
        &mut self,
        host: Stamp<Host>,
        packet: &PositionPacket<'_>,
    ) -> Option<UtcChange> {
        let at = self.device_time(packet.timestamp_us(), host);
        if let Some(last) = self.position {
            let back = last.saturating_since(at);
            if back > Span::ZERO && back <= REORDER {
                return None;
            }
        }
        self.position = Some(at);
        match hours_to_utc(at, packet) {
            Ok(hours) => self.lock(at, hours),
            Err(why) => self.unlock(at, why),
        }
    }

    /// UTC at a device time; `None` without a lock and after the year 2262, the range of stamps.
    #[must_use]
    pub fn utc(&self, at: Stamp<Lidar>) -> Option<Stamp<Utc>> {
        let lock = self.locks.iter().rev().find(|lock| {
            let before_end = lock.until.is_none_or(|until| at < until);
            lock.from <= at && before_end
        })?;
        let ns = at.as_nanos().checked_add(lock.offset.as_nanos())?;
        Some(Stamp::from_nanos(ns))
    }

    /// Number of locks that ended.
    #[must_use]
    pub fn ends(&self) -> usize {
        self.locks
            .iter()
            .filter(|lock| lock.until.is_some())
            .count()
    }

    /// The current state.
    #[must_use]
    pub const fn state(&self) -> UtcState {
        self.state
    }

    /// Device time of a position packet, in the hour nearest to the data, or to the host's clock
    /// without data.
    fn device_time(&self, us: u32, host: Stamp<Host>) -> Stamp<Lidar> {
        let seen = self.data.or(self.position).map(Stamp::as_nanos);
        let past_hour = i64::from(us) * 1_000;
        let hours = whole_hours(seen.unwrap_or(host.as_nanos()).saturating_sub(past_hour));
        Stamp::from_nanos(hours.saturating_mul(HOUR_NS).saturating_add(past_hour))
    }

    fn lock(&mut self, at: Stamp<Lidar>, hours: i64) -> Option<UtcChange> {
        let state = UtcState::Locked { hours };
        if self.state == state {
            return None;
        }
        self.end(at);
        if self.locks.len() == MAX_LOCKS {
            self.locks.pop_front();
        }
        self.locks.push_back(UtcLock {
            from: at,
            until: None,
            offset: Span::from_nanos(hours.saturating_mul(HOUR_NS)),
        });
        self.state = state;
        Some(UtcChange { at, state })
    }

    fn unlock(&mut self, at: Stamp<Lidar>, why: NoUtc) -> Option<UtcChange> {
        let (was, state) = (self.state, UtcState::Unlocked(why));
        self.end(at);
        self.state = state;
        let is_new = match was {
            UtcState::Unlocked(was) => !was.is_like(why),
            UtcState::Locked { .. } => true,
        };
        is_new.then_some(UtcChange { at, state })
    }

    /// Ends the current lock, if there is one.
    fn end(&mut self, at: Stamp<Lidar>) {
        if let Some(lock) = self.locks.back_mut()
            && lock.until.is_none()
        {
            lock.until = Some(at.max(lock.from));
        }
    }
}

/// Hours from device time to UTC by one packet.
fn hours_to_utc(at: Stamp<Lidar>, packet: &PositionPacket<'_>) -> Result<i64, NoUtc> {
    if packet.pps() != Pps::Locked {
        return Err(NoUtc::Pulse(packet.pps()));
    }
    let rmc = packet.rmc().map_err(NoUtc::Sentence)?;
    let fix = rmc.utc.filter(|_| rmc.valid).ok_or(NoUtc::NoFix)?;
    let difference_ns = fix.unix_nanos().saturating_sub(at.as_nanos());
    let hours = whole_hours(difference_ns);
    let age = Span::from_nanos(hours.saturating_mul(HOUR_NS).saturating_sub(difference_ns));
    if age < NEWEST_FIX || age > MAX_AGE_OF_SET_CLOCK {
        Err(NoUtc::Apart { by: age })
    } else if age > OLDEST_FIX {
        Err(NoUtc::Stale { age })
    } else {
        Ok(hours)
    }
}

/// Rounds to the nearest hour.
const fn whole_hours(ns: i64) -> i64 {
    ns.saturating_add(HOUR_NS / 2).div_euclid(HOUR_NS)
}

impl fmt::Display for UtcState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Locked { hours: 0 } => write!(f, "locked"),
            Self::Locked { hours } if hours.abs() <= MAX_ZONE_H => {
                write!(f, "locked; the host's clock is {:+} h off", -hours)
            }
            Self::Locked { hours } => {
                let days = hours.unsigned_abs() / 24;
                let side = if *hours > 0 { "after" } else { "before" };
                write!(
                    f,
                    "locked; the receiver's date is {days} days {side} that of the recording: one is simulated, or the host's clock was not set"
                )
            }
            Self::Unlocked(why) => write!(f, "no lock: {why}"),
        }
    }
}

impl NoUtc {
    /// Ages and differences change with every packet and are reported once.
    fn is_like(self, other: Self) -> bool {
        match (self, other) {
            (Self::Pulse(a), Self::Pulse(b)) => a == b,
            _ => mem::discriminant(&self) == mem::discriminant(&other),
        }
    }
}

fn pps_text(pps: Pps) -> String {
    match pps {
        Pps::Absent => "no pulse per second".to_owned(),
        Pps::Synchronising => "synchronising to the pulse per second".to_owned(),
        Pps::Error => "the pulse per second is in error".to_owned(),
        Pps::Locked => "the pulse per second is locked".to_owned(),
        Pps::Unknown(byte) => format!("pulse-per-second state {byte} is not known"),
    }
}

#[cfg(test)]
mod tests;
