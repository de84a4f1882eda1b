//! The estimator's step against dense normal equations with numeric derivatives.
//!
//! Nothing of the estimator is used below but its inputs (shots, frames, coefficients): points by
//! rotations of single vectors, beams that meet elements by bisection, derivatives by differences,
//! all coefficients as unknowns, elimination by Gauss.

use std::f64::consts::PI;

use cloud::mount::Mount;

use crate::equations::{Equations, ShotWeights};
use crate::estimate::{CalibrationRequest, Estimator};
use crate::model::ScannerModel;
use crate::patches::{Patches, SurfacePatch, Weigh};
use crate::shots::{NominalLaser, RangeShot, Scan};
use crate::surface::{COEFFICIENTS, Frame, Incidence};
use crate::tests::{draws, fixed};

/// Parameters in the order of the names that the estimator reports.
pub(crate) struct Oracle {
    pub lasers: Vec<NominalLaser>,
    pub rotation_y: f64,
    pub position_y: f64,
}

fn about_x([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    [
        x,
        y * angle.cos() - z * angle.sin(),
        y * angle.sin() + z * angle.cos(),
    ]
}

fn about_y([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    [
        x * angle.cos() + z * angle.sin(),
        y,
        z * angle.cos() - x * angle.sin(),
    ]
}

fn about_z([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    [
        x * angle.cos() - y * angle.sin(),
        x * angle.sin() + y * angle.cos(),
        z,
    ]
}

impl Oracle {
    /// Point of a beam at `range_m`, after the laser's correction, in log `log` of several.
    pub fn point(&self, p: &[f64], shot: &RangeShot, log: usize, range_m: f64) -> [f64; 3] {
        let (laser, count) = (usize::from(shot.laser), self.lasers.len());
        let table = &self.lasers[laser];
        let elevation = table.elevation_deg * PI / 180.0 + p[9 + count + laser];
        let azimuth = shot.azimuth[0].atan2(shot.azimuth[1]) + p[9 + 2 * count + laser];
        // Clockwise from y.
        let mut v = about_z(about_x([0.0, range_m, 0.0], elevation), -azimuth);
        v[2] += table.vertical_offset_m;
        v = about_z(about_y(about_x(v, p[0]), self.rotation_y), p[1]);
        v = [v[0] + p[2], v[1] + self.position_y, v[2] + p[3]];
        let side = if shot.rate_rad_s > 0.0 { 0.5 } else { -0.5 };
        let g = shot.tilt_rad;
        let tilt = g * (1.0 + p[5])
            + shot.rate_rad_s * p[4]
            + p[6] * (120.0 * g).sin()
            + p[7] * (120.0 * g).cos()
            + side * p[8];
        v = about_y(v, tilt);
        let d = &p[9 + 3 * count + 6 * log..][..6];
        let cross = [
            d[4] * v[2] - d[5] * v[1],
            d[5] * v[0] - d[3] * v[2],
            d[3] * v[1] - d[4] * v[0],
        ];
        [0, 1, 2].map(|i| v[i] + shot.time_s * (d[i] + cross[i]))
    }

    /// Distance along the beam from where it meets an element to its measured end.
    fn residual(&self, p: &[f64], shot: &RangeShot, log: usize, frame: &Frame, c: &[f64]) -> f64 {
        let measured = shot.range_m + p[9 + usize::from(shot.laser)];
        let height = |range_m: f64| {
            let end = self.point(p, shot, log, range_m);
            let d = [0, 1, 2].map(|i| end[i] - frame.centre[i]);
            let along = |axis: [f64; 3]| (0..3).map(|i| axis[i] * d[i]).sum::<f64>();
            let s = along(frame.along[0]) / frame.half_m;
            let t = along(frame.along[1]) / frame.half_m;
            let bent = c[0] + c[1] * s + c[2] * t + c[3] * s * s + c[4] * s * t + c[5] * t * t;
            along(frame.normal) - bent
        };
        let (mut low, mut high) = (measured - 0.5, measured + 0.5);
        let rises = height(high) > height(low);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match (height(middle) > 0.0) == rises {
                true => high = middle,
                false => low = middle,
            }
        }
        measured - 0.5 * (low + high)
    }
}

/// Solves A x = b by Gauss's elimination with pivots.
fn gauss(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))
            .unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            let pivot = a[k].clone();
            let entries = a[i].iter_mut().zip(&pivot).skip(k);
            entries.for_each(|(entry, pivot)| *entry -= factor * pivot);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k][k];
    }
    b
}

