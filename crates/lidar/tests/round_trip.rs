//! Packets of the simulated sensor decode to firings that encode to the same packets, and every
//! laser's azimuth is that of the rotor when it fired.
//!
//! The packets come from `firmware-sim`, which implements the manual without code of this crate.

use firmware_sim::vlp16::{DataPacketBuilder, LASERS, PacketModel, ReturnMode};
use lidar::{Decoder, Duplicates, Firing, Options, ReturnKind};
use proptest::prelude::*;
use units::{Host, Lidar, Stamp};

const FIRING_NS: i64 = 55_296;
const HOUR_NS: i64 = 3_600_000_000_000;
const HOURS: i64 = 472_222;
const PACKETS: usize = 6;

/// A sensor at constant speed.
#[derive(Clone, Copy, Debug)]
struct Rotor {
    rpm: f64,
    start_deg: f64,
    /// Device time of the first firing, whole microseconds.
    begin_ns: i64,
}

impl Rotor {
    fn azimuth_deg(&self, ns: i64) -> f64 {
        let turned = (ns - self.begin_ns) as f64 * 1e-9 * self.rpm * 6.0;
        (self.start_deg + turned).rem_euclid(360.0)
    }

    fn azimuth_cdeg(&self, ns: i64) -> u16 {
        ((self.azimuth_deg(ns) * 100.0).round() as u16) % 36_000
    }
}

/// Returns of firings: the only one of each laser, or the last and the strongest.
type Shots = Vec<(Returns, Returns)>;
/// Distance in units of 2 mm (0 for no return) and reflectivity of each laser.
type Returns = [(u16, u8); LASERS];

/// Packets with their completion times.
fn build(rotor: Rotor, dual: bool, shots: &Shots) -> Vec<(i64, Vec<u8>)> {
    let a_packet = if dual { 12 } else { 24 };
    shots
        .chunks(a_packet)
        .enumerate()
        .map(|(n, shots)| {
            let first_ns = rotor.begin_ns + (n * a_packet) as i64 * FIRING_NS;
            let times = (0..).map(|i| first_ns + i * FIRING_NS);
            let azimuths = times.map(|ns| rotor.azimuth_cdeg(ns));
            let us = (first_ns / 1_000).rem_euclid(HOUR_NS / 1_000) as u32;
            let bytes = packet(dual, azimuths, shots, us);
            (first_ns + a_packet as i64 * FIRING_NS, bytes)
        })
        .collect()
}

fn packet(
    dual: bool,
    azimuths: impl Iterator<Item = u16>,
    shots: &[(Returns, Returns)],
    us: u32,
) -> Vec<u8> {
    let mode = if dual {
        ReturnMode::Dual
    } else {
        ReturnMode::Strongest
    };
    let mut builder = DataPacketBuilder::new(PacketModel::Vlp16, mode);
    for (azimuth, (last, strongest)) in azimuths.zip(shots) {
        builder.firing(azimuth, last, strongest);
    }
    builder.finish(us).to_vec()
}

/// Start, azimuth and returns of each firing.
#[derive(Debug, Default)]
struct Taken {
    starts: Vec<Stamp<Lidar>>,
    azimuths: Vec<f64>,
    shots: Shots,
}

impl Taken {
    fn firing(&mut self, firing: &Firing<'_>) {
        self.starts.push(firing.start);
        self.azimuths.push(firing.azimuth_deg);
        let (mut last, mut strongest) = ([(0, 0); LASERS], [(0, 0); LASERS]);
        for seen in firing.returns() {
            let laser = usize::from(seen.laser);
            let second = match seen.echo {
                ReturnKind::StrongestOrSecond => true,
                // With all returns requested both of a pair are given, the last first.
                ReturnKind::LastAndStrongest => last[laser].0 != 0,
                ReturnKind::Strongest | ReturnKind::Last | ReturnKind::Unknown => false,
            };
            let place = if second { &mut strongest } else { &mut last };
            place[laser] = (seen.distance_raw, seen.reflectivity);
        }
        self.shots.push((last, strongest));
    }

