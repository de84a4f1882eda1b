//! Frames begin where the rotor passes the cut, and organised frames keep every shot.
//!
//! The packets are encoded here by manual 9.3.2 from an angle as a function of time, so the frame
//! of every firing is known in closed form.
#![expect(clippy::unwrap_used, reason = "a test")]

use lidar::{
    Decoder, Duplicates, Firing, FrameCutter, Options, OrganisedFrame, ReturnKind, RevolutionFrame,
};
use proptest::prelude::*;
use units::Stamp;

const BLOCK_NS: i64 = 110_592;
const FIRING_NS: i64 = 55_296;
const BEGIN_NS: i64 = 470_000 * 3_600_000_000_000 + 5_000_000_000;

/// A UDP payload and the time of its first block after the first packet.
type Packet = (i64, Vec<u8>);

/// Packets of a VLP-16 whose angle after `t` ns is `angle_deg(t)`, which may exceed 360; `is_seen`
/// tells where it fires.
fn packets(
    blocks: i64,
    angle_deg: impl Fn(i64) -> f64,
    seen: impl Fn(f64) -> bool,
    dual: bool,
) -> Vec<Packet> {
    let ticks = (0..blocks).map(|k| k * BLOCK_NS);
    let times: Vec<i64> = ticks
        .filter(|&t| seen(angle_deg(t).rem_euclid(360.0)))
        .collect();
    let per_packet = if dual { 6 } else { 12 };
    let packet = |times: &[i64]| {
        let mut bytes = Vec::new();
        for &t in times {
            let azimuth = (angle_deg(t).rem_euclid(360.0) * 100.0).round() as u16;
            for half in 0..=u16::from(dual) {
                bytes.extend([0xFF, 0xEE]);
                bytes.extend(azimuth.to_le_bytes());
                for channel in 0..32u16 {
                    let distance = match (channel % 16, half) {
                        (2, _) | (3, 0) | (4, 1) => 0,
                        (5, 1) => 4_000,
                        (laser, _) => 5_000 + laser,
                    };
                    bytes.extend(distance.to_le_bytes());
                    bytes.push((channel % 16) as u8);
                }
            }
        }
        let us = ((BEGIN_NS + times[0]) / 1_000).rem_euclid(3_600_000_000) as u32;
        bytes.extend(us.to_le_bytes());
        bytes.extend([if dual { 0x39 } else { 0x37 }, 0x22]);
        (times[0], bytes)
    };
    times.chunks_exact(per_packet).map(packet).collect()
}

