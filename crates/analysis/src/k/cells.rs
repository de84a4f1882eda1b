//! Directions in cells of about the same size, sorted in one pass.
//!
//! A cell is a square on a face of the cube around the sphere, with sides that are about even in angle. Which cell a point is in need not be exact: what a cell reaches is
//! measured from the points in it. Left out: what is done with them.

use glam::DVec3;

use super::lanes::LANES;
use super::tree::{Circle, Circles};

/// Points by cell; empty cells are left out.
#[derive(Debug, Default)]
pub(super) struct Cells {
    /// Where each point stood, by cell; within a cell in an order of chance.
    pub order: Vec<u32>,
    /// Coordinates in that order, [`LANES`] more of every cell than it has points: it starts again.
    pub columns: [Vec<f32>; 3],
    pub cells: Vec<Cell>,
    pub around: Circles,
}

/// One cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// Its first place in the order.
    pub first: usize,
    /// Its first place in the columns.
    pub column: usize,
    /// Its points.
    pub len: usize,
}

/// Numbers that look like chance (splitmix64).
#[derive(Clone, Debug)]
pub(super) struct Chance(u64);

impl Chance {
    pub(super) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    #[inline]
    pub(super) const fn draw(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

/// A number from 0 to below `below` from 32 random bits: each within `below / 2^32` of as likely as the others, together.
#[inline]
pub(super) const fn scaled(bits: u64, below: usize) -> usize {
    (((bits & 0xFFFF_FFFF) * below as u64) >> 32) as usize
}

/// A point while it is sorted.
#[derive(Clone, Copy, Default)]
struct Item {
    at: [f32; 3],
    index: u32,
}

impl Cells {
    /// With so many cells along each of the cube's edges.
    pub(super) fn new(points: &[DVec3], side: usize, chance: &mut Chance) -> Self {
        let all = 6 * side * side;
        let cells: Vec<u32> = points.iter().map(|p| cell(*p, side)).collect();
        let mut next = vec![0_usize; all];
        for &cell in &cells {
            if let Some(count) = next.get_mut(cell as usize) {
                *count += 1;
            }
        }
        let lens = next.clone();
        let mut sum = 0;
        for start in &mut next {
            sum += std::mem::replace(start, sum);
        }
        let mut items = vec![Item::default(); points.len()];
        for ((index, p), &cell) in (0_u32..).zip(points).zip(&cells) {
            if let Some(next) = next.get_mut(cell as usize) {
                if let Some(item) = items.get_mut(*next) {
                    let at = p.as_vec3().to_array();
                    *item = Item { at, index };
                }
                *next += 1;
            }
        }
        let room = points.len() + all.min(points.len()) * LANES;
        let mut sorted = Self {
            columns: std::array::from_fn(|_| Vec::with_capacity(room)),
            ..Self::default()
        };
        let mut circles = Vec::new();
        let mut rest = items.as_mut_slice();
        let mut first = 0;
        for len in lens.into_iter().filter(|&len| len > 0) {
            let (of, behind) = rest.split_at_mut(len.min(rest.len()));
            rest = behind;
            circles.push(sorted.add(of, first, chance));
            first += len;
        }
        sorted.around = Circles::new(&circles);
        sorted.order = items.iter().map(|item| item.index).collect();
        sorted
    }

    /// Adds a cell, its points in an order of chance.
    fn add(&mut self, of: &mut [Item], first: usize, chance: &mut Chance) -> Circle {
        for at in (1..of.len()).rev() {
            of.swap(at, scaled(chance.draw(), at + 1));
        }
        let column = self.columns.first().map_or(0, Vec::len);
        self.cells.push(Cell {
            first,
            column,
            len: of.len(),
        });
        for (axis, column) in self.columns.iter_mut().enumerate() {
            let start = column.len();
            column.extend(of.iter().map(|item| item.at[axis % 3]));
            // From the start again, as often as it takes.
            for lane in 0..LANES {
                let again = column.get(start + lane).copied();
                column.push(again.unwrap_or_default());
            }
        }
        let exact = |item: &Item| DVec3::from(item.at.map(f64::from));
        let points: Vec<DVec3> = of.iter().map(exact).collect();
        // Rounded to f32 they are 1e-7 off; a circle is rounded outward by more.
        Circle::around(points.iter())
    }
}

/// The face by the greatest coordinate, then the square.
#[inline]
fn cell(p: DVec3, side: usize) -> u32 {
    let p = p.as_vec3();
    let a = p.abs();
    let (face, w, u, v) = if a.x >= a.y && a.x >= a.z {
        (0, p.x, p.y, p.z)
    } else if a.y >= a.z {
        (2, p.y, p.z, p.x)
    } else {
        (4, p.z, p.x, p.y)
    };
    let over = 1.0 / w.abs().max(f32::MIN_POSITIVE);
    // About the arc tangent over pi/4, so that squares are about even.
    let even = |t: f32| t * (1.273 - 0.273 * t.abs());
    let place = |t: f32| (((even(t * over) + 1.0) * 0.5 * side as f32) as usize).min(side - 1);
    let face = face + usize::from(w < 0.0);
    ((face * side + place(u)) * side + place(v)) as u32
}
