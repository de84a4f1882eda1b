//! Packets and truth of the rig's lidar, decoded by the manual.

use glam::DVec3;

use super::*;
use crate::cast::{Object, Sphere};
use crate::lidar_clock::HOUR_NS;
use crate::packet_maker::SimulatedPacket;

const START: Stamp<Host> = Stamp::from_nanos(1_790_000_000_000_000_000);
const QC: i64 = 1 << 32;

fn lidar(at_start_us: u32, drift_ppm: f64) -> SimulatedLidar {
    SimulatedLidar::new(
        LidarSensor::vlp16(),
        ReturnMode::Strongest,
        HeadRotation {
            rpm: 600,
            start_deg: 200.0,
        },
        LidarMount::above(0.06),
        START,
        LidarClock::new(START, at_start_us, drift_ppm),
    )
}

/// A lidar in a scene behind a known motion of the shaft, without the drive.
struct Device {
    lidar: SimulatedLidar,
    surroundings: Surroundings,
    maker: PacketMaker<RigEffects>,
    shaft: ShaftCourse,
    packets: u64,
}

impl Device {
    fn new(scene: Scene, lidar: SimulatedLidar, shaft: ShaftCourse) -> Self {
        let surroundings = Surroundings::new(Arc::new(scene), lidar.sensor.range(), true);
        let effects = FiringEffectSet {
            objects: (),
            view: (),
            beam: (),
            surface: (),
            clock: lidar.clock.clone(),
        };
        Self {
            maker: PacketMaker::new(&lidar, effects, surroundings.clone()),
            lidar,
            surroundings,
            shaft,
            packets: 0,
        }
    }

    fn packet(&mut self) -> SimulatedPacket {
        let blocks = 12 * self.packets..12 * (self.packets + 1);
        self.packets += 1;
        (self.maker).packet(&self.lidar, &self.shaft, blocks, None)
    }

    fn truth(&self) -> Truth {
        Truth::new(
            self.lidar.clone(),
            self.surroundings.clone(),
            self.shaft.clone(),
        )
    }
}

/// A shaft that runs from -45 deg at 56.25 deg/s (1125 rpm: 37.5 quadcounts per millisecond) for
/// `ms` milliseconds.
fn sweep(ms: i64) -> ShaftCourse {
    let mut shaft = ShaftCourse::new(GEARING, -30_000 * QC, None);
    for k in 1..=ms {
        shaft.push(-30_000 * QC + k * (37 * QC + QC / 2));
    }
    shaft
}

fn word(packet: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([packet[at], packet[at + 1]])
}

fn stamp_us(packet: &[u8]) -> u32 {
    u32::from_le_bytes(packet[1200..1204].try_into().unwrap())
}

/// A return decoded from the packet by the manual; the azimuth rate is known.
struct Decoded {
    device_ns: i64,
    laser: usize,
    azimuth: Degrees,
    range_m: f64,
}

fn decode(packet: &[u8]) -> Vec<Decoded> {
    let mut all = Vec::new();
    for (block, channel) in (0..12).flat_map(|b| (0..32).map(move |c| (b, c))) {
        let raw = word(packet, 100 * block + 4 + 3 * channel);
        let in_block_ns = (55_296 * (channel / 16) + 2_304 * (channel % 16)) as i64;
        let azimuth_deg = f64::from(word(packet, 100 * block + 2)) / 100.0;
        all.push(Decoded {
            device_ns: i64::from(stamp_us(packet)) * 1_000 + 110_592 * block as i64 + in_block_ns,
            laser: channel % 16,
            azimuth: Degrees(azimuth_deg + 3_600.0 * 1e-9 * in_block_ns as f64),
            range_m: f64::from(raw) * 0.002,
        });
    }
    all
}

