//! Eight rays side by side, and the nearest that each has hit.
//!
//! Consecutive rays of a lidar go nearly the same way and walk a tree together. Where they do not,
//! they walk it one by one; the result is the same, bit for bit.

use fearless_simd::{Simd, f64x8, mask64x8, prelude::*, u64x8};

use glam::DVec3;

use super::beam::Spread;
use super::ray::{FARTHEST_M, Hit, LENGTH_TOLERANCE, ObjectId};

/// Rays of a packet.
pub(crate) const LANES: usize = 8;

/// Origins and directions by coordinate, in some frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayLanes {
    pub(super) origin: [[f64; LANES]; 3],
    pub(super) direction: [[f64; LANES]; 3],
}

impl RayLanes {
    pub(super) const ZERO: Self = Self {
        origin: [[0.0; LANES]; 3],
        direction: [[0.0; LANES]; 3],
    };

    /// One of the rays: origin and direction.
    #[inline(always)]
    pub(super) fn ray(&self, lane: usize) -> ([f64; 3], [f64; 3]) {
        let lane = lane % LANES;
        let ([a, b, c], [d, e, f]) = (&self.origin, &self.direction);
        ([a[lane], b[lane], c[lane]], [d[lane], e[lane], f[lane]])
    }

    /// Sets one of the rays.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, origin: DVec3, direction: DVec3) {
        let lane = lane % LANES;
        let ([a, b, c], [d, e, f]) = (&mut self.origin, &mut self.direction);
        (a[lane], b[lane], c[lane]) = (origin.x, origin.y, origin.z);
        (d[lane], e[lane], f[lane]) = (direction.x, direction.y, direction.z);
    }

    /// Puts the first of these lanes in place of all others, so that those widen no beam.
    #[inline(always)]
    pub(super) fn fill(&mut self, lanes: u64) {
        let first = lanes.trailing_zeros() as usize % LANES;
        let (origin, direction) = self.ray(first);
        for lane in 0..LANES {
            if lanes >> lane & 1 == 0 {
                self.set(lane, origin.into(), direction.into());
            }
        }
    }

    /// Those of the lanes that are rays: as [`super::Ray::new`] has them.
    #[inline(always)]
    pub(super) fn sound<S: Simd>(&self, simd: S) -> u64 {
        let [x, y, z] = loaded(simd, &self.direction);
        let off = (x * x + y * y + z * z - 1.0).abs();
        // A NaN fails every comparison.
        let mut sound = off.simd_le(2.0 * LENGTH_TOLERANCE);
        for coordinate in loaded(simd, &self.origin) {
            sound &= coordinate.abs().simd_le(FARTHEST_M);
        }
        sound.to_bitmask()
    }

    /// The lanes with the same dominant axis and the same signs as the first of them; and that
    /// axis.
    #[inline(always)]
    pub(super) fn alike<S: Simd>(&self, simd: S, lanes: u64) -> (u64, usize) {
        let [x, y, z] = loaded(simd, &self.direction);
        let mut alike = lanes;
        let first = lanes.trailing_zeros();
        for d in [x, y, z] {
            let negative = d.simd_lt(0.0).to_bitmask();
            alike &= if negative >> first & 1 == 1 {
                negative
            } else {
                !negative
            };
        }
        let (x, y, z) = (x.abs(), y.abs(), z.abs());
        let along_x = (x.simd_ge(y) & x.simd_ge(z)).to_bitmask();
        let along_y = !along_x & y.simd_ge(z).to_bitmask();
        let (axis, along) = if along_x >> first & 1 == 1 {
            (0, along_x)
        } else if along_y >> first & 1 == 1 {
            (1, along_y)
        } else {
            (2, !(along_x | along_y))
        };
        (alike & along, axis)
    }
}

/// Coordinates in registers.
#[inline(always)]
pub(super) fn loaded<S: Simd>(simd: S, [x, y, z]: &[[f64; LANES]; 3]) -> [f64x8<S>; 3] {
    [
        f64x8::load_array_ref(simd, x),
        f64x8::load_array_ref(simd, y),
        f64x8::load_array_ref(simd, z),
    ]
}

