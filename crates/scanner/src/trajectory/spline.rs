//! A cubic spline through samples by least squares, for motion without a command.
//!
//! Its pieces are cubics with a common angle and speed where they meet, so that the acceleration
//! may change at once, as it does at corners of the commanded motion. Where an obstacle stops the
//! head the speed changes at once, too: at kinks (`kinks`) pieces share the angle only. An interval
//! is halved while residuals in it have a common sign over more samples than chance explains (a
//! scan statistic over windows of all sizes): knots are far apart on straight lines and close where
//! the motion changes. The normal equations have bandwidth four and are solved as such.

use units::{Host, Span, Stamp};

use super::banded::{BAND, Banded};
use super::pieces::{CubicPiece, PiecewiseCubic};
use super::profile_fit::Observed;

/// A fitted spline.
#[derive(Clone, Debug)]
pub(super) struct SplineFit {
    pub pieces: PiecewiseCubic,
    /// Free parameters.
    pub parameters: usize,
}

/// Parameters of a spline of one interval.
pub(super) const FEWEST_PARAMETERS: usize = BAND;
/// Least number of samples in an interval.
const MIN_SAMPLES: usize = 3;
/// Rounds of halving at most: intervals of a millisecond in a quarter of an hour.
const MAX_ROUNDS: usize = 24;
/// Excess of the square of a window's mean over its expectation, in its variances, at which an
/// interval is halved, beyond the greatest of as many windows by chance (2 ln n).
const MIN_EXCESS: f64 = 6.0;
/// Stiffness against bending, relative to the least weight of a sample.
const STIFFNESS: f64 = 1e-9;
/// Median magnitude of the difference of two standard normal variables.
const MEDIAN_DIFFERENCE: f64 = 0.953_873;
/// Its ninth decile.
const TAIL_DIFFERENCE: f64 = 2.326_174;
/// Least share of the assumed errors that samples have.
const MIN_SCALE: f64 = 0.25;

/// Fits `observed`, in order of time and in seconds after `origin`, from `from_s` to `to_s`, with
/// kinks at `kinks_s`. `None` with fewer than four of them or without time.
pub(super) fn fit(
    observed: &[Observed],
    origin: Stamp<Host>,
    (from_s, to_s): (f64, f64),
    kinks_s: &[f64],
) -> Option<SplineFit> {
    let length = to_s - from_s;
    if observed.len() < BAND || length <= 0.0 || !length.is_finite() {
        return None;
    }
    let end = |at_s| Knot {
        at_s,
        is_kink: false,
    };
    let kinks = kinks_s.iter().map(|at_s| Knot {
        at_s: *at_s,
        is_kink: true,
    });
    let mut knots = vec![end(from_s)];
    knots.extend(kinks);
    knots.push(end(to_s));
    let mut spline = Spline::fit(observed, knots)?;
    for _ in 0..MAX_ROUNDS {
        knots = spline.finer_knots(observed);
        if knots.len() == spline.knots.len() {
            break;
        }
        spline = Spline::fit(observed, knots)?;
    }
    Some(SplineFit {
        pieces: spline.pieces(origin)?,
        parameters: spline.coefficients.len(),
    })
}

/// A knot, in seconds after the origin.
#[derive(Clone, Copy, Debug)]
struct Knot {
    at_s: f64,
    /// The speed changes at once.
    is_kink: bool,
}

struct Spline {
    knots: Vec<Knot>,
    /// Angle and speed at each knot; at kinks the speed before, the angle and the speed after.
    coefficients: Vec<f64>,
    /// The factor of the normal equations, for standard deviations.
    factor: Banded,
    /// Residuals of the samples, in their standard deviations.
    residuals: Vec<f64>,
    /// Index of the first sample of each interval, and the number of samples.
    firsts: Vec<usize>,
    /// Indices of the coefficients of each interval.
    indices: Vec<[usize; BAND]>,
}

/// Indices of angle and speed at both ends of each interval.
fn indices(knots: &[Knot]) -> Vec<[usize; BAND]> {
    let mut first = 0;
    let pairs = knots.windows(2).map(|pair| {
        let kink = |knot: Option<&Knot>| usize::from(knot.is_some_and(|knot| knot.is_kink));
        let (left, right) = (kink(pair.first()), kink(pair.last()));
        let angle = first + left;
        first = angle + 2;
        // Before a kink the speed is first.
        [angle, angle + 1, angle + 2 + right, angle + 3 - right]
    });
    pairs.collect()
}

