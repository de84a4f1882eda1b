//! The live cloud equals a replay of the same records, up to the errors of the streaming clock and
//! trajectory.
#![allow(clippy::unwrap_used)] // a test

use std::collections::HashMap;

use cloud::{Fields, Point, Points};
use drive::record::{Direction, DriveLink, Record, Wire};
use lidar::Options;
use scanner::trajectory::Method;
use scanner::{Accuracy, Live, ScanConfig, SweepPlan, TiltSource};
use units::{Host, Span, Stamp};

/// A full hour, where the sensor's microseconds begin.
const EPOCH_NS: i64 = 472_222 * 3_600_000_000_000;
/// Twelve blocks of a VLP-16.
const PACKET_NS: i64 = 12 * 110_592;
const PACKETS: i64 = 1_200;
/// Default axis: 500 lines, 120:1.
const DEG_PER_QC: f64 = 0.0015;

const MOVE_NS: i64 = 300_000_000;
const SPEED_DEG_S: f64 = -56.25;
const RAMP_S: f64 = 0.1;
const CRUISE_S: f64 = 0.7;
/// A clock is set in the middle of the sweep.
const STEP_NS: i64 = MOVE_NS + 450_000_000;

enum Traffic {
    Lidar(Vec<u8>),
    Drive(Direction, [u8; 16]),
}

impl Traffic {
    const fn is_packet(&self) -> bool {
        matches!(self, Self::Lidar(_))
    }
}

/// Tilt of a profile move: two ramps with a cruise between them.
fn angle_deg(ns: i64) -> f64 {
    let t = ((ns - MOVE_NS - 1_000_000) as f64 * 1e-9).clamp(0.0, CRUISE_S + 2.0 * RAMP_S);
    let ramp = |t: f64| t.clamp(0.0, RAMP_S).powi(2) / (2.0 * RAMP_S) + (t - RAMP_S).max(0.0);
    SPEED_DEG_S * (ramp(t) - ramp((t - RAMP_S - CRUISE_S).max(0.0)))
}

/// A SocketCAN frame.
fn can(id: u32, data: [u8; 8]) -> [u8; 16] {
    let mut frame = [0; 16];
    frame[..4].copy_from_slice(&id.to_be_bytes());
    frame[4] = 8;
    frame[8..].copy_from_slice(&data);
    frame
}

/// Expedited SDO: command, object, subindex 0, value.
fn sdo(command: u8, object: u16, value: i32) -> [u8; 8] {
    let ([low, high], [a, b, c, d]) = (object.to_le_bytes(), value.to_le_bytes());
    [command, low, high, 0, a, b, c, d]
}

fn exchange(log: &mut Vec<(i64, Traffic)>, at: [i64; 2], request: [u8; 8], answer: [u8; 8]) {
    log.push((
        at[0],
        Traffic::Drive(Direction::ToDrive, can(0x601, request)),
    ));
    log.push((
        at[1],
        Traffic::Drive(Direction::FromDrive, can(0x581, answer)),
    ));
}

fn packet(n: i64) -> Vec<u8> {
    packet_stamped(n, 0)
}

/// A packet of a lidar whose clock was set forward by `by_us`.
fn packet_stamped(n: i64, by_us: i64) -> Vec<u8> {
    let mut bytes = Vec::new();
    for block in 0..12 {
        let azimuth = ((n * 12 + block) * 40 % 36_000) as u16;
        bytes.extend([0xFF, 0xEE]);
        bytes.extend(azimuth.to_le_bytes());
        for channel in 0..32_u8 {
            bytes.extend((4_000 + u16::from(channel) * 20).to_le_bytes());
            bytes.push(channel * 7);
        }
    }
    let stamp_us = (n * PACKET_NS / 1_000 + by_us).rem_euclid(3_600_000_000);
    bytes.extend((stamp_us as u32).to_le_bytes());
    bytes.extend([0x37, 0x22]);
    bytes
}

