//! Small surface elements: a plane with a slight curvature through the shots of a voxel.
//!
//! Planes of 2 m and more are wrong on walls that are wavy by millimetres; elements of half a metre
//! with a quadratic part are not. Residuals are along the beam, r = (h - q(s, t)) / (n . D), as the
//! errors of ranges are.

use crate::linear::{Cholesky, Matrix, Vec3, add, axes, dot};
use crate::model::ShotRay;

/// Coefficients of an element: 1, s, t, s^2, s t, t^2.
pub(crate) const COEFFICIENTS: usize = 6;
pub(crate) type Coefficients = [f64; COEFFICIENTS];

/// Curvatures before the scan: 20 mm from the middle of an element to its edge.
const CURVATURE_SD_M: f64 = 0.02;
/// Planes before the scan: free.
const PLANE_SD_M: f64 = 10.0;
/// Beams at lower angles to an element do not count.
const MIN_COSINE: f64 = 0.08;
/// An element needs shots in two dimensions: least standard deviation across, of its half width.
const MIN_ACROSS: f64 = 0.15;
/// Most steps along the beam to an element, which is nearly a plane.
const NEWTON_STEPS: usize = 4;
/// A shorter step is the last: the next would be a hundredth of it, the slope of a curved element.
const EXACT_M: f64 = 1e-4;
/// A fit ends when its coefficients change by less. The step is taken; what is left is of second
/// order.
const FITTED_M: f64 = 5e-4;
/// Fewest shots of an element.
pub(crate) const MIN_SHOTS: usize = 12;

/// The frame of an element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub centre: Vec3,
    pub along: [Vec3; 2],
    pub normal: Vec3,
    /// Half of the voxel's width: the unit of s and t.
    pub half_m: f64,
}

/// A shot relative to an element.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Incidence {
    s: f64,
    t: f64,
    height: f64,
    direction: Vec3,
    /// Inverse variance of the range.
    weight: f64,
}

/// A fitted element.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub coefficients: Coefficients,
    /// Shots that count.
    pub used: usize,
    /// Sum of weighted squared residuals of these.
    pub squares: f64,
}

impl Fit {
    /// Squared residuals per degree of freedom.
    pub fn chi2(&self) -> f64 {
        self.squares / (self.used.saturating_sub(COEFFICIENTS)).max(1) as f64
    }
}

impl Frame {
    /// The frame of points in a voxel; `None` if they do not spread in two dimensions.
    pub fn of(points: impl Iterator<Item = Vec3> + Clone, half_m: f64) -> Option<Self> {
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for point in points.clone() {
            sum = add(sum, 1.0, point);
            count += 1.0;
        }
        let centre = sum.map(|sum: f64| sum / count);
        let mut moments = [[0.0; 3]; 3];
        for point in points {
            let d = add(point, -1.0, centre);
            for (row, di) in moments.iter_mut().zip(d) {
                *row = add(*row, di, d);
            }
        }
        let (values, [normal, minor, major]) = axes(moments);
        let across = (values[1] / count).max(0.0).sqrt();
        (count >= MIN_SHOTS as f64 && across > MIN_ACROSS * half_m).then_some(Self {
            centre,
            along: [major, minor],
            normal,
            half_m,
        })
    }

    /// A shot relative to the element, with the variance of its range.
    pub fn incidence(&self, ray: &ShotRay, weight: f64) -> Incidence {
        let d = add(ray.end, -1.0, self.centre);
        Incidence {
            s: dot(self.along[0], d) / self.half_m,
            t: dot(self.along[1], d) / self.half_m,
            height: dot(self.normal, d),
            direction: ray.direction,
            weight,
        }
    }

    /// The surface's normal (of length near 1) at a place.
    fn normal_at(&self, c: &Coefficients, s: f64, t: f64) -> Vec3 {
        let by_s = (c[1] + 2.0 * c[3] * s + c[4] * t) / self.half_m;
        let by_t = (c[2] + c[4] * s + 2.0 * c[5] * t) / self.half_m;
        add(add(self.normal, -by_s, self.along[0]), -by_t, self.along[1])
    }

    /// The residual of a shot's range, and the element where the beam meets it.
    ///
    /// The place is that of the beam, not of the measured end: its s and t would carry the noise of
    /// the range, which bends grazing elements.
    pub fn residual(&self, c: &Coefficients, shot: &Incidence) -> RangeResidual {
        let across = [0, 1].map(|axis| dot(self.along[axis], shot.direction) / self.half_m);
        let rise = dot(self.normal, shot.direction);
        let mut range_m = 0.0;
        let mut residual = RangeResidual::default();
        for _ in 0..NEWTON_STEPS {
            let (s, t) = (shot.s - range_m * across[0], shot.t - range_m * across[1]);
            let basis = basis(s, t);
            let normal = self.normal_at(c, s, t);
            let cosine = dot(normal, shot.direction);
            let surface: f64 = basis.iter().zip(c).map(|(b, c)| b * c).sum();
            let step = (shot.height - range_m * rise - surface) / cosine;
            range_m += step;
            residual = RangeResidual {
                range_m,
                normal,
                cosine,
                basis,
            };
            if step.abs() < EXACT_M {
                break;
            }
        }
        residual
    }

