//! Data packets of the lidar: the one computation behind [`Rig`](crate::Rig) and
//! [`Simulation`](crate::simulate::Simulation).
//!
//! For each firing: time, azimuth and tilt, the rays, what they meet, what effects make of it, the
//! bytes and the true points. Where no effect is configured, effects are `()` and compile to
//! nothing. A build without the feature `effects` does not contain the calls; a test compares the
//! instruction counts of both builds.

use firmware_sim::vlp16::{
    DATA_LEN, DataPacketBuilder, POSITION_LEN, Pps, TURN_CDEG, firing_blocks, position_packet,
};
use glam::DVec3;
use units::{Host, Span, Stamp};

#[cfg(feature = "effects")]
use crate::effects::{BeamEffect, ObjectsEffect, SurfaceEffect, ViewEffect};
use crate::effects::{ClockEffect, FiringEffects, Needs};
use crate::firing::{Echo, Echoes, SimulatedFiring, Surroundings};
use crate::lidar_clock::LidarClock;
use crate::motion::AxisState;
use crate::sensor::{LidarMount, LidarSensor, MAX_LASERS, PacketModel, RayTable, ReturnMode};

/// Data packets per position packet, about the ratio of real sensors.
const DATA_PER_POSITION: u64 = 5;

/// Rotation of the head, constant in the lidar's own time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadRotation {
    /// Revolutions per minute.
    pub rpm: u32,
    /// Azimuth of the first firing, degrees.
    pub start_deg: f64,
}

/// A return, where it truly is and where it is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TruePoint {
    /// Point at which the middle of the beam meets the scene, metres in the frame of the base. Its
    /// origin is on the tilt axis; x right, y forward, z up.
    pub position_m: DVec3,
    /// Position by the measured distance, on the beam. For a lidar without packets: the result of a
    /// reader who knows time, tilt and nominal sensor exactly, but no motion of the base.
    pub measured_m: DVec3,
    /// Host time of the laser's firing.
    pub host: Stamp<Host>,
    /// Lidar time of the laser's firing since the start, nanoseconds.
    pub device_ns: i64,
    /// Laser number in firing order.
    pub laser: u8,
    /// Return of the pulse: 0 for the one of a single-return mode, 1 for the second of dual return.
    pub echo: u8,
    /// Calibrated reflectivity as reported.
    pub reflectivity: u8,
    /// True distance, metres. Infinite for a return from no surface, such as fog, which only the
    /// points of a lidar without packets include.
    pub range_m: f64,
    /// Azimuth of the beam in the sensor's frame, degrees, 0..360.
    pub azimuth_deg: f64,
    /// Tilt of the platform, degrees.
    pub tilt_deg: f64,
}

/// The tilt of the platform over time.
pub(crate) trait Platform {
    /// Tilt and rate at a host time (nanoseconds since the start); `None` where it is not known.
    fn state(&self, host_ns: i64) -> Option<AxisState>;
}

/// The lidar of a run: everything that is the same for all packets.
#[derive(Clone, Debug)]
pub(crate) struct SimulatedLidar {
    pub sensor: LidarSensor,
    pub returns: ReturnMode,
    pub rotation: HeadRotation,
    pub mount: LidarMount,
    /// Host time of the start.
    pub start: Stamp<Host>,
    /// The clock of the packets' stamps. Its drift acts only where it is the clock effect too.
    pub clock: LidarClock,
    /// Rays of the first firing at an instant.
    rays: RayTable,
    /// Rays of the other firings at that instant.
    more_rays: Vec<RayTable>,
    /// The sensor as a reader knows it, without errors of its lasers.
    nominal: LidarSensor,
}

/// A data packet as it leaves the lidar.
#[derive(Debug)]
pub(crate) struct SimulatedPacket {
    pub payload: [u8; DATA_LEN],
    /// Time at which it leaves, host nanoseconds since the start.
    pub leaves_ns: i64,
    /// The lidar's clock at that time, microseconds past the hour.
    pub stamp_us: u32,
    /// Number of true points.
    pub points: usize,
    pub counts: ShotCounts,
}

