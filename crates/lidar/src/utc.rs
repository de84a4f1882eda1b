//! UTC for a sensor with a receiver: the hour from NMEA, everything below the hour from the
//! sensor's own clock.
//!
//! With a pulse per second and a valid fix the sensor sets its minutes and seconds from the
//! sentence and steers the rest by the pulse, so that its time past the hour is UTC's. A position
//! packet's sentence only has to tell which hour that is: how old the sentence is when it is sent
//! does not matter, as long as it is a few seconds and not half an hour. Left out: any guess where
//! the lock is missing, host time, and leap seconds, which the sensor's counter does not show.

use std::collections::VecDeque;
use std::{fmt, mem};

use protocol::vlp16::{NmeaError, PositionPacket, Pps};
use units::{Host, Lidar, Span, Stamp};

const HOUR_NS: i64 = 3_600_000_000_000;
/// A sentence tells of a second that has begun and is repeated until the next; a receiver may take
/// two for it. Older ones are left from a receiver that fell silent.
const OLDEST_FIX: Span = Span::from_secs(5);
/// Times further apart than this are two clocks that never met, not an old sentence.
const APART: Span = Span::from_secs(60);
/// Some receivers name the second that the next pulse begins.
const NEWEST_FIX: Span = Span::from_millis(-1_500);
/// Sensors send a position packet every ten milliseconds or so; without any for this long nothing
/// says that the lock holds.
const LONGEST_SILENCE: Span = Span::from_secs(5);
/// Position packets this much before the last one are out of order; further back, the clock was
/// set.
const REORDER: Span = Span::from_secs(2);
/// Data this much before the last one were overtaken by it; further back, the clock was set.
const OVERTAKEN: Span = Span::from_millis(20);
/// Locks kept; a receiver that comes and goes more often loses the oldest.
const MOST_LOCKS: usize = 4_096;

/// Coordinated universal time: nanoseconds since 1970-01-01, leap seconds not counted.
pub enum Utc {}

/// Whether the sensor's clock can be told as UTC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UtcState {
    /// Pulse and fix are good: UTC is device time plus this many hours.
    Locked {
        /// Hours between device time, which follows the host's hour, and UTC: 0 where the host's
        /// clock is right.
        hours: i64,
    },
    /// Why it cannot.
    Unlocked(NoUtc),
}

/// Why there is no UTC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoUtc {
    /// No position packet yet.
    NotYet,
    /// The pulse-per-second input is in another state than locked.
    Pulse(Pps),
    /// There is no sentence, or it is not to be trusted.
    Sentence(NmeaError),
    /// The receiver says that its fix is not valid.
    NoFix,
    /// The sentence is left from a receiver that fell silent.
    Stale {
        /// Device time since the second that it tells.
        age: Span,
    },
    /// Device time past the hour is not the sentence's: the sensor has not set its minutes and
    /// seconds.
    Apart {
        /// Device time past the hour less the sentence's, within half an hour.
        by: Span,
    },
    /// No position packet for some seconds of device time.
    Silent,
    /// Device time went backwards: the sensor set its clock.
    ClockSet,
}

/// The lock was acquired, lost, or lost for another reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UtcChange {
    /// Device time at which it was said.
    pub at: Stamp<Lidar>,
    /// What holds from there.
    pub state: UtcState,
}

/// A span of device time in which UTC is known.
#[derive(Clone, Copy, Debug)]
struct UtcLock {
    from: Stamp<Lidar>,
    /// `None` while it lasts.
    until: Option<Stamp<Lidar>>,
    offset: Span,
}

/// Follows the position packets of one sensor and turns device time into UTC.
///
/// Feed it packets in order of arrival, and device times as the decoder gives them, so that both
/// are of the same hour.
#[derive(Clone, Debug)]
pub struct UtcClock {
    state: UtcState,
    locks: VecDeque<UtcLock>,
    data: Option<Stamp<Lidar>>,
    position: Option<Stamp<Lidar>>,
    late: u64,
}

