//! Height fields: a grid of heights, two triangles a cell.
//!
//! A field becomes a mesh, as watertight and fast as any, with one triangle test, at the price of
//! some 80 bytes per triangle.

use glam::DVec3;
use thiserror::Error;

use super::mesh::{Mesh, MeshError};

/// Heights over a rectangular grid.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    columns: usize,
    rows: usize,
    heights_m: Vec<f64>,
    spacing_m: [f64; 2],
}

/// An invalid height field.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum HeightFieldError {
    /// Fewer than two columns or rows of heights, or their number does not fill them.
    #[error("height field: expected {columns} x {rows} heights, 2 x 2 at least, got {got}")]
    Shape {
        /// Heights along x.
        columns: usize,
        /// Heights along y.
        rows: usize,
        /// Heights there are.
        got: usize,
    },
    /// A distance between heights that is not finite and above zero.
    #[error("height field: expected spacings above 0 m, got {0:?}")]
    Spacing([f64; 2]),
    /// A height that is not finite, or too many of them.
    #[error("height field")]
    Mesh(#[from] MeshError),
}

impl HeightField {
    /// Rows of `columns` heights along x (metres), one after the other along y, with `spacing_m`
    /// along x and y. The first height is at x = y = 0.
    ///
    /// # Errors
    /// [`HeightFieldError`] if the heights do not fill the grid or the spacing is not above zero.
    pub fn new(
        columns: usize,
        heights_m: Vec<f64>,
        spacing_m: [f64; 2],
    ) -> Result<Self, HeightFieldError> {
        let got = heights_m.len();
        let rows = got.checked_div(columns).unwrap_or(0);
        if columns < 2 || rows < 2 || columns.checked_mul(rows) != Some(got) {
            return Err(HeightFieldError::Shape { columns, rows, got });
        }
        let sound = spacing_m.iter().all(|by| *by > 0.0 && by.is_finite());
        if !sound {
            return Err(HeightFieldError::Spacing(spacing_m));
        }
        Ok(Self {
            columns,
            rows,
            heights_m,
            spacing_m,
        })
    }

    /// The field as triangles. The cell with its lowest corner at column `i` and row `j` has the
    /// triangles `2 (j (columns - 1) + i)`, the half at that corner and along x, and the next one.
    ///
    /// # Errors
    /// [`HeightFieldError::Mesh`] for heights that are not finite, or too many of them.
    pub fn mesh(&self) -> Result<Mesh, HeightFieldError> {
        let vertices: Vec<DVec3> = self
            .heights_m
            .iter()
            .enumerate()
            .map(|(at, &height_m)| {
                let (column, row) = (at % self.columns, at / self.columns);
                let [x, y] = self.spacing_m;
                DVec3::new(column as f64 * x, row as f64 * y, height_m)
            })
            .collect();
        let cells = (0..self.rows - 1)
            .flat_map(|row| (0..self.columns - 1).map(move |column| row * self.columns + column));
        // More than u32 counts is too many for a mesh, which says so.
        let number = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
        let triangles: Vec<[u32; 3]> = cells
            .flat_map(|at| {
                let (next, up) = (at + 1, at + self.columns);
                [[at, next, up], [next, up + 1, up]].map(|corners| corners.map(number))
            })
            .collect();
        Ok(Mesh::new(&vertices, &triangles)?)
    }
}
