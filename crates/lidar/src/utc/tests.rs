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
    let body = format!("GPRMC,{hour:02}{minute:02}{second:02}.00,{status},0,N,0,W,0,0,{date},,");
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
    for (hours, text) in [
        (6_190, "257 days after that of the recording"),
        (-48, "2 days before that of the recording"),
    ] {
        let apart = UtcState::Locked { hours }.to_string();
        assert!(apart.contains(text), "{apart}");
    }
    // UTC is known exactly from the packet on.
    assert_eq!(clock.utc(stamp(at - 1)), None);
    for after in [0, 1, 500_000_000, 1_700 * S] {
        let utc = clock.utc(stamp(at + after)).map(Stamp::as_nanos);
        assert_eq!(utc, Some(TEN_59 * S + 400_000_000 + after));
    }
}

#[test]
fn the_hour_may_wrap_first_in_either_clock() {
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
    let mut expect = |ms: i64, pps, status, fix_s, expected: &str| {
        let at = t + ms * 1_000_000;
        let change = send(&mut clock, at, pps, status, fix_s).expect(expected);
        assert_eq!(change.state.to_string(), expected);
        assert_eq!(send(&mut clock, at + 10_000_000, pps, status, fix_s), None);
        assert_eq!(
            clock.utc(stamp(at)).is_some(),
            expected == "locked",
            "{expected}"
        );
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
fn the_lock_ends_without_position_packets() {
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
fn a_clock_set_by_the_first_sentence_gives_utc() {
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
