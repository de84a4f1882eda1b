//! The lidar's clock, rotor and link.

mod hours;
mod order;

use ::lidar::{
    Decoder, Duplicates, Firing, Options, ReturnKind, Stats, Timekeeper, UtcClock, UtcState,
};
use firmware_sim::vlp16::{
    DataPacketBuilder, HOUR_US, LASERS, PacketModel, Pps, ReturnMode, SEQUENCE_PERIOD_NS,
    position_packet,
};
use protocol::vlp16::PositionPacket;
use units::{Host, Span, Stamp};

const HOUR_NS: i64 = HOUR_US as i64 * 1_000;
/// A block holds two firing sequences and one azimuth.
const BLOCK_NS: i64 = 2 * SEQUENCE_PERIOD_NS;
/// An hour of 2023.
const BEGIN_NS: i64 = 470_000 * HOUR_NS;
/// Azimuths are hundredths of a degree on the wire.
const WIRE_DEG: f64 = 0.005;
/// Stamps are whole microseconds.
const WIRE_NS: i64 = 1_000;

/// A head whose angle is a function of time, with the azimuths at which it fires.
struct Head<A, S> {
    /// Angle in degrees as a function of seconds, not wrapped at 360.
    angle_deg: A,
    /// Whether it fires at an azimuth.
    sees: S,
    /// Device time of the first block.
    begin_ns: i64,
    dual: bool,
}

/// A UDP payload and its arrival time.
#[derive(Clone)]
struct Packet {
    host: Stamp<Host>,
    bytes: Vec<u8>,
}

/// The decoder's output for one firing.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    ns: i64,
    azimuth_deg: f64,
    laser_15_deg: f64,
    range_m: f64,
}

/// A head at constant speed that fires at all azimuths.
fn steady(rpm: f64, begin_ns: i64) -> Head<impl Fn(f64) -> f64, impl Fn(f64) -> bool> {
    Head {
        angle_deg: move |s: f64| 6.0 * rpm * s,
        sees: |_: f64| true,
        begin_ns,
        dual: false,
    }
}

impl<A: Fn(f64) -> f64, S: Fn(f64) -> bool> Head<A, S> {
    fn azimuth_deg(&self, ns: i64) -> f64 {
        (self.angle_deg)((ns - self.begin_ns) as f64 * 1e-9).rem_euclid(360.0)
    }

    /// The first packets, and device times of all their sequences.
    fn packets(&self, count: usize) -> (Vec<Packet>, Vec<i64>) {
        let blocks = if self.dual { 6 } else { 12 };
        let ticks = (0..).map(|k| self.begin_ns + k * BLOCK_NS);
        let fired = ticks.filter(|&t| (self.sees)(self.azimuth_deg(t)));
        let times: Vec<i64> = fired.take(blocks * count).collect();
        let packets = times.chunks(blocks).map(|times| self.packet(times));
        let sequences = times.iter().flat_map(|&t| [t, t + SEQUENCE_PERIOD_NS]);
        (packets.collect(), sequences.collect())
    }

    fn packet(&self, times: &[i64]) -> Packet {
        let us = (times[0] / 1_000).rem_euclid(i64::from(HOUR_US)) as u32;
        let cdeg = |t| (self.azimuth_deg(t) * 100.0).round() as u16 % 36_000;
        let mode = if self.dual {
            ReturnMode::Dual
        } else {
            ReturnMode::Strongest
        };
        let mut builder = DataPacketBuilder::new(PacketModel::Vlp16, mode);
        for &t in times {
            for t in [t, t + SEQUENCE_PERIOD_NS] {
                let returns = [(range_raw(t - self.begin_ns), 9); LASERS];
                builder.firing(cdeg(t), &returns, &returns);
            }
        }
        let bytes = builder.finish(us);
        let last = times.last().unwrap();
        Packet {
            // Filled, sent, received.
            host: Stamp::from_nanos(last + BLOCK_NS + 150_000),
            bytes: bytes.to_vec(),
        }
    }
}