impl SimulatedPacket {
    /// The position packet after this one, if one is due after `data_packets` packets in all.
    pub fn position_packet(&self, data_packets: u64) -> Option<[u8; POSITION_LEN]> {
        let due = data_packets.is_multiple_of(DATA_PER_POSITION);
        due.then(|| position_packet(self.stamp_us, Pps::Absent, &[]))
    }
}

/// Counts of shots (lasers that fired) and returns.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ShotCounts {
    pub shots: u32,
    /// Shots with at least one return.
    pub returned: u32,
    pub returns: u32,
}

/// Makes packets one after the other; each thread has its own.
#[derive(Debug)]
pub(crate) struct PacketMaker<F> {
    effects: F,
    needs: Needs,
    surroundings: Surroundings,
    /// The firings of a packet and the returns of each.
    firings: Vec<SimulatedFiring>,
    echoes: Vec<Echoes>,
    packet: DataPacketBuilder,
}

/// Distance in the sensor's units (0 for no return) and calibrated reflectivity.
type RawReturn = (u16, u8);

impl SimulatedLidar {
    pub fn new(
        sensor: LidarSensor,
        returns: ReturnMode,
        rotation: HeadRotation,
        mount: LidarMount,
        start: Stamp<Host>,
        clock: LidarClock,
    ) -> Self {
        Self {
            rays: RayTable::new(&sensor, rotation.deg_per_s()),
            more_rays: RayTable::others(&sensor, rotation.deg_per_s()),
            nominal: sensor.clone(),
            sensor,
            returns,
            rotation,
            mount,
            start,
            clock,
        }
    }

    /// The same lidar for readers who know it as `nominal`.
    pub fn known_as(self, nominal: &LidarSensor) -> Self {
        let nominal = nominal.clone();
        Self { nominal, ..self }
    }

    /// Beginning of a firing in lidar time since the start.
    pub fn device_ns(&self, firing: u64) -> i64 {
        self.sensor.firing_ns(firing)
    }

    /// A firing before any is aimed.
    pub fn firing(&self) -> SimulatedFiring {
        SimulatedFiring::new(self.rays.count)
    }

    /// Sets time, azimuth, tilt and rays of a firing. No laser fires where the tilt is not known.
    #[inline]
    pub fn aim<C: ClockEffect>(
        &self,
        firing: &mut SimulatedFiring,
        number: u64,
        clock: &C,
        platform: &impl Platform,
    ) {
        let device_ns = self.device_ns(number);
        let host_ns = clock.host_ns(device_ns);
        firing.number = number;
        firing.time_s = host_ns as f64 * 1e-9;
        firing.azimuth_deg = self.rotation.azimuth_deg(device_ns);
        let state = platform.state(host_ns);
        let is_tilt_known = state.is_some();
        firing.tilt = state.unwrap_or(firing.tilt);
        firing.alive = self.sensor.used as u32;
        match self.more_rays.is_empty() {
            true => firing.aim(&self.rays, &self.mount),
            false => self.aim_one_of_several(firing),
        }
        if !is_tilt_known || !self.sensor.sees(firing.azimuth_deg) {
            firing.alive = 0;
        }
    }

    /// Aims one of several firings of an instant. Apart, since it would slow down the usual case.
    #[inline(never)]
    fn aim_one_of_several(&self, firing: &mut SimulatedFiring) {
        let count = 1 + self.more_rays.len() as u64;
        let at_once = (firing.number % count) as usize;
        let others = at_once.checked_sub(1);
        let rays = others.and_then(|other| self.more_rays.get(other));
        let rays = rays.unwrap_or(&self.rays);
        (firing.lasers, firing.first_laser) = (rays.count, rays.first);
        firing.alive = (self.sensor.used >> rays.first) as u32;
        firing.aim(rays, &self.mount);
    }
}

