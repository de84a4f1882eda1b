//! The lidar's clock: the wrap at the hour, and UTC.

use super::*;

/// The stamp counts microseconds of the hour and drops to nearly zero. Adding an hour whenever it
/// decreases passes this case and fails the next ones.
#[test]
fn the_hour_wraps_between_two_packets() {
    // Ten packets end exactly on the hour.
    let head = steady(600.0, BEGIN_NS - 120 * BLOCK_NS);
    let (packets, truth) = head.packets(20);
    let (seen, stats) = decode(&packets);
    assert_matches_rotor(&head, &seen, &truth, 0);
    assert_no_errors(&stats);
}

/// The packet's stamp belongs to the old hour, most of its firings to the new one. Their times
/// exceed an hour and must not wrap one by one.
#[test]
fn the_hour_wraps_inside_a_packet() {
    for blocks_before in 1..12 {
        let head = steady(600.0, BEGIN_NS - (60 + blocks_before) * BLOCK_NS - 300);
        let (packets, truth) = head.packets(12);
        let (seen, stats) = decode(&packets);
        assert_matches_rotor(&head, &seen, &truth, 0);
        assert_no_errors(&stats);
    }
}

/// The packet around the gap has a stamp before the hour; its last blocks and the next packet
/// follow the hour. The length of the gap is the difference of the stamps, which is negative.
#[test]
fn the_hour_wraps_in_the_gap_of_a_limited_field_of_view() {
    let view = |azimuth: f64| !(41.0..320.0).contains(&azimuth);
    // 5 Hz from 320 deg: the first gap is 45 to 200 ms later.
    for before_ms in [46, 60, 100, 199] {
        let head = Head {
            angle_deg: |s: f64| 320.0 + 1_800.0 * s,
            sees: view,
            begin_ns: BEGIN_NS - before_ms * 1_000_000,
            dual: false,
        };
        let (packets, truth) = head.packets(100);
        let (seen, stats) = decode(&packets);
        let known = seen.len() - 24;
        assert_matches_rotor(&head, &seen[..known], &truth[..known], 15_000);
        assert_no_errors(&stats);
    }
}

/// The packets around the hour are missing. Only the difference of two stamps, half a packet or
/// many packets apart, shows the wrap; it counts as loss, not as a step of the clock.
#[test]
fn the_hour_wraps_while_packets_are_lost() {
    for lost in [1, 2, 7, 40, 700] {
        let head = steady(600.0, BEGIN_NS - 127 * BLOCK_NS);
        let (mut packets, mut truth) = head.packets(720);
        packets.drain(8..8 + lost);
        truth.drain(8 * 24..(8 + lost) * 24);
        let (seen, stats) = decode(&packets);
        assert_matches_rotor(&head, &seen, &truth, 0);
        assert_eq!((stats.lost_packets, stats.clock_steps), (lost as u64, 0));
    }
}

/// Real devices count past the hour before they wrap: 3600.06 s, then 0.061 s.
#[test]
fn the_counter_runs_past_the_hour_before_it_wraps() {
    let head = steady(600.0, BEGIN_NS - 120 * BLOCK_NS);
    let (mut packets, truth) = head.packets(80);
    for (packet, first) in packets.iter_mut().zip(truth.iter().step_by(24)) {
        if (BEGIN_NS..BEGIN_NS + 60_000_000).contains(first) {
            let us = HOUR_US + ((first - BEGIN_NS) / 1_000) as u32;
            packet.bytes[1_200..1_204].copy_from_slice(&us.to_le_bytes());
        }
    }
    let (seen, stats) = decode(&packets);
    assert_matches_rotor(&head, &seen, &truth, 0);
    assert_no_errors(&stats);
}

/// The host starts within a second of the hour with a clock that is minutes off, on the other side
/// of it.
#[test]
fn the_first_packet_is_next_to_the_hour() {
    for (device_ms, host_off_s) in [(-3, 20), (-3, -20), (3, -1_700), (3, 1_700), (-3, 1_700)] {
        let head = steady(600.0, BEGIN_NS + device_ms * 1_000_000);
        let (mut packets, truth) = head.packets(20);
        for packet in &mut packets {
            packet.host += Span::from_secs(host_off_s);
        }
        let (seen, stats) = decode(&packets);
        assert_matches_rotor(&head, &seen, &truth, 0);
        assert_no_errors(&stats);
    }
}

/// A host clock in 2100: over 32 bits of seconds, and half a microsecond per ulp in f64 seconds.
#[test]
fn the_year_2100_is_exact() {
    // 2100-01-01 00:00:00 UTC.
    let midnight_ns = 4_102_444_800 * 1_000_000_000;
    let head = steady(600.0, midnight_ns - 60 * BLOCK_NS);
    let (packets, truth) = head.packets(20);
    let (seen, stats) = decode(&packets);
    assert_matches_rotor(&head, &seen, &truth, 0);
    assert_no_errors(&stats);
    let first = seen[0].ns;
    assert!(
        seen.iter()
            .take(24)
            .enumerate()
            .all(|(i, seen)| seen.ns - first == i as i64 * SEQUENCE_PERIOD_NS)
    );
}

