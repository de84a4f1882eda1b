//! The lidar as a device: when its packets leave, and what is in them.
//!
//! A data packet leaves when its 24th sequence has ended; after every fifth comes a position packet, about as often as real
//! sensors send one. Left out: dual return, GPS, limited field of view.

use firmware_sim::vlp16::{
    DATA_LEN, DISTANCE_UNIT_MM, DataPacketBuilder, LASERS, POSITION_LEN, PacketModel, Pps,
    ReturnMode, SEQUENCES, position_packet,
};
use units::{Host, Stamp};

use crate::shaft::Shaft;
use crate::world::{World, elapsed};

/// Data packets from one position packet to the next.
const DATA_PER_POSITION: u64 = 5;

/// The lidar between two of its packets.
#[derive(Clone, Debug)]
pub(crate) struct Spinning {
    builder: DataPacketBuilder,
    packets: u64,
}

impl Default for Spinning {
    fn default() -> Self {
        Self {
            builder: DataPacketBuilder::new(PacketModel::Vlp16, ReturnMode::Strongest),
            packets: 0,
        }
    }
}

impl Spinning {
    /// When the next data packet leaves.
    pub fn release(&self, world: &World) -> Stamp<Host> {
        world.fired_at(self.sequence().saturating_add(SEQUENCES as i64), 0)
    }

    /// The next data packet. The motion of the shaft has to be known up to its release; firings beyond have no return.
    pub fn data_packet(&mut self, world: &World, shaft: &Shaft) -> [u8; DATA_LEN] {
        let first = self.sequence();
        for sequence in first..first.saturating_add(SEQUENCES as i64) {
            let azimuth_cdeg = world.spin.azimuth_cdeg(elapsed(sequence, 0));
            let mut returns = [(0, 0); LASERS];
            for (laser, slot) in returns.iter_mut().enumerate() {
                if let Some(found) = world.fire(shaft, sequence, laser) {
                    *slot = (distance_raw(found.hit.range_m), found.hit.reflectivity);
                }
            }
            self.builder.firing(azimuth_cdeg, &returns, &[]);
        }
        self.packets += 1;
        self.builder.finish(world.clock.stamp_us(elapsed(first, 0)))
    }

    /// The position packet that leaves behind the last data packet, if one does.
    pub fn position_packet(&self, world: &World) -> Option<[u8; POSITION_LEN]> {
        let due = self.packets > 0 && self.packets.is_multiple_of(DATA_PER_POSITION);
        let now = world.clock.stamp_us(elapsed(self.sequence(), 0));
        due.then(|| position_packet(now, Pps::Absent, &[]))
    }

    /// The first sequence of the next packet.
    fn sequence(&self) -> i64 {
        i64::try_from(self.packets)
            .unwrap_or(i64::MAX)
            .saturating_mul(SEQUENCES as i64)
    }
}

