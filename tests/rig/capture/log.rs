//! The log that the program would have written.

use std::f64::consts::TAU;
use std::path::Path;

use io::files::Overwrite;
use io::log::{LogConfig, LogWriter};
use protocol::record::{Direction, DriveLink, Record, Wire};
use scanner::ScanConfig;
use units::{Host, Span, Stamp};

use crate::port::Arrived;
use crate::random::Random;

/// A record that owns its bytes.
#[derive(Clone, Debug)]
pub(super) struct Owned {
    pub(super) host: Stamp<Host>,
    pub(super) link: DriveLink,
    pub(super) direction: Direction,
    pub(super) frame: Vec<u8>,
}

/// Stamps the packets after `from` with a clock that was set forward by `by`.
pub(super) fn set_lidar(packets: &mut [Arrived], from: Stamp<Host>, by: Span) {
    let data = packets
        .iter_mut()
        .filter(|p| p.host >= from && p.datagram.port == sim::DATA_PORT);
    for packet in data {
        let stamp: &mut [u8] = &mut packet.datagram.payload[1_200..1_204];
        let us = i64::from(u32::from_le_bytes(stamp.try_into().unwrap()));
        let set = (us + by.as_nanos() / 1_000).rem_euclid(3_600_000_000) as u32;
        stamp.copy_from_slice(&set.to_le_bytes());
    }
}

/// Adds normal noise to all ranges, of this standard deviation with their steps of 2 mm, to which
/// they are rounded before and after.
pub(super) fn add_noise(packets: &mut [Arrived], range_sd_m: f64, seed: u64) {
    const STEP_M: f64 = 0.002;
    let mut random = Random(seed);
    let mut uniform = || (random.below(1 << 53) as f64 + 0.5) / (1_u64 << 53) as f64;
    let noise_m = (range_sd_m * range_sd_m - STEP_M * STEP_M / 6.0).sqrt();
    let data = packets.iter_mut();
    let data = data.filter(|packet| packet.datagram.port == sim::DATA_PORT);
    for packet in data {
        for block in packet.datagram.payload[..1_200].chunks_exact_mut(100) {
            for channel in block[4..].chunks_exact_mut(3) {
                let steps = u16::from_le_bytes([channel[0], channel[1]]);
                // Box and Muller, 1958.
                let normal = (-2.0 * uniform().ln()).sqrt() * (TAU * uniform()).cos();
                let noisy = f64::from(steps) + normal * noise_m / STEP_M;
                // Without a return the range is 0.
                if steps > 0 {
                    channel[..2].copy_from_slice(&(noisy.round().max(1.0) as u16).to_le_bytes());
                }
            }
        }
    }
}

/// Writes the records of both devices in order of arrival and returns their number. After a given
/// instant the stamps may be those of a clock that was set.
pub(super) fn write_log(
    path: &Path,
    config: &ScanConfig,
    link: DriveLink,
    drive: &[Owned],
    packets: &[Arrived],
    set: Option<(Stamp<Host>, Span)>,
) -> usize {
    let drive = drive.iter().map(|owned| Record {
        host: owned.host,
        wire: Wire::Drive {
            link: owned.link,
            direction: owned.direction,
            frame: &owned.frame,
        },
    });
    let lidar = packets.iter().map(|arrived| Record {
        host: arrived.host,
        wire: Wire::Lidar {
            source: [192, 168, 1, 201],
            port: arrived.datagram.port,
            payload: &arrived.datagram.payload,
        },
    });
    let mut records: Vec<Record<'_>> = drive.chain(lidar).collect();
    records.sort_by_key(|record| record.host);
    if let Some((from, by)) = set {
        for record in records.iter_mut().filter(|record| record.host >= from) {
            record.host += by;
        }
    }
    let head = LogConfig {
        metadata: toml::to_string(config).unwrap(),
        drive: Some(link),
    };
    let mut writer = LogWriter::create(path, &head, Overwrite::Refuse).unwrap();
    for record in &records {
        writer.write(record).unwrap();
    }
    writer.finish().unwrap();
    records.len()
}
