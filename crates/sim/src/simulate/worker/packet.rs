//! One packet after the other: what a thread does.
//!
//! Where no effect is asked for, what is called here is `()` and compiles to nothing. A build without the feature `effects` does not even call it: a test holds
//! the two against each other.

use firmware_sim::vlp16::DataPacketBuilder;

use super::{Chunk, Job, Packet};
#[cfg(feature = "effects")]
use crate::effects::{Beam, Objects, Surface, View};
use crate::effects::{Clock, FiringEffects};
use crate::sensor::{MOST_LASERS, ReturnMode};
use crate::simulate::{Echo, Echoes, Firing, Spin, Surroundings, TruePoint};

/// What a thread works with.
pub(super) struct Worker<'a, F> {
    job: &'a Job<'a>,
    effects: F,
    surroundings: Surroundings,
    /// The firings of a packet, and what comes back to each.
    firings: Vec<Firing>,
    echoes: Vec<Echoes>,
    packet: DataPacketBuilder,
}

/// A return on the wire: distance in the sensor's units, calibrated reflectivity.
type Raw = (u16, u8);

/// What is reported of a firing.
struct Reported {
    /// In a single-return mode that one, in dual return the last.
    first: [Echo; MOST_LASERS],
    /// In dual return the other; the same where only one came back.
    second: [Echo; MOST_LASERS],
}

impl<'a, F: FiringEffects> Worker<'a, F> {
    pub fn new(job: &'a Job<'a>, effects: F) -> Self {
        let simulation = job.simulation;
        let two = simulation.returns != ReturnMode::Strongest;
        let model = simulation.sensor.model();
        let firings =
            firmware_sim::vlp16::firing_blocks(simulation.returns) * model.firings_per_block();
        Self {
            surroundings: Surroundings::new(
                simulation.scene.clone(),
                simulation.sensor.reach(),
                !job.needs.moving,
            )
            .with_normals(job.needs.normals),
            firings: vec![Firing::new(job.rays.count); firings],
            echoes: vec![Echoes::new(job.rays.count, two); firings],
            packet: DataPacketBuilder::new(simulation.sensor.model(), simulation.returns),
            job,
            effects,
        }
    }

    pub fn into_effects(self) -> F {
        self.effects
    }

    /// Makes a packet: all its firings side by side. Where each effect acts is to be read here.
    pub fn packet(&mut self, number: u64, chunk: &mut Chunk) {
        let job = self.job;
        let effects = self.effects.parts();
        let mut made = Counts::default();
        let points = chunk.points.len();
        let per_block = job.simulation.sensor.model().firings_per_block() as u64;
        let blocks = job.schedule.blocks(number);
        let numbers = blocks.flat_map(|block| (0..per_block).map(move |n| block * per_block + n));
        for (firing, number) in self.firings.iter_mut().zip(numbers) {
            job.aim(firing, number, effects.clock);
            made.shots += firing.alive.count_ones();
            #[cfg(feature = "effects")]
            effects.view.look(firing);
        }
        // What stands, all at once; what moves, firing by firing.
        self.surroundings.meet_all(&self.firings, &mut self.echoes);
        for (firing, echoes) in self.firings.iter().zip(&mut self.echoes) {
            #[cfg(feature = "effects")]
            if job.needs.moving {
                effects.objects.place(firing.at_s, &mut self.surroundings);
                self.surroundings.meet_bodies(firing, echoes);
            }
            #[cfg(feature = "effects")]
            effects.beam.receive(firing, &self.surroundings, echoes);
            #[cfg(feature = "effects")]
            effects.surface.reflect(firing, echoes);
            let told = Told {
                job,
                clock: effects.clock,
                firing,
            };
            told.report(echoes, &mut self.packet, &mut made, &mut chunk.points);
        }
        let device_ns = |firing: &Firing| job.device_ns(firing.number);
        let first_ns = self.firings.first().map_or(0, device_ns);
        let last_ns = self.firings.last().map_or(0, device_ns);
        let end_ns = last_ns.saturating_add(job.simulation.sensor.model().firing_period_ns());
        chunk.packets.push(Packet {
            payload: self.packet.finish(job.clock.stamp_us(first_ns)),
            leaves_ns: effects.clock.host_ns(end_ns),
            stamp_us: job.clock.stamp_us(end_ns),
            points: chunk.points.len() - points,
            shots: made.shots,
            returned: made.returned,
            returns: made.returns,
        });
    }
}

impl Job<'_> {
    /// When a firing begins, in the lidar's own time since the start.
    fn device_ns(&self, firing: u64) -> i64 {
        signed(firing).saturating_mul(self.simulation.sensor.model().firing_period_ns())
    }

    /// A firing's time, azimuth, tilt and rays.
    #[inline]
    fn aim<C: Clock>(&self, firing: &mut Firing, number: u64, clock: &C) {
        let device_ns = self.device_ns(number);
        firing.number = number;
        firing.at_s = clock.host_ns(device_ns) as f64 * 1e-9;
        firing.azimuth_deg = self.simulation.spin.azimuth_deg(device_ns);
        firing.tilt = self.course.platform(firing.at_s);
        firing.alive = self.simulation.sensor.used();
        firing.aim(&self.rays, &self.simulation.mount);
    }
}

/// A firing that is over, to be told of.
struct Told<'a, C> {
    job: &'a Job<'a>,
    clock: &'a C,
    firing: &'a Firing,
}