#[test]
fn packets_agree_with_the_truth_within_their_rounding() {
    let (ms, drift_ppm) = (800, 50.0);
    let mut device = Device::new(Scene::hall(), lidar(3_599_700_000, drift_ppm), sweep(ms));
    let sensor = LidarSensor::vlp16();
    let truth = device.truth();
    let (mut compared, mut worst) = (0, 0.0_f64);
    loop {
        let packet = device.packet();
        if packet.leaves_ns >= device.shaft.end_ns() {
            break;
        }
        for found in decode(&packet.payload) {
            let host = truth.lidar_to_host(found.device_ns);
            let tilt_deg = truth.tilt_deg_at(host).unwrap();
            let (origin, direction) = sensor
                .ray(found.laser, found.azimuth.0, tilt_deg, &device.lidar.mount)
                .unwrap();
            let seen = origin + found.range_m * direction;
            let point = truth.point(found.device_ns, found.laser as u8).unwrap();
            let error = seen.distance(DVec3::from_array(point));
            // 1 mm of range; 0.005 deg of azimuth for level beams; 1 us at 56.25 deg/s.
            let level = sensor.beams[found.laser].elevation_deg.to_radians().cos();
            let across =
                found.range_m * (level * 0.005_f64.to_radians() + 56.25e-6_f64.to_radians());
            let bound = 0.001_f64.hypot(across) + 1e-9;
            assert!(
                error <= bound,
                "{error} m, bound {bound}, at {found_ns}",
                found_ns = found.device_ns
            );
            compared += 1;
            worst = worst.max(error);
        }
    }
    // 602 packets fit into 0.8 s, and errors reach the bound: it is tight.
    assert_eq!(compared, 602 * 384);
    assert!(worst > 0.0017, "{worst}");
}

#[test]
fn stamps_count_in_the_lidars_own_time_and_wrap_at_the_hour() {
    let mut device = Device::new(Scene::hall(), lidar(3_599_999_000, -40.0), sweep(20));
    let packets: Vec<SimulatedPacket> = (0..5).map(|_| device.packet()).collect();
    let stamps: Vec<u32> = packets.iter().map(|p| stamp_us(&p.payload)).collect();
    // 1327.104 us per packet, rounded down to whole microseconds.
    assert_eq!(stamps, [3_599_999_000, 327, 1_654, 2_981, 4_308]);
    // Five packets end after 6.63552 ms of lidar time, 265 ns later for a slow lidar.
    assert_eq!(packets[0].leaves_ns, 1_327_157);
    assert_eq!(packets[4].leaves_ns, 6_635_785);
}

#[test]
fn a_position_packet_follows_every_fifth_data_packet() {
    let mut device = Device::new(Scene::new(), lidar(7, 0.0), sweep(20));
    let mut position = Vec::new();
    for number in 1..=10 {
        let packet = device.packet();
        assert!(packet.payload[4..100].iter().all(|&byte| byte == 0));
        position.extend(packet.position_packet(number).map(|bytes| (number, bytes)));
    }
    let [(5, first), (10, second)] = position.as_slice() else {
        panic!("{} position packets", position.len());
    };
    assert_eq!(first[198..202], 6_642_u32.to_le_bytes());
    assert_eq!(second[198..202], 13_278_u32.to_le_bytes());
    assert!(first[202..].iter().all(|&byte| byte == 0));
}

#[test]
fn surfaces_out_of_range_do_not_return() {
    let raw = |radius_m| {
        let scene = Scene::new()
            .with(Object::new(Sphere { radius_m }), 9)
            .unwrap();
        let mut device = Device::new(scene, lidar(0, 0.0), sweep(2));
        // Laser 14 at -1 deg, 0.7 mm above the head's origin, 60 mm above the centre.
        word(&device.packet().payload, 4 + 3 * 14)
    };
    assert_eq!(raw(0.99), 0);
    assert_eq!(raw(1.01), 505);
    assert_eq!(raw(99.99), 49_996);
    assert_eq!(raw(100.2), 0);
}

#[test]
fn truth_outside_the_run_or_the_lasers_is_none() {
    let truth = Device::new(Scene::hall(), lidar(0, 0.0), sweep(10)).truth();
    assert_eq!(truth.end().as_nanos() - START.as_nanos(), 10_000_000);
    for (device_ns, laser, known) in [
        (0, 0, true),
        (-900, 0, true),
        (34_560, 15, true),
        (0, 16, false),
        (0, 255, false),
        (-100_000, 0, false),
        (10_010_000, 0, false),
        (HOUR_NS + 5_000_000, 3, true),
        (i64::MAX, 0, false),
    ] {
        assert_eq!(
            truth.point(device_ns, laser).is_some(),
            known,
            "{device_ns} {laser}"
        );
    }
    // Between two firings of a laser the nearer one applies.
    let at = |ns: i64| truth.point(ns, 0);
    assert_eq!(at(27_000), at(0));
    assert_eq!(at(28_000), at(55_296));
    assert_ne!(at(0), at(55_296));
    assert_eq!(truth.tilt_deg_at(START), Some(-45.0));
    assert_eq!(truth.tilt_deg_at(truth.end()), None);
}
