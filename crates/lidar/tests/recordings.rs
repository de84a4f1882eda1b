//! Real recordings decode to the counts and sums that two independent decoders agree on.
//!
//! The recordings are not part of the project. They are looked for in `$VELOMOTION_RECORDINGS`, or
//! in a folder `shared/recordings` beside the checkout; where they are absent each test says that
//! it was skipped.
#![expect(
    clippy::disallowed_methods,
    clippy::unwrap_used,
    reason = "a test of recordings"
)]

use std::path::PathBuf;

use lidar::{
    Decoder, Duplicates, FrameCutter, Options, OrganisedFrame, RevolutionFrame, SensorPoint, Stats,
    Timekeeper, UtcClock, UtcState,
};
use pcap_parser::{parse_pcap_frame, parse_pcap_header};
use protocol::vlp16::{PositionPacket, Pps, Product, ReturnMode};
use units::{Host, Span, Stamp};

/// Ethernet, IPv4 without options, UDP.
const HEADERS: usize = 14 + 20 + 8;

struct Datagram {
    host: Stamp<Host>,
    payload: Vec<u8>,
}

/// The UDP datagrams of a recording, or `None`, said aloud, where it is absent.
fn recording(name: &str) -> Option<Vec<Datagram>> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings");
    let folder = std::env::var_os("VELOMOTION_RECORDINGS").map_or_else(beside, PathBuf::from);
    let path = folder.join(name);
    let Ok(bytes) = std::fs::read(&path) else {
        println!("SKIPPED: no recording at {}", path.display());
        return None;
    };
    let (mut rest, _) = parse_pcap_header(&bytes).unwrap();
    let mut datagrams = Vec::new();
    while let Ok((after, frame)) = parse_pcap_frame(rest) {
        rest = after;
        let is_udp = frame.data.get(23) == Some(&17);
        if let Some(payload) = frame.data.get(HEADERS..).filter(|_| is_udp) {
            let us = i64::from(frame.ts_sec) * 1_000_000 + i64::from(frame.ts_usec);
            datagrams.push(Datagram {
                host: Stamp::from_nanos(us * 1_000),
                payload: payload.to_vec(),
            });
        }
    }
    Some(datagrams)
}

/// Without the vertical offsets, as the sums are.
fn options(duplicates: Duplicates) -> Options {
    Options {
        vertical_offsets: false,
        duplicates,
        ..Options::default()
    }
}

struct Decoded {
    points: Vec<SensorPoint>,
    /// Start of each firing in nanoseconds after the first, and its azimuth.
    firings: Vec<(i64, f64)>,
    stats: Stats,
}

fn decode(datagrams: &[Datagram], options: Options) -> Decoded {
    let mut decoder = Decoder::new(options);
    let (mut points, mut starts) = (Vec::new(), Vec::new());
    let mut keep = |firing: &lidar::Firing<'_>| {
        points.extend(firing.points());
        starts.push((firing.start, firing.azimuth_deg));
    };
    for datagram in datagrams {
        decoder.packet(datagram.host, &datagram.payload, &mut keep);
    }
    decoder.finish(&mut keep);
    let first = starts[0].0;
    Decoded {
        points,
        firings: starts
            .iter()
            .map(|&(start, azimuth)| ((start - first).as_nanos(), azimuth))
            .collect(),
        stats: decoder.stats().clone(),
    }
}

fn assert_sums(points: &[SensorPoint], expected: [f64; 3]) {
    for (axis, expected) in expected.into_iter().enumerate() {
        let sum: f64 = points.iter().map(|point| point.position_m[axis]).sum();
        let off = (sum / expected - 1.0).abs();
        println!("axis {axis}: {sum:.3} m, expected {expected}, off by {off:.1e}");
        assert!(off < 1e-4, "axis {axis}: {sum} m, expected {expected}");
    }
}

