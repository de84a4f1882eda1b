//! The firings of a packet, cast together: eight rays of one laser at a time, which go nearly the same way.
//!
//! Left out: what moves.

use crate::cast::{LANES, Lanes, Nearest, Packets, Reach};
use glam::DVec3;

use super::super::firing::{Echo, Echoes, Firing};
use super::{First, Surroundings};
use crate::sensor::MOST_LASERS;

/// Firings that follow one another, and what comes back to them.
struct Volley<'a> {
    around: &'a Surroundings,
    firings: &'a [Firing],
    echoes: &'a mut [Echoes],
    /// Packets of each laser.
    per_laser: usize,
}

impl Volley<'_> {
    /// Which laser's a packet is, and the first of its firings.
    const fn place(&self, packet: usize) -> (usize, usize) {
        (packet / self.per_laser, packet % self.per_laser * LANES)
    }
}

impl Packets for Volley<'_> {
    fn load(&self, packet: usize, lanes: &mut Lanes) -> u64 {
        let (laser, first) = self.place(packet);
        let mut loaded = 0;
        let firings = self.firings.iter().skip(first).take(LANES);
        for (lane, firing) in firings.enumerate() {
            if firing.is_alive(laser)
                && let (Some(origin), Some(direction)) =
                    (firing.origins_m.get(laser), firing.directions.get(laser))
            {
                lanes.set(lane, *origin, *direction);
                loaded |= 1 << lane;
            }
        }
        loaded
    }

    fn take(&mut self, packet: usize, loaded: u64, nearest: &Nearest) {
        let (laser, first) = self.place(packet);
        let around = self.around;
        let both = self.firings.iter().zip(&mut *self.echoes);
        for (lane, (firing, echoes)) in both.skip(first).take(LANES).enumerate() {
            let met = match loaded >> lane & 1 {
                1 => firing
                    .ray(laser)
                    .and_then(|(from, to)| around.first_of_lane(from, to, nearest, lane)),
                _ => None,
            };
            if !around.still
                && let Some(standing_m) = echoes.standing_m.get_mut(laser)
            {
                *standing_m = met.map_or(around.reach.max_m, |first| first.met.range_m);
            }
            if let Some(echo) = echoes.strongest.get_mut(laser) {
                *echo = Echo::of_any(met.and_then(|first| around.seen(first)));
            }
        }
    }
}

impl Surroundings {
    /// What stands, as all lasers meet it of firings that follow one another; those that are not alive have no echo, and nobody has a second one.
    pub(crate) fn meet_all(&self, firings: &[Firing], echoes: &mut [Echoes]) {
        for echoes in echoes.iter_mut().filter(|echoes| echoes.two) {
            echoes.other = [Echo::NONE; MOST_LASERS];
        }
        let lasers = firings.first().map_or(0, |firing| firing.lasers);
        let per_laser = firings.len().min(echoes.len()).div_ceil(LANES).max(1);
        let mut volley = Volley {
            around: self,
            firings,
            echoes,
            per_laser,
        };
        let reach = Reach::up_to(self.reach.max_m);
        (self.scene.caster()).nearest_in(lasers * per_laser, reach, &mut volley);
    }

    /// What a ray met, by its lane.
    #[inline]
    pub(super) fn first_of_lane(
        &self,
        origin_m: DVec3,
        direction: DVec3,
        nearest: &Nearest,
        lane: usize,
    ) -> Option<First> {
        let hit = nearest.best(lane).hit()?;
        let material = self.scene.material(&hit)?;
        let normal = match self.normals {
            true => {
                let point = origin_m + hit.range_m * direction;
                self.scene.caster().normal(&hit, point)
            }
            false => DVec3::ZERO,
        };
        Some(First::new(&hit.with_normal(normal), material))
    }
}
