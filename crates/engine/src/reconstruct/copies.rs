//! Records that a file holds twice: a recorder has written a part of its buffer again, or a program
//! has joined two recordings of the same traffic.

use std::collections::{HashSet, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};

use protocol::record::{Record, Wire};
use protocol::vlp16::{DATA_LEN, DataPacket};

/// The newest records, and the number of those that came again.
#[derive(Debug, Default)]
pub(super) struct RecordCopies {
    packets: Recent,
    frames: Recent,
    /// The stamp of the newest record of the drive that is no copy.
    newest_frame_ns: Option<i64>,
    /// Whether the newest record to the drive is a copy.
    request_is_copy: bool,
    /// Data packets of a lidar that came again.
    pub doubled_packets: u64,
    /// Records of the drive that came again.
    pub doubled_frames: u64,
}

impl RecordCopies {
    /// Whether a record is a copy of one of these; else it becomes one.
    ///
    /// A lidar's data packets differ at least by their times, whatever stamp the recorder gives to
    /// a copy. Polls of a drive at rest are alike but for their stamps. Answers that have the same
    /// stamp, too, were late and were read at once, unless their requests are copies.
    pub fn has(&mut self, record: &Record<'_>) -> bool {
        let mut hasher = DefaultHasher::new();
        match record.wire {
            Wire::Lidar {
                source,
                port,
                payload,
            } => {
                let Ok(packet) = <&[u8; DATA_LEN]>::try_from(payload) else {
                    return false;
                };
                (source, port).hash(&mut hasher);
                // The time at the end and a quarter of the rest tell all apart, and are quick.
                let [.., a, b, c, d, e, f] = *packet;
                [a, b, c, d, e, f].hash(&mut hasher);
                for eight in packet.chunks_exact(8).step_by(4) {
                    hasher.write(eight);
                }
                let is_copy = self.packets.has(hasher.finish()) && DataPacket::new(packet).is_ok();
                self.doubled_packets += u64::from(is_copy);
                is_copy
            }
            Wire::Drive {
                direction, frame, ..
            } => {
                let is_to_device = direction == protocol::record::Direction::ToDrive;
                let ns = record.host.as_nanos();
                (ns, is_to_device, frame).hash(&mut hasher);
                let is_again = self.frames.has(hasher.finish());
                let is_earlier = self.newest_frame_ns.is_some_and(|newest| ns < newest);
                if !is_again {
                    self.newest_frame_ns = Some(ns);
                }
                let is_copy = is_again && (is_to_device || is_earlier || self.request_is_copy);
                if is_to_device {
                    self.request_is_copy = is_copy;
                }
                self.doubled_frames += u64::from(is_copy);
                is_copy
            }
        }
    }
}

/// Records remembered of the lidars and of the drive: those of eleven seconds of one lidar, of two
/// or more of a drive.
const MAX_RECENT: usize = 8192;

/// Hashes of the newest records.
#[derive(Debug, Default)]
struct Recent {
    hashes: HashSet<u64>,
    /// In order, the oldest first.
    order: VecDeque<u64>,
}

impl Recent {
    /// Whether it is one of these; else it becomes one.
    fn has(&mut self, hash: u64) -> bool {
        if !self.hashes.insert(hash) {
            return true;
        }
        self.order.push_back(hash);
        if self.order.len() > MAX_RECENT
            && let Some(oldest) = self.order.pop_front()
        {
            self.hashes.remove(&oldest);
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use protocol::record::{Direction, DriveLink};
    use protocol::vlp16::DATA_LEN;
    use units::Stamp;

    use super::*;

    /// The empty data packet of a VLP-16 at a time, microseconds of the hour.
    fn packet(us: u32) -> [u8; DATA_LEN] {
        let mut packet = [0; DATA_LEN];
        for block in packet[..1200].chunks_exact_mut(100) {
            block[..2].copy_from_slice(&[0xFF, 0xEE]);
        }
        packet[1200..1204].copy_from_slice(&us.to_le_bytes());
        packet[1204..].copy_from_slice(&[0x37, 0x22]);
        packet
    }

    fn lidar(ns: i64, payload: &[u8]) -> Record<'_> {
        Record {
            host: Stamp::from_nanos(ns),
            wire: Wire::Lidar {
                source: [192, 168, 1, 201],
                port: 2368,
                payload,
            },
        }
    }

    fn drive(ns: i64, direction: Direction, frame: &[u8]) -> Record<'_> {
        Record {
            host: Stamp::from_nanos(ns),
            wire: Wire::Drive {
                link: DriveLink::Usb,
                direction,
                frame,
            },
        }
    }

    /// A block of a recorder's buffer that is written again, with the same stamps or with others.
    #[test]
    fn packets_that_come_again_within_seconds_are_copies() {
        let mut copies = RecordCopies::default();
        let packets: Vec<[u8; DATA_LEN]> = (0..5_000).map(|i| packet(1_327 * i)).collect();
        for (i, packet) in (0..).zip(&packets) {
            assert!(!copies.has(&lidar(1_327_000 * i, packet)));
        }
        for (i, packet) in (9_000..).zip(&packets) {
            assert!(copies.has(&lidar(1_327_000 * i, packet)), "{i}");
        }
        assert_eq!(copies.doubled_packets, 5_000);
        // Another lidar may send the same; position packets repeat.
        let mut other = lidar(0, &packets[0]);
        let Wire::Lidar { port, .. } = &mut other.wire else {
            unreachable!()
        };
        *port = 2369;
        assert!(!copies.has(&other));
        let position = [0; 512];
        assert!(!copies.has(&lidar(0, &position)) && !copies.has(&lidar(1, &position)));
    }

    /// Polls of an axis at rest are the same bytes over and over.
    #[test]
    fn records_of_the_drive_are_copies_if_their_stamps_are_the_same() {
        let mut copies = RecordCopies::default();
        let frame = [0x90, 0x02, 0x10, 0x02];
        let mut all = |ns: i64| {
            let ways = [Direction::ToDrive, Direction::FromDrive];
            ways.map(|way| copies.has(&drive(ns, way, &frame)))
        };
        for i in 0..1_000 {
            assert_eq!(all(2_500_000 * i), [false; 2], "{i}");
        }
        for i in 600..1_000 {
            assert_eq!(all(2_500_000 * i), [true; 2], "{i}");
        }
        assert_eq!(copies.doubled_frames, 800);
    }

    /// A drive that has stalled answers the polls of that time at once, with the same bytes.
    #[test]
    fn late_answers_that_are_read_at_once_are_no_copies() {
        let mut copies = RecordCopies::default();
        for i in 0..5 {
            assert!(!copies.has(&drive(2_500_000 * i, Direction::ToDrive, &[1])));
        }
        for _ in 0..5 {
            assert!(!copies.has(&drive(900_000_000, Direction::FromDrive, &[2])));
        }
        assert_eq!(copies.doubled_frames, 0);
        // Of two recordings of the same traffic, joined in the order of time, half are copies.
        for i in 400..500 {
            for (direction, frame) in [(Direction::ToDrive, 1), (Direction::FromDrive, 2)] {
                let frame = [frame];
                let record = drive(2_500_000 * i, direction, &frame);
                let ways = [copies.has(&record), copies.has(&record)];
                assert_eq!(ways, [false, true], "{i} {direction:?}");
            }
        }
        assert_eq!(copies.doubled_frames, 200);
    }
}