    fn rebuild(&self, dual: bool) -> Vec<Vec<u8>> {
        let a_packet = if dual { 12 } else { 24 };
        let starts = self.starts.chunks(a_packet);
        let azimuths = self.azimuths.chunks(a_packet);
        let packets = starts.zip(azimuths).zip(self.shots.chunks(a_packet));
        packets
            .map(|((starts, azimuths), shots)| {
                let us = (starts[0].as_nanos() / 1_000).rem_euclid(HOUR_NS / 1_000);
                let cdeg = azimuths.iter().map(|a| (a * 100.0).round() as u16 % 36_000);
                packet(dual, cdeg, shots, us as u32)
            })
            .collect()
    }
}

/// A distance and a reflectivity, or no return.
fn any_return() -> impl Strategy<Value = (u16, u8)> {
    prop_oneof![
        1 => Just((0, 0)),
        3 => (1..=u16::MAX, any::<u8>()),
        // Few distances, so that pairs are often equal.
        1 => (1u16..3, any::<u8>()),
    ]
}

fn any_shots() -> impl Strategy<Value = Shots> {
    let returns = || prop::array::uniform16(any_return());
    prop::collection::vec((returns(), returns()), 24 * PACKETS)
}

prop_compose! {
    fn any_rotor()(
        rpm in 300.0..1_200.0,
        start_deg in 0.0..360.0,
        // Just before the hour, or anywhere in it.
        before_us in prop_oneof![0i64..10_000, 0..3_600_000_000i64],
    ) -> Rotor {
        Rotor { rpm, start_deg, begin_ns: HOURS * HOUR_NS - before_us * 1_000 }
    }
}

fn decode(packets: &[(i64, Vec<u8>)], each: &mut impl FnMut(&Firing<'_>)) {
    let options = Options {
        duplicates: Duplicates::All,
        ..Options::default()
    };
    let mut decoder = Decoder::new(options);
    for (complete_ns, bytes) in packets {
        let host = Stamp::<Host>::from_nanos(complete_ns + 150_000);
        decoder.packet(host, bytes, each);
    }
    decoder.finish(each);
    assert_eq!(decoder.stats().lost_packets, 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn packets_round_trip_through_firings(
        rotor in any_rotor(), dual: bool, shots in any_shots(),
    ) {
        let packets = build(rotor, dual, &shots);
        let mut taken = Taken::default();
        decode(&packets, &mut |firing| taken.firing(firing));
        let again = taken.rebuild(dual);
        prop_assert_eq!(again.len(), packets.len());
        for (n, ((_, bytes), again)) in packets.iter().zip(&again).enumerate() {
            prop_assert!(bytes == again, "packet {}", n);
        }
    }

    /// Azimuths in hundredths of a degree are off by at most half of one, and so are interpolated
    /// ones.
    #[test]
    fn azimuths_are_exact_to_half_a_hundredth(
        rotor in any_rotor(), dual: bool, shots in any_shots(),
    ) {
        let packets = build(rotor, dual, &shots);
        let a_packet = if dual { 12 } else { 24 };
        let with_successor = (packets.len() - 1) * a_packet;
        let (mut seen, mut worst_deg, mut worst_last_deg) = (0, 0.0_f64, 0.0_f64);
        decode(&packets, &mut |firing| {
            for laser in 0..LASERS as u8 {
                let delay_ns = 2_304 * i64::from(laser);
                let start_ns = rotor.begin_ns + seen as i64 * FIRING_NS;
                // Device time is in whole microseconds.
                assert!((firing.start.as_nanos() - start_ns).abs() < 1_000);
                let apart = firing.laser_azimuth_deg(laser).unwrap() - rotor.azimuth_deg(start_ns + delay_ns);
                let apart = apart.rem_euclid(360.0);
                let apart = apart.min(360.0 - apart);
                if seen < with_successor {
                    worst_deg = worst_deg.max(apart);
                } else {
                    worst_last_deg = worst_last_deg.max(apart);
                }
            }
            seen += 1;
        });
        prop_assert!(worst_deg <= 0.005 + 1e-9, "{} deg", worst_deg);
        // Without a successor, the packet's rate extends from its last block.
        prop_assert!(worst_last_deg <= 0.0075, "{} deg", worst_last_deg);
        prop_assert_eq!(seen, packets.len() * a_packet);
    }
}
