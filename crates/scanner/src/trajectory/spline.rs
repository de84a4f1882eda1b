//! A cubic spline through samples by least squares, for motion without a command.
//!
//! Knots are evenly spaced. Their spacing has the least predicted error by generalised
//! cross-validation (Craven and Wahba 1979). A slight stiffness keeps the spline straight in
//! intervals without samples, so that every system has a solution. The normal equations of
//! B-splines have bandwidth four and are solved as such.

use units::{Host, Span, Stamp};

use super::pieces::{CubicPiece, PiecewiseCubic};
use super::profile_fit::Observed;

/// A fitted spline.
#[derive(Clone, Debug)]
pub(super) struct SplineFit {
    pub pieces: PiecewiseCubic,
    /// Knot spacing.
    #[cfg(test)]
    pub spacing: Span,
}

/// A cubic overlaps four B-splines.
const BAND: usize = 4;
/// Ratio of successive spacings.
const STEP: f64 = std::f64::consts::SQRT_2;
/// Closest knots in mean distances of samples, and farthest as a part of the whole.
const CLOSEST: f64 = 2.0;
const FARTHEST: f64 = 0.25;
/// A score worse than the best by this factor ends the search: wider spacings are worse still.
const MAX_SCORE_RATIO: f64 = 10.0;
/// Stiffness against bending, relative to the mean weight of the samples per interval.
const STIFFNESS: f64 = 1e-9;
/// Limit of knots, for the time of a fit.
const MAX_KNOTS: usize = 100_000;

/// Fits `observed`, in order of time and in seconds after `origin`, from `from_s` to `to_s`. `None`
/// with fewer than four of them or without time.
pub(super) fn fit(
    observed: &[Observed],
    origin: Stamp<Host>,
    from_s: f64,
    to_s: f64,
) -> Option<SplineFit> {
    let length = to_s - from_s;
    if observed.len() < BAND || length <= 0.0 || !length.is_finite() {
        return None;
    }
    let mean = length / observed.len() as f64;
    let closest = (CLOSEST * mean).max(length / MAX_KNOTS as f64);
    let farthest = (FARTHEST * length).max(closest);
    let mut best: Option<(f64, Spline)> = None;
    let mut spacing = closest;
    while spacing <= farthest * STEP {
        let knots = (length / spacing).ceil().max(1.0) as usize;
        if let Some(spline) = Spline::fit(observed, from_s, length / knots as f64, knots) {
            let score = spline.score();
            match &best {
                Some((least, _)) if score > MAX_SCORE_RATIO * least => break,
                Some((least, _)) if score >= *least => {}
                _ => best = Some((score, spline)),
            }
        }
        spacing *= STEP;
    }
    let (_, spline) = best?;
    Some(SplineFit {
        pieces: spline.pieces(origin)?,
        #[cfg(test)]
        spacing: Span::from_secs_f64(spline.spacing_s),
    })
}

struct Spline {
    from_s: f64,
    spacing_s: f64,
    coefficients: Vec<f64>,
    /// The factor of the normal equations, for standard deviations.
    factor: Banded,
    squares: f64,
    samples: usize,
    /// Degrees of freedom of the spline.
    degrees_of_freedom: f64,
}

/// Values of the four B-splines over an interval, at `x` (0 to 1) in it.
fn basis(x: f64) -> [f64; BAND] {
    let (y, x2, x3) = (1.0 - x, x * x, x * x * x);
    [
        y * y * y / 6.0,
        (3.0 * x3 - 6.0 * x2 + 4.0) / 6.0,
        (3.0 * (x + x2 - x3) + 1.0) / 6.0,
        x3 / 6.0,
    ]
}