/// The first NMEA sentence sets minutes and seconds of a free-running clock: device time jumps
/// while the rotor does not. Nothing is lost, and the firings on both sides keep their times.
#[test]
fn nmea_sets_the_device_clock() {
    for step_s in [-1_500, -61, -1, 3, 59, 1_500] {
        let head = steady(600.0, BEGIN_NS + 30 * 60 * 1_000_000_000);
        let (mut packets, mut truth) = head.packets(40);
        for (packet, times) in packets.iter_mut().zip(truth.chunks_mut(24)).skip(20) {
            times.iter_mut().for_each(|t| *t += step_s * 1_000_000_000);
            let us = (times[0] / 1_000).rem_euclid(i64::from(HOUR_US)) as u32;
            packet.bytes[1_200..1_204].copy_from_slice(&us.to_le_bytes());
        }
        let (seen, stats) = decode(&packets);
        assert_eq!(seen.len(), truth.len());
        for (i, (seen, truth)) in seen.iter().zip(&truth).enumerate() {
            assert!(
                (seen.ns - truth).abs() <= WIRE_NS,
                "{step_s} s, firing {i}: {seen:?}"
            );
            let rotor = truth
                - if i < 20 * 24 {
                    0
                } else {
                    step_s * 1_000_000_000
                };
            let off = apart_deg(seen.azimuth_deg, head.azimuth_deg(rotor));
            assert!(off <= 2.0 * WIRE_DEG, "{step_s} s, firing {i}: {off} deg");
        }
        assert_eq!(
            (stats.clock_steps, stats.lost_packets, stats.late),
            (1, 0, 0),
            "{step_s} s"
        );
    }
}

/// NTP sets the host's clock during a scan, by seconds or by more than an hour; the sensor's clock
/// stays.
#[test]
fn a_step_of_the_host_clock_is_found() {
    for step_s in [-7_200, -40, 2, 1_800, 90_000] {
        let head = steady(600.0, BEGIN_NS - 60 * BLOCK_NS);
        let (mut packets, truth) = head.packets(40);
        for packet in packets.iter_mut().skip(17) {
            packet.host += Span::from_secs(step_s);
        }
        let (seen, stats) = decode(&packets);
        assert_matches_rotor(&head, &seen, &truth, 0);
        assert_no_errors(&stats);
    }
}

/// A `$GPRMC` sentence of a whole second of 2024-02-29.
fn rmc(second_of_day: i64) -> Vec<u8> {
    let (h, m, s) = (
        second_of_day / 3_600,
        second_of_day / 60 % 60,
        second_of_day % 60,
    );
    let body = format!("GPRMC,{h:02}{m:02}{s:02}.00,A,5004.9,N,01425.2,E,0.0,0.0,290224,,,A");
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n").into_bytes()
}

/// The receiver's sentence is one second late. Around the hour it names the old hour while the
/// sensor counts the new one, and the host's clock is days off. UTC must not jump by an hour.
#[test]
fn utc_is_correct_across_the_hour_with_a_late_sentence() {
    // 2024-02-29 00:00:00 UTC, a leap day (`date -u -d`).
    let midnight_ns = 1_709_164_800 * 1_000_000_000;
    let hour = 14;
    let begin_ns = midnight_ns + hour * HOUR_NS - 2_000_000_000;
    let head = steady(600.0, begin_ns);
    let (packets, truth) = head.packets(3_000);
    let host_off = Span::from_secs(-100 * 3_600);
    let mut clock = UtcClock::new();
    let mut decoder = Decoder::new(Options::default());
    let (mut utc, mut changes) = (Vec::new(), Vec::new());
    for (i, packet) in packets.iter().enumerate() {
        let host = packet.host + host_off;
        let mut last = None;
        decoder.packet(host, &packet.bytes, &mut |firing| {
            utc.push(clock.utc(firing.start).map(Stamp::as_nanos));
            last = Some(firing.start);
        });
        changes.extend(last.and_then(|at| clock.data(at)));
        if i % 8 == 3 {
            let now = truth[24 * i] + 800_000;
            let us = (now / 1_000).rem_euclid(i64::from(HOUR_US)) as u32;
            let second = (now - midnight_ns) / 1_000_000_000 - 1;
            let bytes = position_packet(us, Pps::Locked, &rmc(second));
            let position = PositionPacket::new(&bytes).unwrap();
            changes.extend(clock.position(host, &position));
        }
    }
    let states: Vec<UtcState> = changes.iter().map(|change| change.state).collect();
    assert_eq!(states, [UtcState::Locked { hours: 100 }]);
    for (utc, truth) in utc.iter().zip(&truth).skip(5 * 24) {
        let off = utc.unwrap() - truth;
        assert!(off.abs() <= WIRE_NS, "{off}");
    }
    assert_eq!(utc[0], None);
}