/// A distance that is unique within half a second.
fn range_raw(since_ns: i64) -> u16 {
    (1_000 + since_ns / SEQUENCE_PERIOD_NS % 9_000) as u16
}

fn decode<'a>(packets: impl IntoIterator<Item = &'a Packet>) -> (Vec<Seen>, Stats) {
    let mut seen = Vec::new();
    let mut keep = |firing: &Firing<'_>| {
        seen.push(Seen {
            ns: firing.start.as_nanos(),
            azimuth_deg: firing.azimuth_deg,
            laser_15_deg: firing.laser_azimuth_deg(15).unwrap(),
            range_m: firing.points().next().unwrap().range_m,
        });
    };
    let mut decoder = Decoder::new(Options::default());
    for packet in packets {
        decoder.packet(packet.host, &packet.bytes, &mut keep);
    }
    decoder.finish(&mut keep);
    (seen, decoder.stats().clone())
}

fn apart_deg(a: f64, b: f64) -> f64 {
    let apart = (a - b).rem_euclid(360.0);
    apart.min(360.0 - apart)
}

/// Checks time, azimuth and range of every firing against the head.
fn assert_matches_rotor<A: Fn(f64) -> f64, S: Fn(f64) -> bool>(
    head: &Head<A, S>,
    seen: &[Seen],
    truth: &[i64],
    slack_ns: i64,
) {
    assert_eq!(seen.len(), truth.len());
    assert!(seen.is_sorted_by(|a, b| a.ns < b.ns));
    let per_packet = if head.dual { 12 } else { 24 };
    for (i, (seen, &truth)) in seen.iter().zip(truth).enumerate() {
        assert!(
            (seen.ns - truth).abs() <= WIRE_NS + slack_ns,
            "firing {i}: {seen:?}, {truth}"
        );
        let raw = (seen.range_m / 0.002).round() as u16;
        assert_eq!(raw, range_raw(truth - head.begin_ns), "firing {i}");
        // Between two azimuths of the wire only their rounding counts. Behind the last block of a
        // packet without successor, or before a gap, the last step is extrapolated, with at most a
        // hundredth of error, for up to 0.82 of a block.
        let carried_on = i % per_packet >= per_packet - 2 || slack_ns > 0;
        let tolerance_deg = if carried_on {
            2.7 * WIRE_DEG
        } else {
            1.02 * WIRE_DEG
        };
        let off = apart_deg(seen.azimuth_deg, head.azimuth_deg(truth));
        assert!(off <= tolerance_deg, "firing {i}: {off} deg");
        let off = apart_deg(seen.laser_15_deg, head.azimuth_deg(truth + 15 * 2_304));
        assert!(off <= tolerance_deg, "firing {i}, laser 15: {off} deg");
    }
}

fn assert_no_errors(stats: &Stats) {
    let odd = [
        stats.malformed,
        stats.other,
        stats.unidentified,
        stats.duplicates,
        stats.reordered,
        stats.late,
        stats.clock_steps,
        stats.lost_packets,
    ];
    assert_eq!(odd, [0; 8], "{stats:?}");
}

/// 36000 is invalid by the manual, and sensors send it; it means 0, not 360.
#[test]
fn azimuth_36000_equals_0() {
    // 0.36 deg per block: every thousandth azimuth is exactly 0.
    let head = steady(0.36 / 6.0 / (BLOCK_NS as f64 * 1e-9), BEGIN_NS);
    let (mut packets, truth) = head.packets(170);
    let mut replaced = 0;
    for packet in &mut packets {
        for block in packet.bytes.chunks_exact_mut(100) {
            if block[2..4] == [0, 0] {
                block[2..4].copy_from_slice(&36_000u16.to_le_bytes());
                replaced += 1;
            }
        }
    }
    assert!(replaced >= 2);
    let (seen, stats) = decode(&packets);
    assert_matches_rotor(&head, &seen, &truth, 0);
    assert!(
        seen.iter()
            .all(|seen| (0.0..360.0).contains(&seen.azimuth_deg))
    );
    assert_no_errors(&stats);
}

