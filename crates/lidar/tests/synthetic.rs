//! Packets of a simulated rotor decode to its azimuth, time, hour, gaps, loss and order.
//!
//! The packets are encoded here by manual 9.3.2, without the code under test.
#![expect(clippy::unwrap_used, reason = "a test")]

use lidar::{Decoder, Duplicates, Firing, Options, ReturnKind, Stats, Timekeeper};
use proptest::prelude::*;
use units::{Host, Span, Stamp};

const BLOCK_NS: i64 = 110_592;
const FIRING_NS: i64 = 55_296;
const HOUR_NS: i64 = 3_600_000_000_000;

/// A VLP-16: angle as a function of device time, and field of view.
#[derive(Clone, Copy, Debug)]
struct Sensor {
    rpm: f64,
    /// Change of speed in rpm per second.
    spin_up: f64,
    start_deg: f64,
    /// Field of view: first azimuth and width in degrees.
    view: (f64, f64),
    dual: bool,
    /// Device time of the first block.
    begin_ns: i64,
}

impl Default for Sensor {
    fn default() -> Self {
        Self {
            rpm: 600.0,
            spin_up: 0.0,
            start_deg: 0.0,
            view: (0.0, 360.0),
            dual: false,
            begin_ns: 470_000 * HOUR_NS + 1_000_000_000_000,
        }
    }
}

#[derive(Clone, Debug)]
struct Packet {
    host: Stamp<Host>,
    bytes: Vec<u8>,
}

impl Sensor {
    fn azimuth_deg(&self, ns: i64) -> f64 {
        let s = (ns - self.begin_ns) as f64 * 1e-9;
        let turned = 6.0 * (self.rpm * s + self.spin_up * s * s / 2.0);
        (self.start_deg + turned).rem_euclid(360.0)
    }

    fn is_in_view(&self, ns: i64) -> bool {
        (self.azimuth_deg(ns) - self.view.0).rem_euclid(360.0) < self.view.1
    }

    /// The first `count` packets and the true time of each block (or pair).
    fn packets(&self, count: usize) -> (Vec<Packet>, Vec<i64>) {
        let per_packet = if self.dual { 6 } else { 12 };
        let ticks = (0..).map(|k| self.begin_ns + k * BLOCK_NS);
        let times: Vec<i64> = ticks
            .filter(|&t| self.is_in_view(t))
            .take(per_packet * count)
            .collect();
        let packets = times.chunks(per_packet).map(|t| self.packet(t)).collect();
        (packets, times)
    }

