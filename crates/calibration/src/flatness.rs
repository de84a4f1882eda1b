//! Evidence from the flatness of large surfaces, mainly on the common range of all lasers.
//!
//! A common error of ranges bends a wall towards the scanner where it is near and not where it is
//! far. Within an element of half a metre its curvature hides that; over metres walls are flatter.
//! The heights of elements over their surface are measurements of all parameters, for errors of
//! others bend walls too. How flat the surfaces are comes from the heights themselves, in clusters
//! of 3 m.

use crate::linear::{Cholesky, Matrix, Vec3, add, dot};

/// A surface element for this purpose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallElement {
    pub log: usize,
    /// Mean position of its shots.
    pub centre: Vec3,
    /// Change of that by the common range, through all parameters that go with it.
    pub slope: Vec3,
    pub normal: Vec3,
    pub shots: usize,
    /// Its number among all elements.
    pub number: usize,
}

/// Elements of a surface lie within this distance of its plane, metres.
const SURFACE_M: f64 = 0.06;
/// Their normals agree with its: the cosine of 6 degrees.
const SURFACE_COSINE: f64 = 0.9945;
/// Fewest elements of a surface.
const MIN_ELEMENTS: usize = 40;
/// Most surfaces that are looked for.
const MAX_SURFACES: usize = 60;
/// Width of clusters in which unevenness is common, metres.
const CLUSTER_M: f64 = 3.0;
/// Unevenness that all clusters share, one standard deviation: the errors in simulated scenes with
/// flat walls are 0.4 to 0.9 mm.
pub(crate) const COMMON_SD_M: f64 = 5e-4;
/// Elements farther off than this many median deviations do not count.
const CUT: f64 = 5.0;

/// The height of an element over its surface: a measurement of all parameters.
#[derive(Clone, Debug)]
pub(crate) struct ElementHeight {
    /// Change by each parameter, less its plane over the surface.
    pub slopes: Vec<f64>,
    pub height_m: f64,
    pub variance_m2: f64,
}

/// The heights of elements over large surfaces. `slopes` has the change of each element's height by
/// each parameter.
pub(crate) fn flatness(elements: &[WallElement], slopes: &[Vec<f64>]) -> Vec<ElementHeight> {
    let mut sums = Sums::default();
    for surface in surfaces(elements, MIN_ELEMENTS) {
        let seed = surface.iter().max_by_key(|element| element.shots);
        if let Some(normal) = seed.map(|seed| seed.normal) {
            sums.add(&surface, normal, slopes);
        }
    }
    sums.result()
}

/// Nearly plane surfaces of `least` elements and more, grown from the elements with most shots.
pub(crate) fn surfaces(elements: &[WallElement], least: usize) -> Vec<Vec<&WallElement>> {
    let mut free: Vec<&WallElement> = elements.iter().collect();
    let mut found = Vec::new();
    for _ in 0..MAX_SURFACES {
        let Some(seed) = free.iter().copied().max_by_key(|element| element.shots) else {
            break;
        };
        let is_near = |element: &&WallElement| {
            element.log == seed.log
                && dot(element.normal, seed.normal).abs() > SURFACE_COSINE
                && dot(seed.normal, add(element.centre, -1.0, seed.centre)).abs() < SURFACE_M
        };
        let (surface, rest): (Vec<&WallElement>, Vec<&WallElement>) =
            free.into_iter().partition(|element| is_near(element));
        free = rest;
        if surface.len() >= least {
            found.push(surface);
        }
    }
    found
}

/// Heights of all surfaces, and the common range by them.
#[derive(Default)]
struct Sums {
    heights: Vec<ElementHeight>,
    information: f64,
    /// Gradients and information of clusters: how much unevenness moves the common range.
    clusters: Vec<[f64; 2]>,
}