/// What holds for every recording here: nothing lost, time forwards, both passes of one mind.
fn assert_sound(datagrams: &[Datagram], decoded: &Decoded) {
    let Stats {
        malformed,
        unidentified,
        duplicates,
        reordered,
        late,
        clock_steps,
        lost_packets,
        ..
    } = decoded.stats;
    let odd = [
        malformed,
        unidentified,
        duplicates,
        reordered,
        late,
        clock_steps,
        lost_packets,
    ];
    assert_eq!(odd, [0; 7], "{:?}", decoded.stats);
    assert!(decoded.firings.is_sorted_by(|a, b| a.0 < b.0));
    let mut timekeeper = Timekeeper::new(Options::default());
    let timings: Vec<_> = datagrams
        .iter()
        .filter_map(|d| timekeeper.packet(d.host, &d.payload))
        .collect();
    assert_eq!(timings.len() as u64, decoded.stats.data);
    let per_packet = decoded.firings.len() / timings.len();
    for (timing, firings) in timings.iter().zip(decoded.firings.chunks(per_packet)) {
        let start = timing.first_firing - timings[0].first_firing;
        assert_eq!(start.as_nanos(), firings[0].0);
    }
}

#[test]
fn vlp16_strongest_with_gps() {
    let Some(datagrams) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let decoded = decode(&datagrams, options(Duplicates::Unique));
    assert_sound(&datagrams, &decoded);
    let stats = &decoded.stats;
    assert_eq!((stats.data, stats.position, stats.other), (293, 57, 0));
    assert_eq!((stats.returns, stats.unique_returns), (73_486, 73_486));
    assert_eq!(decoded.points.len(), 73_486);
    assert_eq!(stats.model.unwrap().name, "VLP-16");
    assert_eq!(stats.return_mode, Some(ReturnMode::Strongest));
    assert_eq!(stats.pps, Some(Pps::Locked));
    assert!(stats.conflicts.is_empty());
    let rpm = stats.rpm.unwrap();
    assert!((rpm - 600.0).abs() < 5.0, "{rpm}");
    let seconds = stats.duration.as_secs_f64();
    assert!((seconds - 293.0 * 1.327_104e-3).abs() < 1e-5, "{seconds}");
    assert_sums(&decoded.points, [-21_874.155, -25_220.069, 3_310.884]);
}

#[test]
fn vlp16_dual() {
    let Some(datagrams) = recording("vlp16-dual.pcap") else {
        return;
    };
    let all = decode(&datagrams, options(Duplicates::All));
    assert_sound(&datagrams, &all);
    assert_eq!(all.stats.data, 603);
    assert_eq!(all.stats.return_mode, Some(ReturnMode::Dual));
    assert_eq!((all.stats.returns, all.points.len()), (116_827, 116_827));
    assert_sums(&all.points, [-41_937.679, -124_166.633, 44_588.168]);
    let unique = decode(&datagrams, options(Duplicates::Unique));
    assert_eq!(
        (unique.stats.unique_returns, unique.points.len()),
        (59_414, 59_414)
    );
    // Twelve firings a packet, 55.296 us apart.
    assert_eq!(all.firings.len(), 603 * 12);
    assert_eq!(all.firings[11].0, 11 * 55_296);
}

#[test]
fn vlp16_of_2014_is_no_hdl32e() {
    let Some(datagrams) = recording("vlp16-2014-no-factory-bytes.pcap") else {
        return;
    };
    let decoded = decode(&datagrams, options(Duplicates::Unique));
    assert_sound(&datagrams, &decoded);
    let stats = &decoded.stats;
    assert_eq!(
        (stats.data, stats.returns, decoded.points.len()),
        (1_902, 700_400, 700_400)
    );
    assert_eq!(stats.product, Some(Product::Hdl32e));
    assert_eq!(stats.model.unwrap().name, "VLP-16");
    let [conflict] = &stats.conflicts[..] else {
        panic!("{:?}", stats.conflicts);
    };
    assert_eq!(
        conflict.to_string(),
        "the packets' factory byte says HDL-32E, their spacing of 1327 us says VLP-16; decoded as VLP-16"
    );
    let rpm = stats.rpm.unwrap();
    assert!((rpm - 1_200.0).abs() < 10.0, "{rpm}");
    assert_sums(&decoded.points, [481_207.905, -83_855.660, 32_263.358]);
}

