//! What truly happened in a run: where beams met the scene, how the platform was tilted, how the clocks related.
//!
//! A point is computed anew when asked for, from the recorded motion of the shaft, with the exact time, azimuth, angle and
//! range of its firing: nothing the wire rounds off is in it. Left out: anything a receiver made of the packets.

use firmware_sim::vlp16::{LASER_PERIOD_NS, SEQUENCE_PERIOD_NS};
use units::{Host, Stamp};

use crate::shaft::Shaft;
use crate::world::World;

/// The true course of a run, up to when it was asked for.
#[derive(Clone, Debug)]
pub struct Truth {
    world: World,
    shaft: Shaft,
}

impl Truth {
    pub(crate) const fn new(world: World, shaft: Shaft) -> Self {
        Self { world, shaft }
    }

    /// Where the beam of `laser` (0..16 in firing order) met the scene at lidar time `device_ns`, in metres in the frame of the
    /// platform's base (origin on the tilt axis, z up: what Eq. 4-6 give).
    ///
    /// `device_ns` is that laser's own instant, its packet's stamp + 55.296 us x sequence + 2.304 us x laser, right modulo an
    /// hour; the firing of that laser nearest to it is taken, so the stamp may be off by nearly half a sequence. In runs
    /// beyond an hour, stamps unwrapped to the nearest hour of the host's time find their own hour.
    ///
    /// `None` for a laser that does not exist, an instant outside the run, or a beam that met nothing within 1..100 m.
    #[must_use]
    pub fn point(&self, device_ns: i64, laser: u8) -> Option<[f64; 3]> {
        let laser = usize::from(laser);
        let after_first = i64::try_from(laser).ok()?.checked_mul(LASER_PERIOD_NS)?;
        let elapsed = self.elapsed(device_ns.saturating_sub(after_first));
        let sequence = (elapsed + SEQUENCE_PERIOD_NS / 2).div_euclid(SEQUENCE_PERIOD_NS);
        let found = self.world.fire(&self.shaft, sequence, laser)?;
        Some(found.point_m.to_array())
    }

    /// The platform's tilt angle at a host time, degrees, with what the gear adds to the motor's; `None` outside the run.
    #[must_use]
    pub fn tilt_deg_at(&self, host: Stamp<Host>) -> Option<f64> {
        self.shaft.tilt(host).map(|angle| angle.0)
    }

    /// The host's time at lidar time `device_ns`, right modulo an hour as in [`Truth::point`].
    #[must_use]
    pub fn lidar_to_host(&self, device_ns: i64) -> Stamp<Host> {
        self.world.clock.host(self.elapsed(device_ns))
    }

    /// The end of the run, rounded up to the drive's next control cycle.
    #[must_use]
    pub fn end(&self) -> Stamp<Host> {
        self.shaft.end()
    }

    fn elapsed(&self, device_ns: i64) -> i64 {
        let run = self.world.clock.elapsed(self.shaft.end());
        self.world
            .clock
            .elapsed_of_stamp(device_ns, SEQUENCE_PERIOD_NS / 2, run)
    }
}
