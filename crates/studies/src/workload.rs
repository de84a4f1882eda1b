//! Workload of studies: the packets of a VLP-16 during a sweep, equal on every machine.
//!
//! 10 revolutions per second, one return per firing and laser, distances by the study. Packets
//! arrive as soon as they are full; [`crate::clocks`] studies delays.

use crate::placing::{LASERS, LaserGeometry, PlainFiring, SensorGeometry};
use analysis::tradeoff::{Bench, StudyError};
use drive::record::{Record, Wire};
use firmware_sim::vlp16::{DATA_PORT, DataPacketBuilder, PacketModel, ReturnMode};
use lidar::{Decoder, Options};
use protocol::vlp16::models::VLP_16;
use scanner::{Accuracy, Alignment, AngleTable, ScanConfig, Survey, TiltSource};
use units::{Host, Span, Stamp};

/// 10 revolutions per second, in degrees per nanosecond.
const AZIMUTH_DEG_NS: f64 = 3_600e-9;
/// A full hour of a day of 2023, on which lidar and host agree.
const START: Stamp<Host> = Stamp::from_nanos(1_700_002_800_000_000_000);
/// Firings per packet.
const FIRINGS: u64 = 24;

/// The tilt angle in degrees, by seconds after the first firing, also negative.
pub(crate) type Tilt = fn(f64) -> f64;

/// A laser's shot, to be answered with a distance in counts (0 for none) and a reflectivity.
pub(crate) struct SimulatedShot {
    pub laser: usize,
    pub azimuth_deg: f64,
    pub tilt_deg: f64,
}

/// Packets of a tilting lidar.
pub(crate) struct Workload {
    tilt_deg: Tilt,
    seconds: f64,
    packets: Vec<(Stamp<Host>, [u8; protocol::vlp16::DATA_LEN])>,
}

impl Workload {
    /// Packets of `seconds` of a tilt; the last one is full.
    pub fn new(
        tilt_deg: Tilt,
        seconds: f64,
        mut answer: impl FnMut(&SimulatedShot) -> (u16, u8),
    ) -> Self {
        let firing_ns = u64::from(VLP_16.firing_period_ns);
        let count = (seconds * 1e9 / (firing_ns * FIRINGS) as f64).ceil() as u64;
        let mut builder = DataPacketBuilder::new(PacketModel::Vlp16, ReturnMode::Strongest);
        let mut packets = Vec::new();
        for packet in 0..count {
            let first_ns = packet * FIRINGS * firing_ns;
            for firing in 0..FIRINGS {
                let start_ns = first_ns + firing * firing_ns;
                let returns: [_; 16] = std::array::from_fn(|laser| {
                    let delay = VLP_16.lasers.get(laser).map_or(0, |l| l.delay_ns);
                    let t_ns = (start_ns + u64::from(delay)) as f64;
                    answer(&SimulatedShot {
                        laser,
                        azimuth_deg: (t_ns * AZIMUTH_DEG_NS) % 360.0,
                        tilt_deg: tilt_deg(t_ns * 1e-9),
                    })
                });
                let azimuth_deg = (start_ns as f64 * AZIMUTH_DEG_NS) % 360.0;
                let azimuth_cdeg = (azimuth_deg * 100.0).round() as u16 % 36_000;
                builder.firing(azimuth_cdeg, &returns, &[]);
            }
            let payload = builder.finish((first_ns / 1_000) as u32);
            let full = (first_ns + FIRINGS * firing_ns) as i64;
            packets.push((START.saturating_add(Span::from_nanos(full)), payload));
        }
        Self {
            tilt_deg,
            seconds,
            packets,
        }
    }

