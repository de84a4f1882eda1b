//! A beam's footprint by any number of sub-rays, one after the other: an independent version of
//! `sim::effect_models::Divergence`, without reflectivities, normals and the search for edges.

use glam::DVec3;
use sim::firing::{SimulatedFiring, SurfaceHit, Surroundings};

/// Half the divergence of the beam along the scan and across it (63-9243, appendix F).
const HALF: [f64; 2] = [1.5e-3, 0.75e-3];
/// Surfaces nearer to each other make one return, metres.
const SEPARATION_M: f64 = 1.0;
/// A return with less of the light is not detected.
const LEAST_SHARE: f64 = 0.05;
/// Tolerance of a plane, metres.
const FLAT_M: f64 = 0.002;

/// The patch that one laser illuminates.
pub struct ReferenceFootprint {
    from_m: DVec3,
    way: DVec3,
    along: DVec3,
    across: DVec3,
}

/// A sub-ray: its place in the patch, -1..=1 in both directions, and its hit.
struct ReferenceSample {
    x: f64,
    y: f64,
    met: Option<SurfaceHit>,
}

/// All sub-rays of a pulse.
pub struct Samples {
    footprint: ReferenceFootprint,
    samples: Vec<ReferenceSample>,
}

impl ReferenceFootprint {
    /// The footprint of a laser in a firing of a VLP-16. The scan runs across the fan between its
    /// lowest laser (0) and its highest (15).
    pub fn of(firing: &SimulatedFiring, laser: usize) -> Option<Self> {
        let (lowest, highest) = (firing.directions.first()?, firing.directions.get(15)?);
        let way = *firing.directions.get(laser)?;
        let scan = lowest.cross(*highest).normalize();
        let along = (scan - way * way.dot(scan)).normalize();
        Some(Self {
            from_m: *firing.origins_m.get(laser)?,
            way,
            along: HALF[0] * along,
            across: HALF[1] * along.cross(way),
        })
    }

    fn towards(&self, x: f64, y: f64) -> DVec3 {
        self.way + x * self.along + y * self.across
    }

    /// Casts `columns` x `rows` sub-rays, each at the centre of its part of the patch.
    pub fn samples(self, [columns, rows]: [usize; 2], around: &Surroundings) -> Samples {
        let place = |at: usize, of: usize| (2 * at + 1) as f64 / of as f64 - 1.0;
        let grid = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let samples = grid.map(|(column, row)| {
            let (x, y) = (place(column, columns), place(row, rows));
            let met = around.meet(self.from_m, self.towards(x, y).normalize());
            ReferenceSample { x, y, met }
        });
        Samples {
            samples: samples.collect(),
            footprint: self,
        }
    }
}

impl Samples {
    /// Whether all hits are on one plane, or there are none. The inverse of the depth is linear
    /// over a plane.
    pub fn are_plane(&self) -> bool {
        if self.samples.iter().all(|sample| sample.met.is_none()) {
            return true;
        }
        let seen: Vec<[f64; 3]> = (self.samples.iter())
            .filter_map(|sample| {
                let length = self.footprint.towards(sample.x, sample.y).length();
                Some([sample.x, sample.y, length / sample.met?.range_m])
            })
            .collect();
        // The grid is symmetric, so means are those of the best plane.
        let sum = |of: &dyn Fn(&[f64; 3]) -> f64| seen.iter().map(of).sum::<f64>();
        let mean = sum(&|[_, _, inverse]| *inverse) / seen.len() as f64;
        let slope = |axis: usize| {
            let squares = sum(&|at| at[axis] * at[axis]);
            match squares > 0.0 {
                true => sum(&|at| at[axis] * at[2]) / squares,
                false => 0.0,
            }
        };
        let (slope_x, slope_y) = (slope(0), slope(1));
        let is_on = |[x, y, inverse]: &[f64; 3]| {
            let off = (mean + slope_x * x + slope_y * y - inverse).abs();
            off <= FLAT_M * inverse * inverse
        };
        seen.len() == self.samples.len() && seen.iter().all(is_on)
    }

    /// The range of the strongest return, and that of the last or, if the strongest is the last, of
    /// the second strongest; infinite for none.
    pub fn returns_m(&self) -> [f64; 2] {
        let mut mets: Vec<&SurfaceHit> =
            self.samples.iter().filter_map(|s| s.met.as_ref()).collect();
        mets.sort_by(|a, b| a.range_m.total_cmp(&b.range_m));
        let strength = |met: &SurfaceHit| light(met.reflectivity) / (met.range_m * met.range_m);
        let noticed = LEAST_SHARE * self.samples.len() as f64;
        // Range and strength, the nearest first.
        let mut returns: Vec<[f64; 2]> = mets
            .chunk_by(|a, b| b.range_m - a.range_m < SEPARATION_M)
            .filter(|together| together.len() as f64 >= noticed)
            .map(|together| {
                let whole: f64 = together.iter().map(|met| strength(met)).sum();
                let ranges = together.iter().map(|met| strength(met) * met.range_m);
                [ranges.sum::<f64>() / whole, whole]
            })
            .collect();
        let strongest = |returns: &[[f64; 2]]| {
            let all = returns.iter().enumerate();
            all.max_by(|(_, a), (_, b)| a[1].total_cmp(&b[1]))
                .map(|(at, _)| at)
        };
        let Some(first) = strongest(&returns) else {
            return [f64::INFINITY; 2];
        };
        let is_last = first + 1 == returns.len();
        let [first_m, _] = returns.remove(first);
        let other = match is_last {
            true => strongest(&returns),
            false => returns.len().checked_sub(1),
        };
        let other = other.and_then(|at| returns.get(at));
        [first_m, other.map_or(f64::INFINITY, |of| of[0])]
    }
}

/// Reflected light relative to a white wall: percent up to 100, then logarithmic up to 300 times
/// that at 255.
fn light(reflectivity: f64) -> f64 {
    let light = match reflectivity <= 100.0 {
        true => reflectivity / 100.0,
        false => 300_f64.powf((reflectivity - 100.0) / 155.0),
    };
    light.max(1e-9)
}
