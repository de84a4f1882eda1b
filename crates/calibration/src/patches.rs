//! Voxels of shots, and the surface elements in them.

use crate::linear::{Vec3, apply};
use crate::model::{ScannerModel, ShotRay};
use crate::shots::{RangeShot, Scan, noise_m};
use crate::surface::{COEFFICIENTS, Coefficients, Fit, Frame, Incidence, MIN_SHOTS};

/// Width of the voxels, metres. One that holds more than a smooth surface is divided once.
const VOXEL_M: f64 = 0.5;
/// Voxels on either side of the origin, along each axis.
const HALF_GRID: f64 = (1_u64 << 19) as f64;

/// Inverse variance of a shot's range: noise, and azimuth and tilt by the slope of the surface.
pub(crate) trait Weigh {
    fn weight(&self, shot: usize, ray: &ShotRay, normal: Vec3) -> f64;
}

/// A surface element and its shots.
#[derive(Clone, Debug)]
pub(crate) struct SurfacePatch {
    pub log: usize,
    pub frame: Frame,
    /// Coefficients of the fit to all shots of its voxel.
    pub coefficients: Coefficients,
    /// Indices of its shots.
    pub shots: Vec<u32>,
}

/// The elements of all logs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Patches {
    pub list: Vec<SurfacePatch>,
    /// Typical residual of a shot in standard deviations; 1 once the parameters fit.
    pub scale: f64,
}

/// Rows of a rotation without special directions, so that no face of a voxel is parallel to a wall.
const GRID: [Vec3; 3] = [
    [0.809634152, -0.050995896, 0.584715280],
    [0.230163753, 0.944010045, -0.236367685],
    [-0.539923316, 0.325951613, 0.776040178],
];
/// Distance from the faces of a voxel, in standard deviations along the beam, within which noise
/// chooses the voxel.
const MARGIN_SD: f64 = 3.0;
/// Greatest chi2 of an element, for infinitely many shots.
const MAX_CHI2: f64 = 1.5;
/// The parameters fit if residuals exceed their standard deviations by less.
pub(crate) const SETTLED_SCALE: f64 = 1.15;

/// Greatest chi2 of an element with this many shots: 1.5, or four standard deviations above 1.
fn max_chi2(used: usize, scale: f64) -> f64 {
    let freedom = used.saturating_sub(6).max(1) as f64;
    if scale > 1.0 {
        return 4.0 * scale * scale;
    }
    MAX_CHI2.max(1.0 + 4.0 * (2.0 / freedom).sqrt())
}

/// A voxel before its surface is judged.
struct VoxelShots {
    log: usize,
    cell: [f64; 3],
    width_m: f64,
    shots: Vec<u32>,
}

impl Patches {
    /// The elements of these scans under a model.
    pub fn new(scans: &[Scan], model: &ScannerModel<'_>, weigh: &[impl Weigh]) -> Self {
        let mut candidates = Vec::new();
        let mut rays = Vec::new();
        for (log, scan) in scans.iter().enumerate() {
            let ends: Vec<ShotRay> = scan.shots.iter().map(|shot| model.ray(shot, log)).collect();
            let all: Vec<u32> = (0..scan.shots.len() as u32).collect();
            candidates.extend(voxels(log, &all, &ends, VOXEL_M));
            rays.push(ends);
        }
        let mut fits: Vec<Option<(Frame, Fit)>> = Vec::with_capacity(candidates.len());
        for candidate in &candidates {
            fits.push(candidate.fit(&rays[candidate.log], &weigh[candidate.log]));
        }
        let mut spread: Vec<f64> = fits.iter().flatten().map(|(_, fit)| fit.chi2()).collect();
        let middle = spread.len() / 2;
        let scale = match spread.is_empty() {
            true => 1.0,
            false => {
                let (_, median, _) = spread.select_nth_unstable_by(middle, f64::total_cmp);
                median.sqrt()
            }
        };
        let scale = if scale < SETTLED_SCALE { 1.0 } else { scale };
        let mut list = Vec::new();
        for (candidate, fit) in candidates.into_iter().zip(fits) {
            let (log, ends) = (candidate.log, &rays[candidate.log]);
            let shots = &scans[log].shots;
            if let Some((frame, fit)) = fit
                && fit.chi2() <= max_chi2(fit.used, scale)
            {
                list.extend(candidate.patch(frame, &fit, scale, ends, shots, &weigh[log]));
                continue;
            }
            for part in voxels(log, &candidate.shots, ends, VOXEL_M / 2.0) {
                if let Some((frame, fit)) = part.fit(ends, &weigh[log])
                    && fit.chi2() <= max_chi2(fit.used, scale)
                {
                    list.extend(part.patch(frame, &fit, scale, ends, shots, &weigh[log]));
                }
            }
        }
        Self { list, scale }
    }
}