/// The nearest whole units of 2 mm; ranges that fit are all there are (100 m is 50,000 units).
fn distance_raw(range_m: f64) -> u16 {
    (range_m * (1_000.0 / f64::from(DISTANCE_UNIT_MM))).round() as u16
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;
    use units::{Degrees, Gearing, Metres};

    use super::*;
    use crate::cast::{Object, Sphere};
    use crate::clock::{HOUR_NS, LidarClock};
    use crate::head::LASERS as TABLE;
    use crate::scene::Scene;
    use crate::scenes;
    use crate::truth::Truth;
    use crate::world::Spin;

    const START: Stamp<Host> = Stamp::from_nanos(1_790_000_000_000_000_000);
    const QC: i64 = 1 << 32;

    fn world(scene: Scene, at_start_us: u32, drift_ppm: f64) -> World {
        let spin = Spin {
            rpm: 600,
            at_start: Degrees(200.0),
        };
        let clock = LidarClock::new(START, at_start_us, drift_ppm);
        World::new(Arc::new(scene), Metres(0.06), clock, spin)
    }

    /// A shaft that runs from -45 deg at 56.25 deg/s (1125 rpm: 37.5 quadcounts a millisecond) for `ms` milliseconds.
    fn sweep(ms: i64) -> Shaft {
        let gearing = Gearing::new(500, 120, 1).unwrap();
        let mut shaft = Shaft::new(START, gearing, -30_000 * QC);
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

    /// One return, read off the packet as the manual describes it; the azimuth rate is known.
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
                device_ns: i64::from(stamp_us(packet)) * 1_000
                    + 110_592 * block as i64
                    + in_block_ns,
                laser: channel % 16,
                azimuth: Degrees(azimuth_deg + 3_600.0 * 1e-9 * in_block_ns as f64),
                range_m: f64::from(raw) * 0.002,
            });
        }
        all
    }

    #[test]
    fn the_truth_is_what_the_packets_say_within_what_the_wire_rounds_off() {
        let (ms, drift_ppm) = (800, 50.0);
        let world = world(scenes::hall(), 3_599_700_000, drift_ppm);
        let (shaft, mut lidar) = (sweep(ms), Spinning::default());
        let truth = Truth::new(world.clone(), shaft.clone());
        let (mut compared, mut worst) = (0, 0.0_f64);
        while lidar.release(&world) < shaft.end() {
            for found in decode(&lidar.data_packet(&world, &shaft)) {
                let host = truth.lidar_to_host(found.device_ns);
                let tilt = Degrees(truth.tilt_deg_at(host).unwrap());
                let (origin, direction) =
                    world.head.beam(found.laser, found.azimuth, tilt).unwrap();
                let seen = origin + found.range_m * direction;
                let point = truth.point(found.device_ns, found.laser as u8).unwrap();
                let error = seen.distance(DVec3::from_array(point));
                // 1 mm of range; 0.005 deg of azimuth, as far as the beam is level; 1 us at 56.25 deg/s.
                let level = TABLE[found.laser].elevation.to_radians().0.cos();
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
        // 602 packets fit 0.8 s, and the bound is reached: neither the stamps nor the angles are better than they claim.
        assert_eq!(compared, 602 * 384);
        assert!(worst > 0.0017, "{worst}");
    }

    #[test]
    fn stamps_count_in_the_lidars_own_time_and_wrap_at_the_hour() {
        let world = world(scenes::hall(), 3_599_999_000, -40.0);
        let (shaft, mut lidar) = (sweep(20), Spinning::default());
        let stamps: Vec<u32> = (0..5)
            .map(|_| stamp_us(&lidar.data_packet(&world, &shaft)))
            .collect();
        // 1327.104 us a packet, cut off to whole microseconds.
        assert_eq!(stamps, [3_599_999_000, 327, 1_654, 2_981, 4_308]);
        // Five packets end after 6.63552 ms of the lidar's time, which a slow lidar reaches 265 ns late.
        assert_eq!(
            Spinning::default().release(&world).as_nanos() - START.as_nanos(),
            1_327_157
        );
        assert_eq!(
            world.clock.host(5 * 1_327_104).as_nanos() - START.as_nanos(),
            6_635_785
        );
    }

    #[test]
    fn a_position_packet_follows_every_fifth_with_the_time_of_leaving() {
        let world = world(Scene::new(), 7, 0.0);
        let (shaft, mut lidar) = (sweep(20), Spinning::default());
        let mut position = Vec::new();
        for packet in 1..=10 {
            assert!(
                lidar.data_packet(&world, &shaft)[4..100]
                    .iter()
                    .all(|&byte| byte == 0)
            );
            position.extend(lidar.position_packet(&world).map(|bytes| (packet, bytes)));
        }
        let [(5, first), (10, second)] = position.as_slice() else {
            panic!("{} position packets", position.len());
        };
        assert_eq!(first[198..202], 6_642_u32.to_le_bytes());
        assert_eq!(second[198..202], 13_278_u32.to_le_bytes());
        assert!(first[202..].iter().all(|&byte| byte == 0));
        assert!(Spinning::default().position_packet(&world).is_none());
    }

    #[test]
    fn too_near_and_too_far_do_not_return() {
        let raw = |radius_m| {
            let scene = Scene::new()
                .with(Object::new(Sphere { radius_m }), 9)
                .unwrap();
            let world = world(scene, 0, 0.0);
            let packet = Spinning::default().data_packet(&world, &sweep(2));
            // Laser 14 at -1 deg, 0.7 mm above the head's origin, 60 mm above the centre.
            word(&packet, 4 + 3 * 14)
        };
        assert_eq!(raw(0.99), 0);
        assert_eq!(raw(1.01), 505);
        assert_eq!(raw(99.99), 49_996);
        assert_eq!(raw(100.2), 0);
    }

    #[test]
    fn truth_beyond_the_run_or_the_lasers_is_none() {
        let world = world(scenes::hall(), 0, 0.0);
        let truth = Truth::new(world, sweep(10));
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
        // Between two firings of a laser the nearer one is meant.
        let at = |ns: i64| truth.point(ns, 0);
        assert_eq!(at(27_000), at(0));
        assert_eq!(at(28_000), at(55_296));
        assert_ne!(at(0), at(55_296));
        assert_eq!(truth.tilt_deg_at(START), Some(-45.0));
        assert_eq!(truth.tilt_deg_at(truth.end()), None);
    }
}
