//! Location of directions in bins: the bin with the nearest centre.
//!
//! Directions are divided into cells ([`super::cells`]). For each cell, the bins that can be
//! nearest to any direction in it are listed beforehand. A cell lies in a ball of radius r around
//! its centre. So the nearest bin centre is at most 2 r farther from that than the one nearest to
//! it. A direction is then compared with the few candidates of its cell.

use glam::DVec3;

use super::cells::CubeCell;
use super::icosahedron::{Icosahedron, IcosahedronFace};

/// Finds the bin of a direction.
#[derive(Clone, Debug)]
pub struct Locator {
    /// Number of cuts of the cells.
    cuts: u8,
    /// Start of each cell's candidates, and the end.
    starts: Vec<u32>,
    /// Bins, ascending within a cell.
    candidates: Vec<u32>,
    centres: Vec<DVec3>,
}

/// More than the rounding of a cell's corner or of a distance.
const MARGIN: f64 = 1e-12;
/// Additional cuts of the cells compared with the bins, up to `MOST_CUTS`.
const FINER: u8 = 2;
const MOST_CUTS: u8 = 9;

impl Locator {
    /// A locator for the bins of an icosahedron.
    #[must_use]
    pub fn new(icosahedron: &Icosahedron) -> Self {
        let cuts = (icosahedron.level() as u8)
            .saturating_add(FINER)
            .min(MOST_CUTS);
        let mut locator = Self {
            cuts,
            starts: vec![0],
            candidates: Vec::new(),
            centres: icosahedron.bins().iter().map(|bin| bin.centre).collect(),
        };
        let mut found = Vec::new();
        for cell in CubeCell::all(cuts) {
            let (middle, radius) = cell.ball();
            candidates(icosahedron, middle, radius + MARGIN, &mut found);
            locator.candidates.extend_from_slice(&found);
            locator.starts.push(locator.candidates.len() as u32);
        }
        locator
    }

    /// The bin with the nearest centre: the largest dot product in f64, the first of equal ones.
    #[inline]
    #[must_use]
    pub fn bin(&self, direction: DVec3) -> u32 {
        let cell = CubeCell::of(direction, self.cuts);
        let range = |i: usize| self.starts.get(i).map_or(0, |&start| start as usize);
        let candidates = self.candidates.get(range(cell)..range(cell + 1));
        let mut nearest = (f64::NEG_INFINITY, 0);
        for &bin in candidates.unwrap_or_default() {
            let centre = self.centres.get(bin as usize).copied();
            let dot = centre.map_or(f64::NEG_INFINITY, |centre| centre.dot(direction));
            if dot > nearest.0 {
                nearest = (dot, bin);
            }
        }
        nearest.1
    }

    /// Number of bins.
    #[must_use]
    pub fn bins(&self) -> usize {
        self.centres.len()
    }
}