/// A sweep, polled every millisecond, in order of time.
fn log() -> Vec<(i64, Traffic)> {
    let mut log = Vec::new();
    for n in 0..PACKETS {
        let delay = 30_000 + n * 7_919 % 20_000;
        log.push(((n + 1) * PACKET_NS + delay, Traffic::Lidar(packet(n))));
    }
    for poll in 0..PACKETS * PACKET_NS / 1_000_000 {
        let at = [poll * 1_000_000 + 100_000, poll * 1_000_000 + 500_000];
        let position = (angle_deg((at[0] + at[1]) / 2) / DEG_PER_QC).floor() as i32;
        exchange(
            &mut log,
            at,
            sdo(0x40, 0x6064, 0),
            sdo(0x43, 0x6064, position),
        );
    }
    let target = (angle_deg(i64::MAX / 2) / DEG_PER_QC) as i32;
    let speed_rpm = (-SPEED_DEG_S / 0.05) as i32;
    for (i, (command, object, value)) in [
        (0x23, 0x607A, target),
        (0x23, 0x6081, speed_rpm),
        (0x2B, 0x6040, 0x001F),
    ]
    .into_iter()
    .enumerate()
    {
        let from = MOVE_NS + 550_000 + i as i64 * 100_000;
        let written = sdo(0x60, object, 0);
        exchange(
            &mut log,
            [from, from + 50_000],
            sdo(command, object, value),
            written,
        );
    }
    log.sort_by_key(|(ns, _)| *ns);
    log
}

fn record((ns, traffic): &(i64, Traffic)) -> Record<'_> {
    Record {
        host: Stamp::<Host>::from_nanos(EPOCH_NS + ns),
        wire: match traffic {
            Traffic::Lidar(payload) => Wire::Lidar {
                source: [0; 4],
                port: 2368,
                payload,
            },
            Traffic::Drive(direction, frame) => Wire::Drive {
                link: DriveLink::Can,
                direction: *direction,
                frame,
            },
        },
    }
}

/// Points that go nowhere.
struct Ignored;

impl cloud::Sink for Ignored {
    fn points(&mut self, _: &Points) -> Result<(), cloud::SinkError> {
        Ok(())
    }
}

/// All of 4,200 packets wait for a drive that never answers, which is more than may wait, or none
/// is answered after the first half of the move.
#[test]
fn returns_without_an_angle_are_counted() {
    let returns = |packets: i64| 384 * packets as u64;
    let sink = &mut Ignored;
    let mut live = Live::new(&ScanConfig::default(), Options::default(), sink).unwrap();
    for n in 0..4_200 {
        let sent = ((n + 1) * PACKET_NS, Traffic::Lidar(packet(n)));
        live.observe(&record(&sent)).unwrap();
    }
    let (counts, _) = live.finish().unwrap();
    assert_eq!((counts.points, counts.outside), (0, returns(4_200)));
    let (log, sink) = (log(), &mut Ignored);
    let mut live = Live::new(&ScanConfig::default(), Options::default(), sink).unwrap();
    let middle = MOVE_NS + 450_000_000;
    let is_kept = |(ns, traffic): &(i64, Traffic)| match traffic {
        Traffic::Lidar(_) => true,
        Traffic::Drive(..) => *ns < middle,
    };
    for entry in log.iter().filter(|entry| is_kept(entry)) {
        live.observe(&record(entry)).unwrap();
    }
    let (counts, _) = live.finish().unwrap();
    assert!(counts.points > 100_000, "{counts:?}");
    assert_eq!(counts.points + counts.outside, returns(PACKETS));
}

/// Points of the live cloud and of a replay with straight lines between samples; the greatest lag.
fn both(log: &[(i64, Traffic)], config: &ScanConfig) -> (Points, Points, Span) {
    let mut live = Points::new(Fields::ALL);
    let mut placer = Live::new(config, Options::default(), &mut live).unwrap();
    let mut lag = Span::ZERO;
    for entry in log {
        placer.observe(&record(entry)).unwrap();
        lag = lag.max(placer.lag().unwrap_or_default());
    }
    let (counts, _) = placer.finish().unwrap();
    assert_eq!(counts.points, live.len() as u64);

    let records = || log.iter().map(record);
    let accuracy = Accuracy::By(Method::Linear);
    let options = Options::default;
    let alignment =
        scanner::align(records(), config, options(), &TiltSource::Log, accuracy).unwrap();
    assert_eq!(alignment.sweeps.len(), 1);
    let mut replayed = Points::new(Fields::ALL);
    scanner::place(records(), &alignment, options(), &mut replayed).unwrap();
    assert!(replayed.len() > 200_000);
    (live, replayed, lag)
}