impl<C: Clock> Told<'_, C> {
    /// Puts what came back into the packet, and into the truth where that is wanted.
    fn report(
        &self,
        echoes: &Echoes,
        packet: &mut DataPacketBuilder,
        made: &mut Counts,
        points: &mut Vec<TruePoint>,
    ) {
        let job = self.job;
        let simulation = job.simulation;
        let device_ns = job.device_ns(self.firing.number);
        let model = simulation.sensor.model();
        let per_m = 1e3 / f64::from(model.distance_unit_mm());
        let azimuth_cdeg = simulation.spin.azimuth_cdeg(device_ns);
        let lasers = self.firing.lasers;
        let reported = match simulation.returns {
            ReturnMode::Strongest | ReturnMode::Unknown(_) => None,
            ReturnMode::Last | ReturnMode::Dual => Some(by_range(echoes)),
        };
        let (first, second) = match &reported {
            None => (&echoes.strongest, &[][..]),
            Some(both) if simulation.returns == ReturnMode::Dual => {
                (&both.first, both.second.get(..lasers).unwrap_or_default())
            }
            Some(both) => (&both.first, &[][..]),
        };
        let mut raw = [[(0, 0); MOST_LASERS]; 2];
        let [raw_first, raw_second] = &mut raw;
        for (laser, (echo, raw)) in first.iter().zip(raw_first).enumerate().take(lasers) {
            *raw = on_the_wire(echo, per_m);
            let there = u32::from(raw.0 > 0);
            made.returned += there;
            made.returns += there;
            if job.truth && raw.0 > 0 {
                points.extend(self.point(laser, 0, echo, raw.1, device_ns));
            }
        }
        for (laser, (echo, raw)) in second.iter().zip(raw_second).enumerate() {
            *raw = on_the_wire(echo, per_m);
            // One return alone is in both blocks.
            if raw.0 == 0 || first.get(laser) == Some(echo) {
                continue;
            }
            made.returns += 1;
            if job.truth {
                points.extend(self.point(laser, 1, echo, raw.1, device_ns));
            }
        }
        let [raw_first, raw_second] = &raw;
        packet.firing(azimuth_cdeg, raw_first, raw_second);
    }

    /// The truth of an echo; none where no surface made it.
    fn point(
        &self,
        laser: usize,
        echo: u8,
        of: &Echo,
        reflectivity: u8,
        device_ns: i64,
    ) -> Option<TruePoint> {
        let simulation = self.job.simulation;
        let beam = simulation.sensor.beams().get(laser)?;
        let (origin, direction) = (
            self.firing.origins_m.get(laser)?,
            self.firing.directions.get(laser)?,
        );
        if !of.true_range_m.is_finite() {
            return None;
        }
        let device_ns = device_ns.saturating_add(beam.delay_ns);
        let after_s = beam.delay_ns as f64 * 1e-9;
        let ahead_deg = beam.azimuth_deg + simulation.spin.deg_per_s() * after_s;
        let host_ns = self.clock.host_ns(device_ns);
        let tilt = self.firing.tilt;
        Some(TruePoint {
            position_m: *origin + of.true_range_m * *direction,
            host: simulation.host(host_ns),
            device_ns,
            laser: u8::try_from(laser).ok()?,
            echo,
            reflectivity,
            range_m: of.true_range_m,
            azimuth_deg: (self.firing.azimuth_deg + ahead_deg).rem_euclid(360.0),
            tilt_deg: tilt.angle_deg + tilt.rate_deg_s * after_s,
        })
    }
}

/// What was counted of a packet.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    shots: u32,
    returned: u32,
    returns: u32,
}

/// The farther of two returns, and the nearer; one alone is both.
fn by_range(echoes: &Echoes) -> Reported {
    let mut reported = Reported {
        first: echoes.strongest,
        second: echoes.strongest,
    };
    let both = reported.first.iter_mut().zip(&mut reported.second);
    for ((last, other), also) in both.zip(&echoes.other) {
        if also.is_there() {
            let farther = also.range_m > last.range_m || !last.is_there();
            *(if farther { last } else { other }) = *also;
        }
    }
    reported
}

/// The nearest whole units; none where the packet cannot say it.
#[inline(always)]
fn on_the_wire(echo: &Echo, per_m: f64) -> Raw {
    if !echo.is_there() {
        return (0, 0);
    }
    // Saturates: a negative range is 0, which is no return, as is one that does not fit.
    let units = (echo.range_m * per_m + 0.5) as u32;
    match u16::try_from(units) {
        Ok(units) if units > 0 => (units, (echo.reflectivity + 0.5) as u8),
        _ => (0, 0),
    }
}

fn signed(number: u64) -> i64 {
    i64::try_from(number).unwrap_or(i64::MAX)
}

impl Spin {
    /// The azimuth at a device time, 0..360 degrees, exact for any length of run.
    pub(super) fn azimuth_deg(self, device_ns: i64) -> f64 {
        let spin = crate::world::Spin {
            rpm: self.rpm,
            at_start: units::Degrees(self.start_deg),
        };
        spin.azimuth(device_ns).0
    }

    /// The same as the wire has it.
    fn azimuth_cdeg(self, device_ns: i64) -> u16 {
        let cdeg = (self.azimuth_deg(device_ns) * 100.0 + 0.5) as u16;
        cdeg % firmware_sim::vlp16::TURN_CDEG
    }
}
