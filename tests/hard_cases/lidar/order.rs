//! Packets that arrive late, twice, never, in batches, or from other devices.

use super::*;

/// A port mirror, or a recording of two interfaces, has every packet twice.
#[test]
fn duplicate_packets_are_ignored() {
    let head = steady(600.0, BEGIN_NS - 40 * BLOCK_NS);
    let (packets, truth) = head.packets(20);
    let twice = packets.iter().flat_map(|packet| [packet, packet]);
    let (seen, stats) = decode(twice);
    assert_matches_rotor(&head, &seen, &truth, 0);
    assert_eq!(
        (stats.duplicates, stats.data, stats.lost_packets),
        (20, 40, 0)
    );
}

/// Neighbouring packets swap, also over the hour, where the later one has the smaller stamp.
#[test]
fn packets_out_of_order_are_reordered_before_decoding() {
    let head = steady(600.0, BEGIN_NS - 121 * BLOCK_NS);
    let (mut packets, truth) = head.packets(20);
    for i in [3, 7, 9, 15] {
        packets.swap(i, i + 1);
    }
    let (seen, stats) = decode(&packets);
    assert_matches_rotor(&head, &seen, &truth, 0);
    assert_eq!((stats.reordered, stats.lost_packets, stats.late), (4, 0, 0));
}

/// A packet too late to be sorted in is dropped and counted, so that device time never runs back.
#[test]
fn packets_that_arrive_too_late_are_dropped() {
    let head = steady(600.0, BEGIN_NS - 121 * BLOCK_NS);
    let (mut packets, mut truth) = head.packets(20);
    let late = packets.remove(6);
    packets.insert(11, late);
    truth.drain(6 * 24..7 * 24);
    let (seen, stats) = decode(&packets);
    assert_matches_rotor(&head, &seen, &truth, 0);
    assert_eq!((stats.late, stats.reordered, stats.lost_packets), (1, 0, 1));
}

/// Foreign datagrams, truncated ones, an HDL-64E's, and position packets between the data change
/// only counts.
#[test]
fn foreign_packets_are_ignored() {
    let head = steady(600.0, BEGIN_NS);
    let (packets, truth) = head.packets(20);
    let mut mixed = Vec::new();
    for (i, packet) in packets.iter().enumerate() {
        mixed.push(packet.clone());
        let bytes = match i {
            2 => b"NTP?".to_vec(),
            3 => Vec::new(),
            5 => packet.bytes[..1_205].to_vec(),
            8 => {
                let mut upper = packet.bytes.clone();
                upper[1] = 0xDD;
                upper
            }
            9 => {
                let mut invalid = packet.bytes.clone();
                invalid[2..4].copy_from_slice(&36_001u16.to_le_bytes());
                invalid
            }
            12 => position_packet(17, Pps::Absent, b"").to_vec(),
            _ => continue,
        };
        mixed.push(Packet {
            host: packet.host,
            bytes,
        });
    }
    let (seen, stats) = decode(&mixed);
    assert_matches_rotor(&head, &seen, &truth, 0);
    let counts = (
        stats.data,
        stats.other,
        stats.malformed,
        stats.position,
        stats.lost_packets,
    );
    assert_eq!(counts, (20, 2, 3, 1, 0));
}

/// The host's network stack delivers packets in batches of 15 ms and more: arrival times do not
/// show firing times.
#[test]
fn packets_in_batches_keep_their_times() {
    let head = steady(600.0, BEGIN_NS - 60 * BLOCK_NS);
    let (mut packets, truth) = head.packets(60);
    for batch in packets.chunks_mut(12) {
        let host = batch.last().unwrap().host;
        batch.iter_mut().for_each(|packet| packet.host = host);
    }
    let (seen, stats) = decode(&packets);
    assert_matches_rotor(&head, &seen, &truth, 0);
    assert_no_errors(&stats);
    // The pass that reads only times agrees to the nanosecond.
    let mut timekeeper = Timekeeper::new(Options::default());
    for (packet, firings) in packets.iter().zip(seen.chunks(24)) {
        let timing = timekeeper.packet(packet.host, &packet.bytes).unwrap();
        assert_eq!(timing.first_firing.as_nanos(), firings[0].ns);
    }
}

/// Packets are missing while the rotor turns: firings after the gap are neither moved nor joined to
/// those before.
#[test]
fn firings_after_lost_packets_are_unaffected() {
    for lost in [1, 3, 75, 150] {
        let head = steady(600.0, BEGIN_NS);
        let (mut packets, mut truth) = head.packets(200);
        packets.drain(20..20 + lost);
        truth.drain(20 * 24..(20 + lost) * 24);
        let (seen, stats) = decode(&packets);
        assert_matches_rotor(&head, &seen, &truth, 0);
        assert_eq!(stats.lost_packets, lost as u64);
    }
}