impl Spline {
    fn fit(observed: &[Observed], from_s: f64, spacing_s: f64, intervals: usize) -> Option<Self> {
        let count = intervals + BAND - 1;
        let mut normal = Banded::zeros(count);
        let mut right = vec![0.0; count];
        let place = |at_s: f64| {
            let x = ((at_s - from_s) / spacing_s).clamp(0.0, intervals as f64);
            let interval = (x as usize).min(intervals - 1);
            (interval, basis(x - interval as f64))
        };
        let mut weights = 0.0;
        for o in observed {
            let (first, values) = place(o.at_s);
            let weight = 1.0 / (o.sd_deg * o.sd_deg);
            weights += weight;
            for (i, a) in values.iter().enumerate() {
                *right.get_mut(first + i)? += weight * a * o.angle_deg;
                for (j, b) in values.iter().enumerate().take(i + 1) {
                    normal.add(first + i, first + j, weight * a * b)?;
                }
            }
        }
        let stiffness = STIFFNESS * weights / intervals as f64;
        for k in 2..count {
            let bend = [(k - 2, 1.0), (k - 1, -2.0), (k, 1.0)];
            for (i, a) in bend {
                for (j, b) in bend.iter().filter(|(j, _)| *j <= i) {
                    normal.add(i, *j, stiffness * a * b)?;
                }
            }
        }
        let factor = normal.factor()?;
        let coefficients = factor.solve(right)?;
        let mut spline = Self {
            from_s,
            spacing_s,
            coefficients,
            factor,
            squares: 0.0,
            samples: observed.len(),
            degrees_of_freedom: 0.0,
        };
        for o in observed {
            let (first, values) = place(o.at_s);
            let around = spline.coefficients.get(first..first + BAND)?;
            let angle: f64 = around.iter().zip(values).map(|(c, b)| c * b).sum();
            spline.squares += ((angle - o.angle_deg) / o.sd_deg).powi(2);
        }
        // An interval without samples takes no degree of freedom.
        spline.degrees_of_freedom = (count as f64).min(observed.len() as f64 - 1.0);
        Some(spline)
    }

    fn reduced_chi2(&self) -> f64 {
        self.squares / (self.samples as f64 - self.degrees_of_freedom).max(1.0)
    }

    /// Generalised cross-validation.
    fn score(&self) -> f64 {
        let n = self.samples as f64;
        let left = (1.0 - self.degrees_of_freedom / n).max(1.0 / n);
        self.squares / n / (left * left)
    }

    fn pieces(&self, origin: Stamp<Host>) -> Option<PiecewiseCubic> {
        let at = |k: usize| {
            origin.saturating_add(Span::from_secs_f64(self.from_s + k as f64 * self.spacing_s))
        };
        let intervals = self.coefficients.len() + 1 - BAND;
        let reduced_chi2 = self.reduced_chi2();
        // Away from the ends the inverse of the band matrix is about constant where there are
        // samples; exact variances at each knot would cost more than the fit.
        let pieces = (0..intervals).map(|k| {
            let (from, to) = (at(k), at(k + 1));
            let around = self.coefficients.get(k..k + BAND)?;
            let value = |weights: [f64; BAND]| -> f64 {
                around.iter().zip(weights).map(|(c, w)| c * w).sum()
            };
            let ns = to.saturating_since(from).as_nanos().max(1) as f64;
            let slopes = [[-0.5, 0.0, 0.5, 0.0], [0.0, -0.5, 0.0, 0.5]].map(|w| value(w) / ns);
            let [begin, end] = [0.0, 1.0].map(|x| value(basis(x)));
            let sd = (self.variance(k)? * reduced_chi2).sqrt();
            Some(CubicPiece::hermite(from, ns, [begin, slopes[0]], [end, slopes[1]]).with_sd(sd))
        });
        PiecewiseCubic::new(pieces.collect::<Option<Vec<_>>>()?, at(intervals))
    }

    /// Variance in the middle of interval `k` if the samples' errors are as assumed.
    fn variance(&self, k: usize) -> Option<f64> {
        // The inverse of such a band matrix decays by three quarters per knot.
        const REACH: usize = 12;
        let (low, high) = (
            k.saturating_sub(REACH),
            (k + BAND + REACH).min(self.coefficients.len()),
        );
        let mut right = vec![0.0; high - low];
        for (i, b) in basis(0.5).into_iter().enumerate() {
            *right.get_mut(k - low + i)? = b;
        }
        let solved = self.factor.solve_within(low, right)?;
        let middle = basis(0.5);
        Some(
            solved
                .get(k - low..)?
                .iter()
                .zip(middle)
                .map(|(s, b)| s * b)
                .sum::<f64>()
                .max(0.0),
        )
    }
}

/// Lower triangle of a symmetric matrix of bandwidth four, or of its Cholesky factor.
struct Banded {
    /// Rows: the diagonal element, the one left of it, and so on.
    rows: Vec<[f64; BAND]>,
}

impl Banded {
    fn zeros(count: usize) -> Self {
        Self {
            rows: vec![[0.0; BAND]; count],
        }
    }

    fn get(&self, row: usize, column: usize) -> f64 {
        let left = row.checked_sub(column);
        left.and_then(|left| self.rows.get(row)?.get(left))
            .copied()
            .unwrap_or(0.0)
    }