/// The step from 359.9 to 0.1 deg is 0.2 deg, anywhere in a packet or between two.
#[test]
fn azimuths_may_wrap_anywhere_in_a_packet() {
    for blocks_before in 0..14 {
        let angle_deg = move |s: f64| {
            359.9 - 0.4 * f64::from(blocks_before) + 0.4 * s / (BLOCK_NS as f64 * 1e-9)
        };
        let head = Head {
            angle_deg,
            sees: |_: f64| true,
            begin_ns: BEGIN_NS,
            dual: blocks_before % 2 == 0,
        };
        let (packets, truth) = head.packets(4);
        let (seen, stats) = decode(&packets);
        assert_matches_rotor(&head, &seen, &truth, 0);
        let rpm = stats.rpm.unwrap();
        assert!(
            (rpm - 0.4 / 6.0 / (BLOCK_NS as f64 * 1e-9)).abs() < 1.0,
            "{rpm}"
        );
        assert_no_errors(&stats);
    }
}

/// A limited field of view: a packet continues after the gap, 155 ms later than its position
/// implies. Interpolation over the jump would put azimuths into the unseen part of the revolution.
#[test]
fn blocks_after_the_gap_of_a_limited_field_of_view_are_timed_later() {
    for (dual, rpm) in [(false, 300.0), (true, 300.0), (false, 1_200.0)] {
        let head = Head {
            angle_deg: |s: f64| 320.0 + 6.0 * rpm * s,
            sees: |azimuth: f64| !(41.0..320.0).contains(&azimuth),
            begin_ns: BEGIN_NS,
            dual,
        };
        let (packets, truth) = head.packets(200);
        let (seen, stats) = decode(&packets);
        // The last packet may straddle a gap that no successor measures.
        let known = seen.len() - 24;
        assert_matches_rotor(&head, &seen[..known], &truth[..known], 15_000);
        assert!(
            seen.iter()
                .all(|seen| !(41.5..319.9).contains(&seen.azimuth_deg))
        );
        assert_no_errors(&stats);
    }
}

/// One laser sees two surfaces, one only a last return, one only a strongest, one both at one
/// distance, one none.
#[test]
fn dual_returns_may_be_missing_on_either_side() {
    let mut last = [(0_u16, 0_u8); LASERS];
    let mut strongest = last;
    (last[0], strongest[0]) = ((5_000, 10), (4_000, 90));
    last[1] = (5_001, 11);
    strongest[2] = (4_002, 92);
    (last[3], strongest[3]) = ((5_003, 93), (5_003, 93));
    let mut builder = DataPacketBuilder::new(PacketModel::Vlp16, ReturnMode::Dual);
    let packets: Vec<Packet> = (0..3u32)
        .map(|k| {
            for sequence in 0..12 {
                builder.firing(1_000 + (12 * k as u16 + sequence) * 20, &last, &strongest);
            }
            let us = (i64::from(k) * 12 * SEQUENCE_PERIOD_NS / 1_000) as u32;
            let host = Stamp::from_nanos(BEGIN_NS + i64::from(us) * 1_000 + 900_000);
            Packet {
                host,
                bytes: builder.finish(us).to_vec(),
            }
        })
        .collect();
    for (duplicates, laser_3) in [(Duplicates::Unique, 1), (Duplicates::All, 2)] {
        let mut decoder = Decoder::new(Options {
            duplicates,
            ..Options::default()
        });
        let mut expected = vec![
            (0, 10.0, 10, ReturnKind::Last),
            (0, 8.0, 90, ReturnKind::StrongestOrSecond),
            (1, 10.002, 11, ReturnKind::Last),
            (2, 8.004, 92, ReturnKind::StrongestOrSecond),
        ];
        expected.extend(
            [(3, 10.006, 93, ReturnKind::LastAndStrongest); 2]
                .into_iter()
                .take(laser_3),
        );
        let mut firings = 0;
        let mut check = |firing: &Firing<'_>| {
            let got: Vec<_> = firing
                .points()
                .map(|p| (p.laser, p.range_m, p.reflectivity, p.echo))
                .collect();
            assert_eq!(got.len(), expected.len());
            for (got, expected) in got.iter().zip(&expected) {
                assert_eq!((got.0, got.2, got.3), (expected.0, expected.2, expected.3));
                assert!((got.1 - expected.1).abs() < 1e-9);
            }
            let pair: Vec<_> = firing.points().take(2).map(|p| p.time).collect();
            assert_eq!(pair[0], pair[1], "one pulse, one time");
            firings += 1;
        };
        for packet in &packets {
            decoder.packet(packet.host, &packet.bytes, &mut check);
        }
        decoder.finish(&mut check);
        let stats = decoder.stats();
        assert_eq!(
            (firings, stats.returns, stats.unique_returns),
            (36, 36 * 6, 36 * 5)
        );
        assert_no_errors(stats);
    }
}

