//! Number and extent of points.

/// An axis-aligned box in metres, ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least x, y, z.
    pub min_m: [f64; 3],
    /// Greatest x, y, z.
    pub max_m: [f64; 3],
}

/// Number and extent of points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// Number of points.
    pub points: u64,
    /// Bounding box; `None` without points.
    pub bounds: Option<Bounds>,
}

impl Bounds {
    /// The box around columns x, y, z; NaN is ignored. `None` if an axis has no number.
    #[must_use]
    pub fn of(columns_m: [&[f64]; 3]) -> Option<Self> {
        let mut bounds = Self {
            min_m: [f64::INFINITY; 3],
            max_m: [f64::NEG_INFINITY; 3],
        };
        let axes = bounds.min_m.iter_mut().zip(&mut bounds.max_m);
        for ((min, max), column) in axes.zip(columns_m) {
            (*min, *max) = extent(column);
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

/// Independent comparisons: more than the latency of one, so that none waits for another.
const LANES: usize = 16;

/// Least and greatest number of a column; infinities in reverse if there is none.
fn extent(column: &[f64]) -> (f64, f64) {
    let (mut least, mut greatest) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    let (chunks, rest) = column.as_chunks::<LANES>();
    for chunk in chunks {
        for ((least, greatest), &value) in least.iter_mut().zip(&mut greatest).zip(chunk) {
            // NaN is neither less nor greater, so that every number replaces it.
            *least = if value < *least { value } else { *least };
            *greatest = if value > *greatest { value } else { *greatest };
        }
    }
    let least = least
        .iter()
        .chain(rest)
        .copied()
        .fold(f64::INFINITY, f64::min);
    let greatest = greatest.iter().chain(rest).copied();
    (least, greatest.fold(f64::NEG_INFINITY, f64::max))
}

impl Summary {
    /// Adds another summary.
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
    fn summaries_of_batches_add_up_to_the_summary_of_the_cloud() {
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

    /// For every length around the number of lanes and NaN at every position.
    #[test]
    fn simd_lanes_agree_with_a_scalar_search() {
        for len in 0..=3 * LANES {
            let column: Vec<f64> = (0..len)
                .map(|i| f64::from((i * 37 % 101) as u32) - 50.0)
                .collect();
            for nan in 0..=len {
                let mut column = column.clone();
                if let Some(value) = column.get_mut(nan) {
                    *value = f64::NAN;
                }
                let plain = column
                    .iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
                        (a.min(*v), b.max(*v))
                    });
                assert_eq!(extent(&column), plain, "{len} {nan}");
            }
        }
    }

    #[test]
    fn empty_clouds_have_no_bounds_and_nan_is_ignored() {
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
