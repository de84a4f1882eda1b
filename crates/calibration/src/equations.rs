//! Normal equations of the parameters, the elements' coefficients eliminated (Schur).

use crate::linear::{Cholesky, Matrix, dot};
use crate::model::{COLUMNS, LASER, ScannerModel, ShotRay};
use crate::parameters::Layout;
use crate::patches::{Patches, SurfacePatch, Weigh};
use crate::shots::{AZIMUTH_SD_RAD, Scan, TILT_SD_RAD};
use crate::surface::{COEFFICIENTS, Incidence, RangeResidual, priors};

/// Residuals beyond this many standard deviations do not count.
pub(crate) const CUT_SD: f64 = 4.0;

/// Variances of the shots of a log.
#[derive(Debug)]
pub(crate) struct ShotWeights<'a> {
    scan: &'a Scan,
    noise_m: &'a [f64],
}

impl<'a> ShotWeights<'a> {
    pub const fn new(scan: &'a Scan, noise_m: &'a [f64]) -> Self {
        Self { scan, noise_m }
    }
}

impl Weigh for ShotWeights<'_> {
    fn weight(&self, shot: usize, ray: &ShotRay, normal: [f64; 3]) -> f64 {
        let shot = &self.scan.shots[shot];
        let noise = self.noise_m[usize::from(shot.laser)];
        // The range to the surface per metre across the beam.
        let cosine = dot(normal, ray.direction).clamp(-1.0, 1.0);
        let slope2 = ((1.0 - cosine * cosine) / (cosine * cosine)).min(200.0);
        let angle2 = AZIMUTH_SD_RAD * AZIMUTH_SD_RAD + TILT_SD_RAD * TILT_SD_RAD;
        let across2 = 0.5 * slope2 * shot.range_m * shot.range_m * angle2;
        1.0 / (noise * noise + across2)
    }
}

/// Residuals of a laser or of all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Residuals {
    pub shots: u64,
    /// Sum of residuals, metres.
    pub sum_m: f64,
    /// Sum of squared residuals, square metres.
    pub squares_m2: f64,
}

/// The equations `hessian delta = -gradient`, without priors.
#[derive(Clone, Debug)]
pub(crate) struct Equations {
    pub hessian: Matrix,
    pub gradient: Vec<f64>,
    /// Sum over the elements of the products of their gradients: how much these really vary.
    pub scatter: Matrix,
    /// Weighted squared residuals and their degrees of freedom.
    pub squares: f64,
    pub freedom: f64,
    /// Elements and shots that count.
    pub patches: usize,
    pub shots: usize,
    pub lasers: Vec<Residuals>,
    /// Root mean square of each element's residuals, metres.
    pub patch_rms_m: Vec<f64>,
}

/// Sums over an element's shots of one laser, which share their columns.
#[derive(Clone)]
struct LaserSums {
    laser: usize,
    hessian: [[f64; COLUMNS]; COLUMNS],
    mixed: [[f64; COLUMNS]; COEFFICIENTS],
    gradient: [f64; COLUMNS],
}

impl LaserSums {
    const fn new(laser: usize) -> Self {
        Self {
            laser,
            hessian: [[0.0; COLUMNS]; COLUMNS],
            mixed: [[0.0; COLUMNS]; COEFFICIENTS],
            gradient: [0.0; COLUMNS],
        }
    }

    /// Adds a shot: derivatives of its residual, weight.
    fn add(&mut self, row: &[f64; COLUMNS], residual: &RangeResidual, weight: f64) {
        let by_range = weight * residual.range_m;
        let by_cosine = weight / residual.cosine;
        for (column, (&value, sums)) in row.iter().zip(&mut self.hessian).enumerate() {
            let scaled = weight * value;
            // A constant length for all rows: the compiler's vectors.
            let half = &mut sums[..if column < COLUMNS / 2 {
                COLUMNS / 2
            } else {
                COLUMNS
            }];
            for (sum, other) in half.iter_mut().zip(row) {
                *sum += scaled * other;
            }
        }
        for (sum, value) in self.gradient.iter_mut().zip(row) {
            *sum += by_range * value;
        }
        for (sums, basis) in self.mixed.iter_mut().zip(residual.basis) {
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum -= by_cosine * basis * value;
            }
        }
    }
}

/// Rows of one element, reused.
struct Workspace {
    /// Coefficients against all parameters.
    mixed: Vec<f64>,
    gradient: Vec<f64>,
    touched: Vec<bool>,
}