#[test]
fn vlp16_with_a_limited_field_of_view() {
    let Some(datagrams) = recording("vlp16-fov-limited-malformed.pcap") else {
        return;
    };
    let decoded = decode(&datagrams, options(Duplicates::Unique));
    assert_sound(&datagrams, &decoded);
    assert_eq!((decoded.stats.data, decoded.points.len()), (41, 15_744));
    // The file ends in the middle of a 37th position packet.
    assert_eq!((decoded.stats.position, decoded.stats.other), (36, 0));
    let mut gaps = Vec::new();
    for pair in decoded.firings.windows(2) {
        let [(start, azimuth), (next, next_azimuth)] = pair else {
            unreachable!()
        };
        assert!(!(41.0..320.0).contains(azimuth), "{azimuth}");
        if next - start > 100_000 {
            gaps.push(((next - start) as f64 * 1e-6, *azimuth, *next_azimuth));
        }
    }
    println!("gaps (ms, from deg, to deg): {gaps:?}");
    assert_eq!(gaps.len(), 2);
    // Timed back from the next packet: 156045 us less one packet and one firing, and 157262
    // likewise.
    assert!((gaps[0].0 - (156.045 - 1.327_104 + 0.055_296)).abs() < 1e-3);
    assert!((gaps[1].0 - (157.262 - 1.327_104 + 0.055_296)).abs() < 1e-3);
    // The rotor's mean rate over the field of view agrees with those times to 2 %.
    for (ms, from, to) in gaps {
        let turned_deg = (to - from).rem_euclid(360.0);
        let rpm = turned_deg / 6.0 / (ms * 1e-3);
        assert!((rpm - 300.0).abs() < 6.0, "{rpm} rpm while looking away");
    }
}

#[test]
fn hdl32e_strongest() {
    let Some(datagrams) = recording("hdl32e-strongest.pcap") else {
        return;
    };
    let decoded = decode(&datagrams, Options::default());
    assert_sound(&datagrams, &decoded);
    let stats = &decoded.stats;
    assert_eq!(
        (stats.unique_returns, decoded.points.len()),
        (146_705, 146_705)
    );
    assert_eq!(stats.model.unwrap().name, "HDL-32E");
    assert!(stats.conflicts.is_empty());
    // 12 firings a packet, 46.08 us apart.
    assert_eq!(decoded.firings.len(), 500 * 12);
    assert_eq!(decoded.firings[1].0, 46_080);
}

#[test]
fn a_packet_missing_anywhere_is_counted_once() {
    let Some(mut datagrams) = recording("vlp16-fov-limited-malformed.pcap") else {
        return;
    };
    datagrams.retain(|d| d.payload.len() == 1206);
    for out in 1..datagrams.len() - 1 {
        let without = datagrams.iter().enumerate().filter(|&(i, _)| i != out);
        let mut decoder = Decoder::new(Options::default());
        let mut last: Option<(i64, f64)> = None;
        for (_, datagram) in without {
            decoder.packet(datagram.host, &datagram.payload, &mut |firing| {
                assert!(!(41.0..320.0).contains(&firing.azimuth_deg));
                let start = firing.start.as_nanos();
                if let Some((before, azimuth)) = last {
                    // Times stay right whichever neighbour is missing.
                    let turned_deg = (firing.azimuth_deg - azimuth).rem_euclid(360.0);
                    let nominal_ns = turned_deg / 1_800.0 * 1e9;
                    let off_ms = ((start - before) as f64 - nominal_ns) * 1e-6;
                    assert!(off_ms.abs() < 4.0, "without {out}: {off_ms} ms");
                }
                last = Some((start, firing.azimuth_deg));
            });
        }
        decoder.finish(&mut |_| {});
        // A missing packet that itself straddled the first gap cannot be told from the gap.
        let straddler = out == 1;
        if !straddler {
            assert_eq!(decoder.stats().lost_packets, 1, "without {out}");
        }
    }
}

