//! Objects: objects that move during the scan. A lidar sees them sheared or twice.
//!
//! A body moves at a constant velocity and rotates at a constant rate about its origin. Each firing
//! meets it at its position when the first laser fires. Bodies are the boxes of this effect's table
//! and the scene's `[[objects]]` with a velocity or a rotation. Motion during a firing (1 mm in 55
//! us at 20 m/s), acceleration and collisions are not included.

use crate::effects::{Needs, ObjectsEffect};
use crate::firing::{Body, Surroundings};
use std::sync::Arc;

use glam::DVec3;
use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};
use crate::cast::{Cuboid, Object};
use crate::scene::Scene;
use crate::scenery::Travel;

/// `[effects.moving_objects]`.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct MovingObjectsSettings {
    /// The boxes: persons, cars, trolleys.
    pub boxes: Vec<MovingBox>,
}

/// A moving box.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct MovingBox {
    /// Position of its centre at the start, metres in the frame of the base.
    pub at_m: [f64; 3],
    /// Length of its edges, metres.
    pub size_m: [f64; 3],
    /// Velocity, metres per second.
    #[serde(default)]
    pub velocity_m_s: [f64; 3],
    /// Rotation about the vertical through its centre, degrees per second, anticlockwise seen from
    /// above.
    #[serde(default)]
    pub turn_deg_s: f64,
    /// Calibrated reflectivity; default 50.
    #[serde(default = "plain")]
    pub reflectivity: u8,
}

const fn plain() -> u8 {
    50
}

/// A moving body.
#[derive(Clone, Debug)]
pub struct Mover {
    /// Its surfaces in its own frame.
    pub scene: Arc<Scene>,
    /// Motion of that frame.
    pub travel: Travel,
}

/// Bodies that move.
#[derive(Clone, Debug, Default)]
pub struct MovingObjects {
    movers: Vec<Mover>,
}

/// Largest size, distance and distance per second of a box, metres.
const MOST_M: f64 = 1e4;

impl MovingObjects {
    /// From any bodies.
    #[must_use]
    pub const fn new(movers: Vec<Mover>) -> Self {
        Self { movers }
    }

    /// From the boxes of these settings.
    ///
    /// # Errors
    /// [`InvalidSetting`] for numbers out of range.
    pub fn of(settings: &MovingObjectsSettings) -> Result<Self, InvalidSetting> {
        let movers = settings.boxes.iter().map(Mover::of);
        Ok(Self::new(movers.collect::<Result<_, _>>()?))
    }

    /// The bodies.
    #[must_use]
    pub fn movers(&self) -> &[Mover] {
        &self.movers
    }

    /// Adds bodies.
    #[must_use]
    pub fn and(mut self, more: impl IntoIterator<Item = Mover>) -> Self {
        self.movers.extend(more);
        self
    }
}

impl Mover {
    fn of(settings: &MovingBox) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(MovingObjects::NAME);
        let all = |setting, values: [f64; 3], least: f64| {
            for value in values {
                check.within(setting, value, least..=MOST_M)?;
            }
            Ok(DVec3::from_array(values))
        };
        let half = 0.5 * all("size_m", settings.size_m, 0.0)?;
        let turn = check.within("turn_deg_s", settings.turn_deg_s, -36_000.0..=36_000.0)?;
        let travel = Travel {
            from_m: all("at_m", settings.at_m, -MOST_M)?,
            velocity_m_s: all("velocity_m_s", settings.velocity_m_s, -MOST_M)?,
            turn_deg_s: turn * DVec3::Z,
        };
        let cuboid = Object::new(Cuboid::new(-half, half));
        let scene = Scene::new().with(cuboid, settings.reflectivity);
        Ok(Self {
            scene: Arc::new(scene.map_err(|error| InvalidSetting {
                effect: MovingObjects::NAME,
                setting: "size_m",
                expected: error.to_string(),
                got: half.max_element(),
            })?),
            travel,
        })
    }
}

effect! {
    MovingObjects, MovingObjectsSettings, firings.objects: Arc, "moving_objects",
    idle: "there is nothing that moves",
    needs: |effect| Needs {
            moving: !effect.movers.is_empty(),
            ..Needs::default()
        },
    new: |settings, _| MovingObjects::of(settings)
}

