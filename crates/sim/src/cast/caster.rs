//! Objects in a scene, and the first hit of a ray among them.
//!
//! Finite objects are in a tree of their own, relative to the middle of the scene; endless planes
//! are tested one after the other. `surface` tests one object.

use fearless_simd::{Level, Simd, dispatch};
use thiserror::Error;

use glam::DVec3;

use super::beam::{Beam, up_to};
use super::build::Quality;
use super::bvh::{BoundingBox, Bvh, MOST_ITEMS, Stack};
use super::mesh::short_middle;
use super::packet::{Best, Nearest, ObjectTest, RayLanes, loaded, spread};
use super::ray::{Hit, Ray, Reach};
use super::surface::Object;

/// Up to this number, objects are tested one after the other.
const FEW: usize = 4;
/// Rays whose directions differ by more than this go one by one.
const WIDE: f64 = 0.15;
/// Rays whose origins differ by more than this, relative to the size of the scene, are cast one by
/// one.
const FAR_APART: f64 = 1e-3;

/// Invalid geometry.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CastError {
    /// More objects than a tree holds.
    #[error("expected at most 2^27 objects, got {0}")]
    TooMany(usize),
    /// An object whose size is not finite or is negative.
    #[error("object {object}: expected a finite size, got corners {low:?} and {high:?}")]
    Size {
        /// Its number, from 0.
        object: usize,
        /// The least corner of its box in its own frame, metres.
        low: [f64; 3],
        /// The greatest corner, metres.
        high: [f64; 3],
    },
}

/// Objects to cast rays at.
#[derive(Clone, Debug)]
pub struct Caster {
    objects: Vec<Object>,
    /// Numbers of the objects that are tested one after the other: planes, and all others if they
    /// are few.
    each: Vec<u32>,
    /// All others, by number, in the order of the tree's leaves.
    leaves: Vec<u32>,
    tree: Bvh,
    /// Origin of the tree's coordinates.
    middle_m: DVec3,
    /// Available SIMD registers. They change no result.
    pub(super) level: Level,
}

/// Stacks of waiting children, for the tree of objects and that of one object.
pub(super) struct Stacks {
    objects: Stack,
    inner: Stack,
}

impl Stacks {
    pub(super) const fn new() -> Self {
        Self {
            objects: Stack::new(),
            inner: Stack::new(),
        }
    }
}

impl Default for Caster {
    /// Nothing to hit.
    fn default() -> Self {
        Self {
            objects: Vec::new(),
            each: Vec::new(),
            leaves: Vec::new(),
            tree: Bvh::over(&[], Quality::OBJECTS).0,
            middle_m: DVec3::ZERO,
            level: Level::new(),
        }
    }
}

impl Caster {
    /// A scene of these objects, which go by their places in this order.
    ///
    /// # Errors
    /// [`CastError`] for an object whose size is no size, or more than 2^27 objects.
    pub fn new(objects: impl IntoIterator<Item = Object>) -> Result<Self, CastError> {
        let mut caster = Self {
            objects: objects.into_iter().collect(),
            ..Self::default()
        };
        if caster.objects.len() > MOST_ITEMS {
            return Err(CastError::TooMany(caster.objects.len()));
        }
        let (mut finite, mut boxes) = (Vec::new(), Vec::new());
        let mut whole = BoundingBox::EMPTY;
        for ((number, object), id) in caster.objects.iter().enumerate().zip(0_u32..) {
            match object.bounds() {
                Ok(None) => caster.each.push(id),
                Ok(Some(bounds)) => {
                    whole.join(&bounds);
                    finite.push(id);
                    boxes.push(bounds);
                }
                Err(BoundingBox { low, high }) => {
                    return Err(CastError::Size {
                        object: number,
                        low,
                        high,
                    });
                }
            }
        }
        caster.middle_m = short_middle(&whole);
        let middle = caster.middle_m;
        for BoundingBox { low, high } in &mut boxes {
            *low = (DVec3::from_array(*low) - middle).to_array();
            *high = (DVec3::from_array(*high) - middle).to_array();
        }
        let (tree, order) = Bvh::over(&boxes, Quality::OBJECTS);
        caster.tree = tree;
        let sorted = order
            .iter()
            .filter_map(|&at| finite.get(at as usize).copied());
        if finite.len() <= FEW {
            caster.each.extend(sorted);
        } else {
            caster.leaves.extend(sorted);
        }
        Ok(caster)
    }

    /// The objects.
    #[must_use]
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The first hit of a ray within its reach; [`Hit`] defines the order of equal distances.
    #[must_use]
    pub fn nearest(&self, ray: &Ray, reach: Reach) -> Option<Hit> {
        let (ray, reach) = (arrays(ray), reach.clean());
        let best = dispatch!(self.level, simd => self.one(simd, &mut Stacks::new(), ray, reach));
        best.hit()
    }

    /// The normal of what a ray hit, at the point where it did: length 1, in the frame of the rays.
    /// It points out of solids, up from planes and height fields, and to the side from which a
    /// triangle is counterclockwise; it is zero for a triangle without an area.
    #[must_use]
    pub fn normal(&self, hit: &Hit, point: DVec3) -> DVec3 {
        let object = self.objects.get(hit.object.index());
        object.map_or(DVec3::ZERO, |object| object.normal(hit.primitive, point))
    }

