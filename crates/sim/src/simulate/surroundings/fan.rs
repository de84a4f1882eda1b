//! Rays from one point that go nearly the same way, such as the parts of a beam: eight at a time.
//!
//! Left out: what moves.

use glam::DVec3;

use super::{First, Met, Surroundings};
use crate::cast::{LANES, Lanes, Nearest, Packets, Reach};

/// Rays, and what each met first of what stands.
struct Fan<'a> {
    around: &'a Surroundings,
    origin_m: DVec3,
    directions: &'a [DVec3],
    take: &'a mut dyn FnMut(usize, Option<First>),
}

impl Packets for Fan<'_> {
    fn load(&self, packet: usize, lanes: &mut Lanes) -> u64 {
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
            let first = self
                .around
                .first_of_lane(self.origin_m, *direction, nearest, lane);
            (self.take)(ray, first);
        }
    }
}

impl Surroundings {
    /// As [`Surroundings::meet`] for every direction, up to the shorter of both lists.
    pub fn meet_fan(&self, origin_m: DVec3, directions: &[DVec3], mets: &mut [Option<Met>]) {
        self.fan(origin_m, directions, &mut |ray, first| {
            if let (Some(met), Some(direction)) = (mets.get_mut(ray), directions.get(ray)) {
                *met = self.nearer(origin_m, *direction, first);
            }
        });
    }

    /// As [`Surroundings::meet_still`] for every direction, up to the shorter of both lists.
    pub fn meet_fan_still(&self, origin_m: DVec3, directions: &[DVec3], mets: &mut [Option<Met>]) {
        self.fan(origin_m, directions, &mut |ray, first| {
            if let Some(met) = mets.get_mut(ray) {
                *met = first.and_then(|first| self.seen(first));
            }
        });
    }

    fn fan(
        &self,
        origin_m: DVec3,
        directions: &[DVec3],
        take: &mut dyn FnMut(usize, Option<First>),
    ) {
        let mut fan = Fan {
            around: self,
            origin_m,
            directions,
            take,
        };
        let packets = directions.len().div_ceil(LANES);
        let reach = Reach::up_to(self.reach.max_m);
        self.scene.caster().nearest_in(packets, reach, &mut fan);
    }
}
