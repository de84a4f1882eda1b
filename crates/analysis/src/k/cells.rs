//! Directions sorted into cells of similar size in one pass.
//!
//! A cell is a square on a face of the cube around the sphere, with sides of similar angle. The
//! assignment of a point to a cell may be inexact, since the extent of a cell is measured from its
//! points. For sampling, each cell is cut into sixteen parts. Its points are laid out so that any
//! 32 consecutive ones are spread over the cell.

use glam::DVec3;

use super::lanes::LANES;
use super::tree::{Circle, Circles};

/// Pairs per draw.
pub(super) const ROW: usize = 32;

/// Parts along each side of a cell.
const PARTS: usize = 4;
const PART_SIDE: u32 = PARTS as u32;

/// Points by cell, without empty cells.
#[derive(Debug, Default)]
pub(super) struct PointCells {
    /// Points by cell, and by part within a cell.
    items: Vec<CellPoint>,
    /// Coordinates in two layouts per cell. Each layout has [`ROW`] entries more than the cell has
    /// points and repeats its beginning.
    pub columns: [Vec<f32>; 3],
    pub cells: Vec<PointCell>,
    pub around: Circles,
}

/// A cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointCell {
    /// Index of its first point.
    pub first: usize,
    /// Number of points.
    pub len: usize,
    /// Two layouts: the first index in the columns, and the step from each point to the next,
    /// modulo the number of points.
    pub layouts: [(usize, usize); 2],
}

impl PointCell {
    /// Index of the point at a position along a layout.
    pub(super) fn point_index(&self, layout: usize, along: usize) -> usize {
        let step = self.layouts.get(layout).map_or(1, |(_, step)| *step) as u64;
        let len = self.len.max(1) as u64;
        // Both factors are below 2^32.
        self.first + (along as u64 % len * step % len) as usize
    }
}

/// A number in `0..below` from 64 random bits; its probability is off by at most `below / 2^64` in
/// total.
#[inline]
pub(super) const fn scaled(bits: u64, below: usize) -> usize {
    ((bits as u128 * below as u128) >> 64) as usize
}

/// A point to be sorted.
#[derive(Clone, Copy, Debug, Default)]
struct CellPoint {
    at: [f32; 3],
    index: u32,
}

/// Steps of the two layouts, as shares of the number of points. 32 pairs of both layouts form a
/// lattice of rank 1 over all pairs: one pair in every 32nd of each cell.
const STEPS: [f64; 2] = [1.0 / 32.0, 7.0 / 32.0];

impl PointCells {
    /// Index in the input of the point at this place.
    pub(super) fn index(&self, place: usize) -> Option<usize> {
        self.items.get(place).map(|item| item.index as usize)
    }

    /// Sorts points into cells, `side` of them along each edge of the cube.
    pub(super) fn new(points: &[DVec3], side: usize) -> Self {
        let all = 6 * side * side;
        let grid = CubeGrid::new(side);
        let squares: Vec<u32> = points.iter().map(|p| grid.square(*p)).collect();
        let mut next = vec![0_u32; all * PARTS * PARTS];
        for &square in &squares {
            if let Some(count) = next.get_mut(square as usize) {
                *count += 1;
            }
        }
        let mut lens = Vec::with_capacity(all);
        let mut sum = 0_u32;
        for cell in next.chunks_mut(PARTS * PARTS) {
            let before = sum;
            for start in cell {
                sum += std::mem::replace(start, sum);
            }
            lens.push((sum - before) as usize);
        }
        let mut items = vec![CellPoint::default(); points.len()];
        for ((index, p), &square) in (0_u32..).zip(points).zip(&squares) {
            if let Some(next) = next.get_mut(square as usize) {
                if let Some(item) = items.get_mut(*next as usize) {
                    let at = p.as_vec3().to_array();
                    *item = CellPoint { at, index };
                }
                *next += 1;
            }
        }
        let mut sorted = Self::default();
        let room = 2 * (points.len() + all.min(points.len()) * ROW);
        sorted.columns = std::array::from_fn(|_| Vec::with_capacity(room));
        let mut circles = Vec::with_capacity(all);
        let mut rest = items.as_slice();
        let mut first = 0;
        for len in lens.into_iter().filter(|&len| len > 0) {
            let (of, behind) = rest.split_at(len.min(rest.len()));
            rest = behind;
            circles.push(around(of));
            let layouts = STEPS.map(|step| sorted.lay_out(of, step));
            sorted.cells.push(PointCell {
                first,
                len,
                layouts,
            });
            first += len;
        }
        sorted.around = Circles::new(&circles);
        sorted.items = items;
        sorted
    }