/// The least and the greatest of each coordinate.
#[inline(always)]
pub(super) fn spread<S: Simd>(of: [f64x8<S>; 3]) -> Spread {
    let [x, y, z] = of;
    Spread {
        low: [x.reduce_min(), y.reduce_min(), z.reduce_min()],
        high: [x.reduce_max(), y.reduce_max(), z.reduce_max()],
    }
}

/// Parameters of a test of an object: distance above which hits count, and the object's number.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectTest {
    pub above_m: f64,
    pub object: u32,
}

/// Behind every object.
const NONE: u64 = u64::MAX;

/// The nearest hit of one ray so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Best {
    pub(super) range_m: f64,
    /// Object, then primitive, which order equal distances; [`NONE`] without a hit.
    what: u64,
}

impl Best {
    /// Nothing yet; nothing farther than this will count.
    #[inline(always)]
    pub(super) const fn within(up_to_m: f64) -> Self {
        Self {
            range_m: up_to_m,
            what: NONE,
        }
    }

    /// Takes a hit if it is nearer than the present one; the caller checks the lower limit.
    #[inline(always)]
    pub(super) fn offer(&mut self, range_m: f64, object: u32, primitive: u32) {
        let what = u64::from(object) << 32 | u64::from(primitive);
        if range_m < self.range_m || range_m == self.range_m && what < self.what {
            *self = Self { range_m, what };
        }
    }

    /// The hit.
    #[inline(always)]
    pub(crate) fn hit(self) -> Option<Hit> {
        (self.what != NONE).then(|| Hit {
            range_m: self.range_m,
            object: ObjectId::new((self.what >> 32) as u32),
            primitive: self.what as u32,
        })
    }
}

/// The nearest hits of eight rays so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    range_m: [f64; LANES],
    what: [u64; LANES],
}

impl Nearest {
    /// Nothing yet; nothing farther than this will count.
    #[inline(always)]
    pub(super) const fn within(up_to_m: f64) -> Self {
        Self {
            range_m: [up_to_m; LANES],
            what: [NONE; LANES],
        }
    }

    /// The largest distance at which any of these lanes looks for hits.
    #[inline(always)]
    pub(super) fn farthest<S: Simd>(&self, simd: S, lanes: u64) -> f64 {
        let ranges = f64x8::simd_from(simd, self.range_m);
        let wanted = mask64x8::from_bitmask(simd, lanes);
        wanted
            .select(ranges, f64x8::splat(simd, f64::NEG_INFINITY))
            .reduce_max()
    }

    /// One ray's.
    #[inline(always)]
    pub(crate) fn best(&self, lane: usize) -> Best {
        Best {
            range_m: self.range_m[lane % LANES],
            what: self.what[lane % LANES],
        }
    }

    /// One ray's, taken back.
    #[inline(always)]
    pub(super) fn put(&mut self, lane: usize, best: Best) {
        self.range_m[lane % LANES] = best.range_m;
        self.what[lane % LANES] = best.what;
    }

    /// Like [`Best::offer`] for the lanes with a hit above the lower limit, each with its own
    /// primitive. Returns whether any was taken.
    #[inline(always)]
    pub(super) fn offer8<S: Simd>(
        &mut self,
        simd: S,
        lanes: u64,
        met: f64x8<S>,
        ask: ObjectTest,
        primitives: u64x8<S>,
    ) -> bool {
        let had = f64x8::load_array_ref(simd, &self.range_m);
        let had_what = u64x8::load_array_ref(simd, &self.what);
        let what = primitives | u64::from(ask.object) << 32;
        // Of a NaN none is true.
        let nearer = met.simd_lt(had) | (met.simd_eq(had) & what.simd_lt(had_what));
        let taken = nearer & met.simd_gt(ask.above_m) & mask64x8::from_bitmask(simd, lanes);
        self.range_m = taken.select(met, had).into();
        self.what = taken.select(what, had_what).into();
        taken.to_bitmask() != 0
    }
}
