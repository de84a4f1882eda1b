//! Limits of the memory: columns of points, written and copied without computation.

use std::hint::black_box;

/// Rows that are written to every column before the next rows: a block's channels.
const BLOCK: usize = 32;

/// Five columns of eight bytes, two of one.
pub struct Columns {
    wide: [Vec<f64>; 5],
    narrow: [Vec<u8>; 2],
    value: u8,
}

impl Columns {
    /// Creates columns of this many rows and touches every page of them.
    pub fn new(rows: usize) -> Self {
        Self {
            wide: [(); 5].map(|()| vec![1.0; rows]),
            narrow: [(); 2].map(|()| vec![1; rows]),
            value: 0,
        }
    }

    /// Writes a value that grows from row to row, a block of every column at a time, as points
    /// come. Gives the rows.
    pub fn write(&mut self) -> usize {
        self.value = black_box(self.value.wrapping_add(1));
        let rows = self.wide[0].len();
        for row in (0..rows).step_by(BLOCK) {
            let end = rows.min(row + BLOCK);
            let base = f64::from(self.value) + row as f64;
            for column in &mut self.wide {
                for (i, value) in column[row..end].iter_mut().enumerate() {
                    *value = base + f64::from(i as u32);
                }
            }
            for column in &mut self.narrow {
                for (i, value) in column[row..end].iter_mut().enumerate() {
                    *value = self.value.wrapping_add(i as u8);
                }
            }
        }
        black_box(&self.wide);
        black_box(&self.narrow);
        rows
    }

    /// Copies a batch over and over until all rows are written. Gives the rows.
    pub fn copy_from(&mut self, batch: &Self) -> usize {
        let step = batch.wide[0].len().max(1);
        let rows = self.wide[0].len();
        for row in (0..rows).step_by(step) {
            let end = rows.min(row + step);
            for (to, from) in self.wide.iter_mut().zip(&batch.wide) {
                to[row..end].copy_from_slice(&from[..end - row]);
            }
            for (to, from) in self.narrow.iter_mut().zip(&batch.narrow) {
                to[row..end].copy_from_slice(&from[..end - row]);
            }
        }
        black_box(&self.wide);
        black_box(&self.narrow);
        rows
    }
}
