//! How far each point is expected to be off.
//!
//! Three things are known with an error that differs from point to point: the tilt angle, the range and the azimuth. They are
//! independent and at right angles but for what sin and cos of small elevations make of it, so their squares add up
//! ([`Alignment::sd_m`]). Left out, as it is one number for a whole scan that calibration finds: a delay that all samples of the angle share
//! or all packets, the mount, and each laser's own constants.

use lidar::SensorPoint;
use units::{Host, Lidar, Stamp};

use crate::clock::Moment;
use crate::scanner::Alignment;

/// Standard deviation of the lidar's stamps, nanoseconds: whole microseconds, cut off.
const STAMP_SD_NS: f64 = 288.675_134_594_812_9;

impl Alignment {
    /// The error that a point is expected to have, root mean square over its three axes, metres:
    ///
    /// sd^2 = (rho sd_gamma)^2 + sd_range^2 + (r cos(w) sd_azimuth)^2 with sd_gamma^2 = sd_fit^2 + (rate sd_clock)^2,
    ///
    /// rho the distance from the tilt axis and r cos(w) from the axis of the lidar's head; sd_fit is the trajectory's, sd_clock the
    /// clock's and the stamps'.
    pub(crate) fn sd_m(&self, point: &SensorPoint, at: Moment, near: Option<Stamp<Host>>) -> f64 {
        let [x, y, z] = point.position_m;
        let height = z + self.mount.d.0;
        let clock_sd_ns = self.clock_sd_ns(point.time, near);
        let by_tilt = (x * x + height * height) * self.trajectory.variance_rad2(at, clock_sd_ns);
        let by_azimuth = (x * x + y * y) * point.azimuth_variance_rad2;
        (by_tilt + self.range_sd_m * self.range_sd_m + by_azimuth).sqrt()
    }

    /// Standard deviation of the instant of a firing, nanoseconds.
    pub(crate) fn clock_sd_ns(&self, device: Stamp<Lidar>, near: Option<Stamp<Host>>) -> f64 {
        self.clock.sd_near_ns(device, near).hypot(STAMP_SD_NS)
    }
}
