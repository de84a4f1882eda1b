//! What rays meet: the one place where the simulation calls the ray caster.
//!
//! Every thread has surroundings of its own, which moving objects are placed in. Left out: how rays are cast ([`Scene`]).

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::firing::{Echo, Echoes, Firing};
use crate::scene::{Facet, Scene};
use crate::sensor::{MOST_LASERS, Reach};

/// The scene around the scanner at the moment.
#[derive(Clone, Debug)]
pub struct Surroundings {
    scene: Arc<Scene>,
    reach: Reach,
    normals: bool,
    still: bool,
    bodies: Vec<Body>,
}

/// Something that can move: its surfaces in its own frame, and where that stands.
#[derive(Clone, Debug)]
pub struct Body {
    /// What it looks like.
    pub scene: Arc<Scene>,
    /// How its frame is turned.
    pub turn: DMat3,
    /// Where its frame's origin is, metres in the frame of the base.
    pub at_m: DVec3,
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
    /// Share of the light that goes off as from a mirror, 0..=1; 0 where no effect needs the normal.
    pub specular: f64,
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

    /// Whether nothing ever moves: what a ray meets now it meets always.
    #[must_use]
    pub const fn is_still(&self) -> bool {
        self.still
    }

    /// How far the sensor sees.
    #[must_use]
    pub const fn reach(&self) -> Reach {
        self.reach
    }

    /// What a ray from `origin_m` along `direction` (length 1) meets first within the sensor's reach, in the frame of the base. A nearer surface
    /// blocks it.
    #[inline]
    #[must_use]
    pub fn meet(&self, origin_m: DVec3, direction: DVec3) -> Option<Met> {
        match self.bodies.is_empty() {
            true => self.meet_still(origin_m, direction),
            false => self.nearest(origin_m, direction),
        }
    }

    /// The same where nothing moves.
    #[inline]
    fn meet_still(&self, origin_m: DVec3, direction: DVec3) -> Option<Met> {
        self.cast(&self.scene, origin_m, direction, self.reach.min_m)
    }

    /// What a ray meets of a scene, no nearer than `min_m`.
    #[inline]
    fn cast(&self, scene: &Scene, origin_m: DVec3, direction: DVec3, min_m: f64) -> Option<Met> {
        let max_m = self.reach.max_m;
        let (hit, facet) = match self.normals {
            true => scene.cast_with_facet(origin_m, direction, min_m, max_m)?,
            false => (
                scene.cast(origin_m, direction, min_m, max_m)?,
                Facet::default(),
            ),
        };
        Some(Met {
            range_m: hit.range_m,
            reflectivity: f64::from(hit.reflectivity),
            normal: facet.normal,
            specular: facet.specular,
        })
    }

    /// The nearest of what stands and what moves. Either can be what blocks the ray.
    #[cold]
    #[inline(never)]
    fn nearest(&self, origin_m: DVec3, direction: DVec3) -> Option<Met> {
        let still = self.cast(&self.scene, origin_m, direction, 0.0);
        let mets = self
            .nearest_body(origin_m, direction)
            .into_iter()
            .chain(still);
        let nearest = mets.min_by(|a, b| a.range_m.total_cmp(&b.range_m))?;
        (nearest.range_m >= self.reach.min_m).then_some(nearest)
    }

    /// The nearest of what moves.
    fn nearest_body(&self, origin_m: DVec3, direction: DVec3) -> Option<Met> {
        let mets = self.bodies.iter().filter_map(|body| {
            let own = body.turn.transpose();
            let from = own * (origin_m - body.at_m);
            let met = self.cast(&body.scene, from, own * direction, 0.0)?;
            let normal = body.turn * met.normal;
            Some(Met { normal, ..met })
        });
        mets.min_by(|a, b| a.range_m.total_cmp(&b.range_m))
    }

    /// What moves, as it stands at the moment. Empty unless an effect fills it.
    pub const fn bodies_mut(&mut self) -> &mut Vec<Body> {
        &mut self.bodies
    }

    /// What stands, as all lasers meet it of firings that follow one another; those that are not alive have no echo, and nobody has a second one.
    #[inline]
    pub(crate) fn meet_all(&self, firings: &[Firing], echoes: &mut [Echoes]) {
        for (firing, echoes) in firings.iter().zip(echoes) {
            let rays = firing.origins_m.iter().zip(&firing.directions);
            let lasers = echoes.strongest.iter_mut().zip(rays).take(firing.lasers);
            for (laser, (echo, (origin, direction))) in lasers.enumerate() {
                let met = firing
                    .is_alive(laser)
                    .then(|| self.meet_still(*origin, *direction))
                    .flatten();
                *echo = met.map_or(Echo::NONE, |met| Echo::of(&met));
            }
            if echoes.two {
                echoes.other = [Echo::NONE; MOST_LASERS];
            }
        }
    }

    /// Puts what moves before what stands. Apart from [`Surroundings::meet_all`], so that a scene in which nothing moves is not asked ray by ray.
    #[cold]
    #[inline(never)]
    pub(crate) fn meet_bodies(&self, firings: &[Firing], echoes: &mut [Echoes]) {
        for (firing, echoes) in firings.iter().zip(echoes) {
            for laser in firing.alive() {
                if let (Some(echo), Some(origin), Some(direction)) = (
                    echoes.strongest.get_mut(laser),
                    firing.origins_m.get(laser),
                    firing.directions.get(laser),
                ) && self.nearest_body(*origin, *direction).is_some()
                {
                    let met = self.nearest(*origin, *direction);
                    *echo = met.map_or(Echo::NONE, |met| Echo::of(&met));
                }
            }
        }
    }
}
