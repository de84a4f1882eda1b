//! An object that can move: its surfaces in its own frame, and the position of that frame.

use std::sync::Arc;

use glam::DVec3;

use super::surroundings::FirstSurface;
use crate::cast::Placement;
use crate::scene::Scene;

/// A rigid object and its present placement.
#[derive(Clone, Debug)]
pub struct Body {
    scene: Arc<Scene>,
    placement: Option<Placement>,
    /// Bounding sphere in its own frame: centre and radius, metres. Infinite objects have none.
    sphere: Option<(DVec3, f64)>,
    /// The sphere's centre at the present placement.
    centre_m: DVec3,
}

impl Body {
    /// Surfaces in a frame of their own, without a placement.
    #[must_use]
    pub fn new(scene: Arc<Scene>) -> Self {
        Self {
            sphere: scene.caster().bounding_sphere(),
            scene,
            placement: None,
            centre_m: DVec3::ZERO,
        }
    }

    /// Sets or removes the placement. Returns whether that changed it.
    pub fn place(&mut self, placement: Option<Placement>) -> bool {
        let moved = self.placement != placement;
        self.placement = placement;
        if let (Some(placement), Some((centre_m, _))) = (placement, self.sphere) {
            self.centre_m = placement.world_point(centre_m);
        }
        moved
    }

    /// Whether it may be within a cone about a ray, `half_width` radians from axis to side. May be
    /// true where it is not.
    #[inline]
    pub(super) fn may_be_near(&self, origin_m: DVec3, direction: DVec3, half_width: f64) -> bool {
        let Some((_, radius_m)) = self.sphere else {
            return self.placement.is_some();
        };
        let to_centre = self.centre_m - origin_m;
        let along_m = to_centre.dot(direction);
        let across_m = (to_centre - along_m * direction).length();
        // The tangent of a small angle is less than twice the angle.
        let reach_m = radius_m + 2.0 * half_width * (along_m.abs() + radius_m);
        // Rounding of the lengths above.
        let margin_m = 1e-12 * (self.centre_m.length() + origin_m.length());
        self.placement.is_some() && along_m >= -reach_m - margin_m && across_m <= reach_m + margin_m
    }

    /// The surface that a ray of the base's frame meets no farther than `max_m`.
    #[inline]
    pub(super) fn first(
        &self,
        origin_m: DVec3,
        direction: DVec3,
        max_m: f64,
        normals: bool,
    ) -> Option<FirstSurface> {
        if !self.may_be_near(origin_m, direction, 0.0) {
            return None;
        }
        let placement = self.placement.as_ref()?;
        let origin = placement.own_point(origin_m);
        let along = placement.own_direction(direction);
        let mut first = FirstSurface::of_scene(&self.scene, origin, along, max_m, normals)?;
        first.met.normal = placement.world_direction(first.met.normal);
        Some(first)
    }
}
