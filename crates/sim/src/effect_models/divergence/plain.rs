//! Map of the directions in which a scene is one plane all around: footprints span no edge.
//!
//! The map is a cube about the centre of the tilt axis with 96 x 96 cells per side. Each cell is
//! sampled by 3 x 3 rays, borders included, and by its neighbours' rays. A cell is plain if the
//! inverse distance is linear along every line of samples (one plane) and the reflectivity is
//! constant. Because lasers are off the centre, near surfaces hide more for them: a cell that is
//! not plain marks those around it, as far as the parallax of its nearest sample reaches. Objects
//! so thin that they fit between samples (10 mrad at most) mark the cells along their middle. Thin
//! parts of larger meshes and moving objects are not seen.

use crate::firing::Surroundings;
use glam::DVec3;

/// Cells per side of the cube.
const CELLS: usize = 96;
/// Steps between samples per cell.
const STEPS: usize = 2;
/// Samples per side, one beyond each end.
const GRID: usize = CELLS * STEPS + 3;
/// Angle between samples, radians: 2 / (CELLS * STEPS) where they are farthest apart, rounded up.
const SAMPLE: f64 = 0.0105;
/// Most points along an object's middle.
const MOST_ALONG: f64 = 10_000.0;
/// Largest distance of lasers from the centre, metres; the map does not serve others.
const PARALLAX_M: f64 = 0.1;
/// Largest half angle of a footprint, radians.
const PATCH: f64 = 0.005;
/// The most cells marked in each direction.
const MOST_AROUND: i64 = 16;

/// A sample of the map.
#[derive(Clone, Copy, Debug, Default)]
struct DirectionSample {
    /// Inverse distance to the plane of the cube's side through it; 0 for nothing.
    inverse: f64,
    reflectivity: f64,
}

/// The map of plain cells.
#[derive(Clone, Debug)]
pub(super) struct UniformCells {
    /// By side, row and column.
    cells: Vec<bool>,
}

impl UniformCells {
    /// Samples the surroundings. Deviations below `flat_m` are not edges.
    pub fn new(surroundings: &Surroundings, flat_m: f64) -> Self {
        let mut map = Self {
            cells: vec![true; 6 * CELLS * CELLS],
        };
        for side in 0..6 {
            let seen = look(surroundings, side);
            for row in 0..CELLS {
                for column in 0..CELLS {
                    if let Some(nearest_m) = uneven(&seen, row, column, flat_m) {
                        let nearest_m = nearest_m.max(surroundings.range().min_m);
                        map.spoil(side, row, column, nearest_m);
                    }
                }
            }
        }
        for object in surroundings.static_objects() {
            if let Some((ends, half_m)) = object.middle_line() {
                map.spoil_thin(ends, half_m);
            }
        }
        map
    }

    /// Marks the cells along the middle of an object where it fits between samples.
    fn spoil_thin(&mut self, [from_m, to_m]: [DVec3; 2], half_m: f64) {
        let is_thin = |distance_m: f64| 2.0 * half_m < SAMPLE * distance_m;
        let way_m = to_m - from_m;
        let nearest = -from_m.dot(way_m) / way_m.length_squared();
        let nearest = if nearest.is_finite() { nearest } else { 0.0 };
        let nearest_m = (from_m + nearest.clamp(0.0, 1.0) * way_m).length();
        if !is_thin(from_m.length().max(to_m.length())) {
            return;
        }
        // Nearer parts are not thin, so that steps of half a sample are enough.
        let thin_m = nearest_m.max(2.0 * half_m / SAMPLE);
        let steps = (2.0 * way_m.length() / (SAMPLE * thin_m)).ceil();
        let steps = steps.clamp(1.0, MOST_ALONG) as u32;
        for step in 0..=steps {
            let point_m = from_m + f64::from(step) / f64::from(steps) * way_m;
            let distance_m = point_m.length();
            if is_thin(distance_m)
                && let Some(cell) = cell_of(point_m)
            {
                let (row, column) = (cell / CELLS % CELLS, cell % CELLS);
                self.spoil(cell / (CELLS * CELLS), row, column, distance_m);
            }
        }
    }

    /// Whether the surroundings of a ray's end are plain.
    pub fn is_around(&self, origin_m: DVec3, direction: DVec3, range_m: f64) -> bool {
        if origin_m.length_squared() > PARALLAX_M * PARALLAX_M {
            return false;
        }
        let seen = match range_m.is_finite() {
            true => origin_m + range_m * direction,
            false => direction,
        };
        let cell = cell_of(seen).and_then(|cell| self.cells.get(cell));
        cell.copied().unwrap_or(false)
    }