#[test]
fn both_passes_agree_on_the_fill() {
    let Some(datagrams) = recording("vlp16-dual.pcap") else {
        return;
    };
    let mut timekeeper = Timekeeper::new(Options::default());
    for d in &datagrams {
        let timing = timekeeper.packet(d.host, &d.payload).unwrap();
        assert_eq!(timing.fill, Span::from_nanos(12 * 55_296));
    }
}

struct Cut {
    frames: Vec<RevolutionFrame>,
    /// Columns, cells with something in them in either layer, and layers of each frame.
    grids: Vec<(usize, usize, usize)>,
}

fn cut(datagrams: &[Datagram], cut_azimuth_deg: f64) -> Cut {
    let mut cutter = FrameCutter::new(cut_azimuth_deg).unwrap();
    let mut grid = OrganisedFrame::new();
    let (mut frames, mut grids) = (Vec::new(), Vec::new());
    let mut decoder = Decoder::new(Options::default());
    let mut close = |frame: Option<RevolutionFrame>, grid: &mut OrganisedFrame| {
        let Some(frame) = frame else { return };
        let cells = (0..grid.layers())
            .flat_map(|layer| (0..grid.rings()).map(move |ring| (layer, ring)))
            .map(|(layer, ring)| grid.row(layer, ring).flatten().count());
        grids.push((grid.columns().len(), cells.sum(), grid.layers()));
        assert_eq!(frame.firings, grid.columns().len() as u64);
        frames.push(frame);
        grid.clear();
    };
    let mut each = |firing: &lidar::Firing<'_>| {
        close(cutter.firing(firing), &mut grid);
        grid.push(firing).unwrap();
    };
    for datagram in datagrams {
        decoder.packet(datagram.host, &datagram.payload, &mut each);
    }
    decoder.finish(&mut each);
    close(cutter.finish(), &mut grid);
    Cut { frames, grids }
}

/// Frames of a turn at any cut; the first and the last are parts of one.
fn assert_turns(name: &str, firings_a_turn: f64) {
    let Some(datagrams) = recording(name) else {
        return;
    };
    for cut_deg in [0.0, 90.0, 211.5, 359.99] {
        let Cut { frames, .. } = cut(&datagrams, cut_deg);
        let sizes: Vec<u64> = frames.iter().map(|frame| frame.firings).collect();
        println!("{name} cut at {cut_deg}: {sizes:?}");
        let [_, inner @ .., _] = &frames[..] else {
            unreachable!("{frames:?}")
        };
        assert!(inner.len() >= 2);
        for frame in inner {
            assert!(frame.whole, "{frame:?}");
            let off = frame.firings as f64 / firings_a_turn - 1.0;
            assert!(off.abs() < 0.005, "{frame:?}, {firings_a_turn} a turn");
        }
    }
}

#[test]
fn frames_of_real_turns_have_the_rotors_size() {
    let a_turn = |hz: f64, firing_us: f64| 1e6 / firing_us / hz;
    assert_turns("vlp16-strongest-gps.pcap", a_turn(10.0, 55.296));
    assert_turns("vlp16-dual.pcap", a_turn(10.0, 55.296));
    assert_turns("vlp16-2014-no-factory-bytes.pcap", a_turn(20.0, 55.296));
}

#[test]
fn frames_of_a_limited_view_begin_where_it_opens() {
    let Some(datagrams) = recording("vlp16-fov-limited-malformed.pcap") else {
        return;
    };
    // 320 to 41 deg of a 5 Hz turn: 81 of 360 deg of 3617 firings.
    let Cut { frames, .. } = cut(&datagrams, 180.0);
    println!("{frames:?}");
    assert_eq!(frames.len(), 3);
    assert!(frames[1].whole);
    assert!((frames[1].firings as f64 - 81.0 / 360.0 * 3_617.0).abs() < 25.0);
    let silent = frames[1].first - frames[0].last;
    assert!((silent.as_secs_f64() - 0.155).abs() < 0.002);
    // Cut at 0, which is in view, frames begin in mid-view.
    let Cut { frames, .. } = cut(&datagrams, 0.0);
    assert!((frames[1].first - frames[0].last).as_nanos() < 60_000);
}

