//! First surfaces of rays: the only place where the simulation calls the ray caster.
//!
//! Static objects are cast for a whole packet at once (`batch`), moving objects per firing; the
//! nearer counts. Effects cast further rays one by one ([`Surroundings::meet`]) or several from one
//! origin ([`Surroundings::cast_fan`]); the results are the same, bit for bit. Each thread has its
//! own surroundings, in which moving objects are placed.

use std::sync::Arc;

use glam::DVec3;

use super::body::Body;
use super::echo::{Echo, Echoes};
use super::{SimulatedFiring, batch};
use crate::cast::{Hit, Object};
use crate::scene::Scene;
use crate::sensor::DetectionRange;

/// The scene around the scanner at the moment.
#[derive(Clone, Debug)]
pub struct Surroundings {
    pub(super) scene: Arc<Scene>,
    pub(super) range: DetectionRange,
    pub(super) normals: bool,
    /// Whether nothing ever moves.
    pub(super) is_static: bool,
    bodies: Vec<Body>,
}

/// The surface that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SurfaceHit {
    /// Distance, metres.
    pub range_m: f64,
    /// Calibrated reflectivity: 0..=100 diffuse, above that retroreflecting.
    pub reflectivity: f64,
    /// The surface's normal, length 1, on either side; 0 where no effect needs it.
    pub normal: DVec3,
    /// Share of specularly reflected light, 0..=1. The normal decides whether it comes back.
    pub specular: f64,
}

/// The first surface along a ray, whether it returns or not.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstSurface {
    pub met: SurfaceHit,
    /// Whether nothing comes back.
    absorbing: bool,
}

impl FirstSurface {
    /// The surface that a ray hit, with its normal if requested.
    #[inline]
    pub fn new(
        scene: &Scene,
        hit: &Hit,
        origin_m: DVec3,
        direction: DVec3,
        normals: bool,
    ) -> Option<Self> {
        let material = scene.material(hit)?;
        let range_m = hit.range_m;
        Some(Self {
            met: SurfaceHit {
                range_m,
                reflectivity: f64::from(material.reflectivity),
                normal: match normals {
                    true => (scene.caster()).normal(hit, origin_m + range_m * direction),
                    false => DVec3::ZERO,
                },
                specular: material.specular,
            },
            absorbing: material.absorbing,
        })
    }

    /// The first surface of a scene no farther than `max_m`.
    pub fn of_scene(
        scene: &Scene,
        origin_m: DVec3,
        direction: DVec3,
        max_m: f64,
        normals: bool,
    ) -> Option<Self> {
        let hit = scene.nearest(origin_m, direction, max_m)?;
        Self::new(scene, &hit, origin_m, direction, normals)
    }
}

impl Surroundings {
    /// A scene within a sensor's range; `is_static` if nothing in it ever moves.
    pub(crate) const fn new(scene: Arc<Scene>, range: DetectionRange, is_static: bool) -> Self {
        Self {
            scene,
            range,
            normals: false,
            is_static,
            bodies: Vec::new(),
        }
    }

    /// The same with or without normals of surfaces.
    pub(crate) fn with_normals(self, normals: bool) -> Self {
        Self { normals, ..self }
    }

    /// The objects that do not move.
    pub(crate) fn static_objects(&self) -> &[Object] {
        self.scene.caster().objects()
    }

    /// The sensor's range of detection.
    #[must_use]
    pub const fn range(&self) -> DetectionRange {
        self.range
    }

    /// The first surface within the sensor's range along a ray from `origin_m` in `direction`
    /// (length 1), in the frame of the base. A nearer surface blocks the ray.
    #[must_use]
    pub fn meet(&self, origin_m: DVec3, direction: DVec3) -> Option<SurfaceHit> {
        let first = self.first_static(origin_m, direction);
        self.with_moving(origin_m, direction, first)
    }

    /// Like [`Surroundings::meet`], without moving objects.
    #[cfg(test)]
    pub(crate) fn meet_static(&self, origin_m: DVec3, direction: DVec3) -> Option<SurfaceHit> {
        self.returning(self.first_static(origin_m, direction)?)
    }

