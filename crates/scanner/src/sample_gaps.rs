//! Times in a sweep from which no angle is known: a busy host or a drive that does not answer.

use units::Span;

use crate::angles::AngleSample;
use crate::sweeps::Sweep;

/// Shortest time without a sample that counts as a gap. The slowest supported polls are 25 ms
/// apart.
const SHORTEST_GAP: Span = Span::from_millis(100);

/// Gaps between the angle samples of all sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SampleGaps {
    /// Gaps of at least 0.1 s.
    pub count: u64,
    /// The longest time between two samples, whether it counts or not.
    pub longest: Span,
}

impl SampleGaps {
    /// The gaps of `sweeps`; the samples are in order of time.
    pub(crate) fn of(samples: &[AngleSample], sweeps: &[Sweep]) -> Self {
        let mut gaps = Self::default();
        for sweep in sweeps {
            let during = |s: &&AngleSample| (sweep.start..=sweep.end).contains(&s.host);
            let times = samples.iter().filter(during).map(|sample| sample.host);
            let mut last = sweep.start;
            for time in times.chain([sweep.end]) {
                let gap = time.saturating_since(last);
                last = time;
                gaps.longest = gaps.longest.max(gap);
                gaps.count += u64::from(gap >= SHORTEST_GAP);
            }
        }
        gaps
    }
}

#[cfg(test)]
mod tests {
    use units::{DegPerS, Degrees, Stamp};

    use super::*;
    use crate::sweeps::Commanded;

    #[test]
    fn gaps_within_sweeps_are_counted() {
        let at_ms = |ms: i64| Stamp::from_nanos(ms * 1_000_000);
        let sweep = |from, to| Sweep {
            from: Degrees(0.0),
            to: Degrees(-45.0),
            cruise: DegPerS(-50.0),
            start: at_ms(from),
            end: at_ms(to),
            commanded: Commanded::default(),
        };
        let times = [0, 10, 110, 111, 600, 605, 610, 900, 2000];
        let samples = times.map(|ms| AngleSample {
            host: at_ms(ms),
            bound: Span::ZERO,
            angle: Degrees(0.0),
        });
        let of = |sweeps: &[Sweep]| SampleGaps::of(&samples, sweeps);
        let both = of(&[sweep(10, 605), sweep(605, 900)]);
        assert_eq!((both.count, both.longest), (3, Span::from_millis(489)));
        // A sweep that is cut off ends between two samples.
        let cut_off = of(&[sweep(10, 500)]);
        assert_eq!(
            (cut_off.count, cut_off.longest),
            (2, Span::from_millis(389))
        );
        // Between two sweeps the axis rests.
        let apart = of(&[sweep(0, 10), sweep(605, 610)]);
        assert_eq!((apart.count, apart.longest), (0, Span::from_millis(10)));
        assert_eq!(of(&[]), SampleGaps::default());
    }
}