#[test]
fn organised_frames_hold_every_return_and_every_shot() {
    for (name, returns, layers) in [
        ("vlp16-strongest-gps.pcap", 73_486, 1),
        ("vlp16-dual.pcap", 116_827, 2),
        ("vlp16-2014-no-factory-bytes.pcap", 700_400, 1),
        ("hdl32e-strongest.pcap", 146_705, 1),
    ] {
        let Some(datagrams) = recording(name) else {
            continue;
        };
        let Cut { grids, .. } = cut(&datagrams, 0.0);
        let cells: usize = grids.iter().map(|grid| grid.1).sum();
        // A pulse whose two returns are one has them in both layers, as the packet has.
        assert_eq!(cells, returns, "{name}");
        assert!(grids.iter().all(|grid| grid.2 == layers));
    }
}

/// What the position packets of a recording make of the clock: changes of the lock, and UTC less
/// the host's clock in seconds for every position packet.
fn utc(datagrams: &[Datagram]) -> (Vec<UtcState>, Vec<f64>, usize) {
    let mut clock = UtcClock::new();
    let mut decoder = Decoder::new(Options::default());
    let (mut states, mut off, mut told) = (Vec::new(), Vec::new(), 0);
    let mut timekeeper = Timekeeper::new(Options::default());
    for datagram in datagrams {
        let Datagram { host, payload } = datagram;
        let mut last = None;
        decoder.packet(*host, payload, &mut |firing| {
            for point in firing.points() {
                told += usize::from(clock.utc(point.time).is_some());
            }
            last = Some(firing.start);
        });
        states.extend(
            last.and_then(|at| clock.data(at))
                .map(|change| change.state),
        );
        if let Ok(position) = PositionPacket::new(payload) {
            states.extend(clock.position(*host, &position).map(|change| change.state));
        }
        if let Some(timing) = timekeeper.packet(*host, payload)
            && let Some(utc) = clock.utc(timing.first_firing + timing.fill)
        {
            off.push((utc.as_nanos() - host.as_nanos()) as f64 * 1e-9);
        }
    }
    (states, off, told)
}

#[test]
fn utc_of_a_locked_sensor_agrees_with_the_host() {
    let Some(datagrams) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let (states, off, told) = utc(&datagrams);
    assert_eq!(states, [UtcState::Locked { hours: 0 }]);
    let (least, most) = off
        .iter()
        .fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
    println!(
        "UTC less host: {least:.6} to {most:.6} s over {} packets, {told} points",
        off.len()
    );
    // The host's clock is 0.367 s fast; what is left is the jitter of arrival, 88 us.
    assert!((-0.367..-0.3665).contains(&least) && (-0.367..-0.3665).contains(&most));
    assert!(most - least < 0.000_2, "{least} {most}");
    // All points but those before the first position packet, and of the packet held back and the
    // last one.
    assert!(told > 72_000, "{told}");
}

#[test]
fn utc_does_not_need_the_hosts_date() {
    let Some(datagrams) = recording("vlp16-fov-limited-malformed.pcap") else {
        return;
    };
    // Its capture times were edited to September 2020; the receiver says 2021-05-20 08:17:21.
    let (states, off, _) = utc(&datagrams);
    let [UtcState::Locked { hours }] = states[..] else {
        panic!("{states:?}");
    };
    let first_utc_s = 1_621_498_641.27;
    let host_s = datagrams[0].host.as_nanos() as f64 * 1e-9;
    assert!((off[0] - (first_utc_s - host_s)).abs() < 0.5, "{}", off[0]);
    assert!((off[0] / 3_600.0 - hours as f64).abs() < 0.5);
}
