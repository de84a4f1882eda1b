//! Symmetric matrices of bandwidth four: the normal equations of a spline of cubics.

/// A cubic depends on angle and speed at both ends.
pub(super) const BAND: usize = 4;

/// Lower triangle of a symmetric matrix of bandwidth four, or of its Cholesky factor.
pub(super) struct Banded {
    /// Rows: the diagonal element, the one left of it, and so on.
    rows: Vec<[f64; BAND]>,
}

impl Banded {
    pub(super) fn zeros(count: usize) -> Self {
        Self {
            rows: vec![[0.0; BAND]; count],
        }
    }

    pub(super) fn get(&self, row: usize, column: usize) -> f64 {
        let left = row.checked_sub(column);
        left.and_then(|left| self.rows.get(row)?.get(left))
            .copied()
            .unwrap_or(0.0)
    }

    /// `column` is at most `row`.
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) -> Option<()> {
        *self.rows.get_mut(row)?.get_mut(row.checked_sub(column)?)? += value;
        Some(())
    }

    /// Adds a symmetric matrix of the coefficients at `index`.
    pub(super) fn add_block(
        &mut self,
        index: [usize; BAND],
        block: &[[f64; BAND]; BAND],
    ) -> Option<()> {
        for (n, (i, row)) in index.into_iter().zip(block).enumerate() {
            for (j, value) in index.into_iter().zip(row).take(n + 1) {
                self.add(i.max(j), i.min(j), *value)?;
            }
        }
        Some(())
    }

    /// The Cholesky factor; `None` if the matrix is not positive definite.
    pub(super) fn factor(mut self) -> Option<Self> {
        for i in 0..self.rows.len() {
            for j in i.saturating_sub(BAND - 1)..=i {
                let from = i.saturating_sub(BAND - 1);
                let sum: f64 = (from..j).map(|k| self.get(i, k) * self.get(j, k)).sum();
                let rest = self.get(i, j) - sum;
                let value = if i == j {
                    if rest <= 0.0 || !rest.is_finite() {
                        return None;
                    }
                    rest.sqrt()
                } else {
                    rest / self.get(j, j)
                };
                *self.rows.get_mut(i)?.get_mut(i - j)? = value;
            }
        }
        Some(self)
    }

    /// Solves with the factor.
    pub(super) fn solve(&self, right: Vec<f64>) -> Option<Vec<f64>> {
        self.solve_within(0, right)
    }

    /// Solves for the rows from `low` on as if there were no others.
    pub(super) fn solve_within(&self, low: usize, mut x: Vec<f64>) -> Option<Vec<f64>> {
        let n = x.len();
        for i in 0..n {
            let from = i.saturating_sub(BAND - 1);
            let sum: f64 = (from..i)
                .map(|k| Some(self.get(low + i, low + k) * x.get(k)?))
                .sum::<Option<f64>>()?;
            let value = (x.get(i)? - sum) / self.get(low + i, low + i);
            *x.get_mut(i)? = value;
        }
        for i in (0..n).rev() {
            let to = (i + BAND).min(n);
            let sum: f64 = (i + 1..to)
                .map(|k| Some(self.get(low + k, low + i) * x.get(k)?))
                .sum::<Option<f64>>()?;
            let value = (x.get(i)? - sum) / self.get(low + i, low + i);
            *x.get_mut(i)? = value;
        }
        Some(x)
    }
}
