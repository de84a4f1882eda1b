//! Raw packets of the lidar, one message per revolution, during captures and between them.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use cloud::messages::{Frames, PACKET_BYTES, Time, Topic, VelodyneScan};
use engine::service::record_feed::RecordQueue;
use protocol::record::{Record, Wire};
use protocol::vlp16::DataPacket;
use units::{Host, Span, Stamp};

use crate::Context;
use crate::bridge::STOP_POLL;
use crate::link::{Error, RouterLink};

/// Packets that may wait for the network: 2.7 s of a VLP-16 in dual return mode.
const QUEUE: usize = 4_096;
/// Most packets of a message: of a lidar that does not rotate. A VLP-16 in dual return mode has
/// 302 per revolution at 300 rpm.
const MOST_PACKETS: u32 = 2_000;
/// Packets follow each other within milliseconds: what is left from before a pause is dropped.
const PAUSE: Span = Span::from_millis(1_000);
/// The azimuth falls by more than this, hundredths of a degree, where a revolution ends.
const HALF_REVOLUTION: u16 = 18_000;

/// Packets of the current revolution.
struct PacketCollector {
    scan: VelodyneScan,
    /// Arrival of the last packet.
    last: Stamp<Host>,
    /// Azimuth of the last packet, hundredths of a degree.
    azimuth_cdeg: u16,
}

/// Publishes packets until the bridge ends.
pub(crate) fn run(context: &Context, link: &RouterLink) -> Result<(), Error> {
    let frames = Frames::with_prefix(&context.settings.frame_prefix);
    let mut revolution = PacketCollector::new(frames.of_packets().child);
    let (queue, packets) = RecordQueue::new(QUEUE);
    let left_out = Arc::clone(queue.left_out());
    let devices = Arc::clone(context.devices());
    link.follow(Topic::LidarPackets, move |watched| {
        devices.feed_packets(watched.then(|| queue.clone()));
    })?;
    while !context.stop.is_set() {
        let Ok(record) = packets.recv_timeout(STOP_POLL) else {
            continue;
        };
        let sent = revolution.push(&record.as_record(), |message| {
            link.send(Topic::LidarPackets, message).map(|_| ())
        });
        if let Err(error) = sent {
            tracing::debug!("ROS 2: {error}");
        }
        let missed = left_out.swap(0, Ordering::Relaxed);
        context.counts.missed.fetch_add(missed, Ordering::Relaxed);
    }
    Ok(())
}

impl PacketCollector {
    fn new(frame: &str) -> Self {
        Self {
            scan: VelodyneScan::new(frame),
            last: Stamp::from_nanos(0),
            azimuth_cdeg: 0,
        }
    }

    /// Adds a data packet. Before the first one of a revolution, the last revolution is sent.
    fn push(
        &mut self,
        record: &Record<'_>,
        send: impl FnOnce(&[u8]) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let Wire::Lidar { payload, .. } = record.wire else {
            return Ok(());
        };
        let packet: Option<&[u8; PACKET_BYTES]> = payload.try_into().ok();
        let block = DataPacket::new(payload).ok();
        let block = block.and_then(|packet| packet.block(0));
        // Position packets, and damaged ones.
        let (Some(packet), Some(block)) = (packet, block) else {
            return Ok(());
        };
        let received = Time::of(record.host)?;
        let azimuth_cdeg = block.azimuth_cdeg();
        let since_last = record.host.saturating_since(self.last);
        if !(Span::ZERO..PAUSE).contains(&since_last) {
            self.scan.clear();
        }
        self.last = record.host;
        let is_over = self.azimuth_cdeg.saturating_sub(azimuth_cdeg) > HALF_REVOLUTION;
        let mut sent = Ok(());
        if self.scan.packets() > 0 && (is_over || self.scan.packets() >= MOST_PACKETS) {
            sent = send(self.scan.finish());
        }
        self.azimuth_cdeg = azimuth_cdeg;
        self.scan.push(received, packet);
        sent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START_NS: i64 = 1_795_226_733_000_000_000;

    /// A packet at a time, milliseconds, and an azimuth, degrees.
    fn push(revolution: &mut PacketCollector, at_ms: i64, azimuth_deg: u16) -> Option<u32> {
        let mut payload = [0; PACKET_BYTES];
        for block in payload[..1200].chunks_exact_mut(100) {
            block[..2].copy_from_slice(&[0xFF, 0xEE]);
            block[2..4].copy_from_slice(&(100 * azimuth_deg).to_le_bytes());
        }
        payload[1204..].copy_from_slice(&[0x37, 0x22]);
        push_payload(revolution, at_ms, &payload)
    }

    /// Number of packets of the message that is sent.
    fn push_payload(revolution: &mut PacketCollector, at_ms: i64, payload: &[u8]) -> Option<u32> {
        let record = Record {
            host: Stamp::from_nanos(START_NS + 1_000_000 * at_ms),
            wire: Wire::Lidar {
                source: [192, 168, 1, 201],
                port: 2368,
                payload,
            },
        };
        let mut packets = None;
        let send = |message: &[u8]| {
            // Encapsulation, stamp, "f" with its length and padding.
            let number = message[20..24].try_into().unwrap();
            packets = Some(u32::from_le_bytes(number));
            Ok(())
        };
        revolution.push(&record, send).unwrap();
        packets
    }

    #[test]
    fn a_message_has_the_packets_of_a_revolution() {
        let mut revolution = PacketCollector::new("f");
        for at_ms in 0..10 {
            let azimuth = 350 + at_ms as u16;
            assert_eq!(push(&mut revolution, at_ms, azimuth), None);
        }
        assert_eq!(push(&mut revolution, 10, 0), Some(10));
        // Azimuths of a lidar that starts may fall by a little.
        for (at_ms, azimuth) in [(11, 90), (12, 80), (13, 180), (14, 270)] {
            assert_eq!(push(&mut revolution, at_ms, azimuth), None);
        }
        assert_eq!(push(&mut revolution, 15, 1), Some(5));
    }

    #[test]
    fn a_revolution_that_a_pause_interrupts_is_dropped() {
        let mut revolution = PacketCollector::new("f");
        assert_eq!(push(&mut revolution, 0, 10), None);
        assert_eq!(push(&mut revolution, 5_000, 20), None);
        assert_eq!(push(&mut revolution, 5_100, 0), None);
        assert_eq!(push(&mut revolution, 5_101, 350), None);
        assert_eq!(push(&mut revolution, 5_102, 0), Some(3));
        // A clock that is set back.
        assert_eq!(push(&mut revolution, 0, 300), None);
        assert_eq!(push(&mut revolution, 1, 0), Some(1));
    }

    #[test]
    fn a_lidar_that_does_not_rotate_fills_no_memory() {
        let mut revolution = PacketCollector::new("f");
        for at_ms in 0..i64::from(MOST_PACKETS) {
            assert_eq!(push(&mut revolution, at_ms, 7), None);
        }
        let next_ms = i64::from(MOST_PACKETS);
        assert_eq!(push(&mut revolution, next_ms, 7), Some(MOST_PACKETS));
    }

    #[test]
    fn position_packets_and_damaged_ones_are_left_out() {
        let mut revolution = PacketCollector::new("f");
        for payload in [&[0; 512][..], &[0; PACKET_BYTES], &[]] {
            assert_eq!(push_payload(&mut revolution, 0, payload), None);
        }
        assert_eq!(revolution.scan.packets(), 0);
    }
}
