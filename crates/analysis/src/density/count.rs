//! Points per bin and their statistics.

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use utoipa::ToSchema;

use super::{DensityError, Locator, SPHERE_DEG2, check};

/// Points per bin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BinCounts(Vec<u64>);

/// Statistics of the points per bin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct Statistics {
    /// Number of bins.
    pub bins: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation over all bins (population, not sample).
    pub sd: f64,
    /// Fewest.
    pub min: u64,
    /// Most.
    pub max: u64,
    /// Mean divided by the mean area of a bin, points per square degree.
    pub mean_per_deg2: f64,
    /// Standard deviation per square degree.
    pub sd_per_deg2: f64,
    /// Bins without a point.
    pub empty: usize,
    /// Standard deviation divided by the mean; `None` without points.
    pub sd_over_mean: Option<f64>,
    /// Share of the bins with a point, 0 to 1; `None` without bins.
    pub coverage: Option<f64>,
}

/// A class of a histogram.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct HistogramClass {
    /// Smallest number of points.
    pub from: u64,
    /// Largest number of points.
    pub to: u64,
    /// Number of bins.
    pub bins: usize,
}

/// Smallest number of directions per thread.
const CHUNK: usize = 1 << 16;

impl BinCounts {
    /// Counts directions in linear time.
    ///
    /// # Errors
    /// [`DensityError::Direction`] for the first invalid direction.
    pub fn new(locator: &Locator, directions: &[DVec3]) -> Result<Self, DensityError> {
        let mut counts = Self::empty(locator);
        counts.add(locator, directions)?;
        Ok(counts)
    }

    /// Bins without points.
    #[must_use]
    pub fn empty(locator: &Locator) -> Self {
        Self(vec![0; locator.bins()])
    }

    /// Counts more directions.
    ///
    /// # Errors
    /// [`DensityError::Direction`] for the first invalid direction; none is counted.
    pub fn add(&mut self, locator: &Locator, directions: &[DVec3]) -> Result<(), DensityError> {
        check(directions)?;
        let bins = locator.bins();
        // One part per thread, since each needs its own row of bins.
        let part = directions
            .len()
            .div_ceil(rayon::current_num_threads().max(1))
            .max(CHUNK);
        let parts: Vec<Vec<u64>> = directions
            .par_chunks(part)
            .map(|part| {
                let mut counts = vec![0_u64; bins];
                for direction in part {
                    if let Some(count) = counts.get_mut(locator.bin(*direction) as usize) {
                        *count += 1;
                    }
                }
                counts
            })
            .collect();
        for counts in parts {
            for (sum, count) in self.0.iter_mut().zip(counts) {
                *sum += count;
            }
        }
        Ok(())
    }

    /// Points in each bin, in the order of [`super::Icosahedron::bins`].
    #[must_use]
    pub fn by_bin(&self) -> &[u64] {
        &self.0
    }

    /// Statistics of all bins.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        self.statistics_of(|_| true)
    }

    /// Statistics of the bins that `which` selects by number.
    #[must_use]
    pub fn statistics_of(&self, which: impl Fn(usize) -> bool) -> Statistics {
        let counts = self.0.iter().enumerate().filter(|(bin, _)| which(*bin));
        let counts: Vec<u64> = counts.map(|(_, count)| *count).collect();
        let bins = counts.len();
        let points: u64 = counts.iter().sum();
        let n = (bins as f64).max(1.0);
        let mean = points as f64 / n;
        let off = counts.iter().map(|&count| (count as f64 - mean).powi(2));
        let sd = (off.sum::<f64>() / n).sqrt();
        let per_deg2 = self.0.len() as f64 / SPHERE_DEG2;
        let empty = counts.iter().filter(|&&count| count == 0).count();
        Statistics {
            bins,
            mean,
            sd,
            min: counts.iter().copied().min().unwrap_or(0),
            max: counts.iter().copied().max().unwrap_or(0),
            mean_per_deg2: mean * per_deg2,
            sd_per_deg2: sd * per_deg2,
            empty,
            sd_over_mean: (mean > 0.0).then(|| sd / mean),
            coverage: (bins > 0).then(|| (bins - empty) as f64 / bins as f64),
        }
    }

    /// A histogram of at most `classes` equally wide classes (at least one) from 0 to the fullest
    /// bin.
    #[must_use]
    pub fn histogram(&self, classes: usize) -> Vec<HistogramClass> {
        let most = self.0.iter().copied().max().unwrap_or(0);
        self.histogram_by((most + 1).div_ceil(classes.max(1) as u64))
    }

    /// A histogram of classes of this width (at least 1) from 0 to the fullest bin.
    #[must_use]
    pub fn histogram_by(&self, width: u64) -> Vec<HistogramClass> {
        let most = self.0.iter().copied().max().unwrap_or(0);
        let width = width.max(1);
        let number = most / width + 1;
        let mut histogram: Vec<HistogramClass> = (0..number)
            .map(|class| HistogramClass {
                from: class * width,
                to: (class + 1) * width - 1,
                bins: 0,
            })
            .collect();
        for count in &self.0 {
            if let Some(class) = histogram.get_mut((count / width) as usize) {
                class.bins += 1;
            }
        }
        histogram
    }
}

