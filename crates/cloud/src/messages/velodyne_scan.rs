//! `velodyne_msgs/VelodyneScan`: raw packets of a lidar, as the ROS driver `velodyne_driver`
//! publishes them for `velodyne_pointcloud`.

use super::cdr::Cdr;
use super::{Time, header};

/// Bytes of a packet.
pub const PACKET_BYTES: usize = 1206;
/// Offset of the header's stamp, after the encapsulation header.
const STAMP: usize = 4;

/// A message under construction.
#[derive(Clone, Debug)]
pub struct VelodyneScan {
    frame: String,
    cdr: Cdr,
    /// Offset of the number of packets.
    length: usize,
    packets: u32,
    last: Time,
}

impl VelodyneScan {
    /// An empty message in this frame, which has ROS's axes, as `velodyne_pointcloud` computes
    /// points with x forward.
    #[must_use]
    pub fn new(frame: &str) -> Self {
        Self {
            frame: frame.to_owned(),
            cdr: Cdr::new(),
            length: 0,
            packets: 0,
            last: Time::default(),
        }
    }

    /// Number of packets so far.
    #[must_use]
    pub const fn packets(&self) -> u32 {
        self.packets
    }

    /// Adds a packet and the time of its arrival.
    pub fn push(&mut self, received: Time, packet: &[u8; PACKET_BYTES]) {
        let cdr = &mut self.cdr;
        if self.packets == 0 {
            cdr.clear();
            header(cdr, received, &self.frame);
            self.length = cdr.placeholder();
        }
        cdr.i32(received.sec);
        cdr.u32(received.nanosec);
        cdr.room(PACKET_BYTES).copy_from_slice(packet);
        self.packets += 1;
        self.last = received;
    }

    /// Drops the packets so far.
    pub const fn clear(&mut self) {
        self.packets = 0;
    }

    /// Completes the message, stamped as by the driver with the time of its last packet. Returns
    /// its bytes, encapsulation header included. The next packet begins a new message.
    pub fn finish(&mut self) -> &[u8] {
        let last = self.last;
        self.cdr.set_u32(STAMP, last.sec.cast_unsigned());
        self.cdr.set_u32(STAMP + 4, last.nanosec);
        self.cdr.set_u32(self.length, self.packets);
        self.packets = 0;
        self.cdr.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::cdr_reader::Reader;

    #[test]
    fn scans_round_trip_and_have_the_time_of_their_last_packet() {
        let mut scan = VelodyneScan::new("left/lidar_ros");
        let time = |sec, nanosec| Time { sec, nanosec };
        scan.push(time(1, 1), &[1; PACKET_BYTES]);
        scan.clear();
        for round in 0..2_u8 {
            assert_eq!(scan.packets(), 0);
            for packet in 2..5 {
                scan.push(
                    time(7, 100 + u32::from(packet)),
                    &[packet + round; PACKET_BYTES],
                );
            }
            assert_eq!(scan.packets(), 3);
            let mut reader = Reader::new(scan.finish());
            assert_eq!(reader.header(), (7, 104, "left/lidar_ros".to_owned()));
            assert_eq!(reader.u32(), 3);
            for packet in 2..5 {
                assert_eq!((reader.u32(), reader.u32()), (7, 100 + u32::from(packet)));
                assert_eq!(reader.take(PACKET_BYTES), [packet + round; PACKET_BYTES]);
            }
            assert!(reader.is_done());
        }
    }
}
