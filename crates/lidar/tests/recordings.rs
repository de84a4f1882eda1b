//! Decoding of real recordings: counts and sums that independent decoders agree on.
//!
//! Cuts of the recordings are in `tests/recordings`, whose README states origin, licence and
//! counts. Tests of the whole files are ignored by default; they look in `$VELOMOTION_RECORDINGS`,
//! or in `shared/recordings` next to the repository.
#![expect(
    clippy::disallowed_methods,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test of recordings"
)]

use std::path::{Path, PathBuf};

use lidar::{
    Decoder, Duplicates, FrameCutter, Options, OrganisedFrame, RevolutionFrame, SensorPoint, Stats,
    Timekeeper, UtcClock, UtcState,
};
use pcap_parser::{parse_pcap_frame, parse_pcap_header};
use protocol::vlp16::{PositionPacket, Pps, Product, ReturnMode};
use units::{Host, Span, Stamp};

/// Length of Ethernet, IPv4 (without options) and UDP headers.
const HEADERS: usize = 14 + 20 + 8;

struct Datagram {
    host: Stamp<Host>,
    payload: Vec<u8>,
}

/// The UDP datagrams of a cut in `tests/recordings`.
fn recording(name: &str) -> Vec<Datagram> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/recordings");
    datagrams(&Path::new(folder).join(name))
}

/// The UDP datagrams of a whole recording.
fn whole_recording(name: &str) -> Vec<Datagram> {
    let default = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings");
    let folder = std::env::var_os("VELOMOTION_RECORDINGS").map_or_else(default, PathBuf::from);
    datagrams(&folder.join(name))
}

fn datagrams(path: &Path) -> Vec<Datagram> {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
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
    datagrams
}

/// Without vertical offsets, like the sums.
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

