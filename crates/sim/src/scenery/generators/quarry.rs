//! A quarry: a pit with a floor, alternating steep faces and berms, a way out, and heaps of rubble.

use glam::{DVec2, dvec2};
use serde::Deserialize;

use super::super::error::{InvalidValue, above_0, finite, invalid, within};
use super::Draws;
use super::draws::{noise, rough};
use crate::cast::{HeightField, HeightFieldError};

/// `height_field = { quarry = { .. } }`: a pit about the origin, whose floor is at z = 0 there.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Quarry {
    /// Length of a side of the square that it fills, metres.
    pub size_m: f64,
    /// From one height to the next, metres.
    pub spacing_m: f64,
    /// Mean distance of the first face, metres.
    pub floor_m: f64,
    /// Middle of the floor, metres: the scanner need not be there.
    pub middle_m: [f64; 2],
    /// Relative deviation of faces from a circle.
    pub winding: f64,
    /// Height of each face, metres.
    pub faces_m: Vec<f64>,
    /// Slope of faces, degrees.
    pub face_deg: f64,
    /// Width of the berm above each face, metres.
    pub berm_m: f64,
    /// The way out: bearing of its centre, counterclockwise from x, and its width, degrees.
    pub way_out_deg: [f64; 2],
    /// Number of heaps.
    pub heaps: u32,
    /// Their least and greatest height, metres.
    pub heap_m: [f64; 2],
    /// Height of the roughness of the ground, metres.
    pub rough_m: f64,
}

impl Default for Quarry {
    fn default() -> Self {
        Self {
            size_m: 220.0,
            spacing_m: 1.0,
            floor_m: 45.0,
            middle_m: [0.0; 2],
            winding: 0.2,
            faces_m: vec![8.0, 8.0],
            face_deg: 74.0,
            berm_m: 8.0,
            way_out_deg: [0.0, 60.0],
            heaps: 10,
            heap_m: [1.5, 4.0],
            rough_m: 0.25,
        }
    }
}

/// The steepest that rubble lies: angle of repose of broken rock.
const REPOSE_DEG: f64 = 37.0;
/// Heaps keep so far off the scanner, metres.
const CLEAR_M: f64 = 6.0;

/// A heap: where, how high.
struct Heap {
    at_m: DVec2,
    height_m: f64,
}

impl Quarry {
    pub(in super::super) fn check(&self) -> Result<(), InvalidValue> {
        above_0("quarry.size_m", self.size_m)?;
        above_0("quarry.spacing_m", self.spacing_m)?;
        above_0("quarry.floor_m", self.floor_m)?;
        finite("quarry.middle_m", &self.middle_m)?;
        within("quarry.winding", self.winding, 0.0..=0.9)?;
        within("quarry.face_deg", self.face_deg, 1.0..=89.0)?;
        within("quarry.berm_m", self.berm_m, 0.0..=10_000.0)?;
        within("quarry.rough_m", self.rough_m, 0.0..=100.0)?;
        within("quarry.heaps", f64::from(self.heaps), 0.0..=1_000.0)?;
        finite("quarry.way_out_deg", &self.way_out_deg)?;
        for height in self.faces_m.iter().chain(&self.heap_m) {
            above_0("quarry.faces_m and heap_m", *height)?;
        }
        let columns = self.size_m / self.spacing_m;
        match (2.0..=5_000.0).contains(&columns) {
            true => Ok(()),
            false => Err(invalid("quarry", "2 to 5000 spacings in a size", columns)),
        }
    }

    /// Half side of the grid, metres.
    pub(in super::super) fn half_m(&self) -> f64 {
        0.5 * (self.columns() - 1) as f64 * self.spacing_m
    }

    fn columns(&self) -> usize {
        (self.size_m / self.spacing_m) as usize + 1
    }

    /// Height of the ground without heaps and roughness.
    fn pit(&self, seed: u64, at_m: DVec2) -> f64 {
        let from_middle = at_m - DVec2::from_array(self.middle_m);
        let out = from_middle.normalize_or_zero();
        let winding = self.winding * noise(seed ^ 1, 2.5 * out.x, 2.5 * out.y);
        let small = 0.025 * rough(seed ^ 2, 8.0 * out.x, 8.0 * out.y);
        let mut beyond = from_middle.length() - self.floor_m * (1.0 + winding + small);
        let mut height_m = 0.0;
        for &face_m in &self.faces_m {
            let run_m = face_m / self.face_deg.to_radians().tan();
            height_m += face_m * (beyond / run_m).clamp(0.0, 1.0);
            beyond -= run_m + self.berm_m;
        }
        let [middle_deg, width_deg] = self.way_out_deg;
        let bearing_deg = from_middle.y.atan2(from_middle.x).to_degrees();
        let off_deg = (bearing_deg - middle_deg + 180.0).rem_euclid(360.0) - 180.0;
        // The sides of the way out rise over some degrees.
        let open = ((off_deg.abs() - 0.5 * width_deg) / 8.0).clamp(0.0, 1.0);
        height_m * open * open * (3.0 - 2.0 * open)
    }

    fn heaps(&self, seed: u64) -> Vec<Heap> {
        let mut draws = Draws::new(seed);
        let slope = REPOSE_DEG.to_radians().tan();
        (0..self.heaps)
            .map(|_| {
                let height_m = draws.between(self.heap_m);
                let foot_m = CLEAR_M + height_m / slope;
                let far_m = (0.85 * self.floor_m).max(foot_m);
                let angle = draws.between([0.0, std::f64::consts::TAU]);
                let middle = DVec2::from_array(self.middle_m);
                let at_m = middle + draws.between([0.2, 1.0]) * far_m * DVec2::from_angle(angle);
                // Pushed off the scanner.
                let off_m = at_m.length().max(foot_m);
                Heap {
                    at_m: off_m * at_m.try_normalize().unwrap_or(DVec2::X),
                    height_m,
                }
            })
            .collect()
    }

    fn height_m(&self, seed: u64, heaps: &[Heap], at_m: DVec2) -> f64 {
        let slope = REPOSE_DEG.to_radians().tan();
        let ground = self.pit(seed, at_m);
        let heaped = heaps.iter().map(|heap| {
            let lumps = 1.0 + 0.25 * noise(seed ^ 3, 0.6 * at_m.x, 0.6 * at_m.y);
            let cone = heap.height_m - slope * lumps * at_m.distance(heap.at_m);
            // Tops are blunt.
            cone.min(0.85 * heap.height_m)
        });
        let top = heaped.fold(ground, f64::max);
        top + self.rough_m * rough(seed ^ 4, 0.2 * at_m.x, 0.2 * at_m.y)
    }
}

/// The pit, from the corner of its square with the least x and y on.
pub(in super::super) fn quarry(
    config: &Quarry,
    seed: u64,
) -> Result<HeightField, HeightFieldError> {
    let (columns, half_m) = (config.columns(), config.half_m());
    let heaps = config.heaps(seed);
    let level_m = config.height_m(seed, &heaps, DVec2::ZERO);
    let along = |step: usize| step as f64 * config.spacing_m - half_m;
    let heights_m = (0..columns)
        .flat_map(|row| (0..columns).map(move |column| (column, row)))
        .map(|(column, row)| {
            config.height_m(seed, &heaps, dvec2(along(column), along(row))) - level_m
        })
        .collect();
    HeightField::new(columns, heights_m, [config.spacing_m; 2])
}
