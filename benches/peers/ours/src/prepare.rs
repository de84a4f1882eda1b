//! A recording, and its parts in the form of the other libraries. All numbers little-endian.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use io::recording::{DatagramKind, Recording};
use lidar::{Decoder, Options};
use protocol::record::{Record, Wire};
use scanner::{AngleTable, TiltSource};
use units::{Host, Stamp};

/// Data packets with their host times, one after another in memory.
#[derive(Clone, Debug, Default)]
pub struct Packets {
    payloads: Vec<u8>,
    hosts: Vec<Stamp<Host>>,
}

/// Bytes of a data packet.
const LEN: usize = protocol::vlp16::DATA_LEN;

impl Packets {
    /// The packets in their order.
    pub fn records(&self) -> impl Iterator<Item = Record<'_>> {
        let payloads = self.payloads.chunks_exact(LEN);
        self.hosts
            .iter()
            .zip(payloads)
            .map(|(host, payload)| Record {
                host: *host,
                wire: Wire::Lidar {
                    source: [192, 168, 1, 201],
                    port: 2368,
                    payload,
                },
            })
    }

    /// The platform goes from 0 to -45 degrees and back at 56.25 deg/s, its angle known every
    /// millisecond.
    pub fn angles(&self) -> Vec<(f64, f64)> {
        let (from, to) = (self.hosts.iter().min(), self.hosts.iter().max());
        let seconds = (*to.expect("packets") - *from.expect("packets")).as_secs_f64();
        (0..)
            .map(|i| f64::from(i) * 1e-3 - 0.1)
            .take_while(|t| *t < seconds + 0.2)
            .map(|t| {
                let way = (t * 56.25).rem_euclid(90.0);
                (t, -(45.0 - (way - 45.0).abs()))
            })
            .collect()
    }

    /// Those angles as the product takes them.
    pub fn tilt(&self) -> TiltSource {
        TiltSource::Table(AngleTable::new(self.angles()).expect("angles in order"))
    }
}

/// The data packets of a recording.
pub fn packets(path: &Path) -> Packets {
    let mut recording = Recording::open(path).expect("a recording");
    let mut packets = Packets::default();
    while let Some(record) = recording.next_record().expect("a readable file") {
        if let Wire::Lidar { payload, .. } = record.wire
            && DatagramKind::of(payload) == DatagramKind::Data
        {
            packets.hosts.push(record.host);
            packets.payloads.extend_from_slice(payload);
        }
    }
    packets
}

/// Writes the parts and describes them as a JSON object.
///
/// - `packets.bin`: i64 host time in nanoseconds and 1206 bytes a packet.
/// - `points.bin`: 40 bytes per point in firing order: x, y, z in metres (sensor's frame; x right,
///   y forward) and device time in
///   seconds as f64, firing as u32 counted from the first, ring, reflectivity, laser, a zero byte.
/// - `angles.csv`: what `replay --tilt` takes.
pub fn prepare(packets: &Packets, folder: &Path) -> String {
    let mut raw = Vec::new();
    let mut points = Vec::new();
    let (mut firings, mut count) = (0_u32, 0_u64);
    let mut decoder = Decoder::new(Options::default());
    let mut each = |firing: &lidar::Firing<'_>| {
        for point in firing.points() {
            for value in point.position_m {
                points.extend_from_slice(&value.to_le_bytes());
            }
            let seconds = point.time.as_nanos() as f64 * 1e-9;
            points.extend_from_slice(&seconds.to_le_bytes());
            points.extend_from_slice(&firings.to_le_bytes());
            points.extend_from_slice(&[point.ring, point.reflectivity, point.laser, 0]);
            count += 1;
        }
        firings += 1;
    };
    for record in packets.records() {
        if let Wire::Lidar { payload, .. } = record.wire {
            raw.extend_from_slice(&record.host.as_nanos().to_le_bytes());
            raw.extend_from_slice(payload);
            decoder.packet(record.host, payload, &mut each);
        }
    }
    decoder.finish(&mut each);
    let mut angles = String::from("time_s,angle_deg\n");
    for (time_s, angle_deg) in packets.angles() {
        writeln!(angles, "{time_s:.6},{angle_deg:.9}").expect("a string");
    }
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).expect("a folder");
    write("packets.bin", &raw);
    write("points.bin", &points);
    write("angles.csv", angles.as_bytes());
    let stats = decoder.stats();
    let model = stats.model.expect("a known model");
    let mode = stats.return_mode.expect("a return mode").to_u8();
    let channels = packets.hosts.len() * 12 * 32;
    let conflict = !stats.conflicts.is_empty();
    format!(
        r#"{{"model":"{}","return_mode":{mode},"packets":{},"channels":{channels},"firings":{firings},"points":{count},"returns":{},"factory_bytes_wrong":{conflict}}}"#,
        model.name,
        packets.hosts.len(),
        stats.returns,
    )
}