    fn packet(&self, times: &[i64]) -> Packet {
        let mut bytes = Vec::new();
        for &t in times {
            let azimuth = (self.azimuth_deg(t) * 100.0).round() as u16; // 36000 included
            for half in 0..=u16::from(self.dual) {
                bytes.extend([0xFF, 0xEE]);
                bytes.extend(azimuth.to_le_bytes());
                for channel in 0..32u16 {
                    // Channel 0 differs between the two returns, channel 1 is missing in the first.
                    let distance = match (channel, half) {
                        (0, 1) => 4_000,
                        (1, 0) if self.dual => 0,
                        _ => 5_000 + channel,
                    };
                    bytes.extend(distance.to_le_bytes());
                    bytes.push(channel as u8);
                }
            }
        }
        let us = (times[0] / 1_000).rem_euclid(3_600_000_000) as u32;
        bytes.extend(us.to_le_bytes());
        bytes.extend([if self.dual { 0x39 } else { 0x37 }, 0x22]);
        let last = times.last().unwrap();
        Packet {
            host: Stamp::from_nanos(last + BLOCK_NS + 200_000),
            bytes,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct SeenFiring {
    ns: i64,
    azimuth_deg: f64,
    laser_15_deg: f64,
    points: usize,
}

fn decode<'a>(packets: impl IntoIterator<Item = &'a Packet>) -> (Vec<SeenFiring>, Stats) {
    let mut seen = Vec::new();
    let mut keep = |firing: &Firing<'_>| {
        seen.push(SeenFiring {
            ns: firing.start.as_nanos(),
            azimuth_deg: firing.azimuth_deg,
            laser_15_deg: firing.laser_azimuth_deg(15).unwrap(),
            points: firing.points().count(),
        });
    };
    let mut decoder = Decoder::new(Options::default());
    for packet in packets {
        decoder.packet(packet.host, &packet.bytes, &mut keep);
    }
    decoder.finish(&mut keep);
    (seen, decoder.stats().clone())
}

fn difference_deg(a: f64, b: f64) -> f64 {
    let apart = (a - b).rem_euclid(360.0);
    apart.min(360.0 - apart)
}

/// Asserts azimuth and time of each firing, with times to a microsecond and `slack_ns`.
fn assert_firings(
    sensor: &Sensor,
    seen: &[SeenFiring],
    blocks: &[i64],
    tolerance_deg: f64,
    slack_ns: i64,
) {
    assert_eq!(seen.len(), 2 * blocks.len());
    for (i, seen) in seen.iter().enumerate() {
        let truth = blocks[i / 2] + (i as i64 % 2) * FIRING_NS;
        let off = (seen.ns - truth).abs();
        assert!(off <= 1_000 + slack_ns, "firing {i}: {off} ns off");
        let off = difference_deg(seen.azimuth_deg, sensor.azimuth_deg(truth));
        assert!(off <= tolerance_deg, "firing {i}: {off} deg off");
        let off = difference_deg(seen.laser_15_deg, sensor.azimuth_deg(truth + 34_560));
        assert!(off <= tolerance_deg, "firing {i}, laser 15: {off} deg off");
    }
}

fn assert_forwards(seen: &[SeenFiring]) {
    assert!(seen.is_sorted_by(|a, b| a.ns < b.ns));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Interpolation between azimuths within 0.005 deg is within 0.005 deg.
    #[test]
    fn azimuths_match_the_rotor(
        rpm in 300.0..1_200.0f64,
        start_deg in 0.0..360.0f64,
        dual: bool,
        begin_us in 0i64..10_000_000_000,
    ) {
        let begin_ns = Sensor::default().begin_ns + begin_us * 1_000;
        let sensor = Sensor { rpm, start_deg, dual, begin_ns, ..Sensor::default() };
        let (packets, blocks) = sensor.packets(30);
        let (seen, stats) = decode(&packets);
        // The last block has no successor and continues at the pace of the block before.
        let known = blocks.len() - 1;
        assert_firings(&sensor, &seen[..2 * known], &blocks[..known], 0.005 + 1e-9, 0);
        assert_firings(&sensor, &seen[2 * known..], &blocks[known..], 0.015, 0);
        assert_forwards(&seen);
        prop_assert_eq!(stats.lost_packets + stats.clock_steps, 0);
        prop_assert!((stats.rpm.unwrap() - rpm).abs() < 0.2);
        let firings = 2 * blocks.len() as i64;
        let off = stats.duration - Span::from_nanos(firings * FIRING_NS);
        prop_assert!(off.as_nanos().abs() <= 1_000);
    }

    #[test]
    fn changes_of_speed_are_followed(spin_up in -300.0..300.0f64, dual: bool) {
        let sensor = Sensor { spin_up, dual, ..Sensor::default() };
        let (packets, blocks) = sensor.packets(400);
        let (seen, stats) = decode(&packets);
        let known = blocks.len() - 1;
        assert_firings(&sensor, &seen[..2 * known], &blocks[..known], 0.005_1, 0);
        prop_assert_eq!(stats.lost_packets, 0);
    }

    /// The hour may change between packets or within one.
    #[test]
    fn the_hour_may_wrap_anywhere(before_us in 0i64..30_000, dual: bool, host_off_s in -1_700i64..1_700) {
        let begin_ns = 470_001 * HOUR_NS - before_us * 1_000;
        let sensor = Sensor { dual, begin_ns, ..Sensor::default() };
        let (mut packets, blocks) = sensor.packets(20);
        for packet in &mut packets {
            packet.host += Span::from_secs(host_off_s);
        }
        let (seen, stats) = decode(&packets);
        assert_firings(&sensor, &seen, &blocks, 0.015, 0);
        assert_forwards(&seen);
        prop_assert_eq!(stats.lost_packets + stats.clock_steps, 0);
    }

    /// Blocks after the gap fire later by the gap than their position in the packet.
    #[test]
    fn a_limited_field_of_view_is_timed_from_the_next_packet(
        rpm in 300.0..1_200.0f64,
        first_deg in 0.0..360.0f64,
        width_deg in 30.0..350.0f64,
        start_deg in 0.0..360.0f64,
        dual: bool,
    ) {
        let view = (first_deg, width_deg);
        let sensor = Sensor { rpm, view, start_deg, dual, ..Sensor::default() };
        let (packets, blocks) = sensor.packets(400);
        let (seen, stats) = decode(&packets);
        // The last packet may span a gap that no successor measures.
        let known = blocks.len() - 12;
        assert_firings(&sensor, &seen[..2 * known], &blocks[..known], 0.015, 1_000);
        assert_forwards(&seen);
        let step_deg = rpm * 6.0 * BLOCK_NS as f64 * 1e-9;
        for firing in &seen {
            let into_deg = (firing.azimuth_deg - first_deg + 0.01).rem_euclid(360.0);
            prop_assert!(into_deg < width_deg + step_deg + 0.02, "{into_deg} of {width_deg}");
        }
        prop_assert_eq!(stats.clock_steps, 0);
    }

    /// With a view of a few degrees one packet spans several gaps.
    #[test]
    fn narrow_fields_of_view_are_timed(rpm in 300.0..1_200.0f64, width_deg in 3.0..30.0f64) {
        let sensor = Sensor { rpm, view: (10.0, width_deg), ..Sensor::default() };
        let (packets, blocks) = sensor.packets(40);
        let (seen, _) = decode(&packets);
        assert_forwards(&seen);
        for (i, (seen, truth)) in seen.chunks(2).zip(&blocks).enumerate().take(blocks.len() - 12) {
            let off_ms = (seen[0].ns - truth) as f64 * 1e-6;
            prop_assert!(off_ms.abs() < 1.0, "block {}: {} ms", i, off_ms);
        }
    }

    #[test]
    fn every_lost_packet_is_counted(
        dual: bool,
        out in prop::collection::btree_set(1usize..99, 0..20),
        limited: bool,
    ) {
        let view = if limited { (320.0, 81.0) } else { (0.0, 360.0) };
        let sensor = Sensor { dual, view, rpm: 300.0, start_deg: 355.0, ..Sensor::default() };
        let (packets, _) = sensor.packets(100);
        // A gap is recognised once a packet spans it.
        let straddlers = packets.windows(2).enumerate().filter(|(_, pair)| {
            (pair[1].host - pair[0].host).as_nanos() > 10_000_000
        });
        let kept: Vec<usize> = straddlers.flat_map(|(i, _)| [i, i + 1, i + 2]).collect();
        let out: Vec<usize> = out.into_iter().filter(|i| !kept.contains(i)).collect();
        let arrived = packets.iter().enumerate().filter(|(i, _)| !out.contains(i));
        let (seen, stats) = decode(arrived.map(|(_, packet)| packet));
        assert_forwards(&seen);
        prop_assert_eq!(stats.lost_packets, out.len() as u64);
    }

    /// Swapped packets are reordered, and repeated packets are emitted once.
    #[test]
    fn packets_out_of_order_are_reordered(
        swaps in prop::collection::btree_set(0usize..60, 0..20),
        twice in prop::collection::btree_set(1usize..120, 0..10),
        dual: bool,
    ) {
        let sensor = Sensor { dual, ..Sensor::default() };
        let (packets, _) = sensor.packets(124);
        let (in_order, _) = decode(&packets);
        let mut shuffled = packets.clone();
        for &i in &swaps {
            shuffled.swap(2 * i, 2 * i + 1);
        }
        let (seen, stats) = decode(&shuffled);
        assert_forwards(&seen);
        prop_assert_eq!(seen.len(), in_order.len());
        for (a, b) in seen.iter().zip(&in_order) {
            prop_assert_eq!(a.ns, b.ns);
            prop_assert!(difference_deg(a.azimuth_deg, b.azimuth_deg) < 0.011);
        }
        prop_assert_eq!((stats.reordered, stats.lost_packets), (swaps.len() as u64, 0));

        let repeated = packets
            .iter()
            .enumerate()
            .flat_map(|(i, packet)| vec![packet; 1 + usize::from(twice.contains(&i))]);
        let (seen, stats) = decode(repeated);
        prop_assert_eq!(seen, in_order);
        prop_assert_eq!(stats.duplicates, twice.len() as u64);
    }

    /// Arbitrary bytes, host times and orders are counted without panic, and both passes agree.
    #[test]
    fn arbitrary_input_does_not_panic(
        junk in prop::collection::vec(junk(), 1..40),
        hosts in prop::collection::vec(prop_oneof![any::<i64>(), 0..10_000_000_000i64], 40),
        options in (any::<bool>(), any::<bool>()),
    ) {
        let duplicates = if options.0 { Duplicates::All } else { Duplicates::Unique };
        let options = Options { duplicates, vertical_offsets: options.1, ..Options::default() };
        let mut decoder = Decoder::new(options.clone());
        let mut timekeeper = Timekeeper::new(options);
        let (mut firings, mut points, mut timed) = (0, 0, 0);
        let mut count = |firing: &Firing<'_>| {
            firings += 1;
            assert!((0.0..360.0).contains(&firing.azimuth_deg));
            points += firing.points().inspect(|point| {
                assert!(point.range_m > 0.0 && point.position_m.iter().all(|c| c.is_finite()));
            }).count() as u64;
        };
        for (bytes, &host) in junk.iter().zip(&hosts) {
            decoder.packet(Stamp::from_nanos(host), bytes, &mut count);
            timed += usize::from(timekeeper.packet(Stamp::from_nanos(host), bytes).is_some());
        }
        decoder.finish(&mut count);
        let stats = decoder.stats();
        prop_assert_eq!(stats.data + stats.position + stats.malformed + stats.other, junk.len() as u64);
        prop_assert!(timed as u64 <= stats.data);
        prop_assert_eq!(stats.firings, firings);
        let expected = match duplicates {
            Duplicates::All => stats.returns,
            Duplicates::Unique => stats.unique_returns,
        };
        prop_assert_eq!(points, expected);
    }
}

