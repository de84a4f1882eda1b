//! What is missing of a capture whose motion went well: a lidar that fell silent, packets that the network lost.
//!
//! Left out: what the kernel and the disk lost, which is counted where it happens (`job`).

use std::time::{Duration, Instant};

use crate::failure::{Failure, Kind};
use crate::reconstruct::report::ScanReport;

/// A lidar that turns sends a packet every 1.3 ms. After so long without one the sweep is stopped: what is not recorded is not worth making.
pub const LIDAR_SILENCE: Duration = Duration::from_secs(1);
/// Sweeps begin and end with a sample of the drive, some milliseconds apart, and a packet takes 1.3 ms to fill. A longer time without packets
/// at the end of the last sweep is a lidar that has gone.
pub const UNHEARD_S: f64 = 0.05;

/// Sees whether the lidar goes on while the axis moves.
#[derive(Debug)]
pub struct Watch {
    packets: u64,
    heard: Instant,
    silent: bool,
}

impl Watch {
    /// From now on, with `packets` heard so far.
    #[must_use]
    pub fn new(packets: u64) -> Self {
        Self {
            packets,
            heard: Instant::now(),
            silent: false,
        }
    }

    /// Whether the lidar has fallen silent, by the number of packets heard until now.
    pub fn silent(&mut self, packets: u64) -> bool {
        if packets != self.packets {
            self.packets = packets;
            self.heard = Instant::now();
        }
        self.silent |= self.heard.elapsed() >= LIDAR_SILENCE;
        self.silent
    }

    /// What is said where it has.
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

/// What a scan lacks that nobody has complained of: packets that never came, an end of the log that never reached the disk.
#[must_use]
pub fn missing(scan: &ScanReport) -> Option<Failure> {
    let lost = scan.contents.lost_packets;
    let mut said = Vec::new();
    if let Some(truncated) = &scan.contents.truncated {
        said.push(format!("the log is incomplete ({truncated})"));
    }
    said.extend(scan.incomplete_sweeps.iter().cloned());
    if lost > 0 {
        let of = lost.saturating_add(scan.contents.packets.data);
        said.push(format!("{lost} of {of} lidar packets are missing"));
    }
    if scan.lidar_gap_s > UNHEARD_S {
        said.push(format!(
            "nothing was heard of the lidar in the last {:.2} s of the sweep",
            scan.lidar_gap_s
        ));
    }
    (!said.is_empty()).then(|| {
        Failure::new(Kind::Incomplete, said.join(", and "))
            .help("see whether the lidar's cable and the network's switches are sound, and scan again if what is missing matters")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lidar_that_goes_on_is_not_silent() {
        let mut watch = Watch::new(7);
        assert!(!watch.silent(7) && !watch.silent(8));
        assert!(watch.failure().is_none());
        watch.heard = watch.heard.checked_sub(LIDAR_SILENCE).unwrap();
        assert!(!watch.silent(9), "it was heard just now");
        watch.heard = watch.heard.checked_sub(LIDAR_SILENCE).unwrap();
        assert!(watch.silent(9));
        // What comes later does not fill the hole.
        assert!(watch.silent(10));
        assert_eq!(watch.failure().unwrap().kind, Kind::Incomplete);
    }
}