/// Properties of every recording here: no loss, increasing time, agreement of both passes.
fn assert_valid(datagrams: &[Datagram], decoded: &Decoded) {
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

/// Contents of a recording by decoders other than ours.
struct Expected {
    data: u64,
    position: u64,
    returns: usize,
    unique: usize,
    sums_m: [f64; 3],
}

#[test]
fn vlp16_strongest_with_gps() {
    let expected = Expected {
        data: 26,
        position: 5,
        returns: 7_747,
        unique: 7_747,
        sums_m: [-226.888, -9_996.653, 544.269],
    };
    assert_strongest_with_gps(&recording("vlp16-strongest-gps.pcap"), &expected);
}

#[test]
#[ignore = "needs the whole recordings"]
fn whole_vlp16_strongest_with_gps() {
    let expected = Expected {
        data: 293,
        position: 57,
        returns: 73_486,
        unique: 73_486,
        sums_m: [-21_874.155, -25_220.069, 3_310.884],
    };
    assert_strongest_with_gps(&whole_recording("vlp16-strongest-gps.pcap"), &expected);
}

fn assert_strongest_with_gps(datagrams: &[Datagram], expected: &Expected) {
    let decoded = decode(datagrams, options(Duplicates::Unique));
    assert_valid(datagrams, &decoded);
    let stats = &decoded.stats;
    assert_eq!(
        (stats.data, stats.position),
        (expected.data, expected.position)
    );
    assert_eq!(stats.other, 0);
    assert_eq!(stats.returns, expected.returns as u64);
    assert_eq!(stats.unique_returns, expected.unique as u64);
    assert_eq!(decoded.points.len(), expected.unique);
    assert_eq!(stats.model.unwrap().name, "VLP-16");
    assert_eq!(stats.return_mode, Some(ReturnMode::Strongest));
    assert_eq!(stats.pps, Some(Pps::Locked));
    assert!(stats.conflicts.is_empty());
    let rpm = stats.rpm.unwrap();
    assert!((rpm - 600.0).abs() < 5.0, "{rpm}");
    let seconds = stats.duration.as_secs_f64();
    assert!(
        (seconds - expected.data as f64 * 1.327_104e-3).abs() < 1e-5,
        "{seconds}"
    );
    assert_sums(&decoded.points, expected.sums_m);
}

#[test]
fn vlp16_dual() {
    let expected = Expected {
        data: 14,
        position: 0,
        returns: 3_022,
        unique: 1_514,
        sums_m: [928.451, 3_004.705, 320.692],
    };
    assert_dual(&recording("vlp16-dual.pcap"), &expected);
}

#[test]
#[ignore = "needs the whole recordings"]
fn whole_vlp16_dual() {
    let expected = Expected {
        data: 603,
        position: 0,
        returns: 116_827,
        unique: 59_414,
        sums_m: [-41_937.679, -124_166.633, 44_588.168],
    };
    assert_dual(&whole_recording("vlp16-dual.pcap"), &expected);
}

fn assert_dual(datagrams: &[Datagram], expected: &Expected) {
    let all = decode(datagrams, options(Duplicates::All));
    assert_valid(datagrams, &all);
    assert_eq!(all.stats.data, expected.data);
    assert_eq!(all.stats.position, expected.position);
    assert_eq!(all.stats.return_mode, Some(ReturnMode::Dual));
    assert_eq!(all.stats.returns, expected.returns as u64);
    assert_eq!(all.points.len(), expected.returns);
    assert_sums(&all.points, expected.sums_m);
    let unique = decode(datagrams, options(Duplicates::Unique));
    assert_eq!(unique.stats.unique_returns, expected.unique as u64);
    assert_eq!(unique.points.len(), expected.unique);
    // Twelve firings per packet at 55.296 us.
    assert_eq!(all.firings.len() as u64, expected.data * 12);
    assert_eq!(all.firings[11].0, 11 * 55_296);
}

#[test]
fn vlp16_of_2014_is_identified() {
    let expected = Expected {
        data: 115,
        position: 21,
        returns: 42_345,
        unique: 42_345,
        sums_m: [28_955.287, -7_197.412, 1_867.654],
    };
    assert_vlp16_of_2014(&recording("vlp16-2014-no-factory-bytes.pcap"), &expected);
}

#[test]
#[ignore = "needs the whole recordings"]
fn whole_vlp16_of_2014_is_identified() {
    let expected = Expected {
        data: 1_902,
        position: 367,
        returns: 700_400,
        unique: 700_400,
        sums_m: [481_207.905, -83_855.660, 32_263.358],
    };
    assert_vlp16_of_2014(
        &whole_recording("vlp16-2014-no-factory-bytes.pcap"),
        &expected,
    );
}

fn assert_vlp16_of_2014(datagrams: &[Datagram], expected: &Expected) {
    let decoded = decode(datagrams, options(Duplicates::Unique));
    assert_valid(datagrams, &decoded);
    let stats = &decoded.stats;
    assert_eq!(
        (stats.data, stats.position),
        (expected.data, expected.position)
    );
    assert_eq!(stats.returns, expected.returns as u64);
    assert_eq!(decoded.points.len(), expected.unique);
    assert_eq!(stats.product, Some(Product::Hdl32e));
    assert_eq!(stats.model.unwrap().name, "VLP-16");
    let [conflict] = &stats.conflicts[..] else {
        panic!("{:?}", stats.conflicts);
    };
    assert_eq!(
        conflict.to_string(),
        "the packets' factory byte says HDL-32E, their spacing of 1327 us says VLP-16; decoded as VLP-16"
    );
    // The spacing confirms the right model against the factory byte.
    let requested = Options {
        model: Some(&protocol::vlp16::models::VLP_16),
        ..options(Duplicates::Unique)
    };
    assert!(decode(datagrams, requested).stats.conflicts.is_empty());
    let rpm = stats.rpm.unwrap();
    assert!((rpm - 1_200.0).abs() < 10.0, "{rpm}");
    assert_sums(&decoded.points, expected.sums_m);
}

#[test]
fn vlp16_with_a_limited_field_of_view() {
    let datagrams = recording("vlp16-fov-limited-malformed.pcap");
    let decoded = decode(&datagrams, options(Duplicates::Unique));
    assert_valid(&datagrams, &decoded);
    assert_eq!((decoded.stats.data, decoded.points.len()), (41, 15_744));
    // The file ends within the 37th position packet.
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
    // Relative to the next packet: 156045 us less one packet and one firing, and 157262 likewise.
    assert!((gaps[0].0 - (156.045 - 1.327_104 + 0.055_296)).abs() < 1e-3);
    assert!((gaps[1].0 - (157.262 - 1.327_104 + 0.055_296)).abs() < 1e-3);
    // The rotor's mean rate over the field of view agrees with those times to 2 %.
    for (ms, from, to) in gaps {
        let turned_deg = (to - from).rem_euclid(360.0);
        let rpm = turned_deg / 6.0 / (ms * 1e-3);
        assert!(
            (rpm - 300.0).abs() < 6.0,
            "{rpm} rpm outside the field of view"
        );
    }
}

#[test]
fn hdl32e_strongest() {
    assert_hdl32e(&recording("hdl32e-strongest.pcap"), 8, 2_496);
}

#[test]
#[ignore = "needs the whole recordings"]
fn whole_hdl32e_strongest() {
    assert_hdl32e(&whole_recording("hdl32e-strongest.pcap"), 500, 146_705);
}

fn assert_hdl32e(datagrams: &[Datagram], packets: usize, returns: usize) {
    let decoded = decode(datagrams, Options::default());
    assert_valid(datagrams, &decoded);
    let stats = &decoded.stats;
    assert_eq!(
        (stats.unique_returns, decoded.points.len()),
        (returns as u64, returns)
    );
    assert_eq!(stats.model.unwrap().name, "HDL-32E");
    assert!(stats.conflicts.is_empty());
    // 12 firings per packet at 46.08 us.
    assert_eq!(decoded.firings.len(), packets * 12);
    assert_eq!(decoded.firings[1].0, 46_080);
}

#[test]
fn missing_packets_are_counted_once() {
    let mut datagrams = recording("vlp16-fov-limited-malformed.pcap");
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
                    // Times are correct whichever neighbour is missing.
                    let turned_deg = (firing.azimuth_deg - azimuth).rem_euclid(360.0);
                    let nominal_ns = turned_deg / 1_800.0 * 1e9;
                    let off_ms = ((start - before) as f64 - nominal_ns) * 1e-6;
                    assert!(off_ms.abs() < 4.0, "without {out}: {off_ms} ms");
                }
                last = Some((start, firing.azimuth_deg));
            });
        }
        decoder.finish(&mut |_| {});
        // A missing packet that spans the first gap is indistinguishable from the gap.
        let straddler = out == 1;
        if !straddler {
            assert_eq!(decoder.stats().lost_packets, 1, "without {out}");
        }
    }
}