/// Payloads from noise to almost valid.
fn junk() -> impl Strategy<Value = Vec<u8>> {
    let packet = (
        prop::collection::vec(any::<u8>(), 1206),
        prop::collection::vec(0u16..=36_000, 12),
        prop_oneof![Just(0x37u8), Just(0x38), Just(0x39), any::<u8>()],
        prop_oneof![
            Just(0x21u8),
            Just(0x22),
            Just(0x24),
            Just(0x28),
            any::<u8>()
        ],
        prop_oneof![any::<u32>(), (0u32..12).prop_map(|k| 1_327 * k)],
    );
    let sound = packet.prop_map(|(mut bytes, azimuths, mode, product, us)| {
        for (block, azimuth) in bytes.chunks_mut(100).zip(azimuths) {
            block[..2].copy_from_slice(&[0xFF, 0xEE]);
            block[2..4].copy_from_slice(&azimuth.to_le_bytes());
        }
        bytes[1200..1204].copy_from_slice(&us.to_le_bytes());
        bytes[1204..].copy_from_slice(&[mode, product]);
        bytes
    });
    prop_oneof![
        1 => prop::collection::vec(any::<u8>(), 0..1_300),
        1 => prop::collection::vec(any::<u8>(), 512),
        6 => sound,
    ]
}

