//! Statistics of the lidar's packets for the status: rate, losses, rotation.
//!
//! This runs for every packet, so it reads only the first block. Recordings have the decoder's
//! statistics instead.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use lidar::{Options, Timekeeper};
use protocol::record::{Record, Wire};
use protocol::vlp16::DataPacket;
use units::{Lidar, Stamp};

use super::status::LidarStatus;
use crate::config::Device;
use crate::devices::lidar_receiver::LidarReceiver;
use crate::devices::lidar_sockets::{LidarSockets, listen_config};
use crate::failure::Failure;
use crate::reconstruct::contents::return_mode_name;

/// Packets between two looks at the return mode.
const MODE_INTERVAL: u64 = 256;
/// One revolution, hundredths of a degree.
const REVOLUTION: i64 = 36_000;
/// Longer gaps are a lidar that was off, not lost packets.
const LONGEST_GAP_NS: i64 = 1_000_000_000;

/// Listens to a device's lidar for this long, and reports what came.
///
/// # Errors
/// Where its ports cannot be opened.
pub fn listen(device: &Device, duration: Duration) -> Result<LidarStatus, Failure> {
    let stats: Arc<Mutex<LidarStats>> = Arc::default();
    let sockets = LidarSockets::bind(&listen_config(device))?;
    let own = Arc::clone(&stats);
    let receiver = LidarReceiver::start(
        sockets,
        Box::new(move |record| super::locked(&own).observe(record)),
    )?;
    std::thread::sleep(duration);
    receiver.counts()?;
    let (status, _) = super::locked(&stats).summary();
    Ok(status)
}

/// Statistics of all packets so far.
pub(super) struct LidarStats {
    timekeeper: Timekeeper,
    last: Option<(Stamp<Lidar>, i64)>,
    /// Azimuth swept and its time since the last summary.
    swept_cdeg: i64,
    swept_ns: i64,
    mode: Option<String>,
    model: Option<&'static str>,
    lost: u64,
    packets: u64,
    /// Time and packets of the last summary.
    last_summary: (Instant, u64),
    /// Time of the last summary that had new packets.
    last_packets: Instant,
}

impl Default for LidarStats {
    fn default() -> Self {
        Self {
            timekeeper: Timekeeper::new(Options::default()),
            last: None,
            swept_cdeg: 0,
            swept_ns: 0,
            mode: None,
            model: None,
            lost: 0,
            packets: 0,
            last_summary: (Instant::now(), 0),
            last_packets: Instant::now(),
        }
    }
}

impl LidarStats {
    /// Handles a record of the lidar.
    pub(super) fn observe(&mut self, record: &Record<'_>) {
        let Wire::Lidar { payload, .. } = record.wire else {
            return;
        };
        self.packets += 1;
        let Some(timing) = self.timekeeper.packet(record.host, payload) else {
            return;
        };
        self.model = Some(timing.model);
        let Ok(packet) = DataPacket::new(payload) else {
            return;
        };
        let azimuth = packet
            .block(0)
            .map_or(0, |block| i64::from(block.azimuth_cdeg()));
        let now = (timing.first_firing, azimuth);
        if let Some((then, before)) = self.last.replace(now) {
            let gap = timing.first_firing.saturating_since(then).as_nanos();
            let fill = timing.fill.as_nanos().max(1);
            if (0..LONGEST_GAP_NS).contains(&gap) {
                // To the nearest whole number of packets.
                let packets = (gap + fill / 2) / fill;
                self.lost += u64::try_from(packets - 1).unwrap_or(0);
            }
            if (1..3 * fill).contains(&gap) {
                self.swept_cdeg += (azimuth - before).rem_euclid(REVOLUTION);
                self.swept_ns += gap;
            }
        }
        if self.packets % MODE_INTERVAL == 1 {
            self.mode = Some(return_mode_name(packet.return_mode()));
        }
    }

    /// The statistics so far with rates since the last summary, and the time since a summary had
    /// new packets.
    pub(super) fn summary(&mut self) -> (LidarStatus, Duration) {
        let now = (Instant::now(), self.packets);
        let (before, packets_before) = std::mem::replace(&mut self.last_summary, now);
        if self.packets != packets_before {
            self.last_packets = now.0;
        }
        let passed = before.elapsed().max(Duration::from_millis(1)).as_secs_f64();
        let minutes = self.swept_ns as f64 * 1e-9 / 60.0;
        let rpm = (self.swept_ns > 0).then(|| self.swept_cdeg as f64 / REVOLUTION as f64 / minutes);
        (self.swept_cdeg, self.swept_ns) = (0, 0);
        let status = LidarStatus {
            model: self.model,
            return_mode: self.mode.clone(),
            rpm,
            received: self.packets,
            packets_per_s: (self.packets - packets_before) as f64 / passed,
            lost_packets: self.lost,
            ..LidarStatus::default()
        };
        (status, self.last_packets.elapsed())
    }
}
