//! One firing of one laser: when, at which azimuth, from which tilt, and what it met. The rig and the truth share it, so
//! that they differ only in what the wire rounds off.

use std::sync::Arc;

use firmware_sim::vlp16::{LASER_PERIOD_NS, SEQUENCE_PERIOD_NS, TURN_CDEG};
use glam::DVec3;
use units::{Degrees, Host, Metres, Stamp};

use crate::clock::LidarClock;
use crate::head::{Head, MAX_RANGE_M, MIN_RANGE_M};
use crate::scene::{Hit, Scene};
use crate::shaft::Shaft;

/// Nanoseconds of a minute.
const MINUTE_NS: i64 = 60_000_000_000;

/// What does not change during a run.
#[derive(Clone, Debug)]
pub(crate) struct World {
    pub scene: Arc<Scene>,
    pub head: Head,
    pub clock: LidarClock,
    pub spin: Spin,
}

/// The head's rotation: constant in the lidar's own time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spin {
    pub rpm: u32,
    pub at_start: Degrees,
}

/// What a laser met.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Return {
    pub hit: Hit,
    pub point_m: DVec3,
}

impl World {
    pub fn new(scene: Arc<Scene>, mount: Metres, clock: LidarClock, spin: Spin) -> Self {
        Self {
            scene,
            head: Head::new(mount),
            clock,
            spin,
        }
    }

    /// The host's time of a laser's firing.
    pub fn fired_at(&self, sequence: i64, laser: usize) -> Stamp<Host> {
        self.clock.host(elapsed(sequence, laser))
    }

    /// What a laser meets; `None` for no return, or where the shaft's position is not known.
    #[inline]
    pub fn fire(&self, shaft: &Shaft, sequence: i64, laser: usize) -> Option<Return> {
        let elapsed_ns = elapsed(sequence, laser);
        let tilt = shaft.tilt(self.clock.host(elapsed_ns))?;
        let (origin, direction) = self.head.beam(laser, self.spin.azimuth(elapsed_ns), tilt)?;
        let hit = self
            .scene
            .cast(origin, direction, MIN_RANGE_M, MAX_RANGE_M)?;
        Some(Return {
            hit,
            point_m: origin + hit.range_m * direction,
        })
    }
}

impl Spin {
    /// The azimuth at a device time, 0..360 deg. Whole turns are taken off in integers, so it stays exact for any length of run.
    pub fn azimuth(&self, elapsed_ns: i64) -> Degrees {
        let in_minute = elapsed_ns.rem_euclid(MINUTE_NS);
        // Below 6e10 x 2^32 only for speeds no head has; saturating keeps it an angle all the same.
        let in_turn = in_minute.saturating_mul(i64::from(self.rpm)) % MINUTE_NS;
        let turned = 360.0 * (in_turn as f64 / MINUTE_NS as f64);
        Degrees((self.at_start.0 + turned).rem_euclid(360.0))
    }

    /// The azimuth as the wire has it: the nearest hundredth of a degree.
    pub fn azimuth_cdeg(&self, elapsed_ns: i64) -> u16 {
        (self.azimuth(elapsed_ns).0 * 100.0).round() as u16 % TURN_CDEG
    }
}

/// Device time of a firing since the start.
pub(crate) fn elapsed(sequence: i64, laser: usize) -> i64 {
    // A laser number is below 16 wherever it is valid.
    let laser = i64::try_from(laser).unwrap_or_default();
    sequence
        .saturating_mul(SEQUENCE_PERIOD_NS)
        .saturating_add(laser.saturating_mul(LASER_PERIOD_NS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_at_600_rpm_takes_a_tenth_of_a_second() {
        let spin = Spin {
            rpm: 600,
            at_start: Degrees(350.0),
        };
        assert!((spin.azimuth(0).0 - 350.0).abs() < 1e-12);
        assert!((spin.azimuth(100_000_000).0 - 350.0).abs() < 1e-12);
        assert!((spin.azimuth(25_000_000).0 - 80.0).abs() < 1e-12);
        // 3600 deg/s over 55.296 us.
        assert!((spin.azimuth(SEQUENCE_PERIOD_NS).0 - 350.199_065_6).abs() < 1e-12);
    }

    #[test]
    fn the_azimuth_stays_exact_over_days() {
        let spin = Spin {
            rpm: 601,
            at_start: Degrees(0.0),
        };
        let days = 100 * 86_400 * 1_000_000_000_i64;
        for ns in [0, 1, 12_345_678, 59_999_999_999] {
            assert_eq!(spin.azimuth(days + ns), spin.azimuth(ns), "{ns}");
        }
    }

    #[test]
    fn the_wire_azimuth_is_the_nearest_and_wraps() {
        let at = |at_start| {
            let spin = Spin {
                rpm: 0,
                at_start: Degrees(at_start),
            };
            spin.azimuth_cdeg(5)
        };
        assert_eq!(at(359.994), 35_999);
        assert_eq!(at(359.996), 0);
        assert_eq!(at(-0.01), 35_999);
        assert_eq!(at(123.456), 12_346);
        assert_eq!(at(720.0), 0);
    }
}