#[test]
fn golden_packet_to_points() {
    let sensor = Sensor {
        rpm: 600.0,
        start_deg: 90.0,
        ..Sensor::default()
    };
    let (packets, _) = sensor.packets(1);
    let mut decoder = Decoder::new(Options::default());
    let mut points = Vec::new();
    let mut keep = |firing: &Firing<'_>| points.extend(firing.points());
    decoder.packet(packets[0].host, &packets[0].bytes, &mut keep);
    decoder.finish(&mut keep);
    assert_eq!(points.len(), 12 * 32);
    // Second firing, laser 3 (channel 19): 55.296 + 3 x 2.304 us on; 3 deg up; 2 mm x 5019; 2.2 mm
    // below the origin.
    let point = points[19];
    assert_eq!((point.laser, point.ring, point.reflectivity), (3, 9, 19));
    assert_eq!(point.time.as_nanos(), sensor.begin_ns + 62_208);
    assert_eq!(point.echo, ReturnKind::Strongest);
    let azimuth = (90.0f64 + 0.40 * 62_208.0 / 110_592.0).to_radians();
    let elevation = 3f64.to_radians();
    let expected = [
        10.038 * elevation.cos() * azimuth.sin(),
        10.038 * elevation.cos() * azimuth.cos(),
        10.038 * elevation.sin() - 0.0022,
    ];
    for (got, expected) in point.position_m.iter().zip(expected) {
        assert!((got - expected).abs() < 1e-9, "{point:?} {expected}");
    }
}