/// Passes every firing to `each`.
fn decode(packets: &[Packet], mut each: impl FnMut(&Firing<'_>)) {
    let mut decoder = Decoder::new(Options::default());
    for (at, bytes) in packets {
        decoder.packet(
            Stamp::from_nanos(BEGIN_NS + at + 1_500_000),
            bytes,
            &mut each,
        );
    }
    decoder.finish(&mut each);
}

/// The frames, and the time and frame index of each firing.
fn cut(packets: &[Packet], cut_azimuth_deg: f64) -> (Vec<RevolutionFrame>, Vec<(i64, u64)>) {
    let mut cutter = FrameCutter::new(cut_azimuth_deg).unwrap();
    let (mut frames, mut firings) = (Vec::new(), Vec::new());
    decode(packets, |firing| {
        frames.extend(cutter.firing(firing));
        firings.push((firing.start.as_nanos() - BEGIN_NS, frames.len() as u64));
    });
    frames.extend(cutter.finish());
    assert_eq!(cutter.finish(), None);
    assert!(
        frames
            .iter()
            .enumerate()
            .all(|(i, frame)| frame.index == i as u64)
    );
    let counted: u64 = frames.iter().map(|frame| frame.firings).sum();
    assert_eq!(counted, firings.len() as u64);
    (frames, firings)
}

fn anywhere(_: f64) -> bool {
    true
}

/// Asserts that every firing is in the frame of its angle, except within the resolution of azimuths
/// at the cut.
fn assert_frames(
    firings: &[(i64, u64)],
    cut_deg: f64,
    angle_deg: impl Fn(i64) -> f64,
    tolerance_deg: f64,
) {
    let revolutions = |t: i64| (angle_deg(t) - cut_deg) / 360.0;
    let base = revolutions(firings[0].0).floor();
    for &(t, frame) in firings {
        let exact = revolutions(t) - base;
        let expected = if angle_deg(t) < angle_deg(firings[0].0) {
            // In the other direction frames count downwards from the cut above.
            revolutions(firings[0].0).ceil() - revolutions(t).ceil()
        } else {
            exact.floor()
        };
        let to_cut_deg = (exact - exact.round()).abs() * 360.0;
        if to_cut_deg > tolerance_deg {
            assert_eq!(
                frame as f64,
                expected,
                "{t} ns, {} deg, cut at {cut_deg}",
                angle_deg(t)
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn frames_begin_at_the_cut_at_any_speed_and_direction(
        rpm in 300.0..1_200.0f64,
        backwards: bool,
        start_deg in 0.0..360.0f64,
        cut_deg in -720.0..720.0f64,
        dual: bool,
    ) {
        let deg_s = if backwards { -6.0 * rpm } else { 6.0 * rpm };
        let angle = |t: i64| 3_600.0 + start_deg + deg_s * t as f64 * 1e-9;
        let (frames, firings) = cut(&packets(3_600, angle, anywhere, dual), cut_deg);
        assert_frames(&firings, cut_deg  , angle, 0.02);
        let per_revolution = 60e9 / rpm / FIRING_NS as f64;
        for frame in &frames[1..frames.len() - 1] {
            prop_assert!(frame.whole);
            prop_assert!((frame.firings as f64 - per_revolution).abs() < 2.0, "{frame:?}, {per_revolution}");
        }
        let first_deg = (angle(0) - cut_deg) * deg_s.signum();
        prop_assert_eq!(frames[0].whole, first_deg.rem_euclid(360.0) < deg_s.abs() * 55.3e-6, "{}", first_deg);
    }

    /// After packets lost at the cut, the first firing begins the frame, once.
    #[test]
    fn packet_loss_at_the_cut_begins_one_frame(cut_deg in 0.0..360.0f64, lost in 1usize..60, before in 0usize..60) {
        let angle = |t: i64| 100.0 + 3_600.0 * t as f64 * 1e-9;
        let mut packets = packets(3_600, angle, anywhere, false);
        let at_cut = packets.iter().position(|&(t, _)| angle(t) > 360.0 + cut_deg).unwrap();
        let from = at_cut.saturating_sub(1 + before.min(lost - 1)).max(1);
        packets.drain(from..from + lost);
        let (frames, firings) = cut(&packets, cut_deg);
        assert_frames(&firings, cut_deg  , angle, 0.02);
        prop_assert!(frames[1..frames.len() - 1].iter().all(|frame| frame.whole));
    }

    /// Frames begin at the cut, or at the edge of a field of view that excludes it.
    #[test]
    fn limited_fields_of_view_are_cut_at_their_gap(
        rpm in 300.0..1_200.0f64,
        first_deg in 0.0..360.0f64,
        width_deg in 40.0..320.0f64,
        cut_deg in 0.0..360.0f64,
    ) {
        let angle = |t: i64| first_deg + 5.0 + 6.0 * rpm * t as f64 * 1e-9;
        let seen = |azimuth: f64| (azimuth - first_deg).rem_euclid(360.0) < width_deg;
        let packets = packets(9_000, angle, seen, false);
        let (frames, firings) = cut(&packets, cut_deg);
        // Times across a gap are exact to microseconds, except in the last packet, whose gap no
        // later packet measures.
        let measured = &firings[..firings.len() - 24];
        assert_frames(measured, cut_deg  , angle, 0.1);
        let at: Vec<i64> = measured.iter().map(|firing| firing.0).collect();
        for frame in &frames[1..] {
            let first = frame.first.as_nanos() - BEGIN_NS;
            let Ok(i) = at.binary_search(&first) else {
                prop_assert!(first > at[at.len() - 1]);
                continue;
            };
            let into_deg = (angle(at[i]) - first_deg).rem_euclid(360.0);
            let cut_into_deg = (cut_deg - first_deg).rem_euclid(360.0);
            let step_deg = 12.0 * rpm * FIRING_NS as f64 * 1e-9;
            // A block that begins within the view may end outside it.
            if cut_into_deg > width_deg + step_deg {
                prop_assert!(into_deg < step_deg + 0.5 || into_deg > 359.5, "{into_deg}");
            }
        }
    }

    /// The rotor jitters at the cut by more than a step.
    #[test]
    fn jitter_at_the_cut_begins_one_frame(
        amplitude_deg in 0.05..0.4f64,
        hz in 200.0..1_000.0f64,
        cut_deg in 0.0..360.0f64,
    ) {
        // 5 revolutions per second, each with a rest of 30 ms at the cut.
        let angle = |t: i64| {
            let (revolution, into) = (t / 200_000_000, t % 200_000_000);
            let moved = (into - 30_000_000).max(0) as f64 / 170_000_000.0;
            let jitter = amplitude_deg * (t as f64 * 1e-9 * hz * std::f64::consts::TAU).sin();
            cut_deg + (revolution as f64 + moved) * 360.0 + jitter
        };
        // Begin before a cut, while the rotor moves.
        let later = |t: i64| angle(t + 100_000_000);
        let (frames, _) = cut(&packets(7_600, later, anywhere, false), cut_deg);
        // 0.84 s from 0.1 s on: cuts at 0.2, 0.4, 0.6, 0.8.
        prop_assert_eq!(frames.len(), 5);
        for (frame, cut_ms) in frames[1..].iter().zip([100, 300, 500, 700]) {
            let off_ms = (frame.first.as_nanos() - BEGIN_NS) as f64 * 1e-6 - f64::from(cut_ms);
            prop_assert!((-1.0..30.0).contains(&off_ms), "{frame:?}");
        }
    }
}

#[test]
fn outages_of_revolutions_begin_one_frame() {
    let angle = |t: i64| 10.0 + 3_600.0 * t as f64 * 1e-9;
    let mut packets = packets(9_000, angle, anywhere, false);
    // 250 ms: two and a half revolutions at 10 Hz.
    packets.drain(200..388);
    let (frames, _) = cut(&packets, 0.0);
    // The gap is from 2.68 to 5.18 revolutions; cuts at 1, 2, 6, 7, 8 and 9.
    let whole: Vec<bool> = frames.iter().map(|frame| frame.whole).collect();
    assert_eq!(whole, [false, true, false, false, true, true, true, false]);
}

#[test]
fn reversals_of_the_rotor_begin_a_frame() {
    let angle = |t: i64| {
        let s = t as f64 * 1e-9;
        if s < 0.15 {
            1_800.0 * s
        } else {
            540.0 - 1_800.0 * s
        }
    };
    // Up to 270 deg and back through 0: one cut at the reversal, one at 0.
    let (frames, _) = cut(&packets(3_600, angle, anywhere, false), 0.0);
    assert_eq!(frames.len(), 3);
    assert!(frames[1].first.as_nanos() - BEGIN_NS - 150_000_000 < 6_000_000);
    assert!((frames[2].first.as_nanos() - BEGIN_NS - 300_000_000).abs() < 200_000);
    let whole: Vec<bool> = frames.iter().map(|frame| frame.whole).collect();
    assert_eq!(whole, [false; 3]);
}

#[test]
fn frames_that_end_within_a_step_of_the_cut_are_whole() {
    // 38 packets are 912 firings, from one cut to just after or just before the next.
    for (last_deg, whole) in [(360.1, true), (359.9, false)] {
        let angle = |t: i64| last_deg * t as f64 / (912 * FIRING_NS) as f64;
        let (frames, _) = cut(&packets(456, angle, anywhere, false), 0.0);
        assert_eq!((frames.len(), frames[0].firings), (1, 912));
        assert_eq!(frames[0].whole, whole, "{last_deg} deg");
    }
}

#[test]
fn cuts_that_are_not_finite_are_refused() {
    for cut in [f64::NAN, f64::INFINITY] {
        let message = FrameCutter::new(cut).unwrap_err().to_string();
        assert!(
            message.starts_with("frames: expected an azimuth in degrees"),
            "{message}"
        );
    }
}

fn organised(packets: &[Packet], duplicates: Duplicates) -> OrganisedFrame {
    let mut frame = OrganisedFrame::new();
    let mut decoder = Decoder::new(Options {
        duplicates,
        ..Options::default()
    });
    let mut keep = |firing: &Firing<'_>| frame.push(firing).unwrap();
    for (at, bytes) in packets {
        decoder.packet(Stamp::from_nanos(BEGIN_NS + at), bytes, &mut keep);
    }
    decoder.finish(&mut keep);
    frame
}

#[test]
fn grids_have_a_cell_per_shot() {
    let angle = |t: i64| 3_600.0 * t as f64 * 1e-9;
    let frame = organised(&packets(120, angle, anywhere, false), Duplicates::Unique);
    assert_eq!(
        (frame.rings(), frame.columns().len(), frame.layers()),
        (16, 240, 1)
    );
    for (column, fired) in frame.columns().iter().enumerate() {
        assert_eq!(
            fired.start.as_nanos(),
            BEGIN_NS
                + column as i64 / 24 * 24 * FIRING_NS / 1_000 * 1_000
                + column as i64 % 24 * FIRING_NS
        );
        for ring in 0..16 {
            // Elevations rise by 2 deg per ring: even lasers from -15, odd ones from 1 (manual
            // table 9-1).
            let laser = if ring < 8 {
                2 * ring
            } else {
                2 * (ring - 8) + 1
            };
            let time = frame.time(ring, column).unwrap();
            assert_eq!((time - fired.start).as_nanos(), 2_304 * laser as i64);
            match frame.cell(0, ring, column) {
                None => assert!([2, 3].contains(&laser), "{laser}"),
                Some(point) => {
                    assert_eq!((usize::from(point.laser), point.time), (laser, time));
                    assert_eq!(usize::from(point.reflectivity), laser);
                    let rise = (point.position_m[2] / point.range_m).asin().to_degrees();
                    assert!(
                        (rise - (2.0 * ring as f64 - 15.0)).abs() < 0.1,
                        "ring {ring}: {rise}"
                    );
                }
            }
        }
    }
    assert_eq!(frame.row(0, 15).flatten().count(), 240);
    assert_eq!(
        (frame.row(0, 1).count(), frame.row(0, 1).flatten().count()),
        (240, 0)
    );
    let outside = [
        frame.cell(0, 16, 0),
        frame.cell(0, 0, 240),
        frame.cell(1, 0, 0),
        frame.cell(2, 0, 0),
    ];
    assert_eq!(outside, [None; 4]);
    assert_eq!(
        (
            frame.time(16, 0),
            frame.time(0, 240),
            frame.row(1, 0).count()
        ),
        (None, None, 0)
    );
}

#[test]
fn dual_returns_are_two_layers() {
    let angle = |t: i64| 3_600.0 * t as f64 * 1e-9;
    let packets = packets(120, angle, anywhere, true);
    for duplicates in [Duplicates::Unique, Duplicates::All] {
        let frame = organised(&packets, duplicates);
        assert_eq!((frame.layers(), frame.columns().len()), (2, 240));
        let at = |layer, laser: usize| {
            let ring = if laser.is_multiple_of(2) {
                laser / 2
            } else {
                8 + laser / 2
            };
            frame
                .cell(layer, ring, 100)
                .map(|point| ((point.range_m * 500.0).round() as u32, point.echo))
        };
        assert_eq!((at(0, 2), at(1, 2)), (None, None));
        assert_eq!(
            (at(0, 3), at(1, 3)),
            (None, Some((5_003, ReturnKind::StrongestOrSecond)))
        );
        assert_eq!(
            (at(0, 4), at(1, 4)),
            (Some((5_004, ReturnKind::Last)), None)
        );
        assert_eq!(at(0, 5), Some((5_005, ReturnKind::Last)));
        assert_eq!(at(1, 5), Some((4_000, ReturnKind::StrongestOrSecond)));
        let both = Some((5_006, ReturnKind::LastAndStrongest));
        assert_eq!((at(0, 6), at(1, 6)), (both, both));
        assert_eq!(frame.row(1, 0).count(), 240);
    }
}

#[test]
fn grids_hold_one_model_and_can_be_reused() {
    let angle = |t: i64| 3_600.0 * t as f64 * 1e-9;
    let mut packets = packets(12, angle, anywhere, false);
    let mut frame = organised(&packets, Duplicates::Unique);
    packets[0].1[1_205] = 0x24; // Puck Hi-Res
    let mut message = None;
    decode(&packets, |firing| message = frame.push(firing).err());
    assert_eq!(
        message.unwrap().to_string(),
        "organised frame: expected firings of a VLP-16, got one of a Puck Hi-Res"
    );
    assert_eq!(frame.columns().len(), 24);
    frame.clear();
    assert_eq!(
        (frame.rings(), frame.columns().len(), frame.layers()),
        (0, 0, 1)
    );
    decode(&packets, |firing| frame.push(firing).unwrap());
    assert_eq!((frame.rings(), frame.columns().len()), (16, 24));
}