/// Weights of angle and speed at both ends of an interval of `length` at `x` (0 to 1) in it.
fn basis(x: f64, length: f64) -> [f64; BAND] {
    let y = 1.0 - x;
    [
        (1.0 + 2.0 * x) * y * y,
        length * x * y * y,
        x * x * (3.0 - 2.0 * x),
        -length * x * x * y,
    ]
}

impl Spline {
    fn fit(observed: &[Observed], knots: Vec<Knot>) -> Option<Self> {
        let count = 2 * knots.len() + knots.iter().filter(|knot| knot.is_kink).count();
        let mut normal = Banded::zeros(count);
        let mut right = vec![0.0; count];
        let weight = |o: &Observed| 1.0 / (o.sd_deg * o.sd_deg);
        let stiffness = STIFFNESS * observed.iter().map(weight).fold(f64::INFINITY, f64::min);
        let mut firsts = vec![0];
        let indices = indices(&knots);
        for (k, pair) in knots.windows(2).enumerate() {
            let [from, to] = [pair.first()?.at_s, pair.last()?.at_s];
            let index = *indices.get(k)?;
            let length = to - from;
            let first = *firsts.last()?;
            let rest = observed.get(first..)?;
            let inside = if k + 2 == knots.len() {
                rest.len()
            } else {
                rest.partition_point(|o| o.at_s < to)
            };
            firsts.push(first + inside);
            let (mut squares, mut products) = ([[0.0; BAND]; BAND], [0.0; BAND]);
            for o in rest.get(..inside)? {
                let values = basis((o.at_s - from) / length, length);
                let weight = weight(o);
                for ((row, product), a) in squares.iter_mut().zip(&mut products).zip(values) {
                    *product += weight * a * o.angle_deg;
                    for (square, b) in row.iter_mut().zip(values) {
                        *square += weight * a * b;
                    }
                }
            }
            for (i, product) in index.iter().zip(products) {
                *right.get_mut(*i)? += product;
            }
            normal.add_block(index, &squares)?;
            // Bending energy of the cubic.
            for bend in [
                [0.0, -1.0, 0.0, 1.0].map(|b| b * length),
                [2.0, length, -2.0, length],
            ] {
                let square = bend.map(|a| bend.map(|b| stiffness * a * b));
                normal.add_block(index, &square)?;
            }
        }
        let factor = normal.factor()?;
        let coefficients = factor.solve(right)?;
        let mut spline = Self {
            knots,
            coefficients,
            factor,
            residuals: Vec::with_capacity(observed.len()),
            firsts,
            indices,
        };
        for k in 0..spline.knots.len() - 1 {
            let (from, length) = spline.interval(k)?;
            let around = spline.around(k)?;
            let inside = observed.get(*spline.firsts.get(k)?..*spline.firsts.get(k + 1)?)?;
            for o in inside {
                let values = basis((o.at_s - from) / length, length);
                let angle: f64 = around.iter().zip(values).map(|(c, b)| c * b).sum();
                spline.residuals.push((o.angle_deg - angle) / o.sd_deg);
            }
        }
        Some(spline)
    }

    fn interval(&self, k: usize) -> Option<(f64, f64)> {
        let (from, to) = (self.knots.get(k)?, self.knots.get(k + 1)?);
        Some((from.at_s, to.at_s - from.at_s))
    }

    /// Angle and speed at both ends of interval `k`.
    fn around(&self, k: usize) -> Option<[f64; BAND]> {
        let mut around = [0.0; BAND];
        for (value, index) in around.iter_mut().zip(self.indices.get(k)?) {
            *value = *self.coefficients.get(*index)?;
        }
        Some(around)
    }