#[cfg(test)]
mod tests {
    use super::super::Icosahedron;
    use super::*;

    fn locator(level: u32) -> Locator {
        Locator::new(&Icosahedron::new(level).unwrap())
    }

    /// Fibonacci's lattice, which is evenly spread.
    fn lattice(n: usize) -> Vec<DVec3> {
        let turn = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        (0..n)
            .map(|i| {
                let z = 1.0 - (2.0 * i as f64 + 1.0) / n as f64;
                let (sin, cos) = (turn * i as f64).sin_cos();
                let r = (1.0 - z * z).sqrt();
                DVec3::new(r * cos, r * sin, z)
            })
            .collect()
    }

    #[test]
    fn counts_agree_with_sequential_counting() {
        let (locator, directions) = (locator(3), lattice(200_000));
        let counts = BinCounts::new(&locator, &directions).unwrap();
        let mut slow = vec![0; 1_280];
        for direction in &directions {
            slow[locator.bin(*direction) as usize] += 1;
        }
        assert_eq!(counts.by_bin(), slow);
        let statistics = counts.statistics();
        assert_eq!(statistics.mean, 156.25);
        assert_eq!(statistics.empty, 0);
        assert!((statistics.mean_per_deg2 - 200_000.0 / 41_252.961_249).abs() < 1e-9);
    }

    #[test]
    fn all_points_in_one_bin() {
        let locator = locator(4);
        let counts = BinCounts::new(&locator, &vec![DVec3::Y; 5_120]).unwrap();
        let statistics = counts.statistics();
        assert_eq!(
            (statistics.min, statistics.max, statistics.empty),
            (0, 5_120, 5_119)
        );
        assert_eq!(statistics.mean, 1.0);
        // sqrt((5119^2 + 5119) / 5120) = sqrt(5119).
        assert!((statistics.sd - 5_119.0_f64.sqrt()).abs() < 1e-12);
        let classes = counts.histogram(10);
        assert_eq!(classes.len(), 10);
        assert_eq!(classes[0].bins, 5_119);
        assert_eq!(classes[9].bins, 1);
    }

    #[test]
    fn statistics_of_a_subset_of_the_bins() {
        let counts = BinCounts(vec![4, 0, 8, 100]);
        let some = counts.statistics_of(|bin| bin < 3);
        assert_eq!(some.coverage, Some(2.0 / 3.0));
        assert_eq!(some.sd_over_mean, Some(some.sd / 4.0));
        assert_eq!(counts.statistics_of(|_| false).coverage, None);
        assert_eq!(counts.statistics_of(|bin| bin == 1).sd_over_mean, None);
        assert_eq!(
            (some.bins, some.mean, some.min, some.max, some.empty),
            (3, 4.0, 0, 8, 1)
        );
        assert!((some.sd - (32.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(counts.statistics_of(|_| false).mean, 0.0);
    }

    #[test]
    fn zero_one_and_two_points_are_counted() {
        let locator = locator(1);
        for n in 0..3 {
            let directions = &[DVec3::Z, DVec3::NEG_Z][..n];
            let statistics = BinCounts::new(&locator, directions).unwrap().statistics();
            assert_eq!(statistics.empty, 80 - n);
            assert_eq!(statistics.max, n.min(1) as u64);
            assert!((statistics.mean - n as f64 / 80.0).abs() < 1e-15);
        }
        let none = BinCounts::new(&locator, &[]).unwrap();
        assert_eq!(
            none.histogram(8),
            [HistogramClass {
                from: 0,
                to: 0,
                bins: 80
            }]
        );
    }

    #[test]
    fn invalid_directions_are_refused_by_index() {
        let locator = locator(2);
        let wrong = [
            DVec3::new(f64::NAN, 0.0, 1.0),
            DVec3::new(f64::INFINITY, 0.0, 0.0),
            DVec3::ZERO,
            DVec3::new(0.0, 0.0, 1.001),
        ];
        for (place, wrong) in [0, 65_536, 140_000, 199_999].into_iter().zip(wrong) {
            let mut directions = lattice(200_000);
            directions[place] = wrong;
            let error = BinCounts::new(&locator, &directions).unwrap_err();
            let message = error.to_string();
            assert!(
                message.starts_with(&format!("density: point {place}: expected a direction")),
                "{message}"
            );
        }
    }

    #[test]
    fn histogram_classes_hold_every_bin_once() {
        let counts = BinCounts::new(&locator(2), &lattice(9_999)).unwrap();
        for classes in [0, 1, 2, 7, 100] {
            let histogram = counts.histogram(classes);
            assert!(histogram.len() <= classes.max(1));
            assert_eq!(histogram.iter().map(|class| class.bins).sum::<usize>(), 320);
            for pair in histogram.windows(2) {
                assert_eq!(pair[0].to + 1, pair[1].from);
            }
            for class in histogram {
                let within = counts
                    .by_bin()
                    .iter()
                    .filter(|c| (class.from..=class.to).contains(c));
                assert_eq!(within.count(), class.bins);
            }
        }
    }
}
