//! Result of the first pass, and the plain definition of placing a point.
//!
//! [`Alignment::place`] is the definition; `fast::firing_blocks` places whole blocks and is tested
//! against it.
//!
//! The expected error of a point combines three independent errors that differ from point to point:
//! tilt angle, range and azimuth. They act at right angles, up to the sine of small elevations, so
//! their squares add ([`Point::sd_m`]). Errors common to a whole scan (a delay that all angle
//! samples or all packets share, the mount, the constants of each laser) are part of it if a
//! calibration gives their covariance.

use cloud::Point;
use cloud::mount::{Mount, Tilt};
use lidar::SensorPoint;
use units::{Degrees, Host, Lidar, Stamp};

use crate::calibration::PointCalibration;
use crate::clock::{LidarClock, Moment};
use crate::clock_steps::{ClockStep, DelayChange};
use crate::residuals::ResidualInterval;
use crate::sample_gaps::SampleGaps;
use crate::sweeps::Sweep;
use crate::tolerance::MethodChoice;
use crate::trajectory::{Method, Trajectory};

/// Result of the first pass: clock, trajectory and mount, which place any firing.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Alignment {
    /// Lidar time to host time.
    pub clock: LidarClock,
    /// Clocks set in mid-recording, in order. Host times are those of the clock before the first.
    pub steps: Vec<ClockStep>,
    /// Lasting changes of the packets' delay whose cause is not known, in order.
    pub delay_changes: Vec<DelayChange>,
    /// Host time to tilt angle.
    pub trajectory: Trajectory,
    /// Reason for the method of the angles, if a tolerance chose it.
    pub choice: Option<MethodChoice>,
    /// The sweeps; empty if the angles are not those of the log.
    pub sweeps: Vec<Sweep>,
    /// Beginnings and ends of sweeps of which the log holds no positions; there are no points of
    /// them.
    pub unseen_sweeps: Vec<(Degrees, Degrees)>,
    /// Indices of sweeps whose command is not complete in the log.
    pub inferred_sweeps: Vec<usize>,
    /// Indices of sweeps that went on after the last position of the drive in the log.
    pub unobserved_ends: Vec<usize>,
    /// Beginnings and ends of motions that may be sweeps, but the log lacks their target.
    pub ambiguous_motions: Vec<(Degrees, Degrees)>,
    /// Mount of the lidar on the axis.
    pub mount: Mount,
    /// Calibration of axis and lasers.
    pub(crate) calibration: Option<PointCalibration>,
    /// Shaft samples discarded as implausible.
    pub implausible: u64,
    /// Gaps between the angle samples within the sweeps.
    pub sample_gaps: SampleGaps,
    /// Residuals of clock and angle, in equal intervals from the first packet to the last.
    pub residuals: Vec<ResidualInterval>,
    /// Standard deviation of a range, metres.
    pub range_sd_m: f64,
    /// Only firings within one of these spans become points.
    pub(crate) spans: Vec<(Stamp<Host>, Stamp<Host>)>,
}

/// Number of returns by outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlacementCounts {
    /// Points handed to the sink.
    pub points: u64,
    /// Returns outside every sweep, or outside the time for which an angle is known.
    pub outside: u64,
}

/// Standard deviation of the lidar's stamps, nanoseconds: truncated to microseconds, 1 us /
/// sqrt(12).
const STAMP_SD_NS: f64 = 288.675_134_594_812_9;

impl Alignment {
    /// An alignment without clock steps and sweeps, as the live cloud and tests make it.
    pub(crate) fn new(
        clock: LidarClock,
        trajectory: Trajectory,
        mount: Mount,
        range_sd_m: f64,
        spans: Vec<(Stamp<Host>, Stamp<Host>)>,
    ) -> Self {
        Self {
            clock,
            steps: Vec::new(),
            delay_changes: Vec::new(),
            trajectory,
            choice: None,
            sweeps: Vec::new(),
            unseen_sweeps: Vec::new(),
            inferred_sweeps: Vec::new(),
            unobserved_ends: Vec::new(),
            ambiguous_motions: Vec::new(),
            mount,
            calibration: None,
            implausible: 0,
            sample_gaps: SampleGaps::default(),
            residuals: Vec::new(),
            range_sd_m,
            spans,
        }
    }

    /// Agreement of the angle samples within the sweeps, root mean square, degrees
    /// ([`Trajectory::rms_deg`]); `None` without tilt.
    #[must_use]
    pub fn angle_rms_deg(&self) -> Option<f64> {
        self.trajectory.rms_deg(&self.spans)
    }