    /// Adds a layout of a cell; returns its start and step.
    fn lay_out(&mut self, of: &[CellPoint], share: f64) -> (usize, usize) {
        let step = coprime((of.len() as f64 * share) as usize, of.len());
        let [x, y, z] = &mut self.columns;
        let start = x.len();
        let mut at = 0;
        // The layout wraps around.
        for _ in 0..of.len() + ROW {
            let [px, py, pz] = of.get(at).map_or([0.0; 3], |item| item.at);
            x.push(px);
            y.push(py);
            z.push(pz);
            at += step;
            if at >= of.len() {
                at -= of.len();
            }
        }
        (start, step)
    }
}

/// The smallest number from `from` on that is coprime to `len`; 0 for a cell of one point.
fn coprime(from: usize, len: usize) -> usize {
    let divisor = |mut a: usize, mut b: usize| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let found = (from.max(1)..len).find(|&step| divisor(step, len) == 1);
    // `len - 1` is always coprime to `len`.
    found.unwrap_or(len.saturating_sub(1))
}

/// The bounding circle of some points, in sixteen lanes. Rounding of the centre does not matter,
/// since the radius is measured from it.
fn around(of: &[CellPoint]) -> Circle {
    let mut sums = [[0.0_f32; LANES]; 3];
    for items in of.chunks(LANES) {
        for (lane, item) in items.iter().enumerate() {
            for (sum, at) in sums.iter_mut().zip(item.at) {
                if let Some(sum) = sum.get_mut(lane) {
                    *sum += at;
                }
            }
        }
    }
    let sum = DVec3::from(sums.map(|lanes| lanes.iter().copied().map(f64::from).sum()));
    let Some(middle) = sum.try_normalize() else {
        return Circle {
            middle: DVec3::X,
            radius: std::f64::consts::PI,
        };
    };
    let [x, y, z] = middle.as_vec3().to_array();
    let mut farthest = [0.0_f32; LANES];
    for items in of.chunks(LANES) {
        for (farthest, item) in farthest.iter_mut().zip(items) {
            let [px, py, pz] = item.at;
            let (dx, dy, dz) = (px - x, py - y, pz - z);
            let squared = dx * dx + dy * dy + dz * dz;
            *farthest = if squared > *farthest {
                squared
            } else {
                *farthest
            };
        }
    }
    let chord = farthest
        .iter()
        .copied()
        .map(f64::from)
        .fold(0.0, f64::max)
        .sqrt();
    // Coordinates are rounded to f32, 6e-8 each, and lengths are 1 within 1e-6: less than 1e-5 in
    // all. Near pi, where a chord resolves angles poorly, the circle is the whole sphere.
    let chord = chord * (1.0 + 1e-6) + 1e-6;
    let radius = if chord > 1.99 {
        std::f64::consts::PI
    } else {
        2.0 * (chord / 2.0).asin() + 2e-5
    };
    Circle { middle, radius }
}

/// Order of the parts of a cell along a space-filling curve (Hilbert 1891).
const ALONG: [u8; PARTS * PARTS] = [0, 1, 14, 15, 3, 2, 13, 12, 4, 7, 8, 11, 5, 6, 9, 10];

/// Squares on the faces of a cube.
struct CubeGrid {
    side: usize,
    /// Half the number of squares along an edge.
    half: f32,
}

impl CubeGrid {
    const fn new(side: usize) -> Self {
        let half = (side * PARTS) as f32 * 0.5;
        Self { side, half }
    }

    /// Index of the face (by the largest coordinate), cell and part of a direction.
    #[inline]
    fn square(&self, p: DVec3) -> u32 {
        let p = p.as_vec3();
        let a = p.abs();
        let is_x = a.x >= a.y && a.x >= a.z;
        let is_y = a.y >= a.z;
        let pick = |x: f32, y: f32, z: f32| if is_x { x } else { if is_y { y } else { z } };
        let (w, u, v) = (
            pick(p.x, p.y, p.z),
            pick(p.y, p.z, p.x),
            pick(p.z, p.x, p.y),
        );
        let face = if is_x { 0 } else { if is_y { 2 } else { 4 } };
        let over = 1.0 / w.abs().max(f32::MIN_POSITIVE);
        // An approximation of the arc tangent over pi/4, which makes the squares similar in angle.
        let even = |t: f32| t * (1.273 - 0.273 * t.abs());
        let most = (self.side * PARTS - 1) as u32;
        let place = |t: f32| (((even(t * over) + 1.0) * self.half) as u32).min(most);
        let face = face + u32::from(w < 0.0);
        let side = self.side as u32;
        let (u, v) = (place(u), place(v));
        let part = (u % PART_SIDE) * PART_SIDE + v % PART_SIDE;
        let cell = (face * side + u / PART_SIDE) * side + v / PART_SIDE;
        let along = ALONG.get(part as usize).copied().unwrap_or(0);
        cell * ALONG.len() as u32 + u32::from(along)
    }
}
