//! The fast path against the definition: every model, return mode and option, any trajectory, any
//! spans.

use std::sync::Arc;

use cloud::mount::Mount;
use cloud::{Fields, Points, Sink};
use drive::record::{Record, Wire};
use lidar::{Corrections, Decoder, Duplicates, LaserCorrection, Options};
use proptest::prelude::*;
use units::{Lidar, Metres};

use super::*;
use crate::angles::AngleSample;
use crate::clock::{Arrival, LidarClock};
use crate::placer::Placer;
use crate::trajectory::{Method, Trajectory};

/// A full hour, where the sensor's count of microseconds begins.
const EPOCH: i64 = 472_222 * 3_600_000_000_000;
const PACKETS: usize = 40;

/// Factory byte of a product, its block period, and mode bytes: single or dual.
const PRODUCTS: [(u8, i64); 4] = [
    (0x22, 110_592),
    (0x24, 110_592),
    (0x21, 46_080),
    (0x28, 55_296),
];

/// Packets of a spinning sensor, filled from `noise`.
fn packets(product: (u8, i64), dual: bool, pace_cdeg: u32, noise: &[u8]) -> Vec<(i64, Vec<u8>)> {
    let (byte, period_ns) = product;
    let blocks = if dual { 6 } else { 12 };
    let mut noise = noise.iter().copied().cycle();
    (0..PACKETS)
        .map(|n| {
            let mut bytes = Vec::new();
            for block in 0..12 {
                let fired = n * blocks + if dual { block / 2 } else { block };
                let azimuth = (35_000 + fired as u32 * pace_cdeg) % 36_000;
                bytes.extend([0xFF, 0xEE]);
                bytes.extend((azimuth as u16).to_le_bytes());
                for _ in 0..32 {
                    // One in four is no return; some pairs are equal.
                    let (a, b) = (noise.next().unwrap(), noise.next().unwrap());
                    let distance = if a < 64 {
                        0
                    } else {
                        u16::from_le_bytes([b & 3, a])
                    };
                    bytes.extend(distance.to_le_bytes());
                    bytes.push(b);
                }
            }
            let device_ns = n as i64 * blocks as i64 * period_ns;
            bytes.extend(((device_ns / 1_000) as u32).to_le_bytes());
            bytes.extend([if dual { 0x39 } else { 0x37 }, byte]);
            (device_ns + blocks as i64 * period_ns, bytes)
        })
        .collect()
}

fn records(packets: &[(i64, Vec<u8>)]) -> impl Iterator<Item = Record<'_>> {
    packets.iter().map(|(ns, payload)| Record {
        host: Stamp::from_nanos(EPOCH + ns),
        wire: Wire::Lidar {
            source: [0; 4],
            port: 2368,
            payload,
        },
    })
}

/// By the definition, point by point.
fn slow(
    alignment: &Alignment,
    options: Options,
    packets: &[(i64, Vec<u8>)],
) -> (Points, PlacementCounts) {
    let (mut points, mut placed) = (Points::new(Fields::ALL), PlacementCounts::default());
    let mut decoder = Decoder::new(options);
    let mut each = |firing: &lidar::Firing<'_>| {
        for point in firing.points() {
            match alignment.place(&point) {
                Some(point) => {
                    placed.points += 1;
                    points.push(point);
                }
                None => placed.outside += 1,
            }
        }
    };
    for (ns, payload) in packets {
        decoder.packet(Stamp::from_nanos(EPOCH + ns), payload, &mut each);
    }
    decoder.finish(&mut each);
    (points, placed)
}

fn fast(
    alignment: &Alignment,
    options: Options,
    packets: &[(i64, Vec<u8>)],
) -> (Points, PlacementCounts) {
    let mut points = Points::new(Fields::ALL);
    let mut placer = Placer::new(alignment, options, &mut points);
    for record in records(packets) {
        placer.observe(&record).unwrap();
    }
    let (placed, _) = placer.finish().unwrap();
    points.finish().unwrap();
    (points, placed)
}

