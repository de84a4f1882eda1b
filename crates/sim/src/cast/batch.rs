//! Many rays: eight of one beam together, from any storage.
//!
//! [`Caster`] casts the eight rays.

use fearless_simd::{Simd, dispatch};

use super::caster::{Caster, Stacks};
use super::packet::{LANES, Nearest, RayLanes};
use super::ray::{Hit, Ray, Reach};

/// Packets of each beam that are cast before those of the next beam.
const PACKETS_AT_A_TIME: usize = 8;

/// A source of packets of up to eight rays and a destination of their hits, without copies of the
/// rays.
pub(crate) trait Packets {
    /// Sets the lanes of a packet. The result has a bit for each lane with a ray, bit 0 for the
    /// first. An invalid ray hits nothing.
    fn load(&self, packet: usize, lanes: &mut RayLanes) -> u64;

    /// Takes what those lanes hit.
    fn take(&mut self, packet: usize, loaded: u64, nearest: &Nearest);
}

/// Rays of a list, and their hits in another.
struct Piece<'a> {
    rays: &'a [Ray],
    beams: usize,
    hits: &'a mut [Option<Hit>],
}

impl Piece<'_> {
    /// Packets of each beam.
    const fn per_beam(&self) -> usize {
        self.rays.len().div_ceil(self.beams).div_ceil(LANES)
    }

    /// Places of a packet's rays in the list.
    fn places(&self, packet: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (beams, per_beam) = (self.beams, self.per_beam().max(1));
        let (beam, first) = (packet / per_beam, packet % per_beam * LANES);
        (0..LANES).map(move |lane| (lane, (first + lane) * beams + beam))
    }
}

impl Packets for Piece<'_> {
    fn load(&self, packet: usize, lanes: &mut RayLanes) -> u64 {
        let mut loaded = 0;
        for (lane, place) in self.places(packet) {
            if let Some(ray) = self.rays.get(place) {
                lanes.set(lane, ray.origin_m(), ray.direction());
                loaded |= 1 << lane;
            }
        }
        loaded
    }

    fn take(&mut self, packet: usize, _: u64, nearest: &Nearest) {
        for (lane, place) in self.places(packet) {
            if let Some(hit) = self.hits.get_mut(place) {
                *hit = nearest.best(lane).hit();
            }
        }
    }
}

impl Caster {
    /// Like [`Caster::nearest`] for every ray, up to the length of the shorter list.
    ///
    /// Rays are in firing order, `beams` of them per firing (zero counts as one); the last firing
    /// may be partial. Rays of one beam in consecutive firings are cast together.
    pub fn nearest_of(&self, rays: &[Ray], beams: usize, reach: Reach, hits: &mut [Option<Hit>]) {
        // More beams than rays: one firing, of which there are these.
        let beams = beams.clamp(1, rays.len().max(1));
        let piece = beams.saturating_mul(LANES * PACKETS_AT_A_TIME);
        for (rays, hits) in rays.chunks(piece).zip(hits.chunks_mut(piece)) {
            let mut piece = Piece { rays, beams, hits };
            self.nearest_in(beams * piece.per_beam(), reach, &mut piece);
        }
    }

    /// Casts packets of rays.
    // Not generic over where they come from, so that it is compiled once.
    pub(crate) fn nearest_in(&self, packets: usize, reach: Reach, of: &mut dyn Packets) {
        let reach = reach.clean();
        dispatch!(self.level, simd => self.packets(simd, packets, reach, of));
    }

    /// The same in the registers there are.
    #[inline(always)]
    fn packets<S: Simd>(&self, simd: S, packets: usize, reach: Reach, of: &mut dyn Packets) {
        let mut stacks = Stacks::new();
        let mut lanes = RayLanes::ZERO;
        for packet in 0..packets {
            let loaded = of.load(packet, &mut lanes);
            let wanted = loaded & lanes.sound(simd);
            let nearest = match wanted {
                0 => Nearest::within(reach.up_to_m),
                _ => self.eight(simd, &mut stacks, &mut lanes, wanted, reach),
            };
            of.take(packet, loaded, &nearest);
        }
    }
}