impl ObjectsEffect for MovingObjects {
    fn place(&self, time_s: f64, surroundings: &mut Surroundings) -> u32 {
        let bodies = surroundings.bodies_mut();
        if bodies.len() != self.movers.len() {
            let made = self.movers.iter().map(|mover| {
                let mut body = Body::new(Arc::clone(&mover.scene));
                body.place(mover.travel.at(0.0).ok());
                body
            });
            *bodies = made.collect();
        }
        let mut moved = 0;
        for (mover, body) in self.movers.iter().zip(bodies) {
            // Beyond the largest coordinates it has no placement.
            moved += u32::from(body.place(mover.travel.at(time_s).ok()));
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use super::{MovingBox, MovingObjects, MovingObjectsSettings};
    use crate::cast::Sphere;
    use crate::effect_models::testing::around;
    use crate::effects::Effect;

    fn ball(radius_m: f64, reflectivity: u8) -> Scene {
        let ball = Object::new(Sphere { radius_m });
        Scene::new().with(ball, reflectivity).unwrap()
    }

    fn walker() -> MovingObjects {
        MovingObjects::of(&MovingObjectsSettings {
            boxes: vec![MovingBox {
                at_m: [0.0, 5.0, 0.0],
                size_m: [1.0, 1.0, 2.0],
                velocity_m_s: [0.0, 2.0, 0.0],
                turn_deg_s: 45.0,
                reflectivity: 30,
            }],
        })
        .unwrap()
    }

    #[test]
    fn a_moving_box_is_hit_where_it_is_at_that_time() {
        let objects = walker();
        let mut surroundings = around(ball(9.0, 60));
        let mut range_m = |time_s: f64| {
            objects.place(time_s, &mut surroundings);
            surroundings
                .meet(DVec3::ZERO, DVec3::Y)
                .map(|met| (met.range_m, met.reflectivity))
        };
        let near = |met: Option<(f64, f64)>, range: f64, reflectivity: f64| {
            let (got, of) = met.unwrap();
            assert!(
                (got - range).abs() < 1e-12 && of == reflectivity,
                "{got} {of}"
            );
        };
        near(range_m(0.0), 4.5, 30.0);
        // An eighth of a revolution: its edge faces the scanner.
        near(range_m(1.0), 7.0 - 0.5_f64.sqrt(), 30.0);
        near(range_m(2.0), 8.5, 30.0);
        // Behind the wall.
        near(range_m(3.0), 9.0, 60.0);
        // Too near to be detected, but in front of the wall; then behind the scanner.
        assert_eq!(range_m(-2.0), None);
        near(range_m(-3.0), 9.0, 60.0);
    }

    #[test]
    fn static_boxes_are_placed_once() {
        let mut surroundings = around(Scene::new());
        let standing = MovingObjects::of(&MovingObjectsSettings {
            boxes: vec![MovingBox {
                at_m: [0.0, 5.0, 0.0],
                size_m: [1.0; 3],
                velocity_m_s: [0.0; 3],
                turn_deg_s: 0.0,
                reflectivity: 30,
            }],
        })
        .unwrap();
        assert_eq!(standing.place(1.0, &mut surroundings), 0);
        assert!(surroundings.meet(DVec3::ZERO, DVec3::Y).is_some());
        assert_eq!(walker().place(1.0, &mut surroundings), 1);
        assert!(!MovingObjects::new(Vec::new()).needs().moving);
        let mut wrong = MovingObjectsSettings {
            boxes: vec![MovingBox {
                at_m: [0.0; 3],
                size_m: [1.0, -1.0, 1.0],
                velocity_m_s: [0.0; 3],
                turn_deg_s: 0.0,
                reflectivity: 1,
            }],
        };
        assert_eq!(MovingObjects::of(&wrong).unwrap_err().setting, "size_m");
        wrong.boxes[0].size_m = [1.0; 3];
        wrong.boxes[0].at_m[2] = f64::NAN;
        assert_eq!(MovingObjects::of(&wrong).unwrap_err().setting, "at_m");
    }
}