/// Two logs of eight elements each, with shots of all lasers.
fn scene() -> (Vec<Scan>, Vec<Vec<Vec<u32>>>) {
    let mut random = draws(11);
    let mut scans = Vec::new();
    let mut members = Vec::new();
    for log in 0..2 {
        let (mut shots, mut of_log) = (Vec::new(), Vec::new());
        for element in 0..8 {
            let (azimuth, tilt) = (f64::from(element) * 0.8 + 0.1, 0.6 * random());
            let (range_m, slope) = (5.0 + f64::from(element), [0.5 * random(), 0.5 * random()]);
            let mut mine = Vec::new();
            for number in 0..64_u32 {
                let (a, g) = (0.02 * random(), 0.02 * random());
                let laser = (number % 16) as u8;
                let elevation = (-15.0 + 2.0 * f64::from(laser)) * PI / 180.0;
                let sin_cos = (azimuth + a).sin_cos();
                mine.push(shots.len() as u32);
                shots.push(RangeShot {
                    range_m: range_m * (1.0 + slope[0] * a + slope[1] * g) + 0.005 * random(),
                    azimuth: [sin_cos.0, sin_cos.1],
                    // Lasers meet the element one after another.
                    tilt_rad: tilt + g + elevation * (azimuth.sin()),
                    rate_rad_s: if number % 2 == 0 { 0.9 } else { -0.4 },
                    time_s: random() + f64::from(log),
                    laser,
                    ..RangeShot::default()
                });
            }
            of_log.push(mine);
        }
        scans.push(Scan { shots });
        members.push(of_log);
    }
    (scans, members)
}