#[test]
fn dual_returns_of_a_pulse_have_one_time() {
    let sensor = Sensor {
        dual: true,
        ..Sensor::default()
    };
    let (packets, _) = sensor.packets(3);
    let mut decoder = Decoder::new(Options::default());
    let mut firings = Vec::new();
    let mut keep = |firing: &Firing<'_>| {
        firings.push(firing.points().take(3).collect::<Vec<_>>());
    };
    for packet in &packets {
        decoder.packet(packet.host, &packet.bytes, &mut keep);
    }
    decoder.finish(&mut keep);
    assert_eq!(firings.len(), 36);
    let raw = |i: usize| (firings[0][i].range_m * 500.0).round() as u32;
    // Laser 0 has two distances, laser 1 a single return.
    assert_eq!((raw(0), firings[0][0].echo), (5_000, ReturnKind::Last));
    assert_eq!(
        (raw(1), firings[0][1].echo),
        (4_000, ReturnKind::StrongestOrSecond)
    );
    assert_eq!(
        (raw(2), firings[0][2].echo),
        (5_001, ReturnKind::StrongestOrSecond)
    );
    assert_eq!(firings[0][0].time, firings[0][1].time);
    // Channel 16 is laser 0 of the second firing: one distance reported twice.
    assert_eq!(firings[1][0].echo, ReturnKind::LastAndStrongest);
    // Of 32 channels one differs, one has a single return, thirty repeat.
    assert_eq!(decoder.stats().returns, 3 * 6 * 63);
    assert_eq!(decoder.stats().unique_returns, 3 * 6 * 33);
}

#[test]
fn late_packets_are_skipped_and_counted() {
    let (packets, _) = Sensor::default().packets(6);
    let order = [0, 2, 3, 4, 1, 5];
    let (seen, stats) = decode(order.map(|i| &packets[i]));
    assert_forwards(&seen);
    assert_eq!((stats.late, stats.lost_packets, seen.len()), (1, 1, 5 * 24));
}

#[test]
fn steps_of_the_device_clock_lose_no_packets() {
    for set_s in [-600, -1, 2, 600] {
        let (mut packets, _) = Sensor::default().packets(20);
        let (after, _) = Sensor {
            begin_ns: Sensor::default().begin_ns + set_s * 1_000_000_000,
            ..Sensor::default()
        }
        .packets(40);
        for (old, new) in packets.clone().iter().zip(&after[20..]) {
            // The host's clock continues.
            packets.push(Packet {
                host: old.host + Span::from_nanos(20 * 12 * BLOCK_NS),
                bytes: new.bytes.clone(),
            });
        }
        let (seen, stats) = decode(&packets);
        assert_eq!(stats.clock_steps, 1, "{set_s} s");
        assert_eq!((stats.lost_packets, stats.late), (0, 0), "{set_s} s");
        assert_eq!(seen.len(), 40 * 24);
        let expected = Span::from_nanos(40 * 12 * BLOCK_NS);
        assert!((stats.duration - expected).as_nanos().abs() < 2_000);
    }
}

#[test]
fn unknown_products_are_identified_by_spacing_or_skipped() {
    let (mut packets, _) = Sensor::default().packets(5);
    for packet in &mut packets {
        packet.bytes[1205] = 0x99;
    }
    let (seen, stats) = decode(&packets);
    assert_eq!((seen.len(), stats.unidentified), (5 * 24, 0));
    assert_eq!(
        stats.conflicts[0].to_string(),
        "the packets' factory byte 0x99 is not known, their spacing of 1327 us says VLP-16; decoded as VLP-16"
    );
    let (seen, stats) = decode(&packets[..1]);
    assert_eq!((seen.len(), stats.unidentified), (0, 1));
}

#[test]
fn the_model_of_the_user_takes_precedence() {
    let (packets, _) = Sensor::default().packets(5);
    let options = Options {
        model: Some(&protocol::vlp16::models::HDL_32E),
        ..Options::default()
    };
    let mut decoder = Decoder::new(options);
    let mut firings = 0;
    for packet in &packets {
        decoder.packet(packet.host, &packet.bytes, &mut |_| firings += 1);
    }
    decoder.finish(&mut |_| firings += 1);
    assert_eq!(
        (firings, decoder.stats().model.unwrap().name),
        (60, "HDL-32E")
    );
    assert_eq!(decoder.stats().conflicts.len(), 1);
    // A Hi-Res has the spacing of a VLP-16: the factory byte alone tells them apart.
    let mut of_one_spacing = Decoder::new(Options {
        model: Some(&protocol::vlp16::models::PUCK_HI_RES),
        ..Options::default()
    });
    for packet in &packets {
        of_one_spacing.packet(packet.host, &packet.bytes, &mut |_| {});
    }
    let conflicts = &of_one_spacing.stats().conflicts;
    assert_eq!(
        conflicts
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>(),
        ["the packets' factory byte says VLP-16; decoded as Puck Hi-Res as asked"]
    );
    let message = decoder.stats().conflicts[0].to_string();
    assert!(
        message.ends_with("says VLP-16; decoded as HDL-32E as asked"),
        "{message}"
    );
}