    /// The knots, and the middles of intervals whose residuals are not random.
    fn finer_knots(&self, observed: &[Observed]) -> Vec<Knot> {
        let scale = scale(&self.residuals);
        let chance = 2.0 * (self.residuals.len() as f64).ln() + MIN_EXCESS;
        let limit = chance * scale * scale;
        let mut finer = Vec::with_capacity(self.knots.len());
        for (k, pair) in self.knots.windows(2).enumerate() {
            let &[from, to] = pair else { continue };
            finer.push(from);
            let (from, to) = (from.at_s, to.at_s);
            let samples = self.firsts.get(k).zip(self.firsts.get(k + 1));
            let Some((&first, &last)) = samples else {
                continue;
            };
            let (Some(times), Some(residuals)) =
                (observed.get(first..last), self.residuals.get(first..last))
            else {
                continue;
            };
            let middle = 0.5 * (from + to);
            let half = times.partition_point(|o| o.at_s < middle);
            let is_divisible = half >= MIN_SAMPLES && times.len() - half >= MIN_SAMPLES;
            if is_divisible && greatest_window(residuals) > limit {
                finer.push(Knot {
                    at_s: middle,
                    is_kink: false,
                });
            }
        }
        finer.extend(self.knots.last());
        finer
    }

    fn pieces(&self, origin: Stamp<Host>) -> Option<PiecewiseCubic> {
        let at = |s: f64| origin.saturating_add(Span::from_secs_f64(s));
        let intervals = self.knots.len() - 1;
        let pieces = (0..intervals).map(|k| {
            let (from_s, length) = self.interval(k)?;
            let (from, to) = (at(from_s), at(from_s + length));
            let [a, va, b, vb] = self.around(k)?;
            let ns = to.saturating_since(from).as_nanos().max(1) as f64;
            let inside = self
                .residuals
                .get(*self.firsts.get(k)?..*self.firsts.get(k + 1)?)?;
            let square: f64 = inside.iter().map(|r| r * r).sum();
            let freedom = (inside.len() as f64 - 2.0).max(1.0);
            let sd = (self.variance(k, length)? * (square / freedom).max(1.0)).sqrt();
            Some(CubicPiece::hermite(from, ns, [a, va * 1e-9], [b, vb * 1e-9]).with_sd(sd))
        });
        PiecewiseCubic::new(
            pieces.collect::<Option<Vec<_>>>()?,
            at(self.knots.last()?.at_s),
        )
    }

    /// Variance in the middle of interval `k` if the samples' errors are as assumed.
    fn variance(&self, k: usize, length: f64) -> Option<f64> {
        // The inverse of such a band matrix decays by about a half per interval.
        const REACH: usize = 24;
        let index = *self.indices.get(k)?;
        let first = index[0];
        let (low, high) = (
            first.saturating_sub(REACH),
            (first + BAND + REACH).min(self.coefficients.len()),
        );
        let mut right = vec![0.0; high - low];
        let middle = basis(0.5, length);
        for (i, b) in index.into_iter().zip(middle) {
            *right.get_mut(i - low)? = b;
        }
        let solved = self.factor.solve_within(low, right)?;
        let mut variance = 0.0;
        for (i, b) in index.into_iter().zip(middle) {
            variance += solved.get(i - low)? * b;
        }
        Some(variance.max(0.0))
    }
}

/// Standard deviation of `residuals` by the differences of neighbours, which a slow change does
/// not affect.
fn scale(residuals: &[f64]) -> f64 {
    let mut differences: Vec<f64> = residuals
        .windows(2)
        .map(|pair| match pair {
            [a, b] => (b - a).abs(),
            _ => 0.0,
        })
        .collect();
    let count = differences.len();
    if count == 0 {
        return 1.0;
    }
    let mut by_quantile = |part: usize, normal: f64| {
        let rank = count * part / 10;
        *differences.select_nth_unstable_by(rank, f64::total_cmp).1 / normal
    };
    // Errors with long tails have a small median.
    let (median, tail) = (
        by_quantile(5, MEDIAN_DIFFERENCE),
        by_quantile(9, TAIL_DIFFERENCE),
    );
    median.max(tail).max(MIN_SCALE)
}

