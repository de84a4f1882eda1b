//! How the lidar is doing while nobody records it: rate, loss, turning speed.
//!
//! It looks at every packet, so it does no more than what is wanted of each; what a recording is worth is told by the decoder that reads it.

use std::time::{Duration, Instant};

use lidar::{Options, Timekeeper};
use protocol::record::{Record, Wire};
use protocol::vlp16::{DataPacket, Model};
use units::{Lidar, Stamp};

use engine::reconstruct::contents::return_mode_name;

/// Azimuth of a whole turn, hundredths of a degree.
const TURN: i64 = 36_000;
/// A longer silence is a lidar that was off, not packets that were lost.
const LONGEST_GAP_NS: i64 = 1_000_000_000;

/// What the packets show.
pub struct Monitor {
    timekeeper: Timekeeper,
    last: Option<(Stamp<Lidar>, i64)>,
    /// Azimuth and time since the last look, for the speed.
    turned: i64,
    turned_ns: i64,
    mode: Option<String>,
    model: Option<&'static str>,
    lost: u64,
    packets: u64,
    seen: (Instant, u64),
}

/// What it says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// The lidar's model.
    pub model: Option<&'static str>,
    /// strongest, last or dual.
    pub return_mode: Option<String>,
    /// Turns a minute.
    pub rpm: Option<f64>,
    /// Packets so far.
    pub packets: u64,
    /// A second, since the last look.
    pub packets_per_s: f64,
    /// Data packets that are missing.
    pub lost_packets: u64,
}

impl Default for Monitor {
    fn default() -> Self {
        Self {
            timekeeper: Timekeeper::new(Options::default()),
            last: None,
            turned: 0,
            turned_ns: 0,
            mode: None,
            model: None,
            lost: 0,
            packets: 0,
            seen: (Instant::now(), 0),
        }
    }
}

impl Monitor {
    /// Looks at a record of the lidar.
    pub fn observe(&mut self, record: &Record<'_>) {
        let Wire::Lidar { payload, .. } = record.wire else {
            return;
        };
        self.packets += 1;
        let Some(timing) = self.timekeeper.packet(record.host, payload) else {
            return;
        };
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
                self.turned += (azimuth - before).rem_euclid(TURN);
                self.turned_ns += gap;
            }
        }
        if self.packets % 256 == 1 {
            self.mode = Some(return_mode_name(packet.return_mode()));
            self.model = Model::of(packet.product()).map(|model| model.name);
        }
    }

    /// What was seen, and the rates since the last look.
    pub fn look(&mut self) -> Seen {
        let (at, before) = std::mem::replace(&mut self.seen, (Instant::now(), self.packets));
        let passed = at.elapsed().max(Duration::from_millis(1)).as_secs_f64();
        let minutes = self.turned_ns as f64 * 1e-9 / 60.0;
        let rpm = (self.turned_ns > 0).then(|| self.turned as f64 / TURN as f64 / minutes);
        (self.turned, self.turned_ns) = (0, 0);
        Seen {
            model: self.model,
            return_mode: self.mode.clone(),
            rpm,
            packets: self.packets,
            packets_per_s: (self.packets - before) as f64 / passed,
            lost_packets: self.lost,
        }
    }
}