    /// Greatest error of the tilt angle during the sweeps: that of the trajectory, and the error of
    /// the samples' stamps ([`LidarClock::host_bound`]) at the greatest speed. `None` without tilt.
    #[must_use]
    pub fn angle_bound_deg(&self) -> Option<f64> {
        let fastest = self.trajectory.fastest(&self.spans).0.abs();
        let stamps_deg = fastest * self.clock.host_bound().as_secs_f64();
        self.trajectory_bound_deg().map(|deg| deg + stamps_deg)
    }

    /// The part of [`Alignment::angle_bound_deg`] without the host's clock
    /// ([`Trajectory::bound_deg`]).
    #[must_use]
    pub fn trajectory_bound_deg(&self) -> Option<f64> {
        (self.trajectory.method() != Method::None).then(|| self.trajectory.bound_deg(&self.spans))
    }

    /// Places a point of the sensor's frame, at its own time and tilt, in the frame of the platform
    /// (Eq. 4-6). `None` outside every sweep, or outside the time for which an angle is known.
    #[must_use]
    pub fn place(&self, point: &SensorPoint) -> Option<Point> {
        self.place_received(point, None)
    }

    /// Like [`Alignment::place`], for a packet received at `received` by the host's clock of that
    /// time, which distinguishes device times that occur twice after the lidar's clock was set
    /// back.
    #[must_use]
    pub fn place_received(
        &self,
        point: &SensorPoint,
        received: Option<Stamp<Host>>,
    ) -> Option<Point> {
        let moment = self.clock.moment_near(point.time, received);
        let in_span =
            |(from, to): &(Stamp<Host>, Stamp<Host>)| *from <= moment.host && moment.host <= *to;
        let tilt = self
            .trajectory
            .angle(moment)
            .filter(|_| self.spans.iter().any(in_span))?;
        let sd_m = self.sd_m(point, moment, tilt, received);
        let tilt = match &self.calibration {
            Some(calibration) => calibration.tilt(tilt, self.rate_deg_s(moment)),
            None => tilt,
        };
        Some(Point {
            position_m: self.mount.place(point.position_m, Tilt::new(tilt)),
            intensity: point.reflectivity,
            ring: point.ring,
            laser: point.laser,
            time: moment.host,
            device_time: point.time,
            tilt,
            sd_m,
            echo: point.echo.code(),
        })
    }

    /// Expected error of a point, root mean square over its three axes, metres:
    ///
    /// `sd^2 = (rho sd_tilt)^2 + sd_range^2 + (r cos(w) sd_azimuth)^2` with `sd_tilt^2 = sd_fit^2 +
    /// (rate sd_clock)^2`,
    ///
    /// where rho is the distance from the tilt axis, r cos(w) the distance from the lidar's spin
    /// axis, `sd_fit` that of the trajectory and `sd_clock` that of clock and stamps. A calibration
    /// adds J C J', with C its covariance.
    fn sd_m(
        &self,
        point: &SensorPoint,
        at: Moment,
        tilt: Degrees,
        received: Option<Stamp<Host>>,
    ) -> f64 {
        let [x, y, _] = point.position_m;
        let [across, _, height] = self.mount.on_platform(point.position_m);
        let clock_sd_ns = self.clock_sd_ns(point.time, received);
        let by_tilt =
            (across * across + height * height) * self.trajectory.variance_rad2(at, clock_sd_ns);
        let by_azimuth = (x * x + y * y) * point.azimuth_variance_rad2;
        let independent = by_tilt + self.range_sd_m * self.range_sd_m + by_azimuth;
        let calibrated = self.calibration.as_ref().map_or(0.0, |calibration| {
            calibration.variance_m2(&self.mount, point, tilt, self.rate_deg_s(at))
        });
        (independent + calibrated).sqrt()
    }

    /// Rate of the tilt, degrees per second; 0 for a fixed platform.
    fn rate_deg_s(&self, at: Moment) -> f64 {
        let piece = self.trajectory.piece(at);
        piece.map_or(0.0, |piece| 1e9 * piece.rate(piece.since(at)))
    }

    /// Standard deviation of the instant of a firing, nanoseconds.
    pub(crate) fn clock_sd_ns(&self, device: Stamp<Lidar>, received: Option<Stamp<Host>>) -> f64 {
        self.clock.sd_near_ns(device, received).hypot(STAMP_SD_NS)
    }
}
