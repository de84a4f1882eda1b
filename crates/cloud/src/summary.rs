//! Count and extent of points: what a writer reports when it finishes.

/// An axis-aligned box in metres, ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least x, y, z.
    pub min_m: [f64; 3],
    /// Greatest x, y, z.
    pub max_m: [f64; 3],
}

/// How many points there were, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Number of points.
    pub points: u64,
    /// The box around them; `None` without points.
    pub bounds: Option<Bounds>,
}

impl Bounds {
    /// The box around columns x, y, z; NaN does not count. `None` where an axis has no number at all.
    #[must_use]
    pub fn of(columns_m: [&[f64]; 3]) -> Option<Self> {
        let mut bounds = Self {
            min_m: [f64::INFINITY; 3],
            max_m: [f64::NEG_INFINITY; 3],
        };
        let axes = bounds.min_m.iter_mut().zip(&mut bounds.max_m);
        for ((min, max), column) in axes.zip(columns_m) {
            for &value in column {
                // f64::min and max let a number win over NaN.
                *min = min.min(value);
                *max = max.max(value);
            }
            if *min > *max {
                return None;
            }
        }
        Some(bounds)
    }

    /// The box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        let [a, b] = [self, other];
        let each = |f: fn(f64, f64) -> f64, p: [f64; 3], q: [f64; 3]| {
            let ([px, py, pz], [qx, qy, qz]) = (p, q);
            [f(px, qx), f(py, qy), f(pz, qz)]
        };
        Self {
            min_m: each(f64::min, a.min_m, b.min_m),
            max_m: each(f64::max, a.max_m, b.max_m),
        }
    }
}

impl Summary {
    /// Adds what another summary counted.
    pub fn add(&mut self, other: Self) {
        self.points += other.points;
        self.bounds = match (self.bounds, other.bounds) {
            (Some(a), Some(b)) => Some(a.union(b)),
            (a, b) => a.or(b),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fields, Point, Points};

    fn summary(positions: &[[f64; 3]]) -> Summary {
        let mut points = Points::new(Fields::NONE);
        for &position_m in positions {
            points.push(Point {
                position_m,
                ..Point::default()
            });
        }
        points.summary()
    }

    #[test]
    fn batches_add_up_to_the_whole() {
        let all = [
            [1.0, -2.0, 3.0],
            [-4.0, 5.0, 0.5],
            [0.0, 0.0, 9.0],
            [2.0, -7.0, -1.0],
        ];
        let mut total = Summary::default();
        total.add(summary(&all[..1]));
        total.add(summary(&[]));
        total.add(summary(&all[1..]));
        assert_eq!(total, summary(&all));
        assert_eq!(
            total.bounds,
            Some(Bounds {
                min_m: [-4.0, -7.0, -1.0],
                max_m: [2.0, 5.0, 9.0]
            })
        );
    }

    #[test]
    fn nothing_has_no_bounds_and_nan_does_not_widen_them() {
        assert_eq!(summary(&[]), Summary::default());
        assert_eq!(summary(&[[f64::NAN; 3]]).bounds, None);
        let bounds = summary(&[[f64::NAN, 1.0, 1.0], [2.0, 2.0, f64::NAN]]).bounds;
        assert_eq!(
            bounds,
            Some(Bounds {
                min_m: [2.0, 1.0, 1.0],
                max_m: [2.0, 2.0, 1.0]
            })
        );
    }
}
