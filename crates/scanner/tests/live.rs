//! The live cloud equals a replay of the same records, up to the errors of the streaming clock and
//! trajectory.

use std::collections::HashMap;

use cloud::{Fields, Point, Points};
use drive::record::{Direction, DriveLink, Record, Wire};
use lidar::Options;
use scanner::trajectory::Method;
use scanner::{Accuracy, Live, ScanConfig, TiltSource};
use units::{Host, Stamp};

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

enum Traffic {
    Lidar(Vec<u8>),
    Drive(Direction, [u8; 16]),
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
        Traffic::Drive(Direction::ToDevice, can(0x601, request)),
    ));
    log.push((
        at[1],
        Traffic::Drive(Direction::FromDevice, can(0x581, answer)),
    ));
}

fn packet(n: i64) -> Vec<u8> {
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
    bytes.extend(((n * PACKET_NS / 1_000) as u32).to_le_bytes());
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

#[test]
fn live_points_equal_those_of_a_replay() {
    let log = log();
    let config = ScanConfig::default();
    let mut live = Points::new(Fields::ALL);
    let mut placer = Live::new(&config, Options::default(), &mut live).unwrap();
    for entry in &log {
        placer.observe(&record(entry)).unwrap();
    }
    let (counts, _) = placer.finish().unwrap();
    assert_eq!(counts.points, live.len() as u64);

    let records = || log.iter().map(record);
    let accuracy = Accuracy::By(Method::Linear);
    let alignment = scanner::align(
        records(),
        &config,
        Options::default(),
        &TiltSource::Log,
        accuracy,
    )
    .unwrap();
    assert_eq!(alignment.sweeps.len(), 1);
    let mut replayed = Points::new(Fields::ALL);
    scanner::place(records(), &alignment, Options::default(), &mut replayed).unwrap();

    assert!(replayed.len() > 200_000);
    let key = |point: &Point| (point.device_time, point.laser);
    let by_firing: HashMap<_, Point> = replayed.iter().map(|point| (key(&point), point)).collect();
    let mut common = 0;
    for point in live.iter() {
        let Some(other) = by_firing.get(&key(&point)) else {
            continue;
        };
        common += 1;
        let same = |p: &Point| (p.intensity, p.ring, p.echo);
        assert_eq!(same(&point), same(other));
        // The jitter of the packets is 20 us, at 56.25 deg/s 0.0011 deg; half of a count is
        // 0.00075.
        assert!(
            (point.time - other.time).as_nanos().abs() < 25_000,
            "{point:?} {other:?}"
        );
        assert!(
            (point.tilt.0 - other.tilt.0).abs() < 0.003,
            "{point:?} {other:?}"
        );
        for (a, b) in point.position_m.iter().zip(other.position_m) {
            assert!((a - b).abs() < 0.6e-3, "{point:?} {other:?}");
        }
    }
    let share = |points: &Points| f64::from(common) / points.len() as f64;
    assert!(
        share(&live) > 0.99 && share(&replayed) > 0.99,
        "{} {}",
        share(&live),
        share(&replayed)
    );
}