impl<F: FiringEffects> PacketMaker<F> {
    pub fn new(lidar: &SimulatedLidar, effects: F, surroundings: Surroundings) -> Self {
        let needs = effects.needs();
        let two = lidar.returns != ReturnMode::Strongest;
        let sensor = &lidar.sensor;
        let firings = firing_blocks(lidar.returns) * sensor.firings_per_block();
        // Without packets this one is filled and not sent.
        let model = sensor.packets.unwrap_or(PacketModel::Vlp16);
        Self {
            surroundings: surroundings.with_normals(needs.normals),
            firings: vec![lidar.firing(); firings],
            echoes: vec![Echoes::new(lidar.firing().lasers, two); firings],
            packet: DataPacketBuilder::new(model, lidar.returns),
            effects,
            needs,
        }
    }

    /// Firings per packet.
    pub const fn firings(&self) -> usize {
        self.firings.len()
    }

    pub fn into_effects(self) -> F {
        self.effects
    }

    /// Makes the packet of these blocks, and its true points where they are wanted.
    pub fn packet(
        &mut self,
        lidar: &SimulatedLidar,
        platform: &impl Platform,
        blocks: impl Iterator<Item = u64>,
        mut points: Option<&mut Vec<TruePoint>>,
    ) -> SimulatedPacket {
        let effects = self.effects.parts();
        let mut counts = ShotCounts::default();
        let points_before = points.as_ref().map_or(0, |points| points.len());
        let per_block = lidar.sensor.firings_per_block() as u64;
        let numbers = blocks.flat_map(|block| (0..per_block).map(move |n| block * per_block + n));
        for (firing, number) in self.firings.iter_mut().zip(numbers) {
            lidar.aim(firing, number, effects.clock, platform);
            counts.shots += firing.alive.count_ones();
            #[cfg(feature = "effects")]
            effects.view.hide(firing);
        }
        // Static objects for all firings together, moving objects firing by firing.
        self.surroundings.meet_all(&self.firings, &mut self.echoes);
        for (firing, echoes) in self.firings.iter().zip(&mut self.echoes) {
            #[cfg(feature = "effects")]
            if self.needs.moving {
                effects.objects.place(firing.time_s, &mut self.surroundings);
                self.surroundings.meet_bodies(firing, echoes);
            }
            #[cfg(feature = "effects")]
            effects.beam.receive(firing, &self.surroundings, echoes);
            #[cfg(feature = "effects")]
            effects.surface.reflect(firing, echoes);
            let report = FiringReport {
                lidar,
                clock: effects.clock,
                firing,
            };
            report.write(echoes, &mut self.packet, &mut counts, points.as_deref_mut());
        }
        let device_ns = |firing: &SimulatedFiring| lidar.device_ns(firing.number);
        let first_ns = self.firings.first().map_or(0, device_ns);
        let last_ns = self.firings.last().map_or(0, device_ns);
        let end_ns = last_ns.saturating_add(lidar.sensor.firing_period_ns);
        SimulatedPacket {
            payload: self.packet.finish(lidar.clock.stamp_us(first_ns)),
            leaves_ns: effects.clock.host_ns(end_ns),
            stamp_us: lidar.clock.stamp_us(end_ns),
            points: points.map_or(0, |points| points.len()) - points_before,
            counts,
        }
    }
}

/// A firing that is complete.
struct FiringReport<'a, C> {
    lidar: &'a SimulatedLidar,
    clock: &'a C,
    firing: &'a SimulatedFiring,
}

