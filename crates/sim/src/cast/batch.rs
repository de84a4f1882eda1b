//! Many rays: eight of one beam together, from any storage, on one thread or several.
//!
//! [`Caster`] casts the eight rays.

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::caster::{Caster, Stacks};
use super::packet::{LANES, Lanes, Nearest};
use super::ray::{Hit, Normal, Ray, Reach};
use super::threads::Threads;

/// Packets of each beam that one thread takes at a time.
const PACKETS_AT_A_TIME: usize = 8;

/// Rays in firing order: `beams` of them per firing, firing after firing.
///
/// Rays of one beam in consecutive firings are cast together. Rays without such an order are one
/// beam.
#[derive(Clone, Copy, Debug)]
pub struct Rays<'a> {
    rays: &'a [Ray],
    beams: usize,
}

impl<'a> Rays<'a> {
    /// Rays of firings with this number of beams; zero counts as one. The last firing may be
    /// partial.
    #[must_use]
    pub fn new(rays: &'a [Ray], beams: usize) -> Self {
        // More beams than rays: one firing, of which there are these.
        let beams = beams.clamp(1, rays.len().max(1));
        Self { rays, beams }
    }
}

/// A source of packets of up to eight rays and a destination of their hits, without copies of the
/// rays.
pub(crate) trait Packets {
    /// Sets the lanes of a packet. The result has a bit for each lane with a ray, bit 0 for the
    /// first. An invalid ray hits nothing.
    fn load(&self, packet: usize, lanes: &mut Lanes) -> u64;

    /// Takes what those lanes hit.
    fn take(&mut self, packet: usize, loaded: u64, nearest: &Nearest);
}

/// Rays of a list, and their hits in another.
struct Piece<'a, N> {
    caster: &'a Caster,
    rays: &'a [Ray],
    beams: usize,
    hits: &'a mut [Option<Hit<N>>],
}

impl<N> Piece<'_, N> {
    /// Packets of each beam.
    const fn per_beam(&self) -> usize {
        self.rays.len().div_ceil(self.beams).div_ceil(LANES)
    }

    /// Places of a packet's rays in the list.
    fn places(&self, packet: usize) -> impl Iterator<Item = (usize, usize)> + use<N> {
        let (beams, per_beam) = (self.beams, self.per_beam().max(1));
        let (beam, first) = (packet / per_beam, packet % per_beam * LANES);
        (0..LANES).map(move |lane| (lane, (first + lane) * beams + beam))
    }
}

impl<N: Normal> Packets for Piece<'_, N> {
    fn load(&self, packet: usize, lanes: &mut Lanes) -> u64 {
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
            if let Some((ray, hit)) = self.rays.get(place).zip(self.hits.get_mut(place)) {
                *hit = self.caster.finish(ray, nearest.best(lane).hit());
            }
        }
    }
}

impl Caster {
    /// As [`Caster::nearest`] for every ray in order, up to the length of the shorter list.
    pub fn nearest_of<N: Normal>(
        &self,
        rays: &Rays<'_>,
        reach: Reach,
        threads: &Threads,
        hits: &mut [Option<Hit<N>>],
    ) {
        let Rays { rays, beams } = *rays;
        let piece = beams.saturating_mul(LANES * PACKETS_AT_A_TIME);
        let work = |(rays, hits): (&[Ray], &mut [Option<Hit<N>>])| {
            let mut piece = Piece {
                caster: self,
                rays,
                beams,
                hits,
            };
            self.nearest_in(beams * piece.per_beam(), reach, &mut piece);
        };
        match threads.pool() {
            None => rays
                .chunks(piece)
                .zip(hits.chunks_mut(piece))
                .for_each(work),
            Some(pool) => pool.install(|| {
                let pieces = rays.par_chunks(piece);
                pieces.zip(hits.par_chunks_mut(piece)).for_each(work);
            }),
        }
    }

    /// Casts packets of rays on the caller's thread.
    // Not generic over where they come from, so that it is compiled once.
    pub(crate) fn nearest_in(&self, packets: usize, reach: Reach, of: &mut dyn Packets) {
        let reach = reach.clean();
        dispatch!(self.level, simd => self.packets(simd, packets, reach, of));
    }

    /// The same in the registers there are.
    #[inline(always)]
    fn packets<S: Simd>(&self, simd: S, packets: usize, reach: Reach, of: &mut dyn Packets) {
        let mut stacks = Stacks::new();
        let mut lanes = Lanes::ZERO;
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