impl Sums {
    /// Adds a surface, with a plane of its own.
    fn add(&mut self, surface: &[&WallElement], normal: Vec3, slopes: &[Vec<f64>]) {
        let axis = if normal[2].abs() < 0.9 {
            [0.0, 0.0, 1.0]
        } else {
            [1.0, 0.0, 0.0]
        };
        let across = crate::linear::cross(normal, axis);
        let along = crate::linear::cross(across, normal);
        let origin = surface.first().map_or([0.0; 3], |element| element.centre);
        let mut kept = surface.to_vec();
        let places = |kept: &[&WallElement]| -> Vec<[f64; 3]> {
            let place = |element: &&WallElement| {
                let d = add(element.centre, -1.0, origin);
                [1.0, dot(across, d), dot(along, d)]
            };
            kept.iter().map(place).collect()
        };
        let heights = |kept: &[&WallElement]| -> Vec<f64> {
            let height = |element: &&WallElement| dot(normal, add(element.centre, -1.0, origin));
            kept.iter().map(height).collect()
        };
        for _ in 0..3 {
            let Some(heights) = less_plane(&places(&kept), &heights(&kept)) else {
                return;
            };
            let mut sorted: Vec<f64> = heights.iter().map(|height| height.abs()).collect();
            let middle = sorted.len() / 2;
            let (_, median, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
            let limit = CUT * *median;
            let mut index = 0;
            kept.retain(|_| {
                index += 1;
                heights[index - 1].abs() <= limit
            });
            if kept.len() < MIN_ELEMENTS {
                return;
            }
        }
        let places = places(&kept);
        let common: Vec<f64> = kept.iter().map(|wall| dot(normal, wall.slope)).collect();
        let (Some(heights), Some(common)) = (
            less_plane(&places, &heights(&kept)),
            less_plane(&places, &common),
        ) else {
            return;
        };
        let parameters = slopes.first().map_or(0, Vec::len);
        let columns: Option<Vec<Vec<f64>>> = (0..parameters)
            .map(|parameter| {
                let side = |wall: &&WallElement| dot(normal, wall.normal).signum();
                let column = kept
                    .iter()
                    .map(|wall| side(wall) * slopes[wall.number][parameter]);
                less_plane(&places, &column.collect::<Vec<f64>>())
            })
            .collect();
        let Some(columns) = columns else {
            return;
        };
        // By variance: uneven surfaces say less.
        let variance = heights.iter().map(|h| h * h).sum::<f64>() / heights.len() as f64;
        let mut cells: Vec<([i64; 2], [f64; 2])> = places
            .iter()
            .zip(heights.iter().zip(&common))
            .map(|(place, (height, slope))| {
                let cell = [place[1], place[2]].map(|at| (at / CLUSTER_M).floor() as i64);
                (cell, [slope * height / variance, slope * slope / variance])
            })
            .collect();
        cells.sort_by_key(|(cell, _)| *cell);
        for cluster in cells.chunk_by(|a, b| a.0 == b.0) {
            let sum = |part: usize| cluster.iter().map(|cell| cell.1[part]).sum::<f64>();
            self.information += sum(1);
            self.clusters.push([sum(0), sum(1)]);
        }
        self.heights.extend(
            heights
                .iter()
                .enumerate()
                .map(|(index, height)| ElementHeight {
                    slopes: columns.iter().map(|column| column[index]).collect(),
                    height_m: *height,
                    variance_m2: variance,
                }),
        );
    }

    /// The heights, with variances by which clusters differ as much as they do.
    fn result(mut self) -> Vec<ElementHeight> {
        let right: f64 = self.clusters.iter().map(|cluster| cluster[0]).sum();
        let error = right / self.information.max(f64::MIN_POSITIVE);
        let scatter = self.clusters.iter();
        let scatter = scatter.map(|[right, information]| (right - information * error).powi(2));
        let ratio = scatter.sum::<f64>() / self.information.max(f64::MIN_POSITIVE);
        for height in &mut self.heights {
            height.variance_m2 *= ratio.max(1.0);
        }
        self.heights
    }
}

/// Values at places [1, s, t] less their plane.
fn less_plane(places: &[[f64; 3]], values: &[f64]) -> Option<Vec<f64>> {
    let mut normal = Matrix::zero(3);
    let mut right = [0.0; 3];
    for (place, value) in places.iter().zip(values) {
        for i in 0..3 {
            right[i] += place[i] * value;
            for j in 0..=i {
                *normal.at_mut(i, j) += place[i] * place[j];
            }
        }
    }
    Cholesky::new(&normal)?.solve(&mut right);
    let plane = |place: &[f64; 3]| (0..3).map(|i| right[i] * place[i]).sum::<f64>();
    let less = places.iter().zip(values);
    Some(less.map(|(place, value)| value - plane(place)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::draws;

    /// A wall 4 m away, seen with ranges that are all 5 mm too long.
    fn wall(noise_m: f64, seed: u64) -> Vec<WallElement> {
        let mut random = draws(seed);
        let mut elements = Vec::new();
        for i in -14..=14 {
            for k in -4..=4 {
                let at = [0.5 * f64::from(i), 4.0, 0.5 * f64::from(k)];
                let length = dot(at, at).sqrt();
                let slope = at.map(|part| part / length);
                let bumpy = add(add(at, 0.005, slope), noise_m * random(), [0.0, 1.0, 0.0]);
                elements.push(WallElement {
                    log: 0,
                    centre: bumpy,
                    slope,
                    normal: [0.0, 1.0, 0.0],
                    shots: 50,
                    number: elements.len(),
                });
            }
        }
        elements
    }

    /// Least squares for the common range alone.
    fn common(elements: &[WallElement]) -> Option<(f64, f64)> {
        let slopes = elements
            .iter()
            .map(|wall| vec![dot(wall.normal, wall.slope)]);
        let heights = flatness(elements, &slopes.collect::<Vec<_>>());
        let information: f64 = heights
            .iter()
            .map(|h| h.slopes[0].powi(2) / h.variance_m2)
            .sum();
        let right: f64 = heights
            .iter()
            .map(|h| h.slopes[0] * h.height_m / h.variance_m2)
            .sum();
        (!heights.is_empty()).then(|| (-right / information, 1.0 / information))
    }

    #[test]
    fn a_bent_wall_shows_the_common_range_with_its_deviation() {
        let (correction, variance) = common(&wall(0.0, 1)).unwrap();
        assert!((correction + 0.005).abs() < 1e-6, "{correction} {variance}");
        let mut squares = 0.0;
        for seed in 0..20 {
            let (correction, variance) = common(&wall(0.004, seed)).unwrap();
            squares += (correction + 0.005).powi(2) / variance / 20.0;
        }
        assert!(squares < 2.0, "{squares}");
    }

    #[test]
    fn without_large_surfaces_nothing_is_known() {
        assert!(common(&wall(0.0, 1)[..30]).is_none());
        assert!(common(&[]).is_none());
    }
}