impl<C: ClockEffect> FiringReport<'_, C> {
    /// Writes the returns into the packet, and into the true points where they are wanted.
    fn write(
        &self,
        echoes: &Echoes,
        packet: &mut DataPacketBuilder,
        counts: &mut ShotCounts,
        mut points: Option<&mut Vec<TruePoint>>,
    ) {
        let lidar = self.lidar;
        let device_ns = lidar.device_ns(self.firing.number);
        let units_per_m = 1e3 / f64::from(lidar.sensor.distance_unit_mm);
        let azimuth_cdeg = lidar.rotation.azimuth_cdeg(device_ns);
        let lasers = self.firing.lasers;
        let by_range = match lidar.returns {
            ReturnMode::Strongest | ReturnMode::Unknown(_) => None,
            ReturnMode::Last | ReturnMode::Dual => Some(farther_and_nearer(echoes)),
        };
        let (first, second) = match &by_range {
            None => (&echoes.strongest, &[][..]),
            Some([far, near]) if lidar.returns == ReturnMode::Dual => {
                (far, near.get(..lasers).unwrap_or_default())
            }
            Some([far, _]) => (far, &[][..]),
        };
        let mut raw = [[(0, 0); MAX_LASERS]; 2];
        let [raw_first, raw_second] = &mut raw;
        for (laser, (echo, raw)) in first.iter().zip(raw_first).enumerate().take(lasers) {
            *raw = raw_return(echo, units_per_m);
            let returned = u32::from(raw.0 > 0);
            counts.returned += returned;
            counts.returns += returned;
            if raw.0 > 0
                && let Some(points) = &mut points
            {
                points.extend(self.point(laser, 0, echo, *raw, device_ns));
            }
        }
        for (laser, (echo, raw)) in second.iter().zip(raw_second).enumerate() {
            *raw = raw_return(echo, units_per_m);
            // A single return is in both blocks.
            if raw.0 == 0 || first.get(laser) == Some(echo) {
                continue;
            }
            counts.returns += 1;
            if let Some(points) = &mut points {
                points.extend(self.point(laser, 1, echo, *raw, device_ns));
            }
        }
        let [raw_first, raw_second] = &raw;
        packet.firing(azimuth_cdeg, raw_first, raw_second);
    }

    /// The point of a return. `None` for one from no surface, unless the lidar has no packets:
    /// these points are all that is measured.
    #[inline(never)]
    fn point(
        &self,
        laser: usize,
        number: u8,
        echo: &Echo,
        (units, reflectivity): RawReturn,
        device_ns: i64,
    ) -> Option<TruePoint> {
        let number_of_laser = self.firing.first_laser + laser;
        let beam = self.lidar.sensor.beams.get(number_of_laser)?;
        let (origin_m, direction) = self.firing.ray(laser)?;
        if !echo.true_range_m.is_finite() && self.lidar.sensor.packets.is_some() {
            return None;
        }
        let unit_m = 1e-3 * f64::from(self.lidar.sensor.distance_unit_mm);
        let (measured_from_m, along) = match self.lidar.sensor.packets {
            Some(_) => (origin_m, direction),
            None => self.known_ray(number_of_laser)?,
        };
        let device_ns = device_ns.saturating_add(beam.delay_ns);
        let after_s = beam.delay_ns as f64 * 1e-9;
        let ahead_deg = beam.azimuth_deg + self.lidar.rotation.deg_per_s() * after_s;
        let host_ns = self.clock.host_ns(device_ns);
        let tilt = self.firing.tilt;
        Some(TruePoint {
            position_m: origin_m + echo.true_range_m * direction,
            measured_m: measured_from_m + f64::from(units) * unit_m * along,
            host: (self.lidar.start).saturating_add(Span::from_nanos(host_ns)),
            device_ns,
            laser: u8::try_from(number_of_laser).ok()?,
            echo: number,
            reflectivity,
            range_m: echo.true_range_m,
            azimuth_deg: (self.firing.azimuth_deg + ahead_deg).rem_euclid(360.0),
            tilt_deg: tilt.angle_deg + tilt.rate_deg_s * after_s,
        })
    }
}

impl<C> FiringReport<'_, C> {
    /// The ray of a laser as a reader knows it: by the nominal sensor, on a base at rest.
    #[inline(never)]
    fn known_ray(&self, laser: usize) -> Option<(DVec3, DVec3)> {
        let (lidar, firing) = (self.lidar, self.firing);
        let beam = lidar.nominal.beams.get(laser)?;
        let after_s = beam.delay_ns as f64 * 1e-9;
        let azimuth_deg = firing.azimuth_deg + lidar.rotation.deg_per_s() * after_s;
        let tilt_deg = firing.tilt.angle_deg + firing.tilt.rate_deg_s * after_s;
        (lidar.nominal).ray(laser, azimuth_deg, tilt_deg, &lidar.mount)
    }
}