    /// The packets as records of a log.
    pub fn records(&self) -> impl Iterator<Item = Record<'_>> {
        self.packets.iter().map(|(host, payload)| Record {
            host: *host,
            wire: Wire::Lidar {
                source: [127, 0, 0, 1],
                port: DATA_PORT,
                payload,
            },
        })
    }

    /// Clock and angles as in a scan, with an angle every millisecond.
    pub fn alignment(&self) -> Result<Alignment, StudyError> {
        let config = ScanConfig::default();
        let mut survey = Survey::new(&config, Options::default()).map_err(StudyError::workload)?;
        for record in self.records() {
            survey.observe(&record);
        }
        let times = (0..).map(|i| f64::from(i) * 1e-3 - 0.1);
        let rows = times
            .take_while(|t| *t < self.seconds + 0.1)
            .map(|t| (t, (self.tilt_deg)(t)));
        let table = AngleTable::new(rows.collect()).map_err(StudyError::workload)?;
        survey
            .solve(&config, &TiltSource::Table(table), Accuracy::Best)
            .map_err(StudyError::workload)
    }

    /// The firings with their angles from decoder and alignment.
    pub fn firings_with_angles(&self, alignment: &Alignment) -> Vec<PlainFiring> {
        let length = Span::from_nanos(i64::from(VLP_16.firing_period_ns));
        let mut shots = Vec::new();
        let mut each = |firing: &lidar::Firing<'_>| {
            let tilt = |at| alignment.trajectory.angle(alignment.clock.moment(at));
            let (Some(from), Some(to)) = (tilt(firing.start), tilt(firing.start + length)) else {
                return;
            };
            let mut counts = [0; LASERS];
            for seen in firing.returns() {
                if let Some(count) = counts.get_mut(usize::from(seen.laser)) {
                    *count = seen.distance_raw;
                }
            }
            shots.push(PlainFiring {
                azimuth_deg: firing.azimuth_deg,
                azimuth_deg_ns: firing.azimuth_rate_deg_s * 1e-9,
                tilt_deg: from.0,
                tilt_deg_ns: (to.0 - from.0) / length.as_nanos() as f64,
                counts,
            });
        };
        self.firings(&mut each);
        shots
    }

    /// Decodes the packets.
    pub fn firings(&self, each: &mut impl FnMut(&lidar::Firing<'_>)) {
        let mut decoder = Decoder::new(Options::default());
        for (host, payload) in &self.packets {
            decoder.packet(*host, payload, each);
        }
        decoder.finish(each);
    }
}

/// The VLP-16 at the height of the configuration's mount.
pub(crate) fn head() -> SensorGeometry {
    let beam = |i: usize| {
        VLP_16
            .lasers
            .get(i)
            .map_or(LaserGeometry::default(), |laser| LaserGeometry {
                elevation_deg: laser.elevation_deg,
                rise_m: laser.vertical_offset_m,
                delay_ns: f64::from(laser.delay_ns),
            })
    };
    SensorGeometry {
        beams: std::array::from_fn(beam),
        unit_m: VLP_16.distance_unit_m,
        d_m: ScanConfig::default().mount.d_m,
    }
}

/// The cruise of the paper's fast scan, 56.25 deg/s. Without ramps, a line is exact between samples
/// too.
pub(crate) fn cruise_deg(t_s: f64) -> f64 {
    -56.25 * t_s
}

/// The duration of 45 degrees, or less with quick effort.
pub(crate) fn cruise_s(bench: &Bench<'_>) -> f64 {
    bench.pick(0.2, 0.8)
}

/// A surface at `range_m` in every direction.
pub(crate) fn all_at(range_m: f64) -> impl FnMut(&SimulatedShot) -> (u16, u8) {
    let count = (range_m / VLP_16.distance_unit_m) as u16;
    move |_| (count, 40)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tilt_is_recovered_from_the_packets() {
        let workload = Workload::new(cruise_deg, 0.3, all_at(100.0));
        let alignment = workload.alignment().unwrap();
        let shots = workload.firings_with_angles(&alignment);
        // 0.3 s in packets of 24 x 55.296 us, the last one full.
        assert_eq!(shots.len(), 227 * 24);
        for (i, shot) in shots.iter().enumerate() {
            let t = i as f64 * 55.296e-6;
            assert_eq!(shot.counts, [50_000; LASERS]);
            // Packets have times in whole microseconds.
            let tilt = cruise_deg(t);
            assert!((shot.tilt_deg - tilt).abs() < 1e-4, "{i}: {shot:?} {tilt}");
            assert!(
                (shot.tilt_deg_ns * 1e9 + 56.25).abs() < 0.01,
                "{i}: {shot:?}"
            );
            let azimuth = (t * 3_600.0) % 360.0;
            let off = (shot.azimuth_deg - azimuth + 180.0).rem_euclid(360.0) - 180.0;
            assert!(off.abs() < 0.011, "{i}: {shot:?} {azimuth}");
        }
    }
}