    /// `column` is at most `row`.
    fn add(&mut self, row: usize, column: usize, value: f64) -> Option<()> {
        *self.rows.get_mut(row)?.get_mut(row.checked_sub(column)?)? += value;
        Some(())
    }

    /// The Cholesky factor; `None` if the matrix is not positive definite.
    fn factor(mut self) -> Option<Self> {
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
    fn solve(&self, right: Vec<f64>) -> Option<Vec<f64>> {
        self.solve_within(0, right)
    }

    /// Solves for the rows from `low` on as if there were no others.
    fn solve_within(&self, low: usize, mut x: Vec<f64>) -> Option<Vec<f64>> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Moment;

    fn observed(count: usize, length_s: f64, motion: impl Fn(f64) -> f64) -> Vec<Observed> {
        (0..count)
            .map(|i| {
                let at_s = length_s * i as f64 / (count - 1) as f64;
                Observed {
                    at_s,
                    angle_deg: motion(at_s),
                    sd_deg: 0.01,
                }
            })
            .collect()
    }

    fn worst(fit: &SplineFit, length_s: f64, motion: impl Fn(f64) -> f64) -> f64 {
        (0..1_000)
            .map(|i| {
                let at_s = length_s * f64::from(i) / 1_000.0;
                let at = Moment {
                    host: Stamp::from_nanos(0) + Span::from_secs_f64(at_s),
                    rest_ns: 0.0,
                };
                (fit.pieces.angle(at).unwrap().0 - motion(at_s)).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_cubic_is_recovered() {
        let motion = |t: f64| 1.0 - 3.0 * t + 2.0 * t * t - 0.7 * t * t * t;
        let fit = fit(&observed(200, 2.0, motion), Stamp::from_nanos(0), 0.0, 2.0).unwrap();
        assert!(worst(&fit, 2.0, motion) < 1e-6);
    }

    #[test]
    fn knots_are_as_close_as_the_motion_requires() {
        let spacing = |hertz: f64| {
            let motion = move |t: f64| (t * hertz * std::f64::consts::TAU).sin();
            let mut noise = 1u32;
            let mut samples = observed(2_000, 2.0, motion);
            for sample in &mut samples {
                noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                sample.angle_deg += 0.02 * (f64::from(noise) / f64::from(u32::MAX) - 0.5);
            }
            let fit = fit(&samples, Stamp::from_nanos(0), 0.0, 2.0).unwrap();
            let off = worst(&fit, 2.0, motion);
            assert!(off < 0.01, "{hertz} Hz: {off}");
            fit.spacing.as_secs_f64()
        };
        let (slow, quick) = (spacing(1.0), spacing(20.0));
        assert!(slow > 4.0 * quick, "{slow} {quick}");
    }

    #[test]
    fn a_gap_in_the_samples_is_bridged() {
        let mut samples = observed(400, 2.0, |t| 5.0 * t);
        samples.retain(|o| !(0.9..1.2).contains(&o.at_s));
        let fit = fit(&samples, Stamp::from_nanos(0), 0.0, 2.0).unwrap();
        assert!(worst(&fit, 2.0, |t| 5.0 * t) < 1e-3);
    }

    #[test]
    fn too_few_samples_give_no_spline() {
        assert!(fit(&observed(3, 1.0, |t| t), Stamp::from_nanos(0), 0.0, 1.0).is_none());
        assert!(fit(&observed(9, 1.0, |t| t), Stamp::from_nanos(0), 1.0, 1.0).is_none());
    }

    #[test]
    fn the_banded_solution_agrees_with_the_dense_one() {
        use nalgebra::{DMatrix, DVector};
        let count = 12;
        let mut band = Banded::zeros(count);
        let mut full = DMatrix::<f64>::zeros(count, count);
        for i in 0..count {
            for j in i.saturating_sub(3)..=i {
                let value = if i == j {
                    5.0 + i as f64
                } else {
                    ((3 * i + j) as f64).sin()
                };
                band.add(i, j, value).unwrap();
                full[(i, j)] = value;
                full[(j, i)] = value;
            }
        }
        let right: Vec<f64> = (0..count).map(|i| (i as f64).cos()).collect();
        let solved = band.factor().unwrap().solve(right.clone()).unwrap();
        let expected = full.lu().solve(&DVector::from_vec(right)).unwrap();
        for (a, b) in solved.iter().zip(expected.iter()) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}