    /// Fits the coefficients to shots, from `start`. Those beyond `cut` standard deviations do not
    /// count.
    pub fn fit(&self, shots: &[Incidence], start: Coefficients, cut: f64) -> Option<Fit> {
        let mut c = start;
        let mut limit = f64::INFINITY;
        let mut fit = None;
        for _ in 0..3 {
            let mut normal = priors();
            let mut right = [0, 1, 2, 3, 4, 5].map(|i| -normal.at(i, i) * c[i]);
            let (mut used, mut squares, mut most) = (0, 0.0, 0.0_f64);
            for shot in shots {
                let residual = self.residual(&c, shot);
                if !residual.counts(shot, limit) {
                    continue;
                }
                let weight = shot.weight / residual.cosine;
                for (right, basis) in right.iter_mut().zip(residual.basis) {
                    *right += weight * residual.range_m * basis;
                }
                residual.add_to(&mut normal, shot);
                let square = shot.weight * residual.range_m * residual.range_m;
                used += 1;
                squares += square;
                most = most.max(square);
            }
            if used < MIN_SHOTS {
                return None;
            }
            let mut step = right;
            Cholesky::new(&normal)?.solve(&mut step);
            c = [0, 1, 2, 3, 4, 5].map(|i| c[i] + step[i]);
            let gain: f64 = right.iter().zip(&step).map(|(a, b)| a * b).sum();
            fit = Some(Fit {
                coefficients: c,
                used,
                squares: (squares - gain).max(0.0),
            });
            if most <= cut * cut && step.iter().all(|change| change.abs() < FITTED_M) {
                break;
            }
            // The first plane is bent by outliers, whose residuals it therefore understates.
            let spread = (squares / used as f64).sqrt();
            limit = if limit.is_infinite() {
                cut.max(2.5 * spread)
            } else {
                cut
            };
        }
        fit
    }
}

/// The residual of a shot.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RangeResidual {
    pub range_m: f64,
    pub normal: Vec3,
    pub cosine: f64,
    pub basis: Coefficients,
}

/// The normal equations of coefficients without a shot.
pub(crate) fn priors() -> Matrix {
    let mut normal = Matrix::zero(COEFFICIENTS);
    for index in 0..COEFFICIENTS {
        let sd = if index < 3 {
            PLANE_SD_M
        } else {
            CURVATURE_SD_M
        };
        *normal.at_mut(index, index) = 1.0 / (sd * sd);
    }
    normal
}

impl RangeResidual {
    /// Adds a shot to the lower triangle of the normal equations of the coefficients.
    pub fn add_to(&self, normal: &mut Matrix, shot: &Incidence) {
        let weight = shot.weight / (self.cosine * self.cosine);
        for i in 0..COEFFICIENTS {
            let scaled = weight * self.basis[i];
            for j in 0..=i {
                normal.values[i * COEFFICIENTS + j] += scaled * self.basis[j];
            }
        }
    }

    /// Whether a shot counts: neither grazing nor farther off than `limit` standard deviations.
    pub fn counts(&self, shot: &Incidence, limit: f64) -> bool {
        self.cosine.abs() > MIN_COSINE && self.range_m * self.range_m * shot.weight <= limit * limit
    }
}

impl Incidence {
    pub const fn weight(&self) -> f64 {
        self.weight
    }
}

fn basis(s: f64, t: f64) -> Coefficients {
    [1.0, s, t, s * s, s * t, t * t]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::draws;

    /// Shots from the origin at a paraboloid, with one shot far off it.
    #[test]
    fn a_fit_finds_a_curved_surface_and_leaves_outliers_out() {
        let mut random = draws(3);
        let mut rays = Vec::new();
        for _ in 0..80 {
            let [x, z] = [0.2 * random(), 0.2 * random()];
            let end = [x, 5.0 + 0.01 * x * x / 0.0625 + 0.1 * z, z];
            let length = dot(end, end).sqrt();
            rays.push(ShotRay {
                end,
                direction: end.map(|part| part / length),
            });
        }
        rays[7].end = add(rays[7].end, 0.3, rays[7].direction);
        let frame = Frame::of(rays.iter().map(|ray| ray.end), 0.25).unwrap();
        let shots: Vec<_> = rays.iter().map(|ray| frame.incidence(ray, 1e6)).collect();
        let fit = frame.fit(&shots, [0.0; COEFFICIENTS], 4.0).unwrap();
        assert_eq!(fit.used, 79);
        assert!(fit.chi2() < 0.01, "{}", fit.chi2());
        let off = frame.residual(&fit.coefficients, &shots[7]).range_m;
        assert!((off - 0.3).abs() < 0.01, "{off}");
    }

    #[test]
    fn a_line_of_points_is_no_element() {
        let line = (0..100).map(|i| [f64::from(i) * 1e-3, 5.0, 0.0]);
        assert!(Frame::of(line, 0.25).is_none());
    }
}
