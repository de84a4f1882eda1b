//! Something that can move: its surfaces in its own frame, and where that stands.
//!
//! Left out: how it moves (effects).

use std::sync::Arc;

use glam::DVec3;

use super::{First, first_of};
use crate::cast::Placement;
use crate::scene::Scene;

/// A rigid thing, its parts and where it stands at the moment.
#[derive(Clone, Debug)]
pub struct Body {
    scene: Arc<Scene>,
    placement: Option<Placement>,
    /// A ball around it in its own frame: middle and radius, metres. Endless things have none.
    ball: Option<(DVec3, f64)>,
    /// The ball's middle where it stands.
    middle_m: DVec3,
}

impl Body {
    /// Surfaces in a frame of their own. It is nowhere until it is placed.
    #[must_use]
    pub fn new(scene: Arc<Scene>) -> Self {
        Self {
            ball: scene.caster().ball(),
            scene,
            placement: None,
            middle_m: DVec3::ZERO,
        }
    }

    /// Puts its frame there, or nowhere; whether it was elsewhere before.
    pub fn place(&mut self, placement: Option<Placement>) -> bool {
        let moved = self.placement != placement;
        self.placement = placement;
        if let (Some(placement), Some((middle_m, _))) = (placement, self.ball) {
            self.middle_m = placement.world_point(middle_m);
        }
        moved
    }

    /// Whether it can be within a cone about a ray, this wide in radians from its middle to its side. It may say so where it is not.
    #[inline]
    pub(super) fn may_be_near(&self, origin_m: DVec3, direction: DVec3, half_width: f64) -> bool {
        let Some((_, radius_m)) = self.ball else {
            return self.placement.is_some();
        };
        let to_middle = self.middle_m - origin_m;
        let along_m = to_middle.dot(direction);
        let beside_m = (to_middle - along_m * direction).length();
        // The tangent of a small angle is less than twice it.
        let reach_m = radius_m + 2.0 * half_width * (along_m.abs() + radius_m);
        // Roundings of the lengths that went in.
        let room_m = 1e-12 * (self.middle_m.length() + origin_m.length());
        self.placement.is_some() && along_m >= -reach_m - room_m && beside_m <= reach_m + room_m
    }

    /// What a ray of the base's frame meets of it, no farther than this.
    #[inline]
    pub(super) fn first(
        &self,
        origin_m: DVec3,
        direction: DVec3,
        up_to_m: f64,
        normals: bool,
    ) -> Option<First> {
        if !self.may_be_near(origin_m, direction, 0.0) {
            return None;
        }
        let placement = self.placement.as_ref()?;
        let origin = placement.own_point(origin_m);
        let along = placement.own_direction(direction);
        let mut first = first_of(&self.scene, origin, along, up_to_m, normals)?;
        first.met.normal = placement.world_direction(first.met.normal);
        Some(first)
    }
}