/// The same points in the same order: positions within a nanometre, times within a nanosecond, all
/// else bit-identical.
fn assert_same(fast: &(Points, PlacementCounts), slow: &(Points, PlacementCounts)) {
    assert_eq!(fast.1, slow.1);
    assert_eq!(fast.0.len(), slow.0.len());
    for (a, b) in fast.0.iter().zip(slow.0.iter()) {
        let off = a
            .position_m
            .iter()
            .zip(&b.position_m)
            .map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9, "{a:?} {b:?}");
        assert!((a.time - b.time).as_nanos().abs() <= 1, "{a:?} {b:?}");
        assert!((a.tilt.0 - b.tilt.0).abs() < 5e-10, "{a:?} {b:?}");
        assert!((a.sd_m / b.sd_m - 1.0).abs() < 1e-6, "{a:?} {b:?}");
        let exact = |p: &cloud::Point| (p.intensity, p.ring, p.laser, p.device_time);
        assert_eq!(exact(&a), exact(&b));
    }
}

/// A clock over `seconds` whose lines differ from block to block.
fn clock(seconds: i64, ppm: &[i64; 4]) -> LidarClock {
    let mut host = EPOCH;
    let mut arrivals = Vec::new();
    for tenth in 0..seconds * 10 {
        let drift = ppm[(tenth / 150 % 4) as usize];
        arrivals.push(Arrival {
            device: Stamp::<Lidar>::from_nanos(EPOCH + tenth * 100_000_000 - seconds * 500_000_000),
            host: Stamp::from_nanos(host - seconds * 500_000_000),
        });
        host += 100_000_000 + drift * 100;
    }
    LidarClock::fit(&arrivals).unwrap()
}

prop_compose! {
    /// Samples at irregular times around the packets, of an axis at up to 500 deg/s either way.
    fn any_trajectory()(
        steps in prop::collection::vec((1i64..4_000_000, -500.0..500.0f64), 2..200),
        begin in -5_000_000i64..20_000_000,
        angle in -180.0..180.0f64,
        fixed in prop::bool::weighted(0.1),
        method in prop::sample::select(&[Method::Linear, Method::Hermite]),
    ) -> Trajectory {
        if fixed {
            return Trajectory::fixed(Degrees(angle));
        }
        let (mut ns, mut angle) = (EPOCH + begin, angle);
        let samples = steps.into_iter().map(|(step, speed)| {
            ns += step;
            angle += speed * step as f64 * 1e-9;
            AngleSample { host: Stamp::from_nanos(ns), bound: Span::ZERO, angle: Degrees(angle) }
        });
        Trajectory::through(samples.collect(), Degrees(0.0), &[], Some(method)).unwrap()
    }
}

prop_compose! {
    fn any_spans()(
        edges in prop::collection::vec(-2_000_000i64..60_000_000, 0..6),
        always: bool,
    ) -> Vec<(Stamp<Host>, Stamp<Host>)> {
        let mut edges = edges;
        edges.sort_unstable();
        if always {
            edges = vec![-1_000_000_000, 1_000_000_000];
        }
        let stamp = |ns: i64| Stamp::from_nanos(EPOCH + ns);
        edges.chunks_exact(2).map(|pair| (stamp(pair[0]), stamp(pair[1]))).collect()
    }
}

prop_compose! {
    fn any_corrections(lasers: usize)(
        lasers in prop::collection::vec(
            (-25.0..15.0f64, -6.0..6.0f64, prop::array::uniform4(-0.1..0.1f64)), lasers,
        ),
        aside: bool,
    ) -> Corrections {
        let lasers = lasers.into_iter().map(|(elevation_deg, azimuth_offset_deg, offsets_m)| {
            let [range, radial, tangential, vertical] = offsets_m;
            LaserCorrection {
                elevation_deg,
                azimuth_offset_deg,
                range_offset_m: range,
                radial_offset_m: radial,
                tangential_offset_m: if aside { tangential } else { 0.0 },
                vertical_offset_m: vertical,
            }
        });
        Corrections { lasers: lasers.collect() }
    }
}

