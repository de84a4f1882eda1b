//! Cells on the sphere: the faces of a cube seen from its centre, each cut into four repeatedly.
//!
//! Great circles bound a cell, so a ball around its centre that contains the corners contains the
//! cell.

use glam::DVec3;

/// A cell: face of the cube, number of cuts, and position among the 4^level cells of the face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct CubeCell {
    face: u8,
    pub level: u8,
    /// Bits of column and row, interleaved.
    code: u64,
}

/// The largest number of cuts; cells are 1e-9 rad wide then.
pub(super) const MOST_CUTS: u8 = 31;

impl CubeCell {
    /// The six faces.
    pub fn faces() -> [Self; 6] {
        [0, 1, 2, 3, 4, 5].map(|face| Self {
            face,
            level: 0,
            code: 0,
        })
    }

    /// All cells of a level, by number.
    pub fn all(level: u8) -> Vec<Self> {
        let mut cells = Self::faces().to_vec();
        for _ in 0..level {
            cells = cells.into_iter().flat_map(Self::cut).collect();
        }
        cells
    }

    /// The four parts of the cell.
    pub fn cut(self) -> [Self; 4] {
        [0, 1, 2, 3].map(|quarter| Self {
            face: self.face,
            level: self.level + 1,
            code: 4 * self.code + quarter,
        })
    }

    /// Index among the cells of its level; the four parts of a cell are consecutive.
    pub fn number(self) -> usize {
        ((u64::from(self.face) << (2 * self.level)) + self.code) as usize
    }

    /// Centre, and radius of a ball around it that contains the cell.
    pub fn ball(self) -> (DVec3, f64) {
        let width = 2.0 / (1_u64 << self.level) as f64;
        let (column, row) = (every_other(self.code), every_other(self.code >> 1));
        let at = |right: f64, up: f64| {
            let u = (column as f64 + right) * width - 1.0;
            let v = (row as f64 + up) * width - 1.0;
            let out = if self.face.is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
            match self.face / 2 {
                0 => DVec3::new(out, u, v),
                1 => DVec3::new(u, out, v),
                _ => DVec3::new(u, v, out),
            }
            .normalize()
        };
        let middle = at(0.5, 0.5);
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
        let off = corners.map(|(right, up)| at(right, up).distance_squared(middle));
        (middle, off.into_iter().fold(0.0, f64::max).sqrt() + 1e-15)
    }

    /// Index of the cell of a level that contains a direction.
    #[inline]
    pub fn of(direction: DVec3, level: u8) -> usize {
        let [x, y, z] = direction.to_array();
        let size = direction.abs();
        let (face, along, u, v) = if size.x >= size.y && size.x >= size.z {
            (0, x, y, z)
        } else if size.y >= size.z {
            (2, y, x, z)
        } else {
            (4, z, x, y)
        };
        let side = 1_u64 << level;
        let half = 0.5 * side as f64;
        let scale = half / along.abs();
        let place = |w: f64| ((w * scale + half) as u64).min(side - 1);
        let face = face + u64::from(along < 0.0);
        let code = spread(place(u)) | spread(place(v)) << 1;
        ((face << (2 * level)) + code) as usize
    }
}

/// Inserts a zero between every two of 32 bits.
#[inline]
fn spread(bits: u64) -> u64 {
    let mut x = bits & 0xffff_ffff;
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555_u64),
    ] {
        x = (x | x << shift) & mask;
    }
    x
}

/// Gathers bits 0, 2, 4 and so on.
fn every_other(bits: u64) -> u64 {
    let mut x = bits & 0x5555_5555_5555_5555;
    for (shift, mask) in [
        (1, 0x3333_3333_3333_3333),
        (2, 0x0f0f_0f0f_0f0f_0f0f),
        (4, 0x00ff_00ff_00ff_00ff),
        (8, 0x0000_ffff_0000_ffff),
        (16, 0x0000_0000_ffff_ffff_u64),
    ] {
        x = (x | x >> shift) & mask;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_lie_in_the_ball_of_their_cell_at_every_level() {
        for k in 0..2_000 {
            let (a, z) = (f64::from(k) * 2.4, f64::from(k) / 1_000.0 - 0.999_5);
            let r = (1.0 - z * z).sqrt();
            let direction = DVec3::new(r * a.cos(), r * a.sin(), z);
            let mut open = CubeCell::faces().to_vec();
            for level in 0..=20 {
                let number = CubeCell::of(direction, level);
                let own: Vec<CubeCell> =
                    open.into_iter().filter(|c| c.number() == number).collect();
                assert_eq!(own.len(), 1);
                let (middle, radius) = own[0].ball();
                assert!(direction.distance(middle) <= radius);
                assert!(radius < 1.5 * 2.0_f64.powi(-i32::from(level)));
                open = own[0].cut().to_vec();
            }
        }
    }

    #[test]
    fn spreading_and_gathering_bits_round_trips() {
        for bits in [0, 1, 2, 0xdead_beef, 0xffff_ffff] {
            assert_eq!(every_other(spread(bits)), bits);
            assert_eq!(every_other(spread(bits) | 0xaaaa), bits);
        }
        assert_eq!(spread(0b1011), 0b100_0101);
    }
}
