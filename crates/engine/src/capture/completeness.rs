//! Gaps in a capture whose motion succeeded: a lidar that fell silent, packets lost in the network.
//!
//! Losses in the kernel and on the way to the disk are counted in [`super::run`].

use std::time::{Duration, Instant};

use crate::failure::{Failure, Kind};
use crate::reconstruct::report::{Contents, ScanReport};

/// Time without packets after which the sweep is stopped. A lidar in rotation sends a packet every
/// 1.3 ms.
pub const LIDAR_SILENCE: Duration = Duration::from_secs(1);
/// A longer time between two looks is a suspension of this program.
const LONGEST_PAUSE: Duration = Duration::from_millis(500);
/// Longest time without packets at the start of the first sweep and at the end of the last,
/// seconds. Sweeps end with a sample of the drive, some milliseconds after the one before, and a
/// packet takes 1.3 ms to fill.
pub const MAX_LIDAR_GAP_S: f64 = 0.05;

/// Watches for silence of the lidar while the axis moves.
#[derive(Debug)]
pub struct SilenceWatch {
    packets: u64,
    last_packet: Instant,
    /// The last call of [`SilenceWatch::silent`].
    last_look: Instant,
    silent: bool,
}

impl SilenceWatch {
    /// Watches from now on, after `packets` packets.
    #[must_use]
    pub fn new(packets: u64) -> Self {
        Self {
            packets,
            last_packet: Instant::now(),
            last_look: Instant::now(),
            silent: false,
        }
    }

    /// Whether the lidar has fallen silent, by the number of packets until now.
    pub fn silent(&mut self, packets: u64) -> bool {
        let now = Instant::now();
        // After a suspension of this program, received packets are yet to be counted.
        let suspended = now - std::mem::replace(&mut self.last_look, now) > LONGEST_PAUSE;
        if packets != self.packets || suspended {
            self.packets = packets;
            self.last_packet = now;
        }
        self.silent |= self.last_packet.elapsed() >= LIDAR_SILENCE;
        self.silent
    }

    /// The failure of a capture whose lidar has fallen silent.
    #[must_use]
    pub fn failure(&self) -> Option<Failure> {
        self.silent.then(|| {
            Failure::new(
                Kind::Incomplete,
                format!(
                    "the lidar fell silent in the middle of the scan: no packet for {} s, and the axis was stopped",
                    LIDAR_SILENCE.as_secs()
                ),
            )
            .help("see whether the lidar is powered and turns, and its cable is in; then scan again")
        })
    }
}

/// The failure of a scan with gaps: lost packets, or a truncated log.
#[must_use]
pub fn missing(scan: &ScanReport) -> Option<Failure> {
    let mut gaps = Vec::new();
    if let Some(truncated) = &scan.contents.truncated {
        gaps.push(format!("the log is incomplete ({truncated})"));
    }
    gaps.extend(scan.incomplete_sweeps.iter().cloned());
    gaps.extend(missing_packets(&scan.contents));
    for (gap_s, part) in scan.lidar_gaps_s.into_iter().zip(["first", "last"]) {
        if gap_s > MAX_LIDAR_GAP_S {
            gaps.push(format!(
                "no lidar packet arrived in the {part} {gap_s:.2} s of the {part} sweep"
            ));
        }
    }
    if scan.points == 0 {
        gaps.push(match &scan.left_out_because {
            Some(why) => format!("the cloud has no point: all returns were {why}"),
            None => "the cloud has no point: the lidar had no return".to_owned(),
        });
    }
    (!gaps.is_empty()).then(|| {
        Failure::new(Kind::Incomplete, gaps.join(", and "))
            .help("see whether the lidar's cable and the network's switches are sound, and scan again if what is missing matters")
    })
}

/// Number of missing lidar packets, and the time of the first gap.
#[must_use]
pub fn missing_packets(contents: &Contents) -> Option<String> {
    let lost = contents.lost_packets;
    if lost == 0 {
        return None;
    }
    let of = lost.saturating_add(contents.packets.data);
    let first = contents.packet_gaps.first();
    let place = first.map_or(String::new(), |gap| match gap.missing == lost {
        true => format!(" at {:.3} s", gap.at_s),
        false => format!(", the first at {:.3} s", gap.at_s),
    });
    Some(format!("{lost} of {of} lidar packets are missing{place}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lidar_that_sends_packets_is_not_silent() {
        let mut watch = SilenceWatch::new(7);
        assert!(!watch.silent(7) && !watch.silent(8));
        assert!(watch.failure().is_none());
        watch.last_packet = watch.last_packet.checked_sub(LIDAR_SILENCE).unwrap();
        assert!(!watch.silent(9), "a packet came just now");
        watch.last_packet = watch.last_packet.checked_sub(LIDAR_SILENCE).unwrap();
        assert!(watch.silent(9));
        // Later packets do not fill the gap.
        assert!(watch.silent(10));
        assert_eq!(watch.failure().unwrap().kind, Kind::Incomplete);
    }
}
