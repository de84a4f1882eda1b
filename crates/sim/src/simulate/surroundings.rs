//! What rays meet: the one place where the simulation calls the ray caster.
//!
//! Every thread has surroundings of its own, which moving objects are placed in. Left out: how rays are cast ([`Scene`]).

use std::sync::Arc;

use glam::DVec3;

use super::firing::{Echo, Echoes, Firing};
use crate::scene::Scene;
use crate::sensor::{MOST_LASERS, Reach};

/// The scene around the scanner at the moment.
#[derive(Clone, Debug)]
pub struct Surroundings {
    scene: Arc<Scene>,
    reach: Reach,
    normals: bool,
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
}

impl Surroundings {
    pub(super) const fn new(scene: Arc<Scene>, reach: Reach) -> Self {
        Self {
            scene,
            reach,
            normals: false,
        }
    }

    /// The same with normals of surfaces, or without.
    pub(super) fn with_normals(self, normals: bool) -> Self {
        Self { normals, ..self }
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
        let Reach { min_m, max_m } = self.reach;
        let (hit, normal) = match self.normals {
            true => self
                .scene
                .cast_with_normal(origin_m, direction, min_m, max_m)?,
            false => (
                self.scene.cast(origin_m, direction, min_m, max_m)?,
                DVec3::ZERO,
            ),
        };
        Some(Met {
            range_m: hit.range_m,
            reflectivity: f64::from(hit.reflectivity),
            normal,
        })
    }

    /// The same for all lasers of firings that follow one another; those that are not alive have no echo, and nobody has a second one.
    #[inline]
    pub(super) fn meet_all(&self, firings: &[Firing], echoes: &mut [Echoes]) {
        for (firing, echoes) in firings.iter().zip(echoes) {
            let rays = firing.origins_m.iter().zip(&firing.directions);
            let lasers = echoes.strongest.iter_mut().zip(rays).take(firing.lasers);
            for (laser, (echo, (origin, direction))) in lasers.enumerate() {
                let met = firing
                    .is_alive(laser)
                    .then(|| self.meet(*origin, *direction))
                    .flatten();
                *echo = met.map_or(Echo::NONE, |met| Echo::of(&met));
            }
            if echoes.two {
                echoes.other = [Echo::NONE; MOST_LASERS];
            }
        }
    }
}