impl Patches {
    /// Range noise of each laser by neighbouring shots of one element.
    pub fn noise_m(&self, scans: &[Scan], default_m: &[f64]) -> Vec<f64> {
        let mut surfaces: Vec<Vec<Option<u32>>> = Vec::with_capacity(scans.len());
        surfaces.extend(scans.iter().map(|scan| vec![None; scan.shots.len()]));
        for (patch, number) in self.list.iter().zip(0..) {
            for &shot in &patch.shots {
                surfaces[patch.log][shot as usize] = Some(number);
            }
        }
        let surface = |log: usize, shot: usize| surfaces[log][shot];
        noise_m(scans, default_m.len(), surface, |laser| default_m[laser])
    }
}

/// Shots by voxel, in the order of the voxels.
fn voxels(log: usize, shots: &[u32], rays: &[ShotRay], width_m: f64) -> Vec<VoxelShots> {
    let cell = |shot: u32| {
        let end = apply(&GRID, rays[shot as usize].end);
        end.map(|part| (part / width_m).floor().clamp(-HALF_GRID, HALF_GRID))
    };
    let mut keyed: Vec<(u64, u32)> = shots
        .iter()
        .map(|&shot| {
            let key = cell(shot).map(|part| (part + HALF_GRID) as u64);
            (key[0] << 42 | key[1] << 21 | key[2], shot)
        })
        .collect();
    keyed.sort_unstable();
    let groups = keyed.chunk_by(|a, b| a.0 == b.0);
    let groups = groups.filter(|group| group.len() >= MIN_SHOTS);
    let candidate = |group: &[(u64, u32)]| VoxelShots {
        log,
        cell: cell(group[0].1),
        width_m,
        shots: group.iter().map(|(_, shot)| *shot).collect(),
    };
    groups.map(candidate).collect()
}

impl VoxelShots {
    fn fit(&self, rays: &[ShotRay], weigh: &impl Weigh) -> Option<(Frame, Fit)> {
        let ends = self.shots.iter().map(|&shot| rays[shot as usize].end);
        let frame = Frame::of(ends, self.width_m / 2.0)?;
        let incidences = self.incidences(&frame, rays, weigh);
        let fit = frame.fit(&incidences, [0.0; COEFFICIENTS], 1e3)?;
        Some((frame, fit))
    }

    fn incidences(&self, frame: &Frame, rays: &[ShotRay], weigh: &impl Weigh) -> Vec<Incidence> {
        let incidence = |&shot: &u32| {
            let ray = &rays[shot as usize];
            let weight = weigh.weight(shot as usize, ray, frame.normal);
            frame.incidence(ray, weight)
        };
        self.shots.iter().map(incidence).collect()
    }

    /// The element, without shots so near a face of the voxel that their noise chose the voxel:
    /// these would bend the element towards themselves.
    fn patch(
        self,
        frame: Frame,
        fit: &Fit,
        scale: f64,
        rays: &[ShotRay],
        all: &[RangeShot],
        weigh: &impl Weigh,
    ) -> Option<SurfacePatch> {
        let incidences = self.incidences(&frame, rays, weigh);
        let inside = |(&shot, incidence): (&u32, &Incidence)| {
            if scale > 1.0 {
                return Some(shot);
            }
            let ray = &rays[shot as usize];
            let off = frame.residual(&fit.coefficients, incidence).range_m;
            let margin = MARGIN_SD / incidence.weight().sqrt();
            let (end, direction) = (apply(&GRID, ray.end), apply(&GRID, ray.direction));
            let is_inside = (0..3).all(|axis| {
                let at = end[axis] - off * direction[axis];
                let from_face = at - self.cell[axis] * self.width_m;
                let margin = margin * direction[axis].abs();
                margin < from_face && from_face < self.width_m - margin
            });
            is_inside.then_some(shot)
        };
        let mut shots: Vec<u32> = self
            .shots
            .iter()
            .zip(&incidences)
            .filter_map(inside)
            .collect();
        // Shots of a laser follow each other, so that sums over them are made at once.
        shots.sort_by_key(|&shot| all[shot as usize].laser);
        (shots.len() >= MIN_SHOTS).then_some(SurfacePatch {
            log: self.log,
            frame,
            coefficients: fit.coefficients,
            shots,
        })
    }
}