/// Firmware before 3.0.29 has no factory bytes, and the values there are the HDL-32E's. Its timing
/// would make azimuths between blocks and all elevations wrong. Block spacing identifies the model,
/// even with lost packets at the start.
#[test]
fn a_vlp16_of_2014_that_claims_to_be_an_hdl32e_is_identified() {
    for lost in [0, 1, 2] {
        let head = steady(1_200.0, BEGIN_NS);
        let (mut packets, mut truth) = head.packets(20);
        for packet in &mut packets {
            packet.bytes[1_205] = 0x21;
        }
        packets.drain(1..1 + lost);
        truth.drain(24..24 * (1 + lost));
        let (seen, stats) = decode(&packets);
        assert_matches_rotor(&head, &seen, &truth, 0);
        assert_eq!(
            (stats.model.unwrap().name, stats.conflicts.len()),
            ("VLP-16", 1)
        );
        assert_eq!((stats.lost_packets, stats.unidentified), (lost as u64, 0));
    }
}

/// During spin-up a mean rate, or that of the last packet, moves azimuths by more than a step of
/// the wire.
#[test]
fn azimuths_follow_a_rotor_that_changes_its_speed() {
    for spin_up in [-600.0, -100.0, 100.0, 600.0] {
        let head = Head {
            angle_deg: move |s: f64| 6.0 * (700.0 * s + spin_up * s * s / 2.0),
            sees: |_: f64| true,
            begin_ns: BEGIN_NS,
            dual: false,
        };
        let (packets, truth) = head.packets(700);
        let (seen, stats) = decode(&packets);
        assert_matches_rotor(&head, &seen, &truth, 0);
        assert_no_errors(&stats);
    }
}

/// A packet's last block has no successor in it. Its second sequence is half a step on, and the
/// next packet's azimuth gives that step. Here the rotor halves its speed within a packet, so that
/// the packet's mean is wrong.
#[test]
fn the_last_block_uses_the_rotation_rate_of_the_next_packet() {
    let knee_s = 23.0 * SEQUENCE_PERIOD_NS as f64 * 1e-9 - 55.296e-6;
    let head = Head {
        angle_deg: move |s: f64| 7_200.0 * s.min(knee_s) + 3_600.0 * (s - knee_s).max(0.0),
        sees: |_: f64| true,
        begin_ns: BEGIN_NS,
        dual: false,
    };
    let (packets, truth) = head.packets(3);
    let (seen, stats) = decode(&packets);
    assert_matches_rotor(&head, &seen, &truth, 0);
    assert_no_errors(&stats);
    // Without successor it continues at the rate of the block before.
    let (alone, _) = decode(&packets[1..2]);
    let step_deg = apart_deg(alone[23].azimuth_deg, alone[22].azimuth_deg);
    assert!(
        (step_deg - 3_600.0 * 55.296e-6).abs() <= WIRE_DEG,
        "{step_deg}"
    );
}