impl Default for UtcClock {
    fn default() -> Self {
        Self::new()
    }
}

impl UtcClock {
    /// A clock that knows nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            state: UtcState::Unlocked(NoUtc::NotYet),
            locks: VecDeque::new(),
            data: None,
            position: None,
            late: 0,
        }
    }

    /// Takes device time as of the last firing that was decoded; says whether that ended the lock.
    pub fn data(&mut self, at: Stamp<Lidar>) -> Option<UtcChange> {
        let back = self
            .data
            .map_or(Span::ZERO, |last| last.saturating_since(at));
        if Span::ZERO < back && back <= OVERTAKEN {
            return None;
        }
        self.data = Some(at);
        if back > Span::ZERO {
            self.position = None;
            // The device goes through these times a second time: what they were the first time
            // helps nobody.
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

    /// Takes a position packet that arrived at `host`; says what it changed.
    ///
    /// Packets that arrive after a later one change nothing: they are counted in
    /// [`UtcClock::late`].
    pub fn position(
        &mut self,
        host: Stamp<Host>,
        packet: &PositionPacket<'_>,
    ) -> Option<UtcChange> {
        let at = self.device_time(packet.timestamp_us(), host);
        if let Some(last) = self.position {
            let back = last.saturating_since(at);
            if back > Span::ZERO && back <= REORDER {
                self.late += 1;
                return None;
            }
        }
        self.position = Some(at);
        match judge(at, packet) {
            Ok(hours) => self.lock(at, hours),
            Err(why) => self.unlock(at, why),
        }
    }

    /// UTC at an instant of device time; `None` where the clock was not locked, and beyond the year
    /// 2262, which no stamp can say.
    #[must_use]
    pub fn utc(&self, at: Stamp<Lidar>) -> Option<Stamp<Utc>> {
        let lock = self.locks.iter().rev().find(|lock| {
            let before_end = lock.until.is_none_or(|until| at < until);
            lock.from <= at && before_end
        })?;
        let ns = at.as_nanos().checked_add(lock.offset.as_nanos())?;
        Some(Stamp::from_nanos(ns))
    }

    /// How often a lock ended, whether or not another followed.
    #[must_use]
    pub fn ends(&self) -> usize {
        self.locks
            .iter()
            .filter(|lock| lock.until.is_some())
            .count()
    }

    /// What holds now.
    #[must_use]
    pub const fn state(&self) -> UtcState {
        self.state
    }

    /// Position packets that arrived after a later one.
    #[must_use]
    pub const fn late(&self) -> u64 {
        self.late
    }

    /// Device time of a position packet: in the hour that lies nearest to the data, without any to
    /// the host's clock.
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
        if self.locks.len() == MOST_LOCKS {
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
        let news = match was {
            UtcState::Unlocked(was) => !was.is_like(why),
            UtcState::Locked { .. } => true,
        };
        news.then_some(UtcChange { at, state })
    }

    /// Ends the lock that lasts, if one does.
    fn end(&mut self, at: Stamp<Lidar>) {
        if let Some(lock) = self.locks.back_mut()
            && lock.until.is_none()
        {
            lock.until = Some(at.max(lock.from));
        }
    }
}

/// Hours from device time to UTC, by one packet.
fn judge(at: Stamp<Lidar>, packet: &PositionPacket<'_>) -> Result<i64, NoUtc> {
    if packet.pps() != Pps::Locked {
        return Err(NoUtc::Pulse(packet.pps()));
    }
    let rmc = packet.rmc().map_err(NoUtc::Sentence)?;
    let fix = rmc.utc.filter(|_| rmc.valid).ok_or(NoUtc::NoFix)?;
    let apart_ns = fix.unix_nanos().saturating_sub(at.as_nanos());
    let hours = whole_hours(apart_ns);
    let age = Span::from_nanos(hours.saturating_mul(HOUR_NS).saturating_sub(apart_ns));
    if age < NEWEST_FIX || age > APART {
        Err(NoUtc::Apart { by: age })
    } else if age > OLDEST_FIX {
        Err(NoUtc::Stale { age })
    } else {
        Ok(hours)
    }
}

/// To the nearest.
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
    /// Ages and distances change with every packet: once said is enough.
    fn is_like(self, other: Self) -> bool {
        match (self, other) {
            (Self::Pulse(a), Self::Pulse(b)) => a == b,
            _ => mem::discriminant(&self) == mem::discriminant(&other),
        }
    }
}

