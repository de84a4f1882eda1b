//! Small dense linear algebra: Cholesky factors and the axes of a symmetric 3 x 3 matrix.

pub(crate) type Vec3 = [f64; 3];

pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// `a + factor b`.
pub(crate) fn add(a: Vec3, factor: f64, b: Vec3) -> Vec3 {
    [
        a[0] + factor * b[0],
        a[1] + factor * b[1],
        a[2] + factor * b[2],
    ]
}

/// Product of a matrix, by rows, and a vector.
pub(crate) fn apply(rows: &[Vec3; 3], v: Vec3) -> Vec3 {
    [dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)]
}

/// A square matrix by rows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Matrix {
    pub size: usize,
    pub values: Vec<f64>,
}

impl Matrix {
    pub fn zero(size: usize) -> Self {
        Self {
            size,
            values: vec![0.0; size * size],
        }
    }

    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.values[row * self.size + column]
    }

    pub fn at_mut(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.values[row * self.size + column]
    }

    /// Copies the lower triangle to the upper one.
    pub fn mirror(&mut self) {
        for row in 0..self.size {
            for column in 0..row {
                *self.at_mut(column, row) = self.at(row, column);
            }
        }
    }
}

/// The lower factor L of a positive definite A = L L'.
#[derive(Clone, Debug)]
pub(crate) struct Cholesky {
    lower: Matrix,
}

impl Cholesky {
    /// Factors a matrix, of which the lower triangle is read; `None` if it is not positive
    /// definite.
    pub fn new(matrix: &Matrix) -> Option<Self> {
        let size = matrix.size;
        let mut lower = matrix.clone();
        for row in 0..size {
            for column in 0..=row {
                let (start, other) = (row * size, column * size);
                let mut sum = lower.values[start + column];
                for k in 0..column {
                    sum -= lower.values[start + k] * lower.values[other + k];
                }
                if row == column {
                    if !(sum > 0.0 && sum.is_finite()) {
                        return None;
                    }
                    lower.values[start + column] = sum.sqrt();
                } else {
                    lower.values[start + column] = sum / lower.values[other + column];
                }
            }
        }
        Some(Self { lower })
    }

    /// Replaces b by L^-1 b.
    pub fn forward(&self, b: &mut [f64]) {
        let (size, lower) = (self.lower.size, &self.lower.values);
        for row in 0..size {
            let mut sum = b[row];
            for k in 0..row {
                sum -= lower[row * size + k] * b[k];
            }
            b[row] = sum / lower[row * size + row];
        }
    }

    /// Replaces b by L'^-1 b.
    fn backward(&self, b: &mut [f64]) {
        let (size, lower) = (self.lower.size, &self.lower.values);
        for row in (0..size).rev() {
            let mut sum = b[row];
            for k in row + 1..size {
                sum -= lower[k * size + row] * b[k];
            }
            b[row] = sum / lower[row * size + row];
        }
    }

    /// Replaces b by A^-1 b.
    pub fn solve(&self, b: &mut [f64]) {
        self.forward(b);
        self.backward(b);
    }

    /// A^-1.
    pub fn inverse(&self) -> Matrix {
        let size = self.lower.size;
        let mut inverse = Matrix::zero(size);
        let mut column = vec![0.0; size];
        for index in 0..size {
            column.fill(0.0);
            column[index] = 1.0;
            self.solve(&mut column);
            for (row, value) in column.iter().enumerate() {
                *inverse.at_mut(row, index) = *value;
            }
        }
        inverse
    }
}

/// Eigenvalues of a symmetric 3 x 3 matrix in ascending order, and their unit eigenvectors, by
/// Jacobi's rotations.
pub(crate) fn axes(mut a: [Vec3; 3]) -> ([f64; 3], [Vec3; 3]) {
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..30 {
        let off = a[0][1].abs() + a[0][2].abs() + a[1][2].abs();
        if off <= 1e-16 * (a[0][0].abs() + a[1][1].abs() + a[2][2].abs()) {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let t = if theta == 0.0 { 1.0 } else { t };
            let cos = 1.0 / t.hypot(1.0);
            let sin = t * cos;
            for row in &mut a {
                let (x, y) = (row[p], row[q]);
                (row[p], row[q]) = (cos * x - sin * y, sin * x + cos * y);
            }
            let (x, y) = (a[p], a[q]);
            a[p] = add(x.map(|part| cos * part), -sin, y);
            a[q] = add(y.map(|part| cos * part), sin, x);
            for row in &mut v {
                let (x, y) = (row[p], row[q]);
                (row[p], row[q]) = (cos * x - sin * y, sin * x + cos * y);
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    (
        order.map(|i| a[i][i]),
        order.map(|i| [v[0][i], v[1][i], v[2][i]]),
    )
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn axes_are_orthonormal_and_diagonalise(m in prop::array::uniform6(-10.0..10.0)) {
            let a = [[m[0], m[1], m[2]], [m[1], m[3], m[4]], [m[2], m[4], m[5]]];
            let (values, vectors) = axes(a);
            prop_assert!(values[0] <= values[1] && values[1] <= values[2]);
            for (i, v) in vectors.into_iter().enumerate() {
                for (j, w) in vectors.into_iter().enumerate() {
                    let expected = if i == j { 1.0 } else { 0.0 };
                    prop_assert!((dot(v, w) - expected).abs() < 1e-12);
                }
                let image = apply(&a, v);
                for k in 0..3 {
                    prop_assert!((image[k] - values[i] * v[k]).abs() < 1e-11);
                }
            }
        }

        #[test]
        fn cholesky_solves_positive_definite_systems(
            m in prop::collection::vec(-1.0..1.0, 25),
            b in prop::collection::vec(-1.0..1.0, 5),
        ) {
            let mut a = Matrix::zero(5);
            for i in 0..5 {
                for j in 0..5 {
                    let product: f64 = (0..5).map(|k| m[5 * i + k] * m[5 * j + k]).sum();
                    *a.at_mut(i, j) = product + if i == j { 0.1 } else { 0.0 };
                }
            }
            let cholesky = Cholesky::new(&a).unwrap();
            let mut x = b.clone();
            cholesky.solve(&mut x);
            let inverse = cholesky.inverse();
            for i in 0..5 {
                let image: f64 = (0..5).map(|k| a.at(i, k) * x[k]).sum();
                prop_assert!((image - b[i]).abs() < 1e-9);
                let by_inverse: f64 = (0..5).map(|k| inverse.at(i, k) * b[k]).sum();
                prop_assert!((by_inverse - x[i]).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn a_singular_matrix_has_no_factor() {
        assert!(Cholesky::new(&Matrix::zero(2)).is_none());
    }
}