    /// The middle and radius of a ball around all objects, metres; none if one is endless.
    pub(crate) fn bounding_sphere(&self) -> Option<(DVec3, f64)> {
        let mut whole = BoundingBox::EMPTY;
        for object in &self.objects {
            whole.join(&object.bounds().ok()??);
        }
        if whole.low[0] > whole.high[0] {
            return Some((DVec3::ZERO, 0.0));
        }
        let (low, high) = (whole.low.into(), whole.high.into());
        let middle_m = DVec3::midpoint(low, high);
        // More than the half diagonal by far more than roundings of it.
        let radius_m = 0.5 * low.distance(high) + 1e-9 * whole.reach();
        Some((middle_m, radius_m))
    }

    /// The hit of one ray.
    #[inline(always)]
    fn one<S: Simd>(
        &self,
        simd: S,
        stacks: &mut Stacks,
        ray: ([f64; 3], [f64; 3]),
        reach: Reach,
    ) -> Best {
        let mut best = Best::within(reach.up_to_m);
        let Stacks { objects, inner } = stacks;
        let above_m = reach.above_m;
        for &object in &self.each {
            let ask = ObjectTest { above_m, object };
            self.ask(simd, inner, ray, ask, &mut best);
        }
        if self.leaves.is_empty() {
            return best;
        }
        let (origin, direction) = ray;
        let origin = (DVec3::from_array(origin) - self.middle_m).to_array();
        let beam = Beam::thin(origin, direction, self.tree.reach_m);
        let far = up_to(best.range_m);
        self.tree.walk(
            simd,
            objects,
            &beam,
            far,
            #[inline(always)]
            |leaf| {
                if let Some(&object) = self.leaves.get(leaf as usize) {
                    let ask = ObjectTest { above_m, object };
                    self.ask(simd, inner, ray, ask, &mut best);
                }
                up_to(best.range_m)
            },
        );
        best
    }

    /// One ray and one object.
    #[inline(always)]
    fn ask<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        ray: ([f64; 3], [f64; 3]),
        ask: ObjectTest,
        best: &mut Best,
    ) {
        if let Some(object) = self.objects.get(ask.object as usize) {
            object.one(simd, stack, ray, ask, best);
        }
    }

    /// The hits of the wanted ones of eight rays.
    #[inline(always)]
    pub(super) fn eight<S: Simd>(
        &self,
        simd: S,
        stacks: &mut Stacks,
        lanes: &mut RayLanes,
        mut wanted: u64,
        reach: Reach,
    ) -> Nearest {
        lanes.fill(wanted);
        let mut nearest = Nearest::within(reach.up_to_m);
        if !self.go_together(simd, lanes) {
            while wanted != 0 {
                let lane = wanted.trailing_zeros() as usize;
                wanted &= wanted - 1;
                let best = self.one(simd, stacks, lanes.ray(lane), reach);
                nearest.put(lane, best);
            }
            return nearest;
        }
        let Stacks { objects, inner } = stacks;
        let above_m = reach.above_m;
        for &object in &self.each {
            let ask = ObjectTest { above_m, object };
            self.ask_eight(simd, inner, (lanes, wanted), ask, &mut nearest);
        }
        if self.leaves.is_empty() {
            return nearest;
        }
        while wanted != 0 {
            let (alike, _) = lanes.alike(simd, wanted);
            wanted &= !alike;
            let beam = self.beam(simd, *lanes, alike);
            let far = up_to(nearest.farthest(simd, alike));
            self.tree.walk(
                simd,
                objects,
                &beam,
                far,
                #[inline(always)]
                |leaf| {
                    if let Some(&object) = self.leaves.get(leaf as usize) {
                        let ask = ObjectTest { above_m, object };
                        self.ask_eight(simd, inner, (lanes, alike), ask, &mut nearest);
                    }
                    up_to(nearest.farthest(simd, alike))
                },
            );
        }
        nearest
    }

    /// Some of eight rays and one object.
    #[inline(always)]
    fn ask_eight<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        (lanes, wanted): (&RayLanes, u64),
        ask: ObjectTest,
        nearest: &mut Nearest,
    ) {
        if let Some(object) = self.objects.get(ask.object as usize) {
            object.eight(simd, stack, lanes, wanted, ask, nearest);
        }
    }

    /// Some of the lanes in the tree of objects.
    #[inline(always)]
    fn beam<S: Simd>(&self, simd: S, mut lanes: RayLanes, alike: u64) -> Beam<true> {
        lanes.fill(alike);
        let [x, y, z] = loaded(simd, &lanes.origin);
        let middle = self.middle_m;
        let origin = [x - middle.x, y - middle.y, z - middle.z];
        let direction = loaded(simd, &lanes.direction);
        Beam::about(&spread(origin), &spread(direction), self.tree.reach_m)
    }

    /// Whether all lanes go so nearly the same way that walking together is faster.
    #[inline(always)]
    fn go_together<S: Simd>(&self, simd: S, lanes: &RayLanes) -> bool {
        let direction = spread(loaded(simd, &lanes.direction));
        let origin = spread(loaded(simd, &lanes.origin));
        direction.width() <= WIDE && origin.width() <= FAR_APART * self.tree.reach_m
    }
}

/// Origin and direction.
#[inline(always)]
fn arrays(ray: &Ray) -> ([f64; 3], [f64; 3]) {
    (ray.origin_m().to_array(), ray.direction().to_array())
}