#[test]
fn a_step_is_that_of_dense_equations_with_numeric_derivatives() {
    let (scans, members) = scene();
    let fixed = fixed(0.01, 0.002);
    let start = Mount::at([0.004, 0.002, 0.06], [0.5, 0.01_f64.to_degrees(), -0.7]);
    let names = ["scale".to_owned()];
    let request = CalibrationRequest {
        scans: &scans,
        lasers: &fixed.lasers,
        start,
        gear: 120.0,
        fixed: &names,
    };
    let estimator = Estimator::new(&request);
    let layout = &estimator.layout;
    let mut random = draws(5);
    let mut values = estimator.start.clone();
    for (value, parameter) in values.iter_mut().zip(layout.parameters()) {
        if parameter.name != "scale" {
            *value += 0.02 * parameter.prior_sd * random();
        }
    }
    let noise_m = vec![0.01; 16];
    let weigh: Vec<_> = scans
        .iter()
        .map(|scan| ShotWeights::new(scan, &noise_m))
        .collect();
    let model = ScannerModel::new(layout, &fixed, &values);
    let mut patches = Patches {
        list: Vec::new(),
        scale: 30.0,
    };
    let mut coefficients = Vec::new();
    let mut weights = Vec::new();
    for (log, elements) in members.iter().enumerate() {
        for shots in elements {
            let ray = |&shot: &u32| model.ray(&scans[log].shots[shot as usize], log);
            let frame = Frame::of(shots.iter().map(|shot| ray(shot).end), 0.25).unwrap();
            let weight = |shot: &u32| weigh[log].weight(*shot as usize, &ray(shot), frame.normal);
            let incidences: Vec<Incidence> = shots
                .iter()
                .map(|shot| frame.incidence(&ray(shot), weight(shot)))
                .collect();
            let fit = frame.fit(&incidences, [0.0; COEFFICIENTS], 120.0).unwrap();
            // The equations begin with these, too.
            let again = frame.fit(&incidences, fit.coefficients, 120.0).unwrap();
            coefficients.extend(again.coefficients);
            weights.extend(shots.iter().map(weight));
            patches.list.push(SurfacePatch {
                log,
                frame,
                coefficients: fit.coefficients,
                shots: shots.clone(),
            });
        }
    }
    let equations = Equations::new(&scans, &patches, layout, &model, &weigh);
    assert_eq!((equations.patches, equations.shots), (16, 1024));
    let step = estimator
        .step(&equations, &values, &estimator.priors)
        .unwrap()
        .step;

    let oracle = Oracle {
        lasers: fixed.lasers.clone(),
        rotation_y: 0.01,
        position_y: 0.002,
    };
    let free: Vec<usize> = (0..values.len()).filter(|&i| i != 5).collect();
    let mut unknowns: Vec<f64> = free.iter().map(|&i| values[i]).collect();
    unknowns.extend(&coefficients);
    let residuals = |unknowns: &[f64]| {
        let mut p = values.clone();
        free.iter()
            .zip(unknowns)
            .for_each(|(&i, value)| p[i] = *value);
        let c = &unknowns[free.len()..];
        let mut all = Vec::new();
        for (patch, c) in patches.list.iter().zip(c.chunks(6)) {
            all.extend(patch.shots.iter().map(|&shot| {
                let shot = &scans[patch.log].shots[shot as usize];
                oracle.residual(&p, shot, patch.log, &patch.frame, c)
            }));
        }
        all
    };
    let r = residuals(&unknowns);
    let n = unknowns.len();
    let columns: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let moved = |by: f64| {
                let mut unknowns = unknowns.clone();
                unknowns[i] += by;
                residuals(&unknowns)
            };
            let (low, high) = (moved(-1e-5), moved(1e-5));
            low.iter()
                .zip(&high)
                .map(|(low, high)| (high - low) / 2e-5)
                .collect()
        })
        .collect();
    let parameters = layout.parameters();
    let mut a = vec![vec![0.0; n]; n];
    let mut b = vec![0.0; n];
    for i in 0..n {
        let weighted = |other: &[f64]| -> f64 {
            let products = columns[i].iter().zip(other).zip(&weights);
            products.map(|((x, y), w)| x * y * w).sum()
        };
        for j in 0..n {
            a[i][j] = weighted(&columns[j]);
        }
        let (sd, off) = match free.get(i) {
            Some(&i) => (parameters[i].prior_sd, values[i] - estimator.start[i]),
            None if (i - free.len()) % 6 < 3 => (10.0, unknowns[i]),
            None => (0.02, unknowns[i]),
        };
        a[i][i] += 1.0 / (sd * sd);
        b[i] = -weighted(&r) - off / (sd * sd);
    }
    // The mean of the azimuths is 0.
    let is_azimuth = |i: usize| free.get(i).is_some_and(|i| (41..57).contains(i));
    let mean: f64 = values[41..57].iter().sum();
    for i in (0..n).filter(|&i| is_azimuth(i)) {
        for j in (0..n).filter(|&j| is_azimuth(j)) {
            a[i][j] += 1e18 / 256.0;
        }
        b[i] -= mean * 1e18 / 256.0;
    }
    let dense = gauss(a, b);
    for (&index, expected) in free.iter().zip(&dense) {
        let off = (step[index] - expected).abs();
        let name = &parameters[index].name;
        assert!(
            off < 2e-3 * parameters[index].prior_sd,
            "{name}: {} {expected}",
            step[index]
        );
    }
    assert_eq!(step[5], 0.0);
    let largest = free
        .iter()
        .map(|&i| (step[i] / parameters[i].prior_sd).abs());
    assert!(
        largest.fold(0.0, f64::max) > 0.1,
        "the step is too small to compare"
    );
}