    /// Marks the cells around a cell whose nearest surface is at this distance.
    fn spoil(&mut self, side: usize, row: usize, column: usize, nearest_m: f64) {
        let width = 2.0 / CELLS as f64;
        let middle = |cell: usize| (cell as f64 + 0.5) * width - 1.0;
        let (u, v) = (middle(column), middle(row));
        // A cell's angle is smaller the farther it is from the side's centre.
        let angle = width / (1.0 + u * u + v * v);
        let reach = (PARALLAX_M / nearest_m + PATCH) / angle;
        let around = (reach.ceil() as i64).clamp(1, MOST_AROUND);
        for down in -around..=around {
            for right in -around..=around {
                let (u, v) = (u + right as f64 * width, v + down as f64 * width);
                if let Some(cell) = cell_of(towards(side, u, v))
                    && let Some(cell) = self.cells.get_mut(cell)
                {
                    *cell = false;
                }
            }
        }
    }
}

/// Direction to a point of a side of the cube; coordinates beyond -1..=1 are outside it.
fn towards(side: usize, u: f64, v: f64) -> DVec3 {
    let w = if side.is_multiple_of(2) { 1.0 } else { -1.0 };
    match side / 2 {
        0 => DVec3::new(w, u, v),
        1 => DVec3::new(v, w, u),
        _ => DVec3::new(u, v, w),
    }
}

/// The cell in which a direction leaves the cube.
fn cell_of(way: DVec3) -> Option<usize> {
    let size = way.abs();
    let (axis, w, u, v) = if size.x >= size.y && size.x >= size.z {
        (0, way.x, way.y, way.z)
    } else if size.y >= size.z {
        (1, way.y, way.z, way.x)
    } else {
        (2, way.z, way.x, way.y)
    };
    if w == 0.0 || !w.is_finite() {
        return None;
    }
    let side = 2 * axis + usize::from(w < 0.0);
    // Saturates at 0.
    let place = |x: f64| (((x / w.abs() + 1.0) * 0.5 * CELLS as f64) as usize).min(CELLS - 1);
    Some((side * CELLS + place(v)) * CELLS + place(u))
}

/// Samples of a side, row by row.
fn look(surroundings: &Surroundings, side: usize) -> Vec<DirectionSample> {
    let place = |step: usize| 2.0 * (step as f64 - 1.0) / (CELLS * STEPS) as f64 - 1.0;
    let mut seen = Vec::with_capacity(GRID * GRID);
    let mut mets = vec![None; GRID];
    for row in 0..GRID {
        let ways = (0..GRID).map(|column| towards(side, place(column), place(row)));
        let (lengths, directions): (Vec<f64>, Vec<DVec3>) =
            ways.map(|way| (way.length(), way / way.length())).unzip();
        surroundings.cast_fan_static(DVec3::ZERO, &directions, &mut mets);
        seen.extend(lengths.iter().zip(&mets).map(|(length, met)| {
            met.map_or(DirectionSample::default(), |met| DirectionSample {
                inverse: length / met.range_m,
                reflectivity: met.reflectivity,
            })
        }));
    }
    seen
}

/// The nearest distance in a cell that is not plain, infinite without a surface; `None` for a plain
/// cell.
fn uneven(seen: &[DirectionSample], row: usize, column: usize, flat_m: f64) -> Option<f64> {
    let at = |row: usize, column: usize| seen.get(row * GRID + column).copied().unwrap_or_default();
    let (first_row, first_column) = (row * STEPS + 1, column * STEPS + 1);
    let (mut nearest, mut plain, mut hole) = (0.0_f64, true, false);
    for row in first_row..=first_row + STEPS {
        for column in first_column..=first_column + STEPS {
            let middle = at(row, column);
            let lines = [
                [at(row, column - 1), at(row, column + 1)],
                [at(row - 1, column), at(row + 1, column)],
                [at(row - 1, column - 1), at(row + 1, column + 1)],
            ];
            for ends in lines {
                let bent = ends[0].inverse + ends[1].inverse - 2.0 * middle.inverse;
                let flat = bent.abs() <= flat_m * middle.inverse * middle.inverse;
                let alike = ends
                    .iter()
                    .all(|end| end.reflectivity == middle.reflectivity);
                plain &= flat && alike;
                for end in ends {
                    nearest = nearest.max(end.inverse);
                    hole |= end.inverse == 0.0;
                }
            }
        }
    }
    match (plain, hole) {
        (true, _) => None,
        // A surface too near to be detected may cause the gap.
        (false, true) => Some(0.0),
        (false, false) => Some(1.0 / nearest),
    }
}
