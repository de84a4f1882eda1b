//! Trees: a trunk and a crown of overlapping balls.

use glam::dvec3;
use serde::Deserialize;

use super::super::error::{InvalidValue, finite, invalid, within};
use super::super::materials::MaterialAssignment;
use super::{Draws, ObjectPart};
use crate::cast::{Cylinder, Sphere};

/// `trees = { count = N, from_m = [x, y], to_m = [x, y], .. }`: anywhere in a rectangle, their feet
/// at z = 0.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trees {
    /// Number of trees.
    pub count: u32,
    /// A corner of where they stand, metres.
    pub from_m: [f64; 2],
    /// The opposite corner.
    pub to_m: [f64; 2],
    /// The least and the greatest height, metres.
    pub height_m: [f64; 2],
    /// Width of the crown over the height.
    #[serde(default = "usual_spread")]
    pub spread: f64,
    /// Material of the crowns; trunks are of the object's.
    pub foliage: String,
}

const fn usual_spread() -> f64 {
    0.5
}

impl Trees {
    pub(in super::super) fn check(&self) -> Result<(), InvalidValue> {
        finite("trees.from_m", &self.from_m)?;
        finite("trees.to_m", &self.to_m)?;
        within("trees.count", f64::from(self.count), 1.0..=10_000.0)?;
        within("trees.spread", self.spread, 0.05..=3.0)?;
        let [low, high] = self.height_m;
        match 0.0 < low && low <= high && high.is_finite() {
            true => Ok(()),
            false => Err(invalid(
                "trees.height_m",
                "[least, greatest] above 0",
                self.height_m,
            )),
        }
    }
}

/// Balls of a crown.
const BALLS: u32 = 9;

pub(in super::super) fn trees(
    config: &Trees,
    seed: u64,
    bark: u32,
    foliage: u32,
) -> Vec<ObjectPart> {
    let mut draws = Draws::new(seed);
    let ([x0, y0], [x1, y1]) = (config.from_m, config.to_m);
    let mut parts = Vec::new();
    for _ in 0..config.count {
        let foot_m = dvec3(draws.between([x0, x1]), draws.between([y0, y1]), 0.0);
        let height = draws.between(config.height_m);
        let crown_m = 0.5 * config.spread * height;
        let trunk = Cylinder {
            radius_m: 0.02 * height + 0.03,
            bottom_m: 0.0,
            top_m: 0.7 * height,
            capped: false,
        };
        parts.push(ObjectPart::new(trunk, MaterialAssignment::One(bark)).moved(foot_m));
        for _ in 0..BALLS {
            let radius_m = crown_m * draws.between([0.42, 0.62]);
            let angle = draws.between([0.0, std::f64::consts::TAU]);
            let out = (crown_m - radius_m) * draws.unit().sqrt();
            // From a third of the height to its top.
            let up = draws.between([0.34 * height + radius_m, height - radius_m]);
            let at_m = dvec3(out * angle.cos(), out * angle.sin(), up);
            let ball = Sphere { radius_m };
            parts
                .push(ObjectPart::new(ball, MaterialAssignment::One(foliage)).moved(foot_m + at_m));
        }
    }
    parts
}