    /// Like [`Surroundings::meet`] for each direction, up to the length of the shorter list.
    pub fn cast_fan(&self, origin_m: DVec3, directions: &[DVec3], mets: &mut [Option<SurfaceHit>]) {
        batch::fan(self, origin_m, directions, &mut |ray, first| {
            if let (Some(met), Some(direction)) = (mets.get_mut(ray), directions.get(ray)) {
                *met = self.with_moving(origin_m, *direction, first);
            }
        });
    }

    /// Like [`Surroundings::cast_fan`], without moving objects.
    pub fn cast_fan_static(
        &self,
        origin_m: DVec3,
        directions: &[DVec3],
        mets: &mut [Option<SurfaceHit>],
    ) {
        batch::fan(self, origin_m, directions, &mut |ray, first| {
            if let Some(met) = mets.get_mut(ray) {
                *met = first.and_then(|first| self.returning(first));
            }
        });
    }

    /// The static surfaces that all lasers of consecutive firings meet; there are no second
    /// returns, and none for lasers that do not fire.
    pub(crate) fn meet_all(&self, firings: &[SimulatedFiring], echoes: &mut [Echoes]) {
        batch::firings(self, firings, echoes);
    }

    /// Replaces static surfaces, as [`Surroundings::meet_all`] found them, by moving ones before
    /// them.
    #[cold]
    #[inline(never)]
    pub(crate) fn meet_bodies(&self, firing: &SimulatedFiring, echoes: &mut Echoes) {
        let lasers = echoes.strongest.iter_mut().zip(&echoes.static_m);
        let rays = firing.origins_m.iter().zip(&firing.directions);
        for (laser, ((echo, max_m), (origin, direction))) in lasers.zip(rays).enumerate() {
            if firing.is_alive(laser)
                && let Some(first) = self.first_moving(*origin, *direction, *max_m)
            {
                *echo = Echo::from_met(self.returning(first));
            }
        }
    }

    /// Whether a moving object may be within a cone about a ray, `half_width` radians (well below
    /// 1) from its axis to its side. May be true without one.
    #[must_use]
    pub fn may_move_near(&self, origin_m: DVec3, direction: DVec3, half_width: f64) -> bool {
        let near = |body: &Body| body.may_be_near(origin_m, direction, half_width);
        self.bodies.iter().any(near)
    }

    /// The moving objects at their present positions. Empty unless an effect fills it.
    pub const fn bodies_mut(&mut self) -> &mut Vec<Body> {
        &mut self.bodies
    }

    /// The echo of the first static surface, or of a moving one before it.
    #[inline]
    fn with_moving(
        &self,
        origin_m: DVec3,
        direction: DVec3,
        first: Option<FirstSurface>,
    ) -> Option<SurfaceHit> {
        if self.bodies.is_empty() {
            return self.returning(first?);
        }
        let max_m = first.map_or(self.range.max_m, |first| first.met.range_m);
        let moving = self.first_moving(origin_m, direction, max_m);
        self.returning(moving.or(first)?)
    }

    /// The echo of the first surface: none if it is too near or absorbing.
    #[inline]
    pub(super) fn returning(&self, first: FirstSurface) -> Option<SurfaceHit> {
        let returns = first.met.range_m >= self.range.min_m && !first.absorbing;
        returns.then_some(first.met)
    }

    fn first_static(&self, origin_m: DVec3, direction: DVec3) -> Option<FirstSurface> {
        let max_m = self.range.max_m;
        FirstSurface::of_scene(&self.scene, origin_m, direction, max_m, self.normals)
    }

    /// The first moving surface no farther than `max_m`.
    fn first_moving(&self, origin_m: DVec3, direction: DVec3, max_m: f64) -> Option<FirstSurface> {
        let mut nearest: Option<FirstSurface> = None;
        for body in &self.bodies {
            let max_m = nearest.map_or(max_m, |first| first.met.range_m);
            if let Some(first) = body.first(origin_m, direction, max_m, self.normals)
                && nearest.is_none_or(|nearest| first.met.range_m < nearest.met.range_m)
            {
                nearest = Some(first);
            }
        }
        nearest
    }
}