impl fmt::Display for NoUtc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotYet => write!(f, "no position packet yet"),
            Self::Pulse(Pps::Absent) => write!(f, "no pulse per second"),
            Self::Pulse(Pps::Synchronising) => write!(f, "synchronising to the pulse per second"),
            Self::Pulse(Pps::Error) => write!(f, "the pulse per second is in error"),
            Self::Pulse(Pps::Locked) => write!(f, "the pulse per second is locked"),
            Self::Pulse(Pps::Unknown(byte)) => {
                write!(f, "pulse-per-second state {byte} is not known")
            }
            Self::Sentence(error) => write!(f, "{error}"),
            Self::NoFix => write!(f, "the receiver has no valid fix"),
            Self::Stale { age } => write!(f, "the sentence is {:.1} s old", age.as_secs_f64()),
            Self::Apart { by } => write!(
                f,
                "device time is {:.1} s off the sentence's minutes and seconds",
                by.as_secs_f64()
            ),
            Self::Silent => write!(f, "position packets stopped"),
            Self::ClockSet => write!(f, "the device set its clock back"),
        }
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

    /// Gives the clock a packet sent at a device time, to a host whose clock is `off_s` ahead of
    /// UTC.
    fn say(
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
    fn the_hour_comes_from_the_fix_and_the_rest_from_the_device() {
        // The host's clock is five hours and seven seconds slow; the sensor counts from its hour.
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
        // Not before it was said, and exactly from then on.
        assert_eq!(clock.utc(stamp(at - 1)), None);
        for after in [0, 1, 500_000_000, 1_700 * S] {
            let utc = clock.utc(stamp(at + after)).map(Stamp::as_nanos);
            assert_eq!(utc, Some(TEN_59 * S + 400_000_000 + after));
        }
    }

    #[test]
    fn the_hour_turns_whichever_side_turns_first() {
        // Late sentences, and one of the second to come, on both sides of 11:00:00 and of midnight.
        for begin_s in [TEN_59, TEN_59 + 13 * 3_600] {
            for fix_late_s in [-1, 0, 1, 2, 4] {
                let mut clock = UtcClock::new();
                for tick in 0..1_200i64 {
                    let device = begin_s * S + tick * 100_000_000 + 37_000;
                    clock.data(stamp(device));
                    let fix_s = device.div_euclid(S) - fix_late_s;
                    let change = say(&mut clock, device, 2, 'A', fix_s);
                    assert_eq!(change.is_some(), tick == 0, "{change:?}");
                    assert_eq!(clock.utc(stamp(device)), Some(stamp(device)));
                }
            }
        }
    }

    #[test]
    fn out_of_order_packets_change_nothing() {
        let mut clock = UtcClock::new();
        let t = TEN_59 * S;
        clock.data(stamp(t));
        say(&mut clock, t, 2, 'A', TEN_59);
        assert!(say(&mut clock, t + 30_000_000, 0, 'A', TEN_59).is_some());
        // Sent before the pulse was lost, arrived after.
        assert_eq!(say(&mut clock, t + 20_000_000, 2, 'A', TEN_59), None);
        assert_eq!(clock.late(), 1);
        assert_eq!(clock.state(), UtcState::Unlocked(NoUtc::Pulse(Pps::Absent)));
        assert!(clock.utc(stamp(t + 29_999_999)).is_some());
        assert_eq!(clock.utc(stamp(t + 30_000_000)), None);
    }

    #[test]
    fn each_way_to_be_without_a_lock_is_said_once() {
        let t = TEN_59 * S;
        let mut clock = UtcClock::new();
        assert_eq!(clock.state().to_string(), "no lock: no position packet yet");
        clock.data(stamp(t));
        let mut expect = |ms: i64, pps, status, fix_s, said: &str| {
            let at = t + ms * 1_000_000;
            let change = say(&mut clock, at, pps, status, fix_s).expect(said);
            assert_eq!(change.state.to_string(), said);
            assert_eq!(say(&mut clock, at + 10_000_000, pps, status, fix_s), None);
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
        // Where it was not locked it stays without, later locks or not.
        assert_eq!(clock.utc(stamp(t + 750_000_000)), None);
        assert_eq!(
            clock.utc(stamp(t + 650_000_000)),
            Some(stamp(t + 650_000_000))
        );
    }

    #[test]
    fn a_lock_that_nobody_confirms_ends() {
        let t = TEN_59 * S;
        let mut clock = UtcClock::new();
        clock.data(stamp(t));
        say(&mut clock, t, 2, 'A', TEN_59);
        assert_eq!(clock.data(stamp(t + 5 * S)), None);
        let change = clock.data(stamp(t + 5 * S + 1)).unwrap();
        assert_eq!(change.state, UtcState::Unlocked(NoUtc::Silent));
        assert_eq!(clock.data(stamp(t + 6 * S)), None);
        assert_eq!(clock.utc(stamp(t + 6 * S)), None);
        assert!(say(&mut clock, t + 7 * S, 2, 'A', TEN_59 + 7).is_some());
        assert_eq!(clock.utc(stamp(t + 7 * S)), Some(stamp(t + 7 * S)));
    }

    #[test]
    fn a_clock_set_by_the_first_sentence_is_utc_from_then_on() {
        // Free-running minutes, 700 s ahead, until the device reads the sentence and sets its clock
        // back.
        let t = TEN_59 * S;
        let mut clock = UtcClock::new();
        clock.data(stamp(t + 700 * S));
        let change = say(&mut clock, t + 700 * S, 2, 'A', TEN_59).unwrap();
        assert!(matches!(
            change.state,
            UtcState::Unlocked(NoUtc::Apart { .. })
        ));
        let set = clock.data(stamp(t + S)).unwrap();
        assert_eq!(
            (set.at, set.state),
            (stamp(t + S), UtcState::Unlocked(NoUtc::ClockSet))
        );
        assert!(say(&mut clock, t + S, 2, 'A', TEN_59 + 1).is_some());
        assert_eq!(clock.utc(stamp(t + S)), Some(stamp(t + S)));
        // A lock from before a step back does not speak for times that came twice.
        let back = t + S - 500_000_000;
        clock.data(stamp(t + 2 * S));
        clock.data(stamp(back));
        assert_eq!(clock.utc(stamp(t + S + 1)), None);
    }

    #[test]
    fn beyond_the_last_stamp_there_is_no_utc() {
        let mut clock = UtcClock::new();
        let last = 7_514_095_636_854_775_808_i64;
        for (us, ns, pps, second) in [(0_u32, 0, 0, 0), (1_219_500_000, last, 2, 77_621)] {
            let mut bytes = packet(0, pps, 'A', 1_709_200_000 + second);
            bytes[198..202].copy_from_slice(&us.to_le_bytes());
            clock.position(stamp(ns / 2), &PositionPacket::new(&bytes).unwrap());
        }
        // A nanosecond more than a stamp can say.
        assert_eq!(clock.utc(stamp(last)), None);
        let before = stamp(last - 1);
        let apart = clock.utc(before).unwrap().as_nanos() - before.as_nanos();
        assert_eq!(apart % HOUR_NS, 0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Whatever comes, an answer is a whole number of hours from device time.
        #[test]
        fn nothing_upsets_it(
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
                prop_assert!(clock.locks.len() <= MOST_LOCKS);
            }
        }
    }
}
