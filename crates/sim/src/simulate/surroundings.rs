//! What rays meet: the one place where the simulation calls the ray caster.
//!
//! What stands is cast for a whole packet at once (`volley`), what moves for one firing at a time, and the nearer of both counts. Effects that want more rays ask
//! one by one ([`Surroundings::meet`]) or for some from one point (`fan`); the answers are the same, bit for bit. Every thread has surroundings of its own, which moving objects are
//! placed in. Left out: how rays are cast ([`Scene`]).

mod body;
mod fan;
mod volley;

use std::sync::Arc;

use glam::DVec3;

use super::firing::{Echo, Echoes, Firing};
use crate::cast::Hit;
use crate::scene::Scene;
use crate::scenery::Material;
use crate::sensor::Reach;

pub use body::Body;

/// The scene around the scanner at the moment.
#[derive(Clone, Debug)]
pub struct Surroundings {
    scene: Arc<Scene>,
    reach: Reach,
    normals: bool,
    still: bool,
    bodies: Vec<Body>,
}

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met {
    /// How far away, metres.
    pub range_m: f64,
    /// Calibrated reflectivity of what it met: 0..=100 diffuse, above that retroreflecting.
    pub reflectivity: f64,
    /// The surface's normal, length 1, whichever way it points; 0 where no effect needs it.
    pub normal: DVec3,
    /// Share of the light that goes off as from a mirror, 0..=1. Whether it comes back the normal decides.
    pub specular: f64,
}

/// The first surface in a ray's way.
#[derive(Clone, Copy, Debug)]
struct First {
    met: Met,
    /// Nothing comes back of it.
    absorbing: bool,
}

impl First {
    #[inline]
    fn new(hit: &Hit<DVec3>, material: &Material) -> Self {
        Self {
            met: Met {
                range_m: hit.range_m,
                reflectivity: f64::from(material.reflectivity),
                normal: hit.normal,
                specular: material.specular,
            },
            absorbing: material.absorbing,
        }
    }
}

impl Surroundings {
    /// A scene as far as a sensor sees it; `still` if nothing in it ever moves.
    pub(crate) const fn new(scene: Arc<Scene>, reach: Reach, still: bool) -> Self {
        Self {
            scene,
            reach,
            normals: false,
            still,
            bodies: Vec::new(),
        }
    }

    /// The same with normals of surfaces, or without.
    pub(crate) fn with_normals(self, normals: bool) -> Self {
        Self { normals, ..self }
    }

    /// How far the sensor sees.
    #[must_use]
    pub const fn reach(&self) -> Reach {
        self.reach
    }

    /// What a ray from `origin_m` along `direction` (length 1) meets first within the sensor's reach, in the frame of the base. A nearer surface
    /// blocks it.
    #[must_use]
    pub fn meet(&self, origin_m: DVec3, direction: DVec3) -> Option<Met> {
        self.nearer(origin_m, direction, self.stands(origin_m, direction))
    }

    /// What comes back of the first that stands, or of what moves before it.
    #[inline]
    fn nearer(&self, origin_m: DVec3, direction: DVec3, stands: Option<First>) -> Option<Met> {
        if self.bodies.is_empty() {
            return self.seen(stands?);
        }
        let up_to_m = stands.map_or(self.reach.max_m, |first| first.met.range_m);
        let moves = self.moves(origin_m, direction, up_to_m);
        self.seen(moves.or(stands)?)
    }

    /// The same with nothing there but what stands.
    #[must_use]
    pub fn meet_still(&self, origin_m: DVec3, direction: DVec3) -> Option<Met> {
        self.seen(self.stands(origin_m, direction)?)
    }

    /// Whether anything that moves can be within a cone about a ray, this wide (radians from its middle to its side, well below 1). It may say so of nothing.
    #[must_use]
    pub fn may_move_near(&self, origin_m: DVec3, direction: DVec3, half_width: f64) -> bool {
        let near = |body: &Body| body.may_be_near(origin_m, direction, half_width);
        self.bodies.iter().any(near)
    }

    /// What comes back of the first surface: nothing of one that is too near.
    #[inline]
    fn seen(&self, first: First) -> Option<Met> {
        let back = first.met.range_m >= self.reach.min_m && !first.absorbing;
        back.then_some(first.met)
    }

    /// The first of what stands.
    fn stands(&self, origin_m: DVec3, direction: DVec3) -> Option<First> {
        first_of(
            &self.scene,
            origin_m,
            direction,
            self.reach.max_m,
            self.normals,
        )
    }

    /// The first of what moves, if it is no farther than this.
    fn moves(&self, origin_m: DVec3, direction: DVec3, up_to_m: f64) -> Option<First> {
        let mut nearest: Option<First> = None;
        for body in &self.bodies {
            let up_to_m = nearest.map_or(up_to_m, |first| first.met.range_m);
            if let Some(first) = body.first(origin_m, direction, up_to_m, self.normals)
                && nearest.is_none_or(|had| first.met.range_m < had.met.range_m)
            {
                nearest = Some(first);
            }
        }
        nearest
    }

    /// What moves, as it stands at the moment. Empty unless an effect fills it.
    pub const fn bodies_mut(&mut self) -> &mut Vec<Body> {
        &mut self.bodies
    }

    /// Puts what moves before what stands, as [`Surroundings::meet_all`] found that.
    #[cold]
    #[inline(never)]
    pub(crate) fn meet_bodies(&self, firing: &Firing, echoes: &mut Echoes) {
        let lasers = echoes.strongest.iter_mut().zip(&echoes.standing_m);
        let rays = firing.origins_m.iter().zip(&firing.directions);
        for (laser, ((echo, up_to_m), (origin, direction))) in lasers.zip(rays).enumerate() {
            if firing.is_alive(laser)
                && let Some(first) = self.moves(*origin, *direction, *up_to_m)
            {
                *echo = Echo::of_any(self.seen(first));
            }
        }
    }
}

/// The first of a scene, no farther than this.
fn first_of(
    scene: &Scene,
    origin_m: DVec3,
    direction: DVec3,
    up_to_m: f64,
    normals: bool,
) -> Option<First> {
    if normals {
        let (hit, material) = scene.nearest::<DVec3>(origin_m, direction, up_to_m)?;
        return Some(First::new(&hit, material));
    }
    let (hit, material) = scene.nearest::<()>(origin_m, direction, up_to_m)?;
    Some(First::new(&hit.with_normal(DVec3::ZERO), material))
}

#[cfg(test)]
mod tests;
