//! Differences between sweeps of one scan, by the elements that both meet.

use std::collections::BTreeMap;

use super::ElementShot;
use crate::shots::RangeShot;

/// Two sweeps of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SweepPair {
    /// Number of the scan, from 0.
    pub log: usize,
    /// Numbers of the sweeps, from 0.
    pub sweeps: [usize; 2],
    /// Whether one went forward and the other back.
    pub both_ways: bool,
    /// Elements that both meet.
    pub patches: usize,
    /// Mean difference of ranges, the second less the first, metres.
    pub mean_m: f64,
    /// Root mean square of the elements' differences, metres.
    pub rms_m: f64,
    /// Root mean square expected from the noise of their shots, metres.
    pub expected_m: f64,
    /// The tilt by which the second is ahead, radians, and its standard deviation.
    pub tilt_rad: [f64; 2],
}

/// Fewest shots of a sweep on an element.
const MIN_SHOTS: f64 = 4.0;
/// Sweeps are compared with as many that follow.
const FOLLOWING: u16 = 2;

/// Weighted sums of a sweep on an element: weight, residuals, slopes by tilt; number; rates.
type Sums = [f64; 5];

#[derive(Default)]
pub(super) struct SweepDifferences {
    log: usize,
    /// Sweeps of the element in progress.
    element: BTreeMap<u16, Sums>,
    pairs: BTreeMap<(usize, u16, u16), PairSums>,
}

#[derive(Default)]
struct PairSums {
    patches: usize,
    both_ways: bool,
    difference_m: f64,
    squares_m2: f64,
    expected_m2: f64,
    /// Sums of the regression of differences by slopes.
    slope2: f64,
    product: f64,
}

impl SweepDifferences {
    /// Begins an element.
    pub fn begin(&mut self, log: usize) {
        self.end();
        self.log = log;
    }

    pub fn add(&mut self, shot: &RangeShot, on_element: &ElementShot) {
        let weight = on_element.expected_m.powi(-2);
        let sums = self.element.entry(shot.sweep).or_default();
        let all = [
            weight,
            weight * on_element.residual_m,
            weight * on_element.by_tilt,
            1.0,
            shot.rate_rad_s,
        ];
        for (sum, value) in sums.iter_mut().zip(all) {
            *sum += value;
        }
    }

    fn end(&mut self) {
        let element = std::mem::take(&mut self.element);
        let whole = |sums: &&Sums| sums[3] >= MIN_SHOTS;
        for (&first, a) in element.iter().filter(|(_, sums)| whole(sums)) {
            let following = element
                .range(first..=first.saturating_add(FOLLOWING))
                .skip(1);
            for (&second, b) in following.filter(|(_, sums)| whole(sums)) {
                let difference = b[1] / b[0] - a[1] / a[0];
                let slope = 0.5 * (a[2] / a[0] + b[2] / b[0]);
                let variance = 1.0 / a[0] + 1.0 / b[0];
                let pair = self.pairs.entry((self.log, first, second)).or_default();
                pair.patches += 1;
                pair.both_ways = a[4] * b[4] < 0.0;
                pair.difference_m += difference;
                pair.squares_m2 += difference * difference;
                pair.expected_m2 += variance;
                pair.slope2 += slope * slope / variance;
                pair.product += slope * difference / variance;
            }
        }
    }

    pub fn result(mut self) -> Vec<SweepPair> {
        self.end();
        let pairs = self.pairs.into_iter();
        let pair = |((log, first, second), sums): ((usize, u16, u16), PairSums)| {
            let count = sums.patches as f64;
            let slope2 = sums.slope2.max(f64::MIN_POSITIVE);
            SweepPair {
                log,
                sweeps: [usize::from(first), usize::from(second)],
                both_ways: sums.both_ways,
                patches: sums.patches,
                mean_m: sums.difference_m / count,
                rms_m: (sums.squares_m2 / count).sqrt(),
                expected_m: (sums.expected_m2 / count).sqrt(),
                tilt_rad: [sums.product / slope2, slope2.powf(-0.5)],
            }
        };
        pairs.map(pair).collect()
    }
}