impl Equations {
    /// The equations of these elements at the values of `model`.
    pub fn new(
        scans: &[Scan],
        patches: &Patches,
        layout: &Layout,
        model: &ScannerModel<'_>,
        weigh: &[ShotWeights<'_>],
    ) -> Self {
        let size = layout.len();
        let mut equations = Self {
            hessian: Matrix::zero(size),
            gradient: vec![0.0; size],
            scatter: Matrix::zero(size),
            squares: 0.0,
            freedom: 0.0,
            patches: 0,
            shots: 0,
            lasers: vec![Residuals::default(); layout.lasers],
            patch_rms_m: Vec::with_capacity(patches.list.len()),
        };
        let mut work = Workspace {
            mixed: vec![0.0; COEFFICIENTS * size],
            gradient: vec![0.0; size],
            touched: vec![false; size],
        };
        let mut incidences = Vec::new();
        for patch in &patches.list {
            let scan = &scans[patch.log];
            equations.add(
                scan,
                patch,
                patches.scale,
                layout,
                model,
                &weigh[patch.log],
                &mut incidences,
                &mut work,
            );
        }
        equations.hessian.mirror();
        equations.scatter.mirror();
        equations
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one element in the frame of its loop"
    )]
    fn add(
        &mut self,
        scan: &Scan,
        patch: &SurfacePatch,
        scale: f64,
        layout: &Layout,
        model: &ScannerModel<'_>,
        weigh: &ShotWeights<'_>,
        incidences: &mut Vec<Incidence>,
        work: &mut Workspace,
    ) {
        let size = layout.len();
        let frame = &patch.frame;
        incidences.clear();
        incidences.extend(patch.shots.iter().map(|&index| {
            let ray = model.ray(&scan.shots[index as usize], patch.log);
            let weight = weigh.weight(index as usize, &ray, frame.normal);
            frame.incidence(&ray, weight)
        }));
        let cut = CUT_SD * scale;
        let Some(fit) = frame.fit(incidences, patch.coefficients, cut) else {
            return;
        };
        work.mixed.fill(0.0);
        work.gradient.fill(0.0);
        work.touched.fill(false);
        // Of the same shots and slopes as all other products: else the equations may turn negative.
        let mut own = priors();
        let (mut squares_m2, mut used) = (0.0, 0.0);
        let mut sums = LaserSums::new(0);
        let mut own_gradient = [0, 1, 2, 3, 4, 5].map(|i| own.at(i, i) * fit.coefficients[i]);
        for (&index, incidence) in patch.shots.iter().zip(&*incidences) {
            let residual = frame.residual(&fit.coefficients, incidence);
            if !residual.counts(incidence, cut) {
                continue;
            }
            // Where the beam meets the element: slopes at the measured end would carry its noise.
            let mut shot = scan.shots[index as usize];
            shot.range_m -= residual.range_m;
            let laser = usize::from(shot.laser);
            let (_, slopes) = model.ray_and_slopes(&shot, patch.log);
            let mut row = [0.0; COLUMNS];
            for (column, (value, slope)) in row.iter_mut().zip(slopes).enumerate() {
                *value = match column {
                    LASER => 1.0,
                    _ => dot(residual.normal, slope) / residual.cosine,
                };
            }
            residual.add_to(&mut own, incidence);
            let weight = incidence.weight();
            for (gradient, basis) in own_gradient.iter_mut().zip(residual.basis) {
                *gradient -= weight * residual.range_m / residual.cosine * basis;
            }
            if sums.laser != laser {
                self.flush(&sums, layout, patch.log, work);
                sums = LaserSums::new(laser);
            }
            sums.add(&row, &residual, weight);
            self.squares += weight * residual.range_m * residual.range_m;
            self.shots += 1;
            let all = &mut self.lasers[laser];
            all.shots += 1;
            all.sum_m += residual.range_m;
            all.squares_m2 += residual.range_m * residual.range_m;
            squares_m2 += residual.range_m * residual.range_m;
            used += 1.0;
        }
        self.flush(&sums, layout, patch.log, work);
        let Some(factor) = Cholesky::new(&own) else {
            return;
        };
        self.freedom += used - COEFFICIENTS as f64;
        self.patch_rms_m
            .push(f64::sqrt(squares_m2 / f64::max(used, 1.0)));
        self.patches += 1;
        let touched: Vec<usize> = (0..size).filter(|&place| work.touched[place]).collect();
        // L^-1 of the mixed block, column by column.
        let mut column = [0.0; COEFFICIENTS];
        let reduced: Vec<[f64; COEFFICIENTS]> = touched
            .iter()
            .map(|&place| {
                for (coefficient, value) in column.iter_mut().enumerate() {
                    *value = work.mixed[coefficient * size + place];
                }
                factor.forward(&mut column);
                column
            })
            .collect();
        // The coefficients are not quite at their best.
        factor.forward(&mut own_gradient);
        for (&place, reduced) in touched.iter().zip(&reduced) {
            let by_own: f64 = reduced.iter().zip(&own_gradient).map(|(a, b)| a * b).sum();
            work.gradient[place] -= by_own;
        }
        for (i, &row) in touched.iter().enumerate() {
            self.gradient[row] += work.gradient[row];
            for (j, &other) in touched.iter().enumerate().take(i + 1) {
                let product: f64 = reduced[i].iter().zip(&reduced[j]).map(|(a, b)| a * b).sum();
                self.hessian.values[row * size + other] -= product;
                self.scatter.values[row * size + other] +=
                    work.gradient[row] * work.gradient[other];
            }
        }
    }

    /// Adds the sums of a laser at the places of its columns.
    fn flush(&mut self, sums: &LaserSums, layout: &Layout, log: usize, work: &mut Workspace) {
        let size = layout.len();
        let mut places = [0; COLUMNS];
        for (column, place) in places.iter_mut().enumerate() {
            *place = ScannerModel::index(layout, column, sums.laser, log);
        }
        for (column, &place) in places.iter().enumerate() {
            work.touched[place] = true;
            work.gradient[place] += sums.gradient[column];
            for (coefficient, mixed) in sums.mixed.iter().enumerate() {
                work.mixed[coefficient * size + place] += mixed[column];
            }
            for (&sum, &other) in sums.hessian[column].iter().zip(&places[..=column]) {
                let (low, high) = (place.max(other), place.min(other));
                self.hessian.values[low * size + high] += sum;
            }
        }
    }
}