/// The bins whose centres can be nearest to a point within `radius` of `middle`, in ascending
/// order.
fn candidates(icosahedron: &Icosahedron, middle: DVec3, radius: f64, found: &mut Vec<u32>) {
    let centre = |face: &IcosahedronFace| face.centre.distance(middle);
    // Descend to a nearby bin, which limits the search.
    let mut best = usize::MAX;
    for faces in icosahedron.levels() {
        let below = if best == usize::MAX {
            0..faces.len()
        } else {
            4 * best..4 * best + 4
        };
        let near = below.filter_map(|i| Some((centre(faces.get(i)?), i)));
        best = near
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map_or(0, |(_, i)| i);
    }
    let first = icosahedron.bins().get(best).map_or(2.0, centre);
    // Faces that may contain a centre that near, level by level.
    let within = first + 2.0 * radius + MARGIN;
    let mut open: Vec<usize> = (0..20).collect();
    for (level, faces) in icosahedron.levels().iter().enumerate() {
        if level > 0 {
            open = open.iter().flat_map(|i| 4 * i..4 * i + 4).collect();
        }
        open.retain(|&i| faces.get(i).is_some_and(|f| centre(f) - f.chord <= within));
    }
    // The nearest bin is no farther than the one found.
    let bins = icosahedron.bins();
    let distances = || open.iter().filter_map(|&i| Some((i, centre(bins.get(i)?))));
    let nearest = distances().map(|(_, d)| d).fold(first, f64::min);
    found.clear();
    let close = distances().filter(|(_, d)| *d <= nearest + 2.0 * radius + MARGIN);
    found.extend(close.map(|(i, _)| i as u32));
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn slow(icosahedron: &Icosahedron, direction: DVec3) -> u32 {
        let mut nearest = (f64::NEG_INFINITY, 0);
        for (bin, face) in icosahedron.bins().iter().zip(0..).map(|(f, i)| (i, f)) {
            let dot = face.centre.dot(direction);
            if dot > nearest.0 {
                nearest = (dot, bin);
            }
        }
        nearest.1
    }

    fn direction() -> impl Strategy<Value = DVec3> {
        // Uniform on the sphere, and near the axes, where cells of the cube adjoin.
        let uniform = (-1.0..1.0_f64, 0.0..std::f64::consts::TAU).prop_map(|(z, a)| {
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * a.cos(), r * a.sin(), z)
        });
        let near = (0..26_usize, -1e-9..1e-9_f64, -1e-9..1e-9_f64).prop_map(|(k, a, b)| {
            let k = k + usize::from(k >= 13);
            let sign = |n: usize| n as f64 - 1.0;
            let corner = DVec3::new(sign(k % 3), sign(k / 3 % 3), sign(k / 9));
            (corner.normalize() + DVec3::new(a, b, -a)).normalize()
        });
        prop_oneof![3 => uniform, 1 => near]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn the_locator_agrees_with_a_search_of_every_bin(
            level in 0..6_u32, directions in prop::collection::vec(direction(), 50),
        ) {
            let icosahedron = Icosahedron::new(level).unwrap();
            let locator = Locator::new(&icosahedron);
            for direction in directions {
                prop_assert_eq!(locator.bin(direction), slow(&icosahedron, direction));
            }
        }
    }

    #[test]
    fn corners_and_edges_of_bins_agree_with_a_full_search() {
        for level in 0..=4 {
            let icosahedron = Icosahedron::new(level).unwrap();
            let locator = Locator::new(&icosahedron);
            for (number, bin) in icosahedron.bins().iter().enumerate().step_by(7) {
                assert_eq!(locator.bin(bin.centre), number as u32);
                let [a, b, c] = bin.corners;
                for border in [a, b, c, (a + b).normalize(), (b + 3.0 * c).normalize()] {
                    assert_eq!(locator.bin(border), slow(&icosahedron, border));
                }
            }
        }
    }

    #[test]
    fn the_first_of_equally_near_bins_is_chosen() {
        // A corner of the icosahedron is equally far from five bins, the middle of an edge from
        // two.
        let icosahedron = Icosahedron::new(0).unwrap();
        let locator = Locator::new(&icosahedron);
        let z = DVec3::Z;
        let dots: Vec<f64> = icosahedron.bins().iter().map(|b| b.centre.dot(z)).collect();
        let most = dots.iter().copied().fold(f64::MIN, f64::max);
        let equal: Vec<usize> = (0..20).filter(|&i| dots[i] == most).collect();
        assert!(equal.len() >= 2, "{dots:?}");
        assert_eq!(locator.bin(z) as usize, equal[0]);
    }

    #[test]
    fn few_candidates_are_compared_per_lookup() {
        let locator = Locator::new(&Icosahedron::new(4).unwrap());
        let mean = locator.candidates.len() as f64 / (locator.starts.len() - 1) as f64;
        assert!(mean < 4.0, "{mean}");
    }
}
