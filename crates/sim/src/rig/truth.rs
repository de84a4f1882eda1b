//! Ground truth of a rig's run: where beams met the scene, the platform's tilt, the clocks.
//!
//! Points are computed on request from the recorded motion of the shaft, without the rounding of
//! the packets.

use firmware_sim::vlp16::SEQUENCE_PERIOD_NS;
use units::{Host, Span, Stamp};

use super::shaft::ShaftCourse;
use crate::firing::Surroundings;
use crate::packet_maker::{Platform, SimulatedLidar};

/// The truth of a run up to the time of the request.
#[derive(Clone, Debug)]
pub struct Truth {
    lidar: SimulatedLidar,
    surroundings: Surroundings,
    shaft: ShaftCourse,
}

impl Truth {
    pub(crate) const fn new(
        lidar: SimulatedLidar,
        surroundings: Surroundings,
        shaft: ShaftCourse,
    ) -> Self {
        Self {
            lidar,
            surroundings,
            shaft,
        }
    }

    /// Point at which the beam of `laser` (0..16 in firing order) met the scene at lidar time
    /// `device_ns`. Metres in the frame of the platform's base, as Eq. 4-6 give it (origin on the
    /// tilt axis, z up).
    ///
    /// `device_ns` is the laser's own time, its packet's stamp + 55.296 us x sequence + 2.304 us x
    /// laser, modulo an hour. The nearest firing of that laser counts, so the time may be off by
    /// nearly half a sequence. In runs of more than an hour, the time is unwrapped to the hour
    /// nearest to the host time.
    ///
    /// `None` for a laser that does not exist, a time outside the run, or a beam without a return
    /// from 1 m to 100 m.
    #[must_use]
    pub fn point(&self, device_ns: i64, laser: u8) -> Option<[f64; 3]> {
        let laser = usize::from(laser);
        let delay_ns = self.lidar.sensor.beams.get(laser)?.delay_ns;
        let elapsed_ns = self.elapsed_ns(device_ns.saturating_sub(delay_ns));
        let sequence = (elapsed_ns + SEQUENCE_PERIOD_NS / 2).div_euclid(SEQUENCE_PERIOD_NS);
        let mut firing = self.lidar.firing();
        let number = u64::try_from(sequence).ok()?;
        (self.lidar).aim(&mut firing, number, &self.lidar.clock, &self.shaft);
        let (origin_m, direction) = firing.is_alive(laser).then(|| firing.ray(laser))??;
        let met = self.surroundings.meet(origin_m, direction)?;
        Some((origin_m + met.range_m * direction).to_array())
    }

    /// The platform's tilt at a host time, degrees, gear ripple included; `None` outside the run.
    #[must_use]
    pub fn tilt_deg_at(&self, host: Stamp<Host>) -> Option<f64> {
        let since_ns = host.saturating_since(self.lidar.start).as_nanos();
        Some(self.shaft.state(since_ns)?.angle_deg)
    }

    /// Host time at lidar time `device_ns`, modulo an hour as in [`Truth::point`].
    #[must_use]
    pub fn lidar_to_host(&self, device_ns: i64) -> Stamp<Host> {
        self.lidar.clock.host(self.elapsed_ns(device_ns))
    }

    /// The end of the run, rounded up to the drive's next control cycle.
    #[must_use]
    pub fn end(&self) -> Stamp<Host> {
        let end = Span::from_nanos(self.shaft.end_ns());
        self.lidar.start.saturating_add(end)
    }

    fn elapsed_ns(&self, device_ns: i64) -> i64 {
        let clock = &self.lidar.clock;
        let run_ns = clock.elapsed(self.end());
        clock.elapsed_of_stamp(device_ns, SEQUENCE_PERIOD_NS / 2, run_ns)
    }
}
