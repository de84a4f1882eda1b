//! Objects: things that move while the scan lasts, as a lidar that needs 0.1 s for a turn and the tilt its time see them: sheared, or twice.
//!
//! A body goes at a steady velocity and turns steadily about its own origin; every firing meets it where it stands when the first laser fires. Bodies are the
//! boxes of this effect's table and whatever of the scene's `[[objects]]` has a velocity or a turn. Left out:
//! its way during a firing (55 us: 1 mm at 20 m/s), bodies that speed up, and collisions.

use std::sync::Arc;

use glam::DVec3;
use serde::Deserialize;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Absorb, Asked, Effect, Listed, Needs, Objects};
use crate::cast::{Cuboid, Object};
use crate::scene::Scene;
use crate::scenery::Travel;
use crate::simulate::{Body, Surroundings};

/// `[effects.moving_objects]`.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct MovingObjectsSettings {
    /// Boxes: what is as large as a person, a car, a trolley.
    pub boxes: Vec<MovingBox>,
}

/// A box that moves.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct MovingBox {
    /// Where its middle is at the start, metres in the frame of the base.
    pub at_m: [f64; 3],
    /// Its edges, metres.
    pub size_m: [f64; 3],
    /// How it goes, metres per second.
    #[serde(default)]
    pub velocity_m_s: [f64; 3],
    /// How it turns about the vertical through its middle, degrees per second, anticlockwise seen from above.
    #[serde(default)]
    pub turn_deg_s: f64,
    /// Calibrated reflectivity; 50 unless said.
    #[serde(default = "plain")]
    pub reflectivity: u8,
}

const fn plain() -> u8 {
    50
}

/// A body on its way.
#[derive(Clone, Debug)]
pub struct Mover {
    /// What it is, in its own frame.
    pub scene: Arc<Scene>,
    /// How that frame goes and turns.
    pub travel: Travel,
}

/// What moves.
#[derive(Clone, Debug)]
pub struct MovingObjects {
    movers: Vec<Mover>,
}

/// The farthest that a box may be or go in a second, and the largest that it may be, metres.
const MOST_M: f64 = 1e4;

impl MovingObjects {
    /// What the scene file calls it.
    pub const NAME: &'static str = "moving_objects";

    /// Any bodies.
    #[must_use]
    pub const fn new(movers: Vec<Mover>) -> Self {
        Self { movers }
    }

    /// The boxes of these settings.
    ///
    /// # Errors
    /// [`Unfit`] for numbers out of their range.
    pub fn of(settings: &MovingObjectsSettings) -> Result<Self, Unfit> {
        let movers = settings.boxes.iter().map(Mover::of);
        Ok(Self::new(movers.collect::<Result<_, _>>()?))
    }

    /// These and more of them.
    #[must_use]
    pub fn and(mut self, more: impl IntoIterator<Item = Mover>) -> Self {
        self.movers.extend(more);
        self
    }
}

impl Mover {
    /// A box.
    fn of(settings: &MovingBox) -> Result<Self, Unfit> {
        let check = Check(MovingObjects::NAME);
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
            scene: Arc::new(scene.map_err(|error| Unfit {
                effect: MovingObjects::NAME,
                setting: "size_m",
                expected: error.to_string(),
                got: half.max_element(),
            })?),
            travel,
        })
    }
}

impl Settings for MovingObjectsSettings {
    fn ask(&self, _: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Arc::new(MovingObjects::of(self)?);
        asked.firings.objects.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for MovingObjects {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn needs(&self) -> Needs {
        Needs {
            moving: !self.movers.is_empty(),
            ..Needs::NOTHING
        }
    }

    fn why_idle(&self) -> &'static str {
        "there is nothing that moves"
    }
}

impl Absorb for MovingObjects {}

impl Objects for MovingObjects {
    fn place(&self, at_s: f64, surroundings: &mut Surroundings) -> u32 {
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
            // Out of all bounds it is nowhere.
            moved += u32::from(body.place(mover.travel.at(at_s).ok()));
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cast::Sphere;
    use crate::effects::testing::around;

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
    fn a_box_is_met_where_it_stands_then() {
        let objects = walker();
        let mut surroundings = around(ball(9.0, 60));
        let mut range_m = |at_s: f64| {
            objects.place(at_s, &mut surroundings);
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
        // An eighth of a turn: its edge looks here.
        near(range_m(1.0), 7.0 - 0.5_f64.sqrt(), 30.0);
        near(range_m(2.0), 8.5, 30.0);
        // Beyond the wall.
        near(range_m(3.0), 9.0, 60.0);
        // Too near to be seen, but in the way; then behind.
        assert_eq!(range_m(-2.0), None);
        near(range_m(-3.0), 9.0, 60.0);
    }

    #[test]
    fn what_stands_is_placed_once() {
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