/// Compares all points of firings that have one.
fn assert_alike(live: &Points, replayed: &Points, what: &str) {
    let key = |point: &Point| (point.device_time, point.laser);
    let mut by_firing: HashMap<_, Option<Point>> = HashMap::new();
    for point in replayed.iter() {
        // After a step back the lidar's clock reads the same twice.
        let is_new = !by_firing.contains_key(&key(&point));
        by_firing.insert(key(&point), is_new.then_some(point));
    }
    let mut common = 0;
    for point in live.iter() {
        let Some(other) = by_firing.get(&key(&point)) else {
            continue;
        };
        common += 1;
        let Some(other) = other else { continue };
        let same = |p: &Point| (p.intensity, p.ring, p.echo);
        assert_eq!(same(&point), same(other));
        // The jitter of the packets is 20 us, at 56.25 deg/s 0.0011 deg; half of a count is
        // 0.00075. A step of a clock is known to the jitter.
        let apart = format!("{what}: {point:?} {other:?}");
        let late = point.time - other.time;
        assert!(late.as_nanos().abs() < 25_000, "{apart}");
        assert!((point.tilt.0 - other.tilt.0).abs() < 0.003, "{apart}");
        for (a, b) in point.position_m.iter().zip(other.position_m) {
            assert!((a - b).abs() < 0.6e-3, "{apart}");
        }
    }
    let share = |points: &Points| f64::from(common) / points.len() as f64;
    let shares = [share(live), share(replayed)];
    assert!(
        shares.iter().all(|share| *share > 0.99),
        "{what}: {shares:?}"
    );
}

#[test]
fn live_points_equal_those_of_a_replay() {
    let (live, replayed, lag) = both(&log(), &ScanConfig::default());
    assert_alike(&live, &replayed, "no step");
    assert!(lag < Span::from_millis(5), "{lag:?}");
}

/// In the middle of the sweep, by NTP or by hand. While it is in doubt, records wait.
#[test]
fn steps_of_the_host_clock_are_undone_in_the_live_cloud() {
    for by in [12, -12, 150, -150, 2_000, -3_600_000].map(|ms| ms * 1_000_000) {
        let mut log = log();
        for (ns, _) in &mut log {
            *ns += if *ns >= STEP_NS { by } else { 0 };
        }
        let (live, replayed, lag) = both(&log, &ScanConfig::default());
        assert_alike(&live, &replayed, &format!("host {by} ns"));
        assert!(lag < Span::from_millis(40), "{by} ns: {lag:?}");
    }
}

#[test]
fn steps_of_the_lidar_clock_are_undone_in_the_live_cloud() {
    for by_us in [60, -60, 600, -600, 20_300, -47_900, 3_000_100] {
        let mut log = log();
        for (n, (ns, traffic)) in (0..).zip(log.iter_mut().filter(|(_, t)| t.is_packet())) {
            let is_later = *ns >= STEP_NS;
            *traffic = Traffic::Lidar(packet_stamped(n, if is_later { by_us } else { 0 }));
        }
        let (live, replayed, _) = both(&log, &ScanConfig::default());
        assert_alike(&live, &replayed, &format!("lidar {by_us} us"));
    }
}

/// The recorder has dropped the command that starts it, or its target.
#[test]
fn a_sweep_without_its_command_is_in_the_live_cloud() {
    let plan = SweepPlan {
        from_deg: 0.0,
        to_deg: angle_deg(i64::MAX / 2),
        cruise_deg_s: SPEED_DEG_S.abs(),
        accel_deg_s2: SPEED_DEG_S.abs() / RAMP_S,
        sweeps: 1,
        both_ways: false,
    };
    let config = ScanConfig {
        sweep: Some(plan),
        ..ScanConfig::default()
    };
    for object in [0x6040_u16, 0x607A] {
        let mut log = log();
        let [low, high] = object.to_le_bytes();
        log.retain(|(_, traffic)| match traffic {
            Traffic::Drive(_, frame) => frame[9..11] != [low, high],
            Traffic::Lidar(_) => true,
        });
        let (live, replayed, _) = both(&log, &config);
        assert_alike(&live, &replayed, &format!("without {object:x}"));
    }
}