#[test]
fn both_passes_agree_on_the_firing_period() {
    let datagrams = recording("vlp16-dual.pcap");
    let mut timekeeper = Timekeeper::new(Options::default());
    for d in &datagrams {
        let timing = timekeeper.packet(d.host, &d.payload).unwrap();
        assert_eq!(timing.fill, Span::from_nanos(12 * 55_296));
    }
}

struct Cut {
    frames: Vec<RevolutionFrame>,
    /// Columns, non-empty cells and layers of each frame.
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

/// Frames of a revolution at any cut; the first and the last are partial.
fn assert_revolutions(name: &str, datagrams: &[Datagram], firings_per_revolution: f64) {
    for cut_deg in [0.0, 90.0, 211.5, 359.99] {
        let Cut { frames, .. } = cut(datagrams, cut_deg);
        let sizes: Vec<u64> = frames.iter().map(|frame| frame.firings).collect();
        println!("{name} cut at {cut_deg}: {sizes:?}");
        let [_, inner @ .., _] = &frames[..] else {
            unreachable!("{frames:?}")
        };
        assert!(inner.len() >= 2);
        for frame in inner {
            assert!(frame.whole, "{frame:?}");
            let off = frame.firings as f64 / firings_per_revolution - 1.0;
            assert!(
                off.abs() < 0.005,
                "{frame:?}, {firings_per_revolution} per revolution"
            );
        }
    }
}

/// Firings of 55.296 us in a revolution.
fn firings_per_revolution(hz: f64) -> f64 {
    1e6 / 55.296 / hz
}

#[test]
fn frames_of_real_revolutions_have_the_rotors_size() {
    let name = "vlp16-2014-no-factory-bytes.pcap";
    assert_revolutions(name, &recording(name), firings_per_revolution(20.0));
}

#[test]
#[ignore = "needs the whole recordings"]
fn frames_of_whole_recordings_have_the_rotors_size() {
    for (name, hz) in [
        ("vlp16-strongest-gps.pcap", 10.0),
        ("vlp16-dual.pcap", 10.0),
        ("vlp16-2014-no-factory-bytes.pcap", 20.0),
    ] {
        assert_revolutions(name, &whole_recording(name), firings_per_revolution(hz));
    }
}

#[test]
fn frames_of_a_limited_field_of_view_begin_at_its_edge() {
    let datagrams = recording("vlp16-fov-limited-malformed.pcap");
    // 320 to 41 deg at 5 Hz: 81 of 360 deg of 3617 firings.
    let Cut { frames, .. } = cut(&datagrams, 180.0);
    println!("{frames:?}");
    assert_eq!(frames.len(), 3);
    assert!(frames[1].whole);
    assert!((frames[1].firings as f64 - 81.0 / 360.0 * 3_617.0).abs() < 25.0);
    let silent = frames[1].first - frames[0].last;
    assert!((silent.as_secs_f64() - 0.155).abs() < 0.002);
    // With a cut at 0, frames begin within the view.
    let Cut { frames, .. } = cut(&datagrams, 0.0);
    assert!((frames[1].first - frames[0].last).as_nanos() < 60_000);
}

#[test]
fn organised_frames_hold_every_return_and_every_shot() {
    for (name, returns, layers) in [
        ("vlp16-strongest-gps.pcap", 7_747, 1),
        ("vlp16-dual.pcap", 3_022, 2),
        ("vlp16-2014-no-factory-bytes.pcap", 42_345, 1),
        ("hdl32e-strongest.pcap", 2_496, 1),
    ] {
        assert_organised(name, &recording(name), returns, layers);
    }
}

#[test]
#[ignore = "needs the whole recordings"]
fn organised_frames_hold_every_return_of_whole_recordings() {
    for (name, returns, layers) in [
        ("vlp16-strongest-gps.pcap", 73_486, 1),
        ("vlp16-dual.pcap", 116_827, 2),
        ("vlp16-2014-no-factory-bytes.pcap", 700_400, 1),
        ("hdl32e-strongest.pcap", 146_705, 1),
    ] {
        assert_organised(name, &whole_recording(name), returns, layers);
    }
}

fn assert_organised(name: &str, datagrams: &[Datagram], returns: usize, layers: usize) {
    let Cut { grids, .. } = cut(datagrams, 0.0);
    let cells: usize = grids.iter().map(|grid| grid.1).sum();
    // Two returns at one distance fill a cell in both layers, as in the packet.
    assert_eq!(cells, returns, "{name}");
    assert!(grids.iter().all(|grid| grid.2 == layers));
}

/// Changes of the lock, and UTC less the host's clock in seconds for every position packet.
fn utc(datagrams: &[Datagram]) -> (Vec<UtcState>, Vec<f64>, usize) {
    let mut clock = UtcClock::new();
    let mut decoder = Decoder::new(Options::default());
    let (mut states, mut off, mut with_utc) = (Vec::new(), Vec::new(), 0);
    let mut timekeeper = Timekeeper::new(Options::default());
    for datagram in datagrams {
        let Datagram { host, payload } = datagram;
        let mut last = None;
        decoder.packet(*host, payload, &mut |firing| {
            for point in firing.points() {
                with_utc += usize::from(clock.utc(point.time).is_some());
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
    (states, off, with_utc)
}

#[test]
fn utc_of_a_locked_sensor_agrees_with_the_host() {
    assert_utc_of_a_locked_sensor(&recording("vlp16-strongest-gps.pcap"), 6_000);
}

#[test]
#[ignore = "needs the whole recordings"]
fn utc_of_a_whole_recording_agrees_with_the_host() {
    assert_utc_of_a_locked_sensor(&whole_recording("vlp16-strongest-gps.pcap"), 72_000);
}

fn assert_utc_of_a_locked_sensor(datagrams: &[Datagram], min_points: usize) {
    let (states, off, with_utc) = utc(datagrams);
    assert_eq!(states, [UtcState::Locked { hours: 0 }]);
    let (least, most) = off
        .iter()
        .fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
    println!(
        "UTC less host: {least:.6} to {most:.6} s over {} packets, {with_utc} points",
        off.len()
    );
    // The host's clock is 0.367 s fast; the rest is the jitter of arrival, 88 us.
    assert!((-0.367..-0.3665).contains(&least) && (-0.367..-0.3665).contains(&most));
    assert!(most - least < 0.000_2, "{least} {most}");
    // All points except those before the first position packet, of the pending packet and of the
    // last one.
    assert!(with_utc > min_points, "{with_utc}");
}

#[test]
fn utc_is_independent_of_the_host_date() {
    let datagrams = recording("vlp16-fov-limited-malformed.pcap");
    // Its capture times were changed to September 2020; the receiver has 2021-05-20 08:17:21.
    let (states, off, _) = utc(&datagrams);
    let [UtcState::Locked { hours }] = states[..] else {
        panic!("{states:?}");
    };
    let first_utc_s = 1_621_498_641.27;
    let host_s = datagrams[0].host.as_nanos() as f64 * 1e-9;
    assert!((off[0] - (first_utc_s - host_s)).abs() < 0.5, "{}", off[0]);
    assert!((off[0] / 3_600.0 - hours as f64).abs() < 0.5);
}