/// Registers of every width of this processor.
fn levels() -> Vec<Level> {
    let detected = Level::new();
    #[cfg(not(target_arch = "x86_64"))]
    let narrower: [Option<Level>; 0] = [];
    #[cfg(target_arch = "x86_64")]
    let narrower = [
        detected.as_sse4_2().map(Level::Sse4_2),
        detected.as_avx2().map(Level::Avx2),
    ];
    let narrower = narrower.into_iter().flatten();
    [detected, Level::baseline()]
        .into_iter()
        .chain(narrower)
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn firing_blocks_place_points_as_the_definition_does(
        product in prop::sample::select(&PRODUCTS),
        modes in (any::<bool>(), any::<bool>(), any::<bool>()),
        corrections in (any_corrections(16), any_corrections(32), any::<bool>()),
        pace_cdeg in 1u32..120,
        noise in prop::collection::vec(any::<u8>(), 1_000..2_000),
        trajectory in any_trajectory(),
        spans in any_spans(),
        ppm in prop::array::uniform4(-150i64..150),
        seconds in 1i64..200,
    ) {
        let (dual, all, vertical_offsets) = modes;
        let packets = packets(product, dual, pace_cdeg, &noise);
        let (sixteen, thirty_two, corrected) = corrections;
        let fitting = if product.1 == 110_592 { sixteen } else { thirty_two };
        let options = Options {
            vertical_offsets,
            duplicates: if all { Duplicates::All } else { Duplicates::Unique },
            corrections: corrected.then(|| Arc::new(fitting)),
            ..Options::default()
        };
        let alignment = Alignment::new(clock(seconds, &ppm), trajectory, Mount::new(Metres(0.06)), 0.004, spans);
        let fast = fast(&alignment, options.clone(), &packets);
        assert_same(&fast, &slow(&alignment, options, &packets));
    }

    /// A replay is the same on every processor.
    #[test]
    fn simd_levels_agree_bit_for_bit(
        product in prop::sample::select(&PRODUCTS),
        dual: bool,
        noise in prop::collection::vec(any::<u8>(), 1_000..2_000),
        trajectory in any_trajectory(),
    ) {
        let packets = packets(product, dual, 40, &noise);
        let always = vec![(Stamp::from_nanos(i64::MIN), Stamp::from_nanos(i64::MAX))];
        let mount = Mount::new(Metres(0.06));
        let alignment = Alignment::new(clock(60, &[5, -20, 30, 0]), trajectory, mount, 0.004, always);
        let run = |mut placer: FiringBlockPlacer<'_>| {
            let (mut points, mut placed) = (Points::new(Fields::ALL), PlacementCounts::default());
            let mut decoder = Decoder::new(Options::default());
            for (ns, payload) in &packets {
                decoder.decode_blocks(Stamp::from_nanos(EPOCH + ns), payload, &mut |block| {
                    placer.place(block, &mut points, &mut placed);
                });
            }
            points
        };
        let wide = run(FiringBlockPlacer::new(&alignment));
        let bits = |points: &Points| -> Vec<[u64; 4]> {
            let tilts = points.tilt_deg().iter();
            points
                .positions()
                .zip(tilts)
                .map(|([x, y, z], tilt)| [x, y, z, *tilt].map(f64::to_bits))
                .collect()
        };
        for level in levels() {
            let narrow = run(FiringBlockPlacer::with_level(&alignment, level));
            prop_assert_eq!(bits(&wide), bits(&narrow), "{:?}", level);
            prop_assert_eq!(&wide, &narrow, "{:?}", level);
        }
    }

    /// The points of a block do not depend on earlier blocks, bit for bit.
    #[test]
    fn a_recording_from_its_middle_gives_the_same_points(
        dual: bool,
        noise in prop::collection::vec(any::<u8>(), 1_000..2_000),
        trajectory in any_trajectory(),
        from in 1..PACKETS - 2,
    ) {
        let packets = packets(PRODUCTS[0], dual, 40, &noise);
        let always = vec![(Stamp::from_nanos(i64::MIN), Stamp::from_nanos(i64::MAX))];
        let mount = Mount::new(Metres(0.06));
        let alignment = Alignment::new(clock(60, &[5, -20, 30, 0]), trajectory, mount, 0.004, always);
        let (whole, _) = fast(&alignment, Options::default(), &packets);
        let (part, _) = fast(&alignment, Options::default(), &packets[from..]);
        let first = part.device_time().first().copied();
        let tail = whole.iter().skip_while(|point| Some(point.device_time) != first);
        prop_assert!(tail.eq(part.iter()));
    }
}
