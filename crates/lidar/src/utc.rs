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
            Self::Locked { hours } => write!(f, "locked; the host's clock is {:+} h off", -hours),
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
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// 2024-02-29 10:59:00 UTC (`date -u -d`).
    const TEN_59: i64 = 1_709_204_340;
    const S: i64 = 1_000_000_000;

    fn stamp<C>(ns: i64) -> Stamp<C> {
        Stamp::from_nanos(ns)
    }

    /// A position packet sent at `device_ns` of the sensor's clock with the sentence of a whole UTC
    /// second.
    fn packet(device_ns: i64, pps: u8, status: char, fix_s: i64) -> Vec<u8> {
        let of_day = fix_s.rem_euclid(86_400);
        let (hour, minute, second) = (of_day / 3_600, of_day / 60 % 60, of_day % 60);
        let date = if fix_s < 1_709_251_200 {
            "290224"
        } else {
            "010324"
        };
        let body =
            format!("GPRMC,{hour:02}{minute:02}{second:02}.00,{status},0,N,0,W,0,0,{date},,");
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        let mut bytes = vec![0; 512];
        let us = (device_ns / 1_000).rem_euclid(3_600_000_000) as u32;
        bytes[198..202].copy_from_slice(&us.to_le_bytes());
        bytes[202] = pps;
        let sentence = format!("${body}*{sum:02X}\r\n");
        bytes[206..206 + sentence.len()].copy_from_slice(sentence.as_bytes());
        bytes
    }

    /// Passes a packet sent at a device time, for a host clock that is `off_s` ahead of UTC.
    fn send(
        clock: &mut UtcClock,
        device_ns: i64,
        pps: u8,
        status: char,
        fix_s: i64,
    ) -> Option<UtcChange> {
        let bytes = packet(device_ns, pps, status, fix_s);
        clock.position(stamp(device_ns), &PositionPacket::new(&bytes).unwrap())
    }

    #[test]
    fn the_hour_follows_from_the_fix() {
        // The host's clock is slow by 5 h and 7 s; the sensor counts from its hour.
        let mut clock = UtcClock::new();
        let device = |utc_ns: i64| utc_ns - 5 * HOUR_NS;
        assert_eq!(clock.data(stamp(device(TEN_59 * S))), None);
        assert_eq!(clock.utc(stamp(device(TEN_59 * S))), None);
        let at = device(TEN_59 * S + 400_000_000);
        let bytes = packet(at, 2, 'A', TEN_59);
        let change = clock.position(stamp(at - 7 * S), &PositionPacket::new(&bytes).unwrap());
        let locked = UtcState::Locked { hours: 5 };
        assert_eq!(
            change,
            Some(UtcChange {
                at: stamp(at),
                state: locked
            })
        );
        assert_eq!(locked.to_string(), "locked; the host's clock is -5 h off");
        // UTC is known exactly from the packet on.
        assert_eq!(clock.utc(stamp(at - 1)), None);
        for after in [0, 1, 500_000_000, 1_700 * S] {
            let utc = clock.utc(stamp(at + after)).map(Stamp::as_nanos);
            assert_eq!(utc, Some(TEN_59 * S + 400_000_000 + after));
        }
    }

    #[test]
    fn the_hour_changes_on_either_side_first() {
        // Old sentences, and one of the next second, on both sides of 11:00:00 and of midnight.
        for begin_s in [TEN_59, TEN_59 + 13 * 3_600] {
            for fix_late_s in [-1, 0, 1, 2, 4] {
                let mut clock = UtcClock::new();
                for tick in 0..1_200i64 {
                    let device = begin_s * S + tick * 100_000_000 + 37_000;
                    clock.data(stamp(device));
                    let fix_s = device.div_euclid(S) - fix_late_s;
                    let change = send(&mut clock, device, 2, 'A', fix_s);
                    assert_eq!(change.is_some(), tick == 0, "{change:?}");
                    assert_eq!(clock.utc(stamp(device)), Some(stamp(device)));
                }
            }
        }
    }

    #[test]
    fn reordered_packets_change_nothing() {
        let mut clock = UtcClock::new();
        let t = TEN_59 * S;
        clock.data(stamp(t));
        send(&mut clock, t, 2, 'A', TEN_59);
        assert!(send(&mut clock, t + 30_000_000, 0, 'A', TEN_59).is_some());
        // Sent before the loss of the pulse, arrived after it.
        assert_eq!(send(&mut clock, t + 20_000_000, 2, 'A', TEN_59), None);
        assert_eq!(clock.state(), UtcState::Unlocked(NoUtc::Pulse(Pps::Absent)));
        assert!(clock.utc(stamp(t + 29_999_999)).is_some());
        assert_eq!(clock.utc(stamp(t + 30_000_000)), None);
    }

    #[test]
    fn each_reason_for_no_lock_is_reported_once() {
        let t = TEN_59 * S;
        let mut clock = UtcClock::new();
        assert_eq!(clock.state().to_string(), "no lock: no position packet yet");
        clock.data(stamp(t));
        let mut expect = |ms: i64, pps, status, fix_s, said: &str| {
            let at = t + ms * 1_000_000;
            let change = send(&mut clock, at, pps, status, fix_s).expect(said);
            assert_eq!(change.state.to_string(), said);
            assert_eq!(send(&mut clock, at + 10_000_000, pps, status, fix_s), None);
            assert_eq!(clock.utc(stamp(at)).is_some(), said == "locked", "{said}");
        };
        expect(0, 0, 'V', TEN_59, "no lock: no pulse per second");
        expect(
            100,
            1,
            'A',
            TEN_59,
            "no lock: synchronising to the pulse per second",
        );
        expect(
            200,
            2,
            'V',
            TEN_59,
            "no lock: the receiver has no valid fix",
        );
        expect(
            300,
            2,
            'A',
            TEN_59 + 400,
            "no lock: device time is -399.7 s off the sentence's minutes and seconds",
        );
        expect(400, 2, 'A', TEN_59, "locked");
        expect(
            500,
            3,
            'A',
            TEN_59,
            "no lock: the pulse per second is in error",
        );
        expect(600, 2, 'A', TEN_59, "locked");
        expect(
            700,
            2,
            'A',
            TEN_59 - 9,
            "no lock: the sentence is 9.7 s old",
        );
        expect(
            800,
            9,
            'A',
            TEN_59,
            "no lock: pulse-per-second state 9 is not known",
        );
        expect(
            900,
            2,
            'X',
            TEN_59,
            "no lock: NMEA sentence offset 223: expected status A or V",
        );
        expect(1_000, 2, 'A', TEN_59 + 1, "locked");
        // Times without a lock stay without UTC.
        assert_eq!(clock.utc(stamp(t + 750_000_000)), None);
        assert_eq!(
            clock.utc(stamp(t + 650_000_000)),
            Some(stamp(t + 650_000_000))
        );
    }

    #[test]
    fn a_lock_without_position_packets_ends() {
        let t = TEN_59 * S;
        let mut clock = UtcClock::new();
        clock.data(stamp(t));
        send(&mut clock, t, 2, 'A', TEN_59);
        assert_eq!(clock.data(stamp(t + 5 * S)), None);
        let change = clock.data(stamp(t + 5 * S + 1)).unwrap();
        assert_eq!(change.state, UtcState::Unlocked(NoUtc::Silent));
        assert_eq!(clock.data(stamp(t + 6 * S)), None);
        assert_eq!(clock.utc(stamp(t + 6 * S)), None);
        assert!(send(&mut clock, t + 7 * S, 2, 'A', TEN_59 + 7).is_some());
        assert_eq!(clock.utc(stamp(t + 7 * S)), Some(stamp(t + 7 * S)));
    }

    #[test]
    fn a_clock_set_by_the_first_sentence_is_utc() {
        // The device's clock is 700 s ahead until it is set by the sentence.
        let t = TEN_59 * S;
        let mut clock = UtcClock::new();
        clock.data(stamp(t + 700 * S));
        let change = send(&mut clock, t + 700 * S, 2, 'A', TEN_59).unwrap();
        assert!(matches!(
            change.state,
            UtcState::Unlocked(NoUtc::Apart { .. })
        ));
        let set = clock.data(stamp(t + S)).unwrap();
        assert_eq!(
            (set.at, set.state),
            (stamp(t + S), UtcState::Unlocked(NoUtc::ClockSet))
        );
        assert!(send(&mut clock, t + S, 2, 'A', TEN_59 + 1).is_some());
        assert_eq!(clock.utc(stamp(t + S)), Some(stamp(t + S)));
        // A lock before a step back does not apply to repeated times.
        let back = t + S - 500_000_000;
        clock.data(stamp(t + 2 * S));
        clock.data(stamp(back));
        assert_eq!(clock.utc(stamp(t + S + 1)), None);
    }

    #[test]
    fn times_after_the_last_stamp_have_no_utc() {
        let mut clock = UtcClock::new();
        let last = 7_514_095_636_854_775_808_i64;
        for (us, ns, pps, second) in [(0_u32, 0, 0, 0), (1_219_500_000, last, 2, 77_621)] {
            let mut bytes = packet(0, pps, 'A', 1_709_200_000 + second);
            bytes[198..202].copy_from_slice(&us.to_le_bytes());
            clock.position(stamp(ns / 2), &PositionPacket::new(&bytes).unwrap());
        }
        // A nanosecond more than a stamp can represent.
        assert_eq!(clock.utc(stamp(last)), None);
        let before = stamp(last - 1);
        let apart = clock.utc(before).unwrap().as_nanos() - before.as_nanos();
        assert_eq!(apart % HOUR_NS, 0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// UTC always differs from device time by whole hours.
        #[test]
        fn any_input_gives_whole_hours(
            steps in prop::collection::vec((any::<u32>(), any::<i64>(), 0u8..4, any::<bool>(), any::<i32>()), 1..60),
        ) {
            let mut clock = UtcClock::new();
            for (us, ns, pps, data, fix) in steps {
                if data {
                    clock.data(stamp(ns));
                }
                let mut bytes = packet(0, pps, 'A', 1_709_200_000 + i64::from(fix) % 100_000);
                bytes[198..202].copy_from_slice(&us.to_le_bytes());
                clock.position(stamp(ns / 2), &PositionPacket::new(&bytes).unwrap());
                if let Some(utc) = clock.utc(stamp(ns)) {
                    prop_assert_eq!((i128::from(utc.as_nanos()) - i128::from(ns)) % i128::from(HOUR_NS), 0);
                }
                prop_assert!(clock.locks.len() <= MAX_LOCKS);
            }
        }
    }
}