/// Greatest square of a sum over a window of residuals, per residual. Windows have 2, 4, 8 ...
/// residuals and overlap by half.
fn greatest_window(residuals: &[f64]) -> f64 {
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    for residual in residuals {
        sum += residual;
        sums.push(sum);
    }
    let mut greatest = 0.0;
    let mut size = 2;
    while size <= residuals.len() {
        let ends = sums.iter().zip(sums.iter().skip(size)).step_by(size / 2);
        let squares = ends.map(|(a, b)| (b - a) * (b - a) / size as f64);
        greatest = squares.fold(greatest, f64::max);
        size *= 2;
    }
    greatest
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

    /// Cross-validation takes the parameters for the trace of the hat matrix: how much each fitted
    /// angle follows its own sample, over all samples.
    #[test]
    fn parameters_are_the_trace_of_the_hat_matrix() {
        let motion = |t: f64| (8.0 * t).sin();
        // Evenly, and with a gap of a third of the time.
        for is_used in [|_: f64| true, |t: f64| !(0.4..1.0).contains(&t)] {
            let mut samples = observed(120, 2.0, motion);
            samples.retain(|sample| is_used(sample.at_s));
            let knots = || {
                let all = [0.0, 0.25, 0.5, 1.0, 1.5, 2.0];
                let knot = |at_s| Knot {
                    at_s,
                    is_kink: at_s == 0.25,
                };
                all.map(knot).to_vec()
            };
            let before = Spline::fit(&samples, knots()).unwrap();
            let mut trace = 0.0;
            for i in 0..samples.len() {
                let (sd_deg, by) = (samples[i].sd_deg, 1e-3);
                samples[i].angle_deg += by;
                let after = Spline::fit(&samples, knots()).unwrap();
                samples[i].angle_deg -= by;
                let fitted = by - sd_deg * (after.residuals[i] - before.residuals[i]);
                trace += fitted / by;
            }
            let parameters = before.coefficients.len() as f64;
            assert!(
                (trace / parameters - 1.0).abs() < 1e-3,
                "{trace} of {parameters}"
            );
        }
    }

    #[test]
    fn a_cubic_is_recovered() {
        let motion = |t: f64| 1.0 - 3.0 * t + 2.0 * t * t - 0.7 * t * t * t;
        let fit = fit(
            &observed(200, 2.0, motion),
            Stamp::from_nanos(0),
            (0.0, 2.0),
            &[],
        )
        .unwrap();
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
            let fit = fit(&samples, Stamp::from_nanos(0), (0.0, 2.0), &[]).unwrap();
            let off = worst(&fit, 2.0, motion);
            assert!(off < 0.016, "{hertz} Hz: {off}");
            fit.parameters as f64
        };
        let (slow, quick) = (spacing(1.0), spacing(20.0));
        assert!(quick > 4.0 * slow, "{slow} {quick}");
    }

    #[test]
    fn a_gap_in_the_samples_is_bridged() {
        let mut samples = observed(400, 2.0, |t| 5.0 * t);
        samples.retain(|o| !(0.9..1.2).contains(&o.at_s));
        let fit = fit(&samples, Stamp::from_nanos(0), (0.0, 2.0), &[]).unwrap();
        assert!(worst(&fit, 2.0, |t| 5.0 * t) < 1e-3);
    }

    /// A head that stops at once, and goes on later.
    #[test]
    fn a_kink_keeps_the_speeds_on_both_sides() {
        let stops = |t: f64| 50.0 * (t.min(0.7031) + (t - 1.2047).max(0.0));
        let observed = observed(400, 2.0, stops);
        let kinks_s = super::super::kinks::find(&observed);
        let [a, b] = kinks_s[..] else {
            panic!("{kinks_s:?}");
        };
        assert!((a - 0.7031).abs() < 1e-3 && (b - 1.2047).abs() < 1e-3);
        let by = |kinks_s: &[f64]| {
            let fit = fit(&observed, Stamp::from_nanos(0), (0.0, 2.0), kinks_s).unwrap();
            (worst(&fit, 2.0, stops), fit.parameters)
        };
        let (smooth, broken) = (by(&[]), by(&kinks_s));
        assert!(broken.0 < 1e-3 && smooth.0 > 0.02, "{broken:?} {smooth:?}");
        assert!(broken.1 < 12, "{broken:?}");
        // A ramp is no kink.
        let ramp =
            |t: f64| 500.0 * (t.clamp(0.5, 0.6) - 0.5).powi(2) / 2.0 + 50.0 * (t - 0.6).max(0.0);
        let found = super::super::kinks::find(&super::tests::observed(800, 2.0, ramp));
        assert!(found.is_empty(), "{found:?}");
    }

    #[test]
    fn too_few_samples_give_no_spline() {
        assert!(
            fit(
                &observed(3, 1.0, |t| t),
                Stamp::from_nanos(0),
                (0.0, 1.0),
                &[]
            )
            .is_none()
        );
        assert!(
            fit(
                &observed(9, 1.0, |t| t),
                Stamp::from_nanos(0),
                (1.0, 1.0),
                &[]
            )
            .is_none()
        );
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
