//! Rays cast eight at a time: those of one laser over the firings of a packet, and those from one
//! origin, such as the parts of a beam. Both kinds go nearly the same way.

use glam::DVec3;

use super::surroundings::FirstSurface;
use super::{Echo, Echoes, SimulatedFiring, Surroundings};
use crate::cast::{LANES, Nearest, Packets, RayLanes, Reach};
use crate::sensor::MAX_LASERS;

/// Consecutive firings and their returns.
struct FiringRays<'a> {
    surroundings: &'a Surroundings,
    firings: &'a [SimulatedFiring],
    echoes: &'a mut [Echoes],
    packets_per_laser: usize,
}

impl FiringRays<'_> {
    /// The laser of a packet, and the packet's first firing.
    const fn laser_and_firing(&self, packet: usize) -> (usize, usize) {
        let (laser, part) = (
            packet / self.packets_per_laser,
            packet % self.packets_per_laser,
        );
        (laser, part * LANES)
    }
}

impl Packets for FiringRays<'_> {
    fn load(&self, packet: usize, lanes: &mut RayLanes) -> u64 {
        let (laser, first) = self.laser_and_firing(packet);
        let mut loaded = 0;
        let firings = self.firings.iter().skip(first).take(LANES);
        for (lane, firing) in firings.enumerate() {
            if firing.is_alive(laser)
                && let Some((origin_m, direction)) = firing.ray(laser)
            {
                lanes.set(lane, origin_m, direction);
                loaded |= 1 << lane;
            }
        }
        loaded
    }

    fn take(&mut self, packet: usize, loaded: u64, nearest: &Nearest) {
        let (laser, first) = self.laser_and_firing(packet);
        let surroundings = self.surroundings;
        let both = self.firings.iter().zip(&mut *self.echoes);
        for (lane, (firing, echoes)) in both.skip(first).take(LANES).enumerate() {
            let met = match loaded >> lane & 1 {
                1 => firing.ray(laser).and_then(|(origin_m, direction)| {
                    surroundings.first_of_lane(origin_m, direction, nearest, lane)
                }),
                _ => None,
            };
            if !surroundings.is_static
                && let Some(static_m) = echoes.static_m.get_mut(laser)
            {
                *static_m = met.map_or(surroundings.range.max_m, |first| first.met.range_m);
            }
            if let Some(echo) = echoes.strongest.get_mut(laser) {
                *echo = Echo::from_met(met.and_then(|first| surroundings.returning(first)));
            }
        }
    }
}

/// See [`Surroundings::meet_all`].
pub(super) fn firings(
    surroundings: &Surroundings,
    firings: &[SimulatedFiring],
    echoes: &mut [Echoes],
) {
    for echoes in echoes.iter_mut().filter(|echoes| echoes.two) {
        echoes.other = [Echo::NONE; MAX_LASERS];
    }
    let lasers = firings.first().map_or(0, |firing| firing.lasers);
    let packets_per_laser = firings.len().min(echoes.len()).div_ceil(LANES).max(1);
    let mut rays = FiringRays {
        surroundings,
        firings,
        echoes,
        packets_per_laser,
    };
    let reach = Reach::up_to(surroundings.range.max_m);
    let caster = surroundings.scene.caster();
    caster.nearest_in(lasers * packets_per_laser, reach, &mut rays);
}

/// Rays from one origin. `take` gets the number of each and its first static surface.
struct FanRays<'a> {
    surroundings: &'a Surroundings,
    origin_m: DVec3,
    directions: &'a [DVec3],
    take: &'a mut dyn FnMut(usize, Option<FirstSurface>),
}

impl Packets for FanRays<'_> {
    fn load(&self, packet: usize, lanes: &mut RayLanes) -> u64 {
        let mut loaded = 0;
        let directions = self.directions.iter().skip(packet * LANES).take(LANES);
        for (lane, direction) in directions.enumerate() {
            lanes.set(lane, self.origin_m, *direction);
            loaded |= 1 << lane;
        }
        loaded
    }

    fn take(&mut self, packet: usize, _: u64, nearest: &Nearest) {
        let directions = self.directions.iter().enumerate();
        let of_packet = directions.skip(packet * LANES).take(LANES);
        for (lane, (ray, direction)) in of_packet.enumerate() {
            let first = (self.surroundings).first_of_lane(self.origin_m, *direction, nearest, lane);
            (self.take)(ray, first);
        }
    }
}

/// Casts rays from one origin; see [`Surroundings::cast_fan`].
pub(super) fn fan(
    surroundings: &Surroundings,
    origin_m: DVec3,
    directions: &[DVec3],
    take: &mut dyn FnMut(usize, Option<FirstSurface>),
) {
    let mut rays = FanRays {
        surroundings,
        origin_m,
        directions,
        take,
    };
    let packets = directions.len().div_ceil(LANES);
    let reach = Reach::up_to(surroundings.range.max_m);
    (surroundings.scene.caster()).nearest_in(packets, reach, &mut rays);
}

impl Surroundings {
    /// The surface that the ray of a lane meets.
    #[inline]
    fn first_of_lane(
        &self,
        origin_m: DVec3,
        direction: DVec3,
        nearest: &Nearest,
        lane: usize,
    ) -> Option<FirstSurface> {
        let hit = nearest.best(lane).hit()?;
        FirstSurface::new(&self.scene, &hit, origin_m, direction, self.normals)
    }
}