/// The farther and the nearer of two returns; a single return is both.
fn farther_and_nearer(echoes: &Echoes) -> [[Echo; MAX_LASERS]; 2] {
    let mut by_range = [echoes.strongest; 2];
    let [far, near] = &mut by_range;
    for ((far, near), other) in far.iter_mut().zip(near).zip(&echoes.other) {
        if other.is_present() {
            let farther = other.range_m > far.range_m || !far.is_present();
            *(if farther { far } else { near }) = *other;
        }
    }
    by_range
}

/// The nearest whole units; no return where the packet cannot express the distance.
#[inline(always)]
fn raw_return(echo: &Echo, units_per_m: f64) -> RawReturn {
    if !echo.is_present() {
        return (0, 0);
    }
    // Saturates: a negative range becomes 0, which is no return, as is one that does not fit.
    let units = (echo.range_m * units_per_m + 0.5) as u32;
    match u16::try_from(units) {
        Ok(units) if units > 0 => (units, (echo.reflectivity + 0.5) as u8),
        _ => (0, 0),
    }
}

/// Nanoseconds of a minute.
const MINUTE_NS: i64 = 60_000_000_000;

impl HeadRotation {
    /// Degrees per second.
    pub(crate) fn deg_per_s(self) -> f64 {
        6.0 * f64::from(self.rpm)
    }

    /// The azimuth at a lidar time since the start, 0..360 degrees. Whole revolutions are removed
    /// in integers, so the azimuth stays exact for runs of any length.
    pub(crate) fn azimuth_deg(self, device_ns: i64) -> f64 {
        let in_minute = device_ns.rem_euclid(MINUTE_NS);
        // Saturates only for speeds that no head has.
        let in_revolution = in_minute.saturating_mul(i64::from(self.rpm)) % MINUTE_NS;
        let rotated = 360.0 * (in_revolution as f64 / MINUTE_NS as f64);
        (self.start_deg + rotated).rem_euclid(360.0)
    }

    /// The azimuth as packets carry it: the nearest hundredth of a degree.
    fn azimuth_cdeg(self, device_ns: i64) -> u16 {
        let cdeg = (self.azimuth_deg(device_ns) * 100.0 + 0.5) as u16;
        cdeg % TURN_CDEG
    }
}

#[cfg(test)]
mod tests {
    use firmware_sim::vlp16::SEQUENCE_PERIOD_NS;

    use super::*;

    const fn rotation(rpm: u32, start_deg: f64) -> HeadRotation {
        HeadRotation { rpm, start_deg }
    }

    #[test]
    fn a_revolution_at_600_rpm_takes_a_tenth_of_a_second() {
        let rotation = rotation(600, 350.0);
        assert!((rotation.azimuth_deg(0) - 350.0).abs() < 1e-12);
        assert!((rotation.azimuth_deg(100_000_000) - 350.0).abs() < 1e-12);
        assert!((rotation.azimuth_deg(25_000_000) - 80.0).abs() < 1e-12);
        // 3600 deg/s over 55.296 us.
        assert!((rotation.azimuth_deg(SEQUENCE_PERIOD_NS) - 350.199_065_6).abs() < 1e-12);
    }

    #[test]
    fn the_azimuth_stays_exact_over_days() {
        let rotation = rotation(601, 0.0);
        let days = 100 * 86_400 * 1_000_000_000_i64;
        for ns in [0, 1, 12_345_678, 59_999_999_999] {
            assert_eq!(rotation.azimuth_deg(days + ns), rotation.azimuth_deg(ns));
        }
    }

    #[test]
    fn the_packet_azimuth_is_the_nearest_hundredth_and_wraps() {
        for (start_deg, cdeg) in [
            (359.994, 35_999),
            (359.996, 0),
            (-0.01, 35_999),
            (123.456, 12_346),
            (720.0, 0),
        ] {
            assert_eq!(rotation(0, start_deg).azimuth_cdeg(5), cdeg);
        }
    }
}
